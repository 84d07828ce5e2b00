//! Positions as CSV: which column is what, and rows as samples of the machine's state.

mod doubts;
mod layout;
mod reach;
mod state;
mod summary;

pub(crate) use doubts::Doubts;
pub(crate) use layout::{Column, Layout, Wanted};
pub(crate) use reach::Reach;
pub(crate) use state::{State, quoted};
pub(crate) use summary::Summary;
