//! The report for a terminal. In: a diagnosis, and how wide the terminal is. Out: text no wider than that; only a word
//! that is longer, such as the path of a file, stands out.

use super::brief;
use super::item::{Fact, Item};
use super::lines::{WIDTH, paragraph};
use super::sheet::{Body, Section, Summary, sheet};
use super::style::Ink;
use crate::diagnosis::Diagnosis;

/// Where facts begin, behind their labels.
const FACTS: usize = 18;

/// A terminal narrower than this many columns breaks lines by itself.
const NARROWEST: usize = 40;

/// What the text is shown on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terminal {
    /// The widest line: from 40 to 100 columns, others are taken as the nearer of the two.
    pub columns: usize,
    /// Whether the verdict, headings and names are set off by colour and weight.
    pub color: bool,
}

impl Default for Terminal {
    /// What a file or a pipe gets: 100 columns without colour.
    fn default() -> Self {
        Self { columns: WIDTH, color: false }
    }
}

/// The diagnosis as text for a person, as [`Terminal::default`] shows it.
pub fn text(diagnosis: &Diagnosis) -> String {
    text_on(diagnosis, Terminal::default())
}

/// The diagnosis as text for a person: the verdict, the findings as a table, what comes back, then all about each finding.
pub fn text_on(diagnosis: &Diagnosis, terminal: Terminal) -> String {
    let page = Page { width: terminal.columns.clamp(NARROWEST, WIDTH), ink: Ink::new(terminal.color) };
    let sheet = sheet(diagnosis);
    let Summary { title, verdict, findings } = &sheet.summary;
    let title = paragraph(page.width, title, "", "");
    let verdict = page.ink.verdict(diagnosis, &paragraph(page.width, verdict, "", ""));
    let mut text = format!("{}\n{verdict}", page.ink.strong(&title));
    text += &brief::table(findings, page.width, page.ink);
    let sections = sheet.files.iter().chain(&sheet.returns).chain(&sheet.found).chain(&sheet.open);
    text.extend(sections.map(|section| page.section(section)));
    text
}

/// How the text is laid out.
#[derive(Clone, Copy)]
struct Page {
    width: usize,
    ink: Ink,
}

impl Page {
    fn section(self, section: &Section) -> String {
        let body = match &section.body {
            Body::Items(items) => {
                let numbered = items.len() > 1;
                let items = items.iter().enumerate().map(|(k, one)| self.item(k, one, numbered));
                items.collect::<Vec<_>>().join("\n")
            }
            Body::List(lines) => lines.iter().enumerate().map(|(k, line)| self.numbered(k, line)).collect(),
        };
        let heading = self.ink.strong(section.heading);
        format!("\n{heading}\n{}\n\n{body}", "-".repeat(section.heading.chars().count()))
    }

    fn item(self, number: usize, item: &Item, with_number: bool) -> String {
        let title = if with_number {
            self.numbered(number, &item.title)
        } else {
            paragraph(self.width, &item.title, "", "   ")
        };
        let facts: String = item.facts.iter().map(|fact| self.fact(fact)).collect();
        self.ink.strong(&title) + &facts
    }

    fn numbered(self, number: usize, line: &str) -> String {
        let mark = format!("{}. ", number + 1);
        paragraph(self.width, line, &mark, &" ".repeat(mark.len()))
    }

    /// The label before the first line; a line that is too long goes on a little further in, so that the next one is seen.
    fn fact(self, fact: &Fact) -> String {
        let several = fact.lines.len() > 1;
        let mut text = String::new();
        for (k, line) in fact.lines.iter().enumerate() {
            let label = if k == 0 { fact.label } else { "" };
            let further = FACTS + if several { 2 } else { 0 };
            let first = format!("   {label:<width$}", width = FACTS - 3);
            text += &paragraph(self.width, line, &first, &" ".repeat(further));
        }
        text
    }
}
