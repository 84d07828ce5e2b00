//! What is said to a person. In: sentences, and what is wrong with files. Out: words that a terminal, a notebook or a log shows in
//! its own way, and the one who hears them.
//!
//! Nothing here prints: who reads files for a person says what it has to say to a [`Listener`].

use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

/// Sentences and marked places of files, in the order in which they are read.
#[derive(Clone, Default, Debug)]
pub struct Words {
    parts: Vec<Part>,
}

/// A part of what is said.
#[derive(Clone, Debug)]
pub enum Part {
    /// A sentence, or lines of them.
    Plain(String),
    /// What was found in a file, at its places there.
    Marked {
        /// The file.
        source: SourceFile,
        /// What was found in it.
        found: Diagnostics,
    },
}

impl Words {
    /// What was found in a file.
    #[must_use]
    pub fn marked(source: &SourceFile, found: &Diagnostics) -> Self {
        Self { parts: vec![Part::Marked { source: source.clone(), found: found.clone() }] }
    }

    /// The words with others after them.
    #[must_use]
    pub fn then(mut self, others: impl Into<Self>) -> Self {
        self.parts.extend(others.into().parts);
        self
    }

    /// The parts, one after another.
    pub fn parts(&self) -> impl Iterator<Item = &Part> {
        self.parts.iter()
    }

    /// Whether nothing is said.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parts.iter().all(Part::is_empty)
    }

    /// The words as text without a line feed at its end, `colored` for a terminal that knows colours.
    #[must_use]
    pub fn text(&self, colored: bool) -> String {
        let parts = self.parts.iter().filter(|part| !part.is_empty());
        let parts: Vec<String> = parts.map(|part| part.text(colored).trim_end().to_owned()).collect();
        parts.join("\n")
    }
}

impl From<String> for Words {
    fn from(text: String) -> Self {
        Self { parts: vec![Part::Plain(text)] }
    }
}

impl From<&str> for Words {
    fn from(text: &str) -> Self {
        Self::from(text.to_owned())
    }
}

impl Part {
    fn is_empty(&self) -> bool {
        match self {
            Self::Plain(text) => text.is_empty(),
            Self::Marked { found, .. } => found.is_empty(),
        }
    }

    fn text(&self, colored: bool) -> String {
        match self {
            Self::Plain(text) => text.clone(),
            Self::Marked { source, found } => render(source, found, colored),
        }
    }
}

/// Who hears what does not stop the work.
pub trait Listener {
    /// Hears a warning or a note.
    fn hear(&self, words: &Words);

    /// Work begins that may take long: a few words that say what is done.
    fn begin(&self, step: &str) {
        let _ = step;
    }

    /// The work that began last is over.
    fn end(&self) {}
}

/// Nobody listens.
impl Listener for () {
    fn hear(&self, _: &Words) {}
}
