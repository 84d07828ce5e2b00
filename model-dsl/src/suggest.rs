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
    let allowed = allowed_edits(word.len());
    let mut best: Option<(usize, &str)> = None;
    let mut abbreviated = None;
    for candidate in candidates {
        let name = letters(candidate);
        if word.len() >= 3 && name.starts_with(&word) {
            abbreviated = abbreviated.or(Some(candidate));
        }
        if word.len().abs_diff(name.len()) > allowed {
            continue;
        }
        let distance = edit_distance(&word, &name);
        if distance <= allowed && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, name)| name).or(abbreviated)
}

fn letters(word: &str) -> Vec<char> {
    word.chars().flat_map(char::to_lowercase).take(64).collect()
}

fn allowed_edits(length: usize) -> usize {
    match length {
        0 | 1 => 0,
        2..=5 => 1,
        longer => longer / 3,
    }
}

/// Optimal string alignment distance, three rows at a time.
fn edit_distance(left: &[char], right: &[char]) -> usize {
    let mut before = vec![0; right.len() + 1];
    let mut above: Vec<usize> = (0..=right.len()).collect();
    let mut previous = None;
    for (row, &letter) in left.iter().enumerate() {
        let current = next_row(row + 1, previous, letter, right, &before, &above);
        before = std::mem::replace(&mut above, current);
        previous = Some(letter);
    }
    above.last().copied().unwrap_or(0)
}

fn next_row(
    row: usize,
    previous: Option<char>,
    letter: char,
    right: &[char],
    before: &[usize],
    above: &[usize],
) -> Vec<usize> {
    let mut current = Vec::with_capacity(above.len());
    let mut left_cell = row;
    current.push(row);
    for (column, &other) in right.iter().enumerate() {
        let at = |cells: &[usize], index: usize| cells.get(index).copied().unwrap_or(usize::MAX / 2);
        let replaced = at(above, column) + usize::from(letter != other);
        let mut least = replaced.min(left_cell + 1).min(at(above, column + 1) + 1);
        let one_back = column.checked_sub(1).and_then(|index| right.get(index).map(|&found| (index, found)));
        if let (Some(earlier), Some((index, found))) = (previous, one_back)
            && earlier == other
            && letter == found
        {
            least = least.min(at(before, index) + 1);
        }
        current.push(least);
        left_cell = least;
    }
    current
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
    fn counts_edits() {
        let count = |left: &str, right: &str| edit_distance(&letters(left), &letters(right));
        assert_eq!(count("", "abc"), 3);
        assert_eq!(count("abc", ""), 3);
        assert_eq!(count("abc", "acb"), 1);
        assert_eq!(count("kitten", "sitting"), 3);
        assert_eq!(count("same", "same"), 0);
    }

    #[test]
    fn a_very_long_word_costs_little() {
        assert_eq!(nearest(&"x".repeat(1_000_000), KEYS), None);
    }
}
