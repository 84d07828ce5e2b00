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
