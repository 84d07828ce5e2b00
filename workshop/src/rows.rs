//! Rows of positions as samples of a machine's state. In: a calibrated machine and the numbers of rows, one after the other. Out: what
//! the runtime reads in each: directions, velocities and temperatures included; and, of a whole table, the answers.
//!
//! A stream is taken row by row ([`State`], [`Samples`]) and answered whenever enough of it has come ([`Answering`]); a table that is in
//! memory is answered at once ([`table::answer`]).

mod answering;
pub mod field;
mod leaning;
mod needs;
mod samples;
mod state;
pub mod table;

pub use answering::{Answer, Answering, Room};
pub use leaning::Lean;
pub use needs::{Timed, timed};
pub use samples::Samples;
pub use state::{FARTHEST, Row, State};

use leaning::Leaning;

use model_dsl::equations::Equations;

/// The columns that a compensation adds: the error in each sensitive direction, that of the tool's direction where it is derived, the
/// compensated position of each axis.
pub fn output_columns(equations: &Equations) -> Vec<String> {
    let positions = equations.axes.iter().map(|axis| format!("{}_comp", axis.variable));
    error_columns(equations).into_iter().chain(positions).collect()
}

/// The error in each sensitive direction (mm), then that of the tool's direction where it is derived (rad): `error_x`, `error_i`.
pub fn error_columns(equations: &Equations) -> Vec<String> {
    let tip = equations.rows.iter().map(|row| row.direction.letter());
    let direction = equations.orientation.iter().map(|row| row.direction.direction_letter());
    tip.chain(direction).map(|letter| format!("error_{}", letter.to_ascii_lowercase())).collect()
}
