//! Ranges: where a parameter that is not linear can be told from a recording at all, and which shapes cannot stand together.
//!
//! In: a term and what the axes did. Out: the least and the greatest value of its nonlinear parameter. Beyond it a wave is a
//! slope, a decay is a step and a settling is a jump: the fit would follow whatever the noise does there and give it a name.

use std::f64::consts::TAU;

use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;

/// The fewest cycles of a vibration in the time that was observed.
pub(crate) const CYCLES: f64 = 6.0;
/// The fewest periods of a cyclic error in the travel.
pub(crate) const PERIODS: f64 = 1.6;
/// A decay may last this share of the time from reversal to reversal.
const DECAY: f64 = 0.3;
/// A play may be taken up over this share of the travel.
const WIND_UP: f64 = 0.8;
/// The longest time constant of a settling, as a multiple of the recording: less than a sixth of a longer one is seen, and that is
/// a straight line within 2 %.
const SETTLING: f64 = 6.0;

/// The range of the nonlinear parameter of a shape, in mm, rad, s or Hz.
pub(crate) fn range(study: &Study<'_>, travels: &[Travel], shape: &Shape) -> (f64, f64) {
    let step = shortest_step(study);
    let observed = study.scenes.iter().map(|scene| scene.observed).fold(0.0, f64::max);
    let travel = shape.axis().and_then(|axis| travels.get(axis)).copied().unwrap_or_default();
    match shape.core() {
        Shape::Backlash { .. } => (travel.step.min(WIND_UP * travel.range()), WIND_UP * travel.range()),
        Shape::ReversalSpike { .. } => (0.3 * step, DECAY * travel.between),
        // A part of a turn is a part of a turn: it is not fitted.
        Shape::Cyclic { axis, period, .. } if goes_round(study, *axis, &travel) => (*period, *period),
        // Of a harmonic it is the period of its fundamental that is fitted.
        Shape::Cyclic { axis, order, .. } => {
            let (shortest, longest) = periods(study, *axis, &travel);
            let order = f64::from(*order);
            (order * shortest, order * longest)
        }
        Shape::Vibration { .. } => (CYCLES / observed, 0.5 / step),
        Shape::Drift { .. } => (5.0 * step, SETTLING * observed),
        Shape::Growth { .. } => (step, SETTLING * observed),
        // A natural frequency that the rows resolve: half of theirs at most.
        Shape::Lag { inertia, .. } if *inertia > 0.0 => {
            ((step / std::f64::consts::PI).powi(2), f64::INFINITY)
        }
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    }
}

/// The periods of a wave along an axis that recordings show, from the shortest to the longest.
pub(crate) fn periods(study: &Study<'_>, axis: usize, travel: &Travel) -> (f64, f64) {
    let longest = if goes_round(study, axis, travel) { TAU } else { travel.range() / PERIODS };
    (2.0 * travel.step, longest)
}

/// Whether an axis is a rotary one that has gone round. It comes back to where it was: its errors repeat in whole parts of a turn,
/// and no other period is possible.
pub(crate) fn goes_round(study: &Study<'_>, axis: usize, travel: &Travel) -> bool {
    study.equations.axes[axis].rotary && travel.range() > ROUND * TAU
}

/// The share of a turn from which on a rotary axis has gone round, and parts of a turn are told apart.
const ROUND: f64 = 0.95;

/// What stands for a shape whose parameter has run to the end of its range, beyond which it is not looked for: a step for a spike
/// that fades over so much of the way to the next reversal, and play that is taken up at once for what is taken up between
/// two rows. Each is the simpler of two names that the recording hardly tells apart.
pub(crate) fn limit(study: &Study<'_>, travels: &[Travel], shape: &Shape) -> Option<Shape> {
    let (least, most) = range(study, travels, shape);
    match *shape {
        Shape::ReversalSpike { axis, decay } if decay >= AT_END * most => {
            Some(Shape::Backlash { axis, wind_up: 0.0 })
        }
        Shape::Backlash { axis, wind_up } if wind_up > 0.0 && AT_END * wind_up <= least => {
            Some(Shape::Backlash { axis, wind_up: 0.0 })
        }
        _ => None,
    }
}

/// At the end of a range is what has come so near to it.
const AT_END: f64 = 0.98;

/// How near two waves may be to one another and still be told apart: one turn more or less over all that was observed.
#[derive(Clone, Debug)]
pub(crate) struct Resolution {
    /// Hz.
    frequency: f64,
    /// Periods for each mm or rad of each axis.
    along: Vec<f64>,
}

impl Resolution {
    /// What the recordings resolve.
    pub(crate) fn new(study: &Study<'_>, travels: &[Travel]) -> Self {
        let observed = study.scenes.iter().map(|scene| scene.observed).fold(0.0, f64::max);
        Self { frequency: 1.0 / observed, along: travels.iter().map(|travel| 1.0 / travel.range()).collect() }
    }

    /// Whether an axis goes so far, mm or rad.
    pub(crate) fn goes(&self, axis: usize, far: f64) -> bool {
        self.along.get(axis).is_some_and(|along| far * along <= 1.0)
    }

    /// Whether two shapes are waves that cannot be told apart.
    pub(crate) fn blurs(&self, a: &Shape, b: &Shape) -> bool {
        match (a, b) {
            (Shape::Vibration { frequency: a }, Shape::Vibration { frequency: b }) => {
                (a - b).abs() < self.frequency
            }
            _ => a.wave_along().zip(b.wave_along()).is_some_and(|((axis, a), (other, b))| {
                axis == other && (1.0 / a - 1.0 / b).abs() < self.along[axis]
            }),
        }
    }
}

/// Whether a shape is a table that bends as another one does, which beside it would only smooth its corners.
pub(crate) fn holds(table: &Shape, other: &Shape) -> bool {
    let Shape::Table { axis: along, nodes, .. } = table else { return false };
    let spacing = nodes.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    match other {
        Shape::Polynomial { axis, .. } => axis == along,
        other => {
            other.wave_along().is_some_and(|(axis, period)| axis == *along && period > SMOOTHED * spacing)
        }
    }
}

/// A wave shorter than this many steps between nodes cannot be what a table leaves at its corners.
const SMOOTHED: f64 = 1.5;

/// The shortest typical step of time of all recordings.
pub(crate) fn shortest_step(study: &Study<'_>) -> f64 {
    let steps = study.scenes.iter().map(|scene| scene.given.step);
    steps.fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests;
