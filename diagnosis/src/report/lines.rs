//! Lines for a terminal. In: sentences, with what stands before their first and their other lines. Out: paragraphs of a given
//! width. All reports of Abbe break their lines here.

use textwrap::{Options, WordSeparator, WordSplitter, fill};

/// The widest line of a report, columns.
pub const WIDTH: usize = 100;

/// A paragraph with its last line end: broken at spaces to a width, `first` before its first line and `others` before the
/// others. A word that is longer, such as the path of a file, stands out.
pub fn paragraph(width: usize, text: &str, first: &str, others: &str) -> String {
    let options = Options::new(width)
        .initial_indent(first)
        .subsequent_indent(others)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation)
        .break_words(false);
    fill(&plain(text), options) + "\n"
}

/// The text without the characters that would move a terminal's cursor, which titles and file names may hold.
pub fn plain(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}
