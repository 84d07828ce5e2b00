//! The report as a page. In: a diagnosis, and where it comes from. Out: one HTML file with its style inside: no script,
//! nothing fetched. It begins with the summary that the text begins with and with what comes back; findings in words stand next,
//! plots of them after that, then what is open.

use pages::text::printed;

use super::brief;
use super::item::{Fact, Item};
use super::plots;
use super::sheet::{Body, Section, Summary, sheet};
use crate::diagnosis::Diagnosis;

const STYLE: &str = "\
.brief { margin-top: 1rem; }
.verdict { margin: 0; padding: .7rem 1rem; background: var(--band); border-left: .25rem solid var(--line); font-size: 1.08rem; }
dl { display: grid; grid-template-columns: 8rem 1fr; gap: .25rem 1rem; margin: 0; }
dt { color: var(--quiet); }
dd { margin: 0; grid-column: 2; font-variant-numeric: tabular-nums; }
pre { padding: .6rem .8rem; background: var(--band); overflow-x: auto; white-space: pre-wrap; overflow-wrap: anywhere;
  font: .88rem/1.45 ui-monospace, monospace; }
pre .added { font-weight: 600; } pre .removed { text-decoration: line-through; } pre .same { color: var(--quiet); }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 27rem), 1fr)); gap: .5rem 1.5rem; }
.plots figcaption { padding-left: .62rem; }
.plots figure { margin: .5rem 0; min-width: 0; }
@media print { .plots { grid-template-columns: 1fr 1fr; gap: 0 1rem; } }
@media (max-width: 36rem) { dl { grid-template-columns: 1fr; } dd { grid-column: 1; } }
";

/// Where a diagnosis comes from, and what it changes: what the page tells besides.
#[derive(Clone, Copy, Debug, Default)]
pub struct Origin<'t> {
    /// The command that makes the page; empty where none does.
    pub command: &'t str,
    /// The program and its version.
    pub program: &'t str,
    /// The calibration without and with the findings, as a unified diff; empty where nothing changes.
    pub change: &'t str,
}

/// The diagnosis as one self-contained page; with plots where it has [`Diagnosis::pictures`].
pub fn html(diagnosis: &Diagnosis, origin: &Origin<'_>) -> String {
    let sheet = sheet(diagnosis);
    let sections = |sections: &[Section]| sections.iter().map(|one| section(one, "")).collect::<String>();
    let returns = sheet.returns.iter().map(|one| section(one, &plots::returns(diagnosis)));
    let body = format!(
        "{}{}{}{}{}{}{}{}",
        summary(diagnosis, &sheet.summary),
        sheet.files.iter().map(|one| section(one, "")).collect::<String>(),
        returns.collect::<String>(),
        sections(&sheet.found),
        plots::sections(diagnosis),
        sections(&sheet.open),
        change(origin),
        command(origin),
    );
    pages::shell::page(&sheet.summary.title, &format!("{}{STYLE}", pages::plot::RULES), &body)
}

/// What the text begins with: machine, verdict, a line for each finding.
fn summary(diagnosis: &Diagnosis, summary: &Summary) -> String {
    let word = diagnosis.verdict.word();
    let [title, verdict] = [&summary.title, &summary.verdict].map(|text| printed(text));
    let findings = table(&summary.findings);
    format!("<h1>{title}</h1>\n<p class=\"verdict\" data-verdict=\"{word}\">{verdict}.</p>\n{findings}")
}

/// A line for each finding; nothing where nothing was found. In a window that is too narrow the table alone is moved.
fn table(rows: &[brief::Row]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let row = |cells: &[String], mark: &str| {
        let cells = cells.iter().map(|cell| format!("<{mark}>{}</{mark}>", printed(cell)));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let head = row(&brief::TITLES.map(str::to_owned), "th");
    let rows: String = rows.iter().map(|cells| row(cells, "td")).collect();
    format!(
        "<div class=\"wide\">\n<table class=\"brief\">\n<thead>\n{head}</thead>\n<tbody>\n{rows}</tbody>\n</table>\n</div>\n"
    )
}

/// What the findings change in the calibration.
fn change(origin: &Origin<'_>) -> String {
    if origin.change.is_empty() {
        return String::new();
    }
    let line = |line: &str| {
        let heading = line.starts_with("+++ ") || line.starts_with("--- ");
        let class = match line.bytes().next() {
            _ if heading => "same",
            Some(b'+') => "added",
            Some(b'-') => "removed",
            _ => "same",
        };
        format!("<span class=\"{class}\">{}</span>\n", pages::text::escape(line))
    };
    let lines: String = origin.change.lines().map(line).collect();
    format!(
        "<section>\n<h2>The calibration with the findings</h2>\n<p>The changes that <code>--write-calibration</code> makes to \
         the known calibration; + is added, - is removed.</p>\n<pre>{lines}</pre>\n</section>\n"
    )
}

/// How the page is made again.
fn command(origin: &Origin<'_>) -> String {
    if origin.command.is_empty() {
        return String::new();
    }
    let [command, program] = [origin.command, origin.program].map(pages::text::escape);
    format!(
        "<section>\n<h2>How to reproduce this page</h2>\n<pre>{command}</pre>\n<p class=\"source\">{program}. The same \
         recordings give the same page.</p>\n</section>\n"
    )
}

/// A section: its heading, plots of it, and what it says.
fn section(section: &Section, plots: &str) -> String {
    let body = match &section.body {
        Body::Items(items) => items.iter().map(item).collect::<String>(),
        Body::List(lines) => {
            let lines: String = lines.iter().map(|line| format!("<li>{}</li>\n", printed(line))).collect();
            format!("<ol>\n{lines}</ol>\n")
        }
    };
    format!("<section>\n<h2>{}</h2>\n{plots}{body}</section>\n", printed(section.heading))
}

fn item(item: &Item) -> String {
    let facts: String = item.facts.iter().map(fact).collect();
    format!("<article>\n<h3>{}</h3>\n<dl>\n{facts}</dl>\n</article>\n", printed(&item.title))
}

/// The line of a fact that its formula takes the place of.
const FORMULA: usize = 1;

fn fact(fact: &Fact) -> String {
    let line = |(number, line): (usize, &String)| match &fact.formula {
        Some(formula) if number == FORMULA => format!("<dd>{formula}</dd>\n"),
        _ => format!("<dd>{}</dd>\n", printed(line)),
    };
    let lines: String = fact.lines.iter().enumerate().map(line).collect();
    format!("<dt>{}</dt>\n{lines}", printed(fact.label))
}
