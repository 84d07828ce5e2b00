//! Noise and other faults as they reach a recording.

use abbe_simulation::noise::{Missing, Noise};
use abbe_simulation::{Instrument, Scenario, Simulated, Temperature, simulate};

use crate::common::{line, path, plant, scenario};

fn noisy(seed: u64) -> Scenario {
    let mut wanted = scenario(path(line(0, 0.0, 200.0), 10.0, 50.0), Instrument::position());
    wanted.path.runs = 3;
    wanted.measurement.noise = Noise { white: 5e-4, resolution: 1e-4, ..Noise::default() };
    wanted.measurement.seed = seed;
    wanted
}

fn recorded(wanted: &Scenario) -> Simulated {
    simulate(&plant("XYFZ", "{EXX: [{backlash: {lost_motion: 5 um}}]}"), wanted).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    assert_eq!(recorded(&noisy(3)), recorded(&noisy(3)));
    assert_ne!(recorded(&noisy(3)).readings[0].values, recorded(&noisy(4)).readings[0].values);
    assert_eq!(recorded(&noisy(3)).readings[0].clean, recorded(&noisy(4)).readings[0].clean);
}

#[test]
fn a_channel_more_changes_no_other() {
    let mut fewer = noisy(3);
    fewer.measurement.instrument =
        Instrument::Position { directions: [true, false, false], angles: Vec::new() };
    fewer.temperatures =
        vec![Temperature { name: "air".to_owned(), noise: Noise::white(1.0), ..Temperature::default() }];
    assert_eq!(recorded(&fewer).readings[0], recorded(&noisy(3)).readings[0]);
}

#[test]
fn noise_has_its_size_and_readings_their_step() {
    let recorded = recorded(&noisy(1));
    let reading = &recorded.readings[1];
    let rows = reading.values.len() as f64;
    let square: f64 =
        reading.values.iter().zip(&reading.clean).map(|(value, clean)| (value - clean).powi(2)).sum();
    // White noise and the rounding to steps: variances add.
    let expected = 2.5e-7 + 1e-8 / 12.0;
    assert!((square / rows / expected - 1.0).abs() < 0.1);
    assert!(reading.values.iter().all(|value| (value / 1e-4 - (value / 1e-4).round()).abs() < 1e-6));
}

#[test]
fn lost_readings_are_lost_in_all_channels_and_no_row_goes() {
    let mut wanted = noisy(1);
    wanted.measurement.missing = Missing { rate: 0.01, blocks: 2, length: 3.0 };
    let whole = recorded(&noisy(1));
    let holes = recorded(&wanted);
    assert_eq!(whole.time, holes.time);
    let lost = |row: usize| holes.readings.iter().filter(|reading| reading.values[row].is_nan()).count();
    let rows = holes.time.len();
    assert!((0..rows).all(|row| matches!(lost(row), 0 | 3)));
    let share = (0..rows).filter(|row| lost(*row) == 3).count() as f64 / rows as f64;
    assert!((0.025..0.08).contains(&share), "{share}");
    let kept = (0..rows).find(|row| lost(*row) == 0).unwrap();
    assert_eq!(whole.readings[0].values[kept], holes.readings[0].values[kept]);
}

#[test]
fn a_loose_part_moves_from_run_to_run_only() {
    let mut wanted = noisy(1);
    wanted.measurement.noise = Noise::default();
    wanted.measurement.fixture = 0.005;
    let recorded = recorded(&wanted);
    let reading = &recorded.readings[2];
    let shift = |row: usize| reading.values[row] - reading.clean[row];
    let mut shifts: Vec<f64> = Vec::new();
    for row in 0..recorded.time.len() {
        if row == 0 || recorded.run[row] != recorded.run[row - 1] {
            shifts.push(shift(row));
        }
        assert!((shift(row) - shifts[shifts.len() - 1]).abs() < 1e-12);
    }
    assert_eq!(shifts.len(), 3);
    assert!(shifts.windows(2).all(|pair| (pair[0] - pair[1]).abs() > 1e-5));
}
