//! `abbe compensate`: positions on standard input become errors and compensated positions on
//! standard output, row by row, in constant memory.

mod answering;
mod input;
mod lines;
mod reader;
mod separator;

use std::cell::RefCell;
use std::io::{self, IsTerminal};
use std::path::Path;
use std::rc::Rc;

use abbe_runtime::ErrorMotion;
use csv::ByteRecord;
use exchange::controller::Unit;
use model_dsl::calibration::Tool;
use model_dsl::diagnostic::Diagnostics;
use rayon::Scope;
use workshop::calibrated::{self, Calibrated};
use workshop::failure::Failure;
use workshop::load;
use workshop::rows::{self, Timed, output_columns, timed};
use workshop::tools;
use workshop::written;

use crate::arguments::Compensate;
use crate::map::Map;
use crate::output::{Person, warn};
use crate::positions::{Layout, State, Summary, Wanted, quoted};
use crate::progress::Progress;
use answering::Answering;
use input::Chunks;
use lines::Place;
use reader::{Comments, Reader};
use separator::Separator;

/// The most bytes that are read or written at once: several times what a pipe holds, so that a file takes few calls of the system.
const CAPACITY: usize = 1 << 18;

/// So many mistakes of a header are told.
const MOST_TOLD: usize = 100;

/// The progress is told every so many rows.
const TOLD: u64 = 4096;

/// Runs the command.
pub(crate) fn run(command: &Compensate) -> Result<(), Failure> {
    if let Some(positions) = &command.positions {
        return Err(from_a_file(&command.calibration, positions));
    }
    let mut calibrated = calibrated::read(&command.calibration, &Person::default())?;
    if let Some(path) = &command.tools {
        calibrated.calibration.tools = tool_table(&calibrated, path, command.tools_unit.into())?;
    }
    if let Some(name) = &command.tool {
        tools::mount(&mut calibrated.calibration, name)?;
    }
    let calibrated = calibrated;
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
    let machine = rows::Answering::new(&calibrated, &motions);
    let drawn = rayon::in_place_scope(|scope| stream(scope, &calibrated, (&machine, &motions), command))?;
    command.map.as_ref().zip(drawn).map_or(Ok(()), |(target, drawing)| written::whole(target, &drawing))
}

/// Positions are read from no file.
fn from_a_file(calibration: &Path, positions: &Path) -> Failure {
    Failure::wrong(format!(
        "error: {} is not read: positions come from standard input\nhelp: write `abbe compensate {} < {}`",
        positions.display(),
        calibration.display(),
        positions.display()
    ))
}

/// Takes the rows from standard input to standard output; gives the map that was asked for.
fn stream<'c>(
    scope: &Scope<'c>,
    calibrated: &'c Calibrated,
    machine: (&'c rows::Answering<'c>, &'c [ErrorMotion<'c>]),
    command: &Compensate,
) -> Result<Option<String>, Failure> {
    let mut rows = Rows::open(scope, calibrated, machine, command)?;
    // Rows on a terminal are their own progress, and whoever types them needs none.
    let seen = command.quiet || io::stdout().is_terminal() || io::stdin().is_terminal();
    let progress = Progress::new(seen, "compensating");
    let done = rows.stream(&progress);
    drop(progress);
    rows.finish(done)
}

/// The tools of LinuxCNC's table.
fn tool_table(calibrated: &Calibrated, path: &Path, unit: Unit) -> Result<Vec<Tool>, Failure> {
    let source = load::read(path)?;
    let mut diagnostics = Diagnostics::new();
    let (equations, calibration) = (&calibrated.equations, &calibrated.calibration);
    let tools = exchange::controller::tool_table(equations, calibration, &source, unit, &mut diagnostics);
    if diagnostics.has_errors() { Err(Failure::marked(&source, &diagnostics)) } else { Ok(tools) }
}

/// The rows on their way from standard input to standard output.
struct Rows<'s, 'c> {
    reader: Reader<'s, 'c>,
    answering: Rc<RefCell<Answering<'s, 'c>>>,
    state: State<'c>,
    comments: Comments,
    /// The first row and its line, where it was read with the header.
    first: Option<(ByteRecord, u64)>,
    row: u64,
}

impl<'s, 'c> Rows<'s, 'c> {
    /// Reads the header and writes the header of the output.
    fn open(
        scope: &'s Scope<'c>,
        calibrated: &'c Calibrated,
        machine: (&'c rows::Answering<'c>, &'c [ErrorMotion<'c>]),
        command: &Compensate,
    ) -> Result<Self, Failure> {
        let equations = &calibrated.equations;
        let chunks = Chunks::begin().map_err(|error| Failure::io("cannot read standard input", &error))?;
        let separator = Separator::of(chunks.rest())?;
        let mut answering = Answering::new(scope, calibrated, machine, separator, command.skip_bad);
        answering.summary = command.summary.then(Summary::default);
        answering.map = command.map.as_ref().map(|_| Map::new(equations, &calibrated.calibration));
        let answering = Rc::new(RefCell::new(answering));
        let mut reader = Reader::new(chunks, &answering, separator);
        let header = reader.header()?;
        let wanted = wanted(calibrated);
        let comments = Comments::new(&header, &wanted);
        let (units, first) = reader.units(header.len(), &comments)?;
        let layout = Layout::read(&header, units.as_deref(), &wanted).map_err(|mistakes| {
            let told = mistakes.iter().take(MOST_TOLD);
            Failure::wrong(
                told.map(|mistake| format!("error: standard input: {mistake}\n")).collect::<String>(),
            )
        })?;
        tell_unread(&layout.unread);
        let needed = timed(&calibrated.calibration);
        if layout.time.is_none() {
            needed.iter().filter_map(Timed::standing).for_each(|standing| warn(&standing));
        }
        answering.borrow_mut().begin(&layout, output_columns(equations))?;
        let hysteresis: Vec<f64> = equations
            .axes
            .iter()
            .map(|axis| if axis.rotary { command.hysteresis.to_radians() } else { command.hysteresis })
            .collect();
        let calibration = &calibrated.calibration;
        let state = State::new(layout, needed.is_some(), calibration, &hysteresis);
        Ok(Self { reader, answering, state, comments, first, row: 0 })
    }

    /// Reads all rows; they are answered when many have come, and before more of them are waited for.
    fn stream(&mut self, progress: &Progress) -> Result<(), Failure> {
        let mut row = ByteRecord::new();
        while let Some(line) = self.next(&mut row)? {
            let place = Place { row: self.row, line };
            if self.row.is_multiple_of(TOLD) && progress.is_watched() {
                progress.step(&format!("compensating: {} rows", self.row));
            }
            let taken = self.state.take(&row);
            let mut answering = self.answering.borrow_mut();
            match taken {
                Ok(()) => answering.take(&mut row, place, (&self.state.sample(), self.state.tool()))?,
                Err(mistake) => answering.refuse(&row, place, &mistake)?,
            }
        }
        self.answering.borrow_mut().answer()
    }

    /// Reads the next row that is no comment, and tells its line.
    fn next(&mut self, row: &mut ByteRecord) -> Result<Option<u64>, Failure> {
        self.row += 1;
        if let Some((first, line)) = self.first.take() {
            *row = first;
            return Ok(Some(line));
        }
        while let Some(line) = self.reader.next(row)? {
            if self.reader.units_of(row, self.comments.width).is_some() {
                self.answering.borrow_mut().answer()?;
                return Err(late_units(line));
            }
            if !self.comments.is_one(row) {
                return Ok(Some(line));
            }
        }
        Ok(None)
    }

    /// Flushes what stands complete, also before a failure is told; gives the map that was asked for.
    fn finish(self, done: Result<(), Failure>) -> Result<Option<String>, Failure> {
        let mut answering = self.answering.borrow_mut();
        answering.flush()?;
        let skipped = answering.skipped;
        if skipped > 0 {
            let rows = if skipped == 1 { "row was" } else { "rows were" };
            warn(&format!("warning: {skipped} bad {rows} left out"));
        }
        answering.reach.told().for_each(|outside| warn(&outside));
        answering.doubts.told(answering.machine.equations()).iter().for_each(|doubt| warn(doubt));
        if let Some(summary) = &answering.summary {
            warn(&summary.to_string());
        }
        done?;
        if skipped > 0 && skipped + 1 == self.row {
            return Err(Failure::no("error: standard input: no row could be compensated".to_owned()));
        }
        answering.draw()
    }
}

/// Warns of columns that nothing reads, by name as far as a person reads names.
fn tell_unread(names: &[String]) {
    const MOST: usize = 20;
    for name in names.iter().take(MOST) {
        warn(&format!("warning: column `{}` is copied to the output, but nothing reads it", quoted(name)));
    }
    if names.len() > MOST {
        warn(&format!("warning: {} more columns are not read either", names.len() - MOST));
    }
}

/// A row of units that stands where no unit is read any more.
fn late_units(line: u64) -> Failure {
    Failure::no(format!(
        "error: standard input, line {line}: a row of units stands below rows of numbers\n\
         help: write it directly below the names of the columns, once, or remove it"
    ))
}

/// What the machine and its calibration need from a row.
fn wanted(calibrated: &Calibrated) -> Wanted<'_> {
    let sensors =
        calibrated.calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()).collect();
    Wanted {
        timed: timed(&calibrated.calibration).is_some(),
        equations: &calibrated.equations,
        sensors,
        time: timed(&calibrated.calibration).and_then(|needed| match needed {
            Timed::Memory(why) => Some(why),
            Timed::Velocity(_) => None,
        }),
        tools: !calibrated.calibration.tools.is_empty(),
    }
}
