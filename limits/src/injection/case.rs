//! Cases. In: a recording and an effect that it allows. Out: the recording with the effect in it, at a size, and what the
//! effect alone shows.

use recording::Recording;
use simulation::noise::Source;

use crate::injection::allowed::Allowed;
use crate::injection::base::{Base, Signal};
use crate::injection::columns::{rms, straightened};
use crate::injection::effect::Effect;

/// Gains of a position loop that anyone has set, 1/s: slower ones are none, faster ones settle from row to row.
const SLOWEST: f64 = 2.0;

/// The part of the time between rows in which a loop must not have settled.
const SETTLED: f64 = 0.2;

/// The largest value at which an effect is tried for what it shows, mm or rad.
const SMALL: f64 = 1e-3;

/// One effect at one size.
pub struct Case {
    /// The base, by number.
    pub base: usize,
    /// The motion that has it.
    pub motion: usize,
    /// The effect at that size.
    pub effect: Effect,
    /// Its largest value over what a straight line leaves of the recording.
    pub size: f64,
    /// What it adds to the readings.
    pub signal: Signal,
    /// The same in its error motion.
    values: Vec<f64>,
}

impl Case {
    /// The effect at several sizes: its largest value in the readings over what a straight line leaves of them. None of a
    /// size at which no such effect is one of its kind.
    pub fn all(number: usize, base: &Base, allowed: &Allowed, sizes: &[f64]) -> Vec<Self> {
        let Some(unit) = unit(base, allowed) else { return Vec::new() };
        sizes.iter().filter_map(|size| Self::of(number, base, allowed, *size, size * unit)).collect()
    }

    fn of(number: usize, base: &Base, allowed: &Allowed, size: f64, factor: f64) -> Option<Self> {
        Self::with(number, base, (allowed.motion, allowed.effect.scaled(factor)), size)
    }

    /// An effect in a motion as it is; nothing where no such effect is one of its kind.
    pub fn with(number: usize, base: &Base, (motion, effect): (usize, Effect), size: f64) -> Option<Self> {
        let sensible = match effect {
            Effect::Lag { gain, .. } => gain > SLOWEST && gain < SETTLED / base.path.clock.step,
            _ => true,
        };
        if !sensible {
            return None;
        }
        let values = effect.values(&base.path)?;
        let signal = base.shown(motion, &values)?;
        Some(Self { base: number, motion, effect, size, signal, values })
    }

    /// The recording with the effect in it.
    pub fn recording(&self, base: &Base) -> Recording {
        let own = base.names.own_axis(&base.names.motions[self.motion]);
        let drive = own.filter(|_| self.effect.at_the_drive());
        base.with(&self.signal, drive.map(|axis| (axis, self.values.as_slice())))
    }
}

/// The strength at which the largest value of an effect in the readings is this, mm or rad.
pub fn strength_of(base: &Base, allowed: &Allowed, largest: f64) -> Option<f64> {
    let (each, _) = departure_of_one(base, allowed)?;
    let factor = largest / each;
    (factor.is_finite() && factor > 0.0).then_some(factor * allowed.effect.strength())
}

/// How many times as large an effect of size one must be for its largest value in the readings to be what a straight line
/// leaves of them.
fn unit(base: &Base, allowed: &Allowed) -> Option<f64> {
    let (each, shown) = departure_of_one(base, allowed)?;
    let unit = left(base, allowed.axis, &shown) / each;
    (unit.is_finite() && unit > 0.0).then_some(unit)
}

/// The largest value in the readings of an effect of size one, and what they gain by it in some part.
fn departure_of_one(base: &Base, allowed: &Allowed) -> Option<(f64, Signal)> {
    let values = allowed.effect.values(&base.path)?;
    let most = largest(&values);
    // So small that bodies turn in proportion to it.
    let small: Vec<f64> = values.iter().map(|value| SMALL * value / most).collect();
    let shown = base.shown(allowed.motion, &small)?;
    Some((departure(&shown, allowed.effect) * most / SMALL, shown))
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
}

/// How far the readings go through an effect: from zero; from the first row where a constant more means nothing.
fn departure(signal: &Signal, effect: Effect) -> f64 {
    let of_place =
        matches!(effect, Effect::Polynomial { .. } | Effect::Coupling { .. } | Effect::Constant { .. });
    let column = |column: &Vec<f64>| {
        let first = column.first().copied().filter(|_| of_place).unwrap_or(0.0);
        column.iter().fold(0.0, |most, value| f64::max(most, (value - first).abs()))
    };
    signal.iter().map(column).fold(0.0, f64::max)
}

/// What a straight line over the axis, or over time, leaves of the readings that show an effect: the size of everything
/// that conceals it.
fn left(base: &Base, axis: Option<usize>, shown: &Signal) -> f64 {
    let position = axis.and_then(|axis| base.path.axes[axis].as_ref()).map(|axis| &axis.position);
    let along = position.unwrap_or(&base.path.clock.time);
    let columns = base.residual();
    let seen = columns.iter().zip(shown).filter(|(_, shown)| largest(shown) > 0.0);
    let squares: Vec<f64> = seen.map(|(column, _)| rms(&straightened(column, along)).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt()
}

/// The order in which cases are worked off: that of a shuffled pack, so that a part of them is a sample of all.
pub fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut source = Source::new(seed, "order");
    let mut keyed: Vec<(f64, usize)> = (0..count).map(|number| (source.uniform(), number)).collect();
    keyed.sort_by(|left, right| left.0.total_cmp(&right.0));
    keyed.into_iter().map(|(_, number)| number).collect()
}
