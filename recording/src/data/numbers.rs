//! Tables that are columns of numbers already: a group of rows of Parquet, or what a program has in memory.
//!
//! In: the numbers of the columns that are wanted. Out: their rows, as those of a text would be taken.

use super::super::cells::counted;
use super::super::{ChannelPlace, Header, Recording};
use super::cell::{self, BadCell};
use super::columns::{Cells, Columns, Width};
use super::error::{DataError, Place};
use super::layout::{find_columns, notes_of_extra};
use super::stamp::Stamp;
use super::{MOST_NUMBERS, settle};

impl Header {
    /// Reads the data from columns in memory; `name` is what people call the table. `column` gives the numbers of a column by its number
    /// in `names`, in the unit of its channel, NaN where nothing was measured; it is asked for those alone that a channel reads.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong in it, and what `column` finds wrong.
    pub fn read_columns(
        &self,
        name: &str,
        names: &[String],
        mut column: impl FnMut(usize) -> Result<Vec<f64>, DataError>,
    ) -> Result<Recording, DataError> {
        let wanted = find_columns(self, names).map_err(|misfit| misfit.of_file(name))?;
        let notes = notes_of_extra(self, name, names);
        if let Some(dates) =
            self.channels.iter().find(|channel| matches!(channel.place, ChannelPlace::Dates(_)))
        {
            let message =
                format!("channel `{}` is in dates, but columns in memory must be numbers", dates.name.value);
            return Err(DataError::new(name, message).help("give seconds, and write `unit: s`"));
        }
        let mut columns: Vec<Values> = names.iter().map(|_| Values::Numbers(Vec::new())).collect();
        let mut rows = None;
        for &index in wanted.iter().flatten() {
            let numbers = column(index)?;
            let length = *rows.get_or_insert(numbers.len());
            if numbers.len() != length {
                let column = names.get(index).map_or("", String::as_str);
                let message = format!(
                    "column `{column}` has {}, but others have {length}",
                    counted(numbers.len(), "row")
                );
                return Err(
                    DataError::new(name, message).help("give one number in every row of every column")
                );
            }
            if let Some(slot) = columns.get_mut(index) {
                *slot = Values::Numbers(numbers);
            }
        }
        let mut table = Columns::new(self, &wanted, Width::Exactly(names.len()), name, MOST_NUMBERS);
        Group { name, before: 0, columns }.send_to(&mut table)?;
        settle::settle(self, table.finish()?, name, notes)
    }
}

/// Rows in columns: a list of values for each column that is wanted, an empty one for the others.
pub(super) struct Group<'n> {
    pub(super) name: &'n str,
    /// How many rows stand before it.
    pub(super) before: u64,
    pub(super) columns: Vec<Values>,
}

/// The values of a column: time stamps, or numbers, NaN where there is none.
pub(super) enum Values {
    Stamps(Vec<Stamp>),
    Numbers(Vec<f64>),
}

/// One row of a group.
struct Row<'g> {
    group: &'g Group<'g>,
    row: usize,
}

impl Group<'_> {
    /// Hands over all rows and tells how many they were.
    pub(super) fn send_to(&self, table: &mut Columns<'_>) -> Result<u64, DataError> {
        let rows = self.columns.iter().map(Values::len).max().unwrap_or(0);
        for row in 0..rows {
            table.take(&Row { group: self, row })?;
        }
        Ok(u64::try_from(rows).unwrap_or(u64::MAX))
    }
}

impl Values {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Stamps(stamps) => stamps.len(),
            Self::Numbers(numbers) => numbers.len(),
        }
    }
}

impl Cells for Row<'_> {
    fn ragged(&self, _width: Width) -> Option<DataError> {
        None
    }

    fn number(&self, index: usize) -> Result<f64, BadCell> {
        let value = match self.group.columns.get(index) {
            Some(Values::Numbers(numbers)) => numbers.get(self.row).copied(),
            // A column that is read as time and as something else too.
            Some(Values::Stamps(stamps)) => stamps.get(self.row).map(|stamp| stamp.since(Stamp::whole(0))),
            None => None,
        };
        let value = value.unwrap_or(f64::NAN);
        if value.is_infinite() {
            return Err(BadCell {
                message: "infinity cannot be a measured number".to_owned(),
                help: "leave the cell empty if nothing was measured".to_owned(),
            });
        }
        Ok(value)
    }

    fn stamp(&self, index: usize) -> Result<Stamp, BadCell> {
        match self.group.columns.get(index) {
            Some(Values::Stamps(stamps)) => Ok(stamps.get(self.row).copied().unwrap_or(Stamp::MISSING)),
            _ => self.number(index).map(Stamp::number),
        }
    }

    fn date(&self, indices: &[usize]) -> Result<Stamp, BadCell> {
        let mut stamps = indices.iter().map(|index| self.stamp(*index));
        let first = stamps.next().unwrap_or(Ok(Stamp::MISSING))?;
        stamps.try_fold(first, |date, later| Ok(date.plus(later?)))
    }

    fn run(&self, index: usize) -> Result<i64, BadCell> {
        cell::run(self.text(index).as_bytes())
    }

    fn text(&self, index: usize) -> String {
        if let Some(Values::Stamps(stamps)) = self.group.columns.get(index) {
            return stamps.get(self.row).map(Stamp::to_string).unwrap_or_default();
        }
        match self.number(index) {
            Ok(value) if value.is_nan() => String::new(),
            Ok(value) => value.to_string(),
            Err(_) => "infinity".to_owned(),
        }
    }

    fn error(&self, _index: usize, message: String) -> DataError {
        let row = u64::try_from(self.row).unwrap_or(u64::MAX).saturating_add(1);
        DataError::new(self.group.name, message).at(Place::Row(self.group.before.saturating_add(row)))
    }
}

#[cfg(test)]
mod tests {
    use model_dsl::diagnostic::Diagnostics;
    use model_dsl::source::SourceFile;
    use model_dsl::{compile_word, yaml};

    use super::*;
    use crate::read_header;

    fn header() -> Header {
        let text = "{recording: 1, machine: FX, instrument: position, data: table,
            channels: {time: {column: t, unit: ms}, run: {column: n}, command.x: {column: c, unit: mm},
            measured.x: {column: x, unit: um}}}";
        let mut diagnostics = Diagnostics::new();
        let root = yaml::read(&SourceFile::new("r.yaml", text), &mut diagnostics).unwrap();
        let stage = compile_word("FX", &mut diagnostics).unwrap();
        read_header(&root, &stage.equations, &mut diagnostics).unwrap()
    }

    fn read(columns: &[(&str, &[f64])]) -> Result<Recording, DataError> {
        let names: Vec<String> = columns.iter().map(|(name, _)| (*name).to_owned()).collect();
        header().read_columns("table", &names, |index| Ok(columns[index].1.to_vec()))
    }

    const NAN: f64 = f64::NAN;

    #[test]
    fn columns_in_memory_are_what_their_text_would_be() {
        let columns: [(&str, &[f64]); 5] = [
            ("unread", &[]),
            ("x", &[0.1, NAN, 2000.5]),
            ("t", &[10.0, 12.0, 15.0]),
            ("n", &[1.0, 1.0, 2.0]),
            ("c", &[0.0, 1.0, 2.0]),
        ];
        let read = read(&columns).unwrap();
        let text = "x,t,n,c\n0.1,10,1,0\n,12,1,1\n2000.5,15,2,2\n";
        let told = header().read_csv("table", text.as_bytes()).unwrap();
        // NaN is not equal to itself: the words are.
        assert_eq!(format!("{read:?}"), format!("{told:?}"));
        assert_eq!(read.measured[0].as_deref().map(|x| x[2]), Some(2000.5 * 1e-3));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_row() {
        let with = |x: &[f64], n: &[f64]| {
            let (t, c): (&[f64], &[f64]) = (&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0]);
            read(&[("x", x), ("t", t), ("n", n), ("c", c)]).unwrap_err()
        };
        let infinite = with(&[0.0, f64::INFINITY, 0.0], &[1.0; 3]);
        assert_eq!((infinite.place, infinite.message.contains("infinity")), (Some(Place::Row(2)), true));
        let half = with(&[0.0; 3], &[1.0, 1.5, 2.0]);
        assert_eq!((half.place, half.message.contains("whole number")), (Some(Place::Row(2)), true));
        assert!(with(&[0.0; 2], &[1.0; 3]).message.contains("rows"));
        let missing = read(&[("x", &[0.0]), ("t", &[0.0]), ("n", &[1.0])]).unwrap_err();
        assert!(missing.message.contains("`c` (channel `command.x`)"), "{}", missing.message);
    }
}
