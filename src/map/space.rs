//! The workspace of a map. In: the tables of a calibration and the positions that were read. Out: for each axis from where to
//! where the map reaches.

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;

/// A stretch of an axis, mm or rad; nothing yet where the ends are crossed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Stretch {
    const NOTHING: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };

    fn with(self, place: f64) -> Self {
        if place.is_finite() { Self { low: self.low.min(place), high: self.high.max(place) } } else { self }
    }

    fn is_long(self) -> bool {
        self.high > self.low
    }

    pub(super) fn length(self) -> f64 {
        self.high - self.low
    }

    pub(super) fn middle(self) -> f64 {
        f64::midpoint(self.low, self.high)
    }
}

/// How far each axis goes.
pub(super) struct Space {
    tables: Vec<Stretch>,
    read: Vec<Stretch>,
}

/// A slide of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slide {
    /// The number of its axis.
    pub(super) axis: usize,
    /// The direction of the part's frame in which it moves: 0, 1, 2.
    pub(super) direction: usize,
    pub(super) stretch: Stretch,
}

impl Space {
    /// The reach of the calibration's tables.
    pub(super) fn new(equations: &Equations, calibration: &Calibration) -> Self {
        let mut tables = vec![Stretch::NOTHING; equations.axes.len()];
        let terms = calibration.motions.iter().flat_map(|motion| &motion.terms);
        for term in terms {
            for (axis, slot) in tables.iter_mut().enumerate() {
                *slot = term.value.nodes(axis).into_iter().fold(*slot, Stretch::with);
            }
        }
        Self { read: vec![Stretch::NOTHING; tables.len()], tables }
    }

    /// Takes a position that was read.
    pub(super) fn take(&mut self, position: &[f64]) {
        for (stretch, place) in self.read.iter_mut().zip(position) {
            *stretch = stretch.with(*place);
        }
    }

    /// Where an axis goes: over its tables, or else over the positions that were read.
    fn stretch(&self, axis: usize) -> Stretch {
        let all = [&self.tables, &self.read].map(|all| all.get(axis).copied().unwrap_or(Stretch::NOTHING));
        all.into_iter().find(|stretch| stretch.is_long()).unwrap_or(all[1])
    }

    /// The slides that have a length, one for each direction, in order.
    pub(super) fn slides(&self, equations: &Equations) -> Vec<Slide> {
        let slide = |direction: usize| {
            let mut axes = equations.axes.iter().enumerate();
            axes.find_map(|(axis, info)| {
                let stretch = self.stretch(axis);
                let fits = !info.rotary && info.along.index() == direction && stretch.is_long();
                fits.then_some(Slide { axis, direction, stretch })
            })
        };
        (0..3).filter_map(slide).collect()
    }

    /// The middle of the workspace: where axes stand that a picture does not move. An axis of which nothing is known stands at
    /// zero.
    pub(super) fn middle(&self) -> Vec<f64> {
        let middle = |axis| Some(self.stretch(axis).middle()).filter(|middle| middle.is_finite());
        (0..self.read.len()).map(|axis| middle(axis).unwrap_or(0.0)).collect()
    }
}

#[cfg(test)]
mod tests {
    use model_dsl::calibration::{Curve, CurveNodes, CurveValues};

    use super::*;

    #[test]
    fn a_table_ends_where_its_last_value_stands() {
        let values = CurveValues::Both(vec![0.0; 5]);
        let uniform = Curve::new(CurveNodes::Uniform { start: 100.0, step: -25.0 }, values.clone());
        assert_eq!(uniform.ends(), Some([100.0, 0.0]));
        let at = Curve::new(CurveNodes::At(vec![1.0, 2.0, 4.0, 8.0, 16.0]), values);
        assert_eq!(at.ends(), Some([1.0, 16.0]));
        let reach = uniform.ends().into_iter().flatten().fold(Stretch::NOTHING, Stretch::with);
        assert_eq!((reach.low, reach.high, reach.middle()), (0.0, 100.0, 50.0));
    }
}
