//! Where error motions are felt and whether the slides can cancel them. In: equations. Out: for each error motion the
//! directions that it reaches, and for each direction whether some command moves the tip along it.
//!
//! Compensation adds what the slides can add: the columns of the Jacobian, one for each slide that corrects. A rotary axis
//! cancels the error of its own angle, and where the machine file asks for it what it can of the tool's direction. What neither reaches is
//! reported and left.

use abbe_runtime::Kinematics as _;

use model_dsl::algebra::Axis;
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;

/// Angles of rotary axes at which the machine is looked at, rad: none of them special.
const ANGLES: [f64; 4] = [0.3, 1.1, 2.3, 4.1];
/// What rounding may leave of a lever arm, as a share of the whole of it.
const ROUNDING: f64 = 1e-9;

/// Whether commands can cancel what an error motion does in a direction of the part's frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cancelled {
    /// Wherever the axes stand.
    Yes,
    /// To an extent that depends on where rotary axes stand.
    InPart,
    /// Nowhere.
    No,
}

/// The machine where its rotary axes stand somewhere.
struct State {
    /// What the slides reach: [`basis`].
    basis: Vec<[f64; 3]>,
    /// The lever arm of each error motion.
    levers: Vec<[f64; 3]>,
    /// What the rotary axes turn the direction of the tool to, as a basis.
    aims: Vec<[f64; 3]>,
    /// What each error motion does to that direction.
    tilts: Vec<[f64; 3]>,
}

/// For each error motion what the slides can do about it in X, Y, Z of the part's frame.
pub(super) fn cancelled(equations: &Equations) -> Vec<[Cancelled; 3]> {
    let states = states(equations);
    let own: Vec<usize> = equations.turning().iter().map(|own| own.motion).collect();
    let verdict = |motion: usize| match (own.contains(&motion), reached(equations, motion).is_empty()) {
        (true, _) => [Cancelled::Yes; 3],
        // It turns the tool, and slides do not.
        (false, true) => [Cancelled::No; 3],
        (false, false) => verdicts(&states, motion),
    };
    (0..equations.motions.len()).map(verdict).collect()
}

/// For each error motion what the rotary axes can do about it in the direction of the tool; nothing where they leave that as it is.
pub(super) fn aimed(equations: &Equations) -> Option<Vec<Cancelled>> {
    if equations.aiming().is_empty() {
        return None;
    }
    let states = states(equations);
    let own: Vec<usize> = equations.turning().iter().map(|own| own.motion).collect();
    let verdict =
        |motion: usize| if own.contains(&motion) { Cancelled::Yes } else { turned(&states, motion) };
    Some((0..equations.motions.len()).map(verdict).collect())
}

/// The verdict on what one error motion does to the direction of the tool.
fn turned(states: &[State], motion: usize) -> Cancelled {
    let tilts = states.iter().filter_map(|state| state.tilts.get(motion).map(|tilt| (*tilt, &state.aims)));
    let pairs: Vec<([f64; 3], [f64; 3])> = tilts.map(|(tilt, aims)| (tilt, outside(tilt, aims))).collect();
    let is_none = |vector: [f64; 3]| dot(&vector, &vector).sqrt() <= ROUNDING;
    if pairs.iter().all(|(_, rest)| is_none(*rest)) {
        Cancelled::Yes
    } else if pairs.iter().all(|(tilt, rest)| is_none(std::array::from_fn(|row| tilt[row] - rest[row]))) {
        Cancelled::No
    } else {
        Cancelled::InPart
    }
}

/// The machine at some places, none of them special.
fn states(equations: &Equations) -> Vec<State> {
    let lengths = |first: f64| std::iter::successors(Some(first), |last| Some(last * 1.3 + 7.0));
    let constants: Vec<f64> = lengths(31.0).take(equations.constants.len()).collect();
    let travels: Vec<f64> = lengths(53.0).take(equations.travels.len()).collect();
    let machine = Interpreter::new(equations, &constants);
    ANGLES
        .iter()
        .map(|angle| {
            let turns = std::iter::successors(Some(*angle), |angle| Some(angle + 0.7));
            let axes = equations.axes.iter().zip(turns.zip(lengths(71.0)));
            let positions: Vec<f64> =
                axes.map(|(axis, (turn, length))| if axis.rotary { turn } else { length }).collect();
            state(&machine, &positions, &travels)
        })
        .collect()
}

/// The machine at one place.
fn state(machine: &Interpreter, positions: &[f64], travels: &[f64]) -> State {
    let mut columns = vec![[0.0; 3]; machine.axes()];
    machine.directions(positions, &mut columns);
    let mut aims = [[0.0; 3]; 3];
    machine.aims(positions, &mut aims);
    let tilt = |motion: usize| {
        let mut motions = vec![0.0; machine.motions()];
        motions[motion] = 1.0;
        machine.direction_error(positions, travels, &motions).unwrap_or_default()
    };
    State {
        basis: basis(columns),
        levers: machine.levers(positions, travels),
        aims: basis(aims),
        tilts: (0..machine.motions()).map(tilt).collect(),
    }
}

/// The verdict on one error motion: what the slides leave of its lever arm, state by state.
fn verdicts(states: &[State], motion: usize) -> [Cancelled; 3] {
    let pair = |state: &State| {
        let arm = state.levers.get(motion)?;
        Some((*arm, outside(*arm, &state.basis)))
    };
    let pairs: Vec<([f64; 3], [f64; 3])> = states.iter().filter_map(pair).collect();
    Axis::ALL.map(|axis| {
        let row = axis.index();
        let vanishes = |part: &dyn Fn(&[f64; 3], &[f64; 3]) -> f64| {
            pairs.iter().all(|(arm, rest)| part(arm, rest).abs() <= ROUNDING * dot(arm, arm).sqrt())
        };
        if vanishes(&|_, rest| rest[row]) {
            Cancelled::Yes
        } else if vanishes(&|arm, rest| arm[row] - rest[row]) {
            Cancelled::No
        } else {
            Cancelled::InPart
        }
    })
}

/// Directions of length 1, square to each other, that together reach what these reach.
fn basis(columns: impl IntoIterator<Item = [f64; 3]>) -> Vec<[f64; 3]> {
    columns.into_iter().fold(Vec::new(), |mut basis, column| {
        let rest = outside(column, &basis);
        let length = dot(&rest, &rest).sqrt();
        if length > ROUNDING {
            basis.push(rest.map(|value| value / length));
        }
        basis
    })
}

/// What is left of a vector without its parts along a basis.
fn outside(vector: [f64; 3], basis: &[[f64; 3]]) -> [f64; 3] {
    basis.iter().fold(vector, |rest, known| {
        let along = dot(&rest, known);
        std::array::from_fn(|row| rest[row] - along * known[row])
    })
}

fn dot(left: &[f64; 3], right: &[f64; 3]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// The directions that a motion reaches, by its number in [`Equations::motions`].
pub(super) fn reached(equations: &Equations, motion: usize) -> Vec<Axis> {
    let rows = equations.rows.iter().filter(|row| row.terms.iter().any(|term| term.motion == motion));
    rows.map(|row| row.direction).collect()
}

/// The parts of the tool's direction that a motion reaches, where that is derived.
pub(super) fn tilted(equations: &Equations, motion: usize) -> impl Iterator<Item = char> {
    let rows = equations.orientation.iter();
    let seen = rows.filter(move |row| row.terms.iter().any(|term| term.motion == motion));
    seen.map(|row| row.direction.direction_letter())
}

/// Whether what reaches these directions can be compensated, in words: `yes`, `no`, `X; not Y`. The angle of a rotary axis may reach
/// none of them, and is cancelled.
///
/// Behind it stands what rotary axes leave of these parts of the tool's direction, where they correct it.
pub(super) fn words(
    reached: &[Axis],
    cancelled: &[Cancelled; 3],
    tilted: &[char],
    aimed: Option<Cancelled>,
) -> String {
    let tip = words_of_tip(reached, cancelled);
    let letters = tilted.iter().map(char::to_string).collect::<Vec<_>>().join(", ");
    match (aimed.filter(|_| !tilted.is_empty()), reached.is_empty()) {
        (None, _) | (Some(Cancelled::Yes), false) => tip,
        (Some(Cancelled::Yes), true) => "yes".to_owned(),
        (Some(Cancelled::InPart), true) => format!("{letters} in part"),
        (Some(Cancelled::No), true) => "no".to_owned(),
        (Some(Cancelled::InPart), false) => format!("{tip}; {letters} in part"),
        (Some(Cancelled::No), false) => format!("{tip}; not {letters}"),
    }
}

/// The words for the tip.
fn words_of_tip(reached: &[Axis], cancelled: &[Cancelled; 3]) -> String {
    let those = |wanted: Cancelled| {
        let found = reached.iter().filter(|axis| cancelled[axis.index()] == wanted);
        found.map(Axis::to_string).collect::<Vec<_>>().join(", ")
    };
    if reached.is_empty() && *cancelled == [Cancelled::Yes; 3] {
        return "yes".to_owned();
    }
    let (yes, part, no) = (those(Cancelled::Yes), those(Cancelled::InPart), those(Cancelled::No));
    match (yes.is_empty(), part.is_empty(), no.is_empty()) {
        (false, true, true) => "yes".to_owned(),
        (true, true, _) => "no".to_owned(),
        _ => {
            let kinds = [(yes, ""), (part, " in part"), (no, "")];
            let told = kinds.into_iter().enumerate().filter(|(_, (axes, _))| !axes.is_empty());
            let told: Vec<String> = told
                .map(|(kind, (axes, after))| format!("{}{axes}{after}", if kind == 2 { "not " } else { "" }))
                .collect();
            told.join("; ")
        }
    }
}
