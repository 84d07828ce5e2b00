//! Units, their ratios and products: `um`, `arcsec`, `1/s`, `um/m/K`, `mm/s^2`, `K.s/mm`.

use super::{Dimension, UnitError};
use crate::suggest::nearest;
use std::f64::consts::PI;
use std::ops::Range;

/// A unit: how its numbers become internal values.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unit {
    /// Internal units (mm, rad, s, degC, N, ...) in one of this unit.
    pub factor: f64,
    /// Added to the number before it is multiplied: -32 for degF, -273.15 for K, else 0. Only for a temperature that
    /// stands alone; in ratios and powers it is 0.
    pub offset: f64,
    /// The kind of quantity it measures.
    pub dimension: Dimension,
}

impl Unit {
    /// The internal value of a number in this unit.
    pub fn to_internal(self, number: f64) -> f64 {
        (number + self.offset) * self.factor
    }
}

/// Name, factor, offset and kind of every unit, with its other spellings after it.
const UNITS: [(&str, f64, f64, Dimension); 44] = [
    ("mm", 1.0, 0.0, Dimension::LENGTH),
    ("um", 1e-3, 0.0, Dimension::LENGTH),
    ("\u{b5}m", 1e-3, 0.0, Dimension::LENGTH),
    ("\u{3bc}m", 1e-3, 0.0, Dimension::LENGTH),
    ("nm", 1e-6, 0.0, Dimension::LENGTH),
    ("cm", 10.0, 0.0, Dimension::LENGTH),
    ("m", 1000.0, 0.0, Dimension::LENGTH),
    ("in", 25.4, 0.0, Dimension::LENGTH),
    ("mil", 25.4e-3, 0.0, Dimension::LENGTH),
    ("uin", 25.4e-6, 0.0, Dimension::LENGTH),
    ("\u{b5}in", 25.4e-6, 0.0, Dimension::LENGTH),
    ("\u{3bc}in", 25.4e-6, 0.0, Dimension::LENGTH),
    ("rad", 1.0, 0.0, Dimension::ANGLE),
    ("mrad", 1e-3, 0.0, Dimension::ANGLE),
    ("urad", 1e-6, 0.0, Dimension::ANGLE),
    ("\u{b5}rad", 1e-6, 0.0, Dimension::ANGLE),
    ("\u{3bc}rad", 1e-6, 0.0, Dimension::ANGLE),
    ("deg", PI / 180.0, 0.0, Dimension::ANGLE),
    ("\u{b0}", PI / 180.0, 0.0, Dimension::ANGLE),
    ("arcmin", PI / 10_800.0, 0.0, Dimension::ANGLE),
    ("arcsec", PI / 648_000.0, 0.0, Dimension::ANGLE),
    ("s", 1.0, 0.0, Dimension::TIME),
    ("ms", 1e-3, 0.0, Dimension::TIME),
    ("us", 1e-6, 0.0, Dimension::TIME),
    ("\u{b5}s", 1e-6, 0.0, Dimension::TIME),
    ("\u{3bc}s", 1e-6, 0.0, Dimension::TIME),
    ("ns", 1e-9, 0.0, Dimension::TIME),
    ("min", 60.0, 0.0, Dimension::TIME),
    ("h", 3600.0, 0.0, Dimension::TIME),
    ("Hz", 1.0, 0.0, Dimension::FREQUENCY),
    ("kHz", 1e3, 0.0, Dimension::FREQUENCY),
    ("degC", 1.0, 0.0, Dimension::TEMPERATURE),
    ("\u{b0}C", 1.0, 0.0, Dimension::TEMPERATURE),
    ("K", 1.0, -273.15, Dimension::TEMPERATURE),
    ("mK", 1e-3, -273_150.0, Dimension::TEMPERATURE),
    ("degF", 5.0 / 9.0, -32.0, Dimension::TEMPERATURE),
    ("\u{b0}F", 5.0 / 9.0, -32.0, Dimension::TEMPERATURE),
    ("N", 1.0, 0.0, Dimension::FORCE),
    ("V", 1.0, 0.0, Dimension::VOLTAGE),
    ("A", 1.0, 0.0, Dimension::CURRENT),
    ("%", 1.0, 0.0, Dimension::PERCENT),
    ("count", 1.0, 0.0, Dimension::COUNT),
    ("counts", 1.0, 0.0, Dimension::COUNT),
    ("1", 1.0, 0.0, Dimension::NONE),
];

/// The units' usual names, for help lines and manuals.
pub const UNIT_NAMES: &str = "mm, um, nm, cm, m, in, mil, uin; rad, mrad, urad, deg, arcmin, arcsec; s, ms, us, ns, min, h; Hz; \
                              degC, K, mK, degF; N; V, A, %, count; and ratios such as 1/s, um/m/K or mm/min";

/// Words that people write for a unit, and the unit.
const WORDS: [(&str, &str); 28] = [
    ("c", "degC"),
    ("celsius", "degC"),
    ("f", "degF"),
    ("fahrenheit", "degF"),
    ("kelvin", "K"),
    ("inch", "in"),
    ("inches", "in"),
    ("\"", "in"),
    ("\"", "arcsec"),
    ("'", "arcmin"),
    ("thou", "mil"),
    ("micron", "um"),
    ("microns", "um"),
    ("micrometer", "um"),
    ("u", "um"),
    ("sec", "s"),
    ("seconds", "s"),
    ("minutes", "min"),
    ("hour", "h"),
    ("hours", "h"),
    ("hr", "h"),
    ("usec", "us"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("\u{2033}", "arcsec"),
    ("as", "arcsec"),
    ("percent", "%"),
    ("newton", "N"),
];

/// The unit that a word names, letter case aside.
pub fn unit_name(word: &str) -> Option<&'static str> {
    let names = || UNITS.iter().map(|(name, ..)| *name);
    names().find(|name| *name == word).or_else(|| names().find(|name| name.eq_ignore_ascii_case(word)))
}

/// The unit that people mean by a word: `inch`, `microns`; or that it names.
pub fn unit_of_word(word: &str) -> Option<&'static str> {
    let lower = word.to_lowercase();
    let meant = WORDS.iter().find(|(known, _)| *known == lower).map(|(_, unit)| *unit);
    meant.or_else(|| unit_name(word))
}

/// The unit of one kind that people may mean by a word that is none: one that they use for it, or the nearest.
pub(super) fn meant(word: &str, kind: Dimension) -> Option<&'static str> {
    let names = || UNITS.iter().filter(|(.., dimension)| *dimension == kind).map(|(name, ..)| *name);
    let lower = word.to_lowercase();
    let words = WORDS.iter().filter(|(known, _)| *known == lower).map(|(_, unit)| *unit);
    words.into_iter().find(|unit| names().any(|name| name == *unit)).or_else(|| nearest(word, names()))
}

/// Reads a unit: a name, or names divided by one another, each with an optional power (`mm/s^2`). What stands above the line
/// may be a product (`K.s/mm`, `K*s/mm`).
///
/// # Errors
///
/// E0304 for a name that is not a unit, with the nearest one; E0305 for a unit that is badly put together.
pub fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let mut parts = text.split('/').peekable();
    let single = text.matches('/').count() == 0;
    let mut start = 0;
    let mut unit: Option<Unit> = None;
    while let Some(part) = parts.next() {
        let first = unit.is_none();
        let last = parts.peek().is_none();
        unit = Some(match unit {
            None => product(part, start, first && !last)?,
            Some(above) => divide(above, trimmed_base(part, start, false)?),
        });
        start += part.len() + 1;
    }
    let unit = unit.ok_or_else(|| incomplete(0..text.len()))?;
    Ok(if single { unit } else { Unit { offset: 0.0, ..unit } })
}

/// Reads `K` or `K.s`.
fn product(text: &str, start: usize, one_allowed: bool) -> Result<Unit, UnitError> {
    let mut start = start;
    let mut product: Option<Unit> = None;
    for part in text.split(PRODUCT) {
        let found = trimmed_base(part, start, one_allowed)?;
        product = Some(match product {
            None => found,
            Some(before) => Unit {
                factor: before.factor * found.factor,
                offset: 0.0,
                dimension: before.dimension.times(found.dimension),
            },
        });
        start += part.len() + 1;
    }
    product.ok_or_else(|| incomplete(start..start + text.len()))
}

/// What stands between the units of a product; one byte each.
const PRODUCT: [char; 2] = ['.', '*'];

/// Reads a unit with its power, whatever white space is around it.
fn trimmed_base(text: &str, start: usize, one_allowed: bool) -> Result<Unit, UnitError> {
    let name_start = start + (text.len() - text.trim_start().len());
    power_of_base(text.trim(), name_start, one_allowed)
}

fn divide(above: Unit, below: Unit) -> Unit {
    Unit { factor: above.factor / below.factor, offset: 0.0, dimension: above.dimension.per(below.dimension) }
}

/// Reads `s`, `s^2` or `s\u{b2}`; a `1` only where something is divided by it.
fn power_of_base(text: &str, start: usize, one_allowed: bool) -> Result<Unit, UnitError> {
    let (name, power) = split_power(text);
    if name.is_empty() || (name == "1" && !one_allowed) {
        return Err(incomplete(start..start + text.len()));
    }
    let Some(power) = power else {
        let message = format!("`{text}` has an exponent that is not a whole number from 1 to 4");
        return Err(UnitError::new("E0305", start..start + text.len(), message).help("write `s^2` or `1/s`"));
    };
    let base = base_unit(name).ok_or_else(|| unknown(name, start..start + name.len()))?;
    if power == 1 {
        return Ok(base);
    }
    Ok(Unit {
        factor: base.factor.powi(i32::from(power)),
        offset: 0.0,
        dimension: base.dimension.power(power),
    })
}

/// A name and its power, 1 where none is written; no power where what is written is none.
fn split_power(text: &str) -> (&str, Option<i8>) {
    if let Some(name) = text.strip_suffix('\u{b2}') {
        return (name, Some(2));
    }
    match text.split_once('^') {
        None => (text, Some(1)),
        Some((name, power)) => {
            let power = power.parse().ok().filter(|power| (1..=4).contains(power));
            (name, power)
        }
    }
}

fn base_unit(name: &str) -> Option<Unit> {
    let found = UNITS.iter().find(|(known, ..)| *known == name)?;
    let &(_, factor, offset, dimension) = found;
    Some(Unit { factor, offset, dimension })
}

fn incomplete(range: Range<usize>) -> UnitError {
    let error = UnitError::new("E0305", range, "missing unit");
    error.help("write a unit such as `um`, or a ratio such as `1/s` or `um/m/K`")
}

fn unknown(name: &str, range: Range<usize>) -> UnitError {
    let error = UnitError::new("E0304", range, format!("unknown unit `{name}`"));
    match unit_of_word(name).or_else(|| nearest(name, UNITS.iter().map(|(known, ..)| *known))) {
        Some(unit) => error.help(format!("did you mean `{unit}`?")),
        None => error.help(format!("use one of the units {UNIT_NAMES}")),
    }
}
