//! The tests of the C interface, in one program. In: a slide as generated code would have it, calibrations of it. Out: what C
//! would be told.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::multiple_unsafe_ops_per_block,
    reason = "a panic is the report of a test, also from what tests share; and they do what C does, one call after another"
)]

mod aiming;
mod directions;
mod files;
mod handle;
mod stage;
