//! What a full calibration leaves of an exact recording: nothing, whatever reads it; and a model of the same terms nothing to
//! first order.

use simulation::{Instrument as Reads, Normal};

use super::*;
use crate::course::STRETCH;
use crate::model::{Effect, Fitted, Place};
use crate::terms::Setting;
use crate::terms::Shape;
use crate::testing::{Bench, ballbar, circle, distance, line, path, peak, position, scenario, warming};
use simulation::path::Shape as PathShape;

/// Errors of every kind, `size` times those of a bad machine.
fn errors(size: f64) -> String {
    let n = |value: f64| value * size;
    format!(
        "{{EXX: [{{polynomial: {{axis: X, per: mm, unit: um, coefficients: [{}, {}]}}}}, {{lag: {{gain: 40 1/s}}}}, {{backlash: {{lost_motion: {} um, wind_up: 3 mm}}}}], \
          EYY: [{{cyclic: {{period: 10 mm, amplitude: {} um, phase: 1 rad}}}}, {{lag: {{gain: 33 1/s}}}}], \
          EZZ: [{{growth: {{sensor: spindle, coefficient: {} um/K, reference: 20 degC, time_constant: 20 s}}}}], \
          EAX: {} urad, EBX: [{{polynomial: {{axis: X, per: mm, unit: urad, coefficients: [{}, {}]}}}}], ECX: {} urad, \
          EAY: {} urad, ECY: [{{coupling: {{axis: X, per: mm, unit: urad, coefficients: [{}]}}}}], EBZ: {} urad, EYX: {} um, \
          EC0Y: {} urad, EB0Z: {} urad, EA0Z: {} urad}}",
        n(5.0),
        n(0.2),
        n(12.0),
        n(7.0),
        n(1.5),
        n(80.0),
        n(30.0),
        n(0.8),
        n(-60.0),
        n(45.0),
        n(0.5),
        n(90.0),
        n(8.0),
        n(150.0),
        n(-120.0),
        n(70.0)
    )
}

/// Who says what the errors of the machine are.
#[derive(Clone, Copy)]
enum Said {
    ByCalibration,
    ByModel,
}

/// What is left of a recording where its errors are said, with settings of the instrument; offsets left free.
fn worst(
    bench: &Bench,
    (errors, said): (&str, Said),
    instrument: Reads,
    shape: PathShape,
    settings: &[(Setting, f64)],
) -> f64 {
    let calibration = bench.calibration(errors);
    let mut scenario = scenario(path(shape, 30.0, 20.0), instrument);
    scenario.path.at = vec![vec![200.0], vec![90.0], vec![-60.0]];
    scenario.temperatures = vec![warming("spindle", 8.0, 15.0)];
    let recording = bench.record(&calibration, &scenario);
    let mut study = Study::new(bench.equations(), Some(&calibration), &[&recording]);
    let fitted = |(setting, value): &(Setting, f64)| Fitted {
        effect: Effect::setting(0, *setting),
        coefficients: vec![*value],
    };
    let mut model = Model::of(settings.iter().map(fitted));
    if matches!(said, Said::ByModel) {
        model.effects.append(&mut study.known);
    }
    let course = Course::new(&study, 0, &model);
    let mut residuals = residuals(&study, 0, &model, &course);
    assert!(!residuals.is_empty());
    residuals.iter_mut().for_each(|residual| crate::zeros::center(residual));
    residuals.iter().map(|residual| peak(residual)).fold(0.0, f64::max)
}

/// Half the errors must leave a quarter.
fn is_of_second_order(what: &str, left: impl Fn(f64) -> f64, most: f64) {
    let (whole, half) = (left(1.0), left(0.5));
    assert!(whole < most, "{what}: {whole}");
    assert!(half < 0.27 * whole + 1e-10, "{what}: {whole}, and with half the errors {half}");
}

/// Every instrument, where it is led, and the unit of its readings in mm or rad.
fn instruments() -> [(&'static str, Reads, PathShape, f64); 6] {
    let along = || line(0, 20.0, 300.0);
    let ring = Normal::Radial(Some([200.0, 90.0, f64::NAN]));
    [
        ("position", position("xyz"), circle(70.0), 1.0),
        ("ballbar", ballbar([0.0; 3]), circle(70.0), 1.0),
        ("straightness", Reads::Straightness { axis: 0, direction: [0.0, 0.0, 1.0] }, along(), 1.0),
        ("linear", Reads::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: 0.0 }, along(), 1.0),
        ("probe", Reads::Probe { normal: ring }, circle(70.0), 1.0),
        ("angular", Reads::Angular { axis: Some(0), about: [0.0, 0.6, 0.8] }, along(), 1e-3),
    ]
}

/// Errors that are known leave nothing, also when they are forty times those of a bad machine: a squareness of 6 mrad.
#[test]
fn what_is_known_is_predicted_exactly() {
    for machine in ["XYFZ", "FXYZ", "XFYZ"] {
        let bench = Bench::of(machine);
        for (what, instrument, shape, unit) in instruments() {
            for size in [1.0, 40.0] {
                let said = (errors(size), Said::ByCalibration);
                let left = worst(&bench, (&said.0, said.1), instrument.clone(), shape.clone(), &[]);
                // A difference of coordinates of up to a metre, rounded some dozen times.
                assert!(left < 1e-11 * unit.max(0.1), "{what} on {machine}, {size} times: {left}");
            }
        }
    }
}

#[test]
fn what_a_model_says_is_predicted_to_first_order() {
    let bench = Bench::of("XYFZ");
    for (what, instrument, shape, unit) in instruments() {
        let left =
            |size: f64| worst(&bench, (&errors(size), Said::ByModel), instrument.clone(), shape.clone(), &[]);
        is_of_second_order(what, left, 5e-4 * unit);
    }
}

/// A term whose sensor was not recorded leaves unknown what it moves itself, and nothing else.
#[test]
fn what_is_not_known_hides_what_it_moves() {
    let bench = Bench::of("XYFZ");
    let grown =
        "EZZ: [{growth: {sensor: spindle, coefficient: 2 um/K, reference: 20 degC, time_constant: 20 s}}]";
    let known = "EBX: 2 mrad, ECY: 1 mrad, EC0Y: 5 mrad";
    let truth = bench.calibration(&format!("{{{known}}}"));
    let recording = bench.record(&truth, &scenario(path(circle(70.0), 30.0, 20.0), position("xyz")));
    let calibration = bench.calibration(&format!("{{{known}, {grown}}}"));
    let study = Study::new(bench.equations(), Some(&calibration), &[&recording]);
    let left = residuals(&study, 0, &Model::default(), &Course::new(&study, 0, &Model::default()));
    assert!(peak(&left[0]) < 1e-11 && peak(&left[1]) < 1e-11, "{} {}", peak(&left[0]), peak(&left[1]));
    assert!(left[2].iter().all(|value| value.is_nan()));
}

#[test]
fn known_centres_and_radii_leave_nothing_more() {
    let bench = Bench::of("XYFZ");
    let none = ("{}", Said::ByCalibration);
    let off = [0.03, -0.02, 0.0];
    let settings =
        [(Setting::Eccentricity { direction: 0 }, off[0]), (Setting::Eccentricity { direction: 1 }, off[1])];
    let left = worst(&bench, none, ballbar(off), circle(70.0), &settings);
    assert!(left < 1e-10, "a centre is taken exactly, {left}");
    let left = worst(&bench, (&errors(40.0), Said::ByCalibration), ballbar(off), circle(70.0), &settings);
    assert!(left < 1e-11, "with errors that are known too, {left}");
    // The bar is longer than it says: its readings are too small by the offset that it adds.
    let longer = Reads::Ballbar { center: None, radius: None, eccentricity: [0.0; 3], offset: -0.005 };
    assert!(worst(&bench, none, longer, circle(70.0), &[(Setting::Radius, 0.005)]) < 1e-10);
    let (angle, travel) = (2e-3_f64, 280.0);
    let beam = Reads::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: angle };
    let missed = worst(&bench, none, beam.clone(), line(0, 20.0, 300.0), &[]);
    assert!(missed > 0.3 * travel * angle * angle / 2.0, "{missed}");
    let left = worst(&bench, none, beam, line(0, 20.0, 300.0), &[(Setting::Cosine, angle * angle / 2.0)]);
    assert!(left < travel * angle.powi(4) / 20.0, "{left}");
}

/// What is left of a circle that was read late, under the true clock: outside, at the drive of X, and outside without.
fn read_late(errors: &str, clock: f64) -> [Vec<f64>; 3] {
    let bench = Bench::of("XYFZ");
    let calibration = bench.calibration(errors);
    let round = PathShape::Circle {
        plane: [0, 1],
        radius: 70.0,
        start: 0.3,
        overshoot: 0.0,
        counterclockwise: vec![true],
    };
    let mut scenario = scenario(path(round, 30.0, 100.0), position("xy"));
    scenario.measurement.clock = clock;
    scenario.measurement.drives = vec![0, 1];
    let recording = bench.record(&calibration, &scenario);
    let study = Study::new(bench.equations(), Some(&calibration), &[&recording]);
    assert!(study.scenes[0].channels[2].kind == Kind::Drive(0));
    let left = |model: &Model| residuals(&study, 0, model, &Course::new(&study, 0, model));
    let fitted = Fitted { effect: Effect::setting(0, Setting::Clock), coefficients: vec![clock] };
    let mut seen = left(&Model::of([fitted]));
    let (outside, drive) = (seen[0].clone(), seen.swap_remove(2));
    [outside, drive, left(&Model::default()).swap_remove(0)]
}

/// The rows in which the instrument saw what was recorded too.
fn inner(residual: &[f64]) -> &[f64] {
    &residual[8..residual.len() - 8]
}

#[test]
fn a_late_clock_shows_the_state_so_much_earlier() {
    let errors = "{EXX: 3 um, EYY: [{cyclic: {period: 10 mm, amplitude: 7 um, phase: 1 rad}}]}";
    for clock in [0.03, -0.02] {
        let [outside, drive, blind] = read_late(errors, clock);
        // Chords between the rows would be 0.2 um off.
        assert!(peak(inner(&outside)) < 5e-5, "{clock}: {}", peak(inner(&outside)));
        assert!(peak(&blind) > 0.5 * 30.0 * clock.abs());
        // The drives have a clock of their own.
        assert!(peak(&drive) < 1e-9);
    }
}

#[test]
fn a_late_clock_shows_what_the_loop_did_so_much_earlier() {
    for clock in [0.03, -0.02] {
        let [outside, drive, blind] = read_late("{EXX: [{lag: {gain: 30 1/s}}]}", clock);
        // The plant takes its commands as straight between the rows.
        assert!(peak(inner(&drive)) < 5e-4, "{clock}: {}", peak(inner(&drive)));
        assert!(peak(inner(&outside)) < 5e-4, "{clock}: {}", peak(inner(&outside)));
        assert!(peak(&blind) > 0.5 * 30.0 * clock.abs());
    }
}

#[test]
fn a_rotary_stage_is_read_in_the_sense_of_its_command() {
    for machine in ["FC", "CF"] {
        let bench = Bench::of(machine);
        let calibration = bench.calibration(
            "{ECC: [{cyclic: {period: 30 deg, amplitude: 40 urad, phase: 0.4 rad}}, {backlash: {lost_motion: 60 urad}}], EAC: 30 urad}",
        );
        let instrument = Reads::Position { directions: [false; 3], angles: vec![0] };
        let recording = bench.record(&calibration, &scenario(path(line(0, 0.0, 2.0), 0.2, 20.0), instrument));
        let study = Study::new(bench.equations(), Some(&calibration), &[&recording]);
        assert_eq!(study.scenes[0].channels[0].kind, Kind::Stage(0));
        let left = residuals(&study, 0, &Model::default(), &Course::new(&study, 0, &Model::default()));
        assert!(peak(&left[0]) < 1e-8, "{machine}: {}", peak(&left[0]));
        let bare = Study::new(bench.equations(), None, &[&recording]);
        let left = residuals(&bare, 0, &Model::default(), &Course::new(&bare, 0, &Model::default()));
        assert!(peak(&left[0]) > 60e-6);
    }
}

#[test]
fn drives_see_what_came_in_on_their_side_only() {
    let bench = Bench::of("FX");
    let calibration = bench.calibration("{EXX: [{lag: {gain: 30 1/s}}, {backlash: {lost_motion: 10 um}}]}");
    let friction = bench.calibration("{EXX: [{lag: {gain: 30 1/s}}]}");
    let mut scenario = scenario(path(line(0, 0.0, 100.0), 20.0, 20.0), position("x"));
    scenario.measurement.drives = vec![0];
    let at_drive = {
        let mut plant = bench.plant(&calibration);
        plant.see_at_drive(&bench.compiled.machine, "EXX", "backlash").unwrap();
        bench.recorded(&plant, &scenario)
    };
    let after = bench.record(&calibration, &scenario);
    let shape = Shape::Backlash { axis: 0, wind_up: 0.0 };
    for (recording, side, other) in
        [(&at_drive, Side::Drive, Side::After), (&after, Side::After, Side::Drive)]
    {
        let study = Study::new(bench.equations(), Some(&friction), &[recording]);
        let left = |side: Side| {
            let effect = Effect { place: Place::Motion { motion: 0, side }, shape: shape.clone() };
            let model = Model::of([Fitted { effect, coefficients: vec![0.01] }]);
            let residuals = residuals(&study, 0, &model, &Course::new(&study, 0, &model));
            residuals.iter().map(|residual| peak(residual)).fold(0.0, f64::max)
        };
        assert!(left(side) < 1e-9, "{side:?}");
        assert!(left(other) > 0.004, "{side:?}");
    }
}

#[test]
fn stretches_make_no_difference() {
    let bench = Bench::of("XYFZ");
    let calibration = bench.calibration(&errors(1.0));
    let mut scenario = scenario(path(circle(70.0), 30.0, 70.0), position("xyz"));
    scenario.temperatures = vec![warming("spindle", 8.0, 15.0)];
    let recording = bench.record(&calibration, &scenario);
    assert!(recording.time.len() > 2 * STRETCH);
    let study = Study::new(bench.equations(), Some(&calibration), &[&recording]);
    let wound = Effect {
        place: Place::Motion { motion: bench.motion("EYX"), side: Side::After },
        shape: Shape::Backlash { axis: 0, wind_up: 40.0 },
    };
    let model = Model::of([Fitted { effect: wound, coefficients: vec![0.01] }]);
    let course = Course::new(&study, 0, &model);
    let pieces = residuals(&study, 0, &model, &course);
    let moved = Passage::new(&study, 0, &model).moved(&study, &course, 0..recording.time.len());
    let whole = Frame::new(&study, &course, &moved, 0..recording.time.len());
    for (number, channel) in study.scenes[0].channels.iter().enumerate() {
        assert!(distance(&whole.residual(&study, 0, channel, &model), &pieces[number]) < 1e-12);
    }
}
