//! The report for a terminal. In: what a recording could show. Out: text of at most 100 columns, but for names that are longer.

use diagnosis::report::{WIDTH, paragraph};

use pages::text::spoken;

use super::words;
use crate::answer::{Limit, Limits};

/// Limits as text for a person.
pub fn text(limits: &Limits) -> String {
    let title = limits.title.as_deref().map_or(String::new(), |title| format!(": {title}"));
    let mut text = wrapped(&format!("{}{title}", limits.file));
    text += &wrapped(&format!("{}, {} rows; {}", limits.machine, limits.rows, alone(limits)));
    text += &words::already(limits).map(|line| wrapped(&line)).unwrap_or_default();
    text += &found(limits);
    text += &list(
        "\nNever found in this recording\n",
        limits.all.iter().filter(|limit| limit.found.is_none()).map(words::never),
    );
    text += &list("\nNever separated in this recording\n", words::pairs(limits).into_iter());
    if let Some(advice) = &limits.advice {
        text += &list("\nExtra passes\n", words::passes(advice).into_iter());
    }
    let trials: usize = limits.all.iter().map(|limit| limit.trials.len()).sum();
    text += "\n";
    text += &wrapped(&format!(
        "From {trials} diagnoses with a known effect in the readings, seed {}. Unless stated otherwise, limits are accurate to \
         about 12 %.",
        limits.seed
    ));
    text
}

fn alone(limits: &Limits) -> String {
    let known =
        if limits.known.is_empty() { String::new() } else { format!(" ({})", limits.known.join(", ")) };
    format!("as it is: {}{known}", spoken(limits.verdict))
}

/// The table of what would be found.
fn found(limits: &Limits) -> String {
    let rows: Vec<[String; 4]> = limits.all.iter().filter_map(row).collect();
    if rows.is_empty() {
        return format!("\n{}", wrapped(words::none(limits)));
    }
    let head = ["found in 9 of 10 from", "", "uncertainty", "reported"].map(str::to_owned);
    let wide = |column: usize| {
        std::iter::once(&head).chain(&rows).map(|row| row[column].chars().count()).max().unwrap_or(0)
    };
    let widths = [wide(0), wide(1), wide(2)];
    let line = |row: &[String; 4]| {
        let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}  "));
        let before: String = cells.collect();
        paragraph(WIDTH, &row[3], &before, &" ".repeat(before.chars().count()))
    };
    let head = format!(
        "\n{:<first$}  {:<second$}  {:<third$}  reported\n",
        "effect",
        "9 of 10 from",
        "uncertainty",
        first = widths[0],
        second = widths[1],
        third = widths[2]
    );
    head + &rows.iter().map(line).collect::<String>()
}

fn row(limit: &Limit) -> Option<[String; 4]> {
    Some([limit.name(), words::size(limit)?, words::interval(limit), words::told_and_drawn(limit)])
}

fn list(heading: &str, lines: impl Iterator<Item = String>) -> String {
    let lines: String = lines.map(|line| paragraph(WIDTH, &line, "   ", "      ")).collect();
    if lines.is_empty() { lines } else { format!("{heading}{lines}") }
}

fn wrapped(line: &str) -> String {
    paragraph(WIDTH, line, "", "   ")
}
