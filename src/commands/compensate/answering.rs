//! Rows that are read become rows that are written. In: rows with the state of the machine in each. Out: the same rows with
//! errors and compensated positions, in their order, as many at a time as one read of the input brings.

use std::cell::RefCell;
use std::io::{self, BufWriter, Read, Write};
use std::rc::Rc;

use abbe_runtime::{ErrorMotion, Sample, TermState, states_needed};
use csv::ByteRecord;
use workshop::calibrated::Calibrated;
use workshop::failure::Failure;
use workshop::rows::{self, Room, Samples};

use super::CAPACITY;
use super::lines::{self, Lines};
use super::separator::Separator;
use crate::map::Map;
use crate::positions::{Column, Layout, Reach, Summary};

/// The longest row, in bytes; what is longer is no table, and would have to be kept as a whole.
const LONGEST_ROW: u64 = 1 << 20;

/// So many rows are answered at once at the most: enough pieces for many processors, and some MB.
const MOST_PENDING: usize = 1 << 13;

/// Standard input that has every row answered and shown before it waits for more, so that a program at the other end of
/// the pipes gets every answer before it asks the next question.
pub(super) struct Input<'c> {
    stdin: io::StdinLock<'static>,
    answering: Rc<RefCell<Answering<'c>>>,
    /// How many bytes were read.
    taken: u64,
}

impl<'c> Input<'c> {
    /// Standard input, with those who answer what it brings.
    pub(super) fn new(stdin: io::StdinLock<'static>, answering: Rc<RefCell<Answering<'c>>>) -> Self {
        Self { stdin, answering, taken: 0 }
    }
}

impl Read for Input<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut answering = self.answering.borrow_mut();
        if let Err(failure) = answering.answer().and_then(|()| answering.flush()) {
            answering.failure = Some(failure);
            return Err(io::Error::other("the rows before could not be answered"));
        }
        if self.taken.saturating_sub(answering.begun) > LONGEST_ROW {
            let mistake = "error: standard input: a row is longer than 1 MiB";
            answering.failure = Some(Failure::no(mistake.to_owned()));
            return Err(io::Error::other("the row is too long"));
        }
        let read = self.stdin.read(buffer)?;
        self.taken += u64::try_from(read).unwrap_or_default();
        Ok(read)
    }
}

/// Those who answer: the machine, and all that hears of its answers.
pub(super) struct Answering<'c> {
    machine: rows::Answering<'c>,
    motions: &'c [ErrorMotion<'c>],
    /// The position of each axis that a program moves, in a row.
    axes: Vec<Column>,
    /// The rows that are pending, as they were read, each with its number; and spare ones behind them.
    records: Vec<(ByteRecord, u64)>,
    /// The state of the machine in each of them.
    samples: Samples<'c>,
    /// The tool of the last row.
    tool: Option<usize>,
    output: BufWriter<io::StdoutLock<'static>>,
    separator: Separator,
    skip_bad: bool,
    /// How many rows were left out.
    pub(super) skipped: u64,
    /// The rows beyond what was measured.
    pub(super) reach: Reach,
    /// What the answers come to, where it is asked for.
    pub(super) summary: Option<Summary>,
    /// What a map is drawn from, where one is asked for.
    pub(super) map: Option<Map<'c>>,
    /// The byte at which the row begins that is being read.
    pub(super) begun: u64,
    /// Why the rows before the one that is read could not be answered, or that one not be read.
    pub(super) failure: Option<Failure>,
}

impl<'c> Answering<'c> {
    /// Nobody has asked yet.
    pub(super) fn new(
        calibrated: &'c Calibrated,
        motions: &'c [ErrorMotion<'c>],
        separator: Separator,
        skip_bad: bool,
    ) -> Self {
        Self {
            machine: rows::Answering::new(calibrated, motions),
            motions,
            axes: Vec::new(),
            records: Vec::new(),
            samples: Samples::new(motions),
            tool: None,
            output: BufWriter::with_capacity(CAPACITY, io::stdout().lock()),
            separator,
            skip_bad,
            skipped: 0,
            reach: Reach::new(&calibrated.equations, &calibrated.calibration),
            summary: None,
            map: None,
            begun: 0,
            failure: None,
        }
    }

    /// Writes the header, and the units where the input has them.
    pub(super) fn begin(&mut self, layout: &Layout, added: Vec<String>) -> Result<(), Failure> {
        self.axes.clone_from(&layout.axes);
        let mut head = lines::writer(self.separator);
        head.write_record(layout.header.iter().chain(&added)).map_err(|error| lines::failed(&error))?;
        if let Some(units) = &layout.units {
            let units = self.units(layout, units);
            head.write_record(units).map_err(|error| lines::failed(&error))?;
        }
        self.show(&lines::text(head)?)
    }

    /// The row of units, with those of the columns that are added.
    fn units(&self, layout: &Layout, units: &[String]) -> Vec<String> {
        let equations = self.machine.equations();
        let tip = equations.rows.iter().map(|_| "mm".to_owned());
        let direction = equations.orientation.iter().map(|_| "rad".to_owned());
        let axes = layout.axes.iter().map(|column| units.get(column.index).cloned().unwrap_or_default());
        let motors = equations.axes.iter().filter(|axis| axis.is_motor()).map(|_| "mm".to_owned());
        let mark = std::iter::once("#unit".to_owned());
        mark.chain(units.iter().cloned()).chain(tip).chain(direction).chain(axes).chain(motors).collect()
    }

    /// Takes a row with the state of the machine and its tool in it; leaves another record in its place.
    pub(super) fn take(
        &mut self,
        row: &mut ByteRecord,
        number: u64,
        (sample, tool): (&Sample<'_>, Option<usize>),
    ) -> Result<(), Failure> {
        let place = self.samples.len();
        if place == self.records.len() {
            self.records.push((ByteRecord::new(), 0));
        }
        if let Some(slot) = self.records.get_mut(place) {
            std::mem::swap(&mut slot.0, row);
            slot.1 = number;
        }
        self.samples.push(sample, tool);
        self.reach.take(sample.position);
        self.tool = tool;
        if self.samples.len() < MOST_PENDING { Ok(()) } else { self.answer() }
    }

    /// Refuses a row that is no state of a machine.
    pub(super) fn refuse(&mut self, row: &ByteRecord, number: u64, mistake: &str) -> Result<(), Failure> {
        self.answer()?;
        if self.skip_bad {
            self.skipped += 1;
            return Ok(());
        }
        Err(lines::bad(row, number, mistake))
    }

    /// Answers what is pending, as far as the first bad row where none may be left out.
    pub(super) fn answer(&mut self) -> Result<(), Failure> {
        if self.samples.is_empty() {
            return Ok(());
        }
        let done = self.answer_rows();
        self.samples.clear();
        done
    }

    fn answer_rows(&mut self) -> Result<(), Failure> {
        let Self { machine, samples, records, .. } = self;
        let (axes, skip_bad, separator) = (self.axes.clone(), self.skip_bad, self.separator);
        let begin = || Lines::new(machine.equations(), &axes, separator, skip_bad);
        let pieces = machine.answer(samples, begin, |lines, row, answer| {
            records.get(row).is_some_and(|record| lines.take(row, record, answer))
        })?;
        pieces.into_iter().try_for_each(|piece| self.take_lines(piece))
    }

    /// Writes the lines of a piece, and lets all hear of them.
    fn take_lines(&mut self, piece: Lines<'_>) -> Result<(), Failure> {
        self.skipped += piece.skipped;
        if let Some(map) = &mut self.map {
            for row in &piece.answered {
                let sample = self.samples.sample(*row);
                map.take(sample.position, sample.temperature.to_vec());
            }
        }
        self.summary.iter_mut().for_each(|summary| summary.add(&piece.summary));
        let failure = piece.failure;
        self.show(&lines::text(piece.writer)?)?;
        failure.map_or(Ok(()), Err)
    }

    fn show(&mut self, text: &[u8]) -> Result<(), Failure> {
        self.output.write_all(text).map_err(|error| cannot_write(&error))
    }

    /// Shows what is written.
    pub(super) fn flush(&mut self) -> Result<(), Failure> {
        self.output.flush().map_err(|error| cannot_write(&error))
    }

    /// The map of what was answered, where one is asked for, with the tool of the last row.
    pub(super) fn draw(&self) -> Result<Option<String>, Failure> {
        let Some(map) = &self.map else { return Ok(None) };
        let mut room = Room::new(self.machine.equations());
        let mut states = vec![TermState::default(); states_needed(self.motions)];
        map.draw(&mut room.compensator(self.machine.machine(self.tool), self.motions, &mut states)?).map(Some)
    }
}

fn cannot_write(error: &io::Error) -> Failure {
    Failure::io("cannot write to standard output", error)
}
