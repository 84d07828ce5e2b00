//! Directions that a controller finds by itself. In: a slide with play, a programme and a temperature. Out: the correction,
//! held against a play that is one: what follows a screw only after that has gone through it.

use abbe_c::{Controller, Inputs, Status};
use proptest::prelude::*;

use crate::stage;

/// The period of the servo cycle, s.
const CYCLE: f64 = 0.001;

fn cycle(controller: &mut Controller, position: f64, temperature: f64) -> (Status, f64) {
    let inputs =
        Inputs { position: &[position], direction: &[], temperature: &[temperature], time_step: CYCLE };
    let (status, _) = controller.update(&inputs, true).unwrap();
    (status, controller.correction()[0])
}

/// A slide behind a screw with play, mm.
struct Slide {
    play: f64,
    at: f64,
}

impl Slide {
    fn follow(&mut self, screw: f64) -> f64 {
        self.at = self.at.clamp(screw - self.play / 2.0, screw + self.play / 2.0);
        self.at
    }
}

const PLAY_AND_GROWTH: &str = "limits: {fade: 1 ms}\nerrors:
  EXX:
    - backlash: {lost_motion: 8 um}
    - growth: {sensor: body, coefficient: 2 um/K, reference: 20 degC}\n";

/// A programme lets the axis stand, and a temperature moves its screw through the play, there and back.
#[test]
fn a_correction_that_turns_a_screw_back_goes_through_its_play() {
    let mut controller = stage::controller(PLAY_AND_GROWTH);
    let mut slide = Slide { play: 0.008, at: -0.004 };
    let mut largest: f64 = 0.0;
    for time in 0..20_000 {
        let position = (f64::from(time) * 0.05).min(100.0);
        let temperature = 20.0 + 10.0 * (f64::from(time) * 5e-4).sin();
        let (_, correction) = cycle(&mut controller, position, temperature);
        let error = slide.follow(position + correction) + 0.002 * (temperature - 20.0) - position;
        if time > 10 {
            largest = largest.max(error.abs());
        }
    }
    // A reversal is seen after 1 um; by the programme alone, which never turns, it would be 8 um.
    assert!(largest < 0.001_1, "{largest}");
}

#[test]
fn a_switched_off_controller_goes_by_the_programme() {
    let mut controller =
        stage::controller("limits: {fade: 1 ms}\nerrors: {EXX: [{backlash: {lost_motion: 8 um}}]}\n");
    let at = |controller: &mut Controller, position, enabled| {
        let inputs = Inputs { position: &[position], direction: &[], temperature: &[], time_step: CYCLE };
        let (_, done) = controller.update(&inputs, enabled).unwrap();
        done.error[0]
    };
    // Up by 1 mm, down by less than the hysteresis, down by more.
    assert_eq!(at(&mut controller, 0.0, false), -0.004);
    assert_eq!(at(&mut controller, 1.0, false), -0.004);
    assert_eq!(at(&mut controller, 0.999_1, false), -0.004);
    assert_eq!(at(&mut controller, 0.998_9, false), 0.004);
    assert_eq!(at(&mut controller, 0.999_8, false), 0.004);
    assert_eq!(at(&mut controller, 1.0, false), -0.004);
}

#[test]
fn a_velocity_goes_on_from_the_last_position_that_was_a_number() {
    let mut controller = stage::controller("errors: {EXX: [{lag: {gain: 100 1/s}}]}\n");
    let mut errors = Vec::new();
    for position in [0.0, 0.1, 0.2, f64::NAN, f64::NAN, 0.5, 0.6] {
        let inputs = Inputs { position: &[position], direction: &[], temperature: &[], time_step: CYCLE };
        errors.push(controller.update(&inputs, true).unwrap().1.error[0]);
    }
    // 100 mm/s behind a loop of 100 1/s is 1 mm.
    for (error, expected) in errors.iter().zip([0.0, -1.0, -1.0, 0.0, 0.0, -1.0, -1.0]) {
        assert!((error - expected).abs() < 1e-9, "{errors:?}");
    }
}

#[test]
fn a_sensor_that_no_term_reads_is_never_missed() {
    let calibration = "sensors: {unused: {mean: [T1, T2]}, body: {mean: [T3, T4]}}\nlimits: {fade: 1 ms, hold: 1 ms}\nerrors:
  EXX: [{growth: {sensor: body, coefficient: 1 um/K, reference: 20 degC}}]\n";
    let mut controller = stage::controller(calibration);
    let mut last = None;
    for _ in 0..10 {
        let inputs =
            Inputs { position: &[0.0], direction: &[], temperature: &[21.0, 25.0], time_step: CYCLE };
        last = Some(controller.update(&inputs, true).unwrap().0);
    }
    assert_eq!(last, Some(Status::Active));
    assert!((controller.correction()[0] + 0.003).abs() < 1e-9);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Whatever a reversal adds to the correction, towards the motion or against it, at once or spread over a time, is no
    /// reversal: after the machine has come to stand, the correction does too.
    #[test]
    fn no_reversal_makes_another(
        lost_motion in -30.0..30.0_f64,
        ramp in prop::option::of(1.0..50.0_f64),
        rate in prop::option::of(1.0..50.0_f64),
        steps in prop::collection::vec((-0.05..0.05_f64, 1..200_usize), 1..12),
    ) {
        let ramp = ramp.map_or(String::new(), |ramp| format!(", ramp: {ramp:.3} ms"));
        let rate = rate.map_or(String::new(), |rate| format!(", rate: {rate:.3} mm/s"));
        let text = format!(
            "limits: {{compensation: 0.2 mm, fade: 10 ms{rate}}}\nerrors:\n  EXX:\n    - backlash: {{lost_motion: {lost_motion:.3} um{ramp}}}\n"
        );
        let mut controller = stage::controller(&text);
        let mut position = 0.0;
        let at = |controller: &mut Controller, position: f64| {
            let inputs = Inputs { position: &[position], direction: &[], temperature: &[], time_step: CYCLE };
            prop_assert!(controller.update(&inputs, true).is_ok());
            Ok(controller.correction()[0])
        };
        for (step, cycles) in steps {
            for _ in 0..cycles {
                position += step;
                at(&mut controller, position)?;
            }
        }
        let mut corrections = Vec::new();
        for _ in 0..1000 {
            corrections.push(at(&mut controller, position)?);
        }
        let rest = &corrections[500..];
        prop_assert!(rest.iter().all(|&correction| (correction - rest[0]).abs() < 1e-12), "{:?}", &rest[..20]);
        prop_assert!((rest[0].abs() - lost_motion.abs() * 0.5e-3).abs() < 1e-6, "{} of {lost_motion}", rest[0]);
    }
}
