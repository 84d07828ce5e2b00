//! What is followed, held against recordings of the exact machine whose truth is known.

use super::{Followed, Size, Untold, follow};
use crate::recording::Recording;
use crate::testing::{Bench, line, noisy, path, position};
use model_dsl::calibration::{CalibratedTerm, Calibration};

/// An error of X of the machine XYFZ, as it is followed.
fn followed(bench: &Bench, motion: &str, term: CalibratedTerm) -> Followed {
    Followed {
        motion: bench.motion(motion),
        at_drive: false,
        inside_loop: false,
        term,
        sensors: Vec::new(),
        share: 0.0,
    }
}

fn backlash(axis: usize) -> CalibratedTerm {
    CalibratedTerm::Backlash { axis, lost_motion: 1.0, wind_up: 0.0 }
}

/// A line along X and back, read with a noise of 1 um.
fn recorded(bench: &Bench, truth: &Calibration, seed: u64) -> Recording {
    let path = path(line(0, 0.0, 200.0), 20.0, 25.0);
    bench.record(truth, &noisy(path, position("x"), 1e-3, seed))
}

fn sizes(bench: &Bench, errors: &str, seed: u64, effects: &[Followed]) -> Vec<Result<Vec<Size>, Untold>> {
    let known = bench.calibration("{}");
    let recording = recorded(bench, &bench.calibration(errors), seed);
    follow(&bench.inputs(&known, &[&recording]), effects)
}

#[test]
fn an_effect_too_weak_to_be_claimed_has_a_size_and_an_interval_that_holds_the_truth() {
    let bench = Bench::of("XYFZ");
    let effects = [followed(&bench, "EXX", backlash(0))];
    let mut held = 0;
    for seed in 1..=60 {
        // Where there is no backlash, the interval holds zero.
        let truth = [0.0, 0.1e-3][usize::from(seed % 2 == 0)];
        let errors = format!("{{EXX: [{{backlash: {{lost_motion: {truth:e} mm}}}}]}}");
        let found = sizes(&bench, &errors, seed, &effects);
        let Ok([size]) = found[0].as_deref() else { panic!("{found:?}") };
        assert_eq!((size.name.as_str(), size.estimate.unit.as_str()), ("lost_motion", "mm"));
        let (low, high) = size.estimate.ci95;
        held += usize::from((low..=high).contains(&truth));
    }
    // Of 60 intervals of 95 %, fewer than 51 hold the truth once in 1400.
    assert!(held >= 51, "{held} of 60");
}

#[test]
fn a_wave_is_followed_with_its_phase_free() {
    let bench = Bench::of("XYFZ");
    let wave = CalibratedTerm::Cyclic { axis: 0, period: 10.0, amplitude: 1.0, phase: 0.0 };
    let long = CalibratedTerm::Cyclic { axis: 0, period: 250.0, amplitude: 1.0, phase: 0.0 };
    let effects = [followed(&bench, "EXX", wave), followed(&bench, "EXX", long)];
    let errors = "{EXX: [{cyclic: {period: 10 mm, amplitude: 2 um, phase: 77 deg}}]}";
    let found = sizes(&bench, errors, 7, &effects);
    let estimate = &found[0].as_ref().unwrap()[0].estimate;
    assert!(estimate.ci95.0 <= 2e-3 && 2e-3 <= estimate.ci95.1, "{estimate:?}");
    assert!(estimate.ci95.1 - estimate.ci95.0 < 1e-3, "{estimate:?}");
    assert_eq!(found[1], Err(Untold::Part), "a wave that does not come round");
}

#[test]
fn what_a_recording_does_not_show_or_tell_apart_has_no_size() {
    let bench = Bench::of("XYFZ");
    let effects = [
        followed(&bench, "EXX", backlash(0)),
        // The same column again, an axis that stands still, and a sensor that was not recorded.
        followed(&bench, "EXX", backlash(0)),
        followed(&bench, "EYY", backlash(1)),
        Followed {
            sensors: vec![(0, "spindle".to_owned())],
            ..followed(
                &bench,
                "EXX",
                CalibratedTerm::Growth { sensor: 0, coefficient: 1.0, reference: 20.0, time_constant: 0.0 },
            )
        },
    ];
    let found = sizes(&bench, "{EXX: [{backlash: {lost_motion: 4 um}}]}", 3, &effects);
    assert_eq!(found[0].as_ref().map(Vec::len), Ok(1));
    assert_eq!(found[1..], [Err(Untold::Mixed), Err(Untold::Absent), Err(Untold::Absent)]);
}
