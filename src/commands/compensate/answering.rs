//! Rows that are read become rows that are written. In: rows with the state of the machine in each. Out: the same rows with
//! errors and compensated positions, in their order, some thousand at a time, while the next ones are read.

use std::io::{self, BufWriter, Write};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, sync_channel};

use abbe_runtime::{ErrorMotion, Sample, TermState, states_needed};
use csv::ByteRecord;
use rayon::Scope;
use workshop::calibrated::Calibrated;
use workshop::failure::Failure;
use workshop::rows::{self, Room, Samples};

use super::CAPACITY;
use super::lines::{self, Lines, Place};
use super::separator::Separator;
use crate::map::Map;
use crate::positions::{Column, Doubts, Layout, Reach, Summary};

/// The number of rows that are computed at once. They are 32 pieces, so that each of 16 processors has two and seldom waits for the last
/// one, and they take a few MB.
const MOST_PENDING: usize = 1 << 13;

/// Rows that wait for their answers.
struct Batch<'c> {
    /// The rows as they were read, each with its place; and spare ones behind them.
    records: Vec<(ByteRecord, Place)>,
    /// The state of the machine in each of them.
    samples: Samples<'c>,
}

impl<'c> Batch<'c> {
    fn new(motions: &'c [ErrorMotion<'c>]) -> Self {
        Self { records: Vec::new(), samples: Samples::new(motions) }
    }

    /// Has the rows answered, piece by piece.
    fn answer(
        &self,
        machine: &rows::Answering<'c>,
        begin: impl Fn() -> Lines<'c> + Sync,
    ) -> Result<Vec<Lines<'c>>, Failure> {
        machine.answer(&self.samples, begin, |lines, row, answer| {
            self.records.get(row).is_some_and(|record| lines.take(row, record, answer))
        })
    }
}

/// Rows with their lines.
type Answered<'c> = (Batch<'c>, Vec<Lines<'c>>);

/// Those who answer: the machine, and all that hears of its answers.
pub(super) struct Answering<'s, 'c> {
    scope: &'s Scope<'c>,
    pub(super) machine: &'c rows::Answering<'c>,
    motions: &'c [ErrorMotion<'c>],
    /// The position of each axis that a program moves, in a row.
    axes: Arc<[Column]>,
    /// The rows that were read last.
    pending: Batch<'c>,
    /// Those before them, which are being answered meanwhile.
    before: Option<Receiver<Result<Answered<'c>, Failure>>>,
    /// The storage of rows that were answered.
    spare: Option<Batch<'c>>,
    /// The tool of the last row.
    tool: Option<usize>,
    output: BufWriter<io::StdoutLock<'static>>,
    separator: Separator,
    skip_bad: bool,
    /// How many rows were left out.
    pub(super) skipped: u64,
    /// The rows beyond what was measured.
    pub(super) reach: Reach,
    /// What must be known beside the answers.
    pub(super) doubts: Doubts,
    /// What the answers come to, where it is asked for.
    pub(super) summary: Option<Summary>,
    /// What a map is drawn from, where one is asked for.
    pub(super) map: Option<Map<'c>>,
    /// The byte at which the row begins that is being read.
    pub(super) begun: u64,
    /// Why the rows before the one that is read could not be answered, or that one not be read.
    pub(super) failure: Option<Failure>,
}

impl<'s, 'c> Answering<'s, 'c> {
    /// Nobody has asked yet. Rows are answered within the scope, while others are read.
    pub(super) fn new(
        scope: &'s Scope<'c>,
        calibrated: &'c Calibrated,
        (machine, motions): (&'c rows::Answering<'c>, &'c [ErrorMotion<'c>]),
        separator: Separator,
        skip_bad: bool,
    ) -> Self {
        Self {
            scope,
            machine,
            motions,
            axes: Arc::new([]),
            pending: Batch::new(motions),
            before: None,
            spare: None,
            tool: None,
            output: BufWriter::with_capacity(CAPACITY, io::stdout().lock()),
            separator,
            skip_bad,
            skipped: 0,
            reach: Reach::new(&calibrated.equations, &calibrated.calibration),
            doubts: Doubts::default(),
            summary: None,
            map: None,
            begun: 0,
            failure: None,
        }
    }

    /// Writes the header, and the units where the input has them.
    pub(super) fn begin(&mut self, layout: &Layout, added: Vec<String>) -> Result<(), Failure> {
        self.axes = layout.axes.as_slice().into();
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
        place: Place,
        (sample, tool): (&Sample<'_>, Option<usize>),
    ) -> Result<(), Failure> {
        let Batch { records, samples } = &mut self.pending;
        let number = samples.len();
        if number == records.len() {
            records.push((ByteRecord::new(), Place::default()));
        }
        if let Some(slot) = records.get_mut(number) {
            std::mem::swap(&mut slot.0, row);
            slot.1 = place;
        }
        samples.push(sample, tool);
        let full = samples.len() >= MOST_PENDING;
        self.reach.take(sample.position);
        self.tool = tool;
        if full { self.hand_over() } else { Ok(()) }
    }

    /// Refuses a row that is no state of a machine.
    pub(super) fn refuse(&mut self, row: &ByteRecord, place: Place, mistake: &str) -> Result<(), Failure> {
        self.answer()?;
        if self.skip_bad {
            self.skipped += 1;
            return Ok(());
        }
        Err(lines::bad(row, place, self.separator, mistake))
    }

    /// Answers all rows that were read, as far as the first bad one where none may be left out.
    pub(super) fn answer(&mut self) -> Result<(), Failure> {
        let before = self.wait()?;
        self.take_back(before)?;
        if self.pending.samples.is_empty() {
            return Ok(());
        }
        let batch = self.next_batch();
        let lines = batch.answer(self.machine, self.lines())?;
        self.take_back(Some((batch, lines)))
    }

    /// Has the rows that were read answered while those before them are written and the next ones are read.
    fn hand_over(&mut self) -> Result<(), Failure> {
        let before = self.wait()?;
        let batch = self.next_batch();
        let (sender, receiver) = sync_channel(1);
        let (machine, begin) = (self.machine, self.lines());
        self.scope.spawn(move |_| {
            let lines = batch.answer(machine, begin);
            // Nobody listens any more after a failure.
            let _ = sender.send(lines.map(|lines| (batch, lines)));
        });
        self.before = Some(receiver);
        self.take_back(before)
    }

    /// Gives the rows that were read away; the next ones go on from what terms remember behind them.
    fn next_batch(&mut self) -> Batch<'c> {
        let mut next = self.spare.take().unwrap_or_else(|| Batch::new(self.motions));
        next.samples.follow(&self.pending.samples);
        std::mem::replace(&mut self.pending, next)
    }

    /// Waits for the rows that were handed over.
    fn wait(&mut self) -> Result<Option<Answered<'c>>, Failure> {
        let Some(receiver) = self.before.take() else { return Ok(None) };
        let lost = |_| Failure::wrong("error: rows were lost on their way".to_owned());
        receiver.recv().map_err(lost)?.map(Some)
    }

    /// Writes rows that were answered, and keeps their storage.
    fn take_back(&mut self, answered: Option<Answered<'c>>) -> Result<(), Failure> {
        let Some((batch, lines)) = answered else { return Ok(()) };
        lines.into_iter().try_for_each(|piece| self.take_lines(&batch, piece))?;
        self.spare = Some(batch);
        Ok(())
    }

    /// What the lines of a piece are gathered in.
    fn lines(&self) -> impl Fn() -> Lines<'c> + Send + Sync + use<'c> {
        let (equations, axes) = (self.machine.equations(), Arc::clone(&self.axes));
        let (separator, skip_bad) = (self.separator, self.skip_bad);
        move || Lines::new(equations, Arc::clone(&axes), separator, skip_bad)
    }

    /// Writes the lines of a piece, and lets all hear of them.
    fn take_lines(&mut self, batch: &Batch<'c>, piece: Lines<'c>) -> Result<(), Failure> {
        self.skipped += piece.skipped;
        if let Some(map) = &mut self.map {
            for row in &piece.answered {
                let sample = batch.samples.sample(*row);
                map.take(sample.position, sample.temperature.to_vec());
            }
        }
        self.doubts.add(&piece.doubts);
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
