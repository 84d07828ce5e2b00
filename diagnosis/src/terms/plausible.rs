//! Plausible sizes: the prior of a term.
//!
//! In: an effect with its coefficients. Out: what its size costs beyond what its physics allows, in units of minus twice the
//! log-likelihood. Within the plausible range, which the reports print, nothing; beyond it the square of how many times, as a
//! normal distribution of the logarithm has it. A size that nobody has seen is not forbidden: it needs the more evidence.

use super::{Setting, Shape, acceleration, backlash, expansion, instrument, lag, reversal_spike};
use crate::model::Effect;
use crate::study::Study;

/// The standard deviation of the logarithm of a size beyond its plausible range: twice the end of the range costs 4, ten times
/// 43, which only an effect far above the noise pays.
const BEYOND: f64 = 0.35;

/// The least and the greatest plausible size of a term, in mm, rad, s and degC.
pub(crate) type Range = (f64, f64);

/// The plausible tilt of a carriage on its way, to either side: 1 mrad bends a guide of a metre by a quarter of a millimetre.
const GUIDE: Range = (0.0, 1e-3);

/// What moves: what a size is measured in, and what is large there.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Body {
    /// A displacement of a body, mm.
    Displaced,
    /// The angle of a rotary axis, rad.
    Rotary,
    /// A rotation of a body that should not turn, as it moves, rad.
    Tilted,
    /// How a body was put on, mm or rad.
    Aligned,
}

impl Body {
    /// What an effect moves. The instrument of a recording measures lengths.
    fn of(study: &Study<'_>, effect: &Effect) -> Self {
        match effect.motion() {
            Some(motion) if study.equations.motions[motion].alignment => Self::Aligned,
            Some(motion) if study.own.contains(&Some(motion)) && study.equations.motions[motion].angular => {
                Self::Rotary
            }
            Some(motion) if study.equations.motions[motion].angular => Self::Tilted,
            _ => Self::Displaced,
        }
    }
}

/// The plausible sizes of an effect; `None` where its physics sets no limit.
pub(crate) fn plausible(study: &Study<'_>, effect: &Effect) -> Option<Range> {
    match effect.shape {
        Shape::Lag { .. } => Some(lag::PLAUSIBLE),
        Shape::Acceleration { .. } => Some(acceleration::PLAUSIBLE),
        Shape::Expansion { .. } => Some(expansion::PLAUSIBLE),
        Shape::Backlash { .. } => backlash::plausible(Body::of(study, effect)),
        Shape::ReversalSpike { .. } => reversal_spike::plausible(Body::of(study, effect)),
        Shape::Polynomial { .. } | Shape::Coupling { .. } | Shape::Table { .. } | Shape::Cyclic { .. } => {
            (Body::of(study, effect) == Body::Tilted).then_some(GUIDE)
        }
        Shape::Instrument(Setting::Cosine) => Some(instrument::COSINE),
        _ => None,
    }
}

/// What a size costs beyond its plausible range.
pub(crate) fn oddity(plausible: Option<Range>, shape: &Shape, coefficients: &[f64]) -> f64 {
    let Some((least, most)) = plausible else { return 0.0 };
    let sum: f64 = coefficients.iter().map(|coefficient| coefficient.abs()).sum();
    // Loops are printed as gains, and fitted as what they lose.
    let loops = matches!(shape, Shape::Lag { .. } | Shape::Acceleration { .. });
    let size = if loops { sum.recip() } else { sum };
    if !size.is_finite() || size <= 0.0 {
        return 0.0;
    }
    let times = (least / size).ln().max((size / most).ln()).max(0.0);
    (times / BEYOND).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Place;
    use crate::side::Side;
    use crate::testing::{Bench, programmed};

    /// What an effect of this size costs on a mill with a rotary table.
    fn cost(motion: &str, shape: &Shape, size: f64) -> f64 {
        let bench = Bench::of("CYXFZ");
        let recording = programmed(&[0.0, 1.0], &vec![vec![0.0, 1.0]; 4]);
        let study = Study::new(bench.equations(), None, &[&recording]);
        let place = Place::Motion { motion: bench.motion(motion), side: Side::After };
        let effect = Effect { place, shape: shape.clone() };
        oddity(plausible(&study, &effect), shape, &[size])
    }

    #[test]
    fn what_no_machine_has_needs_more_evidence_the_larger_it_is() {
        let play = Shape::Backlash { axis: 0, wind_up: 0.0 };
        // 20 um on a slide, half a degree on a rotary axis, 50 urad of yaw at reversals: seen every day.
        for (motion, size) in [("EXX", 0.02), ("EXX", -0.02), ("ECC", 0.0087), ("ECX", 5e-5)] {
            assert_eq!(cost(motion, &play, size), 0.0, "{motion}");
        }
        // Twice what is plausible costs what two standard deviations of its logarithm cost, ten times as much nearly forbids it.
        for (motion, most) in [("EXX", 0.1), ("ECX", 1e-4), ("ECC", 1f64.to_radians())] {
            assert!((cost(motion, &play, 2.0 * most) - 3.92).abs() < 0.01, "{motion}");
            assert!(cost(motion, &play, -10.0 * most) > 40.0, "{motion}");
        }
    }

    #[test]
    fn a_loop_is_judged_by_its_gain_and_a_squareness_not_at_all() {
        let lag = Shape::Lag { axis: 0, inertia: 0.0 };
        assert_eq!(cost("EXX", &lag, 1.0 / 50.0), 0.0);
        assert!(cost("EXX", &lag, 1.0 / 45_000.0) > 100.0);
        assert_eq!(cost("EC0Y", &Shape::Constant, 0.02), 0.0);
        assert_eq!(cost("EXX", &lag, 0.0), 0.0);
    }
}
