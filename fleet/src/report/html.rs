//! The pages. In: a history. Out: the page of the fleet, alarms first and a line a machine; and for each machine its numbers over time and
//! its recordings. No script, nothing fetched.

use std::path::Path;

use pages::plot::RULES;
use pages::text::{escape, printed};

use super::{age, brief, chart, count, most, open, worst};
use crate::history::{Alarm, BOUND, History, Machine};
use crate::results::encoded;

const STYLE: &str = "\
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 22rem), 1fr)); gap: 0 1.5rem; }
.plots figure { min-width: 0; }
.alarm { border-left: 4px solid var(--two); background: var(--band); padding: .5rem .9rem; margin: .8rem 0; }
.alarm p { margin: .2rem 0; }
.alarm .source { overflow-wrap: anywhere; }
td svg { min-width: 10.5rem; }
td.name { white-space: nowrap; }
table.recordings td { overflow-wrap: anywhere; min-width: 7rem; }
table.recordings td.name { min-width: 0; }
";

/// The pages of a fleet as files.
#[derive(Clone, Debug)]
pub struct Pages {
    /// Names and contents: `index.html`, and one for each machine.
    pub files: Vec<(String, String)>,
}

/// How pages refer to each other and to the reports of recordings.
struct Links<'l> {
    machine: &'l dyn Fn(&str) -> String,
    report: &'l dyn Fn(&Path) -> Option<String>,
}

/// The page of the fleet with the machines below, as one file.
#[must_use]
pub fn page(history: &History, command: &str) -> String {
    let links = Links { machine: &|name| format!("#{}", encoded(name)), report: &|_| None };
    let machines: String =
        history.machines.iter().map(|machine| of_machine(history, machine, &links)).collect();
    let body = of_fleet(history, &links) + &machines + &made(command);
    shell("Fleet", &body)
}

/// The page of the fleet and one for each machine; `report` gives the link to the page of a diagnosis.
#[must_use]
pub fn pages(history: &History, command: &str, report: &dyn Fn(&Path) -> Option<String>) -> Pages {
    let name = |machine: &str| format!("machine-{}.html", encoded(machine));
    // The name as a link: what is a per cent sign in the file's name is written as one in a link.
    let links = Links { machine: &|machine| name(machine).replace('%', "%25"), report };
    let mut files =
        vec![("index.html".to_owned(), shell("Fleet", &(of_fleet(history, &links) + &made(command))))];
    for machine in &history.machines {
        let back = "<p><a href=\"index.html\">The fleet</a></p>\n";
        let body = format!("{back}{}{}", of_machine(history, machine, &links), made(command));
        files.push((name(&machine.name), shell(&machine.name, &body)));
    }
    Pages { files }
}

fn shell(title: &str, body: &str) -> String {
    pages::shell::page(title, &format!("{STYLE}{RULES}"), body)
}

fn made(command: &str) -> String {
    format!(
        "<section>\n<h2>How this page was made</h2>\n<p class=\"wide\"><code>{}</code></p>\n</section>\n",
        escape(command)
    )
}

fn of_fleet(history: &History, links: &Links<'_>) -> String {
    let mut body = format!(
        "<h1>Fleet of {} machines</h1>\n<p class=\"source\">Until {}. {} series and comparisons were tested; the chance of any \
         false alarm among all of them is at most {} %.</p>\n",
        history.machines.len(),
        history.until.day(),
        history.questions,
        BOUND * 100.0
    );
    let alarms: String = history.alarms.iter().map(|alarm| of_alarm(alarm, links)).collect();
    let none =
        "<p class=\"none\">No alarm: all changes are chance, or smaller than one recording can show.</p>\n";
    body += &section("Alarms", if alarms.is_empty() { none } else { &alarms });
    let rows: String = history.machines.iter().map(|machine| row(history, machine, links)).collect();
    let head = "<tr><th>Machine</th><th>Last verdict</th><th>Last test</th><th>Changes most</th><th>Over time</th></tr>";
    body += &section(
        "Machines",
        &format!(
            "<div class=\"wide\"><table>\n<thead>{head}</thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
        ),
    );
    body + &ranges(history)
}

fn section(heading: &str, body: &str) -> String {
    format!("<section>\n<h2>{}</h2>\n{body}</section>\n", escape(heading))
}

fn of_alarm(alarm: &Alarm, links: &Links<'_>) -> String {
    let rests = match alarm.recordings.as_slice() {
        [] => String::new(),
        recordings => format!("<p class=\"source\">Based on {}.</p>\n", escape(&recordings.join(", "))),
    };
    format!(
        "<article class=\"alarm\">\n<p><strong><a href=\"{}\">{}</a></strong>: {}</p>\n<p>Look at {}.</p>\n{rests}</article>\n",
        escape(&(links.machine)(&alarm.machine)),
        escape(&alarm.machine),
        printed(&alarm.reason),
        escape(&alarm.look_at)
    )
}

fn row(history: &History, machine: &Machine, links: &Links<'_>) -> String {
    let worst = worst(machine);
    let (verdict, change) = match machine.last() {
        Some(last) => (super::verdict(last), most(machine)),
        None => ("no result yet".to_owned(), String::new()),
    };
    let open = match open(machine).as_slice() {
        [] => String::new(),
        open => format!("<br><span class=\"source\">{}</span>", open.join(", ")),
    };
    format!(
        "<tr><td class=\"name\"><a href=\"{}\">{}</a></td><td>{}{open}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
        escape(&(links.machine)(&machine.name)),
        escape(&machine.name),
        escape(&verdict),
        age(history, machine).unwrap_or_default(),
        printed(&change),
        worst.and_then(chart::small).unwrap_or_default()
    )
}

fn ranges(history: &History) -> String {
    let row = |range: &crate::history::Range| {
        let number = |value: f64| printed(&super::number(value, &range.unit));
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{} to {}</td></tr>\n",
            escape(&range.kind),
            escape(&range.name()),
            range.machines.len(),
            number(range.expected.0),
            number(range.expected.1)
        )
    };
    let rows: String = history.ranges.iter().map(row).collect();
    if rows.is_empty() {
        return rows;
    }
    let head =
        "<tr><th>Kind</th><th>Number</th><th>Machines</th><th>One more is expected within (95 %)</th></tr>";
    let table = format!(
        "<div class=\"wide\"><table>\n<thead>{head}</thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n"
    );
    section("Between machines", &table)
}

fn of_machine(history: &History, machine: &Machine, links: &Links<'_>) -> String {
    let kind = machine.kind.as_ref().map(|kind| format!(", {kind}")).unwrap_or_default();
    let age = age(history, machine).map(|age| format!(", last test {age}")).unwrap_or_default();
    let mut body = format!(
        "<section id=\"{}\">\n<h1>{}</h1>\n<p class=\"source\">{}{}{}</p>\n",
        encoded(&machine.name),
        escape(&machine.name),
        count(machine),
        escape(&kind),
        age
    );
    for alarm in history.alarms.iter().filter(|alarm| alarm.machine == machine.name) {
        body += &of_alarm(alarm, links);
    }
    let mut shown: Vec<_> = machine.series.iter().collect();
    shown.sort_by_key(|followed| !followed.alarm);
    let plots: String = shown
        .into_iter()
        .filter_map(|followed| {
            Some(format!(
                "<figure>{}<figcaption>{}</figcaption></figure>\n",
                chart::plot(followed)?,
                printed(&brief(followed))
            ))
        })
        .collect();
    if !plots.is_empty() {
        body += &format!("<h2>Over time</h2>\n<div class=\"plots\">\n{plots}</div>\n");
    }
    let rows: String = machine
        .recordings
        .iter()
        .rev()
        .map(|entry| {
            let name = escape(&entry.recording);
            let name = match entry.page.as_deref().and_then(links.report) {
                Some(link) => format!("<a href=\"{}\">{name}</a>", escape(&link)),
                None => name,
            };
            let sentence = printed(&entry.sentence);
            let gone = if entry.listed { "" } else { " <span class=\"source\">(missing)</span>" };
            format!(
                "<tr><td class=\"name\">{}</td><td>{name}{gone}</td><td>{sentence}</td></tr>\n",
                entry.time.day()
            )
        })
        .collect();
    let head = "<tr><th>Made</th><th>Recording</th><th>Diagnosis</th></tr>";
    body += &format!(
        "<h2>Recordings</h2>\n<table class=\"recordings\">\n<thead>{head}</thead>\n<tbody>\n{rows}</tbody>\n</table>\n</section>\n"
    );
    body
}
