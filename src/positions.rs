//! Positions as CSV: which column is what, and rows as samples of the machine's state.

mod layout;
mod pending;
mod state;
mod summary;

use layout::Column;
pub(crate) use layout::{Layout, Wanted};
pub(crate) use pending::Pending;
pub(crate) use state::{State, quoted};
pub(crate) use summary::Summary;
