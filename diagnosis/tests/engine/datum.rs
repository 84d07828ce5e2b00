//! Parts that were clamped anew where they were measured. In: parts that the simulation makes on a machine and turns by known angles.
//! Out: the angles, told of each recording, and of the machine what it is, whatever the angles are.

use abbe_diagnosis::diagnosis::ParameterValue::{Fitted, List};
use abbe_diagnosis::diagnosis::{Diagnosis, Estimate, Parameter, Verdict};
use nalgebra::{Rotation3, Vector3};
use simulation::noise::{Noise, Source};
use simulation::{Commands, Datum, Instrument as Reads, Measurement, Normal, replay};

use crate::common::*;
use crate::recording::{PartDatum, Recording};
use crate::testing::*;

/// Standard deviation of the noise, mm.
const SIGMA: f64 = 0.003;

/// A part of 90 points somewhere in a box, one every ten seconds, read where it lies.
fn part(
    bench: &Bench,
    errors: &str,
    size: [f64; 3],
    reads: Reads,
    datum: Option<Datum>,
    seed: u64,
) -> Recording {
    let mut source = Source::new(seed, "points");
    let rows = 90;
    let commands = Commands {
        time: (0..90).map(|row| 10.0 * f64::from(row)).collect(),
        run: vec![1; rows],
        positions: size.map(|size| (0..rows).map(|_| size * (source.uniform() - 0.4)).collect()).into(),
        ..Commands::default()
    };
    let noise = Noise::white(SIGMA);
    let measurement = Measurement { noise, datum, seed, ..Measurement::perfect(reads) };
    let plant = bench.plant(&bench.calibration(errors));
    let file = format!("part{seed}.yaml");
    Recording { file, ..recording(replay(&plant, &commands, &measurement).unwrap()) }
}

fn plate(bench: &Bench, errors: &str, angle: Option<f64>, seed: u64) -> Recording {
    let reads = Reads::Position { directions: [true, true, false], angles: Vec::new() };
    let datum = angle.map(|c| Datum { displacement: [0.4, -0.3, 0.0], rotation: [0.0, 0.0, c] });
    part(bench, errors, [320.0, 260.0, 0.0], reads, datum, seed)
}

fn told(bench: &Bench, parts: &[Recording]) -> Diagnosis {
    let parts: Vec<&Recording> = parts.iter().collect();
    diagnosed(bench, &bench.calibration("{}"), &parts)
}

const SQUARENESS: &str = "{EC0Y: 120 urad}";

#[test]
fn plates_turned_each_by_its_own_angle_show_the_squareness_of_the_machine() {
    let bench = Bench::of("XYFZ");
    let angles = [5.1e-4, -3.5e-4, -4.3e-4, 8.7e-3];
    let plates: Vec<Recording> =
        (1..).zip(angles).map(|(seed, angle)| plate(&bench, SQUARENESS, Some(angle), seed)).collect();
    let diagnosis = told(&bench, &plates);
    assert_eq!(found(&diagnosis), ["EC0Y constant"], "{diagnosis:#?}");
    assert!(off(&numbers(&diagnosis.findings[0], "value")[0], 120e-6) < FAR);
    assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
    assert!((diagnosis.after.rms - SIGMA).abs() < 0.1 * SIGMA, "{:?}", diagnosis.after);
    assert_eq!(diagnosis.settings.len(), 4);
    for (number, angle) in angles.into_iter().enumerate() {
        let own: Vec<_> =
            diagnosis.settings.iter().filter(|setting| setting.recording == number).cloned().collect();
        assert_eq!(own[0].parameters.len(), 1);
        let c = setting(&own, "datum", "c");
        assert!(off(&c, angle) < FAR && c.unit == "rad", "{c:?} {angle}");
    }
    let turns = "cannot show whether the machine rotates all parts about Z by a constant angle";
    assert!(diagnosis.undecided.iter().any(|sentence| sentence.contains(turns)), "{:?}", diagnosis.undecided);
}

#[test]
fn a_rotation_alone_is_no_error_of_the_machine() {
    let bench = Bench::of("XYFZ");
    let diagnosis = told(&bench, &[plate(&bench, "{}", Some(4e-3), 11)]);
    assert_eq!((diagnosis.verdict, found(&diagnosis)), (Verdict::Adequate, Vec::new()));
    assert!(off(&setting(&diagnosis.settings, "datum", "c"), 4e-3) < FAR);
    // A part that lies as its frame says has nothing to tell.
    let straight = told(&bench, &[plate(&bench, "{}", Some(0.0), 12)]);
    assert_eq!((straight.verdict, straight.settings.len()), (Verdict::Adequate, 0));
}

#[test]
fn a_rotation_more_of_a_part_changes_nothing_of_the_machine() {
    let bench = Bench::of("XYFZ");
    let errors = "{EC0Y: 90 urad, EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.1]}}], EZY: [{polynomial: {axis: Y, per: mm, unit: um, coefficients: [0, 0, 4e-4]}}]}";
    let size = [320.0, 260.0, 140.0];
    let lying = |rotation: [f64; 3]| Some(Datum { displacement: [0.1, 0.2, -0.3], rotation });
    let before = part(&bench, errors, size, Reads::position(), lying([0.0; 3]), 21);
    // A degree and more, about an axis across the room: the readings themselves are turned.
    let turned = [0.021, -0.018, 0.013];
    let rotation = Rotation3::from_scaled_axis(Vector3::from(turned));
    let mut after = before.clone();
    for row in 0..before.time.len() {
        let place = Vector3::from_fn(|axis, _| before.measured[axis].as_ref().unwrap()[row]);
        for (column, found) in after.measured.iter_mut().zip((rotation * place).iter()) {
            column.as_mut().unwrap()[row] = *found;
        }
    }
    let (one, other) = (told(&bench, &[before]), told(&bench, &[after]));
    assert_eq!(found(&one), found(&other));
    assert!(one.findings.len() >= 2, "{:?}", found(&one));
    for (one, other) in one.findings.iter().zip(&other.findings) {
        for (one, other) in one.parameters.iter().zip(&other.parameters) {
            assert!(agree(one, other), "{one:?} {other:?}");
        }
    }
    assert!((one.after.rms - other.after.rms).abs() < 1e-3 * one.after.rms);
    for (name, angle) in ["a", "b", "c"].into_iter().zip(turned) {
        assert!(off(&setting(&other.settings, "datum", name), angle) < FAR, "{name}");
    }
}

/// Whether fitted numbers are the same within a twentieth of their interval.
fn agree(one: &Parameter, other: &Parameter) -> bool {
    let same = |one: &Estimate, other: &Estimate| {
        (one.value - other.value).abs() <= 0.05 * (one.ci95.1 - one.ci95.0).abs()
    };
    match (&one.value, &other.value) {
        (Fitted(one), Fitted(other)) => same(one, other),
        (List(one), List(other)) => {
            one.len() == other.len() && one.iter().zip(other).all(|(one, other)| same(one, other))
        }
        (one, other) => one == other,
    }
}

#[test]
fn a_probed_part_lies_displaced_too() {
    let bench = Bench::of("XYFZ");
    let datum = Datum { displacement: [0.0; 3], rotation: [2e-3, -1e-3, 0.0] };
    let probe = |normal| Reads::Probe { normal };
    let above = probe(Normal::Fixed([0.0, 0.0, 1.0]));
    let flat = part(&bench, "{}", [320.0, 260.0, 0.0], above, Some(datum), 31);
    let diagnosis = told(&bench, &[flat]);
    assert_eq!((diagnosis.verdict, diagnosis.settings.len()), (Verdict::Adequate, 1), "{diagnosis:#?}");
    for (name, angle) in [("a", 2e-3), ("b", -1e-3)] {
        assert!(off(&setting(&diagnosis.settings, "datum", name), angle) < FAR, "{name}");
    }
    // All normals lead away from a centre, so that a rotation about the middle of these points moves them along the surface alone.
    let around = probe(Normal::Radial(Some([0.0, 0.0, f64::NAN])));
    let shifted = Datum { displacement: [0.05, -0.08, 0.0], rotation: [0.0; 3] };
    let ring = part(&bench, "{}", [320.0, 260.0, 0.0], around, Some(shifted), 32);
    let diagnosis = told(&bench, &[ring]);
    assert_eq!(diagnosis.verdict, Verdict::Adequate, "{diagnosis:#?}");
    for (name, shift) in [("x", 0.05), ("y", -0.08)] {
        assert!(off(&setting(&diagnosis.settings, "datum", name), shift) < FAR, "{name}");
    }
}

/// All that is claimed of the machine and of the instruments' settings, with its values.
fn claimed(diagnosis: &Diagnosis) -> Vec<(&str, &[Parameter])> {
    let findings =
        diagnosis.findings.iter().map(|finding| (finding.motion.as_str(), &finding.parameters[..]));
    let settings = diagnosis.settings.iter().map(|setting| (setting.term, &setting.parameters[..]));
    findings.chain(settings).collect()
}

#[test]
fn the_datum_of_a_part_that_a_rotation_explains_is_free_and_told() {
    let bench = Bench::of("XYFZ");
    let hint = |diagnosis: &Diagnosis| {
        diagnosis.undecided.iter().find(|sentence| sentence.contains("`setup: {datum: fixed}`")).cloned()
    };
    for (errors, number) in [("{}", 41), (SQUARENESS, 43)] {
        let free = plate(&bench, errors, Some(2e-3), number);
        let saying = |datum| told(&bench, &[Recording { datum, ..free.clone() }]);
        let (silent, free) = (saying(PartDatum::Unsaid), saying(PartDatum::Free));
        let sentence = hint(&silent).unwrap();
        assert!(sentence.contains("about Z in part") && hint(&free).is_none(), "{sentence}");
        assert_eq!((silent.verdict, claimed(&silent)), (free.verdict, claimed(&free)));
        // As its frame says, the machine must have rotated it.
        let fixed = saying(PartDatum::Fixed);
        assert_eq!((hint(&fixed), fixed.verdict, fixed.settings.len()), (None, Verdict::LeftOutPhysics, 0));
    }
    // 2 mrad are 0.1146 deg.
    let turned = Recording { datum: PartDatum::Unsaid, ..plate(&bench, "{}", Some(2e-3), 41) };
    let sentence = hint(&told(&bench, &[turned])).unwrap();
    assert!(sentence.contains("0.114") && sentence.contains("in part41.yaml"), "{sentence}");
    // A squareness turns one side alone.
    let square = Recording { datum: PartDatum::Unsaid, ..plate(&bench, SQUARENESS, None, 42) };
    let diagnosis = told(&bench, &[square]);
    assert_eq!((hint(&diagnosis), diagnosis.verdict), (None, Verdict::LeftOutPhysics));
}

/// Among points in no order, 0.3 mm of backlash hide what 0.4 mrad do, 0.1 mm: only beside it the part shows its rotation.
#[test]
fn the_rotation_of_a_part_is_told_beneath_a_larger_effect() {
    let bench = Bench::of("XYFZ");
    let errors = "{EXX: [{backlash: {axis: X, lost_motion: 0.3 mm}}]}";
    let turned = Recording { datum: PartDatum::Unsaid, ..plate(&bench, errors, Some(4e-4), 61) };
    let diagnosis = told(&bench, &[turned]);
    assert_eq!(found(&diagnosis), ["EXX backlash"], "{diagnosis:#?}");
    assert!(off(&setting(&diagnosis.settings, "datum", "c"), 4e-4) < FAR);
    assert!(diagnosis.undecided.iter().any(|sentence| sentence.contains("`setup: {datum: fixed}`")));
}

#[test]
fn a_line_of_points_that_shows_no_rotation_says_so() {
    let bench = Bench::of("XYFZ");
    let reads = Reads::Position { directions: [true, false, false], angles: Vec::new() };
    let line = part(&bench, "{}", [320.0, 0.0, 0.0], reads, Some(Datum::default()), 51);
    let diagnosis = told(&bench, &[line]);
    let turned = "The rotation of the part of part51.yaml cannot be decided";
    assert!(
        diagnosis.undecided.iter().any(|sentence| sentence.starts_with(turned)),
        "{:?}",
        diagnosis.undecided
    );
    assert_eq!(diagnosis.settings.len(), 0);
}
