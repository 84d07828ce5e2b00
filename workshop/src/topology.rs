//! Topology words of machines. In: a machine as it was loaded. Out: its word, and the same machine with another one.

use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::{compile, compile_word, yaml};

use crate::load::Loaded;

/// The topology word of a machine, and the file that has it.
#[derive(Clone)]
pub struct Topology {
    /// The word.
    pub word: String,
    /// The file's name; of a bare word the word itself.
    pub file: String,
    source: Option<SourceFile>,
}

impl Topology {
    /// The word of a machine, where it has one: a chain that is written out has none.
    pub fn of(loaded: &Loaded) -> Option<Self> {
        let word = loaded.compiled.machine.topology.clone()?;
        let source = loaded.source.clone();
        let file = source.as_ref().map_or(&*word, |source| source.name()).to_owned();
        Some(Self { word, file, source })
    }

    /// The equations of the machine with another word; `None` where that is no machine.
    pub fn derive(&self, word: &str) -> Option<Equations> {
        let mut diagnostics = Diagnostics::new();
        let compiled = match &self.source {
            Some(source) => compile(&self.rewritten(source, word)?, &mut diagnostics),
            None => compile_word(word, &mut diagnostics),
        };
        compiled.map(|compiled| compiled.equations)
    }

    /// The machine file with another word.
    pub fn file_with(&self, word: &str) -> Option<SourceFile> {
        self.source.as_ref().and_then(|source| self.rewritten(source, word))
    }

    fn rewritten(&self, source: &SourceFile, word: &str) -> Option<SourceFile> {
        let root = yaml::read(source, &mut Diagnostics::new())?;
        let place = root.get("topology")?.span;
        let (before, after) = (source.text().get(..place.start)?, source.text().get(place.end..)?);
        Some(SourceFile::new(source.name(), format!("{before}{word}{after}")))
    }
}
