//! `abbe calibrate` as its users meet it: an exact machine is measured by `abbe simulate`, the readings are written as instruments
//! write them, and the calibration is held against the machine's true errors.

use std::fs;
use std::path::{Path, PathBuf};

use model_dsl::calibration::{self, CalibratedTerm, Calibration, CurveValues, MachineNames};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{compile, compile_word, yaml};

use crate::cli::abbe;
use crate::shipped::root;

/// Targets on every axis, mm.
const TARGETS: [f64; 5] = [0.0, 100.0, 200.0, 300.0, 400.0];

/// Cycles of a measurement, and the spread of its readings, um.
const CYCLES: usize = 5;
const NOISE: f64 = 0.2;

/// A mean of five readings lies within so many um of the truth, five times its standard deviation.
const WITHIN: f64 = 5.0 * NOISE / 2.236;

/// What each slide really does: positioning, both straightnesses (none of them with a line of its own), a rotation.
const POSITIONING: [f64; 5] = [0.0, 4.0, 6.0, 3.0, 5.0];
const STRAIGHTNESS: [[f64; 5]; 2] = [[2.0, -1.0, -2.0, -1.0, 2.0], [-1.0, 2.0, 0.0, -2.0, 1.0]];
const ROTATION: [f64; 5] = [0.0, 8.0, -3.0, 5.0, 1.0];
const LOST_MOTION: f64 = 6.0;
const SQUARENESSES: [f64; 3] = [40.0, -25.0, 60.0];

/// The straightnesses of slides, with which of the two curves each has.
const STRAIGHT: [(&str, usize); 6] = [("EYX", 0), ("EZX", 1), ("EXY", 1), ("EZY", 0), ("EXZ", 0), ("EYZ", 1)];

/// A machine, and its squarenesses between X and Y, Y and Z, Z and X.
const MACHINES: [(&str, [&str; 3]); 6] = [
    ("XYFZ", ["EC0Y", "EA0Z", "EB0Z"]),
    ("FXYZ", ["EC0Y", "EA0Z", "EB0Z"]),
    ("XFYZ", ["EC0Y", "EA0Z", "EB0Z"]),
    ("XYZF", ["EC0Y", "EA0Z", "EB0Z"]),
    ("postech-mill", ["EC0Y", "EA0Y", "EB0X"]),
    ("trunnion-5axis", ["EC0Y", "EA0Z", "EB0Z"]),
];

fn names(machine: &str) -> MachineNames {
    let mut found = Diagnostics::new();
    let path = root().join(format!("machines/{machine}.yaml"));
    let compiled = match fs::read_to_string(path) {
        Ok(text) => compile(&SourceFile::new(machine, text), &mut found),
        Err(_) => compile_word(machine, &mut found),
    };
    compiled.unwrap().equations.names()
}

fn constants(machine: &str) -> String {
    let names = names(machine);
    let given: Vec<String> = names.constants.iter().map(|(name, _)| format!("{name}: 0 mm")).collect();
    format!("constants: {{{}}}\n", given.join(", "))
}

fn list(values: &[f64]) -> String {
    format!("{values:?}")
}

fn curve(axis: char, unit: &str, values: &[f64]) -> String {
    format!(
        "{{table: {{axis: {axis}, at: {}, per: mm, unit: {unit}, values: {}}}}}",
        list(&TARGETS),
        list(values)
    )
}

/// A bench for one machine.
struct Bench {
    folder: PathBuf,
    machine: &'static str,
}

impl Bench {
    fn new(test: &str, machine: &'static str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("calibrate").join(test).join(machine);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        Self { folder, machine }
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.folder.join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    }

    /// What an instrument reads on a machine with these errors while an axis goes to and fro over the targets: for each run
    /// whether it went forward, and its readings by target, in the instrument's mm or arcsec.
    fn measured(&self, errors: &str, axis: char, instrument: &str, noise: &str) -> Vec<(bool, Vec<f64>)> {
        self.measured_at("", errors, axis, instrument, noise)
    }

    /// The same where the other axes stand.
    fn measured_at(
        &self,
        at: &str,
        errors: &str,
        axis: char,
        instrument: &str,
        noise: &str,
    ) -> Vec<(bool, Vec<f64>)> {
        let truth = format!(
            "calibration: 1\nmachine: {}\n{}errors:\n{errors}",
            self.machine,
            constants(self.machine)
        );
        let path = format!(
            "path: 1\n{at}line: {{axis: {axis}, from: 0 mm, to: 400 mm, overrun: 2 mm, stations: {{count: 5, dwell: 4 s, readings: 1}}}}\nfeed: 2 m/min\nruns: {CYCLES}\nseed: 7\nnoise: {noise}\ninstrument: {instrument}\n"
        );
        let (truth, path) = (self.write("true.yaml", &truth), self.write("path.yaml", &path));
        let output = self.folder.join("simulated").to_str().unwrap().to_owned();
        let run = abbe(&["simulate", &truth, &path, "--output", &output, "--force"], "");
        assert_eq!(run.status, 0, "{}", run.err);
        let data = fs::read_to_string(Path::new(&output).join("data.csv")).unwrap();
        let readings: Vec<f64> =
            data.lines().skip(1).map(|row| row.rsplit(',').next().unwrap().parse().unwrap()).collect();
        assert_eq!(readings.len(), 2 * CYCLES * TARGETS.len(), "{data}");
        let runs = readings.chunks(TARGETS.len()).enumerate().map(|(number, run)| {
            let forward = number % 2 == 0;
            let mut run = run.to_vec();
            if !forward {
                run.reverse();
            }
            (forward, run)
        });
        runs.collect()
    }

    fn calibration(&self, setup: &str) -> (Calibration, MachineNames, String) {
        let setup = self.write("setup.yaml", setup);
        let output = self.folder.join("calibration.yaml").to_str().unwrap().to_owned();
        let run = abbe(&["calibrate", &setup, "--output", &output, "--force"], "");
        assert_eq!((run.status, run.err.as_str()), (0, ""), "{}", run.out);
        let source = SourceFile::new("c", fs::read_to_string(output).unwrap());
        let (names, mut found) = (names(self.machine), Diagnostics::new());
        let root = yaml::read(&source, &mut found).unwrap();
        (calibration::read(&root, &names, &mut found).unwrap(), names, run.out)
    }
}

/// The readings in the file of a laser: um over targets, odd runs ascending, `zero` being the target at the axis's zero.
fn laser(owner: &str, readings: &[(bool, Vec<f64>)], against: Option<f64>) -> String {
    let mut runs: Vec<(bool, Vec<f64>)> = readings.to_vec();
    let mut targets = TARGETS.to_vec();
    if let Some(zero) = against {
        targets = TARGETS.iter().rev().map(|target| zero - target).collect();
        for (forward, values) in &mut runs {
            *forward = !*forward;
            values.reverse();
            values.iter_mut().for_each(|value| *value = -*value);
        }
    }
    let written: Vec<String> = targets.iter().map(|target| format!("{target:.6}")).collect();
    let mut text = format!(
        "HEADER::\nFile type  : rtl\nOwner      : {owner}\n\nTARGET DATA::\nTarget-count: 5\nTargets :\n{}\n{}\nFlags: 0 0 2 0\n\nRUNS::\nRun-count: {}\n\nDEVIATIONS::\nRun Target Data:\n",
        written[..3].join(" "),
        written[3..].join(" "),
        runs.len()
    );
    for (number, (forward, values)) in runs.iter().enumerate() {
        let mut rows: Vec<String> = values
            .iter()
            .enumerate()
            .map(|(target, value)| format!("{} {} {value:.3}\n", number + 1, target + 1))
            .collect();
        if !forward {
            rows.reverse();
        }
        text += &rows.concat();
    }
    (text + "\nEOF::\n").replace('\n', "\r\n")
}

/// The readings as a plain table, by a sensor that counts the other way.
fn plain(readings: &[(bool, Vec<f64>)]) -> String {
    let mut text = String::from("cycle,direction,position,reading\n#unit,,,m,nm\n").replace("cycle", "run");
    for (number, (forward, values)) in readings.iter().enumerate() {
        for (target, value) in TARGETS.iter().zip(values) {
            let way = if *forward { "+1" } else { "-1" };
            text += &format!("{},{way},{},{}\n", number + 1, target / 1e3, -value * 1e3);
        }
    }
    text
}

fn scaled(readings: &[(bool, Vec<f64>)], factor: f64) -> Vec<(bool, Vec<f64>)> {
    readings
        .iter()
        .map(|(forward, values)| (*forward, values.iter().map(|value| value * factor).collect()))
        .collect()
}

/// Forward and reverse of a motion's table, in units of `unit` mm or rad.
fn table(calibration: &Calibration, names: &MachineNames, motion: &str, unit: f64) -> [Vec<f64>; 2] {
    let terms = calibration.terms(names.motion(motion).unwrap());
    let CalibratedTerm::Table { curve, .. } = &terms[0].value else { panic!("{motion}: {terms:?}") };
    assert_eq!(terms.len(), 1);
    let CurveValues::Directed { forward, reverse } = &curve.values else { panic!("{motion}: {curve:?}") };
    [forward, reverse].map(|values| values.iter().map(|value| value / unit).collect())
}

#[track_caller]
fn near(found: &[f64], truth: &[f64], what: &str) {
    let near = found.iter().zip(truth).all(|(found, truth)| (found - truth).abs() < WITHIN);
    assert!(near && found.len() == truth.len(), "{what}: {found:?} is not {truth:?}");
}

/// Every machine, whichever body its axes move: what is put in comes out, with its sign.
#[test]
fn true_errors_come_back_from_the_files_of_instruments() {
    for (machine, squarenesses) in MACHINES {
        let bench = Bench::new("true", machine);
        let mut errors = String::new();
        for (motion, which) in STRAIGHT {
            let axis = motion.chars().last().unwrap();
            errors += &format!("  {motion}: [{}]\n", curve(axis, "um", &STRAIGHTNESS[which]));
        }
        for (name, angle) in squarenesses.iter().zip(SQUARENESSES) {
            errors += &format!("  {name}: {angle} urad\n");
        }
        let head = format!("setup: 1\nmachine: {machine}\n{}measurements:\n", constants(machine));
        // Rotations were not there while the rest was measured, and have a set-up of their own.
        let (mut setup, mut turning) = (head.clone(), head);
        for (motion, _) in STRAIGHT {
            let (across, axis) = (motion.chars().nth(1).unwrap(), motion.chars().last().unwrap());
            let instrument = format!("{{straightness: {{axis: {axis}, direction: {across}}}}}");
            let readings = scaled(&bench.measured(&errors, axis, &instrument, "0.2 um"), 1e3);
            let mut planes = [axis, across];
            planes.sort_unstable();
            let square = format!("reference: square-{}{}", planes[0], planes[1]);
            // One of the two comes from a laser, the other as a table from a sensor that counts the other way.
            if axis > across {
                bench.write(&format!("{motion}.rtl"), &laser("Linear", &readings, None));
                setup += &format!("  - {{motion: {motion}, data: {motion}.rtl, {square}}}\n");
            } else {
                bench.write(&format!("{motion}.csv"), &plain(&readings));
                setup += &format!(
                    "  - {{motion: {motion}, data: {motion}.csv, deviations: {{sign: -1, column: reading}}, {square}}}\n"
                );
            }
        }
        for axis in ['X', 'Y', 'Z'] {
            let errors = format!(
                "  E{axis}{axis}: [{}, {{backlash: {{lost_motion: {LOST_MOTION} um}}}}]\n",
                curve(axis, "um", &POSITIONING)
            );
            let readings = scaled(
                &bench.measured(&errors, axis, &format!("{{linear: {{axis: {axis}}}}}"), "0.2 um"),
                1e3,
            );
            bench.write(&format!("{axis}.rtl"), &laser("Linear", &readings, Some(450.0)));
            setup += &format!(
                "  - {{motion: E{axis}{axis}, data: {axis}.rtl, targets: {{origin: 450 mm, sign: -1}}, deviations: {{zero_at: 0 mm}}}}\n"
            );
            for about in ['A', 'B', 'C'] {
                let motion = format!("E{about}{axis}");
                let errors = format!("  {motion}: [{}]\n", curve(axis, "arcsec", &ROTATION));
                let readings = bench.measured(
                    &errors,
                    axis,
                    &format!("{{angular: {{axis: {axis}, direction: {about}}}}}"),
                    "0.2 arcsec",
                );
                bench.write(&format!("{motion}.rta"), &laser("Angular", &readings, None));
                turning += &format!(
                    "  - {{motion: {motion}, data: {motion}.rta, targets: {{unit: mm}}, deviations: {{unit: arcsec}}}}\n"
                );
            }
        }
        let (rotations, ..) = bench.calibration(&turning);
        let (calibration, names, report) = bench.calibration(&setup);
        for (motion, which) in STRAIGHT {
            for side in table(&calibration, &names, motion, 1e-3) {
                near(&side, &STRAIGHTNESS[which], &format!("{machine} {motion}"));
            }
        }
        for axis in ["X", "Y", "Z"] {
            let [forward, reverse] = table(&calibration, &names, &format!("E{axis}{axis}"), 1e-3);
            let with = |play: f64| POSITIONING.map(|value| value + play);
            // The zero is that of the means at one target: its noise shifts the whole curve.
            near(&forward, &with(-LOST_MOTION / 2.0), &format!("{machine} E{axis}{axis} forward"));
            near(&reverse, &with(LOST_MOTION / 2.0), &format!("{machine} E{axis}{axis} reverse"));
            for about in ["A", "B", "C"] {
                let motion = format!("E{about}{axis}");
                for side in table(&rotations, &names, &motion, std::f64::consts::PI / 648_000.0) {
                    near(&side, &ROTATION, &format!("{machine} {motion}"));
                }
            }
        }
        for (name, truth) in squarenesses.iter().zip(SQUARENESSES) {
            let terms = calibration.terms(names.motion(name).unwrap());
            let CalibratedTerm::Constant { value } = terms[0].value else { panic!("{terms:?}") };
            // Two slopes over 400 mm of means of ten readings: well below one microradian.
            assert!(
                (value * 1e6 - truth).abs() < 1.5,
                "{machine} {name}: {value} is not {truth} urad\n{report}"
            );
        }
    }
}

/// A laser off the carriage's frame reads pitch and yaw too; with both measured, and the place told, positioning comes out.
#[test]
fn pitch_and_yaw_are_taken_off_positioning_and_straightness() {
    for machine in ["XYFZ", "FXYZ", "XYZF", "postech-mill"] {
        let bench = Bench::new("levers", machine);
        let rotations =
            ["A", "B", "C"].map(|about| format!("  E{about}X: [{}]\n", curve('X', "arcsec", &ROTATION)));
        let rotations = rotations.concat();
        let errors = format!(
            "  EXX: [{}]\n  EYX: [{}]\n{rotations}",
            curve('X', "um", &POSITIONING),
            curve('X', "um", &STRAIGHTNESS[0])
        );
        let mut setup = format!("setup: 1\nmachine: {machine}\n{}measurements:\n", constants(machine));
        for (motion, instrument) in
            [("EXX", "{linear: {axis: X}}"), ("EYX", "{straightness: {axis: X, direction: Y}}")]
        {
            let readings =
                bench.measured_at("at: {Y: 90 mm, Z: -150 mm}\n", &errors, 'X', instrument, "0.2 um");
            bench.write(&format!("{motion}.rtl"), &laser("Linear", &scaled(&readings, 1e3), None));
            setup += &format!(
                "  - {{motion: {motion}, data: {motion}.rtl, at: {{Y: 90 mm, Z: -150 mm}}, deviations: {{zero_at: 0 mm}}}}\n"
            );
        }
        for about in ["A", "B", "C"] {
            let instrument = format!("{{angular: {{axis: X, direction: {about}}}}}");
            let readings = bench.measured(&rotations, 'X', &instrument, "0.02 arcsec");
            bench.write(&format!("E{about}X.rta"), &laser("Angular", &readings, None));
            setup += &format!(
                "  - {{motion: E{about}X, data: E{about}X.rta, targets: {{unit: mm}}, deviations: {{unit: arcsec}}}}\n"
            );
        }
        let (calibration, names, report) = bench.calibration(&setup);
        assert!(report.contains("lever arms subtracted: EBX of up to"), "{report}");
        let from_first = |values: [f64; 5]| values.map(|value| value - values[0]);
        for (motion, truth) in [("EXX", POSITIONING), ("EYX", STRAIGHTNESS[0])] {
            for side in table(&calibration, &names, motion, 1e-3) {
                near(&side, &from_first(truth), &format!("{machine} {motion}"));
            }
        }
    }
}

/// The zero of an angular instrument is anything: the calibration predicts the machine's errors all the same, up to where the
/// zeros of lengths are.
#[test]
fn the_zero_of_a_rotation_is_in_no_squareness() {
    let machine = "FXYZ";
    let bench = Bench::new("zero", machine);
    let errors = format!(
        "  EYX: [{}]\n  EXY: [{}]\n  ECX: [{}]\n  EC0Y: 40 urad\n",
        curve('X', "um", &STRAIGHTNESS[0]),
        curve('Y', "um", &STRAIGHTNESS[1]),
        curve('X', "arcsec", &ROTATION)
    );
    let mut setup = format!("setup: 1\nmachine: {machine}\n{}measurements:\n", constants(machine));
    for (motion, axis, across, at) in [("EYX", 'X', 'Y', "Y: 200 mm"), ("EXY", 'Y', 'X', "X: 100 mm")] {
        let instrument = format!("{{straightness: {{axis: {axis}, direction: {across}}}}}");
        let readings = bench.measured_at(&format!("at: {{{at}}}\n"), &errors, axis, &instrument, "0.1 um");
        bench.write(&format!("{motion}.rtl"), &laser("Linear", &scaled(&readings, 1e3), None));
        setup += &format!("  - {{motion: {motion}, data: {motion}.rtl, at: {{{at}}}, reference: square}}\n");
    }
    let angles = bench.measured(&errors, 'X', "{angular: {axis: X, direction: C}}", "0.01 arcsec");
    let shifted: Vec<(bool, Vec<f64>)> = angles
        .iter()
        .map(|(forward, run)| (*forward, run.iter().map(|angle| angle + 30.0).collect()))
        .collect();
    bench.write("ECX.rta", &laser("Angular", &shifted, None));
    setup += "  - {motion: ECX, data: ECX.rta, targets: {unit: mm}, deviations: {unit: arcsec}}\n";
    bench.calibration(&setup);
    let points: String = TARGETS.iter().flat_map(|x| TARGETS.map(|y| format!("{x},{y},0\n"))).collect();
    let predicted = |name: &str, column: &str| {
        let path = bench.folder.join(name);
        let run = abbe(&["compensate", path.to_str().unwrap(), "--quiet"], &format!("x,y,z\n{points}"));
        assert_eq!(run.status, 0, "{}", run.err);
        crate::cli::column(&run.out, column)
    };
    for column in ["error_x", "error_y"] {
        let (truth, found) = (predicted("true.yaml", column), predicted("calibration.yaml", column));
        let apart: Vec<f64> = found.iter().zip(&truth).map(|(found, truth)| (found - truth) * 1e3).collect();
        let (least, most) =
            apart.iter().fold((f64::MAX, f64::MIN), |(least, most), one| (least.min(*one), most.max(*one)));
        assert!(most - least < 0.6, "{column} is apart by {least} to {most} um");
    }
}

/// How often the interval of a mean holds the truth: 95 of 100, as it says.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let mut chance = abbe_fuzz::mutate::Chance::new(5);
    let (mut held, mut all) = (0, 0);
    for round in 0..40 {
        let bench = Bench::new("intervals", "FX");
        let noise = |chance: &mut abbe_fuzz::mutate::Chance| -> f64 {
            // Twelve equal chances make a normal one.
            (0..12).map(|_| f64::from(u32::try_from(chance.below(1_000_001)).unwrap()) / 1e6).sum::<f64>()
                - 6.0
        };
        let runs: Vec<(bool, Vec<f64>)> = (0..2 * CYCLES)
            .map(|number| (number % 2 == 0, POSITIONING.map(|value| value + noise(&mut chance)).to_vec()))
            .collect();
        bench.write("x.rtl", &laser("Linear", &runs, None));
        let (_, _, report) = bench.calibration("setup: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements: [{motion: EXX, data: x.rtl}]\n");
        let rows = report.lines().filter(|row| {
            row.split_whitespace().next().is_some_and(|cell| cell.ends_with("00.000") || cell == "0.000")
        });
        for (row, truth) in rows.zip(POSITIONING) {
            let cells: Vec<f64> = row.split_whitespace().map(|cell| cell.parse().unwrap()).collect();
            let [_, forward, half, _, reverse, other, _] = cells[..] else { panic!("{row}") };
            held +=
                usize::from((forward - truth).abs() <= half) + usize::from((reverse - truth).abs() <= other);
            all += 2;
        }
        assert_eq!(all, 10 * (round + 1), "{report}");
    }
    // 400 intervals: 380 expected, with a standard deviation of 4.4.
    assert!((362..=396).contains(&held), "{held} of {all}");
}

fn simple(bench: &Bench) -> String {
    let run = |forward: bool| (forward, POSITIONING.to_vec());
    bench.write("x.rtl", &laser("Linear", &[run(true), run(false)], None));
    bench.write("setup.yaml", "setup: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements: [{motion: EXX, data: x.rtl}]\n")
}

#[test]
fn nothing_is_written_over_and_nothing_half() {
    let bench = Bench::new("written", "FX");
    let setup = simple(&bench);
    let at = |name: &str| bench.folder.join(name).to_str().unwrap().to_owned();
    bench.write("there.yaml", "mine");
    for (target, words) in [
        ("there.yaml", "already exists"),
        ("x.rtl", "one of the files that this command"),
        ("setup.yaml", "one of the files that this command"),
        ("no/c.yaml", "its folder does not exist"),
    ] {
        let run = abbe(&["calibrate", &setup, "--output", &at(target)], "");
        assert_eq!(run.status, 2);
        assert!(run.err.contains(words) && run.out.is_empty(), "{target}: {}", run.err);
    }
    assert_eq!(fs::read_to_string(at("there.yaml")).unwrap(), "mine");
    let broken = fs::read_to_string(at("x.rtl")).unwrap().replace("Target-count: 5", "Target-count: 6");
    bench.write("x.rtl", &broken);
    let run = abbe(&["calibrate", &setup, "--output", &at("there.yaml"), "--force"], "");
    assert!(run.status == 2 && run.err.contains("E0914") && run.err.contains("E0924"), "{}", run.err);
    assert_eq!(fs::read_to_string(at("there.yaml")).unwrap(), "mine");
}

#[test]
fn files_without_a_set_up_get_one_to_fill_in() {
    let bench = Bench::new("without", "FX");
    simple(&bench);
    let data = bench.folder.join("x.rtl").to_str().unwrap().to_owned();
    let run = abbe(&["calibrate", &data, &data], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("    setup: 1\n") && run.err.matches("data: x.rtl").count() == 2, "{}", run.err);
    let text: String = run
        .err
        .lines()
        .filter_map(|line| line.strip_prefix("    "))
        .map(|line| format!("{line}\n"))
        .collect();
    // What is shown is read as it stands, once the motion is filled in; until then it is told where.
    let once = text.rsplit_once("  - ").unwrap().0;
    let setup = bench.write("filled.yaml", once);
    let run = abbe(&["calibrate", &setup], "");
    assert!(run.status == 2 && run.err.contains("E0905") && run.err.contains("^^^"), "{}", run.err);
    let setup = bench.write("filled.yaml", &once.replace("E??", "EXX"));
    let run = abbe(&["calibrate", &setup], "");
    assert_eq!((run.status, run.err.as_str()), (0, ""));
}

/// The example that comes with Abbe.
#[test]
fn the_shipped_example_gives_its_true_errors() {
    let folder = root().join("recordings/xyfz-mill-laser");
    let setup = folder.join("setup.yaml").to_str().unwrap().to_owned();
    let output = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("calibrate/shipped.yaml");
    fs::create_dir_all(output.parent().unwrap()).unwrap();
    let run = abbe(&["calibrate", &setup, "--output", output.to_str().unwrap(), "--force"], "");
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    let names = names("xyfz-mill");
    let read = |path: &Path| {
        let mut found = Diagnostics::new();
        let root = yaml::read(&SourceFile::new("c", fs::read_to_string(path).unwrap()), &mut found).unwrap();
        calibration::read(&root, &names, &mut found).unwrap()
    };
    let (truth, found) = (read(&folder.join("true.yaml")), read(&output));
    let square = names.motion("EC0Y").unwrap();
    let angle = |calibration: &Calibration| match calibration.terms(square)[0].value {
        CalibratedTerm::Constant { value } => value,
        ref other => panic!("{other:?}"),
    };
    assert!((angle(&truth) - angle(&found)).abs() < 2e-6, "{} {}", angle(&truth), angle(&found));
    let [forward, reverse] = table(&found, &names, "EXX", 1e-3);
    let lost: Vec<f64> = reverse.iter().zip(&forward).map(|(one, other)| one - other).collect();
    assert!(lost.iter().all(|lost| (lost - 8.0).abs() < 1.0), "{lost:?}");
}

/// What the report says for people, programs find too.
#[test]
fn the_report_is_there_as_json() {
    let setup = root().join("recordings/xyfz-mill-laser/setup.yaml").to_str().unwrap().to_owned();
    let run = abbe(&["calibrate", &setup, "--format", "json"], "");
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    let all: serde_json::Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!(all["schema"], "abbe-calibrate/1");
    let text = abbe(&["calibrate", &setup], "").out;
    for motion in all["motions"].as_array().unwrap() {
        for target in motion["targets"].as_array().unwrap() {
            let (position, forward) = (&target["position"], &target["forward"]);
            let um = |value: &serde_json::Value| format!("{:.2}", 1e3 * value.as_f64().unwrap());
            let [position, value, half] = [
                format!("{:.3}", position.as_f64().unwrap()),
                um(&forward["value"]),
                um(&forward["uncertainty"]["half95"]),
            ];
            let row = text.lines().find(|row| {
                let cells: Vec<&str> = row.split_whitespace().collect();
                cells.first() == Some(&position.as_str())
                    && cells.get(1) == Some(&value.as_str())
                    && cells.get(2) == Some(&half.as_str())
            });
            assert!(row.is_some(), "{position} {value} {half}\n{text}");
        }
    }
    assert_eq!(all["squarenesses"][0]["motion"], "EC0Y");
    assert_eq!(all["squarenesses"][0]["square"], 4e-6);
}

/// Numbers in um that the set-up takes for mm: the unit is marked, and nothing is printed or written.
#[test]
fn a_unit_that_makes_an_error_too_large_is_told_before_anything_is_printed() {
    let bench = Bench::new("unit", "FX");
    bench.write("nounit.csv", "target,deviation\n0,0\n100,-12\n200,-25\n300,-37\n");
    let setup = bench.write(
        "setup.yaml",
        "setup: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements:\n  - {motion: EXX, data: nounit.csv, \
         targets: {unit: mm}, deviations: {unit: mm}}\n",
    );
    let output = bench.folder.join("out.yaml");
    for words in [vec!["calibrate", &setup], vec!["calibrate", &setup, "--output", output.to_str().unwrap()]]
    {
        let run = abbe(&words, "");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{}", run.err);
        assert!(run.err.contains("error[E0430]: 37 mm is not a small error"), "{}", run.err);
        assert!(run.err.contains("setup.yaml:5:") && !run.err.contains("bug"), "{}", run.err);
        assert!(!output.exists());
    }
}

/// A name that no file has is answered with the nearest one beside it.
#[test]
fn a_data_file_that_is_misspelt_is_told_with_the_one_beside() {
    let bench = Bench::new("misspelt", "FX");
    let plain = bench.write("plain.csv", "x [mm],deviation [um]\n0,0\n100,-12\n200,-25\n");
    let setup = bench.write(
        "setup.yaml",
        "setup: 1\nmachine: FX\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements: [{motion: EXX, data: plian.csv}]\n",
    );
    let run = abbe(&["calibrate", &setup], "");
    assert!(run.err.contains(&format!("did you mean `{plain}`?")), "{}", run.err);
    let right = bench.write("setup.yaml", &fs::read_to_string(&setup).unwrap().replace("plian", "plain"));
    let run = abbe(&["calibrate", &right], "");
    assert_eq!(run.status, 0, "{}", run.err);
}

/// What is no file is told as such, not taken for an instrument's.
#[test]
fn a_table_that_is_not_there_is_told_so() {
    let run = abbe(&["calibrate", "no-such.csv"], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("cannot read no-such.csv") && !run.err.contains("set-up"), "{}", run.err);
}
