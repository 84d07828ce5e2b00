//! The findings at a glance. In: the findings of a diagnosis. Out: a row each: the motion, the term, its main parameter with its
//! interval, its share, and what the held-out data say; and the rows as a table of a width.

use textwrap::{Options, wrap};

use super::figure::{change, percent};
use super::parameter;
use super::style::Ink;
use crate::diagnosis::{Finding, Parameter, ParameterValue};

/// What the columns hold of one finding.
pub(super) type Row = [String; 5];

/// The columns' names.
pub(super) const TITLES: [&str; 5] = ["motion", "term", "how much", "share", "held-out rms"];

/// The column that is broken into lines where the table is too wide.
const AMOUNT: usize = 2;

/// The fewest columns that leave an amount legible.
const LEAST: usize = 22;

/// Blanks between columns.
const GAP: usize = 2;

/// The parameters that say how large a term is, the first that is there.
const MAIN: [&str; 7] =
    ["lost_motion", "height", "amplitude", "coefficient", "gain", "value", "coefficients"];

/// The rows of the findings, in their order.
pub(super) fn rows(findings: &[Finding]) -> Vec<Row> {
    findings.iter().map(row).collect()
}

/// The table with an empty line before it; nothing where nothing was found.
pub(super) fn table(rows: &[Row], width: usize, ink: Ink) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let (widths, shown) = fitted(rows, width);
    let head = line(&TITLES.map(str::to_owned), &widths, shown, &|_, cell| ink.quiet(cell));
    let rows = rows.iter().map(|row| {
        line(row, &widths, shown, &|column, cell| if column == 0 { ink.name(cell) } else { cell.to_owned() })
    });
    format!("\n{head}{}", rows.collect::<String>())
}

fn row(finding: &Finding) -> Row {
    let evidence = &finding.evidence;
    let change = change(evidence.without, evidence.with, evidence.unit);
    let change = change.map_or_else(
        || "not tested".to_owned(),
        |(without, with)| {
            // The unit once: both are in the same.
            let without = without.split(' ').next().unwrap_or_default();
            format!("{without} -> {with}")
        },
    );
    let share = percent(finding.share).replace("more than ", "> ").replace("less than ", "< ");
    [finding.motion.clone(), finding.term.to_owned(), amount(finding), share, change]
}

/// The main parameter in a few words.
fn amount(finding: &Finding) -> String {
    if let Some(over) = &finding.over_travel {
        return parameter::over_travel(over);
    }
    let named = |name: &&str| finding.parameters.iter().find(|parameter| parameter.name == *name);
    let fitted = |parameter: &&Parameter| {
        matches!(parameter.value, ParameterValue::Fitted(_) | ParameterValue::List(_))
    };
    let main = MAIN.iter().find_map(named).or_else(|| finding.parameters.iter().find(fitted));
    let Some(main) = main else { return "-".to_owned() };
    let lines = parameter::lines(std::slice::from_ref(main), finding.kind().first_power());
    let Some(first) = lines.get(untold(&main.value)) else { return "-".to_owned() };
    // An angle is told in arcseconds below.
    let first = first.split(" = ").next().unwrap_or_default();
    match lines.len() - 1 {
        0 => first.to_owned(),
        more => format!("{first}, and {more} more"),
    }
}

/// How many of the first numbers of a list the recordings say nothing of, such as the power 0 beside a free zero.
fn untold(value: &ParameterValue) -> usize {
    let ParameterValue::List(list) = value else { return 0 };
    list.iter().take_while(|known| known.value == 0.0 && known.ci95 == (0.0, 0.0)).count() % list.len().max(1)
}

/// The width of each column, and how many columns are shown: the last ones give way where the amount would not be legible,
/// since all they say stands with each finding.
fn fitted(rows: &[Row], width: usize) -> ([usize; 5], usize) {
    let mut widths = TITLES.map(str::len);
    for row in rows {
        for (width, cell) in widths.iter_mut().zip(row) {
            *width = (*width).max(cell.chars().count());
        }
    }
    let others = |shown: usize| {
        let all = widths.iter().take(shown).enumerate().filter(|(column, _)| *column != AMOUNT);
        all.map(|(_, width)| width + GAP).sum::<usize>()
    };
    let needed = widths[AMOUNT].min(LEAST);
    let shown = (AMOUNT + 1..=TITLES.len()).rev().find(|shown| others(*shown) + needed <= width);
    let shown = shown.unwrap_or(AMOUNT + 1);
    widths[AMOUNT] = widths[AMOUNT].min(width.saturating_sub(others(shown)).max(needed));
    (widths, shown)
}

/// A row of the table, of as many lines as its amount has; `set` sets cells off without changing their width.
fn line(cells: &Row, widths: &[usize; 5], shown: usize, set: &dyn Fn(usize, &str) -> String) -> String {
    let amounts = wrap(&cells[AMOUNT], Options::new(widths[AMOUNT]).break_words(false));
    let mut text = String::new();
    for number in 0..amounts.len().max(1) {
        let mut line = String::new();
        let mut blanks = 0;
        for (column, (cell, width)) in cells.iter().zip(widths).enumerate().take(shown) {
            let cell = match (column, number) {
                (AMOUNT, _) => amounts.get(number).map_or("", |amount| amount),
                (_, 0) => cell,
                _ => "",
            };
            let free = width.saturating_sub(cell.chars().count());
            // Shares stand under each other by their per cent signs.
            let before = if column == AMOUNT + 1 { free } else { 0 };
            if cell.is_empty() {
                blanks += width + GAP;
                continue;
            }
            line += &" ".repeat(blanks + before);
            line += &set(column, cell);
            blanks = free - before + GAP;
        }
        text += &line;
        text.push('\n');
    }
    text
}
