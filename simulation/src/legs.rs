//! Legs: stretches of samples through which the axes are driven without a break.
//!
//! In: times, runs and positions. Out: for each sample the number of its leg. Nothing is driven over a gap or from one run to the
//! next: a leg begins at rest where its first sample stands. A run is no leg of its own where the axes plainly went on.

/// A step of time so many times as long as the typical one is a gap.
const GAP: f64 = 20.0;
/// From one run to the next a step so many times as long is a pause.
const PAUSE: f64 = 1.5;
/// The last sample of a run may be one step from its very end, and the first of the next one from its beginning.
const REACH: f64 = 2.0;
/// How far an axis may be off what its speeds before and behind a gap allow, as a share of the way at its speed.
const SLACK: f64 = 0.3;
/// The rounding of a position, as a share of it.
const ROUNDING: f64 = 1e-9;

/// The two samples on the sides of a step that may be a break.
struct Step<'s> {
    time: &'s [f64],
    run: &'s [i64],
    /// The sample behind it.
    row: usize,
    typical: f64,
}

/// The number of the leg of each sample, from 0.
pub(crate) fn legs(time: &[f64], run: &[i64], positions: &[Vec<f64>]) -> Vec<i64> {
    let typical = typical_step(time);
    let mut leg = 0;
    let number = |row: usize| {
        let step = Step { time, run, row, typical };
        leg += i64::from(row > 0 && !step.goes_on(positions));
        leg
    };
    (0..time.len()).map(number).collect()
}

/// How far from the end of a leg the next one may begin as if it went on: [`REACH`] times as far as an axis comes from sample to
/// sample within legs. Among points that are read at rest a new run is a new number.
pub(crate) fn reach(legs: &[i64], position: &[f64]) -> f64 {
    let step = |(first, end): (usize, usize)| {
        let leg = position.get(first..end).unwrap_or_default();
        leg.iter().zip(leg.iter().skip(1)).map(|(before, behind)| (behind - before).abs()).fold(0.0, f64::max)
    };
    REACH * stretches(legs).into_iter().map(step).fold(0.0, f64::max)
}

/// The samples of each leg, as ranges: first and end.
pub(crate) fn stretches(legs: &[i64]) -> Vec<(usize, usize)> {
    let mut start = 0;
    let stretch = |leg: &[i64]| {
        let from = start;
        start += leg.len();
        (from, start)
    };
    legs.chunk_by(|before, after| before == after).map(stretch).collect()
}

fn typical_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> =
        time.iter().zip(time.iter().skip(1)).map(|(before, after)| after - before).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE)
}

impl Step<'_> {
    fn goes_on(&self, positions: &[Vec<f64>]) -> bool {
        let same = self.run.get(self.row) == self.run.get(self.row - 1);
        let pause = self.duration(self.row) / self.typical;
        same && pause <= GAP
            || (same || pause <= PAUSE) && positions.iter().all(|position| self.is_driven(position, !same))
    }

    /// The time from the sample before to a sample.
    fn duration(&self, row: usize) -> f64 {
        let at = |row: usize| self.time.get(row).copied().unwrap_or(f64::NAN);
        at(row) - at(row - 1)
    }

    /// The speed on the way to a sample; 0 where there is none, or none that counts.
    fn speed(&self, position: &[f64], row: usize) -> f64 {
        let near =
            row > 0 && self.run.get(row) == self.run.get(row - 1) && self.duration(row) <= GAP * self.typical;
        let speed = if near { way(position, row) / self.duration(row) } else { 0.0 };
        if speed.is_finite() { speed } else { 0.0 }
    }

    /// Whether an axis may have been driven on: as far as its speeds before and behind allow. From one run to the next it must
    /// have moved on both sides or on none.
    fn is_driven(&self, position: &[f64], runs: bool) -> bool {
        let (before, behind) = (self.speed(position, self.row - 1), self.speed(position, self.row + 1));
        let (way, time) = (way(position, self.row), self.duration(self.row));
        let place = position.get(self.row).copied().unwrap_or_default();
        let slack = SLACK * before.abs().max(behind.abs()) * time + ROUNDING * place.abs();
        let within = way >= before.min(behind) * time - slack && way <= before.max(behind) * time + slack;
        way.is_nan() || within && !(runs && (before == 0.0) != (behind == 0.0))
    }
}

/// The way of an axis to a sample from the one before; NaN where it is not known.
fn way(position: &[f64], row: usize) -> f64 {
    let at = |row: usize| position.get(row).copied().unwrap_or(f64::NAN);
    at(row) - at(row - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sweep from 0 in steps of 1 ms with this speed, mm/s, begun and ended by 3 samples at rest.
    fn sweep(from: f64, speed: f64) -> Vec<f64> {
        (0..40).map(|row: i32| from + 1e-3 * speed * f64::from((row - 3).clamp(0, 33))).collect()
    }

    fn clock(rows: usize) -> Vec<f64> {
        (0..rows).map(|row| 1e-3 * row as f64).collect()
    }

    #[test]
    fn a_run_that_begins_elsewhere_is_a_leg_of_its_own() {
        let positions = [sweep(0.0, 40.0), sweep(0.0, 40.0)].concat();
        let run = [vec![1; 40], vec![2; 40]].concat();
        let found = legs(&clock(80), &run, &[positions]);
        assert_eq!(stretches(&found), [(0, 40), (40, 80)]);
    }

    #[test]
    fn a_number_that_changes_in_motion_stops_no_machine() {
        let positions: Vec<f64> = (0..80).map(f64::from).collect();
        let run = [vec![1; 40], vec![2; 40]].concat();
        assert_eq!(stretches(&legs(&clock(80), &run, &[positions])), [(0, 80)]);
    }

    #[test]
    fn over_a_gap_an_axis_goes_on_as_fast_as_it_was() {
        let mut time = clock(80);
        time.iter_mut().skip(40).for_each(|time| *time += 1.0);
        let ramp: Vec<f64> = time.iter().map(|time| 7.0 * time).collect();
        assert_eq!(stretches(&legs(&time, &[1; 80], &[ramp])), [(0, 80)]);
        let jump = [vec![0.0; 40], vec![300.0; 40]].concat();
        assert_eq!(stretches(&legs(&time, &[1; 80], &[jump])), [(0, 40), (40, 80)]);
        assert_eq!(stretches(&legs(&time, &[1; 80], &[vec![5.0; 80]])), [(0, 80)]);
    }
}
