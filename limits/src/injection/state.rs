//! The states that effects follow. In: times, runs and positions as they were recorded. Out: velocity, acceleration,
//! direction and the time since the last reversal, row by row; and what stays behind a command.
//!
//! All of it is written from the definitions of the terms alone: nothing here is shared with the diagnosis or the simulation.

use crate::injection::columns::{median, rms};

/// A pause this many times as long as the usual step is a gap, over which nothing is driven.
const GAP: f64 = 20.0;

/// When rows were taken.
pub struct Clock {
    /// Time since the recording began, s.
    pub time: Vec<f64>,
    /// The stretches that were driven in one go, as ranges of rows.
    pub stretches: Vec<(usize, usize)>,
    /// The usual time from row to row, s.
    pub step: f64,
}

impl Clock {
    /// A clock of rows with their runs.
    pub fn new(time: Vec<f64>, run: &[i64]) -> Self {
        let steps: Vec<f64> =
            time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
        let step = median(&steps);
        let ends = |row: usize| {
            row == time.len() || run[row] != run[row - 1] || time[row] - time[row - 1] > GAP * step
        };
        let (mut stretches, mut start) = (Vec::new(), 0);
        for row in (1..=time.len()).filter(|row| ends(*row)) {
            stretches.push((start, row));
            start = row;
        }
        Self { time, stretches, step }
    }

    /// From the first row to the last, s.
    pub fn span(&self) -> f64 {
        self.time.last().copied().unwrap_or(0.0) - self.time.first().copied().unwrap_or(0.0)
    }
}

/// Where one axis is and how it moves: mm or rad, and s.
pub struct Axis {
    /// Where it is.
    pub position: Vec<f64>,
    /// By central differences.
    pub velocity: Vec<f64>,
    /// By central differences of those.
    pub acceleration: Vec<f64>,
    /// +1 or -1: the direction of the last real motion, +1 before the first.
    pub direction: Vec<f64>,
    /// The time since the last reversal; infinite before the first.
    pub since: Vec<f64>,
    /// How often it turns.
    pub turns: usize,
    /// From where to where it goes.
    pub range: [f64; 2],
}

impl Axis {
    /// Follows positions; a motion back by no more than `deadband` of the travel is none.
    pub fn new(clock: &Clock, position: Vec<f64>, deadband: f64) -> Self {
        let range = [
            position.iter().copied().fold(f64::INFINITY, f64::min),
            position.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        ];
        let (direction, since, turns) = directions(&clock.time, &position, deadband * (range[1] - range[0]));
        let velocity = slopes(clock, &position);
        let acceleration = slopes(clock, &velocity);
        Self { position, velocity, acceleration, direction, since, turns, range }
    }

    /// How far it goes.
    pub fn travel(&self) -> f64 {
        self.range[1] - self.range[0]
    }

    /// The longest way from row to row.
    pub fn stride(&self) -> f64 {
        self.position.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
    }

    /// Whether the acceleration goes on from row to row, as that of rounded or jittering positions does not: differences of
    /// numbers that know nothing of each other are 1.4 times as large as the numbers.
    pub fn smooth(&self) -> bool {
        let steps: Vec<f64> = self.acceleration.windows(2).map(|pair| pair[1] - pair[0]).collect();
        rms(&steps) < 0.7 * rms(&self.acceleration)
    }

    /// How many places it stands at, told apart by a millionth of the travel.
    pub fn stations(&self) -> usize {
        let near = 1e-6 * self.travel();
        let mut places = self.position.clone();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|later, kept| *later - *kept <= near);
        places.len()
    }
}

/// Slopes by central differences within each stretch, one-sided at its ends.
fn slopes(clock: &Clock, values: &[f64]) -> Vec<f64> {
    let mut slopes = Vec::with_capacity(values.len());
    for &(start, end) in &clock.stretches {
        slopes.extend((start..end).map(|row| {
            let (from, to) = (row.saturating_sub(1).max(start), (row + 1).min(end - 1));
            let step = clock.time[to] - clock.time[from];
            if step > 0.0 { (values[to] - values[from]) / step } else { 0.0 }
        }));
    }
    slopes
}

/// Directions, times since the last reversal, and how many reversals there are. The first motion is none.
fn directions(time: &[f64], position: &[f64], deadband: f64) -> (Vec<f64>, Vec<f64>, usize) {
    let (mut direction, mut moved, mut turned, mut turns) = (1.0, false, f64::NEG_INFINITY, 0);
    let mut furthest = position.first().copied().unwrap_or(0.0);
    let (mut found, mut since) = (Vec::new(), Vec::new());
    for (&now, &at) in time.iter().zip(position) {
        let gone = at - furthest;
        if gone * direction > 0.0 && moved {
            furthest = at;
        } else if gone.abs() > deadband {
            if moved {
                (turned, turns) = (now, turns + 1);
            }
            (direction, moved, furthest) = (gone.signum(), true, at);
        }
        found.push(direction);
        since.push(now - turned);
    }
    (found, since, turns)
}

/// What follows an input at the rate `rate` (1/s): y' = rate (input - y), at rest on the input where a stretch begins, the
/// input straight between rows. What stays behind, y - input, falls by exp(-rate t) and gains -slope/rate (1 - exp(-rate t)).
pub fn followed(clock: &Clock, input: &[f64], rate: f64) -> Vec<f64> {
    let mut output = input.to_vec();
    for &(start, end) in &clock.stretches {
        let mut behind = 0.0;
        for row in start + 1..end {
            let step = clock.time[row] - clock.time[row - 1];
            let decay = (-rate * step).exp();
            let slope = if step > 0.0 { (input[row] - input[row - 1]) / step } else { 0.0 };
            behind = behind * decay - slope / rate * (1.0 - decay);
            output[row] = input[row] + behind;
        }
    }
    output
}

/// A play that is taken up over the way `wind_up`: within -1 and 1, follows the position by twice the way over `wind_up`.
pub fn taken_up(axis: &Axis, wind_up: f64) -> Vec<f64> {
    let mut state = axis.direction.first().copied().unwrap_or(1.0);
    let mut before = axis.position.first().copied().unwrap_or(0.0);
    let next = |position: &f64| {
        state = (state + 2.0 * (position - before) / wind_up).clamp(-1.0, 1.0);
        before = *position;
        state
    };
    axis.position.iter().map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock(rows: usize, step: f64) -> Clock {
        Clock::new((0..rows).map(|row| step * row as f64).collect(), &vec![1; rows])
    }

    #[test]
    fn rows_of_another_run_or_behind_a_gap_are_another_stretch() {
        let time = vec![0.0, 1.0, 2.0, 3.0, 100.0, 101.0];
        assert_eq!(Clock::new(time, &[1, 1, 2, 2, 2, 2]).stretches, [(0, 2), (2, 4), (4, 6)]);
    }

    #[test]
    fn a_parabola_has_its_acceleration() {
        let clock = clock(9, 0.5);
        let axis = Axis::new(&clock, clock.time.iter().map(|t| 3.0 * t * t).collect(), 0.0);
        // Away from the ends, where differences are one-sided.
        assert!(axis.acceleration[2..7].iter().all(|a| (a - 6.0).abs() < 1e-9), "{:?}", axis.acceleration);
        assert!((axis.velocity[4] - 12.0).abs() < 1e-9);
    }

    #[test]
    fn a_swing_is_smooth_and_a_jitter_is_not() {
        let clock = clock(200, 0.01);
        let swing = clock.time.iter().map(|t| (6.0 * t).sin()).collect();
        assert!(Axis::new(&clock, swing, 0.0).smooth());
        let jitter = (0..200_u32).map(|row| f64::from(row.wrapping_mul(2_654_435_761) >> 16)).collect();
        assert!(!Axis::new(&clock, jitter, 0.0).smooth());
    }

    #[test]
    fn directions_turn_at_real_motions_and_the_first_motion_is_no_reversal() {
        let clock = clock(7, 1.0);
        let axis = Axis::new(&clock, vec![5.0, 5.0, 3.0, 3.0 + 1e-9, 2.0, 3.0, 3.0], 1e-6);
        assert_eq!(axis.direction, [1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0]);
        assert_eq!(axis.turns, 1);
        assert_eq!((axis.since[4], axis.since[5], axis.since[6]), (f64::INFINITY, 0.0, 1.0));
    }

    #[test]
    fn a_loop_stays_behind_by_velocity_over_gain() {
        let clock = clock(400, 0.01);
        let ramp: Vec<f64> = clock.time.iter().map(|t| 8.0 * t).collect();
        let behind = followed(&clock, &ramp, 20.0);
        // From rest: v/K (1 - exp(-K t)), at every row and not only in the end.
        for (row, t) in clock.time.iter().enumerate() {
            let expected = 0.4 * (1.0 - (-20.0 * t).exp());
            assert!((ramp[row] - behind[row] - expected).abs() < 1e-12, "row {row}");
        }
    }

    #[test]
    fn a_wind_up_as_long_as_the_play_is_a_slide_that_stands_until_it_is_crossed() {
        let clock = clock(41, 1.0);
        let there_and_back = (0..41).map(|row: i32| f64::from(20 - (row - 20).abs())).collect();
        let axis = Axis::new(&clock, there_and_back, 1e-6);
        let (play, taken) = (4.0, taken_up(&axis, 4.0));
        let slide: Vec<f64> = axis.position.iter().zip(&taken).map(|(q, u)| q - play / 2.0 * u).collect();
        assert_eq!(slide[20..25], [18.0; 5], "it stands while the drive goes from 20 to 16");
        assert_eq!(slide[25], 17.0);
    }
}
