//! Agreement with equations in print, on the page. In: comparisons. Out: a table: section by section how many terms
//! agree, and every one that does not, by name.

use pages::text::escape;

use model_dsl::check::{Comparison, Report, Verdict};
use model_dsl::source::SourceFile;

/// A published set of equations, compared with a machine.
#[derive(Clone, Debug)]
pub struct Published {
    /// What its file says of itself and its source, a paragraph each.
    pub notes: Vec<String>,
    /// The comparison.
    pub report: Report,
}

impl Published {
    /// A comparison with what the head of the equation file says: its comments before the first equation.
    pub fn new(file: &SourceFile, report: Report) -> Self {
        let head = file.text().lines().map_while(|line| line.strip_prefix('#').map(str::trim));
        let mut notes = vec![String::new()];
        for line in head {
            match notes.last_mut() {
                Some(note) if !line.is_empty() => {
                    note.push_str(if note.is_empty() { "" } else { " " });
                    note.push_str(line);
                }
                _ => notes.push(String::new()),
            }
        }
        notes.retain(|note| !note.is_empty());
        Self { notes, report }
    }
}

/// The part of the page about one published set.
pub(super) fn section(published: &Published) -> String {
    let report = &published.report;
    let notes = published.notes.iter().map(|note| format!("<p class=\"source\">{}</p>\n", escape(note)));
    let mut sections: Vec<(&str, Vec<&Comparison>)> = Vec::new();
    for equation in &report.equations {
        let name = equation.section.as_deref().unwrap_or("all equations");
        match sections.iter_mut().find(|(known, _)| *known == name) {
            Some((_, equations)) => equations.push(equation),
            None => sections.push((name, vec![equation])),
        }
    }
    let rows: String = sections.iter().map(|(name, equations)| row(name, equations)).collect();
    let verdict = if report.agrees() {
        "Every printed term agrees with the derived one."
    } else {
        "The printed and the derived equations differ in the terms of the last column."
    };
    format!(
        "{}<p>{verdict}</p>\n<div class=\"wide\"><table class=\"published\">\n<thead><tr><th>Section</th>\
         <th>Equations</th><th>Terms that agree</th><th>Left out by the authors</th><th>Terms that disagree</th>\
         </tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n",
        notes.collect::<String>()
    )
}

fn row(name: &str, equations: &[&Comparison]) -> String {
    let count = |verdict: Verdict| {
        let findings = equations.iter().flat_map(|one| &one.findings);
        findings.filter(|finding| finding.verdict == verdict).count()
    };
    let names: Vec<&str> = equations.iter().map(|equation| equation.left.as_str()).collect();
    let against: Vec<String> = equations.iter().flat_map(|one| one.contradictions()).collect();
    let against = match against.as_slice() {
        [] => "none".to_owned(),
        lines => lines.iter().map(|line| escape(line)).collect::<Vec<_>>().join("<br>"),
    };
    format!(
        "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{against}</td></tr>\n",
        escape(name),
        escape(&names.join(", ")),
        count(Verdict::Agrees),
        count(Verdict::LeftOut)
    )
}
