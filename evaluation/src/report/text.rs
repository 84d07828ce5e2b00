//! The report for a terminal. In: an evaluation. Out: text of at most 100 columns, but for names that are longer.

use diagnosis::report::{WIDTH, paragraph};

use super::head;
use super::shown::Shown;
use super::words;
use crate::Evaluation;
use crate::circular::{Circle, Trace};
use crate::figure::Figure;
use crate::iso230_2::TargetFigures;
use crate::positioning::Positioning;

/// How many targets or traces are listed; JSON has all of them.
const ROWS: usize = 40;

/// The evaluation as text for a person.
pub fn text(evaluation: &Evaluation) -> String {
    let title = evaluation.title.as_deref().map_or(String::new(), |title| format!(": {title}"));
    let mut text = wrapped(&format!("{}{title}", evaluation.file), "", "   ");
    text += &wrapped(&format!("{}, instrument {}", evaluation.machine, evaluation.instrument), "", "   ");
    text += &evaluation.positioning.iter().map(|line| positioning(line, evaluation)).collect::<String>();
    if let Some(diagonals) = &evaluation.diagonals {
        text += "\n";
        text += &wrapped(&words::diagonals(diagonals), "", "   ");
        text += &figures(&diagonals.figures);
    }
    text += &evaluation.circles.iter().map(circle).collect::<String>();
    if !evaluation.not_given.is_empty() {
        text += "\nNot available from this recording\n";
        for one in &evaluation.not_given {
            text += &wrapped(&format!("{}, because {}.", one.what, one.because), "   ", "      ");
        }
    }
    text
}

fn positioning(line: &Positioning, evaluation: &Evaluation) -> String {
    let mut text = format!("\n{}", wrapped(&words::line(line), "", "   "));
    for (label, said) in head::of(line, evaluation) {
        text += &wrapped(&format!("{label}: {said}"), "   ", "      ");
    }
    text += &wrapped(&words::basis(line), "", "   ");
    text += &targets(line);
    text += &figures(&line.figures);
    let further = words::left_out(line).into_iter().chain(line.notes.iter().cloned());
    text.extend(further.map(|note| wrapped(&note, "", "   ")));
    text
}

/// A table of the targets.
fn targets(line: &Positioning) -> String {
    let (shown, (coarse, places)) = (Shown::targets(line), line.unit.coarse());
    let titles = ["n up", "down", "mean up", "down", "both", "B", "s up", "down", "R up", "down", "R"];
    let widths = [6, 6, 9, 8, 8, 8, 7, 7, 8, 8, 8];
    let head: String = titles.iter().zip(widths).map(|(title, width)| right(title, width)).collect();
    let mut text = format!("{:>12}{head}\n", format!("target {coarse}"));
    let row = |target: &TargetFigures| {
        let counts = [target.up, target.down].map(|side| side.map_or(0, |side| side.readings).to_string());
        let (up, down) = (target.up, target.down);
        let numbers = [
            up.map(|side| side.mean),
            down.map(|side| side.mean),
            target.mean(),
            target.reversal(),
            up.and_then(|side| side.s),
            down.and_then(|side| side.s),
            up.and_then(|side| side.repeatability()),
            down.and_then(|side| side.repeatability()),
            target.repeatability(),
        ];
        let numbers = numbers.map(|number| number.map_or("-".to_owned(), |number| shown.number(number)));
        let cells = counts.iter().chain(&numbers).zip(widths).map(|(cell, width)| right(cell, width));
        format!("{:>12.4}{}\n", target.position * places, cells.collect::<String>())
    };
    text.extend(line.targets.iter().take(ROWS).map(row));
    text += &more(line.targets.len(), "targets");
    text + &format!("{:>12}{:>12}\n", "", format!("all in {}", shown.unit))
}

fn more(count: usize, what: &str) -> String {
    match count.saturating_sub(ROWS) {
        0 => String::new(),
        more => format!("{more} more {what}: --format json lists them.\n"),
    }
}

/// The figures that there are, then the others by reason.
fn figures(all: &[Figure]) -> String {
    let mut text = String::new();
    let shown = Shown::figures(all);
    for figure in all {
        if let Some(value) = figure.value.number() {
            let (value, unit) = (shown.number(value), shown.unit);
            let rests = words::rests(figure.rests);
            let line = format!("{:<13}{value:>9} {unit:<7}{} ({rests})", figure.symbol, figure.name);
            text += &wrapped(&line, "   ", &" ".repeat(33));
        }
    }
    text.extend(words::not_given(all).iter().map(|line| wrapped(line, "   ", "      ")));
    text
}

fn circle(circle: &Circle) -> String {
    let mut text = format!("\n{}", wrapped(&words::circle(circle), "", "   "));
    text += &words::feedback(circle).map_or(String::new(), |note| format!("{note}\n"));
    let titles = ["run", "sense", "readings", "G", "G LS", "F max", "F min", "radius", "centre", ""];
    let widths = [6, 7, 10, 9, 9, 9, 9, 9, 10, 10];
    let head: String = titles.iter().zip(widths).map(|(title, width)| right(title, width)).collect();
    text += &format!("{head}\n");
    let shown = Shown::figures(&circle.figures);
    let row = |trace: &Trace| {
        let first = [trace.run.to_string(), trace.sense.name().to_owned(), trace.points.len().to_string()];
        let start: String = first.iter().zip(widths).map(|(cell, width)| right(cell, width)).collect();
        match &trace.figures {
            Err(reason) => format!("{start}   {reason}\n"),
            Ok(own) => {
                let numbers =
                    [own.circular, own.circular_least_squares, own.radial[0], own.radial[1], own.radius];
                let numbers = numbers.into_iter().map(Some);
                let center = [0, 1].map(|part| own.center.and_then(|center| center.get(part).copied()));
                let cells = numbers.chain(center).zip(widths.into_iter().skip(3)).map(|(number, width)| {
                    let cell = number.map_or("-".to_owned(), |number| shown.number(number));
                    right(&cell, width)
                });
                format!("{start}{}\n", cells.collect::<String>())
            }
        }
    };
    text.extend(circle.traces.iter().take(ROWS).map(row));
    text += &more(circle.traces.len(), "traces");
    text += &format!("      all in {}; radius and centre: least-squares circle minus nominal\n", shown.unit);
    text + &figures(&circle.figures)
}

/// A cell of a table: to the right, and never against the one before it.
fn right(cell: &str, width: usize) -> String {
    format!(" {cell:>less$}", less = width - 1)
}

fn wrapped(text: &str, first: &str, others: &str) -> String {
    paragraph(WIDTH, text, first, others)
}
