//! `abbe compensate`: positions on standard input become errors and compensated positions on
//! standard output, row by row, in constant memory.

use std::cell::RefCell;
use std::io::{self, IsTerminal, Read};
use std::rc::Rc;

use abbe_runtime::{Compensator, ErrorMotion, Limits, Outcome, TermState, Work, states_needed};
use csv::ByteRecord;
use model_dsl::calibration::{CalibratedMotion, CalibratedTerm};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;

use crate::arguments::Compensate;
use crate::calibrated::{self, Calibrated};
use crate::failure::Failure;
use crate::map::Map;
use crate::output::warn;
use crate::positions::{Layout, State, Summary, Wanted, output_columns};
use crate::progress::Progress;
use crate::written;

/// Decimal places of errors and positions: a picometre, so that rounding never shows.
const PLACES: usize = 9;

/// The progress is told every so many rows.
const TOLD: u64 = 4096;

/// Runs the command.
pub(crate) fn run(command: &Compensate) -> Result<(), Failure> {
    let calibrated = calibrated::read(&command.calibration)?;
    if let Some(target) = &command.map {
        let machine = command.calibration.with_file_name(&calibrated.calibration.machine.value);
        written::check_picture(target, "--map", &[command.calibration.clone(), machine], command.force)?;
        written::check_folder(target, "--map")?;
    }
    if !command.leave_out_uncompensable {
        calibrated.refuse_uncompensable()?;
    }
    let terms = calibrated.terms(|left_out| warn(&left_out));
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let machine = Interpreter::new(&calibrated.equations, &calibrated.calibration.constants);
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let equations = &calibrated.equations;
    let mut directions = vec![[0.0; 3]; equations.axes.len()];
    let (mut values, mut travel) = (vec![0.0; equations.motions.len()], vec![0.0; equations.travels.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work)
        .map_err(|error| Failure::Wrong(format!("error: the calibration cannot be run: {error}")))?;
    compensator.limits =
        Limits { compensation: calibrated.calibration.limits.compensation.map(|limit| limit.value) };
    let mut rows = Rows::open(&calibrated, command)?;
    // Rows on a terminal are their own progress, and whoever types them needs none.
    let seen = command.quiet || io::stdout().is_terminal() || io::stdin().is_terminal();
    let progress = Progress::new(seen, "compensating");
    let done = rows.stream(&mut compensator, &progress);
    drop(progress);
    let map = rows.finish(done)?;
    let drawn = command.map.as_ref().zip(map);
    drawn.map_or(Ok(()), |(target, map)| written::whole(target, &map.draw(&mut compensator)?))
}

/// The rows that come in.
type Reader = csv::Reader<Input>;

/// The rows that go out.
type Writer = Rc<RefCell<csv::Writer<io::StdoutLock<'static>>>>;

/// Standard input that shows what is finished before it waits for more, so that a program at
/// the other end of the pipes gets every answer before it asks the next question.
struct Input {
    stdin: io::StdinLock<'static>,
    writer: Writer,
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.writer.borrow_mut().flush()?;
        self.stdin.read(buffer)
    }
}

/// The rows on their way from standard input to standard output.
struct Rows<'c> {
    reader: Reader,
    writer: Writer,
    equations: &'c Equations,
    state: State<'c>,
    first: Option<ByteRecord>,
    row: u64,
    skip_bad: bool,
    skipped: u64,
    summary: Option<Summary>,
    map: Option<Map<'c>>,
}

impl<'c> Rows<'c> {
    /// Reads the header and writes the header of the output.
    fn open(calibrated: &'c Calibrated, command: &Compensate) -> Result<Self, Failure> {
        let writer = csv::WriterBuilder::new().flexible(true).from_writer(io::stdout().lock());
        let writer = Rc::new(RefCell::new(writer));
        let input = Input { stdin: io::stdin().lock(), writer: Rc::clone(&writer) };
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(input);
        let mut header = ByteRecord::new();
        if !read(&mut reader, &mut header)? {
            return Err(Failure::No(
                "error: standard input is empty; it begins with a header such as `x,y,z`".to_owned(),
            ));
        }
        let mut second = ByteRecord::new();
        let more = read(&mut reader, &mut second)?;
        let units = more && second.get(0).is_some_and(|cell| cell.trim_ascii() == b"#unit");
        let wanted = wanted(calibrated);
        let layout = Layout::read(&header, units.then_some(&second), &wanted).map_err(|mistakes| {
            let told = mistakes.iter().map(|mistake| format!("error: standard input: {mistake}\n"));
            Failure::Wrong(told.collect())
        })?;
        for name in &layout.unread {
            warn(&format!("warning: column `{name}` is carried along, and nothing reads it"));
        }
        let equations = &calibrated.equations;
        let hysteresis: Vec<f64> = equations
            .axes
            .iter()
            .map(|axis| if axis.rotary { command.hysteresis.to_radians() } else { command.hysteresis })
            .collect();
        let mut rows = Self {
            reader,
            writer,
            equations,
            state: State::new(layout, wanted.time.is_some(), &calibrated.calibration.sensors, &hysteresis),
            first: (more && !units).then_some(second),
            row: 0,
            skip_bad: command.skip_bad,
            skipped: 0,
            summary: command.summary.then(Summary::default),
            map: command.map.as_ref().map(|_| Map::new(equations, &calibrated.calibration)),
        };
        rows.write_header()?;
        Ok(rows)
    }

    fn write_header(&mut self) -> Result<(), Failure> {
        let layout = self.state.layout();
        let header: Vec<String> =
            layout.header.iter().cloned().chain(output_columns(self.equations)).collect();
        let units = layout.units.as_ref().map(|units| {
            let errors = self.equations.rows.iter().map(|_| "mm".to_owned());
            let axis_units =
                layout.axes.iter().map(|column| units.get(column.index).cloned().unwrap_or_default());
            let mark = std::iter::once("#unit".to_owned());
            mark.chain(units.iter().cloned()).chain(errors).chain(axis_units).collect::<Vec<_>>()
        });
        self.writer.borrow_mut().write_record(&header).map_err(closed)?;
        units.map_or(Ok(()), |units| self.writer.borrow_mut().write_record(&units).map_err(closed))
    }

    fn stream(
        &mut self,
        compensator: &mut Compensator<'_, Interpreter>,
        progress: &Progress,
    ) -> Result<(), Failure> {
        let mut compensated = vec![0.0; self.equations.axes.len()];
        let mut row = ByteRecord::new();
        let mut text = String::new();
        while self.next(&mut row)? {
            if self.row.is_multiple_of(TOLD) && progress.is_watched() {
                progress.step(&format!("compensating: {} rows", self.row));
            }
            match self.answer(&row, compensator, &mut compensated) {
                Ok(outcome) => {
                    write_row(self, &row, &outcome.error, &compensated, &mut text)?;
                    self.summary.iter_mut().for_each(|summary| summary.take(&outcome));
                    self.map.iter_mut().for_each(|map| map.take(&self.state.sample()));
                }
                Err(mistake) => self.bad(&row, &mistake)?,
            }
        }
        Ok(())
    }

    fn answer(
        &mut self,
        row: &ByteRecord,
        compensator: &mut Compensator<'_, Interpreter>,
        compensated: &mut [f64],
    ) -> Result<Outcome, String> {
        self.state.take(row)?;
        compensator.compensate(&self.state.sample(), compensated).map_err(|refusal| refusal.to_string())
    }

    fn next(&mut self, row: &mut ByteRecord) -> Result<bool, Failure> {
        self.row += 1;
        match self.first.take() {
            Some(first) => {
                *row = first;
                Ok(true)
            }
            None => read(&mut self.reader, row),
        }
    }

    fn bad(&mut self, row: &ByteRecord, mistake: &str) -> Result<(), Failure> {
        if self.skip_bad {
            self.skipped += 1;
            return Ok(());
        }
        let cells: Vec<_> = row.iter().take(12).map(String::from_utf8_lossy).collect();
        let cells = cells.join(",");
        Err(Failure::No(format!(
            "error: standard input, row {} under the header (`{cells}`): {mistake}\nhelp: --skip-bad leaves such rows out and counts them",
            self.row
        )))
    }

    /// Flushes what stands complete, also before a failure is told; gives what a map is drawn from.
    fn finish(self, done: Result<(), Failure>) -> Result<Option<Map<'c>>, Failure> {
        self.writer
            .borrow_mut()
            .flush()
            .map_err(|error| Failure::io("cannot write to standard output", &error))?;
        if self.skipped > 0 {
            warn(&format!(
                "warning: {} bad row{} left out",
                self.skipped,
                if self.skipped == 1 { " was" } else { "s were" }
            ));
        }
        if let Some(summary) = &self.summary {
            warn(&summary.to_string());
        }
        done?;
        if self.skipped > 0 && self.skipped + 1 == self.row {
            return Err(Failure::No("error: standard input: no row could be compensated".to_owned()));
        }
        Ok(self.map)
    }
}

/// Writes the input's cells, the errors and the compensated positions in the units of their columns.
fn write_row(
    rows: &mut Rows<'_>,
    row: &ByteRecord,
    error: &[f64; 3],
    compensated: &[f64],
    text: &mut String,
) -> Result<(), Failure> {
    let mut writer = rows.writer.borrow_mut();
    for cell in row {
        writer.write_field(cell).map_err(closed)?;
    }
    let errors = rows.equations.rows.iter().map(|row| error[row.direction.index()]);
    let layout = rows.state.layout();
    let positions = compensated
        .iter()
        .zip(&layout.axes)
        .map(|(position, column)| position / column.factor - column.offset);
    for value in errors.chain(positions) {
        write_number(text, value);
        writer.write_field(text.as_str()).map_err(closed)?;
    }
    writer.write_record(None::<&[u8]>).map_err(closed)
}

/// Fixed places; a zero has no sign.
fn write_number(text: &mut String, value: f64) {
    use std::fmt::Write;
    text.clear();
    // Writing into a string cannot fail.
    let _ = write!(text, "{value:.PLACES$}");
    if text.starts_with('-') && text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.')) {
        text.remove(0);
    }
}

fn closed(error: csv::Error) -> Failure {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => Failure::io("cannot write to standard output", &error),
        other => Failure::Wrong(format!("error: cannot write to standard output: {other:?}")),
    }
}

/// Reads the next row; `false` at the end.
fn read(reader: &mut Reader, row: &mut ByteRecord) -> Result<bool, Failure> {
    reader.read_byte_record(row).map_err(|error| match error.into_kind() {
        csv::ErrorKind::Io(error) => Failure::io("cannot read standard input", &error),
        other => Failure::No(format!("error: cannot read standard input: {other:?}")),
    })
}

/// What the machine and its calibration need from a row.
fn wanted(calibrated: &Calibrated) -> Wanted<'_> {
    let sensors =
        calibrated.calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect();
    let mut motions = calibrated.calibration.motions.iter();
    Wanted { equations: &calibrated.equations, sensors, time: motions.find_map(timed) }
}

/// What of an error motion depends on the time between rows, in words.
fn timed(motion: &CalibratedMotion) -> Option<String> {
    let terms = motion.terms.iter().enumerate();
    let mut needing = terms.filter_map(|(place, term)| match &term.value {
        CalibratedTerm::Growth { time_constant, .. } if *time_constant <= 0.0 => None,
        term @ (CalibratedTerm::Lag { .. } | CalibratedTerm::Growth { .. }) => {
            Some(format!("the term `{}` of the calibration", term.name()))
        }
        _ => (motion.ramp(place) > 0.0).then(|| "a `ramp` of the calibration".to_owned()),
    });
    needing.next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_has_no_sign() {
        let mut text = String::new();
        write_number(&mut text, -1e-12);
        assert_eq!(text, "0.000000000");
        write_number(&mut text, -1.5);
        assert_eq!(text, "-1.500000000");
    }
}
