//! How far a polynomial goes over the travel of its axis.
//!
//! In: a polynomial or a coupling of several powers, and the travels. Out: the difference of its highest and its lowest value, with an
//! interval. Its coefficients are those of powers of the position itself, since calibrations are: far from zero they are large, cancel
//! each other and show nobody a size.

use super::Described;
use crate::diagnosis::OverTravel;
use crate::terms::{Shape, polynomial_powers};
use crate::travel::Travel;

/// Into how many steps the travel is divided. A parabola that turns between two of them is higher there by (1/200)^2 of its
/// range at most.
const STEPS: usize = 200;

impl Described<'_> {
    /// How far the effect goes over the travel of its axis; `None` where a parameter says that, or nothing moves.
    pub(crate) fn over_travel(&self, travels: &[Travel]) -> Option<OverTravel> {
        // One power has one coefficient, which says as much.
        let (axis, center, scale, first) = match self.fitted.effect.shape {
            Shape::Polynomial { axis, degree: 2.., center, scale } => (axis, center, scale, 0),
            Shape::Coupling { axis, degree: 2.., scale } => (axis, 0.0, scale, 1),
            _ => return None,
        };
        let travel = travels.get(axis).filter(|travel| travel.moves)?;
        let place = |step: usize| travel.low + travel.range() * crate::number(step) / crate::number(STEPS);
        let places: Vec<f64> = (0..=STEPS).map(place).collect();
        let coefficients = &self.fitted.coefficients;
        let mut powers = vec![Vec::new(); coefficients.len()];
        polynomial_powers(&places, center, scale, first, &mut powers);
        let value = |step: &usize| -> f64 {
            powers.iter().zip(coefficients).map(|(power, coefficient)| power[*step] * coefficient).sum()
        };
        let by_value = |one: &usize, other: &usize| value(one).total_cmp(&value(other));
        let (lowest, highest) = ((0..=STEPS).min_by(by_value)?, (0..=STEPS).max_by(by_value)?);
        let between: Vec<f64> = powers.iter().map(|power| power[highest] - power[lowest]).collect();
        let (factor, unit) = self.motion_unit;
        let range = self.derived(value(&highest) - value(&lowest), &between, (factor, unit.to_owned()));
        Some(OverTravel { axis: self.study.equations.axes[axis].letter.clone(), range })
    }
}
