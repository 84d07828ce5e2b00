//! Words on standard output and standard error. In: text. Out: all of it, or a failure.

use std::io::{self, IsTerminal, Write};

use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use diagnosis::report::{Terminal, WIDTH};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

use crate::arguments::Color;
use crate::failure::Failure;

/// Decides for the whole program what is coloured.
pub(crate) fn color(choice: Color) {
    let choice = match choice {
        Color::Auto => ColorChoice::Auto,
        Color::Always => ColorChoice::AlwaysAnsi,
        Color::Never => ColorChoice::Never,
    };
    choice.write_global();
}

/// Whether what goes to a stream is coloured: by the user's choice, and else where a terminal shows it that knows colours,
/// NO_COLOR being unset.
fn is_colored(stream: &impl RawStream) -> bool {
    AutoStream::choice(stream) != ColorChoice::Never
}

/// What standard output is shown on: a terminal with its width, or a file or pipe.
pub(crate) fn terminal() -> Terminal {
    let out = io::stdout();
    let width = out.is_terminal().then(|| terminal_size::terminal_size_of(&out)).flatten();
    let columns = width.map_or(WIDTH, |(width, _)| usize::from(width.0));
    Terminal { columns, color: is_colored(&out) }
}

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
    render(source, diagnostics, is_colored(&io::stderr()))
}

/// Writes a line for people to standard error.
pub(crate) fn warn(text: &str) {
    // A command does its work even where nobody listens to its warnings.
    let _ = writeln!(io::stderr(), "{}", text.trim_end());
}
