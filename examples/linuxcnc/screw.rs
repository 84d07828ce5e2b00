//! LinuxCNC's own screw compensation beside what Abbe's reader makes of the same files. In: samples of `screw.hal`, and the files.
//! Out: the greatest difference.

use std::error::Error;

use abbe_runtime::Direction;
use exchange::controller::Kind;
use exchange::controller::linuxcnc::{Table, read};

/// Half a unit of the last place that halsampler writes, mm, and what single precision adds to it.
const SAME: f64 = 6e-7;

/// A joint's position, velocity and trim.
const COLUMNS: usize = 3;

/// How a table and LinuxCNC agree.
pub(crate) struct Agreement {
    /// Cycles in which the joint moved forward, and in reverse.
    pub(crate) moved: [usize; 2],
    /// The greatest trim, mm.
    pub(crate) greatest: f64,
    /// The greatest difference, mm.
    pub(crate) difference: f64,
}

impl Agreement {
    /// Whether they are the same.
    pub(crate) fn holds(&self) -> bool {
        self.difference <= SAME
    }
}

/// The table of a file with the `COMP_FILE_TYPE` that it was loaded with.
pub(crate) fn table(text: &str, kind: &str) -> Result<Table, Box<dyn Error>> {
    match kind {
        "0" => Ok(read(text, Kind::Actual)),
        "1" => Ok(read(text, Kind::Trim)),
        _ => Err(format!("`{kind}` is no COMP_FILE_TYPE").into()),
    }
}

/// Compares a joint's samples with a table, in every cycle in which it moves.
pub(crate) fn agreement(samples: &str, joint: usize, table: &Table) -> Result<Agreement, Box<dyn Error>> {
    let mut agreement = Agreement { moved: [0; 2], greatest: 0.0, difference: 0.0 };
    for line in samples.lines() {
        let numbers: Vec<f64> = line
            .split_whitespace()
            .skip(joint * COLUMNS)
            .take(COLUMNS)
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        let [position, velocity, trim] = numbers[..] else {
            return Err(format!("a sample is cut: {line}").into());
        };
        let (way, direction) =
            if velocity > 0.0 { (0, Direction::Positive) } else { (1, Direction::Negative) };
        if velocity != 0.0 {
            agreement.moved[way] += 1;
            agreement.greatest = agreement.greatest.max(trim.abs());
            agreement.difference = agreement.difference.max((table.trim(position, direction) - trim).abs());
        }
    }
    Ok(agreement)
}
