//! The product of finite matrices, in numbers. In: machines whose finite errors can be told by hand, and random topology words.
//! Out: what they do to the tool, and that the equations are its first order. `tests/agreement.rs` of the workspace holds it
//! against matrices that share no code with it.

#![expect(
    clippy::unwrap_used,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_model_dsl::diagnostic::Diagnostics;
use abbe_model_dsl::equations::Equations;
use abbe_model_dsl::exact::{Columns, Displaced, ExactProduct};
use abbe_model_dsl::program::Interpreter;
use abbe_model_dsl::source::SourceFile;
use abbe_model_dsl::{compile, compile_word};
use abbe_runtime::Kinematics;
use proptest::prelude::*;

fn word(word: &str) -> Equations {
    compile_word(word, &mut Diagnostics::new()).unwrap().equations
}

/// The numbers of an axis's letter, or a motion's name; 0 where not given.
fn named(values: &[(&str, f64)], name: &str) -> f64 {
    values.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, value)| *value)
}

/// One row by names.
fn at(equations: &Equations, constants: &[f64], values: &[(&str, f64)]) -> ([f64; 3], [f64; 3]) {
    let position: Vec<f64> = equations.axes.iter().map(|axis| named(values, &axis.letter)).collect();
    let motions: Vec<f64> = equations.motions.iter().map(|motion| named(values, &motion.name)).collect();
    let travel: Vec<f64> = equations.travels.iter().map(|travel| named(values, &travel.name)).collect();
    row(&ExactProduct::new(equations, constants), &position, &travel, &motions)
}

fn row(exact: &ExactProduct, position: &[f64], travel: &[f64], motions: &[f64]) -> ([f64; 3], [f64; 3]) {
    let columns = |values: &[f64]| -> Vec<Vec<f64>> { values.iter().map(|value| vec![*value]).collect() };
    let (positions, travels, motions) = (columns(position), columns(travel), columns(motions));
    let found = run(exact, &positions, &travels, &motions.into_iter().map(Some).collect::<Vec<_>>());
    let first = |columns: &[Vec<f64>; 3]| columns.each_ref().map(|column| column[0]);
    (first(&found.tip), first(found.turn.as_ref().unwrap()))
}

fn run(
    exact: &ExactProduct,
    positions: &[Vec<f64>],
    travels: &[Vec<f64>],
    motions: &[Option<Vec<f64>>],
) -> Displaced {
    let positions: Vec<&[f64]> = positions.iter().map(Vec::as_slice).collect();
    let travels: Vec<&[f64]> = travels.iter().map(Vec::as_slice).collect();
    let motions: Vec<Option<&[f64]>> = motions.iter().map(Option::as_deref).collect();
    exact.displaced(&Columns { positions: &positions, travels: &travels, motions: &motions }, true)
}

#[track_caller]
fn near(found: [f64; 3], expected: [f64; 3], within: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!((found - expected).abs() <= within, "{found:?} is not {expected:?}");
    }
}

/// A line of 200 mm that is turned by 5 mrad ends 2.5 um short of where it would.
#[test]
fn a_turned_line_is_as_long_as_before() {
    let angle = 5e-3_f64;
    let expected = [-200.0 * angle.sin(), 200.0 * (angle.cos() - 1.0), 0.0];
    for mill in ["FXYZ", "XFYZ", "XYFZ", "XYZF"] {
        let (tip, turn) = at(&word(mill), &[0.0, 0.0, 120.0], &[("Y", 200.0), ("EC0Y", angle)]);
        near(tip, expected, 1e-13);
        assert_eq!(turn, [0.0; 3], "the carriage does not turn with its line");
    }
}

/// Two yaws, one on the other, add; the tip goes round by both.
#[test]
fn rotations_about_one_direction_add() {
    let (one, other) = (2e-3_f64, -0.7_f64);
    let mill = word("FXYZ");
    let (tip, turn) = at(&mill, &[30.0, 40.0, 0.0], &[("ECX", one), ("ECY", other)]);
    let (sine, cosine) = (one + other).sin_cos();
    near(tip, [30.0 * cosine - 40.0 * sine - 30.0, 30.0 * sine + 40.0 * cosine - 40.0, 0.0], 1e-13);
    near(turn, [0.0, 0.0, one + other], 1e-15);
}

/// A scale of a slide acts along the line as the carriage before it has turned.
#[test]
fn a_displacement_goes_along_the_turned_frame() {
    let yaw = 1e-3_f64;
    let (tip, _) = at(&word("FXY"), &[0.0; 3], &[("Y", 300.0), ("ECX", yaw), ("EYY", 0.05)]);
    near(tip, [-300.05 * yaw.sin(), 300.05 * yaw.cos() - 300.0, 0.0], 1e-13);
}

/// A part that its table has turned too far sees the tool turned back, about the table's own axis.
#[test]
fn a_rotary_table_turned_too_far() {
    let (angle, error) = (0.8_f64, 3e-3_f64);
    let table = word("CFX");
    let (tip, turn) = at(&table, &[0.0; 3], &[("X", 100.0), ("C", angle), ("ECC", error)]);
    // `along` is minus on the part's branch, and ECC is actual minus commanded: the part turns by minus both.
    let seen = |angle: f64| [100.0 * angle.cos(), 100.0 * angle.sin(), 0.0];
    let (nominal, real) = (seen(angle), seen(angle + error));
    near(tip, [real[0] - nominal[0], real[1] - nominal[1], 0.0], 1e-12);
    near(turn, [0.0, 0.0, error], 1e-15);
}

/// What is not sensitive has no error, a free travel stands in the lever for the position, and what a column lacks is no number.
#[test]
fn sensitive_directions_and_travels() {
    let text = "abbe: 1\nname: stage\nsensitive: [X, Z]\nchain: {tool: [{slide: X, along: +X, errors: \
                {EB0X: {travel: dx}, EC0X: {}}}, {slide: Z, along: +Z}, {tool: tip}]}\n";
    let stage = compile(&SourceFile::new("stage.yaml", text), &mut Diagnostics::new()).unwrap().equations;
    let (tip, _) = at(&stage, &[], &[("X", 300.0), ("dx", 100.0), ("EB0X", 0.01), ("ECZ", 1.0)]);
    near(tip, [100.0 * (0.01_f64.cos() - 1.0), 0.0, -100.0 * 0.01_f64.sin()], 1e-13);
    let exact = ExactProduct::new(&stage, &[]);
    let motions = vec![Some(vec![1e-3; 2]); stage.motions.len()];
    let found = run(&exact, &[vec![1.0; 2], vec![2.0; 2]], &[vec![3.0]], &motions);
    assert!(found.tip[2].len() == 2 && found.tip[2][0].is_finite() && found.tip[2][1].is_nan());
    assert_eq!(found.tip[1], [0.0; 2]);
}

/// Motions that are nothing everywhere may be left out, and rows do not see each other.
#[test]
fn columns_are_their_rows() {
    let mill = word("BXFYZA");
    let exact = ExactProduct::new(&mill, &[10.0, -20.0, 120.0]);
    let value = |row: usize, number: usize| 1e-3 * ((7 * row + 3 * number) as f64).sin();
    let column = |number: usize| -> Vec<f64> { (0..9).map(|row| value(row, number)).collect() };
    let positions: Vec<Vec<f64>> = (0..mill.axes.len())
        .map(|axis| {
            column(axis + 50)
                .into_iter()
                .map(|value| value * if mill.axes[axis].rotary { 1e3 } else { 1e5 })
                .collect()
        })
        .collect();
    let motions: Vec<Option<Vec<f64>>> =
        (0..mill.motions.len()).map(|number| (number % 3 != 0).then(|| column(number))).collect();
    let all = run(&exact, &positions, &[], &motions);
    for number in 0..9 {
        let position: Vec<f64> = positions.iter().map(|column| column[number]).collect();
        let errors: Vec<f64> =
            motions.iter().map(|column| column.as_ref().map_or(0.0, |column| column[number])).collect();
        let (tip, turn) = row(&exact, &position, &[], &errors);
        near(tip, all.tip.each_ref().map(|column| column[number]), 1e-13);
        near(turn, all.turn.as_ref().unwrap().each_ref().map(|column| column[number]), 1e-15);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// The equations are the first order of the product: what they leave quarters where all errors are halved.
    #[test]
    fn what_the_equations_leave_is_of_second_order(
        letters in Just(vec!['X', 'Y', 'Z', 'A', 'B', 'C']).prop_shuffle(),
        (count, bed) in (1..=6_usize).prop_flat_map(|count| (Just(count), 0..=count)),
        numbers in prop::collection::vec(-1.0..1.0_f64, 97),
    ) {
        let mut letters: Vec<char> = letters.into_iter().take(count).collect();
        letters.insert(bed, 'F');
        let machine = word(&letters.into_iter().collect::<String>());
        let mut stream = numbers.iter().copied().cycle();
        let mut take = |size: f64| size * stream.next().unwrap();
        let constants: Vec<f64> = machine.constants.iter().map(|_| take(300.0)).collect();
        let position: Vec<f64> =
            machine.axes.iter().map(|axis| take(if axis.rotary { 3.0 } else { 500.0 })).collect();
        let errors: Vec<f64> =
            machine.motions.iter().map(|motion| take(if motion.angular { 1e-4 } else { 0.05 })).collect();
        let interpreter = Interpreter::new(&machine, &constants);
        let exact = ExactProduct::new(&machine, &constants);
        let turns = interpreter.turns(&position, &[]);
        let left = |scale: f64| {
            let errors: Vec<f64> = errors.iter().map(|error| scale * error).collect();
            let (tip, turn) = row(&exact, &position, &[], &errors);
            let first = interpreter.error(&position, &[], &errors);
            let turned = |d: usize| turns.iter().zip(&errors).map(|(turn, error)| turn[d] * error).sum::<f64>();
            [0, 1, 2, 3, 4, 5].map(|d| if d < 3 { tip[d] - first[d] } else { turn[d - 3] - turned(d - 3) })
        };
        let (whole, half) = (left(1.0), left(0.5));
        // Angles of 36 motions add up to 4 mrad at most, lengths to 2 m: the third order is below their product over 6,
        // and the second below half of what two angles make of them.
        let (angles, lengths): (f64, f64) = (36.0 * 1e-4, 2400.0);
        for d in 0..6 {
            let size = if d < 3 { lengths + 300.0 } else { 1.0 };
            prop_assert!((half[d] - whole[d] / 4.0).abs() <= size * angles.powi(3), "{}: {} {}", d, whole[d], half[d]);
            prop_assert!(whole[d].abs() <= size * angles.powi(2), "{}: {}", d, whole[d]);
        }
    }
}
