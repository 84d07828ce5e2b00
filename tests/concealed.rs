//! Examples of concealed effects, made by a simulation that is not ours, each with its truth: `abbe diagnose` must find what
//! was left out, and no more. In: the folders beside the repository, where they are. Out: every one of their demands.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread;

use model_dsl::diagnostic::Diagnostics;
use model_dsl::quantity::parse_unit;
use model_dsl::source::SourceFile;
use model_dsl::yaml::{self, Node};
use serde_json::Value;

use crate::beside::listed;
use crate::cli::abbe;

/// A motion and a term.
type Name = (String, String);

/// One effect that was left out.
struct Effect {
    name: Name,
    /// Other names for the same thing to first order.
    accept: Vec<Name>,
    side: Option<String>,
    /// Numbers by name and place, in mm, rad, s.
    numbers: Vec<(String, usize, f64)>,
    /// The names of axes and sensors.
    words: Vec<(String, String)>,
}

/// What was left out of one recording.
struct Truth {
    verdict: String,
    effects: Vec<Effect>,
    /// The settings of the instrument, by name.
    settings: Vec<String>,
    /// An axis and an interval of it.
    locate: Option<(String, f64, f64)>,
    holdout_noise: Option<f64>,
}

/// One folder and what is wrong with its diagnosis.
struct Verdict {
    folder: String,
    wrong: Vec<String>,
    /// Every interval: what it says, and whether it holds the truth, itself and at twice its width.
    intervals: Vec<(String, bool, bool)>,
}

#[test]
fn concealed_effects_are_found_and_nothing_else() {
    let Some(folders) = listed("concealed") else { return };
    let verdicts = verdicts(folders);
    assert!(!verdicts.is_empty(), "no folder has a truth");
    let wrong: Vec<String> = verdicts
        .iter()
        .flat_map(|verdict| verdict.wrong.iter().map(|wrong| format!("{}: {wrong}", verdict.folder)))
        .collect();
    let intervals = verdicts.iter().flat_map(|verdict| &verdict.intervals);
    let (all, held) =
        intervals.clone().fold((0, 0), |(all, held), (_, holds, _)| (all + 1, held + i32::from(*holds)));
    for (what, ..) in intervals.clone().filter(|(_, holds, _)| !holds) {
        println!("outside its interval of 95 %: {what}");
    }
    println!("{held} of {all} intervals of 95 % hold the truth");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let far: Vec<&String> = intervals.filter(|(.., near)| !near).map(|(what, ..)| what).collect();
    assert!(far.is_empty(), "outside twice the interval: {far:#?}");
    assert!(20 * held >= 19 * all, "{held} of {all} intervals of 95 % hold the truth");
}

/// The diagnoses of all examples held against their truths; on as many cores as there are.
fn verdicts(mut folders: Vec<PathBuf>) -> Vec<Verdict> {
    folders.retain(|folder| folder.join("truth.yaml").is_file());
    folders.reverse();
    let (left, done) = (Mutex::new(folders), Mutex::new(Vec::new()));
    let next = || left.lock().unwrap().pop();
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(|| {
                while let Some(folder) = next() {
                    let verdict = judge(&folder);
                    done.lock().unwrap().push(verdict);
                }
            });
        }
    });
    let mut verdicts = done.into_inner().unwrap();
    verdicts.sort_by(|left: &Verdict, right: &Verdict| left.folder.cmp(&right.folder));
    verdicts
}

fn judge(folder: &Path) -> Verdict {
    let mut verdict = Verdict {
        folder: folder.file_name().unwrap().to_string_lossy().into_owned(),
        wrong: Vec::new(),
        intervals: Vec::new(),
    };
    let truth = truth(&folder.join("truth.yaml"));
    let recording = folder.join("recording.yaml");
    let run = abbe(&["diagnose", recording.to_str().unwrap(), "--format", "json", "--quiet"], "");
    match serde_json::from_str::<Value>(&run.out) {
        Ok(found) if run.status == 0 => verdict.check(&truth, &found),
        _ => verdict.wrong.push(format!("status {}: {}{}", run.status, run.out, run.err)),
    }
    verdict
}

impl Verdict {
    fn demand(&mut self, holds: bool, what: impl FnOnce() -> String) {
        if !holds {
            self.wrong.push(what());
        }
    }

    fn check(&mut self, truth: &Truth, found: &Value) {
        let findings = found["findings"].as_array().unwrap();
        // A table over the place of a dent says the same as an interval that nothing explains.
        let table = |finding: &Value| {
            let axis = finding["where"]["interval"]["axis"].as_str();
            finding["term"] == "table" && truth.locate.as_ref().is_some_and(|(own, ..)| axis == Some(own))
        };
        let as_good = truth.verdict == "unexplained" && findings.iter().any(table);
        let said = text(&found["verdict"]);
        let right = said == truth.verdict || as_good && said == "left-out-physics";
        self.demand(right, || format!("the verdict is {said}, not {}", truth.verdict));
        for effect in &truth.effects {
            let there = findings.iter().any(|finding| effect.is(&name(finding)) || effect.among(finding));
            self.demand(there, || format!("{:?} is not found", effect.name));
        }
        for finding in findings {
            let known = truth.effects.iter().any(|effect| effect.is(&name(finding)) || effect.among(finding));
            self.demand(known || table(finding), || format!("{:?} is not there", name(finding)));
        }
        for setting in found["instrument"].as_array().unwrap() {
            let known = truth.settings.contains(&text(&setting["term"])) || setting["term"] == "radius";
            self.demand(known, || format!("the instrument's {} is not there", setting["term"]));
        }
        self.check_place(truth, found, findings);
        self.check_rms(truth, found);
        for effect in &truth.effects {
            if let Some(finding) = findings.iter().find(|finding| name(finding) == effect.name) {
                self.check_side(effect, finding);
                // Where one name may stand for another effect too, only their sum has a value.
                let mixed = truth.effects.iter().any(|other| other.accept.contains(&effect.name));
                if !mixed {
                    self.check_parameters(effect, finding);
                }
            }
        }
    }

    fn check_place(&mut self, truth: &Truth, found: &Value, findings: &[Value]) {
        let Some((axis, from, to)) = &truth.locate else { return };
        let told = std::iter::once(&found["unexplained"]["interval"])
            .chain(findings.iter().map(|finding| &finding["where"]["interval"]));
        let fits = |interval: &Value| {
            let (Some(low), Some(high)) = (interval["from"].as_f64(), interval["to"].as_f64()) else {
                return false;
            };
            interval["axis"] == axis.as_str()
                && low <= *to
                && high >= *from
                && high - low <= 2.0 * (to - from)
        };
        let fits = told.clone().any(fits);
        let told: Vec<&Value> = told.collect();
        self.demand(fits, || format!("the place is {axis} {from} to {to}, not {told:?}"));
    }

    fn check_rms(&mut self, truth: &Truth, found: &Value) {
        let named = truth.verdict == "left-out-physics" || truth.verdict == "adequate";
        let Some(noise) = truth.holdout_noise.filter(|_| named) else { return };
        let rms = found["after"]["holdout_rms"].as_f64().unwrap_or(f64::NAN);
        let rms = internal(rms, &text(&found["after"]["unit"]));
        self.demand((rms / noise - 1.0).abs() <= 0.1, || {
            format!("held out {rms} is left, the noise is {noise}")
        });
    }

    fn check_side(&mut self, effect: &Effect, finding: &Value) {
        let Some(side) = &effect.side else { return };
        let said = &finding["where"]["side"];
        self.demand(said == side.as_str(), || format!("{:?} is on the side {said}, not {side}", effect.name));
    }

    fn check_parameters(&mut self, effect: &Effect, finding: &Value) {
        let parameters = &finding["parameters"];
        for (key, word) in &effect.words {
            self.demand(parameters[key] == word.as_str(), || {
                format!("{:?} has the {key} {}, not {word}", effect.name, parameters[key])
            });
        }
        for (key, place, truth) in &effect.numbers {
            let number = match &parameters[key] {
                Value::Array(list) => list.get(*place).unwrap_or(&Value::Null),
                other => other,
            };
            // The constant part of a curve is as free as the zero of the instrument.
            if number.is_null()
                || number["ci95"].is_null()
                || key == "coefficients" && *place == 0 && *truth == 0.0
            {
                continue;
            }
            self.intervals.push(interval(
                &format!("{} {:?} {key} {place}", self.folder, effect.name),
                *truth,
                number,
            ));
        }
    }
}

/// Whether an interval, and one of twice its width, holds a number.
fn interval(what: &str, truth: f64, number: &Value) -> (String, bool, bool) {
    let unit = text(&number["unit"]);
    let read = |value: &Value| internal(value.as_f64().unwrap_or(f64::NAN), &unit);
    let (value, low, high) = (read(&number["value"]), read(&number["ci95"][0]), read(&number["ci95"][1]));
    let turns = if what.contains(" phase ") { TAU * ((value - truth) / TAU).round() } else { 0.0 };
    let truth = truth + turns;
    let holds =
        |stretch: f64| truth >= value - stretch * (value - low) && truth <= value + stretch * (high - value);
    (format!("{what}: {truth} in {value} ({low} to {high})"), holds(1.0), holds(2.0))
}

impl Effect {
    /// Whether a name is this effect's.
    fn is(&self, name: &Name) -> bool {
        self.name == *name || self.accept.contains(name)
    }

    /// Whether a finding says that it cannot be told from this effect.
    fn among(&self, finding: &Value) -> bool {
        finding["indistinguishable_from"].as_array().unwrap().iter().any(|other| self.is(&name(other)))
    }
}

fn name(finding: &Value) -> Name {
    (text(&finding["motion"]), text(&finding["term"]))
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or("").to_owned()
}

/// A number in mm, rad, s, degC.
fn internal(number: f64, unit: &str) -> f64 {
    if unit.is_empty() { number } else { number * parse_unit(unit).unwrap().factor }
}

fn truth(path: &Path) -> Truth {
    let source = SourceFile::new(path.display().to_string(), fs::read_to_string(path).unwrap());
    let root = yaml::read(&source, &mut Diagnostics::new()).unwrap();
    let unit = root.get("unit").and_then(Node::text).unwrap_or("").to_owned();
    let of_angle = internal(1.0, &unit);
    let list = |key: &str| root.get(key).and_then(Node::items).unwrap_or(&[]);
    let at = |node: &Node, key: &str| node.get(key).and_then(Node::text).unwrap().to_owned();
    Truth {
        verdict: at(&root, "verdict"),
        effects: list("findings").iter().map(|node| effect(node, of_angle)).collect(),
        settings: list("instrument").iter().map(|node| at(node, "term")).collect(),
        locate: root.get("locate").map(|node| {
            (at(node, "axis"), at(node, "from").parse().unwrap(), at(node, "to").parse().unwrap())
        }),
        holdout_noise: root.get("holdout_noise_rms").map(|node| of_angle * number(node)),
    }
}

/// `of_angle`: rad in the unit in which the file speaks of an axis and its errors, where that is an angle.
fn effect(node: &Node, of_angle: f64) -> Effect {
    let pair =
        |first: &Node, second: &Node| (first.text().unwrap().to_owned(), second.text().unwrap().to_owned());
    let accept = node.get("accept").and_then(Node::items).unwrap_or(&[]);
    let mut effect = Effect {
        name: pair(node.get("motion").unwrap(), node.get("term").unwrap()),
        accept: accept
            .iter()
            .map(|names| pair(&names.items().unwrap()[0], &names.items().unwrap()[1]))
            .collect(),
        side: node.get("side").and_then(Node::text).map(str::to_owned),
        numbers: Vec::new(),
        words: Vec::new(),
    };
    let sized: BTreeSet<&str> = ["lost_motion", "wind_up", "amplitude", "height", "period", "value"].into();
    for (key, value) in node.get("parameters").and_then(Node::entries).unwrap_or(&[]) {
        let key = key.value.as_str();
        let factor = if sized.contains(key) { of_angle } else { 1.0 };
        match (key, value.items()) {
            ("axis" | "sensor" | "load", _) => {
                effect.words.push((key.to_owned(), value.text().unwrap().to_owned()))
            }
            (_, Some(items)) => {
                let numbers = items.iter().enumerate();
                effect
                    .numbers
                    .extend(numbers.map(|(place, item)| (key.to_owned(), place, factor * number(item))));
            }
            _ => effect.numbers.push((key.to_owned(), 0, factor * number(value))),
        }
    }
    effect
}

fn number(node: &Node) -> f64 {
    node.text().unwrap().parse().unwrap()
}
