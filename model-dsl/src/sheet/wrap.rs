//! Line breaks. In: pieces of an equation or words of a sentence. Out: lines of bounded width.

use std::ops::Range;

use super::writer::Piece;

/// The widest line of plain text, in characters.
pub const WIDTH: usize = 100;
/// How far a line that begins inside a bracket is set in, in characters.
const INSIDE: usize = 4;

/// A line of an equation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Its pieces, by their numbers.
    pub pieces: Range<usize>,
    /// Whether it begins inside a bracket, and so goes on with what the line before it began.
    pub inside: bool,
}

/// Which pieces stand together on a line no wider than `width`. A part of the outer sum is kept whole
/// where it fits into a line; a wider one begins a line and is broken inside its brackets.
pub fn lines(pieces: &[Piece], width: usize) -> Vec<Line> {
    let lengths: Vec<usize> = pieces.iter().map(|piece| piece.text.chars().count()).collect();
    let mut lines: Vec<Line> = Vec::new();
    let (mut used, mut broken) = (0, false);
    for (number, piece) in pieces.iter().enumerate() {
        let outer = piece.depth == 0;
        let inner = pieces.iter().skip(number + 1).take_while(|next| next.depth > 0).count();
        let whole: usize = lengths.iter().skip(number).take(if outer { inner + 1 } else { 1 }).sum();
        let fits = used + whole <= width && !(outer && broken);
        used = match lines.last_mut() {
            Some(line) if fits => {
                line.pieces.end = number + 1;
                used
            }
            _ => {
                broken = !outer || whole > width;
                lines.push(Line { pieces: number..number + 1, inside: !outer });
                if outer { 0 } else { INSIDE }
            }
        };
        used += lengths.get(number).copied().unwrap_or(0);
    }
    lines
}

/// The text of one line.
pub fn join(pieces: &[Piece], line: &Line) -> String {
    let pieces = pieces.get(line.pieces.clone()).unwrap_or_default();
    pieces.iter().map(|piece| piece.text.as_str()).collect()
}

/// A head followed by an equation's pieces, continued under the first of them.
pub fn equation(head: &str, pieces: &[Piece]) -> String {
    let indent = head.chars().count();
    let mut text = head.to_owned();
    for (number, line) in lines(pieces, WIDTH.saturating_sub(indent)).iter().enumerate() {
        let written = join(pieces, line);
        if number == 0 {
            text.push_str(&written);
        } else {
            let indent = indent + if line.inside { INSIDE } else { 0 };
            text.push_str(&format!("\n{:indent$}{}", "", written.trim_start()));
        }
    }
    text.push('\n');
    text
}

/// A head followed by words, continued under the first of them.
pub fn words(head: &str, words: &str) -> String {
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

    fn pieces(texts: &[(&str, usize)]) -> Vec<Piece> {
        texts.iter().map(|(text, depth)| Piece { text: (*text).to_owned(), depth: *depth }).collect()
    }

    fn ranges(texts: &[(&str, usize)], width: usize) -> Vec<(Range<usize>, bool)> {
        lines(&pieces(texts), width).into_iter().map(|line| (line.pieces, line.inside)).collect()
    }

    #[test]
    fn a_line_is_filled_before_it_is_broken() {
        let flat = [("aaaa", 0), (" + bb", 0), (" - c", 0), (" + dddddddddddd", 0)];
        assert_eq!(ranges(&flat, 9), [(0..2, false), (2..3, false), (3..4, false)]);
        assert!(lines(&[], 9).is_empty());
    }

    #[test]
    fn a_bracket_is_kept_whole_where_a_line_can_hold_it() {
        let short = [("aaaaaa", 0), (" + (b", 0), (" - c)*e", 1), (" + d", 0)];
        assert_eq!(ranges(&short, 16), [(0..1, false), (1..4, false)]);
        let long = [("a", 0), (" + (b", 0), (" - cccc", 1), (" - ddddd)*e", 1), (" + f", 0)];
        assert_eq!(ranges(&long, 16), [(0..1, false), (1..3, false), (3..4, true), (4..5, false)]);
    }

    #[test]
    fn words_hang_under_the_first() {
        let text = words("  head  ", &"word ".repeat(30));
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(text.lines().skip(1).all(|line| line.starts_with("        word")));
    }
}
