//! The audit: recordings of the exact machine beside files that are wrong in one place.
//!
//! In: the right files of a mill, and the same with a fault. Out: what to change, with the right value; nothing where the files are
//! right, and nothing beside it.

use abbe_diagnosis::diagnose;
use abbe_diagnosis::diagnosis::{Change, Diagnosis, Estimate, ParameterValue, Verdict};
use model_dsl::calibration::Calibration;
use simulation::noise::Walk;
use simulation::path::Shape;
use simulation::{Instrument as Reads, Path, Scenario};

use crate::common::*;
use crate::recording::Recording;
use crate::testing::*;

/// A measured curve: its motion, the axis that it is written for, the place of its first node and its values, um or urad.
#[derive(Clone, Copy)]
struct Curve {
    motion: &'static str,
    axis: &'static str,
    start: f64,
    values: [f64; 6],
}

const STEP: f64 = 100.0;

const fn curve(motion: &'static str, axis: &'static str, values: [f64; 6]) -> Curve {
    Curve { motion, axis, start: 0.0, values }
}

/// The curves of a mill: displacements of some 10 um, angles of some 50 urad.
const CURVES: [Curve; 8] = [
    curve("EXX", "X", [0.0, 9.0, -6.0, 12.0, 3.0, -8.0]),
    curve("EYX", "X", [0.0, -7.0, 2.0, 8.0, -5.0, -11.0]),
    curve("EBX", "X", [0.0, 60.0, -20.0, -50.0, 10.0, 40.0]),
    curve("ECX", "X", [0.0, -30.0, 40.0, 70.0, 20.0, -60.0]),
    curve("EYY", "Y", [0.0, 10.0, 4.0, -9.0, 0.0, 0.0]),
    curve("EXY", "Y", [0.0, -6.0, 9.0, 2.0, 0.0, 0.0]),
    curve("EAY", "Y", [0.0, 45.0, -35.0, 25.0, 0.0, 0.0]),
    curve("ECY", "Y", [0.0, -20.0, 50.0, -40.0, 0.0, 0.0]),
];

/// The errors of a mill with these curves, and the squareness of its table in urad.
fn errors(curves: &[Curve], square: f64) -> String {
    let written = curves.iter().map(|curve| {
        let unit = if curve.motion.contains(['A', 'B', 'C']) { "urad" } else { "um" };
        format!(
            "{}: [{{table: {{axis: {}, start: {} mm, step: {STEP} mm, unit: {unit}, values: {:?}}}}}]",
            curve.motion, curve.axis, curve.start, curve.values
        )
    });
    let written: Vec<String> = written.chain([format!("EC0Y: {square} urad")]).collect();
    format!("{{{}}}", written.join(", "))
}

const SQUARE: f64 = 80.0;

fn right(bench: &Bench) -> Calibration {
    bench.calibration(&errors(&CURVES, SQUARE))
}

/// The curves with one of them changed.
fn with(motion: &str, change: impl Fn(&mut Curve)) -> Vec<Curve> {
    let mut curves = CURVES.to_vec();
    curves.iter_mut().filter(|curve| curve.motion == motion).for_each(change);
    curves
}

/// Three runs through the room of a mill: X and Y in turn, at two heights.
fn through_the_room(seed: u64) -> Scenario {
    let round = |height: f64| {
        let corners = [(0, 480.0), (1, 280.0), (0, 20.0), (1, 150.0), (0, 480.0), (1, 20.0), (0, 20.0)];
        std::iter::once(vec![(2, height)]).chain(corners.map(|corner| vec![corner]))
    };
    let start = vec![(0, 20.0), (1, 20.0), (2, -90.0)];
    let points = std::iter::once(start).chain(round(-90.0)).chain(round(-10.0));
    let path = Path { runs: 3, ..path(Shape::Points(points.collect()), 50.0, 4.0) };
    noisy(path, position("xyz"), 0.5e-3, seed)
}

/// The diagnosis with the machine's word open to doubt.
fn audited(bench: &Bench, known: &Calibration, recording: &Recording) -> Diagnosis {
    diagnose(&bench.audited(known, recording), &mut |_| {})
}

/// The only change that is told, and no physics beside it.
#[track_caller]
fn only_change(diagnosis: &Diagnosis) -> &Change {
    assert_eq!(found(diagnosis), Vec::<String>::new(), "{:?}", diagnosis.model);
    let [change] = diagnosis.model.as_slice() else {
        panic!("{:?}, {:?}", diagnosis.model, diagnosis.before)
    };
    assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
    assert!(change.evidence.with < change.evidence.without, "{change:?}");
    change
}

/// The number that a change gives.
#[track_caller]
fn amount(change: &Change) -> &Estimate {
    match change.amount.as_ref().map(|amount| &amount.value) {
        Some(ParameterValue::Fitted(estimate)) => estimate,
        other => panic!("{other:?} of {change:?}"),
    }
}

#[test]
fn right_files_are_left_alone() {
    let bench = Bench::of("FXYZ");
    let known = right(&bench);
    for seed in 1..=5 {
        let diagnosis = audited(&bench, &known, &bench.record(&known, &through_the_room(seed)));
        assert!(diagnosis.model.is_empty(), "{:?}", diagnosis.model);
        assert_eq!(diagnosis.verdict, Verdict::Adequate, "{:?}", found(&diagnosis));
        assert!(diagnosis.mended.is_none());
    }
}

#[test]
fn a_factor_is_told_by_its_name() {
    let bench = Bench::of("FXYZ");
    let recording = bench.record(&right(&bench), &through_the_room(11));
    let arcsecond = 4.848_136_811;
    for (motion, wrong, change, factor) in [
        ("ECX", -1.0, "sign", -1.0),
        ("EXX", -1.0, "sign", -1.0),
        ("EBX", 1.0 / arcsecond, "unit", arcsecond),
        ("EAY", arcsecond, "unit", 1.0 / arcsecond),
        ("EYY", 1.0 / 1.4, "size", 1.4),
    ] {
        let known = with(motion, |curve| curve.values = curve.values.map(|value| wrong * value));
        let diagnosis = audited(&bench, &bench.calibration(&errors(&known, SQUARE)), &recording);
        let told = only_change(&diagnosis);
        assert_eq!((told.path.as_str(), told.change), (format!("errors.{motion}").as_str(), change));
        assert!(off(amount(told), factor) < FAR, "{told:?}");
    }
}

#[test]
fn a_turned_squareness_is_told_though_another_one_would_do() {
    let bench = Bench::of("FXYZ");
    let recording = bench.record(&right(&bench), &through_the_room(12));
    let turned = audited(&bench, &bench.calibration(&errors(&CURVES, -SQUARE)), &recording);
    assert_eq!(only_change(&turned).path, "errors.EC0Y");
    assert_eq!(only_change(&turned).change, "sign");
    // One that is another by any other number is a machine that has changed.
    let other = audited(&bench, &bench.calibration(&errors(&CURVES, 0.3 * SQUARE)), &recording);
    assert!(other.model.is_empty(), "{:?}", other.model);
    assert_eq!(found(&other), ["EC0Y constant"]);
}

#[test]
fn a_curve_at_a_wrong_place_is_told_with_the_place() {
    let bench = Bench::of("FXYZ");
    let recording = bench.record(&right(&bench), &through_the_room(13));
    let turned = with("ECX", |curve| curve.values.reverse());
    let slipped = with("EXX", |curve| curve.start = -STEP);
    let misread = with("ECX", |curve| curve.axis = "Y");
    for (curves, path, change) in
        [(turned, "errors.ECX", "mirror"), (slipped, "errors.EXX", "shift"), (misread, "errors.ECX", "axis")]
    {
        let diagnosis = audited(&bench, &bench.calibration(&errors(&curves, SQUARE)), &recording);
        let told = only_change(&diagnosis);
        assert_eq!((told.path.as_str(), told.change), (path, change), "{told:?}");
    }
    let shifted = with("ECX", |curve| curve.start = 30.0);
    let diagnosis = audited(&bench, &bench.calibration(&errors(&shifted, SQUARE)), &recording);
    let told = only_change(&diagnosis);
    assert_eq!((told.path.as_str(), told.change), ("errors.ECX", "shift"));
    assert!(off(amount(told), -30.0) < FAR, "{told:?}");
}

#[test]
fn curves_under_the_wrong_motion_are_told_with_both() {
    let bench = Bench::of("FXYZ");
    let recording = bench.record(&right(&bench), &through_the_room(14));
    let mut swapped = CURVES.to_vec();
    (swapped[0].values, swapped[1].values) = (swapped[1].values, swapped[0].values);
    let told = audited(&bench, &bench.calibration(&errors(&swapped, SQUARE)), &recording);
    let told = only_change(&told);
    assert_eq!((told.path.as_str(), told.change), ("errors.EXX", "exchange"));
    assert_eq!(told.with.as_deref(), Some("errors.EYX"));
    let moved = with("EBX", |curve| curve.motion = "EAX");
    let told = audited(&bench, &bench.calibration(&errors(&moved, SQUARE)), &recording);
    let told = only_change(&told);
    assert_eq!((told.path.as_str(), told.change), ("errors.EAX", "motion"));
    assert_eq!(told.with.as_deref(), Some("errors.EBX"));
}

#[test]
fn a_tool_of_another_length_is_told_with_its_length() {
    let bench = Bench::of("FXYZ");
    let truth = right(&bench);
    let recording = bench.record(&truth, &through_the_room(15));
    let mut known = truth.clone();
    let tool = bench.names.constants.iter().position(|(name, _)| name == "Zt").unwrap();
    known.constants[tool] -= 20.0;
    let diagnosis = audited(&bench, &known, &recording);
    let told = only_change(&diagnosis);
    assert_eq!((told.path.as_str(), told.change), ("constants.Zt", "value"));
    assert!(off(amount(told), truth.constants[tool]) < FAR, "{told:?}");
    let mended = diagnosis.mended.as_ref().unwrap();
    assert!((mended.calibration.constants[tool] - truth.constants[tool]).abs() < 2.0);
}

#[test]
fn a_chain_of_another_order_is_told_by_its_word() {
    let truth = Bench::of("XFYZ");
    let recording = truth.record(&right(&truth), &through_the_room(16));
    let bench = Bench::of("FXYZ");
    let diagnosis = audited(&bench, &right(&bench), &recording);
    let told = only_change(&diagnosis);
    assert_eq!((told.path.as_str(), told.change, told.with.as_deref()), ("topology", "order", Some("XFYZ")));
    let mended = diagnosis.mended.as_ref().unwrap();
    assert_eq!(mended.word.as_deref(), Some("XFYZ"));
    assert_eq!(mended.equations.names(), truth.names);
}

#[test]
fn physics_is_found_beside_a_fault_of_the_files() {
    let bench = Bench::of("FXYZ");
    let truth = together(&right(&bench), &bench.calibration("{EYY: [{backlash: {lost_motion: 6 um}}]}"));
    let recording = bench.record(&truth, &through_the_room(17));
    let known = with("ECX", |curve| curve.values = curve.values.map(|value| -value));
    let diagnosis = audited(&bench, &bench.calibration(&errors(&known, SQUARE)), &recording);
    assert_eq!(found(&diagnosis), ["EYY backlash"]);
    let [change] = diagnosis.model.as_slice() else { panic!("{:?}", diagnosis.model) };
    assert_eq!((change.path.as_str(), change.change), ("errors.ECX", "sign"));
    let play = &numbers(called(&diagnosis, "EYY backlash"), "lost_motion")[0];
    assert!(off(play, 6e-3) < FAR, "{play:?}");
}

#[test]
fn physics_alone_is_no_fault_of_the_files() {
    let bench = Bench::of("FXYZ");
    let known = right(&bench);
    for (name, concealed) in [
        ("EXX polynomial", "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.02]}}]}"),
        ("EYY backlash", "{EYY: [{backlash: {lost_motion: 6 um}}]}"),
        ("ECX cyclic", "{ECX: [{cyclic: {axis: X, period: 90 mm, amplitude: 15 urad, phase: 20 deg}}]}"),
        ("EBX polynomial", "{EBX: [{polynomial: {axis: X, per: mm, unit: urad, coefficients: [0, 0.2]}}]}"),
    ] {
        let truth = together(&known, &bench.calibration(concealed));
        let diagnosis = audited(&bench, &known, &bench.record(&truth, &through_the_room(18)));
        assert!(diagnosis.model.is_empty(), "{name}: {:?}", diagnosis.model);
        assert_eq!(diagnosis.findings.len(), 1, "{name}: {:?}", found(&diagnosis));
        called(&diagnosis, name);
    }
}

#[test]
fn columns_that_are_swapped_turned_or_in_another_unit_are_named_before_anything_is_diagnosed() {
    let bench = Bench::of("FXYZ");
    let known = right(&bench);
    let recording = bench.record(&known, &through_the_room(19));
    let mut swapped = recording.clone();
    swapped.measured.swap(0, 1);
    let mut turned = recording.clone();
    turned.measured[1].iter_mut().flatten().for_each(|value| *value = -*value);
    let mut inches = recording.clone();
    inches.measured[0].iter_mut().flatten().for_each(|value| *value /= 25.4);
    for (recording, path, change, with) in [
        (swapped, "channels.measured.x", "columns", Some("channels.measured.y")),
        (turned, "channels.measured.y", "sign", None),
        (inches, "channels.measured.x", "unit", None),
    ] {
        let diagnosis = audited(&bench, &known, &recording);
        assert_eq!(
            diagnosis.verdict,
            Verdict::Undecided,
            "{path} {change}: {:?} {:?}",
            diagnosis.undecided,
            diagnosis.unexplained
        );
        let [told] = diagnosis.model.as_slice() else { panic!("{:?}", diagnosis.model) };
        assert_eq!((told.path.as_str(), told.change, told.with.as_deref()), (path, change, with));
        assert!(diagnosis.undecided.iter().any(|sentence| sentence.contains(&told.fault)), "{told:?}");
        assert!(told.evidence.with < 0.1 && told.evidence.without > 1.0, "{told:?}");
    }
}

/// Thermal errors that read two sensors, and a reference temperature in degC.
fn thermal(scale: &str, head: &str, reference: f64) -> String {
    let expansion = |motion: &str, axis: &str, coefficient: f64| {
        format!(
            "{motion}: [{{expansion: {{axis: {axis}, sensor: {scale}, coefficient: {coefficient} um/m/K, reference: {reference} degC}}}}]"
        )
    };
    let growth =
        format!("EZZ: [{{growth: {{sensor: {head}, coefficient: 3 um/K, reference: {reference} degC}}}}]");
    format!("{{{}, {}, {growth}}}", expansion("EXX", "X", 9.0), expansion("EYY", "Y", 12.0))
}

#[test]
fn temperatures_that_are_read_wrongly_are_told() {
    let bench = Bench::of("FXYZ");
    let mut scenario = through_the_room(20);
    scenario.temperatures = vec![warming("scale", 4.0, 100.0), warming("head", 9.0, 40.0)];
    let recording = bench.record(&bench.calibration(&thermal("scale", "head", 20.0)), &scenario);
    let right = audited(&bench, &bench.calibration(&thermal("scale", "head", 20.0)), &recording);
    assert!(right.model.is_empty() && right.findings.is_empty(), "{:?}", right.model);
    let swapped = audited(&bench, &bench.calibration(&thermal("head", "scale", 20.0)), &recording);
    let told = only_change(&swapped);
    assert_eq!((told.change, told.path.starts_with("channels.temperature.")), ("sensors", true), "{told:?}");
    // The readings are exchanged, or the names in the calibration: what is known of the machine is not changed on that.
    let known = swapped.mended.as_ref().map(|mended| &mended.calibration);
    assert_eq!(known, Some(&bench.calibration(&thermal("head", "scale", 20.0))));
    // The zeros of the readings take what a reference shifts by the same everywhere: two scales remain that are wrong alike.
    let shifted = audited(&bench, &bench.calibration(&thermal("scale", "head", 23.0)), &recording);
    let told = only_change(&shifted);
    assert_eq!((told.path.as_str(), told.change), ("errors", "reference"), "{told:?}");
    assert!(off(amount(told), -3.0) < FAR, "{told:?}");
}

#[test]
fn an_instrument_that_was_set_up_the_wrong_way_is_told() {
    let bench = Bench::of("FXYZ");
    let known = right(&bench);
    let strokes = Path { runs: 3, ..path(line(0, 10.0, 490.0), 50.0, 4.0) };
    let reads = Reads::Straightness { axis: 0, direction: [0.0, 1.0, 0.0] };
    let mut recording = bench.record(&known, &noisy(strokes, reads, 0.3e-3, 21));
    recording.deviation.iter_mut().flatten().for_each(|reading| *reading = -*reading);
    let diagnosis = audited(&bench, &known, &recording);
    let told = only_change(&diagnosis);
    assert_eq!((told.path.as_str(), told.change), ("channels.deviation", "sign"), "{told:?}");
    // Along one axis the sign of its straightness would do as well.
    assert!(told.alternatives.iter().any(|other| other.contains("EYX")), "{told:?}");
    // A unit of the readings is the inverse of what its numbers have to be multiplied by.
    recording.deviation.iter_mut().flatten().for_each(|reading| *reading *= -25.4);
    let diagnosis = audited(&bench, &known, &recording);
    let told = only_change(&diagnosis);
    assert_eq!((told.change, told.remedy.as_str()), ("unit", "multiply its values by 0.0394"), "{told:?}");
    assert!(told.fault.ends_with("millimetres were entered as inches"), "{told:?}");
    assert!(off(amount(told), 25.4) < FAR, "{told:?}");
}

#[test]
fn a_play_of_another_size_is_a_finding_and_no_wrong_file() {
    let bench = Bench::of("FXYZ");
    let curves = errors(&CURVES, SQUARE);
    let with_play = |play: f64| {
        let beside = format!("EYY: [{{backlash: {{lost_motion: {play} um}}}}, ");
        bench.calibration(&curves.replace("EYY: [", &beside))
    };
    let recording = bench.record(&with_play(9.0), &through_the_room(22));
    let diagnosis = audited(&bench, &with_play(4.0), &recording);
    assert!(diagnosis.model.is_empty(), "{:?}", diagnosis.model);
    let play = &numbers(called(&diagnosis, "EYY backlash"), "lost_motion")[0];
    assert!(off(play, 5e-3) < FAR, "{play:?}");
}

#[test]
fn what_a_wandering_sensor_does_is_no_fault_of_the_files() {
    let bench = Bench::of("FXYZ");
    let known = right(&bench);
    // A dent in an angle that no smooth term follows exactly, beside a sensor that wanders as far.
    let concealed =
        "{EAX: [{table: {axis: X, start: 200 mm, step: 40 mm, unit: urad, values: [0, 8, -6, 5, 0]}}]}";
    let truth = together(&known, &bench.calibration(concealed));
    for seed in 30..36 {
        let circles = Path {
            at: vec![vec![250.0], vec![140.0], vec![-50.0]],
            runs: 2,
            ..path(circle(100.0), 50.0, 8.0)
        };
        let mut scenario = noisy(circles, position("xyz"), 0.3e-3, seed);
        scenario.measurement.noise.walk = Some(Walk { sigma: 1.5e-3, after: 60.0 });
        let diagnosis = audited(&bench, &known, &bench.record(&truth, &scenario));
        assert!(diagnosis.model.is_empty(), "{seed}: {:?}", diagnosis.model);
    }
}
