//! Effects that are injected: what each of the terms adds to an error motion, row by row.
//!
//! In: the states of the axes and what was recorded beside them. Out: numbers in mm or rad. The formulas are those of the
//! vocabulary, from the recorded command, time, temperatures and loads alone.

use std::f64::consts::TAU;

use model_dsl::calibration::TermKind;

use crate::injection::columns::difference;
use crate::injection::kind::Kind;
use crate::injection::state::{Axis, Clock, followed, taken_up};

/// What an effect may depend on.
pub struct Path {
    /// When rows were taken.
    pub clock: Clock,
    /// The axes of the machine, in its order; nothing where it is not known where one is.
    pub axes: Vec<Option<Axis>>,
    /// Temperatures, degC.
    pub temperatures: Vec<Vec<f64>>,
    /// Loads.
    pub loads: Vec<Vec<f64>>,
}

/// One effect: mm, rad, s, degC. Axes, sensors and loads go by number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effect {
    /// The same everywhere: a squareness.
    Constant {
        /// Its size.
        value: f64,
    },
    /// A line over the axis.
    Polynomial {
        /// The axis.
        axis: usize,
        /// Its rise for each mm or rad.
        slope: f64,
    },
    /// A bump, as a table could hold it: `exp(-((q - at)/width)^2/2)`.
    Table {
        /// The axis.
        axis: usize,
        /// The place of its top.
        at: f64,
        /// Its standard deviation.
        width: f64,
        /// Its height.
        height: f64,
    },
    /// A play, which jumps at each reversal or winds up over some way.
    Backlash {
        /// The axis.
        axis: usize,
        /// From one side to the other.
        lost_motion: f64,
        /// The way from side to side; 0 jumps.
        wind_up: f64,
    },
    /// A spike after each reversal, which decays.
    ReversalSpike {
        /// The axis.
        axis: usize,
        /// Its height.
        height: f64,
        /// Its time constant, s.
        decay: f64,
    },
    /// A wave along the axis.
    Cyclic {
        /// The axis.
        axis: usize,
        /// The way of one wave.
        period: f64,
        /// Its amplitude.
        amplitude: f64,
        /// Its phase where the axis is at zero, rad.
        phase: f64,
    },
    /// What a position loop stays behind.
    Lag {
        /// The axis.
        axis: usize,
        /// Its velocity gain, 1/s.
        gain: f64,
    },
    /// Minus the acceleration over a gain.
    Acceleration {
        /// The axis.
        axis: usize,
        /// The gain, 1/s^2 for a motion in mm.
        gain: f64,
    },
    /// A scale or a screw that is warm.
    Expansion {
        /// The axis.
        axis: usize,
        /// The sensor.
        sensor: usize,
        /// 1/K.
        coefficient: f64,
        /// The temperature at which it adds nothing, degC.
        reference: f64,
    },
    /// A structure that grows behind a temperature.
    Growth {
        /// The sensor.
        sensor: usize,
        /// mm/K or rad/K.
        coefficient: f64,
        /// The temperature at which it adds nothing, degC.
        reference: f64,
        /// s.
        time_constant: f64,
    },
    /// A fading drift in time.
    Drift {
        /// Where it comes to.
        amplitude: f64,
        /// s.
        time_constant: f64,
    },
    /// A wave in time.
    Vibration {
        /// Hz.
        frequency: f64,
        /// Its amplitude.
        amplitude: f64,
        /// Its phase at the first row, rad.
        phase: f64,
    },
    /// Of another axis: c_1 q + c_2 q^2.
    Coupling {
        /// The other axis.
        axis: usize,
        /// c_1 and c_2.
        coefficients: [f64; 2],
    },
    /// What gives way under a load.
    Compliance {
        /// The load.
        load: usize,
        /// mm or rad for each unit of the load.
        coefficient: f64,
    },
}

impl Effect {
    /// Its term.
    pub fn term(&self) -> TermKind {
        match self {
            Self::Constant { .. } => TermKind::Constant,
            Self::Polynomial { .. } => TermKind::Polynomial,
            Self::Table { .. } => TermKind::Table,
            Self::Backlash { .. } => TermKind::Backlash,
            Self::ReversalSpike { .. } => TermKind::ReversalSpike,
            Self::Cyclic { .. } => TermKind::Cyclic,
            Self::Lag { .. } => TermKind::Lag,
            Self::Acceleration { .. } => TermKind::Acceleration,
            Self::Expansion { .. } => TermKind::Expansion,
            Self::Growth { .. } => TermKind::Growth,
            Self::Drift { .. } => TermKind::Drift,
            Self::Vibration { .. } => TermKind::Vibration,
            Self::Coupling { .. } => TermKind::Coupling,
            Self::Compliance { .. } => TermKind::Compliance,
        }
    }

    /// What kind of case it makes.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Backlash { wind_up, .. } if *wind_up > 0.0 => Kind::WindUp,
            _ => Kind::Term(self.term()),
        }
    }

    /// The same, this many times as large.
    pub fn scaled(mut self, by: f64) -> Self {
        match &mut self {
            Self::Constant { value: size }
            | Self::Polynomial { slope: size, .. }
            | Self::Table { height: size, .. }
            | Self::Backlash { lost_motion: size, .. }
            | Self::ReversalSpike { height: size, .. }
            | Self::Cyclic { amplitude: size, .. }
            | Self::Expansion { coefficient: size, .. }
            | Self::Growth { coefficient: size, .. }
            | Self::Drift { amplitude: size, .. }
            | Self::Vibration { amplitude: size, .. }
            | Self::Compliance { coefficient: size, .. } => *size *= by,
            Self::Coupling { coefficients, .. } => coefficients.iter_mut().for_each(|size| *size *= by),
            // What stays behind is one over the gain.
            Self::Lag { gain, .. } | Self::Acceleration { gain, .. } => *gain /= by,
        }
        self
    }

    /// Its size as one number above zero to which all that it adds is proportional: what stays behind goes as one over a gain.
    pub fn strength(&self) -> f64 {
        match (self, self.size()) {
            (Self::Table { height, .. }, _) => height.abs(),
            (Self::Lag { .. } | Self::Acceleration { .. }, Some((_, _, gain))) => 1.0 / gain.abs(),
            (_, size) => size.map_or(0.0, |(_, _, size)| size.abs()),
        }
    }

    /// The same at this strength.
    pub fn at_strength(self, strength: f64) -> Self {
        self.scaled(strength / self.strength())
    }

    /// Its size as a calibration has it: the parameter, its place among several, its value. A bump has none.
    pub fn size(&self) -> Option<(&'static str, usize, f64)> {
        Some(match *self {
            Self::Constant { value } => ("value", 0, value),
            Self::Polynomial { slope, .. } => ("coefficients", 1, slope),
            Self::Table { .. } => return None,
            Self::Backlash { lost_motion, .. } => ("lost_motion", 0, lost_motion),
            Self::ReversalSpike { height, .. } => ("height", 0, height),
            Self::Cyclic { amplitude, .. }
            | Self::Drift { amplitude, .. }
            | Self::Vibration { amplitude, .. } => ("amplitude", 0, amplitude),
            Self::Lag { gain, .. } | Self::Acceleration { gain, .. } => ("gain", 0, gain),
            Self::Expansion { coefficient, .. }
            | Self::Growth { coefficient, .. }
            | Self::Compliance { coefficient, .. } => ("coefficient", 0, coefficient),
            // From power 1 on; the second power does not change with the origin.
            Self::Coupling { coefficients, .. } => ("coefficients", 1, coefficients[1]),
        })
    }

    /// Whether the drive's own feedback sees it: what the position loop does is done before the screw.
    pub fn at_the_drive(&self) -> bool {
        matches!(self, Self::Lag { .. } | Self::Acceleration { .. })
    }

    /// What it adds to its error motion in each row; nothing where the path does not know what it depends on.
    pub fn values(&self, path: &Path) -> Option<Vec<f64>> {
        let axis = |number: usize| path.axes.get(number)?.as_ref();
        let over = |number: usize, of: &dyn Fn(f64) -> f64| -> Option<Vec<f64>> {
            Some(axis(number)?.position.iter().map(|q| of(*q)).collect())
        };
        let times = |of: &dyn Fn(f64) -> f64| path.clock.time.iter().map(|t| of(*t)).collect();
        Some(match *self {
            Self::Constant { value } => times(&|_| value),
            Self::Polynomial { axis, slope } => over(axis, &|q| slope * q)?,
            Self::Table { axis, at, width, height } => {
                over(axis, &|q| height * (-0.5 * ((q - at) / width).powi(2)).exp())?
            }
            Self::Backlash { axis: number, lost_motion, wind_up } => {
                let axis = axis(number)?;
                let side = if wind_up > 0.0 { taken_up(axis, wind_up) } else { axis.direction.clone() };
                side.iter().map(|side| -0.5 * lost_motion * side).collect()
            }
            Self::ReversalSpike { axis: number, height, decay } => {
                let axis = axis(number)?;
                let rows = axis.direction.iter().zip(&axis.since);
                rows.map(|(direction, since)| -height * direction * (-since / decay).exp()).collect()
            }
            Self::Cyclic { axis, period, amplitude, phase } => {
                over(axis, &|q| amplitude * (TAU * q / period + phase).sin())?
            }
            Self::Lag { axis: number, gain } => {
                let position = &axis(number)?.position;
                difference(&followed(&path.clock, position, gain), position)
            }
            Self::Acceleration { axis: number, gain } => {
                axis(number)?.acceleration.iter().map(|a| -a / gain).collect()
            }
            Self::Expansion { axis: number, sensor, coefficient, reference } => {
                let rows = path.temperatures.get(sensor)?.iter().zip(&axis(number)?.position);
                rows.map(|(temperature, q)| coefficient * (temperature - reference) * q).collect()
            }
            Self::Growth { sensor, coefficient, reference, time_constant } => {
                let temperature = path.temperatures.get(sensor)?;
                let filtered = match time_constant > 0.0 {
                    true => warmed(&path.clock.time, temperature, time_constant),
                    false => temperature.clone(),
                };
                filtered.iter().map(|warm| coefficient * (warm - reference)).collect()
            }
            Self::Drift { amplitude, time_constant } => {
                times(&|t| amplitude * (1.0 - (-t / time_constant).exp()))
            }
            Self::Vibration { frequency, amplitude, phase } => {
                times(&|t| amplitude * (TAU * frequency * t + phase).sin())
            }
            Self::Coupling { axis, coefficients: [first, second] } => {
                over(axis, &|q| (first + second * q) * q)?
            }
            Self::Compliance { load, coefficient } => {
                path.loads.get(load)?.iter().map(|force| coefficient * force).collect()
            }
        })
    }
}

/// A temperature behind a first-order filter, which begins warm and runs on through pauses and from run to run.
fn warmed(time: &[f64], temperature: &[f64], time_constant: f64) -> Vec<f64> {
    let whole = Clock { time: time.to_vec(), stretches: vec![(0, time.len())], step: 0.0 };
    followed(&whole, temperature, 1.0 / time_constant)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One axis from 0 to 20 mm and back within 40 s, another at its square, a temperature that rises by 0.1 K/s, a load.
    fn path() -> Path {
        let time: Vec<f64> = (0..41).map(f64::from).collect();
        let clock = Clock::new(time.clone(), &[1; 41]);
        let there: Vec<f64> = time.iter().map(|t| 20.0 - (t - 20.0).abs()).collect();
        let other = there.iter().map(|q| q * q).collect();
        let axes = vec![Some(Axis::new(&clock, there, 1e-9)), Some(Axis::new(&clock, other, 1e-9)), None];
        let temperatures = vec![time.iter().map(|t| 20.0 + 0.1 * t).collect()];
        let loads = vec![time.iter().map(|t| if *t < 10.0 { 0.0 } else { 50.0 }).collect()];
        Path { clock, axes, temperatures, loads }
    }

    fn at(effect: Effect, row: usize) -> f64 {
        effect.values(&path()).unwrap()[row]
    }

    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    }

    #[test]
    fn each_is_its_formula() {
        // Row 5: q = 5, forwards; row 25: q = 15, backwards, 4 s behind the first row that goes back.
        near(at(Effect::Constant { value: 3e-5 }, 5), 3e-5);
        near(at(Effect::Polynomial { axis: 0, slope: 1e-4 }, 25), 15e-4);
        near(at(Effect::Table { axis: 0, at: 3.0, width: 2.0, height: 0.01 }, 5), 0.01 * (-0.5_f64).exp());
        near(at(Effect::Backlash { axis: 0, lost_motion: 0.01, wind_up: 0.0 }, 5), -0.005);
        near(at(Effect::Backlash { axis: 0, lost_motion: 0.01, wind_up: 0.0 }, 25), 0.005);
        near(at(Effect::ReversalSpike { axis: 0, height: 0.01, decay: 2.0 }, 5), 0.0);
        near(at(Effect::ReversalSpike { axis: 0, height: 0.01, decay: 2.0 }, 25), 0.01 * (-2.0_f64).exp());
        near(at(Effect::Cyclic { axis: 0, period: 20.0, amplitude: 0.01, phase: 0.0 }, 5), 0.01);
        near(
            at(Effect::Expansion { axis: 0, sensor: 0, coefficient: 1e-5, reference: 20.0 }, 25),
            2.5e-5 * 15.0,
        );
        near(at(Effect::Drift { amplitude: 0.01, time_constant: 5.0 }, 5), 0.01 * (1.0 - (-1.0_f64).exp()));
        near(at(Effect::Vibration { frequency: 0.05, amplitude: 0.01, phase: 0.0 }, 5), 0.01);
        near(at(Effect::Coupling { axis: 1, coefficients: [1e-4, 1e-6] }, 5), 25e-4 + 625e-6);
        near(at(Effect::Compliance { load: 0, coefficient: 1e-4 }, 25), 5e-3);
        // The second axis goes as t^2: 2 mm/s^2.
        near(at(Effect::Acceleration { axis: 1, gain: 400.0 }, 5), -2.0 / 400.0);
    }

    #[test]
    fn a_loop_and_a_body_stay_behind_a_ramp_from_rest() {
        let behind = |rate: f64, slope: f64, t: f64| slope / rate * (1.0 - (-rate * t).exp());
        near(at(Effect::Lag { axis: 0, gain: 0.5 }, 5), -behind(0.5, 1.0, 5.0));
        let growth = Effect::Growth { sensor: 0, coefficient: 1e-3, reference: 20.0, time_constant: 4.0 };
        near(at(growth, 30), 1e-3 * (3.0 - behind(0.25, 0.1, 30.0)));
        let at_once = Effect::Growth { sensor: 0, coefficient: 1e-3, reference: 20.0, time_constant: 0.0 };
        near(at(at_once, 30), 3e-3);
    }

    #[test]
    fn twice_the_size_is_twice_the_effect() {
        let effects = [
            Effect::Backlash { axis: 0, lost_motion: 0.01, wind_up: 3.0 },
            Effect::Acceleration { axis: 1, gain: 400.0 },
            Effect::Coupling { axis: 1, coefficients: [1e-4, 1e-6] },
            Effect::Growth { sensor: 0, coefficient: 1e-3, reference: 20.0, time_constant: 4.0 },
        ];
        for effect in effects {
            let (once, twice) =
                (effect.values(&path()).unwrap(), effect.scaled(2.0).values(&path()).unwrap());
            once.iter().zip(&twice).for_each(|(once, twice)| near(2.0 * once, *twice));
        }
    }

    #[test]
    fn what_is_not_known_gives_nothing() {
        assert_eq!(Effect::Polynomial { axis: 2, slope: 1.0 }.values(&path()), None);
        assert_eq!(Effect::Compliance { load: 1, coefficient: 1.0 }.values(&path()), None);
    }
}
