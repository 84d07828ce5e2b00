//! The report as a page. In: an evaluation. Out: one HTML file with its style and its pictures inside: no script, nothing
//! fetched.

use pages::plot::RULES;
use pages::text::escape;

use super::head;
use super::plots::{self, Picture};
use super::shown::Shown;
use super::words::{self, unit};
use crate::Evaluation;
use crate::circular::{Circle, Trace};
use crate::figure::Figure;
use crate::iso230_2::{Side, TargetFigures};
use crate::positioning::Positioning;

/// How many targets or traces are listed; JSON has all of them.
const ROWS: usize = 200;

const STYLE: &str = "\
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 26rem), 1fr)); gap: 0 1.5rem; }
.plots figure { min-width: 0; }
.number { text-align: right; white-space: nowrap; }
.symbol { white-space: nowrap; }
.made code { white-space: nowrap; }
table.rows { font-size: .92rem; }
table.rows th, table.rows td { padding-right: .5rem; }
";

/// The evaluation as one self-contained page: the figures, their pictures and the numbers behind them. `command` is
/// the line that makes the page again.
pub fn html(evaluation: &Evaluation, command: &str) -> String {
    let title = evaluation.title.clone().unwrap_or_else(|| evaluation.file.clone());
    let mut body = format!(
        "<h1>{}</h1>\n<p class=\"source\">{}: {}, instrument {}</p>\n",
        escape(&title),
        escape(&evaluation.file),
        escape(&evaluation.machine),
        evaluation.instrument
    );
    body.extend(evaluation.positioning.iter().map(|line| positioning(line, evaluation)));
    body += &diagonals(evaluation);
    body.extend(evaluation.circles.iter().map(circle));
    if !evaluation.not_given.is_empty() {
        let lines = evaluation.not_given.iter();
        let lines: String = lines
            .map(|one| format!("<li>{}, because {}.</li>\n", escape(&one.what), escape(&one.because)))
            .collect();
        body += &section("Not available from this recording", &format!("<ul>\n{lines}</ul>\n"));
    }
    body += &format!(
        "<section>\n<h2>How this page was made</h2>\n<p class=\"wide made\"><code>{}</code></p>\n</section>\n",
        escape(command)
    );
    pages::shell::page(&format!("Evaluation: {title}"), &format!("{STYLE}{RULES}"), &body)
}

fn section(heading: &str, body: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{body}</section>\n", escape(heading))
}

fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

fn positioning(line: &Positioning, evaluation: &Evaluation) -> String {
    let mut body = head(line, evaluation) + &paragraph(&words::basis(line));
    body += &figures(&line.figures);
    body += &pictures(plots::positioning(line));
    body += &targets(line);
    let further = words::left_out(line).into_iter().chain(line.notes.iter().cloned());
    body.extend(further.map(|note| paragraph(&note)));
    section(&words::line(line), &body)
}

/// What the test itself was, as a table to fill in.
fn head(line: &Positioning, evaluation: &Evaluation) -> String {
    let row =
        |(label, said): (&str, String)| format!("<tr><th>{label}</th><td>{}</td></tr>\n", escape(&said));
    let rows: String = head::of(line, evaluation).into_iter().map(row).collect();
    format!("<div class=\"wide\"><table>\n<tbody>\n{rows}</tbody></table></div>\n")
}

fn diagonals(evaluation: &Evaluation) -> String {
    let Some(diagonals) = &evaluation.diagonals else { return String::new() };
    let own = evaluation.positioning.iter().filter(|line| line.kind == diagonals.kind);
    let lines: Vec<&Positioning> = own.collect();
    let body = figures(&diagonals.figures) + &pictures(plots::diagonals(&lines).into_iter().collect());
    section(&words::diagonals(diagonals), &body)
}

fn circle(circle: &Circle) -> String {
    let mut body = words::feedback(circle).map(paragraph).unwrap_or_default();
    body += &figures(&circle.figures);
    body += &pictures(plots::circle(circle));
    body += &traces(circle);
    section(&words::circle(circle), &body)
}

fn pictures(all: Vec<Picture>) -> String {
    let figures = all.into_iter().map(|picture| {
        format!(
            "<figure>\n{}<figcaption>{}</figcaption>\n</figure>\n",
            picture.drawing,
            escape(&picture.caption)
        )
    });
    format!("<div class=\"plots\">\n{}</div>\n", figures.collect::<String>())
}

/// The figures that there are as a table, then why the others cannot be given.
fn figures(all: &[Figure]) -> String {
    let shown = Shown::figures(all);
    let rows = all.iter().filter_map(|figure| {
        let value = shown.number(figure.value.number()?);
        Some(format!(
            "<tr><td class=\"symbol\">{}</td><td class=\"number\">{value} {}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            subscripted(figure.symbol),
            unit(shown.unit),
            escape(figure.name),
            words::rests(figure.rests),
            escape(figure.source)
        ))
    });
    let rows: String = rows.collect();
    let mut text = String::new();
    if !rows.is_empty() {
        text += &format!(
            "<div class=\"wide\"><table>\n<thead><tr><th>figure</th><th class=\"number\">value</th><th>what</th>\
             <th>rests on</th><th>defined in</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
        );
    }
    text.extend(words::not_given(all).iter().map(|sentence| paragraph(sentence)));
    text
}

/// `R_up` with what stands below the line.
fn subscripted(symbol: &str) -> String {
    match symbol.split_once('_') {
        Some((letter, below)) => {
            format!("<i>{}</i><sub>{}</sub>", escape(letter), escape(&below.replace('_', " ")))
        }
        None => format!("<i>{}</i>", escape(symbol)),
    }
}

/// A table of numbers under named columns; what is not known is a dash.
fn rows(caption: &str, titles: &[&str], lines: Vec<Vec<String>>, count: usize) -> String {
    let head: String = titles.iter().map(|title| format!("<th class=\"number\">{title}</th>")).collect();
    let line = |cells: Vec<String>| {
        let cells: String =
            cells.iter().map(|cell| format!("<td class=\"number\">{}</td>", escape(cell))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let lines: String = lines.into_iter().map(line).collect();
    let more = match count.saturating_sub(ROWS) {
        0 => String::new(),
        more => paragraph(&format!("{more} more: --format json lists them.")),
    };
    format!(
        "<h3>{caption}</h3>\n<div class=\"wide\"><table class=\"rows\">\n<thead><tr>{head}</tr></thead>\n<tbody>\n{lines}</tbody>\
         </table></div>\n{more}"
    )
}

fn targets(line: &Positioning) -> String {
    let (shown, (coarse, places)) = (Shown::targets(line), line.unit.coarse());
    let row = |target: &TargetFigures| {
        let side = |of: fn(Side) -> Option<f64>| [target.up, target.down].map(|side| side.and_then(of));
        let [mean, s] = [side(|side| Some(side.mean)), side(|side| side.s)];
        let repeatability = side(Side::repeatability);
        let numbers = [mean[0], mean[1], target.mean(), target.reversal(), s[0], s[1]];
        let numbers = numbers
            .into_iter()
            .chain(repeatability)
            .chain([target.repeatability()])
            .map(|number| number.map_or_else(|| "\u{2013}".to_owned(), |number| shown.number(number)));
        let counts = [target.up, target.down].map(|side| side.map_or(0, |side| side.readings).to_string());
        let position = format!("{:.4}", target.position * places);
        std::iter::once(position).chain(counts).chain(numbers).collect()
    };
    let titles = [
        "target",
        "readings \u{2191}",
        "\u{2193}",
        "mean \u{2191}",
        "\u{2193}",
        "both",
        "B",
        "s \u{2191}",
        "\u{2193}",
        "R \u{2191}",
        "\u{2193}",
        "R",
    ];
    let caption = format!("At each target, in {}; targets in {coarse}", unit(shown.unit));
    rows(&caption, &titles, line.targets.iter().take(ROWS).map(row).collect(), line.targets.len())
}

fn traces(circle: &Circle) -> String {
    let shown = Shown::figures(&circle.figures);
    let row = |trace: &Trace| {
        let mut cells =
            vec![trace.run.to_string(), trace.sense.name().to_owned(), trace.points.len().to_string()];
        match &trace.figures {
            Err(reason) => cells.push(reason.clone()),
            Ok(own) => {
                let numbers =
                    [own.circular, own.circular_least_squares, own.radial[0], own.radial[1], own.radius];
                cells.extend(numbers.map(|number| shown.number(number)));
                let center = [0, 1].map(|part| own.center.and_then(|center| center.get(part).copied()));
                cells.extend(
                    center.map(|part| part.map_or_else(|| "\u{2013}".to_owned(), |part| shown.number(part))),
                );
            }
        }
        cells
    };
    let [first, second] = words::directions(circle).map(|direction| format!("centre {direction}"));
    let titles = ["run", "sense", "readings", "G", "G LS", "F max", "F min", "radius", &first, &second];
    let caption = format!(
        "Each time around, in {}; radius and centre: least-squares circle minus nominal",
        unit(shown.unit)
    );
    rows(&caption, &titles, circle.traces.iter().take(ROWS).map(row).collect(), circle.traces.len())
}
