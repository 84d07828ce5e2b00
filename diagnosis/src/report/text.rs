//! The report for a terminal. In: a diagnosis. Out: text of at most 100 columns; only a word that is longer, such as the
//! path of a file, stands out.

use textwrap::{Options, WordSeparator, WordSplitter, fill};

use super::item::{Fact, Item};
use super::sheet::{Body, Section, sheet};
use crate::diagnosis::Diagnosis;

/// The widest line.
const WIDTH: usize = 100;

/// Where facts begin, behind their labels.
const FACTS: usize = 18;

/// The diagnosis as text for a person.
pub fn text(diagnosis: &Diagnosis) -> String {
    let sheet = sheet(diagnosis);
    let mut text = format!("{}\n\n{}\n", wrapped(&sheet.title, "", ""), wrapped(&sheet.verdict, "", ""));
    text.extend(sheet.sections.iter().map(section));
    text
}

fn section(section: &Section) -> String {
    let body = match &section.body {
        Body::Items(items) => {
            let numbered = items.len() > 1;
            let items = items.iter().enumerate().map(|(k, one)| item(k, one, numbered));
            items.collect::<Vec<_>>().join("\n")
        }
        Body::List(lines) => lines.iter().enumerate().map(|(k, line)| numbered(k, line)).collect(),
    };
    format!("\n{}\n{}\n\n{body}", section.heading, "-".repeat(section.heading.chars().count()))
}

fn item(number: usize, item: &Item, with_number: bool) -> String {
    let title =
        if with_number { numbered(number, &item.title) } else { wrapped(&item.title, "", "   ") + "\n" };
    let facts: String = item.facts.iter().map(fact).collect();
    title + &facts
}

fn numbered(number: usize, line: &str) -> String {
    let mark = format!("{}. ", number + 1);
    wrapped(line, &mark, &" ".repeat(mark.len())) + "\n"
}

/// The label before the first line; a line that is too long goes on a little further in, so that the next one is seen.
fn fact(fact: &Fact) -> String {
    let several = fact.lines.len() > 1;
    let mut text = String::new();
    for (k, line) in fact.lines.iter().enumerate() {
        let label = if k == 0 { fact.label } else { "" };
        let further = FACTS + if several { 2 } else { 0 };
        text += &wrapped(line, &format!("   {label:<width$}", width = FACTS - 3), &" ".repeat(further));
        text.push('\n');
    }
    text
}

fn wrapped(text: &str, first: &str, others: &str) -> String {
    let options = Options::new(WIDTH)
        .initial_indent(first)
        .subsequent_indent(others)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation)
        .break_words(false);
    fill(&plain(text), options)
}

/// The text without the characters that would move a terminal's cursor, which titles and file names may hold.
fn plain(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}
