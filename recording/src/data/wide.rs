//! Tables with a column for each run: their rows come once for each run.
//!
//! In: the columns as they stand. Out: a [`Table`] with a row for each reading, in the order in which they were taken: run
//! after run, each from the first row to the last, and then from the last to the first where there is a way back.

use super::super::{Channel, ChannelPlace};
use super::columns::Table;

/// The columns as they stand in the file; a channel has one, or one for each run and way.
pub(super) struct Rows<'h> {
    /// Time since the first row, s.
    pub(super) time: Vec<f64>,
    /// The run of each row.
    pub(super) run: Vec<i64>,
    /// All other channels.
    pub(super) values: Vec<(&'h Channel, Vec<Vec<f64>>)>,
}

/// How often the rows come.
#[derive(Clone, Copy)]
struct Ways {
    runs: usize,
    back: bool,
}

/// The rows one after another; `step` is the time from one to the next where they come more than once, in s.
pub(super) fn laid_out<'h>(rows: Rows<'h>, step: f64, restarted: Option<(i64, usize)>) -> Table<'h> {
    let ways = rows.values.iter().find_map(|(channel, _)| ways_of(channel));
    let Some(ways) = ways else {
        let values = rows
            .values
            .into_iter()
            .map(|(channel, columns)| (channel, columns.into_iter().next().unwrap_or_default()));
        return Table { time: rows.time, run: rows.run, values: values.collect(), restarted };
    };
    let once = rows.time.len() * if ways.back { 2 } else { 1 };
    let time = (0..once * ways.runs).map(|row| row as f64 * step).collect();
    let run = (1..).take(ways.runs).flat_map(|run| std::iter::repeat_n(run, once)).collect();
    let values = rows.values.into_iter().map(|(channel, columns)| (channel, ways.of(&columns)));
    Table { time, run, values: values.collect(), restarted }
}

fn ways_of(channel: &Channel) -> Option<Ways> {
    match &channel.place {
        ChannelPlace::Runs { columns, back } => Some(Ways { runs: columns.len(), back: !back.is_empty() }),
        _ => None,
    }
}

impl Ways {
    /// The values of a channel in all runs; those of its only column come again in each.
    fn of(self, columns: &[Vec<f64>]) -> Vec<f64> {
        let mut all = Vec::new();
        for run in 0..self.runs {
            let column =
                |number: usize| columns.get(number).or(columns.first()).map_or(&[][..], Vec::as_slice);
            all.extend(column(run));
            if self.back {
                all.extend(column(self.runs + run).iter().rev());
            }
        }
        all
    }
}
