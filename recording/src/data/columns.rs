//! Rows of cells become columns of numbers.

use super::super::{Channel, ChannelKind, Header};
use super::cell::BadCell;
use super::clock::{Clock, NotLater};
use super::error::DataError;

/// No reading, position, temperature or load is larger, in mm, rad, degC or the load's unit: what is would leave nothing
/// of the sums of squares that everything after this is made of.
const LARGEST: f64 = 1e18;

/// One row of a table, cell by cell.
pub(super) trait Cells {
    /// What is wrong where it has not as many cells as the header.
    fn ragged(&self, width: usize) -> Option<DataError>;

    /// The number of a cell; NaN where nothing was measured.
    fn number(&self, index: usize) -> Result<f64, BadCell>;

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
    width: usize,
    most: usize,
    clock: Clock,
    time: Option<(usize, &'h Channel)>,
    run: Option<(usize, &'h Channel)>,
    others: Vec<Column<'h>>,
    table: Table<'h>,
}

struct Column<'h> {
    channel: &'h Channel,
    cell: usize,
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
    /// `columns` is the number of each channel's cell, `width` how many cells a row has.
    pub(super) fn new(
        header: &'h Header,
        columns: &[usize],
        width: usize,
        name: &'h str,
        most: usize,
    ) -> Self {
        let placed = header.channels.iter().zip(columns).map(|(channel, cell)| (*cell, channel));
        let find = |kind: ChannelKind| placed.clone().find(|(_, channel)| channel.kind == kind);
        let (time, run) = (find(ChannelKind::Time), find(ChannelKind::Run));
        let others =
            placed.filter(|(_, channel)| !matches!(channel.kind, ChannelKind::Time | ChannelKind::Run));
        let others: Vec<_> = others.map(|(cell, channel)| Column { channel, cell }).collect();
        let factor = time.and_then(|(_, channel)| channel.unit).map_or(1.0, |unit| unit.value.factor);
        let values = others.iter().map(|column| (column.channel, Vec::new())).collect();
        Self {
            name,
            width,
            most,
            clock: Clock::new(factor),
            time,
            run,
            others,
            table: Table { time: Vec::new(), run: Vec::new(), values, restarted: None },
        }
    }

    /// Takes one row.
    pub(super) fn take(&mut self, row: &impl Cells) -> Result<(), DataError> {
        if let Some(error) = row.ragged(self.width) {
            return Err(error);
        }
        self.take_time(row)?;
        for (column, (_, values)) in self.others.iter().zip(&mut self.table.values) {
            let number = row.number(column.cell);
            let number = number.map_err(|bad| at_cell(row, column.cell, column.channel, bad))?;
            let value = column.channel.to_internal(number);
            if value.abs() > LARGEST {
                let bad = BadCell {
                    message: format!("`{}` is too large a number", row.text(column.cell)),
                    help: "look at the unit of the channel".to_owned(),
                };
                return Err(at_cell(row, column.cell, column.channel, bad));
            }
            values.push(value);
        }
        Ok(())
    }

    fn take_time(&mut self, row: &impl Cells) -> Result<(), DataError> {
        let run = match self.run {
            None => 1,
            Some((index, channel)) => row.run(index).map_err(|bad| at_cell(row, index, channel, bad))?,
        };
        let Some((index, channel)) = self.time else { return Ok(()) };
        let stamp = row.number(index).map_err(|bad| at_cell(row, index, channel, bad))?;
        if stamp.is_nan() {
            let bad = BadCell {
                message: "the row has no time".to_owned(),
                help: "every row needs its time; leave out rows at which nothing was measured".to_owned(),
            };
            return Err(at_cell(row, index, channel, bad));
        }
        let taken = self.clock.take(stamp, run);
        let time =
            taken.map_err(|bad| at_cell(row, index, channel, not_later(&bad, &row.text(index), run)))?;
        let numbers = (self.table.time.len() + 1).saturating_mul(self.others.len() + 2);
        if numbers > self.most {
            let message = format!("the file holds more than {} numbers", self.most);
            return Err(row.error(index, message).help("split the recording, or take fewer samples"));
        }
        self.table.time.push(time);
        self.table.run.push(run);
        Ok(())
    }

    /// All rows; there must be one, and something in every channel.
    pub(super) fn finish(mut self) -> Result<Table<'h>, DataError> {
        if self.table.time.is_empty() {
            return Err(DataError::new(self.name, "there is no row under the header"));
        }
        for (channel, values) in &self.table.values {
            if values.iter().all(|value| value.is_nan()) {
                let message =
                    format!("column `{}` (channel `{}`) is empty", channel.column.value, channel.name.value);
                let help = "leave the channel out of the recording file";
                return Err(DataError::new(self.name, message).help(help));
            }
        }
        // Growing left up to as much room again.
        self.table.time.shrink_to_fit();
        self.table.run.shrink_to_fit();
        self.table.values.iter_mut().for_each(|(_, values)| values.shrink_to_fit());
        self.table.restarted = self.clock.restarted;
        Ok(self.table)
    }
}

fn at_cell(row: &impl Cells, index: usize, channel: &Channel, bad: BadCell) -> DataError {
    let message =
        format!("column `{}` (channel `{}`): {}", channel.column.value, channel.name.value, bad.message);
    row.error(index, message).help(bad.help)
}

fn not_later(bad: &NotLater, stamp: &str, run: i64) -> BadCell {
    let before = bad.before;
    let message = format!("`{stamp}` comes after `{before}`, and time must increase");
    let help = if bad.returned {
        format!("run {run} has rows further up: give each repeat its own number")
    } else if bad.same {
        "write the time stamps with more decimal places, one for each row".to_owned()
    } else {
        "sort the rows by time; where repeats have clocks of their own, number them in a channel `run`"
            .to_owned()
    };
    BadCell { message, help }
}
