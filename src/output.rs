//! Words on standard output and standard error. In: text. Out: all of it, or a failure.

use std::cell::RefCell;
use std::io::{self, IsTerminal, Write};

use anstream::stream::RawStream;
use anstream::{AutoStream, ColorChoice};
use diagnosis::report::{Terminal, WIDTH};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use workshop::failure::Failure;
use workshop::told::{Listener, Words};

use crate::arguments::Color;
use crate::progress::Progress;

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

/// Whether everything is coloured, also in files.
pub(crate) fn is_always_colored() -> bool {
    matches!(ColorChoice::global(), ColorChoice::Always | ColorChoice::AlwaysAnsi)
}

/// What standard output is shown on: a terminal with its width, or a file or pipe.
pub(crate) fn terminal() -> Terminal {
    let out = io::stdout();
    let width = out.is_terminal().then(|| terminal_size::terminal_size_of(&out)).flatten();
    let columns = width.map_or(WIDTH, |(width, _)| usize::from(width.0));
    Terminal { columns, color: is_colored(&out) }
}

/// Writes text to standard output. A reader that is gone is no failure: what else the command does, and what it says by its status, does
/// not depend on who reads on.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        done => done.map_err(|error| Failure::io("cannot write to standard output", &error)),
    }
}

/// Shows diagnostics on standard error, coloured where a person reads it.
pub(crate) fn show(source: &SourceFile, diagnostics: &Diagnostics) {
    say(&Words::marked(source, diagnostics));
}

/// Writes a line for people to standard error.
pub(crate) fn warn(text: &str) {
    say(&text.into());
}

/// Says on standard error why the command stopped.
pub(crate) fn report(failure: &Failure) {
    if let Some(words) = failure.words() {
        say(words);
    }
}

/// Writes words to standard error, coloured where a person reads it.
fn say(words: &Words) {
    if !words.is_empty() {
        // A command does its work even where nobody listens: there is nobody left to tell.
        let _ = writeln!(io::stderr(), "{}", words.text(is_colored(&io::stderr())));
    }
}

/// The person at the terminal.
#[derive(Default)]
pub(crate) struct Person {
    quiet: bool,
    /// The line about the work that began last.
    line: RefCell<Option<Progress>>,
}

impl Person {
    /// A person who wants to see how far the work is, unless `quiet`.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, line: RefCell::default() }
    }
}

impl Listener for Person {
    fn hear(&self, words: &Words) {
        say(words);
    }

    fn begin(&self, step: &str) {
        self.line.replace(Some(Progress::new(self.quiet, step)));
    }

    fn end(&self) {
        self.line.replace(None);
    }
}
