//! "Did you mean ...?": the nearest of the names that would have been right.
//!
//! In: a word that is not known and the names that are. Out: the nearest name, or nothing where none is near
//! enough to be of help.

/// The candidate nearest to a word by edits (insert, delete, replace, swap neighbours), letter case aside.
///
/// A third of the word's letters may differ. A word that no candidate is that near to is taken as an
/// abbreviation: the first candidate that it begins, from three letters on. Of equally near ones the first counts.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = letters(word);
    let length = word.chars().count();
    let allowed = allowed_edits(length);
    let mut best: Option<(usize, &str)> = None;
    let mut abbreviated = None;
    for candidate in candidates {
        let name = letters(candidate);
        if length >= 3 && name.starts_with(&word) {
            abbreviated = abbreviated.or(Some(candidate));
        }
        let distance = strsim::osa_distance(&word, &name);
        if distance <= allowed && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, name)| name).or(abbreviated)
}

/// Whether a word is a slip of another one: the same in other letter case or, from four letters on, but for one edit.
pub fn is_slip(word: &str, of: &str) -> bool {
    let (word, of) = (letters(word), letters(of));
    word == of || of.chars().count() >= 4 && strsim::osa_distance(&word, &of) == 1
}

/// Small letters, and no more of them than a name has.
fn letters(word: &str) -> String {
    word.chars().flat_map(char::to_lowercase).take(64).collect()
}

fn allowed_edits(length: usize) -> usize {
    match length {
        0 | 1 => 0,
        2..=5 => 1,
        longer => longer / 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEYS: [&str; 5] = ["slide", "along", "origin", "errors", "coefficients"];

    #[test]
    fn finds_the_slip() {
        assert_eq!(nearest("orgin", KEYS), Some("origin"));
        assert_eq!(nearest("Origin", KEYS), Some("origin"));
        assert_eq!(nearest("silde", KEYS), Some("slide"));
        assert_eq!(nearest("erorrs", KEYS), Some("errors"));
        assert_eq!(nearest("coef", KEYS), Some("coefficients"));
        assert_eq!(nearest("cofficents", KEYS), Some("coefficients"));
    }

    #[test]
    fn stays_silent_when_nothing_is_near() {
        assert_eq!(nearest("banana", KEYS), None);
        assert_eq!(nearest("", KEYS), None);
        assert_eq!(nearest("q", ["m", "s"]), None);
        assert_eq!(nearest("x", std::iter::empty()), None);
    }

    #[test]
    fn the_first_of_equals_counts() {
        assert_eq!(nearest("EXW", ["EXX", "EXY"]), Some("EXX"));
        assert_eq!(nearest("MM", ["mm", "nm"]), Some("mm"));
    }

    #[test]
    fn a_slip_is_one_edit_away() {
        for (word, of) in [("Dir_y", "dir_y"), ("dr_y", "dir_y"), ("Tools", "tool"), ("T", "t")] {
            assert!(is_slip(word, of), "{word}");
        }
        for (word, of) in [("n", "t"), ("tl", "tool"), ("Tool_1", "tool"), ("direction", "dir_y")] {
            assert!(!is_slip(word, of), "{word}");
        }
    }

    #[test]
    fn a_very_long_word_costs_little() {
        assert_eq!(nearest(&"x".repeat(1_000_000), KEYS), None);
    }
}
