//! A fleet: recordings of many machines over years. In: a fleet file that says where the recordings of each machine are. Out: one result
//! for each recording, as tables that others read; what was found once, followed in every recording of its machine; and alarms about
//! what changed.
//!
//! One job is one recording. Its result is named by what it was made from (recording, data, machine, calibration, version of Abbe), is
//! written whole or not at all, and is the same bytes whoever makes it. So a run that was killed goes on where it was, two runs at once do
//! not harm each other, and another engine may hand out the same jobs.
//!
//! ```text
//! fleet file -> file, time -> jobs (key) -> plan: what is there already -> run
//!      -> diagnosed: rows of each recording -> results, shelf: tables of each month (table)
//!      -> effects: each once for a machine (name) -> followed: how large it is in every recording of it
//! results -> history (series) -> change, student: trends and steps; between: machines against each other -> alarms -> report
//! ```

pub mod add;
mod between;
#[cfg(test)]
mod chance;
mod change;
mod diagnosed;
mod effects;
pub mod file;
mod followed;
pub mod history;
mod jobs;
mod key;
mod name;
mod plan;
pub mod report;
mod results;
pub mod run;
mod series;
mod shelf;
mod student;
mod table;
mod time;

pub use change::Change;
pub use history::{History, history};
