//! The compiler against the oracles. In: random machines and the shipped ones. Out: nothing, or the machine file and the
//! number in which the equations differ from dual numbers or from the exact machine.

use std::collections::BTreeMap;

use abbe_runtime::Kinematics;
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::equations::Equations;
use model_dsl::exact::{Columns, Displaced, ExactProduct};
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;
use proptest::prelude::*;

use crate::oracle::{Machine, Sizes, State, draw, dual, exact};
use crate::random::{machines, of_word, state, words};
use crate::shipped::SHIPPED;
use crate::yaml;

/// Both sides add and multiply the same few dozen numbers in another order: some hundred roundings of 1e-16.
const RELATIVE: f64 = 1e-9;

/// Compiles a machine file that must be free of errors.
pub(crate) fn compiled(text: &str) -> Equations {
    let source = SourceFile::new("machine.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let compiled = model_dsl::compile(&source, &mut diagnostics);
    let Some(compiled) = compiled else { panic!("{}\n{text}", render(&source, &diagnostics, false)) };
    compiled.equations
}

/// The interpreter of a machine and its inputs, in the order that its equations give them.
pub(crate) struct Case<'m> {
    pub(crate) machine: &'m Machine,
    pub(crate) equations: &'m Equations,
    pub(crate) interpreter: Interpreter,
    pub(crate) state: State,
    pub(crate) position: Vec<f64>,
    pub(crate) travel: Vec<f64>,
}

impl<'m> Case<'m> {
    pub(crate) fn new(machine: &'m Machine, equations: &'m Equations, state: State) -> Self {
        let constants: Vec<f64> =
            equations.constants.iter().map(|constant| state.constants[&*constant.name]).collect();
        let position = equations.axes.iter().map(|axis| state.positions[&*axis.variable]).collect();
        let travel = equations.travels.iter().map(|travel| state.travels[&*travel.name]).collect();
        Self {
            machine,
            equations,
            interpreter: Interpreter::new(equations, &constants),
            state,
            position,
            travel,
        }
    }

    /// Error motions of random size: displacements within 0.05 mm, angles within 40 urad.
    pub(crate) fn errors(&self, seed: u64) -> Vec<f64> {
        let size = |angular| if angular { 40e-6 } else { 0.05 };
        self.equations.motions.iter().map(|motion| size(motion.angular) * draw(seed, &motion.name)).collect()
    }

    /// The state with error motions `scale` times those given.
    pub(crate) fn with(&self, errors: &[f64], scale: f64) -> State {
        let names = self.equations.motions.iter().map(|motion| motion.name.clone());
        let errors: BTreeMap<String, f64> = names.zip(errors.iter().map(|value| scale * value)).collect();
        State { errors, ..self.state.clone() }
    }

    /// What error motions do to the tool, by the product of finite matrices.
    fn displaced(&self, errors: &[f64]) -> Displaced {
        let constants = self.equations.constants.iter().map(|constant| self.state.constants[&*constant.name]);
        let exact = ExactProduct::new(self.equations, &constants.collect::<Vec<_>>());
        let positions: Vec<&[f64]> = self.position.chunks(1).collect();
        let travels: Vec<&[f64]> = self.travel.chunks(1).collect();
        let motions: Vec<Option<&[f64]>> = errors.chunks(1).map(Some).collect();
        exact.displaced(&Columns { positions: &positions, travels: &travels, motions: &motions }, true)
    }

    fn sensitive(&self, vector: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| if self.machine.sensitive[axis] { vector[axis] } else { 0.0 })
    }

    fn size(&self) -> f64 {
        1.0 + Sizes::of(self.machine, &self.state).lengths
    }
}

/// The first-order equations, number by number, against dual numbers.
pub(crate) fn agrees_with_dual_numbers(case: &Case<'_>, seed: u64) -> Result<(), TestCaseError> {
    let errors = case.errors(seed);
    let (tip, change) = dual::tip(case.machine, &case.with(&errors, 1.0));
    same("nominal", case.interpreter.nominal(&case.position), case.sensitive(tip), case.size())?;
    // The greatest change that errors of this size can make, so that the comparison is relative to them.
    let sizes = Sizes::of(case.machine, &case.with(&errors, 1.0));
    let size = sizes.displacements + sizes.angles * sizes.lengths;
    let error = case.interpreter.error(&case.position, &case.travel, &errors);
    same("error", error, case.sensitive(change), size)?;
    levers_are_dual_numbers(case, &case.interpreter.levers(&case.position, &case.travel))
}

/// Lever arms, whoever computed them, motion by motion against dual numbers.
pub(crate) fn levers_are_dual_numbers(case: &Case<'_>, levers: &[[f64; 3]]) -> Result<(), TestCaseError> {
    prop_assert_eq!(levers.len(), case.equations.motions.len());
    for (motion, lever) in case.equations.motions.iter().zip(levers) {
        let errors = BTreeMap::from([(motion.name.clone(), 1.0)]);
        let (_, arm) = dual::tip(case.machine, &State { errors, ..case.state.clone() });
        same(&motion.name, *lever, case.sensitive(arm), case.size())?;
    }
    Ok(())
}

/// What the file lists and the equations lack must have no lever in any sensitive direction.
pub(crate) fn nothing_seen_is_missing(case: &Case<'_>) -> Result<(), TestCaseError> {
    for link in case.machine.links() {
        for error in link.errors.iter().flatten() {
            let name = error.name(&link.id);
            if case.equations.motions.iter().any(|motion| motion.name == name) {
                continue;
            }
            let errors = BTreeMap::from([(name.clone(), 1.0)]);
            let (_, arm) = dual::tip(case.machine, &State { errors, ..case.state.clone() });
            same(&name, [0.0; 3], case.sensitive(arm), case.size())?;
        }
    }
    Ok(())
}

/// The directions of the slides, as derivatives by dual numbers; rotary axes and second slides do not correct.
pub(crate) fn directions_are_derivatives(case: &Case<'_>) -> Result<(), TestCaseError> {
    let axes = case.equations.axes.len();
    let mut directions = vec![[f64::NAN; 3]; axes];
    case.interpreter.directions(&case.position, &mut directions);
    let mut driven: Vec<usize> = Vec::new();
    for (axis, direction) in case.equations.axes.iter().zip(directions) {
        let rates = BTreeMap::from([(axis.variable.to_string(), 1.0)]);
        let (_, way) = dual::tip(case.machine, &State { rates, ..case.state.clone() });
        let way = case.sensitive(way);
        let along = axis.along.index();
        let corrects = !axis.rotary && !driven.contains(&along) && way.iter().any(|part| part.abs() > 1e-12);
        if corrects {
            driven.push(along);
        }
        same(&axis.letter, direction, if corrects { way } else { [0.0; 3] }, 1.0)?;
    }
    Ok(())
}

/// `J J^T`, J being the directions of the axes: what the equations say of it holds at any position; and where they say nothing,
/// there is something beside its diagonal, a rotary axis changes it, or none changes J.
pub(crate) fn squares_are_those_of_the_directions(case: &Case<'_>) -> Result<(), TestCaseError> {
    let at = |position: &[f64]| {
        let mut directions = vec![[f64::NAN; 3]; position.len()];
        case.interpreter.directions(position, &mut directions);
        let entry =
            |row: usize, column: usize| directions.iter().map(|way| way[row] * way[column]).sum::<f64>();
        std::array::from_fn::<_, 9, _>(|place| entry(place / 3, place % 3))
    };
    let elsewhere: Vec<f64> = case.position.iter().map(|position| 0.3 * position + 1.0).collect();
    let (here, elsewhere) = (at(&case.position), at(&elsewhere));
    let far = |a: [f64; 9], b: [f64; 9]| a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1e-12);
    let diagonal = |squares: [f64; 3]| {
        std::array::from_fn(|place| if place % 4 == 0 { squares[place / 4] } else { 0.0 })
    };
    match case.interpreter.squares() {
        Some(squares) => {
            let told = diagonal(squares);
            prop_assert!(!far(told, here) && !far(told, elsewhere), "{told:?}: {here:?}, {elsewhere:?}");
        }
        None => {
            let alone = diagonal([here[0], here[4], here[8]]);
            let varies = case.interpreter.directions_vary();
            prop_assert!(!varies || far(alone, here) || far(here, elsewhere), "nothing is told of {here:?}");
        }
    }
    Ok(())
}

/// The exact machine: what the first order leaves quarters when all errors are halved.
///
/// With f(s) the exact tip at errors s times the given ones, r(s) = f(s) - f(0) - s E. Taylor's series of f leaves
/// `|r(1/2) - r(1)/4| <= M (1/48 + 1/24)`, M being the bound of the third derivative, and `|r(1)| <= N / 2`, N being that of
/// the second. A lever that is wrong by a thousandth of a mm is more than either.
pub(crate) fn remainder_is_of_second_order(case: &Case<'_>, seed: u64) -> Result<(), TestCaseError> {
    let errors = case.errors(seed);
    let first = case.interpreter.error(&case.position, &case.travel, &errors);
    let rest = exact::tip(case.machine, &case.state);
    let remainder = |scale: f64| {
        let tip = exact::tip(case.machine, &case.with(&errors, scale));
        case.sensitive(std::array::from_fn(|axis| tip[axis] - rest[axis] - scale * first[axis]))
    };
    let sizes = Sizes::of(case.machine, &case.with(&errors, 1.0));
    let (whole, half) = (remainder(1.0), remainder(0.5));
    for axis in 0..3 {
        let defect = (half[axis] - whole[axis] / 4.0).abs();
        let allowed = sizes.third() / 16.0 + sizes.rounding();
        prop_assert!(defect <= allowed, "direction {axis}: {defect:e} > {allowed:e}, of {:e}", whole[axis]);
        let allowed = sizes.second() / 2.0 + sizes.rounding();
        prop_assert!(whole[axis].abs() <= allowed, "direction {axis}: {:e} > {allowed:e}", whole[axis]);
    }
    Ok(())
}

/// The rotation of the tool, motion by motion, against the exact machine.
///
/// One error motion alone turns the tool about one direction that stays, by its own value times a factor: nothing is left
/// over however large it is, and a thousandth of a rad is far above the rounding of 1e-16 that is divided by it.
pub(crate) fn turns_are_those_of_the_exact_machine(case: &Case<'_>) -> Result<(), TestCaseError> {
    const ANGLE: f64 = 1e-3;
    let turns = case.interpreter.turns(&case.position, &case.travel);
    prop_assert_eq!(turns.len(), case.equations.motions.len());
    for (motion, turn) in case.equations.motions.iter().zip(turns) {
        let errors = BTreeMap::from([(motion.name.clone(), ANGLE)]);
        let exact = exact::turn_by_errors(case.machine, &State { errors, ..case.state.clone() });
        same(&motion.name, turn, exact.map(|angle| angle / ANGLE), 1.0)?;
    }
    Ok(())
}

/// All angles together: the product of two of them is what the first order leaves.
pub(crate) fn turns_add(case: &Case<'_>, seed: u64) -> Result<(), TestCaseError> {
    let errors = case.errors(seed);
    let turns = case.interpreter.turns(&case.position, &case.travel);
    let exact = exact::turn_by_errors(case.machine, &case.with(&errors, 1.0));
    let angles = Sizes::of(case.machine, &case.with(&errors, 1.0)).angles;
    for axis in 0..3 {
        let sum: f64 = turns.iter().zip(&errors).map(|(turn, error)| turn[axis] * error).sum();
        let (defect, allowed) = ((sum - exact[axis]).abs(), angles.powi(2) + 1e-13);
        prop_assert!(defect <= allowed, "about {axis}: {defect:e} > {allowed:e}");
    }
    Ok(())
}

/// The direction of the tool where the file asks for it: without errors, motion by motion, and with all of them.
///
/// One angle `e` alone turns the tool about one direction that stays. The directions at `e` and `-e` differ by `2 sin(e)` times the
/// derivative, however large it is. With all angles together the product of two of them is left over.
pub(crate) fn the_tool_points_as_the_exact_machine(case: &Case<'_>, seed: u64) -> Result<(), TestCaseError> {
    const ANGLE: f64 = 1e-3;
    let pointed = |errors: BTreeMap<String, f64>| {
        exact::direction(case.machine, &State { errors, ..case.state.clone() })
    };
    let there = case.interpreter.direction(&case.position).expect("a file that asks for the direction");
    same("direction", there, pointed(BTreeMap::new()), 1.0)?;
    let error = |motions: &[f64]| {
        let found = case.interpreter.direction_error(&case.position, &case.travel, motions);
        found.expect("a file that asks for the direction")
    };
    let alone = |name: &str| {
        let [ahead, behind] =
            [ANGLE, -ANGLE].map(|angle| pointed(BTreeMap::from([(name.to_owned(), angle)])));
        std::array::from_fn(|part| (ahead[part] - behind[part]) / (2.0 * ANGLE.sin()))
    };
    for (number, motion) in case.equations.motions.iter().enumerate() {
        let mut motions = vec![0.0; case.equations.motions.len()];
        motions[number] = 1.0;
        same(&motion.name, error(&motions), alone(&motion.name), 1.0)?;
    }
    for motion in &case.equations.unseen {
        same(&motion.name, [0.0; 3], alone(&motion.name), 1.0)?;
    }
    let errors = case.errors(seed);
    let (first, real) = (error(&errors), exact::direction(case.machine, &case.with(&errors, 1.0)));
    let angles = Sizes::of(case.machine, &case.with(&errors, 1.0)).angles;
    let across: f64 = first.iter().zip(there).map(|(error, direction)| error * direction).sum();
    prop_assert!(across.abs() <= 1e-13 * (1.0 + angles), "the length changes by {across:e}");
    for part in 0..3 {
        let (defect, allowed) =
            ((real[part] - there[part] - first[part]).abs(), angles.powi(2) / 2.0 + 1e-13);
        prop_assert!(defect <= allowed, "part {part}: {defect:e} > {allowed:e}");
    }
    Ok(())
}

/// The product of finite matrices against the oracle's, number by number, with errors a hundred times what machines have.
pub(crate) fn the_product_is_the_exact_machine(case: &Case<'_>, seed: u64) -> Result<(), TestCaseError> {
    let errors: Vec<f64> = case.errors(seed).iter().map(|error| 100.0 * error).collect();
    let real = case.with(&errors, 1.0);
    let (tip, rest) = (exact::tip(case.machine, &real), exact::tip(case.machine, &case.state));
    let tip = case.sensitive(std::array::from_fn(|axis| tip[axis] - rest[axis]));
    let found = case.displaced(&errors);
    for (found, expected) in found.tip.iter().zip(tip) {
        let (found, allowed) = (found[0], Sizes::of(case.machine, &real).rounding());
        prop_assert!((found - expected).abs() <= allowed, "{found} is not {expected} within {allowed:e}");
    }
    let turn = exact::turn_by_errors(case.machine, &real);
    for (found, expected) in found.turn.iter().flatten().zip(turn) {
        prop_assert!((found[0] - expected).abs() <= 1e-12, "turned by {}, not by {expected}", found[0]);
    }
    Ok(())
}

fn same(what: &str, found: [f64; 3], expected: [f64; 3], size: f64) -> Result<(), TestCaseError> {
    for (found, expected) in found.into_iter().zip(expected) {
        let near = (found - expected).abs() <= RELATIVE * size;
        prop_assert!(near, "{what}: {found} is not {expected} (of size {size})");
    }
    Ok(())
}

fn all_laws(machine: &Machine, text: &str, seed: u64) -> Result<(), TestCaseError> {
    let equations = compiled(text);
    let case = Case::new(machine, &equations, state(machine, seed));
    agrees_with_dual_numbers(&case, seed)?;
    nothing_seen_is_missing(&case)?;
    directions_are_derivatives(&case)?;
    squares_are_those_of_the_directions(&case)?;
    turns_are_those_of_the_exact_machine(&case)?;
    turns_add(&case, seed)?;
    the_product_is_the_exact_machine(&case, seed)?;
    remainder_is_of_second_order(&case, seed)?;
    laws_of_the_direction(machine, text, seed)
}

/// The laws of a machine that derives the direction of its tool; those of the tip hold for it as well.
fn laws_of_the_direction(machine: &Machine, text: &str, seed: u64) -> Result<(), TestCaseError> {
    let equations = compiled(&asking(text));
    let case = Case::new(machine, &equations, state(machine, seed));
    agrees_with_dual_numbers(&case, seed)?;
    the_tool_points_as_the_exact_machine(&case, seed)
}

/// A machine file that asks for the direction of the tool.
pub(crate) fn asking(text: &str) -> String {
    let asks = text.lines().any(|line| line.starts_with("orientation:"));
    if asks { text.to_owned() } else { format!("{text}orientation: true\n") }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_chains(machine in machines(), declare in any::<bool>(), seed in any::<u64>()) {
        let text = yaml::text(&machine, declare);
        all_laws(&machine, &text, seed).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
    }

    /// The tool points in any direction, as the constants of a tool have it.
    #[test]
    fn random_tools_that_point_elsewhere(machine in machines(), declare in any::<bool>(), seed in any::<u64>()) {
        let machine = Machine { pointing: true, ..machine };
        let text = yaml::text(&machine, declare);
        laws_of_the_direction(&machine, &text, seed)
            .map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
    }

    #[test]
    fn random_topology_words(word in words(), seed in any::<u64>(), relative in any::<bool>(), bed in any::<bool>()) {
        let machine = Machine { relative, bed, ..of_word(&word) };
        let motions = if relative { "relative" } else { "body" };
        let reference = if bed { "bed" } else { "carriage" };
        let text = format!("abbe: 1\nname: word\nmotions: {motions}\nreference: {reference}\ntopology: {word}\n");
        all_laws(&machine, &text, seed).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
    }
}

/// The six motions, alignments and directions of every word of up to three axes, each at one point.
#[test]
fn every_short_topology_word() {
    for word in every_word(3) {
        let machine = of_word(&word);
        let text = format!("abbe: 1\nname: word\ntopology: {word}\n");
        all_laws(&machine, &text, 7).unwrap_or_else(|error| panic!("{word}: {error}"));
    }
}

#[test]
fn every_shipped_machine() {
    for shipped in SHIPPED {
        let equations = compiled(&shipped.text());
        let machine = (shipped.described)();
        for seed in 0..20 {
            let case = Case::new(&machine, &equations, state(&machine, seed));
            let laws = agrees_with_dual_numbers(&case, seed)
                .and_then(|()| nothing_seen_is_missing(&case))
                .and_then(|()| directions_are_derivatives(&case))
                .and_then(|()| squares_are_those_of_the_directions(&case))
                .and_then(|()| turns_are_those_of_the_exact_machine(&case))
                .and_then(|()| turns_add(&case, seed))
                .and_then(|()| remainder_is_of_second_order(&case, seed))
                .and_then(|()| laws_of_the_direction(&machine, &shipped.text(), seed));
            laws.unwrap_or_else(|error| panic!("{}: {error}", shipped.name));
        }
    }
}

/// Every topology word of up to so many axes: each order of distinct letters, with F at each place.
pub(crate) fn every_word(axes: usize) -> Vec<String> {
    let mut orders = vec![String::new()];
    let mut words = Vec::new();
    for _ in 0..axes {
        orders = orders
            .iter()
            .flat_map(|order| {
                "XYZABC"
                    .chars()
                    .filter(|letter| !order.contains(*letter))
                    .map(move |letter| format!("{order}{letter}"))
            })
            .collect();
        for order in &orders {
            words.extend((0..=order.len()).map(|bed| format!("{}F{}", &order[..bed], &order[bed..])));
        }
    }
    words
}
