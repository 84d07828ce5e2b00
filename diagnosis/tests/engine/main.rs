//! The whole diagnosis on recordings of the exact machine: what was concealed must be found by name and in size, and
//! nothing else.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod common;
mod each_term;
#[path = "../../src/testing.rs"]
mod testing;

use diagnosis::recording;
