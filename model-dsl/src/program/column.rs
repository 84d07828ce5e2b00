//! Values of many rows at once. In: columns, or single numbers that hold in every row. Out: their sums and products,
//! row by row, with the same bits that single numbers would give.

use std::borrow::Cow;

/// What a value is in every row of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Column<'c> {
    /// The same number in every row.
    Same(f64),
    /// A number for each row.
    Rows(Cow<'c, [f64]>),
}

impl Column<'_> {
    /// The value in a row; NaN past the last one of a column.
    pub fn at(&self, row: usize) -> f64 {
        match self {
            Self::Same(value) => *value,
            Self::Rows(values) => values.get(row).copied().unwrap_or(f64::NAN),
        }
    }

    /// The column written out: so many rows where the value is the same in all.
    pub fn written_out(self, rows: usize) -> Vec<f64> {
        match self {
            Self::Same(value) => vec![value; rows],
            Self::Rows(values) => values.into_owned(),
        }
    }

    /// One operation on the value of each row.
    pub(super) fn map(&self, room: &mut Room, operation: impl Fn(f64) -> f64) -> Self {
        match self {
            Self::Same(value) => Self::Same(operation(*value)),
            Self::Rows(rows) => room.filled(rows.iter().map(|value| operation(*value))),
        }
    }

    /// One operation on two values of each row.
    pub(super) fn combine(&self, other: &Self, room: &mut Room, operation: impl Fn(f64, f64) -> f64) -> Self {
        match (self, other) {
            (Self::Same(a), Self::Same(b)) => Self::Same(operation(*a, *b)),
            (Self::Same(a), Self::Rows(b)) => room.filled(b.iter().map(|b| operation(*a, *b))),
            (Self::Rows(a), Self::Same(b)) => room.filled(a.iter().map(|a| operation(*a, *b))),
            (Self::Rows(a), Self::Rows(b)) => {
                room.filled(a.iter().zip(b.iter()).map(|(a, b)| operation(*a, *b)))
            }
        }
    }
}

/// Columns that nobody reads any more, for the next results: those are still in the cache.
#[derive(Debug, Default)]
pub(super) struct Room(Vec<Vec<f64>>);

impl Room {
    /// Takes a column back that nobody reads any more.
    pub(super) fn reuse(&mut self, column: Column<'_>) {
        if let Column::Rows(Cow::Owned(values)) = column {
            self.0.push(values);
        }
    }

    fn filled<'c>(&mut self, values: impl Iterator<Item = f64>) -> Column<'c> {
        let mut column = self.0.pop().unwrap_or_default();
        column.clear();
        column.extend(values);
        Column::Rows(Cow::Owned(column))
    }
}
