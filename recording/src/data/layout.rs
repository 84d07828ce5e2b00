//! The header row and the row of units: where each channel stands.

use std::io::BufRead;

use model_dsl::quantity::{Dimension, Unit, parse_unit, unit_in_name};
use model_dsl::suggest::nearest;

use super::super::cells::{BELOW_THE_NAMES, SPACES, numbers_of_units, told_separator};
use super::super::{Channel, ChannelPlace, Header, Names};
use super::columns::{Cells, Width};
use super::error::{DataError, Place, shown};
use super::lines::{Lines, Row};
use super::separator::{names, separator_of};

/// Where everything stands in a row.
pub(super) struct Layout {
    /// What stands between cells.
    pub(super) separator: u8,
    /// The names of the columns.
    pub(super) names: Vec<String>,
    /// How many cells a row has.
    pub(super) width: Width,
    /// The numbers of each channel's columns, in the order of the channels.
    pub(super) columns: Vec<Vec<usize>>,
    /// What people should know.
    pub(super) notes: Vec<String>,
}

impl Layout {
    /// Reads the header row, and the row of units where there is one. Without a header row the first row tells how many
    /// columns there are, and comes again.
    pub(super) fn read(header: &Header, lines: &mut Lines<'_, impl BufRead>) -> Result<Self, DataError> {
        let name = lines.name();
        let First { line, commented, separator: told } = first_line(header, lines)?;
        let at_header = |message: String| {
            DataError::new(name, message).at(Place::Character { line: lines.number(), column: 1 })
        };
        if line.contains(&0) {
            return Err(
                at_header("the file is not plain text".to_owned()).help("save the table as CSV in UTF-8")
            );
        }
        let wanted: Vec<&str> =
            header.channels.iter().flat_map(Channel::columns).map(|column| column.value.as_str()).collect();
        let separator = told.map_or_else(|| separator_of(&line, &wanted, &header.form), Ok);
        let separator = separator.map_err(|possible| {
            let message = format!(
                "the names are separated by {}, so the separator is ambiguous",
                possible.join(" and ")
            );
            at_header(message)
                .help("separate the columns with commas, and remove the other characters from the names")
        })?;
        let names = match header.form.names {
            Names::Nowhere => (1..=names(&line, separator).len()).map(|number| number.to_string()).collect(),
            Names::FirstRow | Names::Line(_) => names(&line, separator),
        };
        let columns = find_columns(header, &names).map_err(|misfit| {
            let at = misfit.column.map(|column| lines.place(&line, separator, column));
            let mut error = at_header(misfit.message).help(misfit.help);
            error.place = at.or(error.place);
            if let Some(commas) = commas_of_numbers(header, &line, &wanted) {
                return DataError { place: error.place, ..commas.of_file(name) };
            }
            if header.form.names != Names::Nowhere && is_numbers(&names) {
                error = no_header(error, commented.as_deref(), &wanted);
            }
            error
        })?;
        let width = match (separator, header.form.names) {
            // What a program appends to some of its lines is set off by spaces and has no name.
            (SPACES, Names::Nowhere) => {
                Width::AtLeast(columns.iter().flatten().max().map_or(0, |last| last.saturating_add(1)))
            }
            _ => Width::Exactly(names.len()),
        };
        let notes = notes_of_extra(header, name, &names);
        let layout = Self { separator, width, notes, names, columns };
        layout.read_units(header, lines)?;
        Ok(layout)
    }

    /// Reads the row of units: below the names; where there are none, above the numbers, of which the first row comes again.
    fn read_units(&self, header: &Header, lines: &mut Lines<'_, impl BufRead>) -> Result<(), DataError> {
        let nameless = header.form.names == Names::Nowhere;
        if nameless {
            lines.put_back();
        }
        let columns = self.names.len();
        if let Some(above) = lines.units_above(self.separator, columns) {
            if nameless {
                return self.check_units(header, &above);
            }
            let message = "the row of units stands above the names of the columns".to_owned();
            return Err(above.error(0, message).help(BELOW_THE_NAMES));
        }
        if nameless {
            return Ok(());
        }
        match lines.next_units(self.separator, columns)? {
            Some(row) => self.check_units(header, &row),
            None => Ok(()),
        }
    }

    /// Compares a row `#unit,mm,mm` with the units of the recording, which must be the same.
    fn check_units(&self, header: &Header, row: &Row<'_>) -> Result<(), DataError> {
        if row.width() != self.names.len() + 1 {
            let counted = numbers_of_units(row.width().saturating_sub(1), self.names.len());
            let help = "write `#unit` and then one unit for each column, empty if it has none";
            return Err(row.error(0, format!("the row of units has {counted}")).help(help));
        }
        let text = |cell: usize| String::from_utf8_lossy(row.cell(cell)).into_owned();
        same_units(header, (&self.names, &self.columns), text)
            .map_err(|(cell, message)| row.error(cell, message).help(ONE_UNIT))
    }
}

/// The first row of a table.
struct First {
    line: Vec<u8>,
    /// The last comment above it.
    commented: Option<Vec<u8>>,
    /// The separator that a line above it tells.
    separator: Option<u8>,
}

/// The line of the header row, or the first row where there is none; and the last comment above it.
fn first_line(header: &Header, lines: &mut Lines<'_, impl BufRead>) -> Result<First, DataError> {
    let name = lines.name();
    let nothing = || DataError::new(name, "the file is empty").help("begin with a row of column names");
    if let Names::Line(number) = header.form.names {
        let found = lines.skip_to(number)? && lines.next_line()?.is_some();
        if !found || lines.number() != number {
            let error = DataError::new(
                name,
                format!("line {number} should be the header row, but it is missing or empty"),
            );
            return Err(error.help("count all lines, including empty ones"));
        }
        lines.put_back();
        let line = lines.next_line()?.unwrap_or_default().to_vec();
        return Ok(First { line, commented: None, separator: None });
    }
    let (mut commented, mut separator) = (None, None);
    loop {
        let Some(line) = lines.next_line()? else { return Err(nothing()) };
        let line = line.to_vec();
        if lines.number() == 1 && header.form.separator.is_none() && told_separator(&line).is_some() {
            separator = told_separator(&line);
            continue;
        }
        match line.strip_prefix(b"#") {
            Some(comment) => {
                commented = Some(comment.to_vec());
                lines.keep_units();
            }
            None => return Ok(First { line, commented, separator }),
        }
    }
}

/// Compares a row of units, which begins with `#unit` in a cell of its own, with the units of the recording. `text` is what a cell holds.
///
/// # Errors
///
/// The first cell that says otherwise, and what is wrong with it.
pub(super) fn same_units(
    header: &Header,
    (names, columns): (&[String], &[Vec<usize>]),
    text: impl Fn(usize) -> String,
) -> Result<(), (usize, String)> {
    let pairs = header.channels.iter().zip(columns);
    for (channel, column) in pairs.flat_map(|(channel, of)| of.iter().map(move |column| (channel, *column))) {
        let cell = column.saturating_add(1);
        let text = text(cell);
        let same = parse_unit(&text).is_ok_and(|unit| agrees(channel, unit));
        if channel.unit.is_some() && !text.is_empty() && !same {
            return Err((cell, two_units(channel, names.get(column), &text)));
        }
    }
    Ok(())
}

/// Whether a unit in the table is that of the channel. Counts may be of any size, and a date has no unit.
fn agrees(channel: &Channel, found: Unit) -> bool {
    let scaled = channel.scale != 1.0;
    channel.unit.is_none_or(|unit| match &channel.place {
        ChannelPlace::Dates(_) => true,
        _ if scaled => found.dimension == Dimension::COUNT,
        _ => found == unit.value,
    })
}

/// What to do about two units.
pub(super) const ONE_UNIT: &str = "use the same unit in both";

fn two_units(channel: &Channel, column: Option<&String>, found: &str) -> String {
    format!(
        "column `{}` is in `{}` here and in `{}` in the recording file",
        shown(column.map_or("", String::as_str).as_bytes()),
        shown(found.as_bytes()),
        channel.written_unit
    )
}

/// Names that commas separate, in a table whose decimal sign is said to be a comma.
fn commas_of_numbers(header: &Header, line: &[u8], wanted: &[&str]) -> Option<Misfit> {
    let names = names(line, b',');
    let all = wanted.iter().all(|wanted| !places(&names, wanted).is_empty());
    (header.form.decimal_comma && names.len() > 1 && all).then(|| Misfit {
        column: None,
        message: "commas stand between the names, but with `decimal: \",\"` a comma does not separate cells".to_owned(),
        help: "remove `decimal` from the recording file if the numbers have points; else separate the cells with semicolons or tabs"
            .to_owned(),
    })
}

/// What people should know of columns that are kept for them.
pub(super) fn notes_of_extra(header: &Header, name: &str, names: &[String]) -> Vec<String> {
    let lacking = header.extra.iter().filter(|extra| places(names, &extra.column.value).is_empty());
    let notes = lacking.map(|extra| {
        let (column, kept) = (&extra.column.value, &extra.name.value);
        format!("{name} has no column `{column}`, which the recording lists as `{kept}`")
    });
    notes.collect()
}

/// Why the columns are not those of the recording file.
pub(super) struct Misfit {
    /// The number of the column that is wrong, where one is.
    pub(super) column: Option<usize>,
    pub(super) message: String,
    pub(super) help: String,
}

impl Misfit {
    /// The error in a file that does not say where its names stand.
    pub(super) fn of_file(self, name: &str) -> DataError {
        DataError::new(name, self.message).help(self.help)
    }
}

/// The columns of each channel; or what is wrong and what to write.
pub(super) fn find_columns(header: &Header, names: &[String]) -> Result<Vec<Vec<usize>>, Misfit> {
    let wanted = header.channels.iter().flat_map(|channel| {
        channel.columns().into_iter().map(move |column| (channel, column.value.as_str()))
    });
    let missing: Vec<_> = wanted.clone().filter(|(_, column)| places(names, column).is_empty()).collect();
    if let Some((_, first)) = missing.first() {
        let listed: Vec<String> = missing
            .iter()
            .map(|(channel, column)| format!("`{column}` (channel `{}`)", channel.name.value))
            .collect();
        let (verb, plural) = if listed.len() == 1 { ("is", "") } else { ("are", "s") };
        let near = nearest(first, names.iter().map(String::as_str));
        let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let message = format!("there {verb} no column{plural} {}", listed.join(", "));
        let help = format!("{near}the columns are {}", listed_names(names));
        return Err(Misfit { column: None, message, help });
    }
    for (channel, column) in wanted {
        let found = places(names, column);
        if let Some(again) = found.get(1) {
            let message = format!("column `{column}` occurs twice");
            let help = "give each column its own name".to_owned();
            return Err(Misfit { column: Some(*again), message, help });
        }
        let found_place = found.first().copied();
        let name = found_place.and_then(|place| names.get(place));
        if let Some((_, unit, found)) = name.and_then(|name| with_unit(name))
            && !agrees(channel, found)
        {
            let message = two_units(channel, name, unit);
            return Err(Misfit { column: found_place, message, help: ONE_UNIT.to_owned() });
        }
    }
    let columns = header.channels.iter().map(|channel| {
        let columns = channel.columns();
        columns.iter().filter_map(|column| places(names, &column.value).first().copied()).collect()
    });
    Ok(columns.collect())
}

/// The columns with a name; where there is none, those that have a unit behind it, `x [mm]` or `x (mm)`.
pub(super) fn places(names: &[String], wanted: &str) -> Vec<usize> {
    let those = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
        names.iter().enumerate().filter(|(_, name)| is(name)).map(|(number, _)| number).collect()
    };
    let exact = those(&|name| name == wanted);
    if exact.is_empty() {
        return those(&|name| with_unit(name).is_some_and(|(bare, ..)| bare == wanted));
    }
    exact
}

/// A name that ends in a unit in brackets: without it, the unit as it is written, the unit.
fn with_unit(name: &str) -> Option<(&str, &str, Unit)> {
    let (bare, unit) = unit_in_name(name)?;
    parse_unit(unit).ok().map(|found| (bare, unit, found))
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
    let message = "the first row has numbers, not column names".to_owned();
    let text = comment.map(String::from_utf8_lossy).unwrap_or_default();
    let help = if wanted.iter().any(|name| text.contains(name)) {
        "remove the `#` before the names of the columns".to_owned()
    } else {
        format!(
            "write the names of the columns above it, `{}`, or write `data: {{file: ..., header: none}}` and the numbers of the columns in the recording file",
            wanted.join(",")
        )
    };
    DataError { message, help: Some(help), ..error }
}
