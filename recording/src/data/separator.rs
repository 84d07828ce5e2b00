//! What stands between the cells: a comma, a semicolon or a tab, told by the header row where it can be told.

use super::lines::{split, unquoted};

/// The separators that are tried.
const SEPARATORS: [(u8, &str); 3] = [(b',', "commas"), (b';', "semicolons"), (b'\t', "tabs")];

/// The separator of a header row in which the wanted names stand.
///
/// # Errors
///
/// The names of the separators among which it cannot be told.
pub(super) fn separator_of(header: &[u8], wanted: &[&str]) -> Result<u8, Vec<&'static str>> {
    let parts = SEPARATORS.iter().filter(|(separator, _)| names(header, *separator).len() > 1);
    let parts: Vec<_> = parts.collect();
    match parts.as_slice() {
        [] => return Ok(b','),
        [(only, _)] => return Ok(*only),
        _ => {}
    }
    let found = |separator: u8| {
        let names = names(header, separator);
        wanted.iter().filter(|wanted| names.iter().any(|name| name == *wanted)).count()
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
