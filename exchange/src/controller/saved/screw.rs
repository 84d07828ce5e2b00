//! LinuxCNC's screw compensation (`[JOINT_n] COMP_FILE`). In: triplets. Out: the trim of an axis, by direction.
//!
//! LinuxCNC adds the trim to the joint's command ([`linuxcnc`](crate::controller::linuxcnc)); with type 0 a triplet holds where the
//! joint really is. The trim of a nominal position is what the joint fell short of it when it was commanded there, so that the
//! error at that command is minus the trim.

use abbe_runtime::Direction;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{SourceFile, Span};

use super::{Saved, SavedWanted};
use crate::controller::linuxcnc;
use crate::controller::options::Unit;

/// A trim without the last bits of single precision: to a nanometre.
const STEPS: f64 = 1e6;

/// The table of a screw.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Screw {
    /// The axis: an index into the machine's axes.
    pub(super) axis: usize,
    /// Nominal positions, mm, rising.
    pub(super) places: Vec<f64>,
    /// What is added where the axis came in its positive direction, mm.
    pub(super) forward: Vec<f64>,
    /// What is added where it came in its negative direction, mm.
    pub(super) reverse: Vec<f64>,
}

/// Whether a text begins with a triplet.
pub(super) fn is_here(text: &str) -> bool {
    let mut words = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default().split_whitespace();
    let mut is_number = || words.next().is_some_and(|word| word.parse::<f64>().is_ok());
    is_number() && is_number() && is_number()
}

/// Reads a table as LinuxCNC's loader does; what the loader leaves out is told.
pub(super) fn read(source: &SourceFile, wanted: &SavedWanted, diagnostics: &mut Diagnostics) -> Saved {
    let mut refuse = |code, message: &str, help: &str| {
        diagnostics.push(Diagnostic::error(code, Span::default(), message).help(help));
        Saved::default()
    };
    let Some(axis) = wanted.axis else {
        let help = "name the axis: `axis: X`";
        return refuse("E0804", "a screw table does not say which joint it is for", help);
    };
    let Some(kind) = wanted.kind else {
        let help = "give COMP_FILE_TYPE from the machine's INI file: `type: 0` or `type: 1`; the same row has the opposite meaning in the two types";
        return refuse("E0804", "a screw table does not say which type it has", help);
    };
    let table = linuxcnc::read(source.text(), kind);
    if table.len() < 2 {
        let message = "the loader takes fewer than two triplets of this table";
        return refuse(
            "E0803",
            message,
            "write lines of three numbers, beginning with the first line: nominal, forward, reverse",
        );
    }
    for finding in &table.findings {
        let help = "correct the file; LinuxCNC uses only the rest, and so does this calibration";
        diagnostics.push(Diagnostic::warning("W0802", Span::default(), finding.clone()).help(help));
    }
    let Unit(unit) = wanted.unit.unwrap_or(Unit::MM);
    let nominal: Vec<f64> = table.nominals().collect();
    let trims = |direction| {
        nominal.iter().map(|place| nanometres(table.trim(*place, direction) * unit)).collect::<Vec<f64>>()
    };
    let screw = Screw {
        axis,
        forward: trims(Direction::Positive),
        reverse: trims(Direction::Negative),
        places: nominal.iter().map(|place| place * unit).collect(),
    };
    Saved { screw: Some(screw), ..Saved::default() }
}

fn nanometres(trim: f64) -> f64 {
    (trim * STEPS).round() / STEPS
}
