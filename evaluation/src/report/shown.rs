//! The unit and the digits in which people read values. In: the values that stand together. Out: one unit for all of them, with as many
//! decimals as the finest of them needs.
//!
//! A stage that repeats to a nanometre and a table that was turned by degrees are both evaluated: um and arcsec with two decimals
//! would hide the one and bury the other.

use crate::figure::{Figure, Unit};
use crate::positioning::Positioning;

/// How values are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    /// The unit's name.
    pub(super) unit: &'static str,
    /// How many of it are in a mm, or in a rad.
    scale: f64,
    /// Decimals.
    digits: usize,
}

/// Where all values are below it, lengths stand in nm, mm: an um with two decimals would have two digits of the largest.
const NANOMETRES: f64 = 1e-3;

/// Where one value is above it, angles stand in deg, rad: from a degree on, arc seconds have five digits before the point.
const DEGREES: f64 = 1.0 / 180.0 * std::f64::consts::PI;

/// The decimals of a value in degrees: 1e-6 deg are 0.0036 arcsec.
const OF_DEGREES: usize = 6;

/// The decimals at least, of all other units.
const LEAST: usize = 2;

/// The decimals at most: 1e-4 um are a tenth of a nanometre.
const MOST: usize = 4;

impl Shown {
    /// For values up to a size, the finest of which has two digits at least.
    fn new(unit: Unit, greatest: f64, finest: f64) -> Self {
        let (name, scale) = match unit {
            Unit::Length if greatest > 0.0 && greatest < NANOMETRES => ("nm", 1e6),
            Unit::Angle if greatest > DEGREES => unit.coarse(),
            _ => unit.fine(),
        };
        if name == "deg" {
            return Self { unit: name, scale, digits: OF_DEGREES };
        }
        // The fewest decimals that show the second digit of the finest value.
        let enough = (LEAST..MOST).find(|digits| finest * scale * tens(*digits) >= 10.0);
        Self { unit: name, scale, digits: if finest > 0.0 { enough.unwrap_or(MOST) } else { LEAST } }
    }

    /// For figures that stand together; the finest are the repeatabilities.
    pub(super) fn figures(figures: &[Figure]) -> Self {
        let value = |figure: &Figure| Some(figure.value.number()?.abs());
        let repeats = figures.iter().filter(|figure| figure.symbol.starts_with('R')).filter_map(value);
        let unit = figures.first().map_or(Unit::Length, |figure| figure.unit);
        Self::new(unit, greatest(figures.iter().filter_map(value)), least(repeats))
    }

    /// For the targets of a line.
    pub(super) fn targets(line: &Positioning) -> Self {
        let sides = line.targets.iter().flat_map(|target| [target.up, target.down]).flatten();
        let means = sides.clone().map(|side| side.mean.abs());
        Self::new(line.unit, greatest(means), least(sides.filter_map(|side| side.s)))
    }

    /// The number, without a sign for what rounds to nothing.
    pub(super) fn number(self, value: f64) -> String {
        let text = format!("{:.*}", self.digits, value * self.scale);
        let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
        if is_zero { text.trim_start_matches('-').to_owned() } else { text }
    }
}

/// A power of ten.
fn tens(power: usize) -> f64 {
    (0..power).fold(1.0, |value, _| value * 10.0)
}

fn greatest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// The least of what is more than zero; zero where there is none.
fn least(values: impl Iterator<Item = f64>) -> f64 {
    let least = values.filter(|value| *value > 0.0).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_the_size_and_digits_the_finest_value() {
        // Greatest and finest value, mm or rad; then 12.3456 um, or 10 arcsec and 3 deg.
        let of = |unit, greatest, finest, value: f64| {
            let shown = Shown::new(unit, greatest, finest);
            format!("{} {}", shown.number(value), shown.unit)
        };
        let length = Unit::Length;
        assert_eq!(of(length, 20e-3, 1e-3, 12.3456e-3), "12.35 um");
        // A repeatability of 12 nm beside an error of 2 um: two digits of it.
        assert_eq!(of(length, 2e-3, 12e-6, 12.3e-6), "0.012 um");
        assert_eq!(of(length, 2e-3, 1.2e-6, 1.23e-6), "0.0012 um");
        // A nanometre stage.
        assert_eq!(of(length, 40e-6, 5e-6, 12.34e-6), "12.34 nm");
        assert_eq!(of(length, 0.0, 0.0, -1e-12), "0.00 um");
        let arcsec = std::f64::consts::PI / 180.0 / 3600.0;
        assert_eq!(of(Unit::Angle, 30.0 * arcsec, arcsec, 10.0 * arcsec), "10.00 arcsec");
        // 16101 arcsec are 4.4725 deg.
        assert_eq!(of(Unit::Angle, 16101.0 * arcsec, arcsec, 16101.0 * arcsec), "4.472500 deg");
    }
}
