//! The report: diagnoses that are put together by hand, as JSON against the contract, as text and as a page.

#![expect(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

mod cases;
mod contract;
mod page;
mod terminal;
mod words;
