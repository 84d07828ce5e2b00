//! Line breaks. In: pieces of an equation or words of a sentence. Out: lines of bounded width.

use std::ops::Range;

/// The widest line of plain text, in characters.
pub(super) const WIDTH: usize = 100;

/// Which pieces stand together on a line so that no line is wider than `width`, one piece at least.
pub(super) fn lines(pieces: &[String], width: usize) -> Vec<Range<usize>> {
    let mut lines: Vec<Range<usize>> = Vec::new();
    let mut used = 0;
    for (number, piece) in pieces.iter().enumerate() {
        let length = piece.chars().count();
        match lines.last_mut() {
            Some(line) if used + length <= width => {
                line.end = number + 1;
                used += length;
            }
            _ => {
                lines.push(number..number + 1);
                used = length;
            }
        }
    }
    lines
}

/// The pieces of one line, joined.
pub(super) fn join(pieces: &[String], line: Range<usize>) -> String {
    pieces.get(line).map(<[String]>::concat).unwrap_or_default()
}

/// A head followed by an equation's pieces, continued under the first of them.
pub(super) fn equation(head: &str, pieces: &[String]) -> String {
    let indent = head.chars().count();
    let mut text = head.to_owned();
    for (number, line) in lines(pieces, WIDTH.saturating_sub(indent)).into_iter().enumerate() {
        let written = join(pieces, line);
        if number == 0 {
            text.push_str(&written);
        } else {
            text.push_str(&format!("\n{:indent$}{}", "", written.trim_start()));
        }
    }
    text.push('\n');
    text
}

/// A head followed by words, continued under the first of them.
pub(super) fn words(head: &str, words: &str) -> String {
    let indent = head.chars().count();
    let (mut text, mut used) = (head.to_owned(), indent);
    for (number, word) in words.split_whitespace().enumerate() {
        let length = word.chars().count();
        if number > 0 && used + 1 + length > WIDTH {
            text.push_str(&format!("\n{:indent$}", ""));
            used = indent;
        } else if number > 0 {
            text.push(' ');
            used += 1;
        }
        text.push_str(word);
        used += length;
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_filled_before_it_is_broken() {
        let pieces = ["aaaa", " + bb", " - c", " + dddddddddddd"].map(str::to_owned);
        assert_eq!(lines(&pieces, 9), [0..2, 2..3, 3..4]);
        assert!(lines(&[], 9).is_empty());
    }

    #[test]
    fn words_hang_under_the_first() {
        let text = words("  head  ", &"word ".repeat(30));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(text.lines().skip(1).all(|line| line.starts_with("        word")));
    }
}
