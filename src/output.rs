//! Words on standard output and standard error. In: text. Out: all of it, or a failure.

use std::io::{self, IsTerminal, Write};

use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

use crate::failure::Failure;

/// Writes text to standard output.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(|error| Failure::io("cannot write to standard output", &error))
}

/// Shows diagnostics on standard error, coloured where a person reads it.
pub(crate) fn show(source: &SourceFile, diagnostics: &Diagnostics) {
    if !diagnostics.is_empty() {
        warn(&rendered(source, diagnostics));
    }
}

/// The diagnostics of a file as text, coloured where a person reads standard error.
pub(crate) fn rendered(source: &SourceFile, diagnostics: &Diagnostics) -> String {
    let color = io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    render(source, diagnostics, color)
}

/// Writes a line for people to standard error.
pub(crate) fn warn(text: &str) {
    // A command does its work even where nobody listens to its warnings.
    let _ = writeln!(io::stderr(), "{}", text.trim_end());
}
