//! Position loops: from the commanded position to the one that the axis has.
//!
//! In: a command that is linear between samples. Out: the position at each sample, by the exact solution of the loop's
//! equation, so that neither the sample rate nor the gain has to be small. The loop starts at rest on its first command.

/// The position loop of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Servo {
    /// `q' = K (q_cmd - q)`.
    First {
        /// K, 1/s, greater than zero.
        gain: f64,
    },
    /// `q'' = w^2 (q_cmd - q) - 2 D w q'`: lags by `2 D / w` times the velocity in steady state, and may overshoot.
    Second {
        /// The natural frequency w, rad/s, greater than zero.
        frequency: f64,
        /// The damping D, greater than zero.
        damping: f64,
    },
    /// `q = q_cmd + T v`: the drive leads, because its feed-forward is too large. The loop with a time constant below zero has no
    /// stable solution; this is its steady state, with v the slope of the parabola through a sample and its neighbours.
    Lead {
        /// T, s, greater than zero.
        time: f64,
    },
}

/// Where a loop stands.
#[derive(Clone, Copy, Debug, Default)]
struct Stand {
    position: f64,
    velocity: f64,
}

/// What a loop remembers from sample to sample: time and command of the sample before, and where it stood.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Before(Option<(f64, f64, Stand)>);

impl Servo {
    /// The loop with a steady lag of `slowness` times the velocity, s, and the squared reciprocal `inertia` of its natural
    /// frequency, s^2; of first order where that is 0. With a lag below zero the drive leads.
    pub(super) fn of(slowness: f64, inertia: f64) -> Self {
        if slowness < 0.0 {
            Self::Lead { time: -slowness }
        } else if inertia > 0.0 {
            let frequency = 1.0 / inertia.sqrt();
            Self::Second { frequency, damping: 0.5 * slowness * frequency }
        } else {
            Self::First { gain: 1.0 / slowness }
        }
    }

    /// The steady lag over the velocity, s, and the squared reciprocal of the natural frequency, s^2.
    pub(super) fn slowness_and_inertia(self) -> (f64, f64) {
        match self {
            Self::First { gain } => (1.0 / gain, 0.0),
            Self::Second { frequency, damping } => (2.0 * damping / frequency, 1.0 / (frequency * frequency)),
            Self::Lead { time } => (-time, 0.0),
        }
    }

    /// The positions that answer the commands, in the unit of the commands.
    ///
    /// Where a command or a time is missing (NaN) the position is missing too, and the loop goes on from the last command.
    pub fn follow(self, time: &[f64], commands: &[f64]) -> Vec<f64> {
        if let Self::Lead { time: ahead } = self {
            let rows = commands.iter().zip(slopes(time, commands));
            return rows.map(|(command, velocity)| command + ahead * velocity).collect();
        }
        let mut before = Before::default();
        let samples = time.iter().zip(commands);
        samples.map(|(&time, &command)| self.answer(&mut before, time, command)).collect()
    }

    /// What the loop makes of the next sample of its command; one that leads lets it pass, as it knows of no next one.
    pub(super) fn answer(self, before: &mut Before, time: f64, command: f64) -> f64 {
        if !command.is_finite() || !time.is_finite() {
            return f64::NAN;
        }
        let stand = match before.0 {
            None => Stand { position: command, velocity: 0.0 },
            Some((start, from, stand)) => self.step(stand, from, command, time - start),
        };
        before.0 = Some((time, command, stand));
        stand.position
    }

    fn step(self, stand: Stand, from: f64, to: f64, step: f64) -> Stand {
        match self {
            Self::First { gain } => {
                Stand { position: first_order(stand.position, from, to, gain * step), velocity: 0.0 }
            }
            Self::Second { frequency, damping } => second_order(stand, from, to, step, frequency, damping),
            Self::Lead { .. } => Stand { position: to, velocity: 0.0 },
        }
    }
}

/// The slopes of the parabolas through each known value and its neighbours, one-sided at the ends; 0 where there is but one.
fn slopes(time: &[f64], values: &[f64]) -> Vec<f64> {
    let mut slopes = vec![f64::NAN; values.len()];
    let samples = time.iter().zip(values).enumerate();
    let known: Vec<(usize, f64, f64)> = samples
        .filter(|(_, (_, value))| value.is_finite())
        .map(|(row, (time, value))| (row, *time, *value))
        .collect();
    let chord = |from: (usize, f64, f64), to: (usize, f64, f64)| (to.2 - from.2) / (to.1 - from.1);
    for (place, here) in known.iter().enumerate() {
        let before = place.checked_sub(1).and_then(|place| known.get(place));
        let slope = match (before, known.get(place + 1)) {
            (Some(before), Some(after)) => {
                let (come, go) = (chord(*before, *here), chord(*here, *after));
                come + (go - come) * (here.1 - before.1) / (after.1 - before.1)
            }
            (Some(before), None) => chord(*before, *here),
            (None, Some(after)) => chord(*here, *after),
            (None, None) => 0.0,
        };
        if let Some(slot) = slopes.get_mut(here.0) {
            *slot = slope;
        }
    }
    slopes
}

/// A first-order filter over one step in which its input goes linearly `from` one value `to` another.
///
/// `share` is the step divided by the time constant. Zero or less leaves the output as it is.
pub(crate) fn first_order(output: f64, from: f64, to: f64, share: f64) -> f64 {
    if share <= 0.0 {
        return output;
    }
    to + (output - from) * (-share).exp() + (to - from) * ((-share).exp_m1() / share)
}

/// The distance y from the steady state obeys `y'' + 2 D w y' + w^2 y = 0`.
fn second_order(stand: Stand, from: f64, to: f64, step: f64, frequency: f64, damping: f64) -> Stand {
    if step <= 0.0 {
        return stand;
    }
    let slope = (to - from) / step;
    let behind = 2.0 * damping / frequency * slope;
    let distance = stand.position - from + behind;
    let speed = stand.velocity - slope;
    let fade = damping * frequency;
    let (cosine, sine) = modes(step, fade, frequency * frequency * (1.0 - damping * damping));
    let left = distance * cosine + (speed + fade * distance) * sine;
    let left_speed = speed * cosine - (fade * speed + frequency * frequency * distance) * sine;
    Stand { position: to - behind + left, velocity: slope + left_speed }
}

/// `e^(-fade t) cos(w t)` and `e^(-fade t) sin(w t) / w` for a squared frequency of either sign.
fn modes(time: f64, fade: f64, squared: f64) -> (f64, f64) {
    let root = squared.abs().sqrt();
    // So near to critical damping the difference is far below rounding.
    if root * time < 1e-9 {
        let decay = (-fade * time).exp();
        return (decay, decay * time);
    }
    if squared > 0.0 {
        let decay = (-fade * time).exp();
        return (decay * (root * time).cos(), decay * (root * time).sin() / root);
    }
    let (slow, fast) = (((root - fade) * time).exp(), ((-root - fade) * time).exp());
    (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runge-Kutta of the loop's own equation, in small steps, as a second opinion.
    fn integrated(servo: Servo, time: &[f64], commands: &[f64]) -> Vec<f64> {
        let mut state = [commands[0], 0.0];
        let mut found = vec![commands[0]];
        for (times, ends) in time.windows(2).zip(commands.windows(2)) {
            let steps = 400;
            let h = (times[1] - times[0]) / f64::from(steps);
            for number in 0..steps {
                let rate = |state: [f64; 2], at: f64| {
                    let share = (f64::from(number) + at) / f64::from(steps);
                    let command = ends[0] + (ends[1] - ends[0]) * share;
                    match servo {
                        Servo::First { gain } => [gain * (command - state[0]), 0.0],
                        Servo::Lead { .. } => [f64::NAN; 2],
                        Servo::Second { frequency: w, damping: d } => {
                            [state[1], w * w * (command - state[0]) - 2.0 * d * w * state[1]]
                        }
                    }
                };
                let go = |rate: [f64; 2], by: f64| [state[0] + rate[0] * by * h, state[1] + rate[1] * by * h];
                let k1 = rate(state, 0.0);
                let k2 = rate(go(k1, 0.5), 0.5);
                let k3 = rate(go(k2, 0.5), 0.5);
                let k4 = rate(go(k3, 1.0), 1.0);
                for (value, entry) in state.iter_mut().zip(0..2) {
                    *value += h / 6.0 * (k1[entry] + 2.0 * k2[entry] + 2.0 * k3[entry] + k4[entry]);
                }
            }
            found.push(state[0]);
        }
        found
    }

    #[test]
    fn every_loop_solves_its_own_equation() {
        let time = [0.0, 0.01, 0.02, 0.05, 0.051, 0.2, 0.9];
        let commands = [3.0, 3.0, 3.4, 2.0, 2.0, 7.0, 7.0];
        let loops = [
            Servo::First { gain: 30.0 },
            Servo::Second { frequency: 60.0, damping: 0.4 },
            Servo::Second { frequency: 60.0, damping: 1.0 },
            Servo::Second { frequency: 60.0, damping: 2.5 },
        ];
        for servo in loops {
            let exact = servo.follow(&time, &commands);
            for (exact, other) in exact.iter().zip(integrated(servo, &time, &commands)) {
                assert!((exact - other).abs() < 1e-7, "{servo:?}: {exact} {other}");
            }
        }
    }

    #[test]
    fn a_steady_motion_is_followed_at_a_steady_distance() {
        let time: Vec<f64> = (0..2000).map(|row| f64::from(row) * 0.01).collect();
        let commands: Vec<f64> = time.iter().map(|time| 12.0 * time).collect();
        let behind = |servo: Servo| commands[1999] - servo.follow(&time, &commands)[1999];
        assert!((behind(Servo::First { gain: 25.0 }) - 12.0 / 25.0).abs() < 1e-9);
        let second = Servo::Second { frequency: 50.0, damping: 0.7 };
        assert!((behind(second) - 12.0 * 1.4 / 50.0).abs() < 1e-9);
    }

    #[test]
    fn a_drive_that_leads_is_ahead_by_its_velocity() {
        let time: Vec<f64> = (0..50).map(|row| 0.01 * f64::from(row * row)).collect();
        let commands: Vec<f64> = time.iter().map(|time| 3.0 - 2.0 * time + 0.7 * time * time).collect();
        let found = Servo::of(-0.02, 0.0).follow(&time, &commands);
        // Of a parabola the slope is exact, whatever the steps.
        for ((time, command), found) in time.iter().zip(&commands).zip(found).skip(1).take(48) {
            assert!((found - command - 0.02 * (1.4 * time - 2.0)).abs() < 1e-9);
        }
        assert_eq!(Servo::of(-0.02, 1e-4), Servo::Lead { time: 0.02 });
    }

    #[test]
    fn a_missing_command_leaves_a_gap_and_no_more() {
        let time = [0.0, 0.1, 0.2];
        let whole = Servo::First { gain: 5.0 }.follow(&[0.0, 0.2], &[0.0, 2.0]);
        let gap = Servo::First { gain: 5.0 }.follow(&time, &[0.0, f64::NAN, 2.0]);
        assert!(gap[1].is_nan());
        assert_eq!(gap[2], whole[1]);
    }
}
