//! Updates of machines whose truth is known: the exact machine, which shares no code with the equations, is measured, and
//! what an update says of it must hold.

#![expect(
    clippy::unwrap_used,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_update::{Inputs, Method, Options, Update, UpdateError, update};
use model_dsl::calibration::{self, CalibratedTerm, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile_word, yaml};
use nalgebra::{DMatrix, DVector};
use recording::{AxisChannels, Instrument, Named, Recording};
use simulation::noise::Source;
use simulation::{Column, Commands, Plant};

/// All terms that a point can show, with directions, memories and derived sensors.
const EVERYTHING: &str = "calibration: 1
machine: XYFZ
constants: {Xt: 0 mm, Yt: 5 mm, Zt: 120 mm}
sensors: {mean: {mean: [T1, T2]}, start: {initial: T1}}
errors:
  EXX:
    - table: {at: [0, 60, 200], per: mm, unit: um, forward: [1, -4, 6], reverse: [2, 3, -5]}
    - backlash: {lost_motion: 8 um, wind_up: 3 mm}
    - cyclic: {period: 11 mm, amplitude: 2 um, phase: 40 deg}
    - expansion: {sensor: mean, coefficient: 9 um/m/K, reference: 20 degC}
  EYX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.03, -0.0002]}}]
  EBX: [{polynomial: {per: mm, unit: urad, coefficients: [5, 0.04]}}]
  EYY: [{polynomial: {per: mm, unit: um, coefficients: [2, 0.05]}}, {backlash: {lost_motion: 5 um}}]
  EZZ: [{growth: {sensor: T1, coefficient: 2 um/K, reference: 20 degC}}, {polynomial: {sensor: start, unit: um, coefficients: [0, 0.4]}}]
  ECY: [{coupling: {axis: X, per: mm, unit: urad, coefficients: [0.05]}}]
  EC0Y: 30 urad
";

struct Bench {
    compiled: Compiled,
}

impl Bench {
    fn new() -> Self {
        Self { compiled: compile_word("XYFZ", &mut Diagnostics::new()).unwrap() }
    }

    fn read(&self, text: &str) -> Calibration {
        let mut findings = Diagnostics::new();
        let tree = yaml::read(&SourceFile::new("c.yaml", text), &mut findings).unwrap();
        calibration::read(&tree, &self.compiled.equations.names(), &mut findings).unwrap()
    }

    /// Points up, down and across the room, measured in X, Y and Z on the exact machine; two runs.
    fn measured(&self, truth: &Calibration, noise: f64, seed: u64) -> Recording {
        let mut source = Source::new(seed, "bench");
        let rows = 90;
        let walk = |span: f64, source: &mut Source| -> Vec<f64> {
            (0..rows).map(|_| span * source.uniform()).collect()
        };
        let time: Vec<f64> = (0..rows).map(|row| 5.0 * f64::from(row)).collect();
        let warm = |name: &str, rate: f64| Column {
            name: name.to_owned(),
            unit: "degC".to_owned(),
            values: time.iter().map(|time| 20.5 + rate * time / 100.0).collect(),
        };
        let commands = Commands {
            run: (0..rows).map(|row| i64::from(row / 45) + 1).collect(),
            positions: vec![walk(200.0, &mut source), walk(150.0, &mut source), walk(-100.0, &mut source)],
            temperatures: vec![warm("T1", 1.0), warm("T2", 0.3)],
            time,
            ..Commands::default()
        };
        let names = self.compiled.equations.names();
        let plant = Plant::new(&self.compiled.machine, &names, truth).unwrap();
        let mut tips: [Vec<f64>; 3] = Default::default();
        plant
            .run(&commands, |moment| {
                for (tip, place) in tips.iter_mut().zip(moment.pose.tip.iter()) {
                    tip.push(place + noise * source.normal());
                }
            })
            .unwrap();
        let axis = |command: &Vec<f64>| AxisChannels { command: Some(command.clone()), ..Default::default() };
        let named = |column: &Column| Named {
            name: column.name.clone(),
            unit: column.unit.clone(),
            values: column.values.clone(),
        };
        Recording {
            file: "bench.yaml".to_owned(),
            instrument: Instrument::Position,
            axes: commands.positions.iter().map(axis).collect(),
            measured: tips.map(Some),
            temperatures: commands.temperatures.iter().map(named).collect(),
            time: commands.time,
            run: commands.run,
            ..Recording::default()
        }
    }

    fn update(
        &self,
        known: &Calibration,
        recordings: &[&Recording],
        options: Options,
    ) -> Result<Update, UpdateError> {
        let inputs = Inputs {
            equations: &self.compiled.equations,
            calibration: known,
            recordings: recordings.to_vec(),
        };
        update(&inputs, &options)
    }
}

fn absolute(method: Method) -> Options {
    Options { method, datum: [false; 3], ..Options::default() }
}

fn rms(update: &Update) -> [f64; 2] {
    let all = update.residuals.last().unwrap();
    [all.before.rms, all.after.rms]
}

#[test]
fn the_right_calibration_leaves_what_is_of_second_order() {
    let bench = Bench::new();
    let truth = bench.read(EVERYTHING);
    let recording = bench.measured(&truth, 0.0, 1);
    for method in [Method::Svd, Method::Ridge, Method::Select] {
        let updated = bench.update(&truth, &[&recording], absolute(method)).unwrap();
        assert_eq!(updated.points, 270);
        // Errors of 30 um and 40 urad: their products are below a few nm.
        assert!(rms(&updated)[0] < 3e-6, "{:?}", rms(&updated));
        assert!(method != Method::Select || updated.changes.is_empty());
    }
    // Errors are there, and count.
    let without = bench.read(&EVERYTHING.replace("-4, 6", "-4, 90"));
    assert!(rms(&bench.update(&without, &[&recording], absolute(Method::Svd)).unwrap())[0] > 1e-3);
}

#[test]
fn one_wrong_coefficient_is_found_by_select_and_met_by_all() {
    let bench = Bench::new();
    let truth = bench.read(EVERYTHING);
    let recording = bench.measured(&truth, 0.0002, 2);
    let cases = [
        ("EXX.backlash.lost_motion", "8 um", "11 um", 8e-3),
        ("EYX.polynomial[1]", "[0, 0.03, -0.0002]", "[0, 0.05, -0.0002]", 3e-5),
        ("EXX.expansion(mean).coefficient", "9 um/m/K", "14 um/m/K", 9e-6),
        ("ECY.coupling(X)[1]", "[0.05]", "[0.09]", 5e-8),
        ("EC0Y.constant", "30 urad", "50 urad", 3e-5),
        ("EXX.cyclic.amplitude", "amplitude: 2 um", "amplitude: 4 um", 2e-3),
    ];
    for (name, right, wrong, value) in cases {
        let known = bench.read(&EVERYTHING.replacen(right, wrong, 1));
        let [svd, ridge, select] = [Method::Svd, Method::Ridge, Method::Select].map(|method| {
            bench.update(&known, &[&recording], Options { method, ..Options::default() }).unwrap()
        });
        for updated in [&svd, &ridge, &select] {
            assert!(
                rms(updated)[1] < 0.00022 && rms(updated)[1] < rms(updated)[0],
                "{name}: {:?}",
                rms(updated)
            );
        }
        let [change] = select.changes.as_slice() else { panic!("{name}: {:#?}", select.changes) };
        assert_eq!(change.name, name);
        let uncertainty = change.uncertainty.unwrap();
        assert!((change.after - value).abs() < 4.0 * uncertainty, "{name}: {change:?}");
        // The file has it, and nothing else is different.
        let again = bench.update(&select.calibration, &[&recording], Options::default()).unwrap();
        assert!((rms(&again)[0] - rms(&select)[1]).abs() < 1e-9);
    }
}

/// The same points as lengths from a centre, which is somewhat elsewhere than declared: a ballbar, or calipers over a part.
fn lengths(points: &Recording, center: [f64; 3], declared: [f64; 3]) -> Recording {
    const RADIUS: f64 = 100.0;
    let [x, y, z] = points.measured.each_ref().map(|column| column.clone().unwrap());
    let length = |row: usize| {
        let arm = [x[row] - center[0], y[row] - center[1], z[row] - center[2]];
        arm.iter().map(|part| part * part).sum::<f64>().sqrt()
    };
    Recording {
        instrument: Instrument::Ballbar { center: declared, radius: RADIUS },
        deviation: Some((0..x.len()).map(|row| length(row) - RADIUS).collect()),
        measured: Default::default(),
        ..points.clone()
    }
}

/// Lengths from three places around the room tell scales and squarenesses, wherever these places really are.
#[test]
fn lengths_tell_scales_and_squarenesses() {
    let bench = Bench::new();
    let text = |scales: [f64; 3], square: [f64; 3]| {
        let [x, y, z] = scales;
        let [c0y, a0z, b0z] = square;
        format!(
            "calibration: 1\nmachine: XYFZ\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 50 mm}}\nerrors:\n  EXX: [{{polynomial: {{per: mm, unit: um, coefficients: [0, {x}]}}}}]\n  EYY: [{{polynomial: {{per: mm, unit: um, coefficients: [0, {y}]}}}}]\n  EZZ: [{{polynomial: {{per: mm, unit: um, coefficients: [0, {z}]}}}}]\n  EC0Y: {c0y} urad\n  EA0Z: {a0z} urad\n  EB0Z: {b0z} urad\n"
        )
    };
    let (scales, square) = ([0.05, -0.08, 0.03], [60.0, -40.0, 25.0]);
    let truth = bench.read(&text(scales, square));
    let known = bench.read(&text([0.01; 3], [10.0; 3]));
    let recordings: Vec<Recording> = [[-80.0, -60.0, 40.0], [290.0, 200.0, 60.0], [100.0, -90.0, -180.0]]
        .into_iter()
        .zip(20..)
        .map(|(center, seed)| {
            let declared = [center[0] + 0.005, center[1] - 0.003, center[2] + 0.004];
            lengths(&bench.measured(&truth, 0.0, seed), center, declared)
        })
        .collect();
    let recordings: Vec<&Recording> = recordings.iter().collect();
    let updated = bench.update(&known, &recordings, Options::default()).unwrap();
    let names = ["EXX", "EYY", "EZZ"].map(|name| format!("{name}.polynomial[1]"));
    let squares = ["EC0Y", "EA0Z", "EB0Z"].map(|name| format!("{name}.constant"));
    let expected = scales.map(|scale| scale * 1e-3).into_iter().chain(square.map(|square| square * 1e-6));
    for (name, expected) in names.iter().chain(&squares).zip(expected) {
        let change = updated.changes.iter().find(|change| change.name == *name).unwrap();
        // What is across a length of 100 mm, 10 um of it, makes it longer by less than a nm: some 1e-3 of these errors.
        assert!((change.after - expected).abs() < 2e-3 * expected.abs(), "{change:?} {expected}");
    }
    assert!(rms(&updated)[1] < 1e-6 && rms(&updated)[0] > 1e-3, "{:?}", rms(&updated));
}

#[test]
fn a_table_is_moved_as_a_whole_and_its_zeros_stand() {
    let bench = Bench::new();
    let text = "calibration: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 50 mm}\nerrors:\n  EXX:\n    - polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}\n    - table: {at: [0, 70, 130, 200], per: mm, unit: um, values: [0, 4, -6, 5]}\n";
    let truth = bench.read(&text.replace("4, -6, 5", "9, -2, 8"));
    let recording = bench.measured(&truth, 0.0002, 8);
    let options = Options { method: Method::Select, ..Options::default() };
    let updated = bench.update(&bench.read(text), &[&recording], options).unwrap();
    let mut names: Vec<&str> = updated.changes.iter().map(|change| change.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["EXX.table[1]", "EXX.table[2]", "EXX.table[3]"]);
    assert!(updated.fixed.iter().any(|fixed| fixed.name == "EXX.table[0]"));
    let after = |name: &str| updated.changes.iter().find(|change| change.name == name).unwrap().after;
    assert!(
        [("EXX.table[1]", 9e-3), ("EXX.table[2]", -2e-3), ("EXX.table[3]", 8e-3)]
            .iter()
            .all(|(name, value)| (after(name) - value).abs() < 4e-4)
    );
}

/// The ends of a table that repeats are one place: they are one coefficient, and stay one value.
#[test]
fn the_ends_of_a_table_that_repeats_are_one_coefficient() {
    let bench = Bench::new();
    let text = |values: &str| {
        format!(
            "calibration: 1\nmachine: XYFZ\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 50 mm}}\nerrors:\n  EXX: [{{table: {{start: 0 mm, step: 10 mm, period: 40 mm, unit: um, values: [{values}]}}}}]\n"
        )
    };
    let recording = bench.measured(&bench.read(&text("9, -6, 4, 7")), 0.0, 9);
    let known = bench.read(&text("3, -2, 1, 5"));
    let updated = bench.update(&known, &[&recording], absolute(Method::Svd)).unwrap();
    let mut names: Vec<&str> = updated.changes.iter().map(|change| change.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["EXX.table[0]", "EXX.table[1]", "EXX.table[2]", "EXX.table[3]"]);
    let CalibratedTerm::Table { curve, .. } = &updated.calibration.motions[0].terms[0].value else {
        panic!()
    };
    let expected = [9e-3, -6e-3, 4e-3, 7e-3, 9e-3];
    // There is no noise: what is left is the error over the way of the error, some 1e-3 of it at the steepest.
    let close =
        curve.values.forward().iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-5);
    assert!(close && curve.repeats, "{curve:?}");
    assert_eq!(curve.values.forward().first(), curve.values.forward().last());
}

#[test]
fn uncertainties_cover_the_truth() {
    let bench = Bench::new();
    let truth = bench.read(EVERYTHING);
    let (mut inside, mut all) = (0, 0);
    for seed in 0..20 {
        let recording = bench.measured(&truth, 0.001, 50 + seed);
        let updated = bench.update(&truth, &[&recording], Options::default()).unwrap();
        for change in updated.changes.iter().filter(|change| change.determined) {
            inside += usize::from((change.after - change.before).abs() < 2.0 * change.uncertainty.unwrap());
            all += 1;
        }
    }
    // 95 of 100 in the mean; several hundred, though not independent.
    assert!(all > 200 && (90 * all..=99 * all).contains(&(100 * inside)), "{inside} of {all}");
}

#[test]
fn relations_hold_at_every_point() {
    let bench = Bench::new();
    // A second scale, a second constant, and a temperature that stands still.
    let text = "calibration: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 50 mm}\nerrors:\n  EXX:\n    - polynomial: {per: mm, unit: um, coefficients: [3, 0.1]}\n    - polynomial: {per: mm, unit: um, coefficients: [0, 0.2]}\n  EYX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.1]}}]\n  EC0Y: 20 urad\n  EZZ: 4 um\n";
    let known = bench.read(text);
    let recording = bench.measured(&known, 0.0, 3);
    let updated = bench.update(&known, &[&recording], Options::default()).unwrap();
    let relations: Vec<(&str, Vec<&str>)> = updated
        .relations
        .iter()
        .map(|one| (one.name.as_str(), one.others.iter().map(String::as_str).collect()))
        .collect();
    // Constants go into the zeros; the second scale is the first.
    let expected = vec![
        ("EXX.polynomial[0]", vec![]),
        ("EXX.polynomial#2[1]", vec!["EXX.polynomial[1]"]),
        ("EZZ.constant", vec![]),
    ];
    assert_eq!(relations, expected);
    assert_eq!((updated.unknowns, updated.rank), (6, 3));
}

#[test]
fn held_out_runs_are_not_fitted() {
    let bench = Bench::new();
    let truth = bench.read(EVERYTHING);
    let mut recording = bench.measured(&truth, 0.0, 4);
    recording.holdout = Some(vec![2]);
    let known = bench.read(&EVERYTHING.replace("30 urad", "60 urad"));
    let options = Options { method: Method::Select, ..Options::default() };
    let updated = bench.update(&known, &[&recording], options).unwrap();
    assert_eq!((updated.parts[0].points, updated.parts[0].held_out), (135, 135));
    let held_out = updated.held_out.last().unwrap();
    assert!(held_out.before.rms > 5e-4 && held_out.after.rms < 5e-6);
    // What they read does not reach the fit.
    let mut other = recording.clone();
    for column in other.measured.iter_mut().flatten() {
        column.iter_mut().skip(45).for_each(|value| *value += 7.0);
    }
    assert_eq!(bench.update(&known, &[&other], options).unwrap().calibration, updated.calibration);
}

#[test]
fn a_compensated_part_shows_what_was_left() {
    let bench = Bench::new();
    let truth = bench.read(EVERYTHING);
    let known = bench.read(&EVERYTHING.replace("30 urad", "60 urad"));
    let plain = bench.measured(&truth, 0.0, 5);
    // To first order the machine takes its own prediction off: what a perfect nominal would read.
    let predicted = bench.measured(&known, 0.0, 5);
    let mut left = plain.clone();
    for part in 0..3 {
        let predicted = predicted.measured[part].clone().unwrap();
        let nominal = [&plain.axes[0], &plain.axes[1], &plain.axes[2]][part].command.clone().unwrap();
        let offset = [0.0, 5.0, 120.0][part];
        let column = left.measured[part].as_mut().unwrap();
        for row in 0..column.len() {
            column[row] -= predicted[row] - nominal[row] - offset;
        }
    }
    let one = bench.update(&known, &[&plain], Options::default()).unwrap();
    let options = Options { compensated: true, ..Options::default() };
    let other = bench.update(&known, &[&left], options).unwrap();
    assert!(!one.residuals.is_empty() && one.residuals.len() == other.residuals.len());
    for (one, other) in one.residuals.iter().zip(&other.residuals) {
        assert!((one.before.rms - other.before.rms).abs() < 2e-6, "{one:?} {other:?}");
    }
}

#[test]
fn leave_one_out_is_what_leaving_one_out_gives() {
    let bench = Bench::new();
    let truth = bench.read("calibration: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 50 mm}\nerrors: {EXX: [{polynomial: {per: mm, unit: um, coefficients: [3, 0.1]}}], EC0Y: 20 urad}\n");
    let mut recording = bench.measured(&truth, 0.002, 6);
    recording.measured[1] = None;
    recording.measured[2] = None;
    let updated = bench.update(&truth, &[&recording], absolute(Method::Svd)).unwrap();
    // The three effects on X by hand: 1, x and the squareness, on the part's branch against y.
    let position = |axis: usize| recording.axes[axis].command.clone().unwrap();
    let (x, y, read) = (position(0), position(1), recording.measured[0].clone().unwrap());
    let rows = x.len();
    let design = DMatrix::from_fn(rows, 3, |row, column| [1.0, x[row], y[row]][column]);
    let wanted = DVector::from_iterator(rows, (0..rows).map(|row| read[row] - x[row]));
    let left_out = |out: usize| {
        let (less, target) = (design.clone().remove_row(out), wanted.clone().remove_row(out));
        let fit = less.svd(true, true).solve(&target, 1e-14).unwrap();
        wanted[out] - (design.row(out) * fit)[0]
    };
    let brute = ((0..rows).map(|row| left_out(row).powi(2)).sum::<f64>() / 90.0).sqrt();
    let told = updated.leave_one_out[1].unwrap();
    assert!((brute - told).abs() < 1e-6 * brute, "{brute} {told}");
}

#[test]
fn what_cannot_serve_is_refused() {
    let bench = Bench::new();
    let truth = bench.read(EVERYTHING);
    let recording = bench.measured(&truth, 0.0, 7);
    let refused = |known: &Calibration, recording: &Recording| {
        bench.update(known, &[recording], Options::default()).err().unwrap()
    };
    let mut cold = recording.clone();
    cold.temperatures.remove(1);
    assert_eq!(refused(&truth, &cold), UpdateError::NoTemperature { recording: 0, sensor: "T2".to_owned() });
    let level = Instrument::Angular { axis: None, about: [0.0, 0.0, 1.0] };
    let angular = Recording { instrument: level, ..recording.clone() };
    assert_eq!(refused(&truth, &angular), UpdateError::Instrument { recording: 0 });
    let mut empty = recording.clone();
    for column in empty.measured.iter_mut().flatten() {
        column.fill(f64::NAN);
    }
    assert_eq!(refused(&truth, &empty), UpdateError::NoPoints);
    let zero = bench.read(
        "calibration: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors: {EXX: 0 um}\n",
    );
    assert_eq!(refused(&zero, &recording), UpdateError::NothingToMove);
    // A single reading is no mistake: it says little.
    let mut single = recording.clone();
    for column in single.measured.iter_mut().flatten() {
        column.iter_mut().skip(1).for_each(|value| *value = f64::NAN);
    }
    for method in [Method::Svd, Method::Ridge, Method::Select] {
        let options = Options { method, ..Options::default() };
        let updated = bench.update(&truth, &[&single], options).unwrap();
        assert_eq!((updated.points, updated.rank, updated.noise), (3, 0, None));
    }
}
