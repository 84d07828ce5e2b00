//! LinuxCNC's screw compensation (`[JOINT_n] COMP_FILE`). In: what an axis alone does to its own command. Out: a file of
//! triplets; and a file as LinuxCNC's loader takes it, which ends a table without a word at the first line that is no triplet.
//!
//! Facts: LinuxCNC, `docs/src/config/ini-config.adoc`, `src/emc/motion/usrmotintf.cc` (loader), `command.c` (table),
//! `control.c` (interpolation). The trim is added to the joint's command; type 0 files hold positions, of which the loader makes
//! `trim = nominal - actual`.

use std::fmt::Write;

use abbe_runtime::Direction;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::{AxisInfo, Equations};
use model_dsl::source::{SourceFile, Span};

use super::decimal::decimal;
use super::effects::{Effect, Effects};
use super::geometry::Pose;
use super::job::{Controller, File, Job, Written};
use super::lost::Target;
use super::nodes::Spacing;
use super::options::{Kind, Options, Unit};
use super::refused::Refused;

/// The most triplets that a joint takes.
pub const MOST: usize = 256;

/// The most bytes that the loader reads of a line at once.
const LINE: usize = 254;

/// The file of one joint. It holds numbers alone: a comment would end the table.
pub fn write(own: &Effect, base: f64, kind: Kind, unit: Unit) -> String {
    let mut text = String::new();
    for (place, (forward, reverse)) in own.nodes.iter().zip(own.forward.iter().zip(&own.reverse)) {
        let told = |trim: f64| match kind {
            Kind::Trim => trim + base,
            Kind::Actual => place - (trim + base),
        };
        let numbers =
            [*place, told(*forward), told(*reverse)].map(|number| decimal(number / unit.0, unit.decimals()));
        let _ = writeln!(text, "{}", numbers.join(" "));
    }
    text
}

/// The table of a joint as LinuxCNC holds it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    entries: Vec<Entry>,
    /// What the loader leaves out, with or without a word, line by line.
    pub findings: Vec<String>,
}

/// One entry: trims are kept with 24 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    nominal: f64,
    forward: f32,
    reverse: f32,
}

/// Reads a file as LinuxCNC's loader does.
pub fn read(text: &str, kind: Kind) -> Table {
    let mut table = Table::default();
    for (number, line) in chunks(text) {
        let Some([nominal, forward, reverse]) = triplet(line) else {
            let after = text.lines().count().saturating_sub(number);
            table.findings.push(format!(
                "line {number} is not a triplet: the loader stops there without a message and ignores {after} line{} after it",
                if after == 1 { "" } else { "s" }
            ));
            break;
        };
        let trim = |number: f64| match kind {
            Kind::Actual => nominal - number,
            Kind::Trim => number,
        };
        table.take(number, Entry { nominal, forward: single(trim(forward)), reverse: single(trim(reverse)) });
    }
    table
}

impl Table {
    /// Takes an entry as the motion controller does.
    fn take(&mut self, line: usize, entry: Entry) {
        if self.entries.len() >= MOST {
            self.findings.push(format!("line {line} is ignored: a joint takes {MOST} entries"));
        } else if self.entries.last().is_some_and(|last| entry.nominal <= last.nominal) {
            self.findings
                .push(format!("line {line} is ignored: its nominal position is not above the one before"));
        } else {
            self.entries.push(entry);
        }
    }

    /// The number of entries.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there is no compensation.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The nominal positions of the entries, in the machine's unit.
    pub fn nominals(&self) -> impl Iterator<Item = f64> {
        self.entries.iter().map(|entry| entry.nominal)
    }

    /// What is added to the joint's command, in the machine's unit: straight lines between entries, constant outside.
    pub fn trim(&self, position: f64, direction: Direction) -> f64 {
        let of = |entry: &Entry| match direction {
            Direction::Positive => entry.forward,
            Direction::Negative => entry.reverse,
        };
        let after = self.entries.partition_point(|entry| entry.nominal <= position);
        let here = after.checked_sub(1).and_then(|here| self.entries.get(here));
        match (here, self.entries.get(after)) {
            (Some(here), Some(next)) => {
                let slope = single(f64::from(of(next) - of(here)) / (next.nominal - here.nominal));
                f64::from(of(here)) + f64::from(slope) * (position - here.nominal)
            }
            (Some(end), None) | (None, Some(end)) => f64::from(of(end)),
            (None, None) => 0.0,
        }
    }
}

/// The lines as the loader's buffer cuts them, with their numbers.
fn chunks(text: &str) -> impl Iterator<Item = (usize, &[u8])> {
    let lines = text.lines().enumerate();
    lines.flat_map(|(number, line)| {
        let bytes = line.as_bytes();
        let empty = bytes.is_empty().then_some(bytes);
        bytes.chunks(LINE).chain(empty).map(move |chunk| (number + 1, chunk))
    })
}

/// Three numbers at the beginning of a line, whatever follows them.
fn triplet(line: &[u8]) -> Option<[f64; 3]> {
    let mut rest = line;
    let mut next = || {
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let number = rest.get(start..)?;
        let (value, length) = number_at(number)?;
        rest = number.get(length..)?;
        Some(value)
    };
    Some([next()?, next()?, next()?])
}

/// The decimal number that a text begins with, and its length. Unlike C's, no infinity and no hexadecimal number.
fn number_at(text: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(matches!(text.first(), Some(b'+' | b'-')));
    let whole = digits(text, sign);
    let point = usize::from(text.get(sign + whole) == Some(&b'.'));
    let after = if point == 1 { digits(text, sign + whole + 1) } else { 0 };
    if whole + after == 0 {
        return None;
    }
    let end = sign + whole + point + after;
    let exponent = match text.get(end) {
        Some(b'e' | b'E') => {
            let sign = usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
            let digits = digits(text, end + 1 + sign);
            if digits > 0 { 1 + sign + digits } else { 0 }
        }
        _ => 0,
    };
    let length = end + exponent;
    let number = std::str::from_utf8(text.get(..length)?).ok()?.parse().ok()?;
    Some((number, length))
}

fn digits(text: &[u8], from: usize) -> usize {
    text.iter().skip(from).take_while(|byte| byte.is_ascii_digit()).count()
}

#[expect(clippy::cast_possible_truncation, reason = "LinuxCNC stores trims and slopes in single precision")]
fn single(number: f64) -> f32 {
    number as f32
}

/// LinuxCNC with files for some of its joints.
#[derive(Clone, Debug)]
pub struct Joints {
    /// For each axis of the machine its table, where it has one.
    pub tables: Vec<Option<Table>>,
    /// The unit of each joint's table: degrees for one that turns.
    pub units: Vec<Unit>,
    /// The type of the files.
    pub kind: Kind,
}

impl Target for Joints {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let joints = self.tables.iter().zip(&self.units).zip(pose.position.iter().zip(&pose.direction));
        let trim = |((table, unit), (position, direction)): ((&Option<Table>, &Unit), (&f64, &Direction))| {
            table.as_ref().map_or(0.0, |table| table.trim(position / unit.0, *direction) * unit.0)
        };
        Ok(joints.map(trim).collect())
    }
}

impl Controller for Joints {
    fn load(&mut self, source: &SourceFile, axis: Option<usize>, diagnostics: &mut Diagnostics) {
        match axis.and_then(|axis| self.tables.get_mut(axis)) {
            Some(slot) => *slot = Some(read(source.text(), self.kind)),
            None => diagnostics.push(
                Diagnostic::error("E0804", Span::default(), "the file does not say which joint it is for")
                    .help("name the axis: --check X=x.comp"),
            ),
        }
    }

    fn findings(&self) -> Vec<String> {
        self.tables.iter().flatten().flat_map(|table| table.findings.clone()).collect()
    }

    fn target(&self) -> &dyn Target {
        self
    }
}

/// LinuxCNC without compensation.
pub(super) fn controller(job: &Job<'_, '_>) -> Joints {
    let axes = &job.geometry.equations.axes;
    let units = axes.iter().map(|axis| unit(axis, job.options)).collect();
    Joints { tables: vec![None; axes.len()], units, kind: job.options.kind }
}

/// The unit of a joint: the machine's for slides, degrees for what turns.
fn unit(axis: &AxisInfo, options: &Options) -> Unit {
    if axis.rotary { Unit::DEGREE } else { options.unit }
}

/// A file for each joint that corrects.
pub(super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let Job { geometry, space, options } = *job;
    let effects = Effects::new(geometry, space)?;
    let mut written = Written::default();
    for axis in effects.correcting() {
        let Some(info) = geometry.equations.axes.get(axis) else { continue };
        let nodes = effects.nodes(axis)?.at_any_places(Spacing { points: options.points, most: MOST })?;
        let own = effects.of(axis, &nodes)?.into_iter().find(|effect| effect.target == axis);
        let (Some(own), Some(base)) = (own, effects.base.get(axis)) else { continue };
        let name = format!("{}.comp", info.letter.to_lowercase());
        let kind = match options.kind {
            Kind::Actual => 0,
            Kind::Trim => 1,
        };
        let joints = joints(geometry.equations, axis);
        written.loading.push(format!(
            "[JOINT_n] of {joints}: COMP_FILE = {name} and COMP_FILE_TYPE = {kind}, and no BACKLASH beside them"
        ));
        let about = format!("{} triplets for the joint of {joints}", nodes.len());
        written.files.push(File {
            name,
            axis: Some(axis),
            text: write(&own, *base, options.kind, unit(info, options)),
            about,
        });
    }
    Ok(written)
}

/// The joint of an axis in words; the joints of both motors where two carry its beam.
fn joints(equations: &Equations, axis: usize) -> String {
    let is_of = |motor: &&AxisInfo| motor.follows.iter().any(|(followed, _)| *followed == axis);
    let motors: Vec<&str> = equations.axes.iter().filter(is_of).map(|motor| motor.letter.as_str()).collect();
    match equations.axes.get(axis) {
        Some(info) if motors.is_empty() => info.letter.clone(),
        _ => motors.join(" and of "),
    }
}
