//! Figures as people read them. In: numbers in mm, rad, deg, s and their ratios. Out: text in um, urad, arcsec, ppm or ms,
//! rounded to its uncertainty.

use crate::diagnosis::Estimate;

/// Whether a number is a size of an error, or a stretch along an axis: the same unit reads differently.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Kind {
    /// A size of an error: micrometres, microradians.
    Error,
    /// A stretch along an axis, a period: millimetres, degrees.
    Travel,
    /// A gain or a frequency: in its own unit.
    Plain,
}

/// A unit for people, and how many of it are one unit of the diagnosis.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Scale {
    factor: f64,
    unit: String,
}

impl Scale {
    fn new(factor: f64, unit: impl Into<String>) -> Self {
        Self { factor, unit: unit.into() }
    }

    /// The unit for numbers of a size in a unit of the diagnosis.
    pub(super) fn of(unit: &str, kind: Kind, size: f64) -> Self {
        let small = match kind {
            Kind::Error => size < 1.0,
            Kind::Travel => size < 0.1,
            Kind::Plain => false,
        };
        match (unit, kind) {
            ("mm", _) if small => Self::new(1e3, "um"),
            ("rad", Kind::Error) if size < 0.01 => Self::new(1e6, "urad"),
            ("rad", _) => Self::new(1f64.to_degrees(), "deg"),
            ("deg", Kind::Error) if size < 0.1 => Self::new(3600.0, "arcsec"),
            ("s", _) if size < 1.0 => Self::new(1e3, "ms"),
            ("s", _) if size >= 600.0 => Self::new(1.0 / 60.0, "min"),
            ("1/s", Kind::Travel) => Self::new(1.0, "Hz"),
            ("mm" | "deg" | "s" | "Hz" | "degC" | "K", _) | (_, Kind::Plain) => Self::new(1.0, unit),
            _ => Self::ratio(unit),
        }
    }

    /// A ratio such as `rad/mm^2`: the error above in um, urad or parts per million, the lengths below in m.
    fn ratio(unit: &str) -> Self {
        let mut parts = unit.split('/');
        let (mut factor, above) = match parts.next().unwrap_or_default() {
            "mm" => (1e3, "um"),
            "rad" => (1e6, "urad"),
            "deg" => (3600.0, "arcsec"),
            "" | "1" => (1e6, "ppm"),
            other => (1.0, other),
        };
        let mut text = above.to_owned();
        for part in parts {
            let (name, power) = part.split_once('^').unwrap_or((part, "1"));
            let lengths = if name == "mm" { power.parse().unwrap_or(1) } else { 0 };
            factor *= 1e3f64.powi(lengths);
            text = format!("{text}/{}", part.replacen("mm", "m", 1));
        }
        Self::new(factor, text)
    }

    /// The ends of many fitted numbers, and the widest of their intervals.
    pub(super) fn between(&self, low: f64, high: f64, half_width: f64) -> String {
        let [low, high, half] = [low, high, half_width].map(|number| number * self.factor);
        match places_of(half) {
            Some(places) => {
                let ends = format!("{} to {}", fixed(low, places), self.with_unit(&fixed(high, places)));
                format!("{ends}, each within {}", self.with_unit(&fixed(half, places)))
            }
            None => format!("{} to {}", significant(low, 3), self.with_unit(&significant(high, 3))),
        }
    }

    fn with_unit(&self, number: &str) -> String {
        if self.unit.is_empty() { number.to_owned() } else { format!("{number} {}", self.unit) }
    }
}

/// A size, such as an rms, in the unit in which people read it, to two significant digits.
pub fn size(value: f64, unit: &str) -> String {
    let scale = Scale::of(unit, Kind::Error, value.abs());
    scale.with_unit(&significant(value * scale.factor, 2))
}

/// Two sizes in one unit, with as many digits as it takes to tell them apart; nothing where one of them is not known.
pub(super) fn change(one: f64, other: f64, unit: &str) -> Option<(String, String)> {
    if !one.is_finite() || !other.is_finite() {
        return None;
    }
    let scale = Scale::of(unit, Kind::Error, one.abs().max(other.abs()));
    let (one, other) = (one * scale.factor, other * scale.factor);
    let digits = (2..6).find(|digits| significant(one, *digits) != significant(other, *digits)).unwrap_or(2);
    Some((scale.with_unit(&significant(one, digits)), scale.with_unit(&significant(other, digits))))
}

/// A number that is given and not fitted.
pub(super) fn given(value: f64, unit: &str, kind: Kind) -> String {
    let scale = Scale::of(unit, kind, value.abs());
    let number = significant(value * scale.factor, 5);
    let shortest =
        if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { &number };
    scale.with_unit(shortest)
}

/// Both ends of a stretch with their unit, to a thousandth of its length.
pub(super) fn stretch(from: f64, to: f64, unit: &str) -> String {
    let scale = Scale::of(unit, Kind::Travel, from.abs().max(to.abs()));
    let (from, to) = (from * scale.factor, to * scale.factor);
    let places = places_of((to - from).abs() / 10.0).unwrap_or(3);
    format!("{} to {}", fixed(from, places), scale.with_unit(&fixed(to, places)))
}

/// A part of the whole in per cent; nothing is called all of it.
pub(super) fn percent(part: f64) -> String {
    match part.clamp(0.0, 1.0) {
        part if part.is_nan() => "an unknown part".to_owned(),
        part if part > 0.995 => "more than 99 %".to_owned(),
        part if part > 0.0 && part < 0.005 => "less than 1 %".to_owned(),
        part => format!("{:.0} %", 100.0 * part),
    }
}

/// A fitted number with its 95 % interval, rounded to two digits of its half width.
pub(super) fn estimate(estimate: &Estimate, kind: Kind) -> String {
    let (low, high) = (estimate.ci95.0.min(estimate.ci95.1), estimate.ci95.0.max(estimate.ci95.1));
    let value = estimate.value;
    let largest =
        [value, low, high].into_iter().filter(|end| end.is_finite()).map(f64::abs).fold(0.0, f64::max);
    let scale = Scale::of(&estimate.unit, kind, largest);
    let [value, low, high] = [value, low, high].map(|number| number * scale.factor);
    let half = (high - low) / 2.0;
    if !value.is_finite() {
        return "not known".to_owned();
    }
    match places_of(half) {
        None => format!(
            "{} (the recordings do not determine its interval)",
            scale.with_unit(&significant(value, 4))
        ),
        Some(places) if ((high + low) / 2.0 - value).abs() > 0.1 * half => {
            let [value, low, high] = [value, low, high].map(|number| fixed(number, places));
            scale.with_unit(&format!("{value} ({low} to {high})"))
        }
        Some(places) => scale.with_unit(&format!("{} +- {}", fixed(value, places), fixed(half, places))),
    }
}

/// An angle in arcseconds beside the microradians; nothing for another unit or a large angle.
pub(super) fn arcseconds(angle: &Estimate) -> Option<String> {
    let small = angle.unit == "rad" && angle.value.abs() < 0.01;
    let degrees = |radians: f64| radians.to_degrees();
    let ci95 = (degrees(angle.ci95.0), degrees(angle.ci95.1));
    let angle = Estimate { value: degrees(angle.value), ci95, unit: "deg".to_owned() };
    small.then(|| estimate(&angle, Kind::Error))
}

/// The decimal places that show two digits of a width; nothing where it has no digits. Negative: tens and hundreds.
fn places_of(width: f64) -> Option<i32> {
    if !width.is_finite() || width <= 0.0 {
        return None;
    }
    // Rounding may add a digit: 0.0996 has two digits as 0.10.
    let first = 1 - exponent(width)?;
    let rounded = (width * 10f64.powi(first)).round() / 10f64.powi(first);
    Some(1 - exponent(rounded)?)
}

/// The power of ten of the first digit.
fn exponent(value: f64) -> Option<i32> {
    // The text has it without the rounding of a logarithm.
    format!("{value:e}").rsplit('e').next()?.parse().ok()
}

/// A number with `digits` significant digits. Its whole digits are all shown, up to four.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    match exponent(value) {
        _ if !value.is_finite() => "unknown".to_owned(),
        Some(exponent) if value != 0.0 => {
            // 12.5 keeps its tenth as 0.60 keeps its hundredth: two digits, three from ten on.
            let digits = if exponent > 0 { digits + 1 } else { digits };
            fixed(value, (digits - 1 - exponent).max(0))
        }
        _ => "0".to_owned(),
    }
}

/// A number with `places` decimal places. Negative places round to tens and hundreds. A number that would need too many is
/// written with a power of ten; a zero has no sign.
fn fixed(value: f64, places: i32) -> String {
    if places > 9 || value.abs() >= 1e9 {
        return format!("{value:.2e}");
    }
    let step = 10f64.powi(-places);
    let value = if places < 0 { (value / step).round() * step } else { value };
    let text = format!("{value:.*}", usize::try_from(places).unwrap_or(0));
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|byte| matches!(byte, b'0' | b'.')) => zero.to_owned(),
        _ => text,
    }
}
