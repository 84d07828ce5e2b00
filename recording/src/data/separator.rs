//! What stands between the cells: what the recording file says; else a comma, a semicolon or a tab, told by the first row.

use super::super::cells::{SPACES, split, unquoted};
use super::super::form::{Form, Separator};
use super::layout::places;

/// The separators that are tried.
const SEPARATORS: [(u8, &str); 3] = [(b',', "commas"), (b';', "semicolons"), (b'\t', "tabs")];

impl Separator {
    /// The byte that stands for it.
    fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Spaces => SPACES,
        }
    }
}

/// The separator of a first row in which the wanted names stand.
///
/// # Errors
///
/// The names of the separators among which it cannot be told.
pub(super) fn separator_of(header: &[u8], wanted: &[&str], form: &Form) -> Result<u8, Vec<&'static str>> {
    if let Some(given) = form.separator {
        return Ok(given.byte());
    }
    // What is the decimal sign separates nothing.
    let possible = SEPARATORS.iter().filter(|(separator, _)| !(form.decimal_comma && *separator == b','));
    let parts = possible.filter(|(separator, _)| names(header, *separator).len() > 1);
    let parts: Vec<_> = parts.collect();
    match parts.as_slice() {
        [] => return Ok(if form.decimal_comma { b';' } else { b',' }),
        [(only, _)] => return Ok(*only),
        _ => {}
    }
    let found = |separator: u8| {
        let names = names(header, separator);
        wanted.iter().filter(|wanted| !places(&names, wanted).is_empty()).count()
    };
    let most = parts.iter().map(|(separator, _)| found(*separator)).max().unwrap_or(0);
    let best: Vec<_> = parts.iter().filter(|(separator, _)| found(*separator) == most).collect();
    match best.as_slice() {
        [(only, _)] => Ok(*only),
        several => Err(several.iter().map(|(_, name)| *name).collect()),
    }
}

/// The names of a header row.
pub(super) fn names(header: &[u8], separator: u8) -> Vec<String> {
    let mut cells = Vec::new();
    split(header, separator, &mut cells);
    let cells = cells.into_iter().filter_map(|(start, end)| header.get(start..end));
    cells.map(|cell| String::from_utf8_lossy(unquoted(cell)).replace("\"\"", "\"")).collect()
}
