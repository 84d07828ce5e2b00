//! The header row and the row of units: where each channel stands.

use std::io::BufRead;

use model_dsl::quantity::parse_unit;
use model_dsl::suggest::nearest;

use super::super::{Channel, Header};
use super::columns::Cells;
use super::error::{DataError, Place, shown};
use super::lines::{Lines, Row};
use super::separator::{names, separator_of};

/// Where everything stands in a row.
pub(super) struct Layout {
    /// What stands between cells.
    pub(super) separator: u8,
    /// The names of the columns.
    pub(super) names: Vec<String>,
    /// The number of each channel's column, in the order of the channels.
    pub(super) columns: Vec<usize>,
    /// What people should know.
    pub(super) notes: Vec<String>,
}

impl Layout {
    /// Reads the header row, and the row of units where there is one.
    pub(super) fn read(header: &Header, lines: &mut Lines<'_, impl BufRead>) -> Result<Self, DataError> {
        let name = lines.name();
        let mut commented = None;
        let line = loop {
            let Some(line) = lines.next_line()? else {
                return Err(
                    DataError::new(name, "the file is empty").help("begin with a row of column names")
                );
            };
            match line.strip_prefix(b"#") {
                Some(comment) => commented = Some(comment.to_vec()),
                None => break line.to_vec(),
            }
        };
        let at_header = |message: String| {
            DataError::new(name, message).at(Place::Character { line: lines.number(), column: 1 })
        };
        if line.starts_with(&[0xff, 0xfe]) || line.starts_with(&[0xfe, 0xff]) || line.contains(&0) {
            return Err(
                at_header("the file is not plain text".to_owned()).help("save the table as CSV in UTF-8")
            );
        }
        let wanted: Vec<&str> = header.channels.iter().map(|channel| channel.column.value.as_str()).collect();
        let separator = separator_of(&line, &wanted).map_err(|possible| {
            let message =
                format!("{} stand between the names: what separates the columns?", possible.join(" and "));
            at_header(message).help("separate the columns with commas, and take the others out of the names")
        })?;
        let names = names(&line, separator);
        let columns = find_columns(header, &names).map_err(|(message, help)| {
            let mut error = at_header(message).help(help);
            if is_numbers(&names) {
                error = no_header(error, commented.as_deref(), &wanted);
            }
            error
        })?;
        let layout = Self { separator, notes: notes_of_extra(header, name, &names), names, columns };
        layout.check_units(header, lines)?;
        Ok(layout)
    }

    /// Reads a row `#unit,mm,mm`, whose units must be those of the recording.
    fn check_units(&self, header: &Header, lines: &mut Lines<'_, impl BufRead>) -> Result<(), DataError> {
        match lines.next_line()? {
            Some(line) if line.starts_with(b"#unit") => {}
            Some(_) => {
                lines.put_back();
                return Ok(());
            }
            None => return Ok(()),
        }
        lines.put_back();
        let Some(row) = lines.next_cells(self.separator)? else { return Ok(()) };
        if row.width() != self.names.len() + 1 {
            let message = format!(
                "the row of units has {} units for {} columns",
                row.width().saturating_sub(1),
                self.names.len()
            );
            let help = "write `#unit` and then one unit for each column, empty where it has none";
            return Err(row.error(0, message).help(help));
        }
        let mut pairs = header.channels.iter().zip(&self.columns);
        pairs.try_for_each(|(channel, column)| same_unit(channel, column + 1, &row))
    }
}

fn same_unit(channel: &Channel, cell: usize, row: &Row<'_>) -> Result<(), DataError> {
    let text = String::from_utf8_lossy(row.cell(cell)).into_owned();
    let Some(unit) = channel.unit.filter(|_| !text.is_empty()) else { return Ok(()) };
    if parse_unit(&text).is_ok_and(|found| found == unit.value) {
        return Ok(());
    }
    let message = format!(
        "column `{}` is in `{}` here and in `{}` in the recording file",
        channel.column.value,
        shown(text.as_bytes()),
        channel.written_unit
    );
    Err(row.error(cell, message).help("let both say the same"))
}

/// What people should know of columns that are kept for them.
pub(super) fn notes_of_extra(header: &Header, name: &str, names: &[String]) -> Vec<String> {
    let lacking = header.extra.iter().filter(|extra| !names.contains(&extra.column.value));
    let notes = lacking.map(|extra| {
        let (column, kept) = (&extra.column.value, &extra.name.value);
        format!("{name} has no column `{column}`, which the recording keeps as `{kept}`")
    });
    notes.collect()
}

/// The column of each channel; or what is wrong and what to write.
pub(super) fn find_columns(header: &Header, names: &[String]) -> Result<Vec<usize>, (String, String)> {
    let place = |channel: &Channel| names.iter().position(|name| *name == channel.column.value);
    let missing: Vec<&Channel> = header.channels.iter().filter(|channel| place(channel).is_none()).collect();
    if let Some(first) = missing.first() {
        let listed: Vec<String> = missing
            .iter()
            .map(|channel| format!("`{}` (channel `{}`)", channel.column.value, channel.name.value))
            .collect();
        let (verb, plural) = if listed.len() == 1 { ("is", "") } else { ("are", "s") };
        let near = nearest(&first.column.value, names.iter().map(String::as_str));
        let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let message = format!("there {verb} no column{plural} {}", listed.join(", "));
        return Err((message, format!("{near}the columns are {}", listed_names(names))));
    }
    let twice = |channel: &&Channel| names.iter().filter(|name| **name == channel.column.value).count() > 1;
    if let Some(channel) = header.channels.iter().find(twice) {
        let message = format!("column `{}` stands twice", channel.column.value);
        return Err((message, "give each column its own name".to_owned()));
    }
    Ok(header.channels.iter().filter_map(place).collect())
}

fn listed_names(names: &[String]) -> String {
    const MOST: usize = 24;
    let shown_names: Vec<String> = names.iter().take(MOST).map(|name| shown(name.as_bytes())).collect();
    let more = if names.len() > MOST { format!(" and {} more", names.len() - MOST) } else { String::new() };
    format!("{}{more}", shown_names.join(", "))
}

fn is_numbers(names: &[String]) -> bool {
    names.iter().all(|name| name.is_empty() || name.replace(',', ".").parse::<f64>().is_ok())
}

fn no_header(error: DataError, comment: Option<&[u8]>, wanted: &[&str]) -> DataError {
    let message = "the first row is a row of numbers, not of column names".to_owned();
    let text = comment.map(String::from_utf8_lossy).unwrap_or_default();
    let help = if wanted.iter().any(|name| text.contains(name)) {
        "take away the `#` before the names of the columns".to_owned()
    } else {
        format!("write the names of the columns above it, `{}`", wanted.join(","))
    };
    DataError { message, help: Some(help), ..error }
}
