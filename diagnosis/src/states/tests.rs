//! States against closed solutions, fine integration, and the histories of the exact machine.

use super::*;
use crate::side::Side;
use crate::terms::Memory;
use crate::testing::{Bench, commands, distance, normals, path, peak, programmed, scenario, uneven};
use simulation::path::Shape;

/// A loop of first order.
fn behind(time_constant: f64) -> Driven {
    Driven { position_loop: PositionLoop { time_constant, inertia: 0.0 }, ..Driven::default() }
}

fn states(time: &[f64], command: &[f64], lag: f64, clock: f64) -> States {
    let recording = programmed(time, &[command.to_vec()]);
    States::new(&recording, &Given::new(&recording, Vec::new(), Vec::new()), &[behind(lag)], clock)
}

fn axis(time: &[f64], command: &[f64], lag: f64) -> AxisStates {
    states(time, command, lag, 0.0).axes.remove(0)
}

#[test]
fn behind_a_loop_a_ramp_is_the_closed_solution() {
    let (speed, lag) = (12.0, 0.4);
    let time = uneven(1, 80, 0.1);
    let command: Vec<f64> = time.iter().map(|t| speed * t).collect();
    let states = axis(&time, &command, lag);
    let solution: Vec<f64> = time.iter().map(|t| speed * (t - lag * (1.0 - (-t / lag).exp()))).collect();
    assert!(distance(&states.position, &solution) < 1e-11);
    let slope = |t: &f64| speed * ((-t / lag).exp() * (1.0 + t / lag) - 1.0);
    let slopes: Vec<f64> = time.iter().map(slope).collect();
    assert!(distance(&states.lag_slope, &slopes) < 1e-3 * speed);
}

#[test]
fn behind_a_loop_a_circle_is_what_fine_integration_gives() {
    let (radius, turn, lag, step) = (80.0, 1.1, 0.05, 0.02);
    let time: Vec<f64> = (0..600).map(|row| step * f64::from(row)).collect();
    let command: Vec<f64> = time.iter().map(|t| radius * (turn * t).sin()).collect();
    let found = axis(&time, &command, lag).position;
    // Runge and Kutta through the straight pieces between the rows.
    let mut q = command[0];
    let mut integrated = vec![q];
    let parts = 200;
    for pair in command.windows(2) {
        let h = step / f64::from(parts);
        let slope = (pair[1] - pair[0]) / step;
        for part in 0..parts {
            let at = |inner: f64, q: f64| (pair[0] + slope * (f64::from(part) * h + inner) - q) / lag;
            let a = at(0.0, q);
            let b = at(h / 2.0, q + h / 2.0 * a);
            let c = at(h / 2.0, q + h / 2.0 * b);
            let d = at(h, q + h * c);
            q += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
        integrated.push(q);
    }
    assert!(distance(&found, &integrated) < 1e-9);
    // In the end it is the circle itself, smaller by the cosine of the phase that it lags by.
    let (w, phase) = (turn * lag, (turn * lag).atan());
    let steady = |t: &f64| radius * phase.cos() * (turn * t - phase).sin();
    let late: Vec<f64> = time[300..].iter().map(steady).collect();
    assert!(distance(&found[300..], &late) < 2e-4 * radius, "{w}");
}

#[test]
fn missing_commands_are_missing_states_and_bridged_by_straight_lines() {
    let time: Vec<f64> = (0..60).map(|row| 0.1 * f64::from(row)).collect();
    let command: Vec<f64> = time.iter().map(|t| 5.0 * t).collect();
    let whole = axis(&time, &command, 0.3);
    let mut gappy = command.clone();
    gappy[20..31].fill(f64::NAN);
    let states = axis(&time, &gappy, 0.3);
    assert!(states.position[20..31].iter().all(|q| q.is_nan()));
    // On a ramp the bridge is the ramp.
    assert!(distance(&states.position[31..], &whole.position[31..]) < 1e-11);
    assert!(states.direction.iter().all(|d| *d == 1.0));
    let still = axis(&time, &vec![f64::NAN; 60], 0.3);
    assert!(!still.moves && still.position.iter().all(|q| q.is_nan()));
}

#[test]
fn the_clock_shows_what_was_so_much_earlier() {
    let time = uneven(4, 120, 0.1);
    let way = |t: f64| 7.0 * (0.9 * t).sin() + 3.0;
    let command: Vec<f64> = time.iter().map(|t| way(*t)).collect();
    for clock in [0.03, 0.25, -0.04, -0.31] {
        let shown = states(&time, &command, 0.0, clock).axes.remove(0);
        let seen: Vec<f64> = time.iter().map(|t| way((t - clock).clamp(time[0], time[119]))).collect();
        // Between rows the way is round: a chord would be 0.02 off where the steps are longest.
        assert!(distance(&shown.position[5..115], &seen[5..115]) < 2e-3, "{clock}");
        // At the ends there is no row beyond to tell how it bends.
        assert!(distance(&shown.position, &seen) < 0.03, "{clock}");
        let speed: Vec<f64> = time.iter().map(|t| -6.3 * (0.9 * (t - clock)).cos()).collect();
        assert!(distance(&shown.clock_slope[5..115], &speed[5..115]) < 0.1, "{clock}");
        // Along a straight way nothing bends.
        let straight: Vec<f64> = time.iter().map(|t| 2.0 - 4.0 * t).collect();
        let shown = states(&time, &straight, 0.0, clock).axes.remove(0);
        let seen: Vec<f64> = time.iter().map(|t| 2.0 - 4.0 * (t - clock).clamp(time[0], time[119])).collect();
        assert!(distance(&shown.position, &seen) < 1e-11, "{clock}");
    }
}

#[test]
fn a_clock_sees_the_way_on_both_sides_of_a_corner_between_two_rows() {
    let time: Vec<f64> = (0..40).map(|row| 0.1 * f64::from(row)).collect();
    // There at 8 mm/s and back at 5 mm/s; the corner lies between two rows, or at one.
    for corner in [1.93, 2.0] {
        let way = |t: f64| if t < corner { 8.0 * t } else { 8.0 * corner - 5.0 * (t - corner) };
        let command: Vec<f64> = time.iter().map(|t| way(*t)).collect();
        for clock in [-0.02, -0.06, 0.02, 0.06] {
            let shown = states(&time, &command, 0.0, clock).axes.remove(0);
            let seen: Vec<f64> = time.iter().map(|t| way((t - clock).clamp(time[0], time[39]))).collect();
            assert!(distance(&shown.position, &seen) < 1e-9, "{corner} {clock}");
        }
    }
}

#[test]
fn directions_are_of_the_last_real_motion() {
    let nan = f64::NAN;
    let position = [5.0, 5.0, 4.0, 4.0, 4.0, 3.0, nan, nan, 2.0, 2.0, 2.5, 3.0, 3.0, 2.9, 2.0];
    let time: Vec<f64> = (0..15).map(f64::from).collect();
    let found = axis(&time, &position, 0.0);
    let d = [1.0, 1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0];
    assert_eq!(*found.direction, d);
    // The first motion is no reversal.
    assert!(found.since_reversal[..10].iter().all(|since| since.is_infinite() && *since > 0.0));
    assert_eq!(found.since_reversal[10..], [0.0, 1.0, 2.0, 0.0, 1.0]);
    assert!(found.moves);
}

#[test]
fn the_rounding_of_a_programmed_position_is_no_motion() {
    let time: Vec<f64> = (0..40).map(f64::from).collect();
    // To 100 mm, then a rest that trembles in the last digit.
    let rest = |row: u32| 100.0 + if row.is_multiple_of(2) { 1e-12 } else { 0.0 };
    let command: Vec<f64> =
        (0..40).map(|row| if row < 20 { 5.0 * f64::from(row) } else { rest(row) }).collect();
    let found = axis(&time, &command, 0.0);
    assert!(found.direction.iter().all(|d| *d == 1.0));
    let still = axis(&time, &vec![37.5; 40], 0.0);
    assert!(!still.moves && still.since_reversal.iter().all(|since| since.is_infinite()));
}

#[test]
fn derivatives_of_parabolas_are_exact_at_uneven_times() {
    let time = uneven(6, 50, 0.3);
    let values: Vec<f64> = time.iter().map(|t| 2.0 - 3.0 * t + 1.7 * t * t).collect();
    let expected: Vec<f64> = time.iter().map(|t| -3.0 + 3.4 * t).collect();
    let found = derivative(&time, &[1; 50], &values);
    assert!(distance(&found[1..49], &expected[1..49]) < 1e-9 * peak(&expected));
    let mut gappy = values.clone();
    gappy[17] = f64::NAN;
    gappy[30..34].fill(f64::NAN);
    let found = derivative(&time, &[1; 50], &gappy);
    for row in (1..49).filter(|row| !gappy[*row].is_nan()) {
        assert!((found[row] - expected[row]).abs() < 1e-9 * peak(&expected), "{row}");
    }
    assert!(
        found[17].is_nan()
            && derivative(&[0.0], &[1], &[3.0]) == [0.0]
            && derivative(&[], &[], &[]).is_empty()
    );
}

#[test]
fn derivatives_stay_within_a_leg() {
    let time = [0.0, 1.0, 3.0, 10.0, 11.0, 12.0];
    let values = time.map(|t| if t < 5.0 { 2.0 * t } else { 50.0 - 3.0 * t });
    assert_eq!(derivative(&time, &[1, 1, 1, 2, 2, 2], &values), [2.0, 2.0, 2.0, -3.0, -3.0, -3.0]);
}

#[test]
fn states_are_those_of_the_exact_machine() {
    let bench = Bench::of("XYFZ");
    let truth = bench.calibration("{EXX: [{lag: {gain: 30 1/s}}], EYY: [{lag: {gain: 45 1/s}}]}");
    let mut spiral = path(Shape::Spiral { plane: [0, 1], inner: 10.0, outer: 60.0, turns: 2.0 }, 40.0, 50.0);
    spiral.acceleration = Some(200.0);
    let plant = bench.plant(&truth);
    let recording = bench.recorded(&plant, &scenario(spiral, simulation::Instrument::position()));
    let states = States::new(
        &recording,
        &Given::new(&recording, Vec::new(), Vec::new()),
        &[behind(1.0 / 30.0), behind(1.0 / 45.0), behind(0.0)],
        0.0,
    );
    let mut worst = [0.0_f64; 2];
    let mut turned = 0;
    let mut each = |moment: &simulation::Moment<'_>| {
        let row = moment.state.row;
        for (number, axis) in states.axes.iter().enumerate() {
            worst[0] = worst[0].max((axis.position[row] - moment.state.position(number)).abs());
            assert_eq!(axis.direction[row], moment.state.direction(number), "axis {number} row {row}");
            let since = moment.state.time - moment.state.reversal(number);
            if since.is_nan() {
                assert!(axis.since_reversal[row].is_infinite());
            } else {
                worst[1] = worst[1].max((axis.since_reversal[row] - since).abs());
                turned += 1;
            }
        }
    };
    plant.run(&commands(&recording), &mut each).unwrap();
    assert!(worst[0] < 1e-9 && worst[1] < 1e-9, "{worst:?}");
    assert!(turned > 100);
    assert!(!states.axes[2].moves);
}

#[test]
fn views_are_the_rows_themselves() {
    let time: Vec<f64> = (0..20).map(f64::from).collect();
    let command: Vec<f64> = time.iter().map(|t| t * t).collect();
    let recording = programmed(&time, std::slice::from_ref(&command));
    let warm: Vec<f64> = time.iter().map(|t| 20.0 + t).collect();
    let load: Vec<f64> = time.iter().map(|t| 3.0 * t).collect();
    let states = States::new(
        &recording,
        &Given::new(&recording, vec![warm.clone()], vec![load.clone()]),
        &[behind(0.0)],
        0.0,
    );
    let rows = states.rows(5..9);
    assert_eq!(rows.len(), 4);
    assert_eq!((rows.time, rows.axis(0).position), (&time[5..9], &command[5..9]));
    assert_eq!((rows.temperature(0), rows.load(0)), (&warm[5..9], &load[5..9]));
}

#[test]
fn the_drive_stands_in_where_nothing_was_programmed() {
    let channels = |command: Option<Vec<f64>>, actual: Option<Vec<f64>>| AxisChannels {
        command,
        actual,
        measured: None,
    };
    assert_eq!(*nominal_position(&channels(Some(vec![1.0]), Some(vec![2.0])), 1), [1.0]);
    assert_eq!(*nominal_position(&channels(None, Some(vec![2.0])), 1), [2.0]);
    assert_eq!(*nominal_position(&channels(None, None), 3), [0.0; 3]);
}

#[test]
fn what_turned_between_two_rows_at_one_place_is_not_known() {
    let turns = |position: &[f64]| -> Vec<usize> {
        let unseen = unseen_turns(&vec![0; position.len()], position);
        (0..position.len()).filter(|row| unseen[*row]).collect()
    };
    // There and back, each end read twice; the second reading comes from nobody knows where.
    assert_eq!(turns(&[0.0, 5.0, 9.0, 9.0, 5.0, 0.0, 0.0, 5.0]), [3, 6]);
    // Read thrice, both of the later ones; an end that is read once, or left as it was reached, is no turn unseen.
    assert_eq!(turns(&[0.0, 9.0, 9.0, 9.0, 0.0]), [2, 3]);
    assert_eq!(turns(&[0.0, 5.0, 5.0, 9.0, 5.0, 0.0, 0.0]), [0; 0]);
    // An overrun that was recorded tells the side.
    assert_eq!(turns(&[0.0, 9.0, 11.0, 9.0, 0.0, -2.0, 0.0, 9.0]), [0; 0]);
}

#[test]
fn a_sharp_reversal_of_a_rounded_way_is_known_to_no_row_beside_it() {
    let beside = |position: &[f64]| -> Vec<usize> {
        let time: Vec<f64> = (0..position.len()).map(crate::number).collect();
        let marked = beside_reversals(&time, &vec![0; position.len()], position);
        (0..position.len()).filter(|row| marked[*row]).collect()
    };
    assert_eq!(beside(&[0.0, 6.0, 12.0, 18.0, 12.0, 6.0, 0.0]), [3, 4]);
    // A start, a stop and a slow turn are seen as they are.
    assert_eq!(beside(&[0.0, 0.0, 6.0, 12.0, 12.0, 12.0]), [0; 0]);
    assert_eq!(beside(&[0.0, 6.0, 9.0, 9.5, 9.0, 6.0, 0.0]), [0; 0]);
}

/// Sweeps as recorders store them: each run with a clock of its own, laid behind the last; and one that is the last of them alone.
fn sweeps() -> (Recording, Recording) {
    let speeds = [20.0, -35.0, 50.0];
    let sweep = |speed: f64| -> Vec<f64> {
        (0..150).map(|row: i32| 0.01 * speed * f64::from((row - 10).clamp(0, 100))).collect()
    };
    let command: Vec<f64> = speeds.iter().flat_map(|speed| sweep(*speed)).collect();
    let time: Vec<f64> = (0..command.len()).map(|row| 0.01 * crate::number(row)).collect();
    let mut all = programmed(&time, &[command]);
    all.run = (1..=3).flat_map(|run| vec![run; 150]).collect();
    (all, programmed(&time[..150], &[sweep(50.0)]))
}

#[test]
fn every_run_is_what_it_is_alone() {
    let (all, alone) = sweeps();
    for clock in [0.0, 0.017, -0.031, 0.4] {
        for lag in [0.0, 0.05, 0.3] {
            let states = |recording: &Recording| {
                let given = Given::new(recording, Vec::new(), Vec::new());
                States::new(recording, &given, &[behind(lag)], clock).axes.remove(0)
            };
            let (all, alone) = (states(&all), states(&alone));
            let pairs = [
                (&all.position, &alone.position),
                (&all.acceleration, &alone.acceleration),
                (&all.direction, &alone.direction),
                (&all.lag_slope, &alone.lag_slope),
                (&all.clock_slope, &alone.clock_slope),
            ];
            for (number, (all, alone)) in pairs.into_iter().enumerate() {
                let apart = distance(&all[300..], alone);
                // What is subtracted from a time that goes on is not rounded as what is subtracted from one that begins.
                assert!(apart <= 1e-9 * (1.0 + peak(alone)), "{number} of {lag} s, {clock} s: {apart}");
            }
            // No run turns, and to be driven to its beginning is no reversal.
            assert!(all.since_reversal.iter().all(|since| since.is_infinite()));
            assert!(all.direction[150..300].iter().all(|direction| *direction == -1.0));
        }
    }
}

#[test]
fn a_play_begins_anew_where_an_axis_was_displaced() {
    let (all, alone) = sweeps();
    let stands = |recording: &Recording| {
        let given = Given::new(recording, Vec::new(), Vec::new());
        let driven = |crossing| Driven { crossing, ..Driven::default() };
        let flank = |crossing| States::new(recording, &given, &[driven(crossing)], 0.0).axes.remove(0).flank;
        [Crossing::Over(4.0), Crossing::After(4.0)].map(flank)
    };
    for (all, alone) in stands(&all).iter().zip(&stands(&alone)) {
        assert!(distance(&all[300..], alone) < 1e-12);
    }
}

#[test]
fn a_play_that_comes_late_comes_when_the_axis_has_gone_so_far_back() {
    // There and back twice, the second time by less than the way.
    let command = [0.0, 3.0, 6.0, 5.0, 4.0, 3.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0];
    let time: Vec<f64> = (0..command.len()).map(|row| row as f64).collect();
    let recording = programmed(&time, &[command.to_vec()]);
    let given = Given::new(&recording, Vec::new(), Vec::new());
    let driven = Driven { crossing: Crossing::After(2.5), ..Driven::default() };
    let axis = States::new(&recording, &given, &[driven], 0.0).axes.remove(0);
    let late = [&[1.0; 5][..], &[-1.0; 7]].concat();
    assert_eq!((&*axis.flank, &*axis.jumped), (&*late, &*late));
    // The direction itself is that of the motion.
    let directions = [1.0, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, -1.0];
    assert_eq!(*axis.direction, directions);
    // What comes in on either side of the drive's feedback comes late. A play that is crossed is one behind the drive.
    let column = |crossing, side| {
        let driven = Driven { crossing, ..Driven::default() };
        let states = States::new(&recording, &given, &[driven], 0.0);
        let mut columns = [Vec::new()];
        let backlash = crate::terms::Shape::Backlash { axis: 0, wind_up: 0.0 };
        backlash.fill_on(side, &states.rows(0..command.len()), &mut Memory::default(), &mut columns);
        columns.concat()
    };
    let halves = |jumped: &[f64]| jumped.iter().map(|jumped| -0.5 * jumped).collect::<Vec<f64>>();
    for side in [Side::After, Side::Drive] {
        assert_eq!(column(Crossing::After(2.5), side), halves(&late));
    }
    assert_eq!(column(Crossing::Over(2.0), Side::Drive), halves(&directions));
    assert_ne!(column(Crossing::Over(2.0), Side::After), halves(&directions));
}

#[test]
fn runs_that_go_on_keep_their_direction_and_reversal() {
    // There, a pause, and back from where it stood: to leave the other way is a reversal.
    let command = [0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 2.0, 1.0];
    let mut recording = programmed(&[0.0, 1.0, 2.0, 3.0, 4.0, 105.0, 106.0, 107.0], &[command.to_vec()]);
    recording.run = vec![1, 1, 1, 1, 1, 2, 2, 2];
    let states =
        States::new(&recording, &Given::new(&recording, Vec::new(), Vec::new()), &[behind(0.0)], 0.0);
    assert_eq!(*states.axes[0].direction, [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -1.0, -1.0]);
    assert_eq!(states.axes[0].since_reversal[6..], [0.0, 1.0]);
}

#[test]
fn runs_and_gaps_are_those_of_the_exact_machine() {
    let bench = Bench::of("FX");
    let truth = bench.calibration("{EXX: [{lag: {gain: 12 1/s}}]}");
    let plant = bench.plant(&truth);
    for seed in 0..40 {
        // Pieces of motion and of rest, which go on, begin elsewhere, or come after a gap; with one run number or several.
        let mut draws = normals(seed, 60).into_iter();
        let mut draw = || draws.next().unwrap();
        let (mut time, mut command, mut run) = (Vec::new(), Vec::new(), Vec::new());
        let (mut now, mut place, mut number) = (0.0, 0.0, 1);
        for _ in 0..8 {
            let speed = if draw() > 0.0 { 30.0 * draw() } else { 0.0 };
            for _ in 0..40 {
                time.push(now);
                command.push(place);
                run.push(number);
                now += 0.01;
                place += 0.01 * speed;
            }
            now += if draw() > 0.5 { 1.0 } else { 0.0 };
            place += if draw() > 0.0 { 50.0 * draw() } else { 0.0 };
            number += i64::from(draw() > 0.0);
        }
        let mut recording = programmed(&time, &[command]);
        recording.run = run;
        let given = Given::new(&recording, Vec::new(), Vec::new());
        let states = States::new(&recording, &given, &[behind(1.0 / 12.0)], 0.0);
        let axis = &states.axes[0];
        let mut each = |moment: &simulation::Moment<'_>| {
            let row = moment.state.row;
            assert!((axis.position[row] - moment.state.position(0)).abs() < 1e-9, "{seed}, row {row}");
            assert_eq!(axis.direction[row], moment.state.direction(0), "{seed}, row {row}");
        };
        plant.run(&commands(&recording), &mut each).unwrap();
    }
}

/// On a parabola the way to each row has its acceleration; beside a corner, where only one end bends, it has none.
#[test]
fn the_way_between_rows_is_an_arc_and_no_corner() {
    let times = [0.0, 0.1, 0.25, 0.4, 0.5, 0.6];
    let parabola = times.map(|time| 3.0 * time * time - time);
    for row in 2..5 {
        assert!((steady_acceleration(&times, &parabola, row) - 6.0).abs() < 1e-9, "{row}");
    }
    // The ends of a leg are straight.
    assert_eq!([1, 5].map(|row| steady_acceleration(&times, &parabola, row)), [0.0, 0.0]);
    let corner = times.map(|time| if time < 0.25 { 0.0 } else { time - 0.25 });
    assert_eq!([2, 3, 4].map(|row| steady_acceleration(&times, &corner, row)), [0.0; 3]);
}

/// A recording that begins on the way is taken where its feedback begins. One whose feedback shows more than where the axis is, a
/// vibration, a wave or a play, is taken at rest on its command: none of these fades with the loop.
#[test]
fn an_axis_begins_away_from_its_command_where_its_way_back_is_seen() {
    let (lag, speed) = (0.02, 50.0);
    let time: Vec<f64> = (0..400).map(|row| 0.001 * f64::from(row)).collect();
    let command: Vec<f64> = time.iter().map(|t| speed * (t - 0.1).max(0.0)).collect();
    let at_rest = axis(&time, &command, lag).position;
    let fading = |t: f64| 0.4 * (-t / lag).exp();
    let shown = |more: &dyn Fn(f64) -> f64| {
        let noise = normals(5, time.len()).into_iter().map(|noise| 1e-3 * noise);
        let rows = time.iter().zip(at_rest.iter()).zip(noise);
        let actual = rows.map(|((t, position), noise)| position + more(*t) + noise).collect();
        let mut recording = programmed(&time, std::slice::from_ref(&command));
        recording.axes[0].actual = Some(actual);
        let given = Given::new(&recording, Vec::new(), Vec::new());
        States::new(&recording, &given, &[behind(lag)], 0.0).axes.remove(0).position
    };
    let away: Vec<f64> = at_rest.iter().zip(&time).map(|(position, t)| position + fading(*t)).collect();
    // The start is one reading, with its noise.
    assert!(distance(&shown(&fading), &away) < 5e-3);
    for frequency in [0.3, 1.0, 3.0, 4.5, 7.0, 23.0, 83.0, 300.0] {
        for eighths in 0..16_u8 {
            let phase = f64::from(eighths) * std::f64::consts::FRAC_PI_8;
            let vibration = |t: f64| 0.4 * (std::f64::consts::TAU * frequency * t + phase).sin();
            assert!(distance(&shown(&vibration), &at_rest) < 1e-12, "{frequency} Hz, {phase} rad");
        }
    }
    assert!(distance(&shown(&|_| -0.4), &at_rest) < 1e-12);
}

/// Rows of a tenth of a second, in which an axis goes so fast.
fn given(velocity: impl Fn(f64) -> f64) -> Given {
    let time: Vec<f64> = (0..100).map(|row| 0.1 * f64::from(row)).collect();
    let steps = time.iter().scan(0.0, |position, t| {
        let here = *position;
        *position += 0.1 * velocity(*t);
        Some(here)
    });
    let recording = programmed(&time, &[steps.collect()]);
    Given::new(&recording, Vec::new(), Vec::new())
}

/// Of an axis that keeps its speed a loop is only seen where it begins at rest.
#[test]
fn an_axis_may_begin_underway_where_it_moves_at_first_and_changes_its_speed() {
    let later = |t: f64| if t < 5.0 { 2.0 } else { -2.0 };
    for (is_underway, velocity) in [
        (true, &later as &dyn Fn(f64) -> f64),
        (true, &|t| 2.0 + t),
        (false, &|_| 2.0),
        (false, &|t| if t < 1.0 { 0.0 } else { 2.0 }),
    ] {
        assert_eq!(given(velocity).may_begin_underway(0), is_underway);
    }
}

/// The rows within five time constants of such a beginning do not count.
#[test]
fn an_axis_that_begins_underway_is_unsettled_until_its_loop_has_forgotten() {
    let given = given(|t| if t < 5.0 { 2.0 } else { -2.0 });
    let recording = programmed(&given.time, &[given.programmed[0].to_vec()]);
    let states = |underway: bool| {
        let driven = Driven { underway, ..behind(0.21) };
        States::new(&recording, &given, &[driven], 0.0)
    };
    let unsettled = |states: &States| (0..100).filter(|row| states.is_unsettled(*row)).collect::<Vec<_>>();
    assert_eq!(unsettled(&states(false)), Vec::<usize>::new());
    let underway = states(true);
    assert_eq!(unsettled(&underway), (0..11).collect::<Vec<_>>());
    // It begins behind its command by the time constant times the speed, and stays there.
    let command = &given.programmed[0];
    assert!((0..50).all(|row| (command[row] - underway.axes[0].position[row] - 0.42).abs() < 1e-9));
}
