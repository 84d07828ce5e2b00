//! Which effects a recording can show at all. In: a recording, and random choices. Out: effects of size one in error motions
//! that its readings see.
//!
//! The rules are those of fairness: an effect that leaves no trace of its own, however large, is no case. Each bound is what
//! the effect needs to stand out: enough reversals that one can be held out, enough rows for a wave, a rise of temperature.

use std::f64::consts::TAU;

use model_dsl::calibration::TermKind;
use simulation::noise::Source;

use crate::injection::base::{Base, Signal};
use crate::injection::columns::{alike, correlation, rms, straightened};
use crate::injection::effect::Effect;
use crate::injection::kind::Kind;
use crate::injection::state::Axis;

/// Reversals that an effect of direction needs: one on each side of what is held out.
const REVERSALS: usize = 2;

/// Places that an axis must stand at for a wave or a bump of 9 to 14 on the travel to be drawn by them.
const PLACES: usize = 100;

/// The longest time between rows at which a position loop, of some 1/s, does more than settle unseen, s.
const FAST: f64 = 0.05;

/// The shortest recording in which a structure warms, s.
const SLOW: f64 = 300.0;

/// A rise of temperature that is more than its sensor's display, K.
const WARMER: f64 = 1.0;

/// An effect of size one and the motion that it is in.
pub struct Allowed {
    /// The motion, by number.
    pub motion: usize,
    /// The axis that moves, where the effect follows one.
    pub axis: Option<usize>,
    /// The effect of size one.
    pub effect: Effect,
}

/// Random choices of one case: the same under the same seed, whatever other cases there are.
struct Draw(Source);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    fn sign(&mut self) -> f64 {
        if self.0.uniform() < 0.5 { -1.0 } else { 1.0 }
    }
}

/// All effects that a recording allows.
pub fn allowed(base: &Base, seed: u64) -> Vec<Allowed> {
    let mut all = Vec::new();
    let mut take =
        |motion: usize, axis: Option<usize>, make: &dyn Fn(&mut Draw) -> Option<Effect>, kind: Kind| {
            let name = &base.names.motions[motion].name;
            let mut draw = Draw(Source::new(seed, &format!("{} {name} {}", base.name, kind.name())));
            all.extend(make(&mut draw).map(|effect| Allowed { motion, axis, effect }));
        };
    let motions: Vec<Option<usize>> = (0..base.names.axes.len()).map(|axis| base.motion_of(axis)).collect();
    for (number, motion) in motions.iter().enumerate() {
        let moving = base.path.axes[number].as_ref().filter(|axis| axis.travel() > 0.0);
        let (Some(motion), Some(axis)) = (*motion, moving) else { continue };
        let of = |kind: Kind| move |draw: &mut Draw| of_axis(base, number, axis, kind, draw);
        for kind in OF_AXIS {
            take(motion, Some(number), &of(kind), kind);
        }
    }
    if let Some(motion) = motions.iter().flatten().next().copied() {
        for kind in BESIDE {
            take(motion, None, &|draw| beside(base, kind, draw), kind);
        }
    }
    if let Some(motion) = squareness(base).filter(|_| base.outside()) {
        take(
            motion,
            None,
            &|draw| Some(Effect::Constant { value: draw.sign() }),
            Kind::Term(TermKind::Constant),
        );
    }
    all
}

/// An effect of size one of a kind in a motion of an axis, where the recording could show it. `name` is that of the draw: the same
/// name draws the same place, period, phase and sign in whatever motion.
pub fn drawn(
    base: &Base,
    motion: usize,
    axis: usize,
    (kind, name): (Kind, &str),
    seed: u64,
) -> Option<Allowed> {
    let moving = base.path.axes.get(axis)?.as_ref().filter(|axis| axis.travel() > 0.0)?;
    let mut draw = Draw(Source::new(seed, name));
    let (follows, effect) = if kind.term() == TermKind::Constant {
        (None, Some(Effect::Constant { value: draw.sign() }))
    } else if OF_AXIS.contains(&kind) {
        (Some(axis), of_axis(base, axis, moving, kind, &mut draw))
    } else {
        (None, beside(base, kind, &mut draw))
    };
    effect.map(|effect| Allowed { motion, axis: follows, effect })
}

/// The kinds that follow an axis.
const OF_AXIS: [Kind; 10] = [
    Kind::Term(TermKind::Polynomial),
    Kind::Term(TermKind::Table),
    Kind::Term(TermKind::Backlash),
    Kind::WindUp,
    Kind::Term(TermKind::ReversalSpike),
    Kind::Term(TermKind::Cyclic),
    Kind::Term(TermKind::Lag),
    Kind::Term(TermKind::Acceleration),
    Kind::Term(TermKind::Expansion),
    Kind::Term(TermKind::Coupling),
];

/// The kinds that follow what is recorded beside the axes.
const BESIDE: [Kind; 4] = [
    Kind::Term(TermKind::Growth),
    Kind::Term(TermKind::Drift),
    Kind::Term(TermKind::Vibration),
    Kind::Term(TermKind::Compliance),
];

fn of_axis(base: &Base, number: usize, axis: &Axis, kind: Kind, draw: &mut Draw) -> Option<Effect> {
    let clock = &base.path.clock;
    let (travel, turns) = (axis.travel(), axis.turns >= REVERSALS);
    let fine = axis.stations() > PLACES;
    match kind {
        Kind::Term(TermKind::Polynomial) => {
            Some(Effect::Polynomial { axis: number, slope: draw.sign() / travel })
        }
        Kind::Term(TermKind::Table) => bump(base, number, axis, draw),
        Kind::Term(TermKind::Backlash) if turns => {
            Some(Effect::Backlash { axis: number, lost_motion: 1.0, wind_up: 0.0 })
        }
        Kind::WindUp => {
            let wind_up = travel / draw.between(20.0, 50.0);
            let resolved = fine && axis.stride() < wind_up / 3.0;
            (turns && resolved).then_some(Effect::Backlash { axis: number, lost_motion: 1.0, wind_up })
        }
        Kind::Term(TermKind::ReversalSpike) => {
            let decay = clock.step * draw.between(6.0, 15.0);
            // Twice as many as backlash needs: a spike shows in the few rows behind each.
            let apart = clock.span() / axis.turns.max(1) as f64;
            let many = axis.turns >= 2 * REVERSALS && decay < apart / 5.0;
            many.then(|| Effect::ReversalSpike { axis: number, height: draw.sign(), decay })
        }
        Kind::Term(TermKind::Cyclic) => {
            let mut period = travel / draw.between(9.0, 14.0);
            if base.names.axes[number].rotary {
                // What turns repeats in whole parts of a turn.
                period = TAU / (TAU / period).round().max(1.0);
            }
            let resolved = fine && axis.stride() < period / 6.0;
            let phase = draw.between(0.0, TAU);
            resolved.then_some(Effect::Cyclic { axis: number, period, amplitude: 1.0, phase })
        }
        Kind::Term(TermKind::Lag) if turns && clock.step < FAST => {
            Some(Effect::Lag { axis: number, gain: draw.between(15.0, 60.0) })
        }
        Kind::Term(TermKind::Acceleration) if turns && clock.step < FAST => {
            let most = axis.acceleration.iter().fold(0.0, |most: f64, a| most.max(a.abs()));
            let strong = axis.acceleration.iter().filter(|a| a.abs() > 0.2 * most).count();
            // A command that jumps from speed to speed, or is rounded, has no acceleration that rows could show.
            let smooth = strong > PLACES && axis.smooth();
            smooth.then(|| Effect::Acceleration { axis: number, gain: draw.sign() })
        }
        Kind::Term(TermKind::Expansion) => {
            let (sensor, reference) = warmest(base)?;
            let coefficient = draw.sign();
            (axis.stations() > 2).then_some(Effect::Expansion {
                axis: number,
                sensor,
                coefficient,
                reference,
            })
        }
        Kind::Term(TermKind::Coupling) if base.outside() => coupling(base, number, axis, draw),
        _ => None,
    }
}

/// A bump at a place that many passes cross, a few percent of the travel wide.
fn bump(base: &Base, number: usize, axis: &Axis, draw: &mut Draw) -> Option<Effect> {
    let at = axis.range[0] + axis.travel() * draw.between(0.3, 0.7);
    let width = axis.travel() * draw.between(0.03, 0.06);
    let height = draw.sign();
    // Twenty rows, and passes enough that a place is told from a moment.
    let there = axis.position.iter().filter(|q| (*q - at).abs() < 1.18 * width).count();
    let crossed = axis.turns > REVERSALS && there > 20 && axis.stations() > 8;
    let moves = base.path.axes[number].is_some();
    (moves && crossed).then_some(Effect::Table { axis: number, at, width, height })
}

/// A bow of the motion over the travel of another axis that does not go along with this one.
fn coupling(base: &Base, number: usize, axis: &Axis, draw: &mut Draw) -> Option<Effect> {
    let others = base.path.axes.iter().enumerate().filter(|(other, _)| *other != number);
    let mut others = others.filter_map(|(other, axis)| Some((other, axis.as_ref()?)));
    let (other, state) = others.find(|(_, state)| {
        state.travel() > 0.0 && state.stations() > 8 && !alike(&state.position, &axis.position)
    })?;
    // ((q - middle)/half)^2 less its constant part.
    let (middle, half) = (0.5 * (state.range[0] + state.range[1]), 0.5 * state.travel());
    let size = draw.sign() / (half * half);
    Some(Effect::Coupling { axis: other, coefficients: [-2.0 * middle * size, size] })
}

/// The kinds that follow what is recorded beside the axes.
fn beside(base: &Base, kind: Kind, draw: &mut Draw) -> Option<Effect> {
    let clock = &base.path.clock;
    let span = clock.span();
    let whole = clock.stretches.len() < 3;
    match kind {
        Kind::Term(TermKind::Growth) => {
            let (sensor, reference) = warmest(base)?;
            let time_constant = span / draw.between(10.0, 20.0);
            let coefficient = draw.sign();
            // A filter of some rows at least; from run to run nobody knows what was between.
            let slow = whole && time_constant > 5.0 * clock.step;
            slow.then_some(Effect::Growth { sensor, coefficient, reference, time_constant })
        }
        Kind::Term(TermKind::Drift) => {
            let time_constant = span / draw.between(4.0, 7.0);
            (whole && span > SLOW).then(|| Effect::Drift { amplitude: draw.sign(), time_constant })
        }
        Kind::Term(TermKind::Vibration) => {
            let frequency = 1.0 / (clock.step * draw.between(10.0, 20.0));
            let phase = draw.between(0.0, TAU);
            // A wave needs its rows at even times: stations have times of their own.
            let even = clock.time.len() > PLACES && clock.step < FAST;
            even.then_some(Effect::Vibration { frequency, amplitude: 1.0, phase })
        }
        Kind::Term(TermKind::Compliance) => {
            let load = pushes(base)?;
            Some(Effect::Compliance { load, coefficient: draw.sign() })
        }
        _ => None,
    }
}

/// The sensor that warms most, and its first temperature.
fn warmest(base: &Base) -> Option<(usize, f64)> {
    let rise = |column: &Vec<f64>| {
        let (low, high) = column.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(*value), high.max(*value))
        });
        high - low
    };
    let risen = base.path.temperatures.iter().enumerate().map(|(sensor, column)| (sensor, rise(column)));
    let (sensor, risen) = risen.max_by(|left, right| left.1.total_cmp(&right.1))?;
    let first = base.path.temperatures[sensor].first().copied()?;
    (risen > WARMER).then_some((sensor, first))
}

/// A load that changes and is not the answer of a drive to its own motion.
fn pushes(base: &Base) -> Option<usize> {
    let moving: Vec<&Axis> = base.path.axes.iter().flatten().filter(|axis| axis.travel() > 0.0).collect();
    let answer = |load: &Vec<f64>| {
        let causes = moving.iter().flat_map(|axis| [&axis.velocity, &axis.acceleration, &axis.direction]);
        // Half of an answer is an answer: what drives push against has friction and mass in it.
        causes.into_iter().any(|cause| correlation(load, cause).abs() > 0.5)
    };
    let changes = |load: &Vec<f64>| rms(&straightened(load, &vec![0.0; load.len()])) > 0.0;
    base.path.loads.iter().position(|load| changes(load) && !answer(load))
}

/// The alignment that readings see most of, where two axes move.
fn squareness(base: &Base) -> Option<usize> {
    let alignments =
        base.compiled.equations.motions.iter().enumerate().filter(|(_, motion)| motion.alignment);
    let flat = vec![0.0; base.path.clock.time.len()];
    let step = vec![1e-3; flat.len()];
    // Without what it adds everywhere alike, which is the zero of the reading.
    let change =
        |signal: Signal| signal.iter().map(|column| rms(&straightened(column, &flat))).fold(0.0, f64::max);
    let seen = alignments.filter_map(|(motion, _)| Some((motion, change(base.shown(motion, &step)?))));
    let (motion, most) = seen.max_by(|left, right| left.1.total_cmp(&right.1))?;
    let moving = base.path.axes.iter().flatten().filter(|axis| axis.travel() > 0.0).count();
    (moving > 1 && most > 0.0).then_some(motion)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_of_a_case_do_not_depend_on_other_cases() {
        let one = |name: &str| Draw(Source::new(7, name)).between(0.0, 1.0);
        assert_eq!(one("base EXX lag"), one("base EXX lag"));
        assert_ne!(one("base EXX lag"), one("base EXX cyclic"));
    }
}
