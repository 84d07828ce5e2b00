//! Readers of others that panic where a file is broken. In: a call of one. Out: what it gives, or that it failed.
//!
//! The readers of Parquet and of workbooks check much and not all: an assertion on what a file says of itself, or a sum that
//! is too large, ends the program. Here it ends the reading. Nothing that such a call has begun is used afterwards.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

use super::error::DataError;

thread_local! {
    /// Whether this thread reads with what may panic.
    static READS: Cell<bool> = const { Cell::new(false) };
}

/// The hook is taken over once for the program: many threads read at a time.
static HOOK: Once = Once::new();

/// Panics of this thread are not shown while it reads; all others are, as before.
fn keep_quiet() {
    HOOK.call_once(|| {
        let shown = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !READS.get() {
                shown(panic);
            }
        }));
    });
}

/// Reads a file, whatever is wrong with it. What the reader would print on a panic is not shown.
pub(super) fn contained<T>(name: &str, read: impl FnOnce() -> Result<T, DataError>) -> Result<T, DataError> {
    keep_quiet();
    READS.set(true);
    let read = panic::catch_unwind(AssertUnwindSafe(read));
    READS.set(false);
    read.unwrap_or_else(|_| {
        let error = DataError::new(name, "it cannot be read: its description of itself is wrong");
        Err(error.help("write the file again, or save the table as CSV"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reader_that_panics_has_failed_and_the_next_one_reads() {
        let failed = contained("x", || -> Result<u8, DataError> { panic!("a sum that is too large") });
        assert!(failed.unwrap_err().message.contains("it cannot be read"));
        assert_eq!(contained("x", || Ok(7)).unwrap(), 7);
        // Panics of a test are shown as before.
        assert!(!READS.get());
    }
}
