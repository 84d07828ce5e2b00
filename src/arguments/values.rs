//! Options with a form of their own. In: a word. Out: its numbers, or what to write.

/// The directions X, Y, Z in which the zero of a part is free.
#[derive(Clone, Copy)]
pub(crate) struct Datum {
    /// The directions in which the zero of a part is free.
    pub(crate) displaced: [bool; 3],
    /// Whether the part lies turned as well, as one does that was measured on another machine than it was made on.
    pub(crate) turned: bool,
}

/// `free`, `turned`, `none` or directions.
pub(super) fn datum(text: &str) -> Result<Datum, String> {
    let all = |displaced, turned| Datum { displaced: [displaced; 3], turned };
    match text {
        "free" => return Ok(all(true, false)),
        "turned" => return Ok(all(true, true)),
        "none" => return Ok(all(false, false)),
        _ => {}
    }
    let mut free = [false; 3];
    for word in text.split(',') {
        let place = ["x", "y", "z"].iter().position(|letter| word.trim().eq_ignore_ascii_case(letter));
        match place.and_then(|place| free.get_mut(place)) {
            Some(slot) => *slot = true,
            None => {
                return Err("write `free`, `turned`, `none`, or directions such as `z` or `x,z`".to_owned());
            }
        }
    }
    Ok(Datum { displaced: free, turned: false })
}

/// A number that is zero or more.
pub(super) fn non_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("not a number that is zero or more".to_owned()),
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
    Ok((axis, number(&value)?))
}

/// `X=0:500`.
pub(super) fn range(text: &str) -> Result<(String, [f64; 2]), String> {
    let (axis, value) = name(text)?;
    let (from, to) = value.split_once(':').ok_or("write both ends, as in X=0:500")?;
    Ok((axis, [number(from)?, number(to)?]))
}

fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("`{text}` is not a number"))
}
