//! Evaluations of data whose figures are known: a printed data set, closed forms, and the exact machine, which shares no code
//! with what is tested.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod bench;
mod circles;
mod diagonals;
mod fits;
mod page;
mod positioning;
mod printed;
