//! The report for a terminal. In: an evaluation. Out: text of at most 100 columns, but for names that are longer.

use textwrap::{Options, WordSeparator, WordSplitter, fill};

use crate::Evaluation;
use crate::circular::{Circle, Trace};
use crate::figure::{Figure, Given, Rests, Sensor, Unit};
use crate::iso230_2::TargetFigures;
use crate::positioning::{Kind, Positioning, Zero};

/// The widest line.
const WIDTH: usize = 100;

/// How many targets or traces are listed; JSON has all of them.
const ROWS: usize = 40;

/// The evaluation as text for a person.
pub fn text(evaluation: &Evaluation) -> String {
    let title = evaluation.title.as_deref().map_or(String::new(), |title| format!(": {title}"));
    let mut text = wrapped(&format!("{}{title}", evaluation.file), "", "   ");
    text += &wrapped(&format!("{}, instrument {}", evaluation.machine, evaluation.instrument), "", "   ");
    text += &evaluation.positioning.iter().map(positioning).collect::<String>();
    if let Some(diagonals) = &evaluation.diagonals {
        let kind = if diagonals.kind == Kind::BodyDiagonal { "Body" } else { "Face" };
        text += &wrapped(&format!("\n{kind} diagonals together: {}", diagonals.names.join(", ")), "", "   ");
        text += &figures(&diagonals.figures);
    }
    text += &evaluation.circles.iter().map(circle).collect::<String>();
    if !evaluation.not_given.is_empty() {
        text += "\nCannot be given from this recording\n";
        for one in &evaluation.not_given {
            text += &wrapped(&format!("{}, because {}.", one.what, one.because), "   ", "      ");
        }
    }
    text
}

fn positioning(line: &Positioning) -> String {
    let names = line.axes.join(" and ");
    let what = match line.kind {
        Kind::Slide => format!("the slide {names}"),
        Kind::Rotary => format!("the rotary axis {names}"),
        Kind::FaceDiagonal => format!("a face diagonal of {names}"),
        Kind::BodyDiagonal => format!("a body diagonal of {names}"),
    };
    let stand = |(axis, at, unit): &(String, f64, Unit)| format!("{axis} {}", unit.place(*at));
    let others: Vec<String> = line.at.iter().map(stand).collect();
    let others = if others.is_empty() { String::new() } else { format!(", at {}", others.join(", ")) };
    let heading = format!("Positioning of {what}{others}");
    let mut text = format!("\n{}", wrapped(&heading, "", "   "));
    text += &wrapped(&basis(line), "", "   ");
    text += &targets(line);
    text += &figures(&line.figures);
    if !line.left_out.is_empty() {
        let places: Vec<String> = line.left_out.iter().map(|place| line.unit.place(*place)).collect();
        text += &wrapped(
            &format!("Approached from one side only, and left out: {}.", listed(&places)),
            "",
            "   ",
        );
    }
    text += &line.notes.iter().map(|note| wrapped(note, "", "   ")).collect::<String>();
    text
}

fn basis(line: &Positioning) -> String {
    let sensor = match line.sensor {
        Sensor::Instrument => "Read by the instrument",
        Sensor::Feedback => "Read by the drive's own feedback: what comes in after the drive is not seen",
    };
    let zero = match line.zero {
        Zero::Instrument => "its own zero",
        Zero::Nominal => "the nominal position",
        Zero::Mean => {
            "the mean of all readings, since without a calibration the machine's constants are not known"
        }
    };
    format!("{sensor}; deviations are actual minus target and count from {zero}.")
}

/// A table of the targets.
fn targets(line: &Positioning) -> String {
    let ((fine, scale), (coarse, places)) = (line.unit.fine(), line.unit.coarse());
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
        let numbers = numbers.map(|number| number.map_or("-".to_owned(), |number| short(number * scale)));
        let cells = counts.iter().chain(&numbers).zip(widths).map(|(cell, width)| right(cell, width));
        format!("{:>12.4}{}\n", target.position * places, cells.collect::<String>())
    };
    text.extend(line.targets.iter().take(ROWS).map(row));
    text += &more(line.targets.len(), "targets");
    text + &format!("{:>12}{:>12}\n", "", format!("all in {fine}"))
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
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for figure in all {
        match &figure.value {
            Given::Value(value) => {
                let (unit, scale) = figure.unit.fine();
                let value = short(value * scale);
                let rests = rests(figure.rests);
                let line = format!("{:<13}{value:>9} {unit:<7}{} ({rests})", figure.symbol, figure.name);
                text += &wrapped(&line, "   ", &" ".repeat(33));
            }
            Given::Not(reason) => match reasons.iter_mut().find(|(known, _)| known == reason) {
                Some((_, symbols)) => symbols.push(figure.symbol),
                None => reasons.push((reason, vec![figure.symbol])),
            },
        }
    }
    for (reason, symbols) in reasons {
        let line = format!("{} cannot be given from this recording, because {reason}.", symbols.join(", "));
        text += &wrapped(&line, "   ", "      ");
    }
    text
}

fn rests(rests: Rests) -> String {
    let [least, most] = rests.runs;
    let runs = if least == most { format!("{least}") } else { format!("{least} to {most}") };
    match rests.targets {
        Some(targets) => format!("{targets} targets, {runs} runs"),
        None => format!("{} readings, {runs} traces", rests.readings),
    }
}

fn circle(circle: &Circle) -> String {
    let center = circle.center.map_or(String::new(), |[one, other]| {
        let mut letters = circle.plane.chars();
        let mut letter = || letters.next().unwrap_or(' ');
        format!(", centre {} {one:.3} {} {other:.3} mm", letter(), letter())
    });
    let heading = format!(
        "Circle in {}, radius {:.3} mm{center}, feed {:.0} mm/min",
        circle.plane,
        circle.radius,
        circle.feed * 60.0
    );
    let mut text = format!("\n{}", wrapped(&heading, "", "   "));
    if circle.sensor == Sensor::Feedback {
        text += "Read by the drives' own feedback: what comes in after the drives is not seen.\n";
    }
    let titles = ["run", "sense", "readings", "G", "G LS", "F max", "F min", "radius", "centre", ""];
    let widths = [6, 7, 10, 9, 9, 9, 9, 9, 10, 10];
    let head: String = titles.iter().zip(widths).map(|(title, width)| right(title, width)).collect();
    text += &format!("{head}\n");
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
                    let cell = number.map_or("-".to_owned(), |number| short(number * 1e3));
                    right(&cell, width)
                });
                format!("{start}{}\n", cells.collect::<String>())
            }
        }
    };
    text.extend(circle.traces.iter().take(ROWS).map(row));
    text += &more(circle.traces.len(), "traces");
    text += "      all in um; radius and centre: least-squares circle minus nominal\n";
    text + &figures(&circle.figures)
}

/// A list that does not grow beyond a line or two.
fn listed(places: &[String]) -> String {
    let some: Vec<&str> = places.iter().take(8).map(String::as_str).collect();
    match places.len().saturating_sub(8) {
        0 => some.join(", "),
        more => format!("{} and {more} more", some.join(", ")),
    }
}

/// A cell of a table: to the right, and never against the one before it.
fn right(cell: &str, width: usize) -> String {
    format!(" {cell:>less$}", less = width - 1)
}

/// Two decimals, without a sign for what rounds to nothing.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    if text == "-0.00" { "0.00".to_owned() } else { text }
}

fn wrapped(text: &str, first: &str, others: &str) -> String {
    let options = Options::new(WIDTH)
        .initial_indent(first)
        .subsequent_indent(others)
        .word_separator(WordSeparator::AsciiSpace)
        .word_splitter(WordSplitter::NoHyphenation)
        .break_words(false);
    fill(&plain(text), options) + "\n"
}

/// The text without the characters that would move a terminal's cursor, which file names may hold.
fn plain(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}
