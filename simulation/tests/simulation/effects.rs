//! One effect at a time: what it does to the tool tip.

use std::f64::consts::TAU;
use std::sync::Arc;

use abbe_simulation::path::Shape;
use abbe_simulation::{Instrument, Load, Plant, Pulses, Servo, Simulated, Temperature, simulate};

use crate::common::{Built, circle, line, path, plant, scenario};

/// A single slide X, read along X.
fn stage(errors: &str) -> Plant {
    plant("FX", errors)
}

fn along(plant: &Plant, feed: f64, rate: f64) -> Simulated {
    simulate(plant, &scenario(path(line(0, 0.0, 100.0), feed, rate), Instrument::position())).unwrap()
}

/// Measured minus commanded of the first direction.
fn deviation(simulated: &Simulated) -> Vec<f64> {
    let pairs = simulated.readings[0].values.iter().zip(&simulated.commands[0]);
    pairs.map(|(measured, command)| measured - command).collect()
}

#[test]
fn a_perfect_machine_stands_where_it_is_told() {
    let simulated = along(&stage("{}"), 10.0, 7.0);
    assert!(deviation(&simulated).iter().all(|value| value.abs() < 1e-12));
    assert_eq!(simulated.time.len(), 141);
}

#[test]
fn backlash_steps_at_the_quadrants_of_a_circle() {
    // 8 um of lost motion in X and none in Y: measured x jumps by 8 um where x turns, y nowhere.
    let plant = plant("XYFZ", "{EXX: [{backlash: {lost_motion: 8 um}}]}");
    let recorded =
        simulate(&plant, &scenario(path(circle(50.0), 20.0, 100.0), Instrument::position())).unwrap();
    let (x, y) = (&recorded.commands[0], &recorded.commands[1]);
    let mut direction = 1.0;
    let mut turns = 0;
    for row in 0..x.len() {
        if row > 0 && x[row] != x[row - 1] {
            let now = (x[row] - x[row - 1]).signum();
            turns += i32::from(row > 1 && now != direction);
            direction = now;
        }
        assert!((recorded.readings[0].values[row] - x[row] + 0.004 * direction).abs() < 1e-12, "row {row}");
        assert!((recorded.readings[1].values[row] - y[row]).abs() < 1e-12, "row {row}");
    }
    // Twice a circle, and once more where the circle itself turns back.
    assert_eq!(turns, 5);
}

#[test]
fn a_wind_up_takes_the_play_over_its_travel() {
    let plant = stage("{EXX: [{backlash: {lost_motion: 10 um, wind_up: 4 mm}}]}");
    let recorded = along(&plant, 10.0, 10.0);
    let value = |time: f64| {
        let row = recorded.time.iter().position(|known| (known - time).abs() < 1e-9).unwrap();
        deviation(&recorded)[row]
    };
    assert!((value(5.0) + 0.005).abs() < 1e-12);
    // Back from 100 mm: at 99 mm half a turn of u is left of the two, at 98 mm u is 0, at 96 mm it is over.
    assert!((value(10.1) + 0.0025).abs() < 1e-12);
    assert!(value(10.2).abs() < 1e-12);
    assert!((value(10.4) - 0.005).abs() < 1e-12);
    assert!((value(15.0) - 0.005).abs() < 1e-12);
}

#[test]
fn a_lag_settles_at_velocity_over_gain_and_slows_add() {
    for (errors, behind) in [
        ("{EXX: [{lag: {gain: 25 1/s}}]}", 10.0 / 25.0),
        ("{EXX: [{lag: {gain: 25 1/s}}, {lag: {gain: 100 1/s}}]}", 10.0 / 25.0 + 10.0 / 100.0),
    ] {
        let recorded = along(&stage(errors), 10.0, 50.0);
        let deviation = deviation(&recorded);
        let at = |time: f64| deviation[recorded.time.iter().position(|known| *known >= time).unwrap()];
        assert_eq!(deviation[0], 0.0, "at rest before the start");
        assert!((at(9.9) + behind).abs() < 1e-9, "{errors}");
        assert!((at(19.9) - behind).abs() < 1e-9, "{errors}");
        // From rest the distance grows by 1 - exp(-K t).
        let gain = 10.0 / behind;
        assert!((at(0.04) + behind * (1.0 - (-gain * 0.04_f64).exp())).abs() < 1e-9, "{errors}");
    }
}

#[test]
fn the_other_terms_see_the_position_behind_the_lag() {
    let plant = stage(
        "{EXX: [{lag: {gain: 2 1/s}}], EYX: [{polynomial: {per: mm, unit: mm, coefficients: [0, 1e-3]}}]}",
    );
    let recorded = along(&plant, 10.0, 20.0);
    for (x, y) in recorded.readings[0].values.iter().zip(&recorded.readings[1].values) {
        assert!((y - 1e-3 * x).abs() < 1e-12);
    }
}

#[test]
fn a_lag_of_another_motion_adds_and_does_not_move_the_axis() {
    let plant = stage("{EYX: [{lag: {gain: 20 1/s}}]}");
    let recorded = along(&plant, 10.0, 50.0);
    assert!(deviation(&recorded).iter().all(|value| value.abs() < 1e-12));
    let row = recorded.time.iter().position(|time| *time >= 9.0).unwrap();
    assert!((recorded.readings[1].values[row] + 10.0 / 20.0).abs() < 1e-9);
}

#[test]
fn a_second_order_loop_may_stand_in_for_a_lag() {
    let plant = stage("{}").with_servo(0, Some(Servo::Second { frequency: 40.0, damping: 0.5 }));
    let recorded = along(&plant, 10.0, 50.0);
    let row = recorded.time.iter().position(|time| *time >= 9.0).unwrap();
    assert!((deviation(&recorded)[row] + 10.0 * 2.0 * 0.5 / 40.0).abs() < 1e-9);
}

#[test]
fn acceleration_counts_the_ramps_only() {
    let plant = stage("{EXX: [{acceleration: {gain: 1000 1/s^2}}]}");
    let mut wanted = scenario(path(line(0, 0.0, 100.0), 20.0, 100.0), Instrument::position());
    wanted.path.acceleration = Some(10.0);
    let recorded = simulate(&plant, &wanted).unwrap();
    let deviation = deviation(&recorded);
    let at = |time: f64| deviation[recorded.time.iter().position(|known| *known >= time).unwrap()];
    // Up in 2 s, 3 s at full speed, down in 2 s, and the same back.
    for (time, acceleration) in [(1.0, 10.0), (3.5, 0.0), (6.0, -10.0), (8.0, -10.0), (13.0, 10.0)] {
        assert!((at(time) + acceleration / 1000.0).abs() < 1e-9, "{time}: {}", at(time));
    }
}

#[test]
fn spikes_decay_from_the_reversal_on() {
    let plant = stage("{EXX: [{reversal-spike: {height: 5 um, decay: 200 ms}}]}");
    let recorded = along(&plant, 10.0, 50.0);
    let deviation = deviation(&recorded);
    let turned = recorded.time.iter().position(|time| *time > 10.0 + 1e-9).unwrap();
    assert!(deviation[..turned].iter().all(|value| value.abs() < 1e-12));
    for (deviation, time) in deviation.iter().zip(&recorded.time).skip(turned) {
        let since = time - recorded.time[turned];
        assert!((deviation - 0.005 * (-since / 0.2).exp()).abs() < 1e-12);
    }
}

#[test]
fn waves_are_of_position_or_of_time() {
    let plant = stage(
        "{EXX: [{cyclic: {period: 5 mm, amplitude: 2 um, phase: 0.4 rad}}], EZX: [{vibration: {frequency: 3 Hz, amplitude: 1 um, phase: 1 rad}}]}",
    );
    let recorded = along(&plant, 10.0, 31.0);
    for (row, deviation) in deviation(&recorded).iter().enumerate() {
        let (q, t) = (recorded.commands[0][row], recorded.time[row]);
        assert!((deviation - 0.002 * (TAU * q / 5.0 + 0.4).sin()).abs() < 1e-12);
        assert!((recorded.readings[2].values[row] - 0.001 * (TAU * 3.0 * t + 1.0).sin()).abs() < 1e-12);
    }
}

#[test]
fn thermal_terms_follow_their_sensor_and_its_filter() {
    let plant = stage(
        "{EXX: [{expansion: {sensor: scale, coefficient: 11.5 um/m/K, reference: 20 degC}}], EYX: [{growth: {sensor: scale, coefficient: 2 um/K, reference: 20 degC, time_constant: 40 s}}], EZX: [{drift: {amplitude: 6 um, time_constant: 30 s}}]}",
    );
    let mut wanted = scenario(path(line(0, 0.0, 100.0), 1.0, 20.0), Instrument::position());
    wanted.temperatures = vec![Temperature {
        name: "scale".to_owned(),
        start: 22.0,
        steps: vec![(0.0, 30.0)],
        time_constant: 100.0,
        ..Temperature::default()
    }];
    let recorded = simulate(&plant, &wanted).unwrap();
    let sensor = &recorded.temperatures[0].values;
    for (row, time) in recorded.time.iter().enumerate() {
        let q = recorded.commands[0][row];
        let warmth = 30.0 - 8.0 * (-time / 100.0).exp();
        assert!((sensor[row] - warmth).abs() < 1e-12);
        let expanded = 11.5e-6 * (warmth - 20.0) * q;
        assert!((recorded.readings[0].values[row] - q - expanded).abs() < 1e-12);
        // T through another filter: the sum of both exponentials. Linear between samples of 50 ms it is good to 1e-6 degC.
        let filtered =
            30.0 - 8.0 * (100.0 * (-time / 100.0).exp() - 40.0 * (-time / 40.0).exp()) / (100.0 - 40.0);
        assert!((recorded.readings[1].values[row] - 0.002 * (filtered - 20.0)).abs() < 1e-8);
        assert!((recorded.readings[2].values[row] - 0.006 * (1.0 - (-time / 30.0).exp())).abs() < 1e-12);
    }
}

#[test]
fn coupling_and_compliance_come_from_elsewhere() {
    let plant = plant(
        "XYFZ",
        "{EZX: [{coupling: {axis: Y, per: m, unit: um, coefficients: [30, -200]}}, {compliance: {load: cutting, coefficient: 0.05 um/N}}]}",
    );
    let mut wanted = scenario(path(line(1, 0.0, 200.0), 50.0, 20.0), Instrument::position());
    let pulses = Pulses { height: 100.0, period: 2.0, width: 0.5, start: 0.0 };
    wanted.loads = vec![Load {
        name: "cutting".to_owned(),
        unit: "N".to_owned(),
        pulses: Some(pulses),
        ..Load::default()
    }];
    let recorded = simulate(&plant, &wanted).unwrap();
    for (row, z) in recorded.readings[2].values.iter().enumerate() {
        let metres = recorded.commands[1][row] / 1000.0;
        let bent = 0.03 * metres - 0.2 * metres * metres;
        let pushed = 5e-5 * recorded.loads[0].values[row];
        // The table X carries the part: what lifts it brings the tip nearer.
        assert!((z - 120.0 + bent + pushed).abs() < 1e-12, "{row}");
    }
}

#[test]
fn what_no_term_describes_can_be_added() {
    let built = Built::of("FX", "{}");
    let motion = built.names.motion("EXX").unwrap();
    let plant = built.plant().with_effect(
        motion,
        Arc::new(|state| if state.position(0) > 50.0 { 1e-4 * state.velocity(0) } else { 0.0 }),
    );
    let recorded = along(&plant, 10.0, 9.0);
    let late: Vec<f64> = deviation(&recorded);
    assert!((late[60] - 1e-3).abs() < 1e-12 && late[10].abs() < 1e-12);
}

#[test]
fn a_rotation_is_finite_and_not_linearised() {
    // A pitch of half a degree: the tip 120 mm below the carriage goes round an arc.
    let plant = plant("FZX", "{EBX: 0.5 deg}");
    let recorded =
        simulate(&plant, &scenario(path(Shape::Still { time: 1.0 }, 1.0, 1.0), Instrument::position()))
            .unwrap();
    let angle = 0.5_f64.to_radians();
    assert!((recorded.readings[0].values[0] - 120.0 * angle.sin()).abs() < 1e-12);
    assert!((recorded.readings[2].values[0] - 120.0 * angle.cos()).abs() < 1e-12);
}

#[test]
fn a_missing_sensor_is_told_by_name() {
    let plant = stage("{EXX: [{growth: {sensor: motor, coefficient: 1 um/K, reference: 20 degC}}]}");
    let error = simulate(&plant, &scenario(path(line(0, 0.0, 9.0), 1.0, 1.0), Instrument::position()));
    assert_eq!(error.unwrap_err().to_string(), "the calibration needs the temperature of `motor`");
}
