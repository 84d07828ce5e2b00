//! How work ends that does not succeed. In: what went wrong. Out: its class, and words about it.

use std::io;

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use crate::told::Words;

/// Why work stopped.
#[derive(Clone, Debug)]
pub enum Failure {
    /// The check or the data says no: status 1 of the command line. The words may be none where all is said already.
    No(Words),
    /// The command or a file is wrong: status 2.
    Wrong(Words),
    /// The reader of the output is gone: nothing is wrong, and nothing more can be said.
    ClosedPipe,
}

impl Failure {
    /// The check or the data says no.
    pub fn no(words: impl Into<Words>) -> Self {
        Self::No(words.into())
    }

    /// The command or a file is wrong.
    pub fn wrong(words: impl Into<Words>) -> Self {
        Self::Wrong(words.into())
    }

    /// A file is wrong at the places that were found.
    #[must_use]
    pub fn marked(source: &SourceFile, found: &Diagnostics) -> Self {
        Self::Wrong(Words::marked(source, found))
    }

    /// A failure to read or write something.
    #[must_use]
    pub fn io(what: &str, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::ClosedPipe,
            _ => Self::wrong(format!("error: {what}: {error}")),
        }
    }

    /// What is said of it; nothing where the reader is gone.
    #[must_use]
    pub fn words(&self) -> Option<&Words> {
        match self {
            Self::No(words) | Self::Wrong(words) => Some(words),
            Self::ClosedPipe => None,
        }
    }
}
