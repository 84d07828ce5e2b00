//! How far a polynomial goes over the travel of its axis.
//!
//! In: a polynomial or a coupling of several powers, and the travels. Out: the difference of its highest and its lowest value, with an
//! interval. Its coefficients are those of powers of the position itself, since calibrations are: far from zero they are large, cancel
//! each other and show nobody a size.

use super::Described;
use crate::diagnosis::OverTravel;
use crate::terms::Shape;
use crate::travel::Travel;

/// Into how many steps the travel is divided. A parabola that turns between two of them is higher there by (1/200)^2 of its
/// range at most.
const STEPS: usize = 200;

/// The powers of (q - center) / scale that a shape is the sum of.
struct Powers {
    axis: usize,
    center: f64,
    scale: f64,
    first: usize,
    last: usize,
}

impl Powers {
    /// Those of a shape of several powers; one power has one coefficient, which says as much.
    fn of(shape: &Shape) -> Option<Self> {
        let powers = match *shape {
            Shape::Polynomial { axis, degree, center, scale } => {
                Self { axis, center, scale, first: 0, last: degree }
            }
            Shape::Coupling { axis, degree, scale } => {
                Self { axis, center: 0.0, scale, first: 1, last: degree }
            }
            _ => return None,
        };
        (powers.last > 1).then_some(powers)
    }

    /// Each power at a position.
    fn at(&self, position: f64) -> Vec<f64> {
        let x = (position - self.center) / self.scale;
        let powers = std::iter::successors(Some(1.0), |power| Some(power * x));
        powers.skip(self.first).take(self.last + 1 - self.first).collect()
    }
}

impl Described<'_> {
    /// How far the effect goes over the travel of its axis; `None` where a parameter says that, or nothing moves.
    pub(crate) fn over_travel(&self, travels: &[Travel]) -> Option<OverTravel> {
        let powers = Powers::of(&self.fitted.effect.shape)?;
        let travel = travels.get(powers.axis).filter(|travel| travel.moves)?;
        let place = |step: usize| travel.low + travel.range() * crate::number(step) / crate::number(STEPS);
        let value = |powers: &Vec<f64>| -> f64 {
            powers.iter().zip(&self.fitted.coefficients).map(|(power, coefficient)| power * coefficient).sum()
        };
        let places: Vec<Vec<f64>> = (0..=STEPS).map(|step| powers.at(place(step))).collect();
        let by_value = |one: &&Vec<f64>, other: &&Vec<f64>| value(one).total_cmp(&value(other));
        let (lowest, highest) = (places.iter().min_by(by_value)?, places.iter().max_by(by_value)?);
        let between: Vec<f64> = highest.iter().zip(lowest).map(|(high, low)| high - low).collect();
        let (factor, unit) = self.motion_unit;
        let range = self.derived(value(&between), &between, (factor, unit.to_owned()));
        Some(OverTravel { axis: self.study.equations.axes[powers.axis].letter.clone(), range })
    }
}
