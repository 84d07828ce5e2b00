//! Lines of the output. In: rows as they were read, and what they are answered. Out: their text, in their order, and what it comes to;
//! as far as the first bad row where none may be left out.

use std::sync::Arc;

use csv::ByteRecord;
use model_dsl::equations::Equations;
use workshop::failure::Failure;
use workshop::rows::Answer;

use super::separator::Separator;
use crate::decimal::Decimal;
use crate::positions::{Column, Doubts, Summary, quoted};

/// Where a row stands.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Its number under the header, from 1.
    pub(super) row: u64,
    /// The line of the input in which it begins, from 1.
    pub(super) line: u64,
}

/// The lines of rows that follow each other.
pub(super) struct Lines<'l> {
    equations: &'l Equations,
    axes: Arc<[Column]>,
    separator: Separator,
    skip_bad: bool,
    number: Decimal,
    pub(super) writer: csv::Writer<Vec<u8>>,
    pub(super) summary: Summary,
    pub(super) doubts: Doubts,
    /// The rows that were answered.
    pub(super) answered: Vec<usize>,
    /// How many rows were left out.
    pub(super) skipped: u64,
    /// Why it ends here.
    pub(super) failure: Option<Failure>,
}

impl<'l> Lines<'l> {
    /// No line yet, of a machine whose axes have their positions in these columns.
    pub(super) fn new(
        equations: &'l Equations,
        axes: Arc<[Column]>,
        separator: Separator,
        skip_bad: bool,
    ) -> Self {
        Self {
            equations,
            axes,
            separator,
            skip_bad,
            number: Decimal::default(),
            writer: writer(separator),
            summary: Summary::default(),
            doubts: Doubts::default(),
            answered: Vec::new(),
            skipped: 0,
            failure: None,
        }
    }

    /// Takes a row by its place, as it was read with its number, and what it is answered; `false` where it is the last.
    pub(super) fn take(&mut self, row: usize, record: &(ByteRecord, Place), answer: &Answer<'_>) -> bool {
        match &answer.outcome {
            Ok(outcome) => {
                self.summary.take(outcome, answer.lean.as_ref());
                self.doubts.take(answer);
                self.answered.push(row);
                let written = self.write(&record.0, outcome.error, answer);
                self.failure = written.err().map(|error| failed(&error));
            }
            Err(_) if self.skip_bad => self.skipped += 1,
            Err(refusal) => {
                self.failure = Some(bad(&record.0, record.1, self.separator, &refusal.to_string()))
            }
        }
        self.failure.is_none()
    }

    /// Writes the input's cells, the errors and the compensated positions in the units of their columns.
    fn write(&mut self, record: &ByteRecord, error: [f64; 3], answer: &Answer<'_>) -> Result<(), csv::Error> {
        for cell in record {
            self.writer.write_field(cell)?;
        }
        let errors = self.equations.rows.iter().filter_map(|row| error.get(row.direction.index()).copied());
        let leans = answer.lean.iter().flat_map(|lean| lean.without);
        // Motors have no column, and are told in mm.
        let scales = self.axes.iter().map(|column| (column.factor, column.offset));
        let axes = answer.command.iter().zip(scales.chain(std::iter::repeat((1.0, 0.0))));
        let commands = axes.map(|(command, (factor, offset))| command / factor - offset);
        for value in errors.chain(leans).chain(commands) {
            self.writer.write_field(self.number.text(value))?;
        }
        self.writer.write_record(None::<&[u8]>)
    }
}

/// Writes rows of any width to memory.
pub(super) fn writer(separator: Separator) -> csv::Writer<Vec<u8>> {
    csv::WriterBuilder::new().delimiter(separator.byte()).flexible(true).from_writer(Vec::new())
}

/// What was written.
pub(super) fn text(writer: csv::Writer<Vec<u8>>) -> Result<Vec<u8>, Failure> {
    writer.into_inner().map_err(|error| Failure::io("cannot write a row", error.error()))
}

/// Why a row could not be written.
pub(super) fn failed(error: &csv::Error) -> Failure {
    Failure::wrong(format!("error: cannot write a row: {error}"))
}

/// Why a row is bad.
pub(super) fn bad(row: &ByteRecord, place: Place, separator: Separator, mistake: &str) -> Failure {
    let cells: Vec<_> = row.iter().take(12).map(|cell| quoted(&String::from_utf8_lossy(cell))).collect();
    let cells = cells.join(char::from(separator.byte()).to_string().as_str());
    let Place { row, line } = place;
    Failure::no(format!(
        "error: standard input, line {line}, row {row} under the header (`{cells}`): {mistake}\nhelp: use --skip-bad to leave out such rows and count them"
    ))
}
