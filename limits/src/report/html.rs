//! The report as a page. In: what a recording could show. Out: one HTML file with its style and its curves inside: no script, nothing
//! fetched.

use pages::plot::{Axis, Cartesian, Draw, Line, Look, Plot, RULES, Series, Tone};
use pages::text::{escape, printed, spoken};

use super::words;
use crate::answer::{Found, Limit, Limits};
use crate::posterior::SHARE;

const STYLE: &str = "\
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr)); gap: 0 1.5rem; }
.plots figure { min-width: 0; }
.number { text-align: right; white-space: nowrap; }
.made code { white-space: nowrap; }
";

/// Limits as one self-contained page: the table, the curves, and what is never told apart. `command` is the line that makes the page
/// again.
pub fn html(limits: &Limits, command: &str) -> String {
    let title = limits.title.clone().unwrap_or_else(|| limits.file.clone());
    let mut body = format!(
        "<h1>Detection limits: {}</h1>\n<p class=\"source\">{}: {}, {} rows; as it is: {}</p>\n",
        escape(&title),
        escape(&limits.file),
        escape(&limits.machine),
        limits.rows,
        escape(&spoken(limits.verdict))
    );
    body += &words::already(limits).map(|line| format!("<p>{}</p>\n", printed(&line))).unwrap_or_default();
    body += &table(limits);
    let never: Vec<String> =
        limits.all.iter().filter(|limit| limit.found.is_none()).map(words::never).collect();
    body += &list("Never found in this recording", &never);
    body += &list("Never separated in this recording", &words::pairs(limits));
    if let Some(advice) = &limits.advice {
        body += &list("Extra passes", &words::passes(advice));
    }
    body += &curves(limits);
    body += &section(
        "How this page was made",
        &format!("<p class=\"wide made\"><code>{}</code></p>\n", escape(command)),
    );
    pages::shell::page(&format!("Limits: {title}"), &format!("{STYLE}{RULES}"), &body)
}

fn section(heading: &str, body: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{body}</section>\n", escape(heading))
}

fn list(heading: &str, lines: &[String]) -> String {
    let lines: String = lines.iter().map(|line| format!("<li>{}</li>\n", printed(line))).collect();
    if lines.is_empty() { lines } else { section(heading, &format!("<ul>\n{lines}</ul>\n")) }
}

fn table(limits: &Limits) -> String {
    let row = |limit: &Limit| {
        Some(format!(
            "<tr><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}</td></tr>\n",
            printed(&words::name(limit)),
            printed(&words::size(limit)?),
            printed(&words::interval(limit)),
            printed(&words::told(limit))
        ))
    };
    let rows: String = limits.all.iter().filter_map(row).collect();
    if rows.is_empty() {
        return section("Effects that would be found", &format!("<p>{}</p>\n", words::none(limits)));
    }
    section(
        "Effects that would be found",
        &format!(
            "<div class=\"wide\"><table>\n<thead><tr><th>effect</th><th class=\"number\">found in 9 of 10 from</th>\
             <th class=\"number\">uncertainty</th><th>reported</th></tr></thead>\n<tbody>\n{rows}</tbody></table></div>\n"
        ),
    )
}

fn curves(limits: &Limits) -> String {
    let figure = |limit: &Limit| {
        let found = limit.found.as_ref()?;
        let drawing = curve(limit, found).draw().inline();
        Some(format!("<figure>\n{drawing}</figure>\n"))
    };
    let figures: String = limits.all.iter().filter_map(figure).collect();
    if figures.is_empty() {
        return figures;
    }
    let caption = "<p>The share of trials that find an effect, over its size. Marks: single trials, found (1) or not (0). Line: \
                   the share estimated from all trials. Vertical line: found in nine of ten trials.</p>\n";
    section("Share found over size", &format!("{caption}<div class=\"plots\">\n{figures}</div>\n"))
}

/// The share found over the size.
fn curve(limit: &Limit, found: &Found) -> Cartesian {
    let (low, high) = ends(limit, found);
    let steps = 60;
    let share = (0..=steps).map(|step| {
        let strength = low * (high / low).powf(crate::number(step) / crate::number(steps));
        (limit.scale.told(strength), found.posterior.share(strength))
    });
    let marks = limit
        .trials
        .iter()
        .map(|trial| (limit.scale.told(trial.strength), if trial.is_found { 1.0 } else { 0.0 }));
    let size = limit.size().unwrap_or_default();
    Cartesian::new(
        &words::name(limit),
        Axis::exactly(limit.scale.of, &limit.scale.unit).logarithmic(),
        Axis::exactly("share found", "").within(-0.05, 1.05).reaching(0.0).reaching(1.0),
    )
    .series(Series::new("", Look::of(0).toned(Tone::Quiet), Draw::Line, vec![(size, 0.0), (size, SHARE)]))
    .series(Series::new("", Look::of(0), Draw::Line, share.collect()))
    .series(Series::new("", Look::of(1), Draw::Marks, marks.collect()))
    .line(Line::new(size, "9 of 10"))
    .sized(320.0, 150.0)
}

/// From the smallest trial to the largest, and the limit between them.
fn ends(limit: &Limit, found: &Found) -> (f64, f64) {
    let strengths = limit.trials.iter().map(|trial| trial.strength);
    let low = strengths.clone().fold(0.5 * found.strength, f64::min);
    (low, strengths.fold(1.5 * found.strength, f64::max))
}
