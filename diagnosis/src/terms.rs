//! Terms as regressors: one piece of physics each, as columns over the rows of a recording.
//!
//! In: the states of the machine in a stretch of rows. Out: for each term its columns, one for each linear coefficient;
//! what is not linear (a period, a time constant, a wind-up) is the shape's own and is searched for. The meaning of each
//! term, its plausible range and the words that explain it stand in a file of its own.

mod acceleration;
mod backlash;
mod coupling;
mod cyclic;
mod delay;
mod drift;
mod expansion;
mod factor;
mod growth;
mod instrument;
mod known;
mod lag;
mod load;
mod look;
mod meaning;
mod plausible;
mod polynomial;
mod reversal_spike;
mod step;
mod table;
mod vibration;

pub(crate) use instrument::{Setting, SettingKind};
pub(crate) use known::known;
pub use look::look_at;
pub use meaning::meaning;
pub(crate) use plausible::{Range, oddity, plausible};
pub(crate) use polynomial::{fill as polynomial_powers, in_position as polynomial_in_position};

use std::f64::consts::TAU;

use model_dsl::calibration::{Factor, TermKind};
use wide::f64x4;

use self::factor::FactorMemory;
use crate::position_loop::Follower;
use crate::side::Side;
use crate::states::{Play, Rows};

/// The temperature at which scales are true where nothing else is said: ISO 1, degC.
pub(crate) const REFERENCE_TEMPERATURE: f64 = 20.0;

/// What a term is, apart from its linear coefficients. Positions are in mm or rad, times in s.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Shape {
    /// 1.
    Constant,
    /// Powers 0 to `degree` of x = (q - center) / scale.
    Polynomial { axis: usize, degree: usize, center: f64, scale: f64 },
    /// Powers 0 to `degree` of x = (T - center) / scale of a sensor.
    SensorPolynomial { sensor: usize, degree: usize, center: f64, scale: f64 },
    /// A hat function for each node; for each direction of motion where it is directed.
    Table { axis: usize, nodes: Vec<f64>, directed: bool, repeats: bool },
    /// -d/2, or the play operator -u/2.
    Backlash { axis: usize, wind_up: f64 },
    /// -d exp(-(t - t_reversal) / decay).
    ReversalSpike { axis: usize, decay: f64 },
    /// Sine and cosine of 2 pi order (q - center) / period: far from the travel a little of the period is much of the phase. Of a
    /// harmonic, `period` is that of its fundamental, which all harmonics of one wave share; a wave by itself has the order 1.
    Cyclic { axis: usize, period: f64, order: u32, center: f64 },
    /// The change of the position behind the position loop with its time constant 1/K, which is the coefficient; of second
    /// order where it has an inertia 1/w^2, s^2.
    Lag { axis: usize, inertia: f64 },
    /// -a.
    Acceleration { axis: usize },
    /// (T - reference) q.
    Expansion { axis: usize, sensor: usize, reference: f64 },
    /// T* - reference, T* behind a first-order filter.
    Growth { sensor: usize, reference: f64, time_constant: f64 },
    /// 1 - exp(-t / time_constant).
    Drift { time_constant: f64 },
    /// sin(2 pi f t) and cos(2 pi f t).
    Vibration { frequency: f64 },
    /// Powers 1 to `degree` of q_other / scale.
    Coupling { axis: usize, degree: usize, scale: f64 },
    /// The load.
    Compliance { load: usize },
    /// q(t - time) - q(t).
    Delay { axis: usize, time: f64 },
    /// 0 before a time, 1 from it on.
    Step { time: f64 },
    /// Each column of another shape times factors.
    Times { core: Box<Shape>, factors: Vec<Factor<usize>> },
    /// A setting of the instrument.
    Instrument(Setting),
}

/// What a shape remembers from one stretch of rows to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Memory {
    value: Option<f64>,
    last: f64,
    last_input: f64,
    play: Play,
    /// The position loop that answers the shape.
    follower: Follower,
    /// What its factors remember.
    factors: Vec<FactorMemory>,
}

/// The one parameter of a shape that is not linear.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Nonlinear {
    /// Its name in calibration files; that of a lag is its inertia, of which they have the frequency.
    pub(crate) name: &'static str,
    /// Its value.
    pub(crate) value: f64,
}

impl Shape {
    /// The term's name in calibration files, or the setting's in reports.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Instrument(setting) => setting.name(),
            Self::Constant => TermKind::Constant.name(),
            Self::Polynomial { .. } | Self::SensorPolynomial { .. } => TermKind::Polynomial.name(),
            Self::Table { .. } => TermKind::Table.name(),
            Self::Backlash { .. } => TermKind::Backlash.name(),
            Self::ReversalSpike { .. } => TermKind::ReversalSpike.name(),
            Self::Cyclic { .. } => TermKind::Cyclic.name(),
            Self::Lag { .. } => TermKind::Lag.name(),
            Self::Acceleration { .. } => TermKind::Acceleration.name(),
            Self::Expansion { .. } => TermKind::Expansion.name(),
            Self::Growth { .. } => TermKind::Growth.name(),
            Self::Drift { .. } => TermKind::Drift.name(),
            Self::Vibration { .. } => TermKind::Vibration.name(),
            Self::Coupling { .. } => TermKind::Coupling.name(),
            Self::Compliance { .. } => TermKind::Compliance.name(),
            Self::Delay { .. } => TermKind::Delay.name(),
            Self::Step { .. } => TermKind::Step.name(),
            Self::Times { core, .. } => match **core {
                Self::Constant => TermKind::Product.name(),
                ref core => core.name(),
            },
        }
    }

    /// A wave whose frequency is `rate` for each unit of a recorded speed.
    pub(crate) fn spin(load: usize, rate: f64, phase: f64) -> Self {
        Self::Times { core: Box::new(Self::Constant), factors: vec![Factor::Spin { load, rate, phase }] }
    }

    /// Whether it is no term of the vocabulary with a name of its own: a term with factors, or an event.
    pub(crate) fn is_composed(&self) -> bool {
        matches!(self, Self::Times { .. } | Self::Step { .. })
    }

    /// The shape without its factors.
    pub(crate) fn core(&self) -> &Self {
        match self {
            Self::Times { core, .. } => core,
            plain => plain,
        }
    }

    /// How many numbers of it are fitted or searched for.
    pub(crate) fn parameters(&self) -> usize {
        self.columns() + usize::from(self.nonlinear().is_some()) + self.searched_factors()
    }

    /// How many numbers of its factors were searched for, and for an event its time.
    fn searched_factors(&self) -> usize {
        if let Self::Step { .. } = self {
            return 1;
        }
        let searched = |factor: &Factor<usize>| match factor {
            Factor::Fading { .. } | Factor::Warmth { .. } | Factor::Play { .. } | Factor::Half { .. } => 1,
            Factor::Temperature { time_constant, .. } => usize::from(*time_constant > 0.0),
            // Where it lies, and how wide it is; how fast it turns, and from where.
            Factor::Curve { .. } | Factor::Spin { .. } => 2,
            _ => 0,
        };
        self.factors().iter().map(searched).sum()
    }

    /// Its factors; none of most shapes.
    pub(crate) fn factors(&self) -> &[Factor<usize>] {
        match self {
            Self::Times { factors, .. } => factors,
            _ => &[],
        }
    }

    /// What it is, physically.
    pub(crate) fn meaning(&self) -> &'static str {
        match self {
            Self::Constant => meaning::CONSTANT,
            Self::Polynomial { .. } => polynomial::MEANING,
            Self::SensorPolynomial { .. } | Self::Growth { .. } => growth::MEANING,
            Self::Table { .. } => table::MEANING,
            Self::Backlash { .. } => backlash::MEANING,
            Self::ReversalSpike { .. } => reversal_spike::MEANING,
            Self::Cyclic { .. } => cyclic::MEANING,
            Self::Lag { .. } => lag::MEANING,
            Self::Acceleration { .. } => acceleration::MEANING,
            Self::Expansion { .. } => expansion::MEANING,
            Self::Drift { .. } => drift::MEANING,
            Self::Vibration { .. } => vibration::MEANING,
            Self::Coupling { .. } => coupling::MEANING,
            Self::Compliance { .. } => load::MEANING,
            Self::Delay { .. } => delay::MEANING,
            Self::Step { .. } => step::MEANING,
            Self::Times { core, .. } => match **core {
                Self::Constant => factor::MEANING,
                ref core => core.meaning(),
            },
            Self::Instrument(_) => "",
        }
    }

    /// How many linear coefficients it has.
    pub(crate) fn columns(&self) -> usize {
        match self {
            Self::Polynomial { degree, .. } | Self::SensorPolynomial { degree, .. } => degree + 1,
            Self::Coupling { degree, .. } => *degree,
            Self::Table { nodes, directed, .. } => nodes.len() * if *directed { 2 } else { 1 },
            Self::Cyclic { .. } | Self::Vibration { .. } => 2,
            Self::Times { core, .. } => core.columns(),
            _ => 1,
        }
    }

    /// The parameter that is not linear, where it has one.
    pub(crate) fn nonlinear(&self) -> Option<Nonlinear> {
        let (name, value) = match *self {
            Self::Backlash { wind_up, .. } if wind_up > 0.0 => ("wind_up", wind_up),
            Self::ReversalSpike { decay, .. } => ("decay", decay),
            Self::Cyclic { period, .. } => ("period", period),
            Self::Growth { time_constant, .. } if time_constant > 0.0 => ("time_constant", time_constant),
            Self::Drift { time_constant } => ("time_constant", time_constant),
            Self::Lag { inertia, .. } if inertia > 0.0 => ("frequency", inertia),
            Self::Vibration { frequency } => ("frequency", frequency),
            Self::Times { ref core, .. } => return core.nonlinear(),
            _ => return None,
        };
        Some(Nonlinear { name, value })
    }

    /// The shape with another value of its nonlinear parameter.
    pub(crate) fn with_nonlinear(&self, value: f64) -> Self {
        let mut shape = self.clone();
        match &mut shape {
            Self::Backlash { wind_up: parameter, .. }
            | Self::ReversalSpike { decay: parameter, .. }
            | Self::Cyclic { period: parameter, .. }
            | Self::Growth { time_constant: parameter, .. }
            | Self::Drift { time_constant: parameter }
            | Self::Lag { inertia: parameter, .. }
            | Self::Vibration { frequency: parameter } => *parameter = value,
            Self::Times { core, .. } => **core = core.with_nonlinear(value),
            _ => {}
        }
        shape
    }

    /// The axis that a wave runs along, and its length.
    pub(crate) fn wave_along(&self) -> Option<(usize, f64)> {
        match *self {
            Self::Cyclic { axis, period, order, .. } => Some((axis, period / f64::from(order))),
            _ => None,
        }
    }

    /// How the phase of a wave, rad, changes with its nonlinear parameter in each row of a stretch; nothing of all other shapes.
    pub(crate) fn phase_slope(&self, rows: &Rows<'_>) -> Vec<f64> {
        match *self {
            Self::Cyclic { axis, period, order, center } => {
                cyclic::phase_slope(rows, axis, period, order, center)
            }
            Self::Vibration { .. } => vibration::phase_slope(rows),
            Self::Times { ref core, .. } => core.phase_slope(rows),
            _ => Vec::new(),
        }
    }

    /// Whether it happens once, at a moment.
    pub(crate) fn is_event(&self) -> bool {
        matches!(self, Self::Step { .. })
    }

    /// Whether it is a wave along an axis or in time.
    pub(crate) fn is_wave(&self) -> bool {
        matches!(self, Self::Cyclic { .. } | Self::Vibration { .. })
    }

    /// Whether its coefficient acts on the states, so that a linear fit of it holds only nearby.
    pub(crate) fn nonlinear_in_coefficient(&self) -> bool {
        matches!(self, Self::Lag { .. } | Self::Instrument(Setting::Clock))
    }

    /// The axis whose state it reads, where there is one.
    pub(crate) fn axis(&self) -> Option<usize> {
        match *self {
            Self::Polynomial { axis, .. }
            | Self::Table { axis, .. }
            | Self::Backlash { axis, .. }
            | Self::ReversalSpike { axis, .. }
            | Self::Cyclic { axis, .. }
            | Self::Lag { axis, .. }
            | Self::Acceleration { axis }
            | Self::Expansion { axis, .. }
            | Self::Coupling { axis, .. }
            | Self::Delay { axis, .. } => Some(axis),
            Self::Times { ref core, .. } => core.axis(),
            _ => None,
        }
    }

    /// Fills one column for each linear coefficient with the rows of a stretch. Stretches come in order; `memory` is that
    /// of the stretch before, or the default at the beginning of a recording.
    pub(crate) fn fill(&self, rows: &Rows<'_>, memory: &mut Memory, out: &mut [Vec<f64>]) {
        match self {
            Self::Constant => each(out, |column| column.resize(rows.len(), 1.0)),
            Self::Polynomial { axis, degree: _, center, scale } => {
                polynomial::fill(rows.axis(*axis).position, *center, *scale, 0, out);
            }
            Self::SensorPolynomial { sensor, degree: _, center, scale } => {
                polynomial::fill(rows.temperature(*sensor), *center, *scale, 0, out);
            }
            Self::Coupling { axis, degree: _, scale } => coupling::fill(rows, *axis, *scale, out),
            Self::Table { axis, nodes, directed, repeats } => {
                table::fill(rows, *axis, table::Nodes { nodes, repeats: *repeats }, *directed, out);
            }
            Self::Backlash { axis, wind_up } => {
                one(out, |out| backlash::fill(rows, *axis, *wind_up, memory, out))
            }
            Self::ReversalSpike { axis, decay } => {
                one(out, |out| reversal_spike::fill(rows, *axis, *decay, out))
            }
            Self::Cyclic { axis, period, order, center } => {
                cyclic::fill(rows, *axis, period / f64::from(*order), *center, out);
            }
            Self::Lag { axis, .. } => one(out, |out| lag::fill(rows, *axis, out)),
            Self::Acceleration { axis } => one(out, |out| acceleration::fill(rows, *axis, out)),
            Self::Expansion { axis, sensor, reference } => {
                one(out, |out| expansion::fill(rows, *axis, *sensor, *reference, out));
            }
            Self::Growth { sensor, reference, time_constant } => {
                one(out, |out| growth::fill(rows, *sensor, *reference, *time_constant, memory, out));
            }
            Self::Drift { time_constant } => one(out, |out| drift::fill(rows, *time_constant, out)),
            Self::Vibration { frequency } => vibration::fill(rows, *frequency, out),
            Self::Compliance { load } => one(out, |out| load::fill(rows, *load, out)),
            Self::Delay { axis, time } => one(out, |out| delay::fill(rows, *axis, *time, out)),
            Self::Step { time } => one(out, |out| step::fill(rows, *time, out)),
            Self::Times { core, factors } => {
                core.fill(rows, memory, out);
                factor::multiply(factors, rows, &mut memory.factors, out);
            }
            // What the instrument's settings do depends on the instrument and is filled where it is known.
            Self::Instrument(_) => each(out, |column| column.resize(rows.len(), 0.0)),
        }
    }

    /// Fills its columns as they come in on a side: behind the position loop that answers them, where one does; a play as far as it is
    /// crossed.
    pub(crate) fn fill_on(&self, side: Side, rows: &Rows<'_>, memory: &mut Memory, out: &mut [Vec<f64>]) {
        self.fill_crossed(side, rows, memory, out);
        let position_loop = side.answered_by().map(|axis| rows.position_loop(axis));
        if let (Some(position_loop), [column]) = (position_loop.filter(|known| known.acts()), out) {
            for (row, (time, value)) in rows.time.iter().zip(column).enumerate() {
                if rows.begins(row) {
                    memory.follower = Follower::default();
                }
                *value = position_loop.follow(&mut memory.follower, *time, *value, 0.0).position;
            }
        }
    }

    /// Fills its columns, a play as far as it is crossed.
    fn fill_crossed(&self, side: Side, rows: &Rows<'_>, memory: &mut Memory, out: &mut [Vec<f64>]) {
        match (side, self) {
            (side, Self::Backlash { axis, wind_up: 0.0 }) => {
                one(out, |out| backlash::fill_crossed(rows, *axis, side, out));
            }
            (_, Self::Times { core, factors }) => {
                core.fill_crossed(side, rows, memory, out);
                factor::multiply(factors, rows, &mut memory.factors, out);
            }
            _ => self.fill(rows, memory, out),
        }
    }

    /// Adds the value of the term with these coefficients to `sum`, as it comes in on a side.
    pub(crate) fn add(
        &self,
        coefficients: &[f64],
        side: Side,
        rows: &Rows<'_>,
        memory: &mut Memory,
        sum: &mut [f64],
    ) {
        match self {
            Self::Table { axis, nodes, directed, repeats } => {
                let nodes = table::Nodes { nodes, repeats: *repeats };
                table::add(rows, *axis, nodes, *directed, coefficients, sum);
            }
            // The position behind the loop is in the states already.
            Self::Lag { .. } => {}
            _ => {
                let mut columns = vec![Vec::with_capacity(rows.len()); self.columns()];
                self.fill_on(side, rows, memory, &mut columns);
                for (column, coefficient) in columns.iter().zip(coefficients) {
                    for (sum, value) in sum.iter_mut().zip(column) {
                        *sum += coefficient * value;
                    }
                }
            }
        }
    }
}

/// How often something has turned whose speed, in turns a second, a channel records.
pub(crate) fn turned(time: &[f64], speed: &[f64]) -> Vec<f64> {
    factor::FactorMemory::default().turned(time, speed, 1.0)
}

fn each(out: &mut [Vec<f64>], fill: impl Fn(&mut Vec<f64>)) {
    for column in out {
        column.clear();
        fill(column);
    }
}

fn one(out: &mut [Vec<f64>], fill: impl FnOnce(&mut Vec<f64>)) {
    if let Some(column) = out.first_mut() {
        column.clear();
        fill(column);
    }
}

/// The two columns sin and cos of 2 pi times a phase in turns.
fn wave(turns: impl Iterator<Item = f64>, out: &mut [Vec<f64>]) {
    if let [sines, cosines] = out {
        cosines.clear();
        cosines.extend(turns);
        sines.clear();
        sines.resize(cosines.len(), 0.0);
        for (sines, cosines) in sines.chunks_mut(LANES).zip(cosines.chunks_mut(LANES)) {
            let mut turns = [0.0; LANES];
            turns[..cosines.len()].copy_from_slice(cosines);
            let (sine, cosine) = (f64x4::new(turns) * f64x4::splat(TAU)).sin_cos();
            sines.copy_from_slice(&sine.to_array()[..sines.len()]);
            cosines.copy_from_slice(&cosine.to_array()[..cosines.len()]);
        }
    }
}

/// How many phases are worked out together: as many as an `f64x4` has. One by one, sines and cosines would be half of a search among waves.
const LANES: usize = 4;

#[cfg(test)]
mod tests;
