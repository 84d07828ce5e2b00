//! Recordings, read from files that are written here by hand, and from the example recordings where they are at hand.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod arbitrary;
#[path = "../../../tests/beside.rs"]
mod beside;
mod common;
mod data;
mod examples;
mod header;
mod hostile;
mod refused;
mod refused_data;
mod setup;
mod text_forms;
mod wide;
mod written;
