//! Weight and colour on a terminal. In: words, and whether the terminal shows colour. Out: the words, set off by the codes
//! that terminals know; the words themselves where it shows none. Nothing is told by colour alone.

use anstyle::{AnsiColor, Style};

use crate::diagnosis::{Diagnosis, Verdict};

/// The codes, or none.
#[derive(Clone, Copy)]
pub(super) struct Ink {
    color: bool,
}

impl Ink {
    pub(super) fn new(color: bool) -> Self {
        Self { color }
    }

    /// Headings and names.
    pub(super) fn strong(self, text: &str) -> String {
        self.set(Style::new().bold(), text)
    }

    /// Names of columns.
    pub(super) fn quiet(self, text: &str) -> String {
        self.set(Style::new().dimmed(), text)
    }

    /// The names of motions.
    pub(super) fn name(self, text: &str) -> String {
        self.set(AnsiColor::Cyan.on_default().bold(), text)
    }

    /// The verdict, its first words set off.
    pub(super) fn verdict(self, diagnosis: &Diagnosis, text: &str) -> String {
        let color = match diagnosis.verdict {
            Verdict::Adequate => AnsiColor::Green,
            Verdict::LeftOutPhysics => AnsiColor::Yellow,
            Verdict::Undecided | Verdict::Unexplained | Verdict::NotRepeatable => AnsiColor::Magenta,
        };
        match text.split_once(':') {
            Some((word, rest)) => self.set(color.on_default().bold(), word) + ":" + rest,
            None => text.to_owned(),
        }
    }

    /// The text between the codes; a line end stays outside.
    fn set(self, style: Style, text: &str) -> String {
        if !self.color {
            return text.to_owned();
        }
        let line = text.trim_end_matches('\n');
        let end = &text[line.len()..];
        format!("{style}{line}{style:#}{end}")
    }
}
