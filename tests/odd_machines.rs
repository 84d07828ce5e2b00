//! Machines and calibrations with which a program easily goes wrong: a singular pose, a symbol of the other sign, numbers that are not
//! small, what no term reads and what has no lever. In: files written here. Out: what the command line answers.

use std::fs;
use std::path::PathBuf;

use crate::cli::{Run, abbe, column};

/// Files in a folder of the test's own; the path of the first.
pub(crate) fn files(test: &str, files: &[(&str, &str)]) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("odd-machines").join(test);
    fs::create_dir_all(&folder).unwrap();
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
    folder.join(files[0].0).to_str().unwrap().to_owned()
}

fn compensated(calibration: &str, rows: &str, options: &[&str]) -> Run {
    abbe(&[&["compensate", calibration], options].concat(), rows)
}

/// A wheelhead with an infeed slide W on a swivel B on a cross slide X: at B = 90 degrees W moves the wheel along X, as X does.
const SWIVEL: &str = "abbe: 1\nname: swivel\nsensitive: [X, Z]\nchain:\n  tool:\n    - {slide: X, along: +X}\n    - {rotary: B, along: +B}\n    - {slide: W, along: +W}\n    - {tool: wheel}\n";

#[test]
fn near_a_singular_pose_the_reason_is_told_and_nothing_moves_far() {
    let known = "calibration: 1\nmachine: swivel.yaml\nerrors: {EZX: 10 um}\n";
    let known = files("singular", &[("known.yaml", known), ("swivel.yaml", SWIVEL)]);
    let run = compensated(&known, "x,b,w\n100,30,10\n100,89.99,10\n", &["--summary"]);
    assert_eq!(run.status, 1, "{}", run.err);
    assert!(run.err.contains("row 2 under the header"), "{}", run.err);
    assert!(run.err.contains("times as far as the tip: here"), "{}", run.err);
    let rows = "x,b,w\n100,30,10\n100,89.99,10\n100,89.999,10\n100,90,10\n100,85,10\n";
    let run = compensated(&known, rows, &["--skip-bad", "--summary"]);
    assert_eq!(run.status, 0, "{}", run.err);
    assert_eq!(column(&run.out, "b"), [30.0, 90.0, 85.0]);
    // In the pose itself the error stays.
    assert!(run.err.contains("with compensation      0.0 to  10.0 um"), "{}", run.err);
    assert_eq!(column(&run.out, "x_comp")[1], 100.0);
}

#[test]
fn a_name_has_one_sense_whatever_its_symbol() {
    let machine = |detail: &str| {
        format!(
            "abbe: 1\nname: d\nchain:\n  tool:\n    - {{slide: X, along: +X, errors: {{EB0X: {detail}}}}}\n    - {{tool: tip}}\n"
        )
    };
    let known = "calibration: 1\nmachine: d.yaml\nerrors: {EB0X: 10 urad}\n";
    let mut told = Vec::new();
    for (test, detail) in [("plain", "ao"), ("turned", "{symbol: ao, sign: -1}")] {
        let calibration = files(test, &[("known.yaml", known), ("d.yaml", &machine(detail))]);
        let run = compensated(&calibration, "x\n200\n", &[]);
        told.push(column(&run.out, "error_z")[0]);
        let file = calibration.replace("known.yaml", "d.yaml");
        let iso = abbe(&["derive", &file, "--names", "iso"], "").out;
        assert!(iso.contains("dPz = -x*EB0X"), "{iso}");
        let symbols = abbe(&["derive", &file], "").out;
        assert!(symbols.contains(if test == "plain" { "dPz = -x*ao" } else { "dPz = x*ao" }), "{symbols}");
    }
    // +X travel goes towards -Z.
    assert_eq!(told, [-0.002, -0.002]);
    let without = files("nameless", &[("d.yaml", &machine("{sign: -1}"))]);
    let run = abbe(&["derive", &without], "");
    assert_eq!(run.status, 2, "{}", run.err);
    assert!(run.err.contains("error[E0142]"), "{}", run.err);
}

#[test]
fn an_error_motion_that_is_not_small_is_no_error_motion() {
    let known = "calibration: 1\nmachine: FXYZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors:\n  EC0Y: 45 deg\n  EBX: 3 rad\n";
    let run = compensated(&files("large", &[("known.yaml", known)]), "x,y,z\n1,2,3\n", &[]);
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert_eq!(run.err.matches("error[E0430]").count(), 2, "{}", run.err);
}

/// What grows beyond what is small within any 20 mm or 20 degC is refused where it is read; a long machine's curve about a far place, whose
/// coefficients are large at its zero, is not.
#[test]
fn an_error_motion_that_does_not_stay_small_is_none_either() {
    let of = |errors: &str| {
        let known = format!(
            "calibration: 1\nmachine: FXYZ\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}}\nerrors:\n{errors}"
        );
        compensated(&files("growing", &[("known.yaml", &known)]), "x,y,z,T_s\n5600,2,3,21\n", &[])
    };
    for large in [
        "  EBX: [{polynomial: {axis: X, unit: deg, per: mm, coefficients: [0, 1]}}]\n",
        "  EBX: [{polynomial: {axis: X, unit: deg, per: mm, coefficients: [3, 0]}}]\n",
        "  EBX: [{coupling: {axis: Y, unit: rad, per: mm, coefficients: [0.01]}}]\n",
        "  EBX: [{growth: {sensor: s, coefficient: 1 deg/K, reference: 20 degC, time_constant: 10 s}}]\n",
        // 12 um/m with the unit of its coefficient forgotten.
        "  EXX: [{polynomial: {axis: X, unit: mm, per: mm, coefficients: [0, 12]}}]\n",
    ] {
        let run = of(large);
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{large}");
        assert_eq!(run.err.matches("error[E0430]").count(), 1, "{}", run.err);
    }
    // 10 um ((x - 5500 mm)/500 mm)^5, written about zero.
    let far = "  EXX: [{polynomial: {axis: X, unit: um, per: mm, coefficients: \
               [-1610510, 1464.1, -0.5324, 9.68e-5, -8.8e-9, 3.2e-13]}}]\n";
    let run = of(far);
    assert!(run.status == 0 && !run.err.contains("small"), "{}", run.err);
    assert!((column(&run.out, "error_x")[0] - 0.01 * 0.2_f64.powi(5)).abs() < 1e-8, "{}", run.out);
}

/// A rotation that is small where it is read and grows with the place is told of by rows: it is 12 mrad at 120 mm.
#[test]
fn rows_where_an_error_motion_is_not_small_are_counted() {
    let known = "calibration: 1\nmachine: FXYZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors:\n  \
                 EBX: [{polynomial: {axis: X, unit: mrad, per: mm, coefficients: [0, 0.1]}}]\n";
    let known = files("rows", &[("known.yaml", known)]);
    let run = compensated(&known, "x,y,z\n10,0,0\n110,0,0\n120,0,0\n", &[]);
    let told =
        "warning: EBX is up to 12.0 mrad in 2 rows; the equations are of first order, for up to 10 mrad";
    assert!(run.status == 0 && run.err.contains(told), "{}", run.err);
    let inside = compensated(&known, "x,y,z\n99,0,0\n", &[]);
    assert_eq!((inside.status, inside.err.as_str()), (0, ""));
}

/// With the tool along C, C turns its direction nowhere: what stays of that error is told. Tilted by 30 degrees nothing stays.
#[test]
fn a_direction_that_stays_wrong_is_told() {
    let machine = fs::read_to_string(crate::shipped::root().join("machines/trunnion-5axis.yaml")).unwrap();
    let known = "calibration: 1\nmachine: m.yaml\nconstants: {Ya: 0 mm, Za: 0 mm, Xc: 0 mm, Yc: 0 mm, Zc: 0 mm, Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors:\n  EAX: 20 urad\n  EBX: 30 urad\n";
    let known =
        files("parallel", &[("known.yaml", known), ("m.yaml", &format!("{machine}orientation: true\n"))]);
    let at = |a: &str| compensated(&known, &format!("x,y,z,a,c\n0,0,0,{a},0\n"), &[]);
    let parallel = at("0");
    let told =
        "warning: the rotary axes leave up to 6.2 arcsec of the error of the tool's direction in 1 row";
    assert!(parallel.status == 0 && parallel.err.contains(told), "{}", parallel.err);
    assert!(!at("30").err.contains("direction"), "{}", at("30").err);
}

#[test]
fn what_no_term_reads_stops_no_row() {
    let known = "calibration: 1\nmachine: FX\nsensors:\n  body: {mean: [a, b]}\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors: {EXX: 3 um}\n";
    let run = compensated(&files("unread", &[("known.yaml", known)]), "x\n10\n", &[]);
    assert_eq!(run.status, 0, "{}", run.err);
    assert!(run.err.contains("warning[W0401]"), "{}", run.err);
    assert_eq!(column(&run.out, "error_x"), [0.003]);
}

#[test]
fn a_motion_without_a_lever_is_read_and_told() {
    let machine = "abbe: 1\nname: gantry\nchain:\n  tool:\n    - {slide: X, along: +X}\n    - {slide: Y, along: +Y}\n    - {slide: Z, along: +Z}\n    - {tool: tip, offset: [0, 0, -100]}\n";
    let known = "calibration: 1\nmachine: gantry.yaml\nerrors:\n  EXX: 3 um\n  ECZ: 20 urad\n";
    let known = files("lever", &[("known.yaml", known), ("gantry.yaml", machine)]);
    let run = compensated(&known, "x,y,z\n1,2,3\n", &[]);
    assert_eq!(run.status, 0, "{}", run.err);
    assert!(run.err.contains("warning[W0402]: ECZ has no effect on gantry"), "{}", run.err);
    assert_eq!(column(&run.out, "x_comp"), [0.997]);
    let derived = abbe(&["derive", &known.replace("known.yaml", "gantry.yaml")], "").out;
    assert!(derived.contains("Without effect, because they have no lever arm here: ECY, ECZ."), "{derived}");
}
