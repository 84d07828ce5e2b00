//! The catalogue: every fault that files may have.
//!
//! In: the files as they were read. Out: all faults that they may have, whether the recordings can show them or not.

use model_dsl::calibration::{CalibratedMotion, CalibratedTerm, Calibration, CurveValues, TermKind};
use model_dsl::equations::Equations;

use super::fault::{Fault, Scope, TermAt};
use crate::Inputs;

/// All faults. Without a calibration there are none: the prediction has no error then, whatever the chain is.
pub(super) fn faults(inputs: &Inputs<'_>) -> Vec<Fault> {
    let Some(known) = inputs.calibration.filter(|known| !known.motions.is_empty()) else { return Vec::new() };
    let equations = inputs.equations;
    // Of faults that explain as much, the first is told. One instrument set up the wrong way is likelier than many wrong numbers.
    let recordings = inputs.recordings.iter().enumerate();
    let deviating = recordings.filter(|(_, recording)| recording.deviation.is_some());
    let mut faults: Vec<Fault> = deviating.map(|(recording, _)| Fault::Scale { recording }).collect();
    faults.extend(sizes(known, equations));
    faults.extend(terms(known).flat_map(|(at, term)| of_term(at, term, equations)));
    faults.extend(places(known, equations));
    faults.extend(equations.offsets().map(|(number, _)| Fault::Constant(number)));
    faults.extend(orders(inputs).into_iter().map(Fault::Order));
    faults.extend(sensors(known));
    faults
}

/// The terms of a calibration.
fn terms(known: &Calibration) -> impl Iterator<Item = (TermAt, &CalibratedTerm)> {
    known.motions.iter().flat_map(|listed| {
        let terms = listed.terms.iter().enumerate();
        terms.map(|(place, term)| (TermAt { motion: listed.motion, place }, &term.value))
    })
}

/// Wrong factors: of each term, and of all numbers that may have been entered together.
fn sizes(known: &Calibration, equations: &Equations) -> Vec<Fault> {
    let sized = terms(known).filter(|(_, term)| !is_of_a_drive(term));
    let mut scopes: Vec<Scope> = sized.map(|(at, _)| Scope::Term(at)).collect();
    let several = known.motions.iter().filter(|listed| listed.terms.len() > 1);
    scopes.extend(several.map(|listed| Scope::Motion(listed.motion)));
    let motions = || {
        let listed = known.motions.iter().map(|listed| &equations.motions[listed.motion]);
        listed.filter(|motion| !motion.alignment)
    };
    let axes = 0..equations.axes.len();
    scopes.extend(
        axes.filter(|axis| motions().filter(|motion| motion.axis == Some(*axis)).count() > 1)
            .map(Scope::Axis),
    );
    let angles = motions().filter(|motion| motion.angular).count();
    if angles > 1 && angles < known.motions.len() {
        scopes.push(Scope::Angles);
    }
    if known.motions.len() > 1 {
        scopes.push(Scope::Everything);
    }
    scopes.into_iter().map(Fault::Size).collect()
}

/// Whether a wrong size is the same as a finding of that term: another squareness, another play. A table is not: its form is too
/// particular for a finding to have it by chance.
pub(super) fn is_a_finding(inputs: &Inputs<'_>, fault: &Fault) -> bool {
    let (Fault::Size(Scope::Term(at)), Some(known)) = (fault, inputs.calibration) else { return false };
    let mut of_place = terms(known).filter(|(place, _)| place == at);
    of_place.next().is_some_and(|(_, term)| !matches!(term, CalibratedTerm::Table { .. }))
}

/// The faults of one term other than its size.
fn of_term(at: TermAt, term: &CalibratedTerm, equations: &Equations) -> Vec<Fault> {
    let mut faults = Vec::new();
    if let CalibratedTerm::Table { curve, .. } = term {
        faults.push(Fault::Mirror(at));
        faults.extend([-2, -1, 1, 2].map(|quarters| Fault::Shift { at, quarters }));
        faults.extend([-1, 1].map(|nodes| Fault::Slip { at, nodes }));
        if matches!(curve.values, CurveValues::Directed { .. }) {
            faults.push(Fault::Directions(at));
        }
    }
    if let Some(axis) = term.axis().filter(|_| !is_of_a_drive(term)) {
        let others = (0..equations.axes.len()).filter(|other| *other != axis);
        // Numbers per mm mean something else per rad.
        let alike = others.filter(|other| equations.axes[*other].rotary == equations.axes[axis].rotary);
        faults.extend(alike.map(|read| Fault::Axis { of: at, named: axis, read }));
    }
    faults
}

/// Whether a term is what the drive of an axis does, which has its place in the axis's own motion.
fn is_of_a_drive(term: &CalibratedTerm) -> bool {
    matches!(term.kind(), TermKind::Lag | TermKind::Acceleration | TermKind::Delay)
}

/// Whether a motion holds anything of the drive of its axis.
fn has_a_drive(listed: &CalibratedMotion) -> bool {
    !listed.inside_loop.is_empty() || listed.terms.iter().any(|term| is_of_a_drive(&term.value))
}

/// Numbers under the wrong error motion: two of one kind exchanged, or moved to one that has none. A motion with anything of a drive
/// stands where it belongs.
fn places(known: &Calibration, equations: &Equations) -> Vec<Fault> {
    let driven =
        |motion: usize| known.motions.iter().any(|listed| listed.motion == motion && has_a_drive(listed));
    let listed: Vec<usize> =
        known.motions.iter().map(|listed| listed.motion).filter(|motion| !driven(*motion)).collect();
    let mut faults = Vec::new();
    for (number, from) in listed.iter().enumerate() {
        for to in 0..equations.motions.len() {
            let (one, other) = (&equations.motions[*from], &equations.motions[to]);
            if driven(to) || one.angular != other.angular || one.alignment != other.alignment {
                continue;
            }
            if !listed.contains(&to) {
                faults.push(Fault::Moved { from: *from, to });
            } else if listed[number + 1..].contains(&to) {
                faults.push(Fault::Exchange { one: *from, other: to });
            }
        }
    }
    faults
}

/// Other orders of the topology word. Of a word of up to four letters these are all; of a longer one those with two neighbours exchanged.
fn orders(inputs: &Inputs<'_>) -> Vec<String> {
    let Some(chains) = inputs.chains else { return Vec::new() };
    let letters: Vec<char> = chains.word.chars().collect();
    let words = if letters.len() <= ALL_ORDERS { permutations(&letters) } else { neighbours(&letters) };
    let words = words.into_iter().map(|word| word.into_iter().collect::<String>());
    words.filter(|word| word != chains.word).collect()
}

/// The longest word of which every order is tried. Four letters have 24 orders, five have 120, and each has to be derived.
const ALL_ORDERS: usize = 4;

fn permutations(letters: &[char]) -> Vec<Vec<char>> {
    if letters.is_empty() {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for first in 0..letters.len() {
        let mut rest = letters.to_vec();
        let letter = rest.remove(first);
        for mut word in permutations(&rest) {
            word.insert(0, letter);
            all.push(word);
        }
    }
    all
}

fn neighbours(letters: &[char]) -> Vec<Vec<char>> {
    let exchanged = |place: usize| {
        let mut word = letters.to_vec();
        word.swap(place, place + 1);
        word
    };
    (0..letters.len().saturating_sub(1)).map(exchanged).collect()
}

/// Faults of temperatures: the reference of all terms that have one, and sensors that are exchanged.
fn sensors(known: &Calibration) -> Vec<Fault> {
    let thermal = |term: &CalibratedTerm| {
        matches!(term, CalibratedTerm::Expansion { .. } | CalibratedTerm::Growth { .. })
    };
    let mut faults = Vec::new();
    if terms(known).any(|(_, term)| thermal(term)) {
        faults.push(Fault::Reference);
    }
    let inputs: Vec<usize> = known.sensors.inputs().map(|(number, _)| number).collect();
    for (place, one) in inputs.iter().enumerate() {
        faults.extend(inputs[place + 1..].iter().map(|other| Fault::Sensors { one: *one, other: *other }));
    }
    faults
}
