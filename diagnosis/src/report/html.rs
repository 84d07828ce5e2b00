//! The report as a page. In: a diagnosis. Out: one HTML file with its style inside: no script, nothing fetched.

use super::item::{Fact, Item};
use super::sheet::{Body, Section, sheet};
use crate::diagnosis::Diagnosis;

const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1b1b1b; --paper: #fdfdfb; --line: #c9c9c2; --band: #f1f1ec; --quiet: #5a5a55; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e8e6e1; --paper: #17181a; --line: #45474b; --band: #202225; --quiet: #a5a39d; }
}
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2rem 1.25rem 4rem; max-width: 56rem; color: var(--ink); background: var(--paper);
  font: 1rem/1.55 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.15rem; margin: 2.25rem 0 .5rem; padding-bottom: .2rem; border-bottom: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.25rem 0 .4rem; }
.verdict { margin: 0; padding: .7rem 1rem; background: var(--band); border-left: .25rem solid var(--line); font-size: 1.08rem; }
dl { display: grid; grid-template-columns: 8rem 1fr; gap: .25rem 1rem; margin: 0; }
dt { color: var(--quiet); }
dd { margin: 0; grid-column: 2; font-variant-numeric: tabular-nums; }
@media (max-width: 36rem) { dl { grid-template-columns: 1fr; } dd { grid-column: 1; } }
@media print { body { max-width: none; } article { break-inside: avoid; } }
";

/// The diagnosis as one self-contained page.
pub fn html(diagnosis: &Diagnosis) -> String {
    let sheet = sheet(diagnosis);
    let title = escape(&sheet.title);
    let sections: String = sheet.sections.iter().map(section).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n\
         <p class=\"verdict\" data-verdict=\"{}\">{}.</p>\n{sections}</main>\n</body>\n</html>\n",
        diagnosis.verdict.word(),
        escape(&sheet.verdict),
    )
}

fn section(section: &Section) -> String {
    let body = match &section.body {
        Body::Items(items) => items.iter().map(item).collect::<String>(),
        Body::List(lines) => {
            let lines: String = lines.iter().map(|line| format!("<li>{}</li>\n", escape(line))).collect();
            format!("<ol>\n{lines}</ol>\n")
        }
    };
    format!("<section>\n<h2>{}</h2>\n{body}</section>\n", escape(section.heading))
}

fn item(item: &Item) -> String {
    let facts: String = item.facts.iter().map(fact).collect();
    format!("<article>\n<h3>{}</h3>\n<dl>\n{facts}</dl>\n</article>\n", escape(&item.title))
}

fn fact(fact: &Fact) -> String {
    let lines: String = fact.lines.iter().map(|line| format!("<dd>{}</dd>\n", escape(line))).collect();
    format!("<dt>{}</dt>\n{lines}", escape(fact.label))
}

/// Text as it stands in a page; `+-` becomes its sign.
fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
    text.replace(" +- ", " \u{b1} ")
}
