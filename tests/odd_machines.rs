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
