//! The tests of the C interface, in one program. In: a slide as generated code would have it, calibrations of it. Out: what C
//! would be told.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    clippy::multiple_unsafe_ops_per_block,
    reason = "tests, whose helpers are theirs alone, and which do what C does, one call after another"
)]

mod directions;
mod files;
mod handle;
mod stage;
