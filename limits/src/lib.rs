//! Limits: what a recording could show.
//!
//! In: a recording of a machine, or a path that was not driven yet. Out: for each kind of effect in each error motion that the readings
//! see, from which size on it would be found in nine of ten cases and with which interval; and what can never be told apart.
//!
//! Nothing is assumed of the diagnosis: known effects are injected into the recording itself, at sizes near the limit, and diagnosed.
//!
//! ```text
//! recording -> subject: kinds in motions -> injection: the recording with one of them -> trial: what a diagnosis says
//!      -> search (posterior): the size that nine of ten find -> limits -> answer: plain data -> report: text, JSON, a page
//! a path -> plan, made: recordings of a machine as it is known; moves, passes: short paths that tell names apart
//! ```

pub mod answer;
pub mod injection;
pub mod limits;
mod made;
pub mod moves;
pub mod passes;
pub mod plan;
pub mod posterior;
pub mod report;
pub mod search;
pub mod size;
pub mod subject;
#[cfg(test)]
mod testing;
pub mod trial;

/// A count as a number.
fn number(count: usize) -> f64 {
    count as f64
}

/// The whole part of a number from 0 to some million, as an index.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and a million")]
fn index(value: f64) -> usize {
    value.clamp(0.0, 1e6) as usize
}

/// The whole part of a logarithm.
#[expect(clippy::cast_possible_truncation, reason = "the decimal logarithm of a number is within 400")]
fn whole(value: f64) -> i32 {
    value as i32
}
