//! Waves of elements of drives: a wave is named after the screw or the worm that the machine file tells of, and after
//! nothing whose period is another.

use std::f64::consts::TAU;

use abbe_diagnosis::diagnosis::Repeats;
use model_dsl::machine::ElementKind;
use simulation::{Instrument, Path};

use crate::common::*;
use crate::recording::AngleUnit;
use crate::testing::*;

/// What the wave of one error motion repeats with, of a machine with these drives on which it is concealed.
fn repeats(word: &str, drive: &str, path: Path, concealed: &str) -> Vec<Repeats> {
    let bench = Bench::driven(word, drive);
    let path = Path { runs: 3, ..path };
    let (motion, scenario) = match word {
        "FX" => ("EXX cyclic", noisy(path, position("x"), 0.001, 21)),
        _ => {
            let table = Instrument::Position { directions: [false; 3], angles: vec![0] };
            ("ECC cyclic", noisy(path, table, 20e-6, 22))
        }
    };
    let mut recording = bench.record(&bench.calibration(concealed), &scenario);
    recording.angle_unit = AngleUnit::Degree;
    let diagnosis = diagnosed(&bench, &bench.calibration("{}"), &[&recording]);
    called(&diagnosis, motion).repeats_with.clone()
}

/// A slide over 120 mm, in steps of a millimetre.
fn slide() -> Path {
    path(line(0, 0.0, 120.0), 20.0, 20.0)
}

/// A path of a rotary table through an angle in rad, with a step in degrees.
fn table(through: f64, step: f64) -> Path {
    path(line(0, 0.0, through), 0.1, 0.1 / step.to_radians())
}

#[test]
fn half_the_pitch_of_a_screw() {
    let wave = "{EXX: [{cyclic: {period: 5 mm, amplitude: 3 um, phase: 1 rad}}]}";
    let screw = Repeats { element: ElementKind::Screw, period: 10.0, unit: "mm", harmonic: 2 };
    assert_eq!(repeats("FX", "{X: {pitch: 10 mm}}", slide(), wave), [screw]);
    // A motor that turns twice for one turn of the screw is as good a name, and one that turns three times is none.
    let motor = Repeats { element: ElementKind::Motor, period: 5.0, unit: "mm", harmonic: 1 };
    assert_eq!(repeats("FX", "{X: {pitch: 10 mm, ratio: 2}}", slide(), wave), [motor, screw]);
    assert_eq!(repeats("FX", "{X: {pitch: 10 mm, ratio: 3}}", slide(), wave), [screw]);
}

#[test]
fn a_period_that_is_another_is_named_after_nothing() {
    let wave = "{EXX: [{cyclic: {period: 5.15 mm, amplitude: 3 um, phase: 1 rad}}]}";
    assert_eq!(repeats("FX", "{X: {pitch: 10 mm, ratio: 2}}", slide(), wave), []);
    assert_eq!(repeats("FX", "{}", slide(), wave), []);
}

#[test]
fn a_turn_of_a_worm() {
    let wave = "{ECC: [{cyclic: {period: 2 deg, amplitude: 60 urad, phase: 1 rad}}]}";
    let part = || table(1.2, 0.3);
    let found = repeats("FC", "{C: {teeth: 180}}", part(), wave);
    let [Repeats { element: ElementKind::Worm { teeth: 180 }, period, unit: "deg", harmonic: 1 }] = found[..]
    else {
        panic!("{found:?}")
    };
    assert!((period - 2.0).abs() < 1e-12, "{period}");
    assert_eq!(repeats("FC", "{}", part(), wave), []);
}

/// Nobody has to say that a table repeats after a turn.
#[test]
fn three_times_a_turn_of_a_table() {
    let wave = "{ECC: [{cyclic: {period: 120 deg, amplitude: 60 urad, phase: 1 rad}}]}";
    let found = repeats("FC", "{}", table(TAU, 3.0), wave);
    let [Repeats { element: ElementKind::Axis, period, unit: "deg", harmonic: 3 }] = found[..] else {
        panic!("{found:?}")
    };
    assert!((period - 360.0).abs() < 1e-9, "{period}");
}
