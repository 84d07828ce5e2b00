//! The catalogue: every fault that files may have.
//!
//! In: the files as they were read. Out: faults, each of which changes some number that the recordings could show.

use model_dsl::calibration::{CalibratedTerm, Calibration, CurveValues, SeriesInput};
use model_dsl::equations::Equations;

use super::fault::{Fault, Scope, TermAt};
use crate::Inputs;

/// All faults. Without a calibration there are none: a machine of which nothing is known predicts no error, whatever its chain is.
pub(super) fn faults(inputs: &Inputs<'_>) -> Vec<Fault> {
    let Some(known) = inputs.calibration.filter(|known| !known.motions.is_empty()) else { return Vec::new() };
    let equations = inputs.equations;
    // Of those that explain as much, the first is told: an instrument that was set up the wrong way before all numbers that were.
    let recordings = inputs.recordings.iter().enumerate();
    let deviating = recordings.filter(|(_, recording)| recording.deviation.is_some());
    let mut faults: Vec<Fault> = deviating.map(|(recording, _)| Fault::Scale { recording }).collect();
    faults.extend(sizes(known, equations));
    faults.extend(terms(known).flat_map(|(at, term)| of_term(at, term, equations)));
    faults.extend(places(known, equations));
    faults.extend((0..equations.constants.len()).map(Fault::Constant));
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

/// Factors of numbers: of each term, and of what is entered together where that is more than one.
fn sizes(known: &Calibration, equations: &Equations) -> Vec<Fault> {
    let mut scopes: Vec<Scope> = terms(known).map(|(at, _)| Scope::Term(at)).collect();
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

/// Whether numbers of another size are what a finding of the same term says: a squareness or a play that is another one. Only a curve
/// has a form that no finding comes to have by chance.
pub(super) fn is_a_finding(inputs: &Inputs<'_>, fault: &Fault) -> bool {
    let (Fault::Size(Scope::Term(at)), Some(known)) = (fault, inputs.calibration) else { return false };
    let mut of_place = terms(known).filter(|(place, _)| place == at);
    of_place.next().is_some_and(|(_, term)| !matches!(term, CalibratedTerm::Table { .. }))
}

/// What may be wrong with one term beside its size.
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
    let reads = match term {
        CalibratedTerm::Table { axis, .. }
        | CalibratedTerm::Coupling { axis, .. }
        | CalibratedTerm::Backlash { axis, .. }
        | CalibratedTerm::Cyclic { axis, .. }
        | CalibratedTerm::Polynomial { input: SeriesInput::Axis(axis), .. } => Some(*axis),
        _ => None,
    };
    if let Some(axis) = reads {
        let others = (0..equations.axes.len()).filter(|other| *other != axis);
        // Numbers per mm mean something else per rad.
        let alike = others.filter(|other| equations.axes[*other].rotary == equations.axes[axis].rotary);
        faults.extend(alike.map(|read| Fault::Axis { of: at, named: axis, read }));
    }
    faults
}

/// Numbers under the wrong error motion: two of one kind exchanged, or moved to one that has none.
fn places(known: &Calibration, equations: &Equations) -> Vec<Fault> {
    let listed: Vec<usize> = known.motions.iter().map(|listed| listed.motion).collect();
    let mut faults = Vec::new();
    for (number, from) in listed.iter().enumerate() {
        for to in 0..equations.motions.len() {
            let (one, other) = (&equations.motions[*from], &equations.motions[to]);
            if one.angular != other.angular || one.alignment != other.alignment {
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

/// Other orders of the chain: every order of a word of up to four letters, and of a longer one those in which two letters that stand
/// side by side are exchanged.
fn orders(inputs: &Inputs<'_>) -> Vec<String> {
    let Some(chains) = inputs.chains else { return Vec::new() };
    let letters: Vec<char> = chains.word.chars().collect();
    let words = if letters.len() <= ALL_ORDERS { permutations(&letters) } else { neighbours(&letters) };
    let words = words.into_iter().map(|word| word.into_iter().collect::<String>());
    words.filter(|word| word != chains.word).collect()
}

/// The most letters of which every order is tried: five have 120.
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
