//! The laws of the exact machine. In: small machines with few errors. Out: what must hold of their recordings, from
//! formulas that are written here a second time.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod common;
mod effects;
mod faults;
mod files;
mod instruments;
mod motors;
mod path_files;
mod runtime;
