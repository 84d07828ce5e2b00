//! The head of a table. In: a file. Out: the names of its columns, and how a recording file says where and how they are written.

use std::path::Path;

use ::recording::cells::{self, SPACES, counted, told_separator};
use ::recording::is_date;

use crate::failure::Failure;
use crate::load;

/// Names of columns stand among the first lines, below what a program says of itself.
const MOST_LINES: usize = 100;

/// The columns of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Their names.
    pub names: Vec<String>,
    /// The line in which they stand, where it is not the first that is no comment.
    pub(super) line: Option<u64>,
    /// Whether spaces stand between them.
    pub(super) spaced: bool,
    /// Whether a comma is the decimal sign.
    pub(super) decimal_comma: bool,
    /// The unit of each of them in the row of units, empty where it has none; nothing where there is no such row.
    pub(super) units: Vec<String>,
    /// Whether each of them holds dates.
    pub(super) dates: Vec<bool>,
}

/// What stands between the cells of a text.
#[derive(Clone, Copy, PartialEq)]
enum Separator {
    Character(u8),
    Spaces,
}

/// What is tried, in this order: where others stand between the cells, a comma may be the decimal sign.
const SEPARATORS: [Separator; 4] =
    [Separator::Character(b';'), Separator::Character(b'\t'), Separator::Character(b','), Separator::Spaces];

/// The columns of the table in a file: of Parquet and workbooks as they say, of a text the last line above the first row of numbers.
///
/// # Errors
///
/// A file that cannot be read, and one in which no names stand above numbers.
pub fn columns(data: &Path) -> Result<Columns, Failure> {
    let head = ::recording::column_names(data).map_err(|error| Failure::wrong(error.to_string()))?;
    if let Some(head) = head {
        let ::recording::ColumnNames { names, line, units, dates } = head;
        return Ok(Columns { names, line, spaced: false, decimal_comma: false, units, dates });
    }
    let head = load::head_of_file(data)?.map_or_else(|| load::bytes(data), Ok)?;
    columns_of(data, &String::from_utf8_lossy(&head))
}

/// The columns of a text that a file holds.
///
/// # Errors
///
/// A text in which no names stand above numbers.
pub(super) fn columns_of(data: &Path, text: &str) -> Result<Columns, Failure> {
    of_text(text).map_err(|wrong| {
        let (what, help) = wrong.told();
        Failure::no(format!("error: {} {what}\nhelp: {help}", data.display()))
    })
}

/// Why a text has no columns.
#[derive(Debug, PartialEq)]
pub(super) enum Wrong {
    /// Nothing stands in it.
    Empty,
    /// The row of units does not stand below the names.
    UnitsAbove,
    /// No row of numbers was found, or none with names above it.
    NoNames,
    /// In columns that are set off by spaces: how many names and how many numbers.
    Spaces(usize, usize),
}

impl Wrong {
    fn told(&self) -> (String, &'static str) {
        match self {
            Self::Empty => ("is empty".to_owned(), "give a table: a row of column names, and rows of numbers below it"),
            Self::UnitsAbove => (
                "has its row of units above the names of its columns".to_owned(),
                cells::BELOW_THE_NAMES,
            ),
            Self::NoNames => (
                "has no row of column names, separated by commas, semicolons, tabs or spaces, above its numbers".to_owned(),
                "write the names above the first row of numbers, such as `t,x_cmd,y_cmd`, without a `#`",
            ),
            Self::Spaces(names, numbers) => (
                format!(
                    "has {} above {}, separated by spaces, so the names of its columns cannot be told",
                    counted(*names, "word"),
                    counted(*numbers, "number")
                ),
                "separate the columns with commas, semicolons or tabs, or write names without spaces",
            ),
        }
    }
}

/// The columns of a text.
pub(super) fn of_text(text: &str) -> Result<Columns, Wrong> {
    let text = text.trim_start_matches('\u{feff}');
    let lines = text.lines().enumerate().take(MOST_LINES);
    let mut lines: Vec<(usize, &str)> = lines.filter(|(_, line)| !line.trim().is_empty()).collect();
    if lines.is_empty() {
        return Err(Wrong::Empty);
    }
    let told = lines.first().and_then(|(_, line)| told_separator(line.as_bytes()));
    if told.is_some() {
        lines.remove(0);
    }
    let tried: Vec<Separator> = match told {
        Some(told) => vec![Separator::Character(told)],
        None => SEPARATORS.to_vec(),
    };
    let (data, separator) = lines
        .iter()
        .enumerate()
        .find_map(|(place, (_, line))| Some((place, separator_of(line, &tried)?)))
        .ok_or(Wrong::NoNames)?;
    let (above, rows) = lines.split_at(data);
    of_parts(above, rows, separator)
}

/// The columns of a text whose rows of numbers begin behind the lines above them; each line has its number, counted from 0.
fn of_parts(above: &[(usize, &str)], rows: &[(usize, &str)], separator: Separator) -> Result<Columns, Wrong> {
    let is_comment = |line: &str| line.starts_with('#') || cells::may_be_units(line.as_bytes());
    let place = above.iter().rposition(|(_, line)| !is_comment(line)).ok_or(Wrong::NoNames)?;
    let (number, header) = *above.get(place).ok_or(Wrong::NoNames)?;
    let names: Vec<String> =
        separator.split(header).into_iter().map(|name| name.replace("\"\"", "\"")).collect();
    let units_of =
        |lines: &[(usize, &str)]| lines.iter().find_map(|(_, line)| separator.units(line, names.len()));
    let (before, below) = above.split_at(place);
    if units_of(before).is_some() {
        return Err(Wrong::UnitsAbove);
    }
    let units = units_of(below);
    let first_row = rows.first().map(|(_, row)| separator.split(row)).unwrap_or_default();
    let spaced = separator == Separator::Spaces;
    if spaced && names.len() != first_row.len() {
        return Err(Wrong::Spaces(names.len(), first_row.len()));
    }
    // A comment between other words and the numbers may hold the names.
    if units.is_none() && below.len() > 1 && names.len() != first_row.len() {
        return Err(Wrong::NoNames);
    }
    let first = above.iter().find(|(_, line)| !is_comment(line)).map(|(first, _)| *first);
    let line = (first != Some(number)).then(|| u64::try_from(number).unwrap_or(u64::MAX).saturating_add(1));
    let decimal_comma = rows.iter().any(|(_, row)| {
        separator.split(row).iter().any(|cell| cell.contains(',') && separator.is_number(cell))
    });
    let dates = first_row.iter().map(|cell| is_date(cell)).collect();
    Ok(Columns { names, line, spaced, decimal_comma, units: units.unwrap_or_default(), dates })
}

/// What separates the cells of a row of numbers. `None` if the line is another one.
fn separator_of(line: &str, tried: &[Separator]) -> Option<Separator> {
    tried.iter().copied().find(|separator| separator.is_of_numbers(line))
}

impl Separator {
    /// The byte that stands for it.
    fn byte(self) -> u8 {
        match self {
            Self::Character(character) => character,
            Self::Spaces => SPACES,
        }
    }

    /// The cells of a line, without the white space and the quotes around them.
    fn split(self, line: &str) -> Vec<&str> {
        let mut ranges = Vec::new();
        cells::split(line.as_bytes(), self.byte(), &mut ranges);
        ranges.into_iter().filter_map(|(start, end)| unquoted(line.get(start..end)?)).collect()
    }

    /// The units, if the line is the row of units of a table with this number of columns.
    fn units(self, line: &str, columns: usize) -> Option<Vec<String>> {
        let mut ranges = Vec::new();
        if !cells::split_units(line.as_bytes(), self.byte(), columns, &mut ranges) {
            return None;
        }
        let units = ranges.into_iter().skip(1).filter_map(|(start, end)| unquoted(line.get(start..end)?));
        Some(units.map(str::to_owned).collect())
    }

    /// Whether a cell is a number, with a point or, where no comma separates cells, with a comma.
    fn is_number(self, cell: &str) -> bool {
        let comma = self != Self::Character(b',') && cell.matches(',').count() == 1 && !cell.contains('.');
        cell.parse::<f64>().is_ok() || comma && cell.replace(',', ".").parse::<f64>().is_ok()
    }

    /// Whether most cells of a line are numbers or dates. Words may stand among them, but not where spaces separate.
    fn is_of_numbers(self, line: &str) -> bool {
        let cells = self.split(line);
        if line.starts_with('#') || cells.len() < 2 {
            return false;
        }
        let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
        let numbers = cells.iter().filter(|cell| self.is_number(cell) || is_date(cell)).count();
        let needed = if self == Self::Spaces { filled } else { filled.div_ceil(2) };
        numbers > 0 && numbers >= needed
    }
}

fn unquoted(cell: &str) -> Option<&str> {
    std::str::from_utf8(cells::unquoted(cell.as_bytes())).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_above_the_first_row_of_numbers() {
        let names = |text: &str| of_text(text).ok().map(|columns| (columns.names.join("|"), columns.line));
        assert_eq!(names("t,x\n0,1\n"), Some(("t|x".to_owned(), None)));
        assert_eq!(names("# a program\n\nt;x\n#unit;s;mm\n0;1\n"), Some(("t|x".to_owned(), None)));
        assert_eq!(names("Spindle test, machine 3\nt,x\n0,1\n"), Some(("t|x".to_owned(), Some(2))));
        assert_eq!(names("when\tx\n2026-07-09T10:00:00\t1\n"), Some(("when|x".to_owned(), None)));
        assert_eq!(names("t,x\n# a note\n0,1\n"), Some(("t|x".to_owned(), None)));
        assert_eq!(
            names("t,\"x, cmd\",\"a \"\"b\"\"\"\n0,1,2\n"),
            Some(("t|x, cmd|a \"b\"".to_owned(), None))
        );
        assert_eq!(
            names("datetime,pv,value\n2026-03-01T08:00:00,m1,1\n"),
            Some(("datetime|pv|value".to_owned(), None))
        );
        assert_eq!(names("sep=;\nt;x\n0;1,5\n"), Some(("t|x".to_owned(), None)));
        assert_eq!(of_text("\n \n"), Err(Wrong::Empty));
        assert_eq!(of_text("# unit,s,mm\nt,x\n0,1\n"), Err(Wrong::UnitsAbove));
        for none in [
            "1,2\n3,4\n",
            "# t,x\n0,1\n",
            "a title\n# t,x\n0,1\n",
            "recording: 1\ntitle: a, b\n",
            "just words, and more",
        ] {
            assert_eq!(of_text(none), Err(Wrong::NoNames), "{none}");
        }
    }

    #[test]
    fn a_comma_is_the_decimal_sign_where_others_separate() {
        let read = |text: &str| of_text(text).map(|columns| (columns.names.join("|"), columns.decimal_comma));
        let european = "Time [s];Run;X [mm];Deviation [um]\n0;1;0,0;-3,61\n1;1;5,0;-3,40\n";
        assert_eq!(read(european), Ok(("Time [s]|Run|X [mm]|Deviation [um]".to_owned(), true)));
        assert_eq!(read("t\tx\n0\t0\n1\t0,5\n"), Ok(("t|x".to_owned(), true)));
        assert_eq!(read("t;x\n0;0.5\n"), Ok(("t|x".to_owned(), false)));
        assert_eq!(read("t,x,note\n0,1,\"a;b\"\n"), Ok(("t|x|note".to_owned(), false)));
    }

    #[test]
    fn spaces_separate_where_nothing_else_does() {
        let read = |text: &str| of_text(text).map(|columns| (columns.names.join("|"), columns.spaced));
        assert_eq!(read("t  x_cmd\n 0  1.5\n"), Ok(("t|x_cmd".to_owned(), true)));
        assert_eq!(read("t x cmd\n0 1.5\n"), Err(Wrong::Spaces(3, 2)));
        assert_eq!(read("on 3 axes\nno 2 numbers\n"), Err(Wrong::NoNames));
    }
}
