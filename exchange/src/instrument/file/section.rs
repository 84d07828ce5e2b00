//! Text in sections, as Renishaw writes it. In: a text. Out: its sections by name, each with its lines and their places.

use model_dsl::source::Span;

use super::cell::{Piece, lines};

/// The mark behind a section's name.
const MARK: &str = "::";

/// A section: `RUNS::` and the lines up to the next one.
#[derive(Debug)]
pub(super) struct Section<'t> {
    /// Its name in capitals, without the mark.
    pub(super) name: String,
    /// Where its name stands.
    pub(super) span: Span,
    /// Its lines that are not empty.
    pub(super) lines: Vec<Piece<'t>>,
}

/// Whether a text begins with a section.
pub(super) fn is_sectioned(text: &str) -> bool {
    lines(text)
        .map(Piece::trimmed)
        .find(|line| !line.text.is_empty())
        .is_some_and(|line| name(line).is_some())
}

fn name(line: Piece<'_>) -> Option<String> {
    let name = line.trimmed().text.strip_suffix(MARK)?.trim();
    let plain = name.chars().all(|letter| letter.is_ascii_alphabetic() || " -".contains(letter));
    (plain && !name.is_empty()).then(|| name.to_ascii_uppercase())
}

/// All sections, in order. What stands before the first one belongs to none.
pub(super) fn sections(text: &str) -> Vec<Section<'_>> {
    let mut all: Vec<Section<'_>> = Vec::new();
    for line in lines(text).map(Piece::trimmed).filter(|line| !line.text.is_empty()) {
        match (name(line), all.last_mut()) {
            (Some(name), _) => all.push(Section { name, span: line.span, lines: Vec::new() }),
            (None, Some(section)) => section.lines.push(line),
            (None, None) => {}
        }
    }
    all
}

impl<'t> Section<'t> {
    /// The entries `key: value`, the key as it is written.
    pub(super) fn entries(&self) -> impl Iterator<Item = (&'t str, Piece<'t>)> {
        self.lines.iter().filter_map(|line| {
            let (key, value) = line.split_once(':')?;
            Some((key.text.trim(), value.trimmed()))
        })
    }

    /// The value of a key, letter case and spaces aside.
    pub(super) fn entry(&self, key: &str) -> Option<Piece<'t>> {
        self.entries().find(|(name, _)| is(name, key)).map(|(_, value)| value)
    }
}

/// Whether a key is the one that is meant: `Target-count`, `Target count` and `TARGET-COUNT` are one.
pub(super) fn is(name: &str, key: &str) -> bool {
    let plain = |text: &str| -> String {
        text.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_lowercase()).collect()
    };
    plain(name) == plain(key)
}
