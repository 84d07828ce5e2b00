//! The tables. In: the scores of all cases. Out: Markdown, plain text or JSON.

use std::collections::BTreeSet;

use serde_json::{Value, json};

use limits::injection::base::Base;
use limits::injection::case::Case;
use limits::injection::kind::Kind;
use limits::injection::score::{How, NEAR, Score};

/// A case with its score.
pub(crate) struct Line<'c> {
    pub(crate) case: &'c Case,
    pub(crate) base: &'c Base,
    pub(crate) score: Score,
}

/// The columns of all tables but the first.
const HEAD: [&str; 8] = [
    "cases",
    "found by name",
    "found",
    "extra claims a case",
    "held out over base, median",
    "within 10 %",
    "intervals",
    "hold the truth",
];

/// A table of words.
struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// All tables as text: in Markdown, or with columns under each other.
pub(crate) fn text(lines: &[Line<'_>], sizes: &[f64], markdown: bool) -> String {
    let tables = [by_kind(lines, sizes), by_size(lines, sizes), by_base(lines)];
    let tables: Vec<String> =
        tables.iter().map(|table| if markdown { table.markdown() } else { table.plain() }).collect();
    tables.join("\n")
}

fn by_kind(lines: &[Line<'_>], sizes: &[f64]) -> Table {
    let sized = sizes.iter().map(|size| format!("found at {size}"));
    let head = ["kind".to_owned()].into_iter().chain(sized).chain(HEAD.map(str::to_owned)).collect();
    let kinds =
        Kind::ALL.iter().map(|kind| (kind.name(), pick(lines, |line| line.case.effect.kind() == *kind)));
    let all = ("all", lines.iter().collect());
    let rows = kinds.chain([all]).filter(|(_, lines)| !lines.is_empty()).map(|(kind, lines)| {
        let sized = sizes.iter().map(|size| {
            let found = lines.iter().filter(|line| line.case.size == *size);
            let found: Vec<bool> = found.map(|line| line.score.how != How::Missed).collect();
            of(&found)
        });
        [kind.to_owned()].into_iter().chain(sized).chain(figures(&lines)).collect()
    });
    Table { head, rows: rows.collect() }
}

fn by_size(lines: &[Line<'_>], sizes: &[f64]) -> Table {
    let rows = sizes.iter().map(|size| {
        let sized = pick(lines, |line| line.case.size == *size);
        [size.to_string()].into_iter().chain(figures(&sized)).collect()
    });
    Table { head: headed("size"), rows: rows.collect() }
}

fn by_base(lines: &[Line<'_>]) -> Table {
    let names: BTreeSet<&str> = lines.iter().map(|line| line.base.name.as_str()).collect();
    let rows = names.into_iter().map(|name| {
        let own = pick(lines, |line| line.base.name == name);
        [name.to_owned()].into_iter().chain(figures(&own)).collect()
    });
    Table { head: headed("recording"), rows: rows.collect() }
}

fn headed(first: &str) -> Vec<String> {
    [first].into_iter().chain(HEAD).map(str::to_owned).collect()
}

fn pick<'l, 'c>(lines: &'l [Line<'c>], wanted: impl Fn(&Line<'c>) -> bool) -> Vec<&'l Line<'c>> {
    lines.iter().filter(|line| wanted(line)).collect()
}

/// The figures of some cases, in the order of the head.
fn figures(lines: &[&Line<'_>]) -> [String; 8] {
    let totals = Totals::of(lines);
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.2}"));
    [
        totals.cases.to_string(),
        share(totals.named, totals.cases),
        share(totals.found, totals.cases),
        number((totals.cases > 0).then(|| totals.extra as f64 / totals.cases as f64)),
        number(totals.left),
        share(totals.near, totals.figures),
        totals.intervals.to_string(),
        share(totals.covered, totals.intervals),
    ]
}

/// What is counted.
struct Totals {
    cases: usize,
    named: usize,
    found: usize,
    extra: usize,
    /// The median of the held-out figures over those of the bases.
    left: Option<f64>,
    near: usize,
    figures: usize,
    covered: usize,
    intervals: usize,
}

impl Totals {
    fn of(lines: &[&Line<'_>]) -> Self {
        let count = |wanted: &dyn Fn(&Score) -> bool| lines.iter().filter(|line| wanted(&line.score)).count();
        let mut left: Vec<f64> = lines.iter().filter_map(|line| line.score.left).collect();
        left.sort_by(f64::total_cmp);
        Self {
            cases: lines.len(),
            named: count(&|score| score.how == How::Named),
            found: count(&|score| score.how != How::Missed),
            extra: lines.iter().map(|line| line.score.extra.len()).sum(),
            left: left.get(left.len() / 2).copied(),
            near: left.iter().filter(|left| **left < NEAR).count(),
            figures: left.len(),
            covered: count(&|score| score.covered == Some(true)),
            intervals: count(&|score| score.covered.is_some()),
        }
    }

    fn json(&self) -> Value {
        json!({
            "cases": self.cases,
            "named": self.named,
            "found": self.found,
            "extra": self.extra,
            "held_out_over_base": self.left,
            "within_tenth": self.near,
            "held_out_figures": self.figures,
            "covered": self.covered,
            "intervals": self.intervals,
        })
    }
}

/// `3 of 5`.
fn of(found: &[bool]) -> String {
    match found.len() {
        0 => "-".to_owned(),
        all => format!("{} of {all}", found.iter().filter(|found| **found).count()),
    }
}

fn share(part: usize, whole: usize) -> String {
    if whole == 0 { "-".to_owned() } else { format!("{:.0} %", 100.0 * part as f64 / whole as f64) }
}

impl Table {
    fn markdown(&self) -> String {
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        let rule = vec!["---".to_owned(); self.head.len()];
        [&self.head, &rule].into_iter().chain(&self.rows).map(|cells| line(cells)).collect()
    }

    fn plain(&self) -> String {
        let cells = || [&self.head].into_iter().chain(&self.rows);
        let width = |column: usize| cells().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let padded = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
            padded.collect::<Vec<String>>().join("  ").trim_end().to_owned() + "\n"
        };
        cells().map(line).collect()
    }
}

/// Everything as JSON.
pub(crate) fn json(lines: &[Line<'_>], seed: u64) -> Value {
    let cases: Vec<Value> = lines.iter().map(case).collect();
    let all: Vec<&Line<'_>> = lines.iter().collect();
    json!({"schema": "abbe-injected/1", "seed": seed, "totals": Totals::of(&all).json(), "cases": cases})
}

fn case(line: &Line<'_>) -> Value {
    let Line { case, base, score } = line;
    let size = case.effect.size().map(|(name, _, value)| json!({"parameter": name, "value": value}));
    json!({
        "recording": base.name,
        "motion": base.names.motions[case.motion].name,
        "kind": case.effect.kind().name(),
        "size": case.size,
        "injected": size,
        "found": score.how.word(),
        "extra": score.extra,
        "held_out_over_base": score.left,
        "covered": score.covered,
        "verdict": score.verdict,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_one_cell_for_each_column() {
        let table = Table {
            head: vec!["kind".to_owned(), "found".to_owned()],
            rows: vec![vec!["reversal-spike".to_owned(), "3 of 5".to_owned()]],
        };
        assert_eq!(table.markdown(), "| kind | found |\n| --- | --- |\n| reversal-spike | 3 of 5 |\n");
        assert_eq!(table.plain(), "kind            found\nreversal-spike  3 of 5\n");
    }

    #[test]
    fn nothing_is_no_share() {
        assert_eq!(
            (share(0, 0), share(1, 3), of(&[]), of(&[true, false])),
            ("-".to_owned(), "33 %".to_owned(), "-".to_owned(), "1 of 2".to_owned())
        );
    }
}
