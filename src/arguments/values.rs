//! Options with a form of their own. In: a word. Out: its numbers, or what to write.

use workshop::rows::FARTHEST;

/// A number that is zero or more.
pub(super) fn non_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("write a number that is zero or more".to_owned()),
    }
}

/// A whole number in a range.
pub(super) fn whole<T: TryFrom<u64>>(
    from: u64,
    to: u64,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number = text.parse().ok().filter(|number| (from..=to).contains(number));
        let number = number.and_then(|number| T::try_from(number).ok());
        number.ok_or_else(|| match to {
            u64::MAX => format!("write a whole number of at least {from}"),
            _ => format!("write a whole number from {from} to {to}"),
        })
    }
}

/// `X=...`, in two parts.
pub(super) fn name(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((axis, value)) if !axis.is_empty() && !value.is_empty() => {
            Ok((axis.to_owned(), value.to_owned()))
        }
        _ => Err("write an axis and its value, as in X=...".to_owned()),
    }
}

/// `X=120`.
pub(super) fn place(text: &str) -> Result<(String, f64), String> {
    let (axis, value) = name(text)?;
    Ok((axis, reached(&value)?))
}

/// `X=10000`.
pub(super) fn count(text: &str) -> Result<(String, f64), String> {
    let (axis, value) = name(text)?;
    Ok((axis, number(&value)?))
}

/// `X=0:500`.
pub(super) fn range(text: &str) -> Result<(String, [f64; 2]), String> {
    let (axis, value) = name(text)?;
    let (from, to) = value.split_once(':').ok_or("write both ends, as in X=0:500")?;
    Ok((axis, [reached(from)?, reached(to)?]))
}

fn reached(text: &str) -> Result<f64, String> {
    let place = number(text)?;
    if place.abs() > FARTHEST {
        Err(format!("`{text}` is farther than any machine reaches"))
    } else {
        Ok(place)
    }
}

fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("`{text}` is not a number"))
}
