//! Coarse readings: positions that a display of a few significant digits shows ten or a hundred times coarser than the others.
//!
//! In: the readings of a position, and where the axis was. Out: from which magnitude on they are coarse, where that matters, and the
//! readings without them. It exists because such a display shows 99.9 mm and then 100 mm: their rounding noise has at
//! least a hundred times the variance of that of the others, and only at some places.
//!
//! It is for positions alone. Where an error is written with few digits, the coarse readings are the largest ones: the effect itself.

use crate::noise::display_step;
use crate::rounded;

/// Readings that are coarser than the others.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Coarse {
    /// From which magnitude on, mm or rad.
    pub(crate) from: f64,
    /// The step of their display.
    pub(crate) step: f64,
    /// That of the others.
    pub(crate) fine: f64,
    /// How many there are.
    pub(crate) count: usize,
}

/// The powers of ten that are tried, in units of the display: from what a probe reads to the longest travel.
const POWERS: std::ops::RangeInclusive<i32> = -3..=5;

/// At least this many different readings must be coarse. One reading of a fine display looks coarse by chance in one of ten cases, and six
/// do in one of a million.
const FEWEST: usize = 6;

/// At least this share of the readings must be left: where most are coarse, they are what there is.
const LEFT: f64 = 0.5;

/// The standard deviation of the coarse rounding must exceed this share of that of the other readings about the position: a third makes
/// their noise a twentieth larger.
const MATTERS: f64 = 1.0 / 3.0;

/// The coarse readings among some, where there are any and their rounding matters. `position` is where the axis was, and `unit` that of
/// the display: mm, or a degree in rad.
pub(crate) fn coarse(values: &[f64], position: &[f64], unit: f64) -> Option<Coarse> {
    let found = POWERS.filter_map(|power| coarse_from(values, unit * 10f64.powi(power)));
    let first = found.min_by(|one, other| one.from.total_cmp(&other.from));
    first.filter(|coarse| rounded::deviation(coarse.step) > MATTERS * coarse.others_off(values, position))
}

/// The readings without the coarse ones.
pub(crate) fn without(values: &[f64], coarse: &Coarse) -> Vec<f64> {
    values.iter().map(|value| if coarse.holds(*value) { f64::NAN } else { *value }).collect()
}

impl Coarse {
    fn holds(&self, value: f64) -> bool {
        value.abs() >= self.from * (1.0 - 1e-9)
    }

    /// How far the other readings are off the position: the standard deviation. Zero where none is known beside it.
    fn others_off(&self, values: &[f64], position: &[f64]) -> f64 {
        let pairs = values.iter().zip(position).filter(|(value, _)| !self.holds(**value));
        let off = pairs.map(|(value, position)| value - position).filter(|off| off.is_finite());
        let off: Vec<f64> = off.collect();
        let count = crate::number(off.len().max(1));
        let mean = off.iter().sum::<f64>() / count;
        (off.iter().map(|off| (off - mean).powi(2)).sum::<f64>() / count).sqrt()
    }
}

fn coarse_from(values: &[f64], from: f64) -> Option<Coarse> {
    let known = values.iter().copied().filter(|value| value.is_finite());
    let mut coarse = Coarse { from, step: 0.0, fine: 0.0, count: 0 };
    let (above, below): (Vec<f64>, Vec<f64>) = known.partition(|value| coarse.holds(*value));
    let enough_left = crate::number(below.len()) >= LEFT * crate::number(above.len() + below.len());
    if !enough_left || different(&above) < FEWEST {
        return None;
    }
    coarse.step = display_step(&above);
    coarse.fine = display_step(&below);
    coarse.count = above.len();
    let digits = (coarse.step / coarse.fine).log10();
    (digits > 0.99 && digits < 2.01 && (digits - digits.round()).abs() < 0.01).then_some(coarse)
}

/// How many different numbers there are, up to the fewest that count.
fn different(values: &[f64]) -> usize {
    let mut seen: Vec<f64> = Vec::new();
    for value in values {
        if seen.len() < FEWEST && !seen.contains(value) {
            seen.push(*value);
        }
    }
    seen.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a display of three significant digits shows of a value from 10 to 1000.
    fn shown(value: f64) -> f64 {
        let step = if value < 99.95 { 0.1 } else { 1.0 };
        (value / step).round() * step
    }

    fn way(from: f64, to: f64) -> Vec<f64> {
        (0..200).map(|row| from + (to - from) * f64::from(row) / 199.0 + 0.013).collect()
    }

    #[test]
    fn readings_of_three_digits_are_coarse_from_a_power_of_ten_on() {
        for (unit, name) in [(1.0, "mm"), (std::f64::consts::PI / 180.0, "deg")] {
            let values: Vec<f64> = way(40.0, 130.0).iter().map(|value| shown(*value) * unit).collect();
            let position: Vec<f64> = way(40.0, 130.0).iter().map(|value| value * unit).collect();
            let found = coarse(&values, &position, unit).unwrap();
            let near = |one: f64, other: f64| (one / other - 1.0).abs() < 1e-6;
            assert!(near(found.from, 100.0 * unit) && near(found.step, unit), "{name} {found:?}");
            assert!(near(found.fine, 0.1 * unit), "{name} {found:?}");
            let left = without(&values, &found);
            assert_eq!(left.iter().filter(|value| value.is_nan()).count(), found.count);
            assert!(left.iter().all(|value| value.is_nan() || value.abs() < 100.0 * unit));
        }
    }

    #[test]
    fn a_display_of_one_step_and_one_that_is_mostly_coarse_have_no_coarse_readings() {
        let even: Vec<f64> = way(40.0, 130.0).iter().map(|value| (value * 10.0).round() / 10.0).collect();
        assert_eq!(coarse(&even, &even, 1.0), None);
        assert_eq!(coarse(&way(40.0, 130.0), &way(40.0, 130.0), 1.0), None);
        let mostly: Vec<f64> = way(80.0, 300.0).iter().map(|value| shown(*value)).collect();
        assert_eq!(coarse(&mostly, &mostly, 1.0), None);
        // Stations at whole millimetres, of which three lie beyond 100 mm.
        let stations: Vec<f64> =
            (0..130).map(|row| f64::from(row / 10 * 10) + 0.2 * f64::from(u8::from(row < 90))).collect();
        assert_eq!(coarse(&stations, &stations, 1.0), None);
    }

    #[test]
    fn rounding_that_is_small_beside_what_the_others_are_off_does_not_matter() {
        let position = way(40.0, 130.0);
        let values: Vec<f64> = position.iter().map(|value| shown(*value)).collect();
        // An error that grows along the travel. The deviation of steps of 1 mm is 0.29 mm. It matters up to 0.87 mm: below 100 mm the
        // travel has a deviation of 17 mm, so that the limit lies near a slope of 0.05.
        for (slope, matters) in [(0.0, true), (0.04, true), (0.06, false), (0.5, false)] {
            let off: Vec<f64> = position.iter().map(|value| value * (1.0 - slope)).collect();
            assert_eq!(coarse(&values, &off, 1.0).is_some(), matters, "{slope}");
        }
        // Without a position at all it does.
        assert!(coarse(&values, &vec![f64::NAN; values.len()], 1.0).is_some());
    }
}
