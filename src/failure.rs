//! How a command ends when it does not succeed. In: what went wrong. Out: words on standard
//! error and the exit status of its class.

use std::io::{self, Write};
use std::process::ExitCode;

/// Why a command stopped.
pub(crate) enum Failure {
    /// The check or the data says no: status 1. The text may be empty where all is said already.
    No(String),
    /// The command or a file is wrong: status 2.
    Wrong(String),
    /// The reader of standard output is gone: nothing is wrong, and nothing more can be said.
    ClosedPipe,
}

impl Failure {
    /// A failure to read or write something.
    pub(crate) fn io(what: &str, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ClosedPipe,
            _ => Self::Wrong(format!("error: {what}: {error}")),
        }
    }

    /// Says it on standard error.
    pub(crate) fn report(&self) {
        if let Self::No(text) | Self::Wrong(text) = self
            && !text.is_empty()
        {
            // Where standard error itself is gone there is nobody left to tell.
            let _ = writeln!(io::stderr(), "{}", text.trim_end());
        }
    }

    /// The exit status.
    pub(crate) fn status(&self) -> ExitCode {
        match self {
            Self::No(_) => ExitCode::from(1),
            Self::Wrong(_) => ExitCode::from(2),
            Self::ClosedPipe => ExitCode::SUCCESS,
        }
    }
}
