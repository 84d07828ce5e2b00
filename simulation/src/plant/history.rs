//! The history of one axis: what the terms of error motions read of it.
//!
//! In: times, legs and positions behind the position loop. Out, one entry a sample: velocity and acceleration by
//! differences within the leg, the direction of the last real motion and the time of the last reversal. Where a leg begins
//! elsewhere than the last one ended, nobody knows how the axis came there: that is no motion and no reversal.

use crate::legs::{reach, stretches};

/// One axis over a whole recording; mm or rad, and s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// The position behind the position loop.
    pub position: Vec<f64>,
    /// The velocity: central differences, one-sided at the ends of a leg.
    pub velocity: Vec<f64>,
    /// The acceleration: second differences; at the ends of a leg that of the neighbour.
    pub acceleration: Vec<f64>,
    /// +1 or -1: the direction of the last real motion, +1 before the first; that of a leg's own first motion where the leg
    /// begins elsewhere than the last one ended.
    pub direction: Vec<f64>,
    /// Whether a leg begins there, elsewhere than the last one ended.
    pub displaced: Vec<bool>,
    /// The time of the sample at which the direction turned last, s; NaN before the first reversal since
    /// the axis was displaced.
    pub reversal: Vec<f64>,
}

impl History {
    /// Follows an axis through its legs, numbered sample by sample, with the position behind its loop; a motion back by no more than
    /// `deadband` is no real motion. Where a leg begins is a matter of its commands: what a loop had left to go is not asked.
    pub fn of(time: &[f64], legs: &[i64], commands: &[f64], position: Vec<f64>, deadband: f64) -> Self {
        let mut history = Self { position, ..Self::default() };
        let mut tracker = Tracker::default();
        let near = reach(legs, commands).max(deadband);
        let mut last = None;
        for (start, end) in stretches(legs) {
            let time = time.get(start..end).unwrap_or_default();
            let position = history.position.get(start..end).unwrap_or_default();
            history.velocity.extend(velocities(time, position));
            history.acceleration.extend(accelerations(time, position));
            let told = commands.get(start..end).unwrap_or_default().iter().copied();
            let known: Vec<f64> = told.filter(|command| command.is_finite()).collect();
            let way = known.first().zip(last).map_or(0.0, |(first, last): (&f64, f64)| first - last);
            let displaced = way.abs() > near;
            if displaced {
                tracker = Tracker::displaced(&known, way, deadband);
            }
            last = known.last().copied().or(last);
            for (&time, &position) in time.iter().zip(position) {
                tracker.take(time, position, deadband);
                history.direction.push(tracker.direction);
                history.reversal.push(tracker.reversal);
            }
            history.displaced.resize(history.direction.len(), false);
            if let Some(first) = history.displaced.get_mut(start) {
                *first = displaced;
            }
        }
        history
    }
}

fn slope(time: &[f64], position: &[f64], from: usize, to: usize) -> f64 {
    let at = |column: &[f64], row: usize| column.get(row).copied().unwrap_or(f64::NAN);
    let step = at(time, to) - at(time, from);
    if step > 0.0 { (at(position, to) - at(position, from)) / step } else { 0.0 }
}

fn velocities(time: &[f64], position: &[f64]) -> Vec<f64> {
    let last = position.len().saturating_sub(1);
    (0..position.len()).map(|row| slope(time, position, row.saturating_sub(1), (row + 1).min(last))).collect()
}

fn accelerations(time: &[f64], position: &[f64]) -> Vec<f64> {
    let rows = position.len();
    if rows < 3 {
        return vec![0.0; rows];
    }
    let at = |row: usize| {
        let row = row.clamp(1, rows - 2);
        let (before, after) = (slope(time, position, row - 1, row), slope(time, position, row, row + 1));
        let span = time.get(row + 1).zip(time.get(row - 1)).map_or(0.0, |(end, start)| end - start);
        if span > 0.0 { 2.0 * (after - before) / span } else { 0.0 }
    };
    (0..rows).map(at).collect()
}

/// Where an axis came from and which way it goes.
#[derive(Debug)]
struct Tracker {
    /// The furthest position in the present direction.
    furthest: Option<f64>,
    moved: bool,
    direction: f64,
    reversal: f64,
}

impl Default for Tracker {
    fn default() -> Self {
        Self { furthest: None, moved: false, direction: 1.0, reversal: f64::NAN }
    }
}

impl Tracker {
    /// At the beginning of a leg with these commands, the first of which is so far from where the last leg ended. An axis that
    /// does not move any more is likeliest to stand as it came.
    fn displaced(known: &[f64], way: f64, deadband: f64) -> Self {
        let first = known.first().copied().unwrap_or_default();
        let motion = known.iter().map(|position| position - first).find(|gone| gone.abs() > deadband);
        Self { direction: motion.unwrap_or(way).signum(), ..Self::default() }
    }

    fn take(&mut self, time: f64, position: f64, deadband: f64) {
        if !position.is_finite() {
            return;
        }
        let Some(furthest) = self.furthest else {
            self.furthest = Some(position);
            return;
        };
        let gone = position - furthest;
        if !self.moved {
            if gone.abs() > deadband {
                self.moved = true;
                self.direction = gone.signum();
                self.furthest = Some(position);
            }
        } else if gone * self.direction >= 0.0 {
            self.furthest = Some(position);
        } else if gone.abs() > deadband {
            self.direction = -self.direction;
            self.reversal = time;
            self.furthest = Some(position);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_turn_at_real_motions_only() {
        let time = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let positions = vec![5.0, 5.0, 4.0, 4.0 + 1e-7, 3.0, 3.5, 3.5];
        let history = History::of(&time, &[1; 7], &positions.clone(), positions, 1e-6);
        assert_eq!(history.direction, [1.0, 1.0, -1.0, -1.0, -1.0, 1.0, 1.0]);
        assert!(history.reversal[4].is_nan(), "the first motion is no reversal");
        assert_eq!(history.reversal[5..], [5.0, 5.0]);
    }

    #[test]
    fn differences_stay_within_a_run() {
        let time = [0.0, 1.0, 3.0, 10.0, 11.0, 12.0];
        let parabola = |t: f64| 2.0 * t * t;
        let positions: Vec<f64> = time.iter().map(|t| parabola(*t)).collect();
        let history = History::of(&time, &[1, 1, 1, 2, 2, 2], &positions.clone(), positions, 0.0);
        assert_eq!(history.acceleration, [4.0; 6]);
        assert_eq!(history.velocity[0], 2.0);
        assert_eq!(history.velocity[4], 44.0);
    }

    #[test]
    fn short_and_empty_runs_have_no_acceleration() {
        assert_eq!(History::of(&[], &[], &[], Vec::new(), 0.0), History::default());
        let history = History::of(&[0.0, 1.0, 2.0], &[1, 2, 2], &[0.0, 1.0, 3.0], vec![0.0, 1.0, 3.0], 0.0);
        assert_eq!(history.acceleration, [0.0; 3]);
        assert_eq!(history.velocity, [0.0, 2.0, 2.0]);
    }
}
