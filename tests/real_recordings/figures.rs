//! The figures of a diagnosis as the pages of `docs/cases` show them. In: a diagnosis as JSON and a page. Out: a complaint
//! where the page shows anything else than today's figures.

use std::env;
use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::shipped::root;

/// The environment variable that has the pages written anew instead of checked.
const WRITE: &str = "ABBE_WRITE_FIGURES";

/// How far something found is from what is documented of it.
pub(super) struct Distance {
    /// What is compared with which figure.
    pub(super) what: String,
    /// What is found, in any unit.
    pub(super) found: f64,
    /// Half the width of its interval, where it has one.
    pub(super) half_width: Option<f64>,
    /// What is documented, in the same unit.
    pub(super) documented: f64,
}

impl Distance {
    fn told(&self) -> String {
        let share = 100.0 * (self.found / self.documented - 1.0);
        let widths = self.half_width.map(|half| (self.found - self.documented).abs() / half);
        let widths =
            widths.map_or(String::new(), |widths| format!(", {widths:.1} half widths of its interval"));
        let places = if share.abs() < 0.1 { 3 } else { 1 };
        format!("{share:+.places$} %{widths}")
    }
}

/// Holds the marked block of a page against a diagnosis and how far it is from what is documented.
pub(super) fn check(page: &str, block: &str, found: &Value, distances: &[Distance]) {
    let path = path(page);
    let text = fs::read_to_string(&path).unwrap();
    let opening = format!("<!-- figures {block} -->\n");
    let from = text.find(&opening).expect("the page has such a block") + opening.len();
    let to = from + text[from..].find("<!-- end -->").expect("the block ends");
    let today = table(found, distances);
    if env::var_os(WRITE).is_some() {
        fs::write(&path, format!("{}{today}{}", &text[..from], &text[to..])).unwrap();
        return;
    }
    assert_eq!(
        &text[from..to],
        today,
        "docs/cases/{page}.md shows old figures of {block}; with {WRITE}=1 and one thread the tests write them anew"
    );
}

/// Holds the row of a case in the list of all cases against a diagnosis: its parameters and the last three cells.
pub(super) fn check_row(title: &str, found: &Value) {
    let text = fs::read_to_string(path("README")).unwrap();
    let row = text.lines().find(|line| line.starts_with(&format!("| [{title}](")));
    let cells: Vec<&str> = row.expect("the case is in the list").split(" | ").map(str::trim).collect();
    let [_, _, _, _, parameters, _, before, after, held_out] = cells.as_slice() else {
        panic!("{title} has {} cells", cells.len());
    };
    let rms = |when: &str, which: &str| rms(&found[when][which], &text_of(&found[when]["unit"]));
    let rms = [rms("before", "rms"), rms("after", "rms"), rms("after", "holdout_rms")];
    assert_eq!([*before, *after, held_out.trim_end_matches(" |")], rms, "docs/cases/README.md, {title}");
    let all: Vec<String> = findings(found).iter().flat_map(parameter_rows).map(|(_, value)| value).collect();
    for parameter in parameters.split("; ").filter(|parameter| *parameter != "-") {
        let told = all.iter().any(|value| parameter.ends_with(value.as_str()));
        assert!(told, "docs/cases/README.md, {title}: {parameter} is none of {all:?}");
    }
}

fn path(page: &str) -> PathBuf {
    root().join("docs/cases").join(page).with_extension("md")
}

/// All figures of a diagnosis, and how far they are from what is documented.
fn table(found: &Value, distances: &[Distance]) -> String {
    let rms_of = |part: &Value, key: &str| rms(&part[key], &text_of(&part["unit"]));
    let mut rows = vec![
        ("verdict".to_owned(), text_of(&found["verdict"])),
        ("noise of a sample".to_owned(), rms_of(&found["noise"], "value")),
        ("rms before, all samples".to_owned(), rms_of(&found["before"], "rms")),
        ("rms after, all samples".to_owned(), rms_of(&found["after"], "rms")),
        ("rms before, held out".to_owned(), rms_of(&found["before"], "holdout_rms")),
        ("rms after, held out".to_owned(), rms_of(&found["after"], "holdout_rms")),
    ];
    for finding in findings(found) {
        let name = name(finding);
        rows.extend(
            parameter_rows(finding).into_iter().map(|(key, value)| (format!("{name}: {key}"), value)),
        );
        rows.push((format!("{name}: held out without it"), rms_of(&finding["evidence_rms"], "without")));
        for other in finding["indistinguishable_from"].as_array().unwrap() {
            let other = format!("{} of {}", text_of(&other["term"]), text_of(&other["motion"]));
            rows.push((format!("{name}: or else"), other));
        }
    }
    let unexplained = &found["unexplained"];
    if unexplained.is_object() {
        rows.push(("unexplained".to_owned(), text_of(&unexplained["direction"])));
        rows.push(("unexplained: rms where it appears".to_owned(), rms_of(unexplained, "rms")));
        rows.push(("unexplained: what".to_owned(), text_of(&unexplained["detail"])));
        let interval = &unexplained["interval"];
        if let (Some(from), Some(to)) = (interval["from"].as_f64(), interval["to"].as_f64()) {
            // Two digits of the width.
            let tells = |places: &usize| (to - from) * 10_f64.powi(i32::try_from(*places).unwrap()) >= 10.0;
            let places = (0..12).find(tells).unwrap_or(12);
            let place = format!("{from:.places$} to {to:.places$} {}", text_of(&interval["unit"]));
            rows.push((format!("unexplained: {}", text_of(&interval["axis"])), place));
        }
    }
    rows.extend(distances.iter().map(|distance| (format!("off: {}", distance.what), distance.told())));
    let rows: String = rows.iter().map(|(name, value)| format!("| {name} | {value} |\n")).collect();
    format!("| figure | today |\n| --- | --- |\n{rows}")
}

fn findings(found: &Value) -> &[Value] {
    found["findings"].as_array().unwrap()
}

/// Term, motion and side.
fn name(finding: &Value) -> String {
    let side = text_of(&finding["where"]["side"]);
    format!("{} of {}, {side}", text_of(&finding["term"]), text_of(&finding["motion"]))
}

/// The parameters of a finding and their values with intervals; lists by number.
fn parameter_rows(finding: &Value) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    for (key, value) in finding["parameters"].as_object().unwrap() {
        let key = key.replace('_', " ");
        match (value.as_str(), value.as_array()) {
            (Some(word), _) => rows.push((key, word.to_owned())),
            (_, Some(items)) if key == "at" => rows.push((key, places(items))),
            (_, Some(items)) => rows.extend(
                items.iter().enumerate().map(|(place, item)| (format!("{key} {}", place + 1), fitted(item))),
            ),
            _ => rows.push((key, fitted(value))),
        }
    }
    rows
}

/// Where the nodes of a table stand.
fn places(nodes: &[Value]) -> String {
    let of = |node: &Value| node["value"].as_f64().unwrap().to_string();
    let unit = nodes.first().map(|node| text_of(&node["unit"])).unwrap_or_default();
    format!("{} {unit}", nodes.iter().map(of).collect::<Vec<_>>().join(", "))
}

/// A fitted number with its interval, to two digits of its half width.
fn fitted(number: &Value) -> String {
    let (factor, unit) = shown(&text_of(&number["unit"]));
    let Some(value) = number["value"].as_f64() else { return "no number".to_owned() };
    let ends = (number["ci95"][0].as_f64(), number["ci95"][1].as_f64());
    let (Some(low), Some(high)) = ends else { return format!("{} {unit}", factor * value) };
    let half = factor * (high - low) / 2.0;
    let places = decimals(half, 2);
    let show = |number: f64| format!("{:.places$}", factor * number);
    format!("{} ({} to {}) {unit}", show(value), show(low), show(high))
}

/// A root mean square, to three digits.
fn rms(number: &Value, unit: &str) -> String {
    let (factor, unit) = shown(unit);
    let Some(value) = number.as_f64() else { return "-".to_owned() };
    let places = decimals(factor * value, 3);
    format!("{:.places$} {unit}", factor * value)
}

/// The decimal places at which a number has so many digits.
fn decimals(number: f64, digits: i32) -> usize {
    let size = number.abs().log10().floor();
    (0..12)
        .find(|places| size + f64::from(*places) >= f64::from(digits - 1))
        .map_or(0, |places| usize::try_from(places).unwrap())
}

/// A unit as the pages write it, and the factor to it.
fn shown(unit: &str) -> (f64, String) {
    match unit {
        "mm" => (1e3, "um".to_owned()),
        "rad" => (1f64.to_degrees(), "deg".to_owned()),
        "" => (1e6, "ppm".to_owned()),
        _ => match unit.strip_prefix("mm/") {
            Some(per) => match per {
                "mm" | "mm^2" | "mm^3" => (1.0, unit.to_owned()),
                _ => (1e3, format!("um/{per}")),
            },
            None => (1.0, unit.to_owned()),
        },
    }
}

fn text_of(value: &Value) -> String {
    value.as_str().unwrap_or("").to_owned()
}
