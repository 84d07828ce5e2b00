//! Ticks. In: the ends of a range. Out: round numbers that cover it: 1, 2 or 5 times a power of ten; for degrees parts of a
//! turn; for a logarithmic range 1, 2 and 5 of each decade.

/// Round numbers in order with their texts, and the ends of the axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    pub(super) ends: (f64, f64),
    pub(super) values: Vec<f64>,
    pub(super) texts: Vec<String>,
}

/// Beyond this a number is no measurement, and differences of such numbers overflow.
pub(super) const LARGEST: f64 = 1e100;

/// The ends of the numbers that can be drawn; nothing without one.
pub(super) fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.filter(|value| value.abs() <= LARGEST).fold(None, |ends, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((value.min(low), value.max(high)))
    })
}

/// Round numbers from at most `low` to at least `high`, about `most` of them.
pub(super) fn round(low: f64, high: f64, most: usize) -> Ticks {
    let (low, high) = opened(low, high);
    steps(low, high, step(low, high, most))
}

/// The same for what is counted: no ticks between whole numbers.
pub(super) fn whole_steps(low: f64, high: f64, most: usize) -> Ticks {
    let (low, high) = opened(low, high);
    steps(low, high, step(low, high, most).max(1.0))
}

/// The same in degrees: multiples of 15, 30, 45 or 90 where the range is that wide.
pub(super) fn degrees(low: f64, high: f64, most: usize) -> Ticks {
    let (low, high) = opened(low, high);
    let most = count(most);
    let parts = [1.0, 5.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0];
    match parts.into_iter().find(|part| (high - low) / part <= most) {
        Some(part) if high - low >= 4.0 => steps(low, high, part),
        _ => steps(low, high, step(low, high, 6)),
    }
}

/// 1, 2 and 5 of each decade between the ends; decades alone where there are many, the ends themselves where there is none.
pub(super) fn decades(low: f64, high: f64) -> Ticks {
    let known = |end: f64| if end.is_nan() { 1.0 } else { end.clamp(1.0 / LARGEST, LARGEST) };
    let (low, high) = (known(low.min(high)), known(high.max(low)));
    let (low, high) = if high > low * (1.0 + 1e-9) { (low, high) } else { (low / 2.0, high * 2.0) };
    let (first, last) = (low.log10().floor(), high.log10().ceil());
    let parts: &[f64] = if last - first <= 4.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let apart = ((last - first) / 8.0).ceil().max(1.0);
    let mut values = Vec::new();
    let mut decade = first;
    while decade <= last {
        values.extend(parts.iter().map(|part| part * 10f64.powf(decade)));
        decade += apart;
    }
    values.retain(|tick| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(tick));
    if values.len() < 2 {
        values = vec![low, high];
    }
    let texts = values.iter().map(|value| text(*value, places(*value))).collect();
    Ticks { ends: (low, high), values, texts }
}

/// The decimal places that a number of a logarithmic axis needs: those of its first digit, more where it is not round.
fn places(value: f64) -> f64 {
    let first = -(value.log10() + 1e-9).floor();
    let part = value * 10f64.powf(first);
    if (part - part.round()).abs() < 1e-6 { first } else { first + 2.0 }
}

/// Both ends apart: a range of no width is opened around its number.
fn opened(low: f64, high: f64) -> (f64, f64) {
    let known = |end: f64| if end.is_finite() { end.clamp(-LARGEST, LARGEST) } else { 0.0 };
    let (low, high) = (known(low.min(high)), known(high.max(low)));
    let size = low.abs().max(high.abs());
    if high - low > 1e-9 * size && high - low > 1.0 / LARGEST {
        (low, high)
    } else if size > 1.0 / LARGEST {
        (low - 0.1 * size, high + 0.1 * size)
    } else {
        (-1.0, 1.0)
    }
}

/// The smallest round step of which at most so many fit.
pub(super) fn step(low: f64, high: f64, most: usize) -> f64 {
    let rough = (high - low) / count(most);
    let decade = 10f64.powf(rough.log10().floor());
    // A rounded logarithm may be one decade low or high.
    let steps = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0].map(|part| part * decade);
    steps.into_iter().find(|step| *step >= rough * (1.0 - 1e-9)).unwrap_or(10.0 * decade)
}

fn steps(low: f64, high: f64, step: f64) -> Ticks {
    // What rounding alone puts beyond a tick needs no further one.
    let (first, last) = ((low / step + 1e-9).floor(), (high / step - 1e-9).ceil());
    let mut values = Vec::new();
    let mut at = first;
    while at <= last && values.len() < MOST {
        values.push(at * step);
        at += 1.0;
    }
    let places = -(step.log10() + 1e-9).floor();
    let texts = values.iter().map(|value| text(*value, places)).collect();
    let ends = (values.first().copied().unwrap_or(low), values.last().copied().unwrap_or(high));
    Ticks { ends, values, texts }
}

/// More ticks than this nobody reads.
const MOST: usize = 64;

/// A number with so many decimal places; with a power of ten where it is very large or very small.
pub(super) fn text(value: f64, places: f64) -> String {
    let text = if value.abs() >= 1e7 || places > 6.0 {
        if value == 0.0 { "0".to_owned() } else { exponent(value) }
    } else {
        format!("{value:.*}", whole(places))
    };
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|byte| matches!(byte, b'0' | b'.')) => zero.to_owned(),
        Some(size) => format!("\u{2212}{size}"),
        None => text,
    }
}

fn exponent(value: f64) -> String {
    let text = format!("{value:.2e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 6; NaN is 0")]
fn whole(places: f64) -> usize {
    places.clamp(0.0, 6.0) as usize
}

#[expect(clippy::cast_precision_loss, reason = "counts of ticks and series are small")]
pub(super) fn count(number: usize) -> f64 {
    number.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::{decades, degrees, round, text, whole_steps};

    fn is_round(step: f64) -> bool {
        let part = step / 10f64.powf((step.log10() + 1e-9).floor());
        [1.0, 2.0, 5.0].iter().any(|round| (part - round).abs() < 1e-6)
    }

    #[test]
    fn steps_are_round_and_cover_the_range() {
        let mut ends = (-3.7_f64, 1.3e-5_f64);
        for _ in 0..400 {
            ends = (ends.0 * -1.07, ends.1 * 1.09);
            let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
            for most in [2, 5, 8] {
                let ticks = round(low, high, most).values;
                let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
                let width = high - low;
                assert!(first <= low + 1e-8 * width && last >= high - 1e-8 * width, "{low} {high} {ticks:?}");
                assert!(ticks.len() >= 2 && ticks.len() <= most + 2, "{low} {high} {ticks:?}");
                assert!(is_round(ticks[1] - ticks[0]), "{low} {high} {ticks:?}");
            }
        }
    }

    #[test]
    fn degrees_are_parts_of_a_turn() {
        assert_eq!(
            degrees(0.0, 360.0, 8).values,
            [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0, 360.0]
        );
        assert_eq!(degrees(-10.0, 80.0, 8).values[0], -15.0);
        assert_eq!(degrees(0.0, 1.0, 8).texts[1], "0.2");
    }

    #[test]
    fn a_constant_gets_room_on_both_sides() {
        for value in [0.0, 5.0, -2e-7, 1e99] {
            let ticks = round(value, value, 5).values;
            assert!(ticks[0] < value && ticks[ticks.len() - 1] > value, "{value} {ticks:?}");
        }
    }

    #[test]
    fn decades_count_one_two_five_between_the_ends() {
        let ticks = decades(0.03, 4.0);
        assert_eq!((ticks.ends, ticks.texts.join(" ")), ((0.03, 4.0), "0.05 0.1 0.2 0.5 1 2".to_owned()));
        assert_eq!(decades(1e-9, 1e9).values.len(), 7);
        assert_eq!(decades(1.1, 1.2).texts, ["1.10", "1.20"]);
    }

    #[test]
    fn whole_numbers_have_no_ticks_between() {
        assert_eq!(whole_steps(1.0, 2.0, 8).texts, ["1", "2"]);
        assert_eq!(whole_steps(1.0, 100.0, 8).values[1], 20.0);
    }

    #[test]
    fn hostile_ends_still_give_ticks() {
        for (low, high) in
            [(f64::NAN, f64::NAN), (f64::NEG_INFINITY, f64::INFINITY), (-1e308, 1e308), (5e-324, 5e-324)]
        {
            for ticks in [round(low, high, 5), degrees(low, high, 5), decades(low, high)] {
                assert!(ticks.values.len() >= 2 && ticks.values.iter().all(|tick| tick.is_finite()));
            }
        }
    }

    #[test]
    fn numbers_have_the_places_of_their_step() {
        assert_eq!(round(-0.2, 0.4, 4).texts, ["\u{2212}0.2", "0.0", "0.2", "0.4"]);
        assert_eq!(text(2e-9, 9.0), "2e-9");
        assert_eq!(text(-0.0001, 2.0), "0.00");
    }
}
