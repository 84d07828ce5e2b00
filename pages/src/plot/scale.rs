//! Scales. In: a number. Out: its place in the drawing; nothing where it is not finite or lies beyond the axis.

/// From numbers to places, straight or logarithmic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    factor: f64,
    logarithmic: bool,
}

impl Scale {
    /// `ends` of the axis in its shown unit lie at the `places`; `factor` leads from given numbers to shown ones.
    pub(super) fn new(ends: (f64, f64), places: (f64, f64), factor: f64, logarithmic: bool) -> Self {
        let of = |end: f64| if logarithmic { end.log10() } else { end };
        Self { low: of(ends.0), high: of(ends.1), from: places.0, to: places.1, factor, logarithmic }
    }

    /// The place of a given number.
    pub(super) fn place(&self, value: f64) -> Option<f64> {
        self.shown(value * self.factor)
    }

    /// The place of a number in the shown unit.
    pub(super) fn shown(&self, value: f64) -> Option<f64> {
        let value = if self.logarithmic { value.log10() } else { value };
        let part = (value - self.low) / (self.high - self.low);
        (-EDGE..=1.0 + EDGE).contains(&part).then_some(self.from + part * (self.to - self.from))
    }

    /// The place of a given number, held at the ends of the axis; nothing where it is not a number.
    pub(super) fn held(&self, value: f64) -> Option<f64> {
        let shown = value * self.factor;
        let shown = if self.logarithmic { shown.max(f64::MIN_POSITIVE).log10() } else { shown };
        let part = ((shown - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        (!part.is_nan()).then_some(self.from + part * (self.to - self.from))
    }
}

/// What rounding puts beyond the end of an axis.
const EDGE: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn places_are_in_proportion_and_nothing_lies_beyond() {
        let scale = Scale::new((0.0, 10.0), (100.0, 200.0), 1e3, false);
        assert_eq!(scale.place(0.0025), Some(125.0));
        assert_eq!([0.011, -0.001, f64::NAN, f64::INFINITY].map(|value| scale.place(value)), [None; 4]);
        assert_eq!(scale.held(f64::INFINITY), Some(200.0));
        assert_eq!(scale.held(f64::NAN), None);
    }

    #[test]
    fn equal_factors_take_equal_room() {
        let scale = Scale::new((1.0, 100.0), (0.0, 200.0), 1.0, true);
        assert_eq!([1.0, 10.0, 100.0].map(|value| scale.place(value)), [Some(0.0), Some(100.0), Some(200.0)]);
        assert_eq!([0.0, -1.0].map(|value| scale.place(value)), [None; 2]);
    }
}
