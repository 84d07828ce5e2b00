//! Readers of others that panic where a file is broken. In: a call of one. Out: what it gives, or that it failed.
//!
//! The readers of Parquet and of workbooks check much and not all: an assertion on what a file says of itself, or a sum that
//! is too large, ends the program. Here it ends the reading. Nothing that such a call has begun is used afterwards.

use std::panic::{self, AssertUnwindSafe};

use super::super::Recording;
use super::error::DataError;

/// Reads a file, whatever is wrong with it. What the reader would print on a panic is not shown.
pub(super) fn contained(
    name: &str,
    read: impl FnOnce() -> Result<Recording, DataError>,
) -> Result<Recording, DataError> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| ()));
    let read = panic::catch_unwind(AssertUnwindSafe(read));
    panic::set_hook(hook);
    read.unwrap_or_else(|_| {
        let error = DataError::new(name, "it cannot be read: what it says of itself does not hold");
        Err(error.help("write the file anew, or save the table as CSV"))
    })
}
