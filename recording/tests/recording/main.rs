//! Recordings, read from files that are written here by hand, and from the example recordings where they are at hand.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a panic is the report of a test, also from a function that tests share; what is skipped is printed"
)]

mod arbitrary;
mod common;
mod data;
mod examples;
mod header;
#[cfg(feature = "parquet")]
mod parquet;
mod refused;
mod refused_data;
mod setup;
