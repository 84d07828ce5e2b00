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

/// The plausible sizes of a curve along a slide. `over` is the length in mm to which its coefficients refer.
fn along_a_guide(body: Body, over: f64) -> Option<Range> {
    match body {
        Body::Tilted => Some(GUIDE),
        Body::Displaced => Some((0.0, SLOPE * over)),
        Body::Rotary | Body::Aligned => None,
    }
}

/// The plausible slope of a displacement. Scales and guides of a mill are off by a ten-thousandth, those of a printer or of a small
/// stage by up to five thousandths.
const SLOPE: f64 = 5e-3;

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
        // At constant speed a delay of 1/K is a loop of gain K: what makes the one odd makes the other odd too, and the data decide.
        Shape::Lag { .. } | Shape::Delay { .. } => Some(lag::PLAUSIBLE),
        Shape::Acceleration { .. } => Some(acceleration::PLAUSIBLE),
        Shape::Expansion { .. } => Some(expansion::PLAUSIBLE),
        Shape::Backlash { .. } => backlash::plausible(Body::of(study, effect)),
        Shape::ReversalSpike { .. } => reversal_spike::plausible(Body::of(study, effect)),
        Shape::Polynomial { scale, .. } | Shape::Coupling { scale, .. } => {
            along_a_guide(Body::of(study, effect), scale.abs())
        }
        Shape::Table { .. } | Shape::Cyclic { .. } => along_a_guide(Body::of(study, effect), f64::INFINITY),
        Shape::Instrument(Setting::Cosine) => Some(instrument::COSINE),
        _ => None,
    }
}

/// What a size costs beyond its plausible range.
pub(crate) fn oddity(plausible: Option<Range>, shape: &Shape, coefficients: &[f64]) -> f64 {
    let Some((least, most)) = plausible else { return 0.0 };
    let size = size(shape, coefficients);
    if !size.is_finite() || size <= 0.0 {
        return 0.0;
    }
    let times = (least / size).ln().max((size / most).ln()).max(0.0);
    (times / BEYOND).powi(2)
}

/// How large an effect is: the gain of a loop, half of what a curve goes through, else what its coefficients make together. What does
/// not change along a curve is a zero.
fn size(shape: &Shape, coefficients: &[f64]) -> f64 {
    let sum = |coefficients: &[f64]| coefficients.iter().map(|coefficient| coefficient.abs()).sum::<f64>();
    match shape {
        Shape::Lag { .. } | Shape::Acceleration { .. } => sum(coefficients).recip(),
        Shape::Delay { time, .. } => (time.abs() * sum(coefficients)).recip(),
        Shape::Polynomial { .. } => sum(coefficients.get(1..).unwrap_or_default()),
        Shape::Table { .. } => {
            let highest = coefficients.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let lowest = coefficients.iter().copied().fold(f64::INFINITY, f64::min);
            0.5 * (highest - lowest)
        }
        _ => sum(coefficients),
    }
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
    fn a_curve_is_as_large_as_what_it_goes_through_and_not_as_its_zero() {
        let polynomial = Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 100.0 };
        assert_eq!(size(&polynomial, &[7.0, -0.2, 0.1]), 0.2 + 0.1);
        let table = Shape::Table { axis: 0, nodes: vec![0.0, 1.0, 2.0], directed: false, repeats: false };
        assert_eq!(size(&table, &[5.0, 5.5, 4.5]), 0.5);
        // A slope of 4 thousandths over a slide is a printer's, of 4 hundredths nobody's.
        let along_x = |size: f64| {
            let polynomial = Shape::Polynomial { axis: 0, degree: 1, center: 0.0, scale: 100.0 };
            let bench = Bench::of("FX");
            let recording = programmed(&[0.0, 1.0], &[vec![0.0, 1.0]]);
            let study = Study::new(bench.equations(), None, &[&recording]);
            let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
            let effect = Effect { place, shape: polynomial.clone() };
            oddity(plausible(&study, &effect), &polynomial, &[0.0, size])
        };
        assert_eq!(along_x(0.4), 0.0);
        assert!(along_x(4.0) > 30.0);
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
