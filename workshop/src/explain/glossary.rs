//! The words of the glossary. In: a word. Out: what the guide's glossary says of it, or nothing: the page of the guide and the command
//! have one source.

use textwrap::fill;

use super::page::WIDTH;

/// The guide's glossary: a paragraph each, `**Word, other word**: what it is.`
const GLOSSARY: &str = include_str!("../../../docs/guide/glossary.md");

/// A paragraph of the glossary: its words, and what it says of them.
struct Paragraph {
    words: &'static str,
    text: &'static str,
}

/// The page of a word; letter case does not matter, `-` stands for a space, and a plural for its singular.
pub(super) fn page(name: &str) -> Option<String> {
    let found = paragraphs().find(|one| one.words.split(", ").any(|word| same(word, name)))?;
    let text = found.text.split_whitespace().collect::<Vec<_>>().join(" ");
    // Marks of emphasis are for print.
    Some(format!("{}: a word of the glossary\n\n{}\n", found.words, fill(&text.replace('*', ""), WIDTH)))
}

/// All words of the glossary.
pub(super) fn words() -> impl Iterator<Item = &'static str> {
    paragraphs().flat_map(|one| one.words.split(", "))
}

fn paragraphs() -> impl Iterator<Item = Paragraph> {
    GLOSSARY.split("\n\n").filter_map(|text| {
        let (words, text) = text.trim().strip_prefix("**")?.split_once("**: ")?;
        Some(Paragraph { words, text })
    })
}

fn same(word: &str, name: &str) -> bool {
    let spelled = |text: &str| {
        let text = text.replace('-', " ").to_lowercase();
        text.strip_suffix('s').unwrap_or(&text).to_owned()
    };
    spelled(word) == spelled(name)
}
