//! `abbe compensate` where the direction of the tool is derived. In: small five-axis machines, and numbers worked by hand. Out: the columns of
//! the direction's error, and how far the tool leans without compensation and with it.

use crate::cli::{Run, abbe, column};
use crate::odd_machines::files;

/// Rows, compensated by a calibration of a machine.
fn compensated(name: &str, machine: &str, errors: &str, rows: &str, options: &[&str]) -> Run {
    let known = format!("calibration: 1\nmachine: machine.yaml\n{errors}");
    let known = files(name, &[("known.yaml", &known), ("machine.yaml", machine)]);
    abbe(&[&["compensate", &known], options].concat(), rows)
}

/// A head that swivels on B, over slides that run without error.
const HEAD: &str = "abbe: 1\nname: head\norientation: true\nchain:\n  tool:\n    - {slide: X, along: +X, errors: [EXX, EBX]}\n    - {slide: Z, along: +Z, errors: []}\n    - {rotary: B, along: +B}\n    - {tool: tip, offset: [0, 0, -100]}\n";

fn close(found: &[f64], expected: &[f64]) {
    let away = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs());
    assert!(
        found.len() == expected.len() && away.fold(0.0, f64::max) < 1e-9,
        "{found:?} is not {expected:?}"
    );
}

/// Turned about Y by 40 urad, the tool at angle b leans by (cos b, 0, -sin b) times as much.
#[test]
fn the_error_of_the_direction_stands_behind_that_of_the_tip() {
    let run = compensated("leaning", HEAD, "errors: {EBX: 40 urad}\n", "x,z,b\n0,0,0\n0,0,30\n", &[]);
    assert_eq!(run.status, 0, "{}", run.err);
    let header = "x,z,b,error_x,error_y,error_z,error_i,error_j,error_k,x_comp,z_comp,b_comp\n";
    assert!(run.out.starts_with(header), "{}", run.out);
    close(&column(&run.out, "error_i"), &[40e-6, 40e-6 * 30.0_f64.to_radians().cos()]);
    close(&column(&run.out, "error_j"), &[0.0, 0.0]);
    close(&column(&run.out, "error_k"), &[0.0, -20e-6]);
    // B turns it back; where it is to leave it, it stays.
    close(&column(&run.out, "b_comp"), &[-40e-6_f64.to_degrees(), 30.0 - 40e-6_f64.to_degrees()]);
    let left = HEAD.replace("orientation: true", "orientation: uncorrected");
    let run = compensated("leaning-told", &left, "errors: {EBX: 40 urad}\n", "x,z,b\n0,0,0\n0,0,30\n", &[]);
    close(&column(&run.out, "error_i"), &[40e-6, 40e-6 * 30.0_f64.to_radians().cos()]);
    assert_eq!(column(&run.out, "b_comp"), [0.0, 30.0]);
    let plain = HEAD.replace("orientation: true\n", "");
    let run =
        compensated("leaning-plain", &plain, "errors: {EBX: 40 urad}\n", "x,z,b\n0,0,0\n", &["--summary"]);
    assert!(run.out.starts_with("x,z,b,error_x,error_y,error_z,x_comp,z_comp,b_comp\n"), "{}", run.out);
    assert!(!run.err.contains("arcsec"), "{}", run.err);
}

#[test]
fn the_row_of_units_says_rad() {
    let run = compensated(
        "leaning-units",
        HEAD,
        "errors: {EBX: 40 urad}\n",
        "x,z,b\n#unit,um,in,rad\n0,0,0\n",
        &[],
    );
    assert_eq!(run.status, 0, "{}", run.err);
    assert_eq!(run.out.lines().nth(1), Some("#unit,um,in,rad,mm,mm,mm,rad,rad,rad,um,in,rad"));
}

#[test]
fn a_column_of_that_name_is_one_of_the_output() {
    let run = compensated("leaning-taken", HEAD, "errors: {EBX: 40 urad}\n", "x,z,b,error_i\n0,0,0,0\n", &[]);
    assert_eq!(run.status, 2);
    assert!(run.err.contains("`error_i` has the name of an output column"), "{}", run.err);
}

/// 30 urad of X and 40 urad of B about Y are 70 urad together; B takes its own away where it leaves the direction, and else all. 30 urad are
/// 6.2 arc seconds, 70 urad 14.4.
#[test]
fn a_rotary_axis_corrects_its_own_part_of_the_direction() {
    let errors = "errors: {EBX: 30 urad, EBB: 40 urad}\n";
    let rows = "x,z,b\n0,0,0\n50,0,60\n";
    let run = compensated("leaning-all", HEAD, errors, rows, &["--summary"]);
    assert!(run.err.contains("  with compensation      0.0 to   0.0 arcsec\n"), "{}", run.err);
    let own = HEAD.replace("orientation: true", "orientation: uncorrected");
    let run = compensated("leaning-own", &own, errors, rows, &["--summary"]);
    assert_eq!(run.status, 0, "{}", run.err);
    let told = "Angle of the tool's direction from its target, by the model:\n  without compensation  14.4 to  14.4 arcsec\n  with compensation      6.2 to   6.2 arcsec\n";
    assert!(run.err.contains(told), "{}", run.err);
    let left = HEAD.replace("along: +B}", "along: +B, corrects: false}");
    let run = compensated("leaning-left", &left, errors, "x,z,b\n0,0,0\n", &["--summary"]);
    assert!(run.err.contains("  with compensation     14.4 to  14.4 arcsec\n"), "{}", run.err);
}

/// B lags by 10 urad; after it turns back the tool leans by as much the other way. A quarter of the ramp later a quarter of these 20 urad is
/// corrected: 15 urad are left, 3.1 arc seconds.
#[test]
fn what_a_ramp_leaves_for_later_is_told() {
    let errors = "errors: {EBB: [{backlash: {lost_motion: 20 urad, ramp: 4 s}}]}\n";
    let run =
        compensated("leaning-ramp", HEAD, errors, "t,x,z,b\n0,0,0,0\n1,0,0,10\n2,0,0,9\n", &["--summary"]);
    assert_eq!(run.status, 0, "{}", run.err);
    let told = "  without compensation   2.1 to   2.1 arcsec\n  with compensation      0.0 to   3.1 arcsec\n";
    assert!(run.err.contains(told), "{}", run.err);
}

/// A rotation about the tip itself has no lever there, and is seen all the same.
#[test]
fn what_only_turns_the_tool_is_told() {
    let machine = HEAD.replace("offset: [0, 0, -100]", "offset: [0, 0, 0]");
    let errors = "errors: {EAB: 20 urad}\n";
    let run = compensated("turning-only", &machine, errors, "x,z,b\n0,0,0\n", &["--summary"]);
    assert_eq!(run.status, 0, "{}", run.err);
    close(&column(&run.out, "error_j"), &[-20e-6]);
    assert!(!run.err.contains("W0402"), "{}", run.err);
    assert!(
        run.err.contains("leave up to 4.1 arcsec of the error of the tool's direction in 1 row"),
        "{}",
        run.err
    );
    assert!(run.err.contains("  with compensation      4.1 to   4.1 arcsec\n"), "{}", run.err);
}

/// Terms that remember are followed from row to row as those of the tip are, rows that were left out among them.
#[test]
fn what_a_term_remembers_turns_the_tool_too() {
    let wound = "EBX: [{backlash: {lost_motion: 20 urad, wind_up: 2 mm}}]";
    let errors = format!(
        "limits: {{compensation: 0.1 mm}}\nerrors: {{EXX: [{{table: {{axis: X, at: [0 mm, 9 mm], unit: mm, values: [0, 0.5]}}}}], {wound}}}\n"
    );
    let rows = "x,z,b\n0,0,0\n1,0,0\n9,0,0\n8.5,0,0\n0.5,0,0\n";
    let run = compensated("leaning-wound", HEAD, &errors, rows, &["--skip-bad"]);
    assert_eq!(run.status, 0, "{}", run.err);
    // Forwards -10 urad, and the other way over 2 mm once it turns; at 9 and 8.5 mm the correction of EXX is over the limit.
    let all = compensated("leaning-wound-all", HEAD, &format!("errors: {{{wound}}}\n"), rows, &[]);
    let (some, all) = (column(&run.out, "error_i"), column(&all.out, "error_i"));
    assert_eq!(some, [all[0], all[1], all[4]], "{}", run.out);
    assert!(all[1] < all[3] && all[3] < all[4] && (all[4] - 10e-6).abs() < 1e-9, "{all:?}");
}

/// What the direction is wrong by does not depend on the tool, nor on where a free travel begins.
#[test]
fn tools_and_travels_leave_the_direction_as_it_is() {
    let machine = HEAD
        .replace("errors: [EXX, EBX]", "errors: {EBX: EBX, EB0X: {travel: dx, rotates: true}}")
        .replace("-100", "L");
    let errors =
        "constants: {L: -100 mm}\ntools: {long: {L: -300 mm}}\nerrors: {EBX: 30 urad, EB0X: 10 urad}\n";
    let rows = "x,z,b,dx,tool\n0,0,0,0,\n5,0,0,50,long\n";
    let run = compensated("leaning-tools", &machine, errors, rows, &[]);
    assert_eq!(run.status, 0, "{}", run.err);
    close(&column(&run.out, "error_i"), &[40e-6, 40e-6]);
    close(&column(&run.out, "error_x"), &[-4e-3, -12e-3]);
}

/// The same head, whose tools point in several ways.
fn with_tools(name: &str, tools: &str, rows: &str) -> Run {
    let machine = HEAD.replace("offset: [0, 0, -100]", "offset: [Xt, Yt, Zt], direction: [It, Jt, Kt]");
    let known =
        format!("constants: {{Xt: 0 mm, Yt: 0 mm, Zt: -100 mm}}\ntools: {tools}\nerrors: {{EBX: 40 urad}}\n");
    compensated(name, &machine, &known, rows, &[])
}

/// Turned about Y by e, a tool along X leans by -e in Z and its tip at (-100, 0, 0) goes up by 100 e; a tool along Y does not lean. B turns
/// the direction of the one back and has nothing to do for the other.
#[test]
fn each_tool_leans_as_it_points() {
    let tools =
        "{T1: {}, T2: {direction: [1, 0, 0]}, T3: {direction: [0, -2, 0]}, T4: {turned: {B: 90 deg}}}";
    let run =
        with_tools("tools-that-point", tools, "x,z,b,tool\n0,0,0,\n0,0,0,T1\n0,0,0,T2\n0,0,0,T3\n0,0,0,T4\n");
    assert_eq!(run.status, 0, "{}", run.err);
    let e = 40e-6;
    close(&column(&run.out, "error_i"), &[e, e, 0.0, 0.0, 0.0]);
    close(&column(&run.out, "error_j"), &[0.0; 5]);
    close(&column(&run.out, "error_k"), &[0.0, 0.0, -e, 0.0, -e]);
    close(&column(&run.out, "error_x"), &[-100.0 * e, -100.0 * e, -100.0 * e, -100.0 * e, 0.0]);
    close(&column(&run.out, "error_z"), &[0.0, 0.0, 0.0, 0.0, 100.0 * e]);
    let back = -e.to_degrees();
    close(&column(&run.out, "b_comp"), &[back, back, back, 0.0, back]);
}

/// Without names for the direction a tool that says where it points is refused where it says so.
#[test]
fn a_tool_that_points_needs_a_machine_that_lets_it() {
    let known = "tools: {T5: {direction: [0, 1, 0]}}\nerrors: {EBX: 40 urad}\n";
    let run = compensated("tools-that-cannot", HEAD, known, "x,z,b\n0,0,0\n", &[]);
    assert_eq!(run.status, 2, "{}", run.err);
    assert!(run.err.contains("error[E0432]") && run.err.contains("direction: [It, Jt, Kt]"), "{}", run.err);
    assert_eq!(run.out, "");
}
