//! Hostile files. In: any bytes, as a file of one of the kinds that Abbe reads. Out: nothing, or a panic where a promise does
//! not hold: every file ends in an answer or in findings that lie within it, in bounded time and memory, and no number that
//! is not finite is given as an answer.
//!
//! Each module has one function, `run`, which goes with the bytes as far as the program would. The search by coverage, in
//! `targets/`, and the tests of the workspace, which know [`mutate`] alone, call the same functions.

pub mod calibration;
pub mod equations;
pub mod fleet;
pub mod instrument;
pub mod machine;
pub mod mutate;
pub mod path;
pub mod positions;
pub mod recording;
mod text;

/// Takes a file and panics where a promise does not hold.
pub type Run = fn(&[u8]);

/// Every kind of file with its function.
pub const TARGETS: [(&str, Run); 8] = [
    ("machine", machine::run),
    ("calibration", calibration::run),
    ("recording", recording::run),
    ("equations", equations::run),
    ("path", path::run),
    ("positions", positions::run),
    ("instrument", instrument::run),
    ("fleet", fleet::run),
];
