//! Loops against fine integration of their own equation, and at the ends of what they may be.

use super::*;

/// Runge and Kutta for `inertia q'' + time_constant q' + q = command` through straight pieces of the command.
fn integrated(one: PositionLoop, time: &[f64], commands: &[f64], start: Stand) -> Vec<Stand> {
    let rate = |q: f64, v: f64, command: f64| match one.inertia {
        0.0 => ((command - q) / one.time_constant, 0.0),
        inertia => (v, (command - q - one.time_constant * v) / inertia),
    };
    let (mut q, mut v) = (start.position, start.velocity);
    let mut stands = vec![start];
    for (times, ends) in time.windows(2).zip(commands.windows(2)) {
        let parts = 2000;
        let h = (times[1] - times[0]) / f64::from(parts);
        for part in 0..parts {
            let at =
                |share: f64| ends[0] + (ends[1] - ends[0]) * (f64::from(part) + share) / f64::from(parts);
            let a = rate(q, v, at(0.0));
            let b = rate(q + h / 2.0 * a.0, v + h / 2.0 * a.1, at(0.5));
            let c = rate(q + h / 2.0 * b.0, v + h / 2.0 * b.1, at(0.5));
            let d = rate(q + h * c.0, v + h * c.1, at(1.0));
            q += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
            v += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
        }
        let velocity = if one.inertia == 0.0 { (ends[1] - q) / one.time_constant } else { v };
        stands.push(Stand { position: q, velocity });
    }
    stands
}

fn followed(one: PositionLoop, time: &[f64], commands: &[f64], start: Start) -> Vec<Stand> {
    let mut follower = Follower::from(start);
    time.iter().zip(commands).map(|(time, command)| one.follow(&mut follower, *time, *command, 0.0)).collect()
}

#[test]
fn every_loop_solves_its_own_equation() {
    let time = [0.0, 0.01, 0.02, 0.05, 0.051, 0.2, 0.9];
    let commands = [3.0, 3.0, 3.4, 2.0, 2.0, 7.0, 7.0];
    let start = Stand { position: 2.6, velocity: -4.0 };
    // Of first order; ringing, critical and creeping of second order.
    for inertia in [0.0, 4e-4, 1e-4, 2.5e-5] {
        let one = PositionLoop { time_constant: 0.02, inertia };
        let rest = Stand { position: commands[0], velocity: 0.0 };
        for (from, begin) in [(Start::AtRest, rest), (Start::At(start), start)] {
            let expected = integrated(one, &time, &commands, begin);
            let found = followed(one, &time, &commands, from);
            for (found, expected) in found.iter().zip(&expected).skip(1) {
                assert!(
                    (found.position - expected.position).abs() < 1e-8,
                    "{inertia}: {found:?} {expected:?}"
                );
                assert!(
                    (found.velocity - expected.velocity).abs() < 1e-5,
                    "{inertia}: {found:?} {expected:?}"
                );
            }
        }
    }
}

#[test]
fn a_parabola_is_followed_as_many_short_chords_of_it_are() {
    let command = |t: f64| 2.0 + 3.0 * t - 40.0 * t * t;
    let start = Stand { position: 1.9, velocity: -4.0 };
    let time: Vec<f64> = (0..=4000).map(|row| 0.05 * f64::from(row) / 4000.0).collect();
    let commands: Vec<f64> = time.iter().map(|t| command(*t)).collect();
    for inertia in [0.0, 4e-4, 1e-4, 2.5e-5] {
        let one = PositionLoop { time_constant: 0.02, inertia };
        let expected = *followed(one, &time, &commands, Start::At(start)).last().unwrap();
        let piece = Piece { from: command(0.0), to: command(0.05), time: 0.05, acceleration: -80.0 };
        let found = one.step(start, piece);
        assert!((found.position - expected.position).abs() < 1e-8, "{inertia}: {found:?} {expected:?}");
        assert!((found.velocity - expected.velocity).abs() < 1e-2, "{inertia}: {found:?} {expected:?}");
    }
}

#[test]
fn without_inertia_a_loop_is_of_first_order() {
    let time: Vec<f64> = (0..200).map(|row| 0.01 * f64::from(row)).collect();
    let commands: Vec<f64> = time.iter().map(|t| 5.0 * (3.0 * t).sin()).collect();
    let at = |inertia: f64| {
        followed(PositionLoop { time_constant: 0.03, inertia }, &time, &commands, Start::AtRest)
    };
    for (light, none) in at(1e-9).iter().zip(at(0.0)) {
        assert!((light.position - none.position).abs() < 1e-5, "{light:?} {none:?}");
    }
}

#[test]
fn a_steady_motion_is_followed_by_the_time_constant_whatever_the_inertia() {
    let time: Vec<f64> = (0..3000).map(|row| 0.002 * f64::from(row)).collect();
    let commands: Vec<f64> = time.iter().map(|t| 12.0 * t).collect();
    for inertia in [0.0, 1e-5, 1e-3] {
        let found = followed(PositionLoop { time_constant: 0.04, inertia }, &time, &commands, Start::AtRest);
        let behind = commands[2999] - found[2999].position;
        assert!((behind - 12.0 * 0.04).abs() < 1e-9, "{inertia}: {behind}");
    }
}

#[test]
fn a_missing_command_is_a_gap_and_no_more() {
    let one = PositionLoop { time_constant: 0.2, inertia: 0.003 };
    let whole = followed(one, &[0.0, 0.2], &[0.0, 2.0], Start::AtRest);
    let gap = followed(one, &[0.0, 0.1, 0.2], &[0.0, f64::NAN, 2.0], Start::AtRest);
    assert!(gap[1].position.is_nan());
    assert_eq!((gap[2].position, gap[2].velocity), (whole[1].position, whole[1].velocity));
}

/// A way of constant acceleration, by a sum of straight pieces of a millisecond, that is recorded from its sixth second on.
#[test]
fn a_loop_that_begins_underway_is_where_it_would_be_had_it_been_followed_from_its_rest() {
    let command = |t: f64| 2.0 * t * t;
    let time: Vec<f64> = (0..8001).map(|row| 1e-3 * f64::from(row)).collect();
    let commands: Vec<f64> = time.iter().map(|t| command(*t)).collect();
    for inertia in [0.0, 4e-3, 4e-4] {
        let one = PositionLoop { time_constant: 0.05, inertia };
        let whole = followed(one, &time, &commands, Start::AtRest);
        let start = Start::Underway { velocity: 4.0 * time[6000], acceleration: 4.0 };
        let cut = followed(one, &time[6000..], &commands[6000..], start);
        for (cut, whole) in cut.iter().zip(&whole[6000..]) {
            assert!((cut.position - whole.position).abs() < 1e-6, "{inertia}: {cut:?} {whole:?}");
            assert!((cut.velocity - whole.velocity).abs() < 2e-3, "{inertia}: {cut:?} {whole:?}");
        }
    }
}
