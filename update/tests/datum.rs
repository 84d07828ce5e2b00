//! Parts that were made on one machine and measured on another: the rotation of each is known, and so is the machine.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_update::{Inputs, Method, Options, Rotation, Update, report, update};
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile_word, yaml};
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use recording::{AxisChannels, Instrument, PartDatum, Recording};
use simulation::noise::Source;
use simulation::{Commands, Plant};

const NOISE: f64 = 0.005;

/// What the machine is, and what is known of it.
const TRUTH: &str = "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.04]}}], EYY: [{polynomial: {per: mm, unit: um, coefficients: [0, -0.03]}}], EC0Y: 120 urad";
const KNOWN: &str = "EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.01]}}], EYY: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.01]}}], EC0Y: 1 urad";

struct Bench {
    compiled: Compiled,
}

impl Bench {
    fn new() -> Self {
        Self { compiled: compile_word("XYFZ", &mut Diagnostics::new()).unwrap() }
    }

    fn read(&self, errors: &str) -> Calibration {
        let text = format!(
            "calibration: 1\nmachine: XYFZ\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 80 mm}}\nerrors: {{{errors}}}\n"
        );
        let mut findings = Diagnostics::new();
        let tree = yaml::read(&SourceFile::new("c.yaml", text), &mut findings).unwrap();
        calibration::read(&tree, &self.compiled.equations.names(), &mut findings).unwrap()
    }

    /// A part of 60 points, as far apart as these, made on the exact machine and measured where it lies turned and displaced.
    fn part(&self, span: [f64; 3], turned: [f64; 3], seed: u64) -> Recording {
        let mut source = Source::new(seed, "part");
        let rows = 60;
        let positions: Vec<Vec<f64>> =
            span.iter().map(|span| (0..rows).map(|_| 30.0 + span * source.uniform()).collect()).collect();
        let commands = Commands {
            run: vec![1; rows],
            time: (0..60).map(|row| 10.0 * f64::from(row)).collect(),
            positions,
            ..Commands::default()
        };
        let plant =
            Plant::new(&self.compiled.machine, &self.compiled.equations.names(), &self.read(TRUTH)).unwrap();
        let rotation = Rotation3::from_scaled_axis(Vector3::from(turned));
        let shift = Vector3::from_fn(|_, _| source.normal());
        let mut measured: [Vec<f64>; 3] = Default::default();
        plant
            .run(&commands, |moment| {
                let place = rotation * moment.pose.tip + shift;
                for (column, place) in measured.iter_mut().zip(place.iter()) {
                    column.push(place + NOISE * source.normal());
                }
            })
            .unwrap();
        let axis = |command: &Vec<f64>| AxisChannels { command: Some(command.clone()), ..Default::default() };
        Recording {
            file: format!("part{seed}.yaml"),
            instrument: Instrument::Position,
            datum: PartDatum::Free,
            axes: commands.positions.iter().map(axis).collect(),
            measured: measured.map(Some),
            time: commands.time,
            run: commands.run,
            ..Recording::default()
        }
    }

    /// A plate, read in X and Y alone.
    fn plate(&self, angle: f64, seed: u64) -> Recording {
        let mut plate = self.part([300.0, 250.0, 0.0], [0.0, 0.0, angle], seed);
        plate.measured[2] = None;
        plate
    }

    fn update(&self, known: &Calibration, recordings: &[Recording], options: Options) -> Update {
        let recordings = recordings.iter().collect();
        update(&Inputs { equations: &self.compiled.equations, calibration: known, recordings }, &options)
            .unwrap()
    }
}

fn angles(updated: &Update) -> Vec<(&str, f64)> {
    updated.rotations.iter().map(|one: &Rotation| (one.about, one.angle)).collect()
}

/// Each change beside the truth, in standard uncertainties.
fn off(updated: &Update) -> Vec<(String, f64)> {
    let truth = |name: &str| match name {
        "EXX.polynomial[1]" => 4e-5,
        "EYY.polynomial[1]" => -3e-5,
        "EC0Y.constant" => 120e-6,
        other => panic!("{other}"),
    };
    let changes = updated.changes.iter();
    changes.map(|one| (one.name.clone(), (one.after - truth(&one.name)) / one.uncertainty.unwrap())).collect()
}

#[test]
fn plates_turned_each_by_its_own_angle_show_the_squareness_of_the_machine() {
    let bench = Bench::new();
    let turned = [5.1e-4, -3.5e-4, -4.3e-4, 8.7e-3];
    let plates: Vec<Recording> = (1..).zip(turned).map(|(seed, angle)| bench.plate(angle, seed)).collect();
    for method in [Method::Svd, Method::Select] {
        let updated = bench.update(&bench.read(KNOWN), &plates, Options { method, ..Options::default() });
        assert_eq!(updated.changes.len(), 3);
        for (name, off) in off(&updated) {
            assert!(off.abs() < 3.5, "{method:?} {name}: {off}");
        }
        assert_eq!((updated.zeros, updated.rotations.len()), (8, 4));
        for (one, angle) in updated.rotations.iter().zip(turned) {
            assert_eq!(one.about, "Z");
            assert!((one.angle - angle).abs() < 4.0 * one.uncertainty.unwrap(), "{one:?} {angle}");
        }
        assert!((updated.noise.unwrap() - NOISE).abs() < 0.15 * NOISE, "{:?}", updated.noise);
    }
}

/// The same by the normal equations of one plate, all unknowns at once, written out here.
#[test]
fn angle_and_uncertainty_are_those_of_one_least_squares_fit() {
    let bench = Bench::new();
    let plate = bench.plate(4e-4, 11);
    let updated = bench.update(&bench.read(KNOWN), std::slice::from_ref(&plate), Options::default());
    let position = |axis: usize| plate.axes[axis].command.clone().unwrap();
    let (x, y) = (position(0), position(1));
    let (read_x, read_y) = (plate.measured[0].clone().unwrap(), plate.measured[1].clone().unwrap());
    let rows = x.len();
    // EXX, EYY, EC0Y, which turns the line of Y about Z, two displacements, the rotation about the origin.
    let design = DMatrix::from_fn(2 * rows, 6, |row, column| {
        let (x, y) = (x[row % rows], y[row % rows]);
        let along_x = [x, 0.0, -y, 1.0, 0.0, -y];
        let along_y = [0.0, y, 0.0, 0.0, 1.0, x];
        if row < rows { along_x[column] } else { along_y[column] }
    });
    let wanted = DVector::from_iterator(
        2 * rows,
        read_x.iter().zip(&x).chain(read_y.iter().zip(&y)).map(|(read, place)| read - place),
    );
    let normal = (design.transpose() * &design).try_inverse().unwrap();
    let fit = &normal * design.transpose() * &wanted;
    let left = &wanted - &design * &fit;
    let noise = (left.norm_squared() / (2.0 * 60.0 - 6.0)).sqrt();
    let [one] = updated.rotations.as_slice() else { panic!("{:?}", updated.rotations) };
    // 0.4 mrad times errors of 0.1 mrad, and its own square, are left out here.
    assert!((one.angle - fit[5]).abs() < 2e-7, "{one:?} {}", fit[5]);
    let expected = noise * normal[(5, 5)].sqrt();
    assert!((one.uncertainty.unwrap() - expected).abs() < 1e-3 * expected, "{one:?} {expected}");
    let squareness = updated.changes.iter().find(|change| change.name == "EC0Y.constant").unwrap();
    assert!((squareness.after - fit[2]).abs() < 2e-7, "{squareness:?} {}", fit[2]);
    let expected = noise * normal[(2, 2)].sqrt();
    assert!((squareness.uncertainty.unwrap() - expected).abs() < 1e-3 * expected);
}

#[test]
fn a_rotation_more_of_a_part_changes_nothing_of_the_machine() {
    let bench = Bench::new();
    let known = bench.read(KNOWN);
    let before = bench.part([300.0, 250.0, 120.0], [0.0; 3], 21);
    let one = bench.update(&known, std::slice::from_ref(&before), Options::default());
    // Two degrees about an axis across the room, and a displacement: the readings themselves are turned.
    let turned = [0.021, -0.018, 0.023];
    let rotation = Rotation3::from_scaled_axis(Vector3::from(turned));
    let mut after = before.clone();
    for row in 0..before.time.len() {
        let place = Vector3::from_fn(|part, _| before.measured[part].as_ref().unwrap()[row]);
        let found = rotation * place + Vector3::new(3.0, -1.0, 2.0);
        for (column, found) in after.measured.iter_mut().zip(found.iter()) {
            column.as_mut().unwrap()[row] = *found;
        }
    }
    let other = bench.update(&known, std::slice::from_ref(&after), Options::default());
    assert_eq!(one.changes.len(), 3);
    for (one, other) in one.changes.iter().zip(&other.changes) {
        let uncertainty = one.uncertainty.unwrap();
        assert!((one.after - other.after).abs() < 1e-3 * uncertainty, "{one:?} {other:?}");
    }
    let sizes = |updated: &Update| updated.residuals.last().unwrap().after.rms;
    assert!((sizes(&one) - sizes(&other)).abs() < 1e-3 * sizes(&one));
    let found = other.rotations.iter().zip(&one.rotations).zip(turned);
    for ((other, one), turned) in found {
        assert!((other.angle - one.angle - turned).abs() < 2e-6, "{other:?} {one:?}");
    }
    assert_eq!(other.rotations.len(), 3);
}

#[test]
fn what_turns_the_machine_as_a_whole_is_not_told_from_the_part() {
    let bench = Bench::new();
    let known = bench.read(&format!("{KNOWN}, ECX: 1 urad"));
    let plates = [bench.plate(5e-4, 31), bench.plate(-2e-4, 32)];
    let updated = bench.update(&known, &plates, Options::default());
    let unseen: Vec<&str> = updated.relations.iter().map(|relation| relation.name.as_str()).collect();
    assert_eq!((unseen, updated.relations[0].others.len()), (vec!["ECX.constant"], 0));
    for (name, off) in off(&updated) {
        assert!(off.abs() < 3.5, "{name}: {off}");
    }
    // A part that was not clamped anew tells it.
    let mut clamped = plates.clone();
    clamped[1].datum = PartDatum::Unsaid;
    let updated = bench.update(&known, &clamped, Options::default());
    assert!(updated.relations.is_empty(), "{:?}", updated.relations);
}

/// The zero of a part whose datum is free is free whatever is said of the others.
#[test]
fn a_free_datum_frees_the_zero_too() {
    let bench = Bench::new();
    let mut plates = [bench.plate(5e-4, 41), bench.plate(-2e-4, 42)];
    plates[1].datum = PartDatum::Unsaid;
    let options = Options { datum: [false; 3], ..Options::default() };
    let updated = bench.update(&bench.read(KNOWN), &plates, options);
    assert_eq!((updated.zeros, updated.rotations.len()), (2, 1));
}

#[test]
fn heights_alone_show_a_tilt_and_normals_all_of_it() {
    let bench = Bench::new();
    let tilt = [2e-3, -1e-3, 4e-4];
    let mut heights = bench.part([300.0, 250.0, 0.0], tilt, 51);
    (heights.measured[0], heights.measured[1]) = (None, None);
    let known = bench
        .read(&format!("{KNOWN}, EZZ: [{{polynomial: {{per: mm, unit: um, coefficients: [0, 0.01]}}}}]"));
    let updated = bench.update(&known, &[heights], Options::default());
    let found = angles(&updated);
    assert_eq!(found.iter().map(|(about, _)| *about).collect::<Vec<_>>(), ["X", "Y"]);
    assert!(found.iter().zip(tilt).all(|((_, angle), tilt)| (angle - tilt).abs() < 3e-5), "{found:?}");
    // The same part probed along many normals, as a recording of the instrument `probe` has it.
    let whole = bench.part([300.0, 250.0, 120.0], tilt, 52);
    let mut source = Source::new(52, "normals");
    let normals: Vec<Vector3<f64>> =
        whole.time.iter().map(|_| Vector3::from_fn(|_, _| source.normal()).normalize()).collect();
    let nominal = |row: usize| {
        Vector3::from_fn(|part, _| whole.axes[part].command.as_ref().unwrap()[row] + [0.0, 0.0, 80.0][part])
    };
    let read = |row: usize| Vector3::from_fn(|part, _| whole.measured[part].as_ref().unwrap()[row]);
    let deviation = (0..whole.time.len()).map(|row| normals[row].dot(&(read(row) - nominal(row)))).collect();
    let probed = Recording {
        instrument: Instrument::Probe,
        measured: [None, None, None],
        deviation: Some(deviation),
        normal: Some([0, 1, 2].map(|part: usize| normals.iter().map(|normal| normal[part]).collect())),
        ..whole
    };
    let updated = bench.update(&bench.read(KNOWN), &[probed], Options::default());
    let found = angles(&updated);
    assert_eq!((updated.zeros, found.len()), (3, 3));
    assert!(found.iter().zip(tilt).all(|((_, angle), tilt)| (angle - tilt).abs() < 6e-5), "{found:?}");
}

#[test]
fn a_part_that_was_turned_and_does_not_say_so_is_told() {
    let bench = Bench::new();
    let silent = |angle: f64, seed: u64| Recording { datum: PartDatum::Unsaid, ..bench.plate(angle, seed) };
    let updated = bench.update(&bench.read(KNOWN), &[silent(2e-3, 61), silent(0.0, 62)], Options::default());
    let [hint] = updated.hints.as_slice() else { panic!("{:?}", updated.hints) };
    // 2 mrad are 0.1146 deg; the squareness of 0.12 mrad turns one side a little more.
    assert!(hint.contains(" deg about Z in part61.yaml,") && !hint.contains("part62"), "{hint}");
    assert!(hint.contains("0.11") && hint.contains("`setup: {datum: free}`"), "{hint}");
    assert!(report::text(&updated).contains("The measured deviations show a rotation of the part"));
    // Where it says so there is nothing to tell, and the report has the angle.
    let free = bench.update(&bench.read(KNOWN), &[bench.plate(2e-3, 61)], Options::default());
    assert!(free.hints.is_empty());
    assert!(report::text(&free).contains("part61.yaml: 20"), "{}", report::text(&free));
    let json: serde_json::Value = serde_json::from_str(&report::json(&free)).unwrap();
    let rotation = &json["datum"]["rotations"][0];
    assert_eq!((&rotation["about"], &rotation["angle"]["unit"]), (&"Z".into(), &"rad".into()));
    assert!((rotation["angle"]["value"].as_f64().unwrap() - 2e-3).abs() < 2e-5, "{rotation}");
}
