//! Rows of cells become columns of numbers.

use super::super::{Channel, ChannelKind, ChannelPlace, Header};
use super::cell::BadCell;
use super::clock::{Clock, NotLater};
use super::error::DataError;
use super::stamp::Stamp;
use super::wide;

/// No reading, position, temperature or load is larger, in mm, rad, degC or the load's unit: what is would leave nothing
/// of the sums of squares that everything after this is made of.
const LARGEST: f64 = 1e18;

/// How many cells a row has.
#[derive(Clone, Copy)]
pub(super) enum Width {
    /// As many as the header.
    Exactly(usize),
    /// Those that are read, and others that are not.
    AtLeast(usize),
}

/// One row of a table, cell by cell.
pub(super) trait Cells {
    /// What is wrong where it has not as many cells as it should.
    fn ragged(&self, width: Width) -> Option<DataError>;

    /// The number of a cell; NaN where nothing was measured.
    fn number(&self, index: usize) -> Result<f64, BadCell>;

    /// The time stamp of a cell in the unit of its column.
    fn stamp(&self, index: usize) -> Result<Stamp, BadCell>;

    /// The date in a cell, or the date and the time of day in two.
    fn date(&self, indices: &[usize]) -> Result<Stamp, BadCell>;

    /// The number of a run.
    fn run(&self, index: usize) -> Result<i64, BadCell>;

    /// A cell's text, for messages.
    fn text(&self, index: usize) -> String;

    /// An error at a cell.
    fn error(&self, index: usize, message: String) -> DataError;
}

/// The numbers of all rows so far.
pub(super) struct Columns<'h> {
    name: &'h str,
    width: Width,
    most: usize,
    /// How many numbers a row is in the end.
    numbers: usize,
    clock: Clock,
    time: Option<(&'h [usize], &'h Channel)>,
    run: Option<(usize, &'h Channel)>,
    others: Vec<Column<'h>>,
    time_so_far: Vec<f64>,
    run_so_far: Vec<i64>,
}

/// One column of a channel.
struct Column<'h> {
    channel: &'h Channel,
    cell: usize,
    values: Vec<f64>,
}

/// The columns of a table of data, in mm, rad, s and degC.
pub(super) struct Table<'h> {
    /// Time since the first row.
    pub(super) time: Vec<f64>,
    /// The run of each row; 1 where there is no such channel.
    pub(super) run: Vec<i64>,
    /// All other channels.
    pub(super) values: Vec<(&'h Channel, Vec<f64>)>,
    /// The first run that had a clock of its own, and how many had.
    pub(super) restarted: Option<(i64, usize)>,
}

impl<'h> Columns<'h> {
    /// No rows yet; `most` is the number of numbers that may come.
    ///
    /// `columns` are the numbers of each channel's cells, `width` how many cells a row has.
    pub(super) fn new(
        header: &'h Header,
        columns: &'h [Vec<usize>],
        width: Width,
        name: &'h str,
        most: usize,
    ) -> Self {
        let placed = header.channels.iter().zip(columns);
        let find = |kind: ChannelKind| placed.clone().find(|(channel, _)| channel.kind == kind);
        let time = find(ChannelKind::Time).map(|(channel, cells)| (cells.as_slice(), channel));
        let run = find(ChannelKind::Run).and_then(|(channel, cells)| Some((*cells.first()?, channel)));
        let others =
            placed.filter(|(channel, _)| !matches!(channel.kind, ChannelKind::Time | ChannelKind::Run));
        let others = others.flat_map(|(channel, cells)| {
            cells.iter().map(move |cell| Column { channel, cell: *cell, values: Vec::new() })
        });
        let others: Vec<Column<'_>> = others.collect();
        // A row comes again in each run.
        let ways =
            header.channels.iter().filter(|channel| channel.is_wide()).map(|channel| channel.columns().len());
        let numbers =
            ways.max().map_or(others.len() + 2, |ways| ways.saturating_mul(header.channels.len() + 2));
        let factor = time.map_or(1.0, |(_, channel)| channel.to_internal(1.0));
        Self {
            name,
            width,
            most,
            numbers,
            clock: Clock::new(factor),
            time,
            run,
            others,
            time_so_far: Vec::new(),
            run_so_far: Vec::new(),
        }
    }

    /// Takes one row.
    pub(super) fn take(&mut self, row: &impl Cells) -> Result<(), DataError> {
        if let Some(error) = row.ragged(self.width) {
            return Err(error);
        }
        self.take_time(row)?;
        for column in &mut self.others {
            let number = row.number(column.cell);
            let number = number.map_err(|bad| at_cell(row, &[column.cell], column.channel, bad))?;
            let value = column.channel.to_internal(number);
            if value.abs() > LARGEST {
                let bad = BadCell {
                    message: format!("`{}` is too large", row.text(column.cell)),
                    help: "check the unit of the channel".to_owned(),
                };
                return Err(at_cell(row, &[column.cell], column.channel, bad));
            }
            column.values.push(value);
        }
        Ok(())
    }

    fn take_time(&mut self, row: &impl Cells) -> Result<(), DataError> {
        let run = match self.run {
            None => 1,
            Some((index, channel)) => row.run(index).map_err(|bad| at_cell(row, &[index], channel, bad))?,
        };
        let Some((cells, channel)) = self.time else { return Ok(()) };
        let first = cells.first().copied().unwrap_or_default();
        let rows = self.time_so_far.len();
        let stamp = match &channel.place {
            ChannelPlace::Every => Ok(Stamp::whole(i64::try_from(rows).unwrap_or(i64::MAX))),
            ChannelPlace::Dates(_) => row.date(cells),
            ChannelPlace::Column(_) | ChannelPlace::Runs { .. } => row.stamp(first),
        };
        let stamp = stamp.map_err(|bad| at_cell(row, cells, channel, bad))?;
        if stamp.is_missing() {
            let bad = BadCell {
                message: "the row has no time".to_owned(),
                help: "give every row its time; leave out rows without a measurement".to_owned(),
            };
            return Err(at_cell(row, cells, channel, bad));
        }
        let taken = self.clock.take(stamp, run);
        let time = taken.map_err(|bad| {
            let mut bad = not_later(&bad, &row.text(first), run);
            if self.run.is_some_and(|(run, _)| cells.contains(&run)) {
                bad.help = "give `time` and `run` columns of their own: they are the same column".to_owned();
            }
            at_cell(row, cells, channel, bad)
        })?;
        if (rows + 1).saturating_mul(self.numbers) > self.most {
            let message = format!("the file has more than {} numbers", self.most);
            return Err(row.error(first, message).help("split the recording, or take fewer samples"));
        }
        self.time_so_far.push(time);
        self.run_so_far.push(run);
        Ok(())
    }

    /// All rows; there must be one, and something in every channel.
    pub(super) fn finish(self) -> Result<Table<'h>, DataError> {
        if self.time_so_far.is_empty() {
            return Err(DataError::new(self.name, "there is no row below the header"));
        }
        let mut seen: Vec<(&Channel, bool)> = Vec::new();
        for column in &self.others {
            let something = column.values.iter().any(|value| !value.is_nan());
            match seen.last_mut().filter(|(channel, _)| std::ptr::eq(*channel, column.channel)) {
                Some((_, known)) => *known |= something,
                None => seen.push((column.channel, something)),
            }
        }
        if let Some((channel, _)) = seen.iter().find(|(_, something)| !something) {
            let message = format!("{} is empty", named(channel));
            let help = "remove the channel from the recording file";
            return Err(DataError::new(self.name, message).help(help));
        }
        let mut values: Vec<(&Channel, Vec<Vec<f64>>)> = Vec::new();
        for mut column in self.others {
            // Growing left up to as much room again.
            column.values.shrink_to_fit();
            match values.last_mut().filter(|(channel, _)| std::ptr::eq(*channel, column.channel)) {
                Some((_, columns)) => columns.push(column.values),
                None => values.push((column.channel, vec![column.values])),
            }
        }
        let (mut time, mut run) = (self.time_so_far, self.run_so_far);
        time.shrink_to_fit();
        run.shrink_to_fit();
        let step = self.clock.factor();
        Ok(wide::laid_out(wide::Rows { time, run, values }, step, self.clock.restarted))
    }
}

/// The columns of a channel and its name, for messages.
fn named(channel: &Channel) -> String {
    let columns: Vec<String> = channel.columns().iter().map(|column| format!("`{}`", column.value)).collect();
    format!("column {} (channel `{}`)", columns.join(", "), channel.name.value)
}

fn at_cell(row: &impl Cells, cells: &[usize], channel: &Channel, bad: BadCell) -> DataError {
    let message = match &channel.place {
        // Which of many it is, the place tells.
        ChannelPlace::Runs { .. } => format!("channel `{}`: {}", channel.name.value, bad.message),
        _ => format!("{}: {}", named(channel), bad.message),
    };
    row.error(cells.first().copied().unwrap_or_default(), message).help(bad.help)
}

fn not_later(bad: &NotLater, stamp: &str, run: i64) -> BadCell {
    let before = bad.before;
    if bad.other_clock {
        let message = format!("`{stamp}` follows `{before}`, but only one of them has a time zone");
        return BadCell { message, help: "write all times with a time zone, or all without".to_owned() };
    }
    let message = format!("`{stamp}` follows `{before}`, but time must increase");
    let help = if bad.returned {
        format!("run {run} also has rows further up; give each repeat its own number")
    } else if bad.same {
        "write the time stamps with more decimal places, so that each row has its own".to_owned()
    } else {
        "sort the rows by time; if each repeat has its own clock, number the repeats in a channel `run`"
            .to_owned()
    };
    BadCell { message, help }
}
