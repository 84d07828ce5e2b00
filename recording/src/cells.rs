//! A line of a table of text. In: the bytes of a line. Out: where its cells stand in it; and whether it is no row of numbers but the row of
//! units, or Excel's line that says what separates the cells.
//!
//! Recordings, the tables of `abbe calibrate`, the positions of `abbe compensate` and `abbe new` all ask here, so that a table means the
//! same everywhere.

use model_dsl::quantity::parse_unit;

/// The separator that stands for any number of spaces and tabs.
pub const SPACES: u8 = b' ';

/// What to do about a row of units that stands where none is read.
pub const BELOW_THE_NAMES: &str = "write the names first, then `#unit` and the units";

/// Finds the cells of a line; a space as the separator stands for any number of spaces and tabs. In quotes a separator is none.
pub fn split(line: &[u8], separator: u8, cells: &mut Vec<(usize, usize)>) {
    cells.clear();
    split_behind(line, 0, separator, cells);
}

/// The same of what stands behind a place in the line.
fn split_behind(line: &[u8], from: usize, separator: u8, cells: &mut Vec<(usize, usize)>) {
    if separator == SPACES {
        return split_at_spaces(line, from, cells);
    }
    let mut start = from;
    let mut quoted = false;
    for (at, &byte) in line.iter().enumerate().skip(from) {
        if byte == b'"' {
            quoted = !quoted;
        } else if byte == separator && !quoted {
            cells.push((start, at));
            start = at + 1;
        }
    }
    cells.push((start, line.len()));
}

fn split_at_spaces(line: &[u8], from: usize, cells: &mut Vec<(usize, usize)>) {
    let mut start = None;
    let mut quoted = false;
    for (at, byte) in line.iter().enumerate().skip(from) {
        quoted ^= *byte == b'"';
        match start {
            Some(begun) if byte.is_ascii_whitespace() && !quoted => {
                cells.push((begun, at));
                start = None;
            }
            None if !byte.is_ascii_whitespace() => start = Some(at),
            _ => {}
        }
    }
    cells.extend(start.map(|begun| (begun, line.len())));
}

/// A cell without white space and quotes around it.
pub fn unquoted(cell: &[u8]) -> &[u8] {
    let cell = cell.trim_ascii();
    let inner = cell.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
    inner.map_or(cell, <[u8]>::trim_ascii)
}

/// Whether a line may be a row of units: `#unit,s,,mm`. In place of `#unit` may stand `# unit`, `#Units` and the like, and a colon behind it.
pub fn may_be_units(line: &[u8]) -> bool {
    Mark::of(line).is_some()
}

/// Whether a line is the row of units of a table with this number of columns.
pub fn is_row_of_units(line: &[u8], separator: u8, columns: usize) -> bool {
    may_be_units(line) && split_units(line, separator, columns, &mut Vec::new())
}

/// Finds the cells of a row of units: the mark `#unit`, then the units. Returns whether the line is the row of units of a table with this
/// number of columns.
///
/// Where no separator stands behind the mark, the line is a row of units only if it has one for each column: else it is a comment.
pub fn split_units(line: &[u8], separator: u8, columns: usize, cells: &mut Vec<(usize, usize)>) -> bool {
    let Some(mark) = Mark::of(line) else { return false };
    cells.clear();
    cells.push((0, mark.end));
    if mark.end < line.len() {
        split_behind(line, mark.end, separator, cells);
    }
    mark.alone || cells.len() == columns.saturating_add(1)
}

/// How many units a row of units has, for how many columns.
pub fn numbers_of_units(units: usize, columns: usize) -> String {
    format!("{} for {}", counted(units, "unit"), counted(columns, "column"))
}

/// What to write in place of a number whose comma may separate thousands as well as decimals, `1,000`; nothing of any other text.
pub fn thousands(text: &str) -> Option<String> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let (first, groups) = digits.split_once(',')?;
    let is = |digits: &str, counts: std::ops::RangeInclusive<usize>| {
        counts.contains(&digits.len()) && digits.bytes().all(|byte| byte.is_ascii_digit())
    };
    let whole = groups.split_once('.').map_or(groups, |(whole, _)| whole);
    let grouped =
        is(first, 1..=3) && !first.starts_with('0') && whole.split(',').all(|group| is(group, 3..=3));
    grouped.then(|| {
        let (without, point) = (text.replace(',', ""), text.replacen(',', ".", 1));
        match point.parse::<f64>() {
            Ok(_) => format!(
                "write `{without}` if the comma separates thousands, `{point}` if it is the decimal sign"
            ),
            Err(_) => format!("write `{without}`, without commas"),
        }
    })
}

/// A number of things in words: `1 cell`, `2 cells`.
pub fn counted(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

/// What a row of units begins with.
struct Mark {
    /// Where the units begin: behind the mark and the separator after it.
    end: usize,
    /// Whether it stands in a cell of its own.
    alone: bool,
}

impl Mark {
    fn of(line: &[u8]) -> Option<Self> {
        let mark = mark_end(line)?;
        let rest = line.get(mark..)?;
        let blank = rest.iter().take_while(|byte| **byte == b' ').count();
        match rest.get(blank) {
            Some(b',' | b';' | b'\t') => Some(Self { end: mark + blank + 1, alone: true }),
            Some(_) => are_units(rest).then_some(Self { end: mark + blank, alone: false }),
            // A word alone is the title of a comment, unless it is written as a mark.
            None => (line == b"#unit").then_some(Self { end: line.len(), alone: true }),
        }
    }
}

/// Where the mark of a row of units ends: `#unit`, letter case, blanks, a plural, a colon and quotes aside.
fn mark_end(line: &[u8]) -> Option<usize> {
    let mut rest = line.trim_ascii_start();
    let quoted = rest.first() == Some(&b'"');
    rest = rest.get(usize::from(quoted)..)?.strip_prefix(b"#")?.trim_ascii_start();
    let (word, behind) = rest.split_at_checked(4)?;
    if !word.eq_ignore_ascii_case(b"unit") {
        return None;
    }
    rest = match behind.first() {
        Some(b's' | b'S') => behind.get(1..)?,
        _ => behind,
    };
    if rest.first().is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_' || !byte.is_ascii()) {
        return None;
    }
    rest = rest.strip_prefix(b":").unwrap_or(rest);
    if quoted {
        rest = rest.trim_ascii_start().strip_prefix(b"\"").unwrap_or(rest);
    }
    Some(line.len() - rest.len())
}

/// Whether all cells are units or empty, and one is a unit.
fn are_units(rest: &[u8]) -> bool {
    let separates = |byte: &u8| matches!(byte, b',' | b';' | b'\t');
    let cells: Vec<&[u8]> = match rest.iter().any(separates) {
        true => rest.split(separates).collect(),
        false => rest.split(|byte| *byte == b' ').collect(),
    };
    let mut cells = cells.into_iter().map(unquoted).filter(|cell| !cell.is_empty()).peekable();
    let is_unit = |cell: &[u8]| std::str::from_utf8(cell).is_ok_and(|cell| parse_unit(cell).is_ok());
    cells.peek().is_some() && cells.all(is_unit)
}

/// The separator that Excel writes into the first line of a table, `sep=;`. `None` if the line is another one.
pub fn told_separator(line: &[u8]) -> Option<u8> {
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    // A tab behind the sign is not white space here.
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    let line = line.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\"")).unwrap_or(line);
    let (word, separator) = line.split_at_checked(4)?;
    match separator {
        [one @ (b',' | b';' | b'\t')] if word.eq_ignore_ascii_case(b"sep=") => Some(*one),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(line: &str, separator: u8, columns: usize) -> Option<Vec<&str>> {
        let mut cells = Vec::new();
        split_units(line.as_bytes(), separator, columns, &mut cells)
            .then(|| cells.iter().skip(1).map(|(start, end)| line[*start..*end].trim()).collect())
    }

    #[test]
    fn a_row_of_units_is_known_however_its_mark_is_written() {
        for line in [
            "#unit,s,,mm",
            "# unit,s,,mm",
            "#Unit,s,,mm",
            "#UNITS,s,,mm",
            "#  Units ,s,,mm",
            "# units: s,,mm",
            "#unit s,,mm",
            "\"#unit\",s,,mm",
            "\"# Units\",s,,mm",
            "#unit:,s,,mm",
        ] {
            assert_eq!(units(line, b',', 3), Some(vec!["s", "", "mm"]), "{line}");
        }
        assert_eq!(units("#unit\t\tmm", b'\t', 2), Some(vec!["", "mm"]));
        assert_eq!(units("# unit s  mm", SPACES, 2), Some(vec!["s", "mm"]));
        assert_eq!(units("#unit\ts\tmm", SPACES, 2), Some(vec!["s", "mm"]));
        assert_eq!(units("#unit", b',', 3), Some(vec![]));
    }

    #[test]
    fn a_comment_about_units_is_a_comment() {
        for line in [
            "# units are those of the controller",
            "#unitary",
            "# unit_x,mm",
            "# Units",
            "# unit 5, second try",
            "unit,s,mm",
            "# the units, mm",
            "# Units: mm",
            "#",
            "",
        ] {
            assert!(!is_row_of_units(line.as_bytes(), b',', 4), "{line}");
        }
    }

    #[test]
    fn a_comma_may_separate_thousands() {
        for (text, told) in [
            (
                "1,000",
                Some("write `1000` if the comma separates thousands, `1.000` if it is the decimal sign"),
            ),
            ("-12,345,678.5", Some("write `-12345678.5`, without commas")),
            ("1,5", None),
            ("0,125", None),
            ("1000,000", None),
            ("1.5", None),
        ] {
            assert_eq!(thousands(text).as_deref(), told, "{text}");
        }
    }

    #[test]
    fn excel_tells_its_separator() {
        for (line, separator) in [
            ("sep=;", Some(b';')),
            ("SEP=,", Some(b',')),
            ("sep=\t", Some(b'\t')),
            ("\"sep=;\"\r", Some(b';')),
            ("\u{feff}sep=;", Some(b';')),
            ("sep=x", None),
            ("sep,x", None),
            ("sep=", None),
        ] {
            assert_eq!(told_separator(line.as_bytes()), separator, "{line:?}");
        }
    }
}
