//! Rows that are read become rows that are written. In: rows with the state of the machine in each. Out: the same rows with
//! errors and compensated positions, in their order, a batch at a time.

use std::cell::RefCell;
use std::io::{self, Read};
use std::rc::Rc;

use abbe_runtime::{Compensator, Exchanged, Refusal, Sample};
use csv::ByteRecord;
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use workshop::failure::Failure;
use workshop::rows::{Lean, Leaning};

use super::CAPACITY;
use crate::decimal::Decimal;
use crate::map::Map;
use crate::positions::{Layout, Pending, Summary, quoted};

/// The longest row, in bytes; what is longer is no table, and would have to be kept as a whole.
const LONGEST_ROW: u64 = 1 << 20;

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
    pub(super) fn new(answering: Rc<RefCell<Answering<'c>>>) -> Self {
        Self { stdin: io::stdin().lock(), answering, taken: 0 }
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

/// The machine without a tool, and with each tool of the calibration.
pub(super) struct Machines {
    pub(super) without: Interpreter,
    pub(super) with: Vec<Interpreter>,
}

/// Those who answer: the compensator, and all that hears of its answers.
pub(super) struct Answering<'c> {
    equations: &'c Equations,
    compensator: Compensator<'c, Exchanged<&'c Interpreter>>,
    machines: &'c Machines,
    machine: &'c Exchanged<&'c Interpreter>,
    /// The tool of the rows that are pending.
    tool: Option<usize>,
    pending: Pending,
    /// What follows the direction of the tool, where the machine derives it.
    pub(super) leaning: Option<Leaning<'c>>,
    /// The error of that direction in the rows that are pending; nothing where it is not derived.
    leans: Vec<Lean>,
    writer: csv::Writer<io::StdoutLock<'static>>,
    number: Decimal,
    skip_bad: bool,
    /// How many rows were left out.
    pub(super) skipped: u64,
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
        equations: &'c Equations,
        (machines, machine): (&'c Machines, &'c Exchanged<&'c Interpreter>),
        compensator: Compensator<'c, Exchanged<&'c Interpreter>>,
        skip_bad: bool,
    ) -> Self {
        let mut builder = csv::WriterBuilder::new();
        Self {
            equations,
            compensator,
            machines,
            machine,
            tool: None,
            pending: Pending::default(),
            leaning: None,
            leans: Vec::new(),
            writer: builder.flexible(true).buffer_capacity(CAPACITY).from_writer(io::stdout().lock()),
            number: Decimal::default(),
            skip_bad,
            skipped: 0,
            summary: None,
            map: None,
            begun: 0,
            failure: None,
        }
    }

    /// Writes the header, and the units where the input has them.
    pub(super) fn begin(&mut self, layout: &Layout, added: Vec<String>) -> Result<(), Failure> {
        self.pending = Pending::new(layout, &self.compensator);
        self.writer.write_record(layout.header.iter().chain(&added)).map_err(closed)?;
        let Some(units) = &layout.units else { return Ok(()) };
        let tip = self.equations.rows.iter().map(|_| "mm".to_owned());
        let errors = tip.chain(self.equations.orientation.iter().map(|_| "rad".to_owned()));
        let axes = layout.axes.iter().map(|column| units.get(column.index).cloned().unwrap_or_default());
        let motors = self.equations.axes.iter().filter(|axis| axis.is_motor()).map(|_| "mm".to_owned());
        let axes = axes.chain(motors);
        let mark = std::iter::once("#unit".to_owned());
        self.writer.write_record(mark.chain(units.iter().cloned()).chain(errors).chain(axes)).map_err(closed)
    }

    /// Takes the tool of the next row: the rows before it are answered with theirs.
    pub(super) fn change_tool(&mut self, tool: Option<usize>) -> Result<(), Failure> {
        if tool != self.tool {
            self.answer()?;
            let with = tool.and_then(|tool| self.machines.with.get(tool));
            self.machine.exchange(with.unwrap_or(&self.machines.without));
            self.tool = tool;
        }
        Ok(())
    }

    /// Takes a row with the state of the machine in it; leaves another record in its place.
    pub(super) fn take(
        &mut self,
        row: &mut ByteRecord,
        number: u64,
        sample: &Sample<'_>,
    ) -> Result<(), Failure> {
        self.pending.push(row, number, sample);
        self.leans.extend(self.leaning.as_mut().map(|leaning| leaning.take(sample)));
        if self.pending.is_full() { self.answer() } else { Ok(()) }
    }

    /// Refuses a row that is no state of a machine.
    pub(super) fn refuse(&mut self, row: &ByteRecord, number: u64, mistake: &str) -> Result<(), Failure> {
        self.answer()?;
        bad(row, number, mistake, self.skip_bad, &mut self.skipped)
    }

    /// Answers what is pending, as far as the first bad row where none may be left out.
    pub(super) fn answer(&mut self) -> Result<(), Failure> {
        // Before the header is read there is not even room for a row.
        if self.pending.len() == 0 {
            return Ok(());
        }
        let done = self.answer_rows();
        self.pending.clear();
        self.leans.clear();
        done
    }

    fn answer_rows(&mut self) -> Result<(), Failure> {
        self.compensate()
            .map_err(|refusal| Failure::wrong(format!("error: the rows cannot be compensated: {refusal}")))?;
        for row in 0..self.pending.len() {
            let (record, number) = self.pending.record(row);
            match self.pending.answer(row) {
                Ok(outcome) => {
                    let lean = self.leans.get(row).copied();
                    self.write(row, &outcome.error, lean.as_ref())?;
                    self.summary.iter_mut().for_each(|summary| summary.take(&outcome, lean.as_ref()));
                    self.map.iter_mut().for_each(|map| self.pending.show(row, map));
                }
                Err(refusal) => {
                    bad(record, number, &refusal.to_string(), self.skip_bad, &mut self.skipped)?;
                }
            }
        }
        Ok(())
    }

    /// Has all rows compensated; one by one where rotary axes correct the direction of the tool, since each row then has an error of it
    /// that stays.
    fn compensate(&mut self) -> Result<(), Refusal> {
        let rows = self.pending.len();
        if self.equations.aiming().is_empty() {
            return self.pending.compensate(0..rows, &mut self.compensator);
        }
        for (row, lean) in self.leans.iter_mut().enumerate() {
            self.pending.compensate(row..row + 1, &mut self.compensator)?;
            lean.with = self.compensator.direction().map_or([f64::NAN; 3], |direction| direction.remaining);
        }
        Ok(())
    }

    /// Writes the input's cells, the errors and the compensated positions in the units of their columns.
    fn write(&mut self, row: usize, error: &[f64; 3], lean: Option<&Lean>) -> Result<(), Failure> {
        for cell in self.pending.record(row).0 {
            self.writer.write_field(cell).map_err(closed)?;
        }
        let errors = self.equations.rows.iter().map(|row| error[row.direction.index()]);
        let leans = lean.iter().flat_map(|lean| lean.without);
        for value in errors.chain(leans).chain(self.pending.commands(row)) {
            self.writer.write_field(self.number.text(value)).map_err(closed)?;
        }
        self.writer.write_record(None::<&[u8]>).map_err(closed)
    }

    /// Shows what is written.
    pub(super) fn flush(&mut self) -> Result<(), Failure> {
        self.writer.flush().map_err(|error| Failure::io("cannot write to standard output", &error))
    }

    /// The map of what was answered, where one is asked for.
    pub(super) fn draw(&mut self) -> Option<Result<String, Failure>> {
        self.map.as_ref().map(|map| map.draw(&mut self.compensator))
    }
}

/// Leaves a bad row out, or says why it is bad.
fn bad(row: &ByteRecord, number: u64, mistake: &str, skip: bool, skipped: &mut u64) -> Result<(), Failure> {
    if skip {
        *skipped += 1;
        return Ok(());
    }
    let cells: Vec<_> = row.iter().take(12).map(|cell| quoted(&String::from_utf8_lossy(cell))).collect();
    let cells = cells.join(",");
    Err(Failure::no(format!(
        "error: standard input, row {number} under the header (`{cells}`): {mistake}\nhelp: --skip-bad leaves such rows out and counts them"
    )))
}

fn closed(error: csv::Error) -> Failure {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => Failure::io("cannot write to standard output", &error),
        other => Failure::wrong(format!("error: cannot write to standard output: {other:?}")),
    }
}
