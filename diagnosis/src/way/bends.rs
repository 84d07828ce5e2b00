//! Bends: how a command goes between rows where a controller has more cycles than a recording has rows.
//!
//! In: times and programmed positions of the rows, and their legs. Out: for each step the acceleration of the parabola that the command
//! follows there. It is that between the velocities at both ends, each taken where the path is smooth: a planner changes its acceleration
//! from one value to another, and rows on the other side of such a change say nothing of the velocity.

/// How many rows give the velocity at one of them: the fewest whose differences show that the acceleration changes among them.
const ROWS: usize = 4;

/// The acceleration in the step that begins at each row; 0 where too few rows of a leg tell.
pub(super) fn accelerations(time: &[f64], command: &[f64], legs: &[usize]) -> Vec<f64> {
    let velocities: Vec<f64> = (0..time.len()).map(|row| velocity(time, command, legs, row)).collect();
    let between = |from: usize| (velocities[from + 1] - velocities[from]) / (time[from + 1] - time[from]);
    let known = (1..time.len()).map(|row| if legs[row - 1] == legs[row] { between(row - 1) } else { 0.0 });
    known.map(|acceleration| if acceleration.is_finite() { acceleration } else { 0.0 }).collect()
}

/// The velocity at a row: of the cubics through rows around it, that with the least jerk. NaN where a leg has too few rows.
fn velocity(time: &[f64], command: &[f64], legs: &[usize], row: usize) -> f64 {
    let firsts = (row + 1).saturating_sub(ROWS)..=row;
    let whole = firsts.filter(|first| first + ROWS <= time.len() && legs[*first] == legs[first + ROWS - 1]);
    let cubics = whole.map(|first| {
        let rows = first..first + ROWS;
        Cubic::through(&time[rows.clone()], &command[rows])
    });
    let smooth = cubics.filter(|cubic| cubic.jerk.is_finite());
    let smoothest = smooth.min_by(|one, other| one.jerk.abs().total_cmp(&other.jerk.abs()));
    smoothest.map_or(f64::NAN, |cubic| cubic.velocity(time[row]))
}

/// Velocity and acceleration in the first of some rows by the cubic through the first of them; `None` of too few.
pub(super) fn first_motion(time: &[f64], command: &[f64]) -> Option<(f64, f64)> {
    let (time, command) = (time.get(..ROWS)?, command.get(..ROWS)?);
    let cubic = Cubic::through(time, command);
    let (velocity, acceleration) = (cubic.velocity(time[0]), cubic.acceleration(time[0]));
    (velocity.is_finite() && acceleration.is_finite()).then_some((velocity, acceleration))
}

/// A cubic by Newton's divided differences.
struct Cubic {
    times: [f64; ROWS - 1],
    speed: f64,
    bend: f64,
    /// A sixth of its third derivative.
    jerk: f64,
}

impl Cubic {
    fn through(time: &[f64], command: &[f64]) -> Self {
        let divided = |differences: &[f64], order: usize| -> Vec<f64> {
            let number =
                |row: usize| (differences[row + 1] - differences[row]) / (time[row + order] - time[row]);
            (0..differences.len() - 1).map(number).collect()
        };
        let speeds = divided(command, 1);
        let bends = divided(&speeds, 2);
        let jerks = divided(&bends, 3);
        Self { times: [time[0], time[1], time[2]], speed: speeds[0], bend: bends[0], jerk: jerks[0] }
    }

    fn velocity(&self, at: f64) -> f64 {
        let [a, b, c] = self.times.map(|time| at - time);
        self.speed + self.bend * (a + b) + self.jerk * (a * b + a * c + b * c)
    }

    fn acceleration(&self, at: f64) -> f64 {
        2.0 * self.bend + 2.0 * self.jerk * self.times.map(|time| at - time).iter().sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From rest with 8 mm/s^2 until 2.25 s, then steadily, in rows of half a second: the planner changes its acceleration within the fifth
    /// step, whose mean acceleration is half of it.
    #[test]
    fn a_planner_may_change_its_acceleration_between_rows() {
        let until = 2.25;
        let command =
            |t: f64| if t < until { 4.0 * t * t } else { 4.0 * until * until + 8.0 * until * (t - until) };
        let time: Vec<f64> = (-4..11).map(|row| 0.5 * f64::from(row)).collect();
        let way: Vec<f64> = time.iter().map(|t| if *t < 0.0 { 0.0 } else { command(*t) }).collect();
        let found = accelerations(&time, &way, &[1; 15]);
        let expected = [0.0, 0.0, 0.0, 0.0, 8.0, 8.0, 8.0, 8.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
        }
    }

    /// Within a leg of three rows no cubic tells, and from leg to leg nothing is driven.
    #[test]
    fn what_too_few_rows_tell_is_straight() {
        let time: Vec<f64> = (0..8).map(f64::from).collect();
        let way: Vec<f64> = time.iter().map(|t| t * t).collect();
        assert_eq!(
            accelerations(&time, &way, &[1, 1, 1, 2, 2, 2, 2, 2]),
            [0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0]
        );
    }
}
