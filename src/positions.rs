//! Positions as CSV: which column is what, and rows as samples of the machine's state.

mod layout;
mod state;
mod summary;

use layout::Column;
pub(crate) use layout::{Layout, Wanted, output_columns};
pub(crate) use state::State;
pub(crate) use summary::Summary;
