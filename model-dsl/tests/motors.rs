//! Motors by hand. In: machine files with crossed belts and with beams, whose lever arms can be written down at once. Out: the same from the
//! compiler, and the errors of files that say something else.

#![expect(
    clippy::unwrap_used,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_model_dsl::algebra::Axis;
use abbe_model_dsl::compile;
use abbe_model_dsl::diagnostic::{Diagnostics, render};
use abbe_model_dsl::equations::Equations;
use abbe_model_dsl::program::Interpreter;
use abbe_model_dsl::sheet::infix;
use abbe_model_dsl::source::SourceFile;
use abbe_runtime::Kinematics;

fn source(rest: &str) -> SourceFile {
    SourceFile::new("machine.yaml", format!("abbe: 1\nname: machine\n{rest}"))
}

fn derived(rest: &str) -> Equations {
    let source = source(rest);
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&source, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{}", render(&source, &diagnostics, false));
    compiled.unwrap().equations
}

/// The lever arms of a motion in X, Y and Z.
fn arms(equations: &Equations, name: &str) -> [String; 3] {
    let motion = equations.motions.iter().position(|motion| motion.name == name).unwrap();
    Axis::ALL.map(|direction| infix(&equations.arm(direction, motion)))
}

/// The codes of a file that is wrong, each with the text that it marks.
fn refused(rest: &str) -> Vec<(&'static str, String)> {
    let source = source(rest);
    let mut diagnostics = Diagnostics::new();
    assert!(compile(&source, &mut diagnostics).is_none(), "{rest}");
    let marked = |span: abbe_model_dsl::source::Span| source.text()[span.start..span.end].trim().to_owned();
    diagnostics.iter().map(|found| (found.code, marked(found.span))).collect()
}

/// A beam along X on slide Y that carries X and Z, its drives at these places; `rest` goes with the slide.
fn gantry(drives: &str, rest: &str) -> String {
    format!(
        "chain:\n  tool:\n    - slide: Y\n      along: +Y\n      drives: {drives}\n{rest}    - slide: X\n      along: +X\n    - \
         slide: Z\n      along: +Z\n    - tool: tip\n      offset: [Xt, 0, 0]\n"
    )
}

/// A = X + Y and B = X - Y: half of each error goes with X, and half of it, or its opposite, with Y.
#[test]
fn errors_behind_crossed_belts_go_with_both_slides() {
    let printer = derived("topology: FXYZ\ntransmission: {A: X + Y, B: X - Y}\n");
    assert_eq!(arms(&printer, "EA"), ["0.5", "0.5", "0"]);
    assert_eq!(arms(&printer, "EB"), ["0.5", "-0.5", "0"]);
    let letters: Vec<&str> = printer.axes.iter().map(|axis| axis.letter.as_str()).collect();
    assert_eq!(letters, ["X", "Y", "Z", "A", "B"]);
}

/// A table that runs -Y for +Y is behind the same belts: positioning is counted along, so that the arm stays.
#[test]
fn a_table_that_runs_the_other_way_keeps_the_sense_of_its_motors() {
    let printer = derived("topology: YFXZ\ntransmission: {A: X + Y, B: X - Y}\n");
    assert_eq!(
        arms(&printer, "EA"),
        arms(&derived("topology: FXYZ\ntransmission: {A: X + Y, B: X - Y}\n"), "EA")
    );
}

/// A = 2 X, B = X + 3 Z: X = A/2, Z = (B - A/2)/3.
#[test]
fn any_map_of_fractions_is_inverted_exactly() {
    let machine = derived("topology: FXYZ\ntransmission: {A: 2*X, B: X + 3*Z}\n");
    assert_eq!(arms(&machine, "EA"), ["0.5", "0", "-1/6"]);
    assert_eq!(arms(&machine, "EB"), ["0", "0", "1/3"]);
}

/// Drives at -400 mm and 600 mm: the beam goes 0.6 e1 + 0.4 e2 at its origin, and turns by (e2 - e1)/1000 mm. At x the tool goes in Y by
/// what the straight line through both drives is there; beyond the slides Xt is part of x.
#[test]
fn a_beam_goes_as_the_line_through_its_drives() {
    let machine = derived(&gantry("{Y1: {x: -400 mm}, Y2: {x: 0.6 m}}", ""));
    assert_eq!(arms(&machine, "EY1"), ["0", "-0.001*x - 0.001*Xt + 0.6", "0"]);
    assert_eq!(arms(&machine, "EY2"), ["0", "0.001*x + 0.001*Xt + 0.4", "0"]);
}

/// What the drives correct by themselves: their own error, and the rotation over the lever of each.
#[test]
fn drives_correct_their_own_errors_and_the_rotation_of_the_beam() {
    let machine = derived(&gantry("{Y1: {x: -400 mm}, Y2: {x: 600 mm}}", ""));
    let number = |name: &str| machine.motions.iter().position(|motion| motion.name == name).unwrap();
    let (first, second, turns) = (number("EY1"), number("EY2"), number("ECY"));
    let squaring = machine.squaring();
    let shares: Vec<(usize, usize, f64)> =
        squaring.iter().map(|own| (own.motor, own.of, own.weight)).collect();
    assert_eq!(shares, [(3, turns, -400.0), (3, first, 1.0), (4, turns, 600.0), (4, second, 1.0)]);
    let left = derived(&gantry("{Y1: {x: -400 mm}, Y2: {x: 600 mm}}", "      corrects: false\n"));
    assert!(left.squaring().is_empty());
    assert_eq!(left.following(), machine.following());
}

/// The interpreter says of motors what the equations say.
#[test]
fn the_interpreter_has_the_shares_of_the_equations() {
    let machine = derived("topology: FXYZ\ntransmission: {A: X + Y, B: X - Y}\n");
    let constants = vec![0.0; machine.constants.len()];
    let interpreter = Interpreter::new(&machine, &constants);
    let shares: Vec<(usize, usize, f64)> =
        interpreter.following().iter().map(|share| (share.motor, share.of, share.weight)).collect();
    assert_eq!(shares, [(3, 0, 1.0), (3, 1, 1.0), (4, 0, 1.0), (4, 1, -1.0)]);
}

#[test]
fn a_transmission_that_is_none_is_refused_where_it_is_wrong() {
    for (transmission, code, marked) in [
        ("{A: X + Y, B: 2*X + 2*Y}", "E0149", "A"),
        ("{A: X + Y}", "E0149", "A"),
        ("{A: X*Y, B: X - Y}", "E0149", "X*Y"),
        ("{A: X + 3, B: X - Y}", "E0149", "X + 3"),
        ("{A: X +, B: X - Y}", "E0149", "X +"),
        ("{A: X + V, B: X - Y}", "E0149", "X + V"),
        ("{A: X + C, B: X - Y}", "E0149", "X + C"),
        ("{A: X - X, B: X - Y}", "E0149", "X - X"),
        ("{Y: X + Y, B: X - Y}", "E0148", "Y"),
        ("{XX: X + Y, B: X - Y}", "E0148", "XX"),
        ("{A: X + Y, a: X - Y}", "E0148", "a"),
        ("[A, B]", "E0103", "[A, B]"),
    ] {
        let found = refused(&format!("topology: CFXYZ\ntransmission: {transmission}\n"));
        assert_eq!(found.first(), Some(&(code, marked.to_owned())), "{transmission}: {found:?}");
    }
}

#[test]
fn drives_that_span_no_beam_are_refused_where_they_are_wrong() {
    for (drives, rest, marked) in [
        ("{Y1: {x: 1 mm}}", "", "{Y1: {x: 1 mm}}"),
        ("{Y1: {x: 1 mm}, Y2: {x: 1 mm}}", "", "{Y1: {x: 1 mm}, Y2: {x: 1 mm}}"),
        ("{Y1: {x: 1 mm}, Y2: {z: 2 mm}}", "", "{Y1: {x: 1 mm}, Y2: {z: 2 mm}}"),
        ("{Y1: {x: 1 mm, z: 2 mm}, Y2: {x: 2 mm}}", "", "Y1"),
        ("{Y1: {x: L}, Y2: {x: 2 mm}}", "", "L"),
        ("{Y1: {x: 1 mm}, Y2: {x: 2 mm}}", "      reference: bed\n", "drives"),
        ("Y1", "", "Y1"),
    ] {
        let found = refused(&gantry(drives, rest));
        assert_eq!(found.first(), Some(&("E0150", marked.to_owned())), "{drives}: {found:?}");
    }
    let twice = gantry("{Y1: {x: 1 mm}, Y2: {x: 2 mm}}", "") + "transmission: {A: X + Y, B: X - Y}\n";
    assert_eq!(refused(&twice), [("E0150", "drives".to_owned())]);
    let along = refused(&gantry("{Y1: {y: 1 mm}, Y2: {x: 2 mm}}", ""));
    assert_eq!(along.first(), Some(&("E0101", "y".to_owned())));
}
