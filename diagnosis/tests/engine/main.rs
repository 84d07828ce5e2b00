//! The whole diagnosis on recordings of the exact machine: what was concealed must be found by name and in size, and
//! nothing else.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod audit;
#[path = "../../../tests/beside.rs"]
#[expect(dead_code, reason = "tests of other crates use the rest")]
mod beside;
mod common;
mod confusions;
mod datum;
mod drives;
mod each_term;
mod evidence;
mod forms;
mod invariances;
mod large;
mod motors;
mod pictures;
mod set_up;
#[path = "../../src/testing.rs"]
mod testing;
mod verdicts;
mod ways;

// What the machines and recordings of the tests are made for, under the name that they know it by.
use ::recording;
use abbe_diagnosis::{Chains, Inputs};
