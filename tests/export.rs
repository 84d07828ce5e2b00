//! `abbe export` as its users meet it: files for every controller, what is told of them, and what is refused.

use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::{Run, abbe};
use crate::shipped::root;

/// A folder of the test's own.
fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("export").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn postech() -> String {
    root().join("calibrations/postech-mill.yaml").to_str().unwrap().to_owned()
}

fn exported(folder: &Path, format: &str, more: &[&str]) -> Run {
    let postech = postech();
    abbe(&[&["export", format, &postech, "--output", folder.to_str().unwrap()], more].concat(), "")
}

/// The rms that a report tells in the line of this name, um.
fn rms(report: &str, line: &str) -> f64 {
    let told = report.lines().find(|told| told.trim_start().starts_with(line)).unwrap();
    told.split_whitespace().rev().nth(1).unwrap().parse().unwrap()
}

#[test]
fn every_format_writes_files_and_tells_what_they_lose() {
    let counts = ["--counts", "X=10000", "--counts", "Y=10000", "--counts", "Z=10000"];
    let formats: [(&str, &[&str], &[&str]); 9] = [
        ("linuxcnc", &[], &["x.comp", "y.comp", "z.comp"]),
        ("isg", &[], &["volumetric.csv"]),
        ("etalon", &[], &["volumetric.txt"]),
        ("sinumerik", &["--value", "error", "--tables", "60"], &["cec.ini", "eec.ini"]),
        ("heidenhain", &["--value", "error"], &["AXIS_X.COM", "AXIS_Y.COM", "AXIS_Z.COM"]),
        ("pmac", &counts, &["compensation.pmc"]),
        ("marlin", &[], &["abbe.gcode"]),
        ("klipper", &[], &["abbe.cfg"]),
        ("reprap", &["--points", "11"], &["abbe.g", "heightmap.csv"]),
    ];
    for (format, more, files) in formats {
        let folder = folder(format);
        let run = exported(&folder, format, more);
        assert_eq!((run.status, run.err.as_str()), (0, ""), "{format}");
        let mut there: Vec<String> = fs::read_dir(&folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        there.sort();
        assert_eq!(there, files, "{format}");
        let (without, with, own) =
            (rms(&run.out, "without"), rms(&run.out, "with these"), rms(&run.out, "with Abbe's"));
        assert!(own < 0.01 && with < without, "{format}: {}", run.out);
        // The play of Y, 10 um, is what a file without directions loses: half of it.
        if matches!(format, "isg" | "etalon") {
            assert!((rms(&run.out, "loss") - 5.0).abs() < 0.1, "{format}: {}", run.out);
        }
        if format == "sinumerik" {
            assert!(rms(&run.out, "loss") < 0.05, "{}", run.out);
        }
    }
}

/// A machine and its calibration in a folder of the test's own, written in a format: X, Y and Z go from 0 to 300 mm.
fn exported_motors(test: &str, [machine, errors]: [&str; 2], format: &str) -> Run {
    let folder = folder(test).join(format);
    fs::create_dir_all(&folder).unwrap();
    let calibration = folder.join("known.yaml");
    fs::write(folder.join("motors.yaml"), machine).unwrap();
    let constants =
        if machine.contains("topology") { "constants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\n" } else { "" };
    fs::write(&calibration, format!("calibration: 1\nmachine: motors.yaml\n{constants}errors: {errors}\n"))
        .unwrap();
    let (calibration, out) = (calibration.to_str().unwrap(), folder.to_str().unwrap());
    let ranges = ["--range", "X=0:300", "--range", "Y=0:300", "--range", "Z=0:300"];
    abbe(&[&["export", format, calibration, "--output", out], &ranges[..]].concat(), "")
}

/// Tables of one drive know nothing of crossed belts, whose motors move two axes each. What corrects the tip has nothing to do with motors.
#[test]
fn crossed_belts_have_files_where_a_controller_corrects_the_tip() {
    let corexy =
        ["abbe: 1\nname: corexy\ntopology: ZFYX\ntransmission: {A: X + Y, B: X - Y}\n", "{EC0Y: 500 urad}"];
    for format in ["isg", "etalon", "marlin", "klipper", "reprap"] {
        let run = exported_motors("crossed", corexy, format);
        assert_eq!((run.status, run.err.as_str()), (0, ""), "{format}");
        assert!(
            rms(&run.out, "without") > 40.0 && rms(&run.out, "with these") < 0.1,
            "{format}: {}",
            run.out
        );
        assert!(!run.out.contains("A 0 to 0"), "{format}: {}", run.out);
    }
    for format in ["linuxcnc", "sinumerik", "heidenhain", "pmac"] {
        let run = exported_motors("crossed", corexy, format);
        let told = "A moves several axes together, but these tables correct a drive that moves one";
        assert!(
            run.status == 2 && run.err.contains(told) && run.err.contains("abbe compensate"),
            "{}",
            run.err
        );
    }
}

/// Two motors of a beam that get one command: a table of the slide is a table of both joints.
#[test]
fn two_joints_of_one_slide_have_one_file() {
    let gantry = "abbe: 1\nname: gantry\nchain:\n  tool:\n    - {slide: Y, along: +Y, drives: {Y1: {x: -400 mm}, Y2: {x: 600 mm}}, corrects: false}\n    - {slide: X, along: +X}\n    - {slide: Z, along: +Z}\n    - {tool: tip, offset: [0, 30, -100]}\n";
    let errors = "{EYY: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}]}";
    for format in ["linuxcnc", "isg"] {
        let run = exported_motors("gantry", [gantry, errors], format);
        assert_eq!((run.status, run.err.as_str()), (0, ""), "{format}");
        assert!(rms(&run.out, "without") > 8.0 && rms(&run.out, "with these") < 0.1, "{format}: {}", run.out);
        assert!(
            format == "isg" || run.out.contains("[JOINT_n] of Y1 and of Y2: COMP_FILE = y.comp"),
            "{}",
            run.out
        );
    }
}

#[test]
fn a_file_that_is_there_is_replaced_only_when_asked() {
    let folder = folder("there");
    fs::write(folder.join("z.comp"), "mine\n").unwrap();
    let run = exported(&folder, "linuxcnc", &[]);
    assert_eq!(run.status, 2);
    assert!(run.err.contains("z.comp already exists") && run.err.contains("--force"), "{}", run.err);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "no file is written where one cannot be");
    assert_eq!(exported(&folder, "linuxcnc", &["--force"]).status, 0);
    assert_ne!(fs::read_to_string(folder.join("z.comp")).unwrap(), "mine\n");
}

#[test]
fn files_that_are_there_are_read_as_the_controller_reads_them() {
    let folder = folder("check");
    let written = exported(&folder, "linuxcnc", &[]);
    let check = |files: &[String]| {
        let postech = postech();
        let files: Vec<&str> = files.iter().flat_map(|file| ["--check", file.as_str()]).collect();
        abbe(&[&["export", "linuxcnc", &postech][..], &files].concat(), "")
    };
    let named =
        |axis: &str| format!("{}={}", axis.to_uppercase(), folder.join(format!("{axis}.comp")).display());
    let all = ["x", "y", "z"].map(named);
    let read = check(&all);
    assert_eq!(read.status, 0, "{}", read.err);
    assert_eq!(rms(&read.out, "with these"), rms(&written.out, "with these"));
    // A comment at the top switches the table of X off, and what that costs is told.
    let x = folder.join("x.comp");
    let text = fs::read_to_string(&x).unwrap();
    fs::write(&x, format!("# X\n{text}")).unwrap();
    let commented = check(&all);
    assert!(commented.out.contains("line 1 is not a triplet"), "{}", commented.out);
    assert_eq!(rms(&commented.out, "with these"), rms(&check(&all[1..]).out, "with these"));
    let unnamed = check(&[x.to_str().unwrap().to_owned()]);
    assert!(unnamed.status == 2 && unnamed.err.contains("E0804"), "{}", unnamed.err);
}

#[test]
fn what_cannot_be_exported_is_refused_with_what_to_do() {
    let folder = folder("refused");
    let nowhere = folder.join("no").join("where");
    for (format, more, says) in [
        ("linuxcnc", &["--points", "300"][..], "the controller takes 256"),
        ("linuxcnc", &["--at", "Q=3"], "no axis Q"),
        ("linuxcnc", &["--range", "X=9:3"], "the range of X is empty"),
        ("linuxcnc", &["--output", nowhere.to_str().unwrap()], "does not exist"),
        ("pmac", &[], "--counts X=10000"),
        ("heidenhain", &[], "--value error"),
        ("sinumerik", &["--name", "Q=AX1"], "no such axis"),
        ("sinumerik", &["--name", "X=a b;"], "`a b;` is no name of an axis"),
        ("linuxcnc", &["--range", "X=0:500", "--range", "X=0:600"], "--range X=...: it is given twice"),
        ("isg", &["--counts", "X=10000"], "--counts has no effect on isg"),
        ("linuxcnc", &["--value", "error"], "it is an option for sinumerik, heidenhain"),
        ("pmac", &["--type", "1"], "it is an option for linuxcnc"),
    ] {
        let run = match more.first() {
            Some(&"--output") => abbe(&[&["export", format, &postech()], more].concat(), ""),
            _ => exported(&folder, format, more),
        };
        assert_eq!(run.status, 2, "{format} {more:?}: {}", run.out);
        assert!(run.err.contains(says), "{format} {more:?}: {}", run.err);
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn terms_that_no_controller_compensates_are_refused_by_name() {
    let folder = folder("terms");
    let calibration = folder.join("known.yaml");
    let text = "calibration: 1\nmachine: FX\nerrors:\n  EXX: [{constant: {value: 3 um}}, {drift: {amplitude: 5 um, time_constant: 10 min}}]\n";
    fs::write(&calibration, text).unwrap();
    let calibration = calibration.to_str().unwrap();
    let output = folder.to_str().unwrap();
    let args = ["export", "linuxcnc", calibration, "--output", output, "--range", "X=0:100"];
    let refused = abbe(&args, "");
    assert!(refused.status == 2 && refused.err.contains("E0425"), "{}", refused.err);
    let without = abbe(&[&args[..], &["--leave-out-uncompensable"]].concat(), "");
    assert_eq!(without.status, 0, "{}", without.err);
    assert!(without.out.contains("EXX drift: up to 5.00 um in the end"), "{}", without.out);
}

#[test]
fn a_volumetric_file_comes_back_as_a_calibration() {
    let folder = folder("back");
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let head = "machine: xyfz-mill\nconstants: {Xt: 20 mm, Yt: 0 mm, Zt: 120 mm}\n";
    let errors = "errors:\n  EXX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: um, values: [0, 4, 7, 13, 9, 2]}}]\n  EAY: [{polynomial: {axis: Y, unit: urad, per: mm, coefficients: [3, 0.2]}}]\n  EYZ: [{table: {axis: Z, start: -200 mm, step: 50 mm, unit: um, values: [5, 1, 0, 2, 3]}}]\n  EC0Y: 40 urad\n";
    fs::write(at("known.yaml"), format!("calibration: 1\n{head}{errors}")).unwrap();
    let ranges = ["--range", "Y=-10:300"];
    for (format, file) in [("isg", "volumetric.csv"), ("etalon", "volumetric.txt")] {
        let (known, output) = (at("known.yaml"), at(""));
        let run =
            abbe(&[&["export", format, &known, "--output", &output, "--force"], &ranges[..]].concat(), "");
        assert_eq!(run.status, 0, "{}", run.err);
        fs::write(at("set-up.yaml"), format!("setup: 1\n{head}volumetric: {file}\n")).unwrap();
        let run = abbe(&["calibrate", &at("set-up.yaml"), "--output", &at("back.yaml"), "--force"], "");
        assert_eq!(run.status, 0, "{}", run.err);
        let points = "x,y,z\n12.5,40,-130\n333,250,-10\n500,0,-200\n";
        let [one, other] = ["known.yaml", "back.yaml"].map(|name| abbe(&["compensate", &at(name)], points));
        let numbers = |text: &str| -> Vec<f64> {
            let cells = text.lines().skip(1).flat_map(|line| line.split(','));
            cells.map(|cell| cell.parse().unwrap()).collect()
        };
        let (one, other) = (numbers(&one.out), numbers(&other.out));
        assert_eq!((one.len(), other.len()), (27, 27), "{format}");
        assert!(
            one.iter().zip(&other).all(|(one, other)| (one - other).abs() < 1e-8),
            "{format}: {one:?} {other:?}"
        );
    }
    let twice = format!("setup: 1\n{head}errors: {{EXX: 3 um}}\nvolumetric: volumetric.csv\n");
    fs::write(at("set-up.yaml"), twice).unwrap();
    let run = abbe(&["calibrate", &at("set-up.yaml")], "");
    assert!(run.status == 2 && run.err.contains("E0911"), "{}", run.err);
}

#[test]
fn what_printers_and_hobby_mills_have_saved_comes_in_as_a_calibration() {
    let folder = folder("saved");
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let head = "setup: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\n";
    let printer = "[bed_mesh]\nspeed: 120\n\n#*# <---------------------- SAVE_CONFIG ---------------------->\n#*# DO NOT EDIT THIS BLOCK OR BELOW.\n#*#\n#*# [bed_mesh default]\n#*# version = 1\n#*# points =\n#*# \t  0.100000, 0.300000\n#*# \t  -0.100000, 0.100000\n#*# x_count = 2\n#*# y_count = 2\n#*# mesh_x_pps = 2\n#*# mesh_y_pps = 2\n#*# algo = lagrange\n#*# tension = 0.2\n#*# min_x = 0.0\n#*# max_x = 200.0\n#*# min_y = 0.0\n#*# max_y = 200.0\n#*#\n#*# [skew_correction square]\n#*# xy_skew = 0.001\n#*# xz_skew = 0.0\n#*# yz_skew = 0.0\n";
    fs::write(at("printer.cfg"), printer).unwrap();
    fs::write(at("x.comp"), "0 0 0\n200 -0.05 -0.03\n").unwrap();
    // Given alone, the files are answered with the set-up that they need.
    let asked = abbe(&["calibrate", &at("printer.cfg"), &at("x.comp")], "");
    assert!(
        asked.status == 2
            && asked.err.contains(
                "corrections:\n      - {data: printer.cfg}\n      - {data: x.comp, axis: X, type: 1}"
            ),
        "{}",
        asked.err
    );
    let corrections = "corrections:\n  - {data: printer.cfg}\n  - {data: x.comp, axis: X, type: 1}\n";
    fs::write(at("set-up.yaml"), format!("{head}{corrections}")).unwrap();
    let run = abbe(&["calibrate", &at("set-up.yaml"), "--output", &at("printer.yaml")], "");
    assert_eq!(run.status, 0, "{}", run.err);
    assert!(
        run.err.contains("3 terms of error motions") && run.err.contains("1 term of error motions"),
        "{}",
        run.err
    );
    // At 200 and 100 mm: the skew sends the tool 0.1 mm towards -X, the screw 0.05 mm; the bed is 0.2 mm high, the mean of 0.3 and 0.1.
    let run = abbe(&["compensate", &at("printer.yaml")], "x,y,z,dir_x\n200,100,0,1\n");
    let row = run.out.lines().nth(1).unwrap();
    let commanded: Vec<f64> = row.split(',').rev().take(3).map(|cell| cell.parse().unwrap()).collect();
    let [z, y, x] = commanded.try_into().unwrap();
    // The table holds its end outside 200 mm, so that the screw's part is -0.05 mm but for its slope times 0.1 mm.
    assert!((x - 199.85).abs() < 1e-4 && (y - 100.0_f64).abs() < 1e-9 && (z - 0.2_f64).abs() < 2e-4, "{row}");
    // What two files give is given once.
    fs::write(at("set-up.yaml"), format!("{head}{corrections}errors: {{EXX: 3 um}}\n")).unwrap();
    let run = abbe(&["calibrate", &at("set-up.yaml")], "");
    assert!(run.status == 2 && run.err.contains("E0911") && run.err.contains("EXX: 3 um"), "{}", run.err);
    let twice = "corrections:\n  - {data: x.comp, axis: X, type: 1}\n  - {data: x.comp, axis: X, type: 1}\n";
    fs::write(at("set-up.yaml"), format!("{head}{twice}")).unwrap();
    let run = abbe(&["calibrate", &at("set-up.yaml")], "");
    assert!(
        run.status == 2 && run.err.contains("E0911") && run.err.contains("another file already gives"),
        "{}",
        run.err
    );
    for (bad, code) in [
        ("corrections: []\n", "E0901"),
        ("corrections: [{axis: X}]\n", "E0901"),
        ("corrections: [{data: x.comp, axis: Q, type: 1}]\n", "E0906"),
        ("corrections: [{data: x.comp, axis: X, type: 2}]\n", "E0907"),
        ("corrections: [{data: x.comp, axis: X, kind: 1}]\n", "E0903"),
        ("corrections: [{data: x.comp, x: [9 mm, 1 mm]}]\n", "E0904"),
        ("corrections: [{data: x.comp, axis: X}]\n", "E0804"),
        ("corrections: [{data: x.comp, axis: X, type: 0}]\n", "E0430"),
        ("corrections: [{data: set-up.yaml}]\n", "E0802"),
        ("corrections: [{data: nowhere.cfg}]\n", "E0914"),
        ("diagonals: {}\n", "E0901"),
        ("diagonals: {XY: {AC: 140 mm, BD: 141 mm}}\n", "E0901"),
        ("diagonals: {XY: {AC: 140 mm, BD: 99 mm, AD: 100 mm}}\n", "E0926"),
        ("diagonals: {XY: {AC: 140 mm, BD: 140 mm, AD: 0 mm}}\n", "E0926"),
        ("diagonals: {XY: {AC: 140, BD: 141 mm, AD: 100 mm}}\n", "E0306"),
        ("diagonals: {XY: {AC: 141 mm, BD: 141.4 mm, AD: 100 mm}}\nerrors: {EC0Y: 1 mrad}\n", "E0911"),
    ] {
        fs::write(at("bad.yaml"), format!("{head}{bad}")).unwrap();
        let run = abbe(&["calibrate", &at("bad.yaml")], "");
        assert!(run.status == 2 && run.err.contains(code), "{bad}: {}", run.err);
    }
}

#[test]
fn lengths_of_squares_are_squareness_as_klipper_and_marlin_have_it() {
    let folder = folder("squares");
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    // The example of Klipper's documentation, nearly square; the factors are Klipper's `calc_skew_factor`, worked out here anew.
    let factor = |ac: f64, bd: f64, ad: f64| {
        let side = (2.0 * ac * ac + 2.0 * bd * bd - 4.0 * ad * ad).sqrt() / 2.0;
        (std::f64::consts::FRAC_PI_2 - ((ac * ac - side * side - ad * ad) / (2.0 * side * ad)).acos()).tan()
    };
    let [xy, xz, yz] = [factor(140.4, 142.8, 99.8), factor(141.6, 141.4, 99.8), factor(142.4, 142.1, 99.5)];
    assert!(xy < -0.01 && xz > 0.001 && yz > 0.001, "{xy} {xz} {yz}");
    let lengths = "diagonals:\n  XY: {AC: 140.4 mm, BD: 142.8 mm, AD: 99.8 mm}\n  XZ: {AC: 141.6 mm, BD: 141.4 mm, AD: 99.8 mm}\n  YZ: {AC: 142.4 mm, BD: 142.1 mm, AD: 99.5 mm}\n";
    for machine in ["XYFZ", "YFXZ", "FXYZ"] {
        let set_up =
            format!("setup: 1\nmachine: {machine}\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}}\n{lengths}");
        fs::write(at("set-up.yaml"), set_up).unwrap();
        let run = abbe(&["calibrate", &at("set-up.yaml"), "--output", &at("printer.yaml"), "--force"], "");
        assert_eq!(run.status, 0, "{}", run.err);
        let run = abbe(&["compensate", &at("printer.yaml")], "x,y,z\n50,120,80\n");
        let row = run.out.lines().nth(1).unwrap();
        let commanded: Vec<f64> = row.split(',').skip(6).map(|cell| cell.parse().unwrap()).collect();
        // Klipper's `calc_skew`.
        let theirs = [50.0 - 120.0 * xy - 80.0 * (xz - xy * yz), 120.0 - 80.0 * yz, 80.0];
        assert!(
            commanded.iter().zip(theirs).all(|(ours, theirs)| (ours - theirs).abs() < 1e-6),
            "{machine}: {row}, {theirs:?}"
        );
    }
    // A machine without Z has one square; another one is refused.
    fs::write(
        at("set-up.yaml"),
        format!("setup: 1\nmachine: FXY\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}}\n{lengths}"),
    )
    .unwrap();
    let run = abbe(&["calibrate", &at("set-up.yaml")], "");
    assert!(run.status == 2 && run.err.contains("E0906") && run.err.contains("no axis Z"), "{}", run.err);
}
