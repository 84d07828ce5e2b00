//! What a code of a diagnostic, a term of the vocabulary, a factor, the name of an error motion, a topology word and a word of the
//! glossary mean. In: a name. Out: a page for a person, or the names that are near to it.
//!
//! The texts stand in files beside this one, in the form that `entry` reads: one source for the command and for the tables
//! of the reference, which are compared with it.

mod entry;
mod glossary;
mod motion;
mod page;
mod topology;

use model_dsl::calibration::factor::vocabulary::{FACTOR_NAMES, FactorEntry, FactorKind};
use model_dsl::suggest::nearest;

use entry::Entry;

/// The diagnostics, one file for each family of codes.
const CODES: [&str; 11] = [
    include_str!("explain/codes/E00.txt"),
    include_str!("explain/codes/E01.txt"),
    include_str!("explain/codes/W02.txt"),
    include_str!("explain/codes/E03.txt"),
    include_str!("explain/codes/E04.txt"),
    include_str!("explain/codes/E05.txt"),
    include_str!("explain/codes/E06.txt"),
    include_str!("explain/codes/E07.txt"),
    include_str!("explain/codes/E08.txt"),
    include_str!("explain/codes/E09.txt"),
    include_str!("explain/codes/E10.txt"),
];

/// The terms of calibration files, then the settings of instruments.
const TERMS: &str = include_str!("explain/terms.txt");

/// Examples of the factors of terms, in the order of the vocabulary.
const FACTORS: &str = include_str!("explain/factors.txt");

/// How many near names are told.
const NEAR: usize = 3;

fn codes() -> Vec<Entry<'static>> {
    CODES.iter().flat_map(|file| entry::read(file)).collect()
}

fn terms() -> Vec<Entry<'static>> {
    entry::read(TERMS)
}

/// The factors of the vocabulary, each with its example.
fn factors() -> Vec<(&'static FactorEntry, Entry<'static>)> {
    FactorKind::all().map(FactorKind::entry).zip(entry::read(FACTORS)).collect()
}

/// All codes and terms, a line each, and the words of the glossary.
pub fn overview() -> String {
    page::overview(&codes(), &terms(), &factors(), &glossary::words().collect::<Vec<_>>())
}

/// The page of a code, a term, a factor, an error motion, a topology word or a word of the glossary; a name that is several of a term,
/// a factor and a word gives all of them. Letter case and `_` for `-` do not matter.
///
/// # Errors
///
/// The nearest names, at most three, where there is no page of this one.
pub fn page(name: &str) -> Result<String, Vec<&'static str>> {
    let name = name.trim().replace('_', "-");
    let is = |entry: &Entry<'_>| entry.name.eq_ignore_ascii_case(&name);
    if let Some(code) = codes().iter().find(|entry| is(entry)) {
        return Ok(page::code(code));
    }
    let term = terms().iter().find(|entry| is(entry)).map(page::term);
    let factors = factors();
    let factor = factors.iter().find(|(_, entry)| is(entry)).map(|(known, entry)| page::factor(known, entry));
    let pages: Vec<String> = term.into_iter().chain(factor).chain(glossary::page(&name)).collect();
    if !pages.is_empty() {
        return Ok(pages.join("\n"));
    }
    motion::page(&name).or_else(|| topology::page(&name)).ok_or_else(|| near(&name))
}

/// The names nearest to one that is none, the nearest first.
fn near(name: &str) -> Vec<&'static str> {
    let mut names: Vec<&'static str> = terms().iter().chain(&codes()).map(|entry| entry.name).collect();
    names.extend(FACTOR_NAMES);
    // A word of the glossary that is a term too has one name: letters' case does not matter.
    let is_term = |word: &&str| names.iter().any(|name| name.eq_ignore_ascii_case(word));
    let words: Vec<&'static str> = glossary::words().filter(|word| !is_term(word)).collect();
    names.extend(words);
    names.sort_unstable();
    names.dedup();
    let mut found = Vec::new();
    while found.len() < NEAR
        && let Some(one) = nearest(name, names.iter().copied())
    {
        names.retain(|other| *other != one);
        found.push(one);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_told_nearest_first() {
        assert_eq!(near("baklash"), ["backlash"]);
        assert_eq!(near("E0201").first(), Some(&"E0001"));
        assert_eq!(near("E0201").len(), NEAR);
        assert!(near("banana").is_empty());
    }
}
