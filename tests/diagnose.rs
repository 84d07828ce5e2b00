//! `abbe diagnose` as its users meet it: the shipped recording, what is written back, and how it ends; and `abbe simulate`
//! in place of a recording.

use std::fs;
use std::path::{Path, PathBuf};

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml::{self, Node};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

use crate::cli::{Run, abbe, column};
use crate::shipped::root;

/// The recording that the repository ships.
const SHIPPED: &str = "recordings/postech-ballbar";

/// The calibration that it names.
const KNOWN: &str = "calibrations/postech-mill.yaml";

/// A folder of a test's own, empty.
fn folder(test: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("diagnose").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn done(run: Run) -> Run {
    assert_eq!(run.status, 0, "{}", run.err);
    run
}

fn json(run: &Run) -> Value {
    serde_json::from_str(&run.out).unwrap_or_else(|error| panic!("{error}: {}", run.out))
}

/// Simulates into a folder and gives the two files.
fn simulated(arguments: &[&str], output: &Path) -> (String, String) {
    done(abbe(&[&["simulate"], arguments, &["--output", output.to_str().unwrap()]].concat(), ""));
    (text(&output.join("recording.yaml")), text(&output.join("data.csv")))
}

mod shipped_recording {
    use super::*;

    fn file(name: &str) -> String {
        format!("{SHIPPED}/{name}")
    }

    #[test]
    fn it_is_made_again_byte_for_byte() {
        let (recording, data) = simulated(
            &[&file("true.yaml"), &file("path.yaml"), "--known", KNOWN],
            &folder("made-again").join("out"),
        );
        assert_eq!(data, text(&root().join(file("data.csv"))));
        // The ways to the calibration and to the schema depend on where the recording lies.
        let of_place =
            |line: &str| line.starts_with("calibration:") || line.starts_with("# yaml-language-server:");
        let but_calibration = |text: &str| -> Vec<String> {
            text.lines().filter(|line| !of_place(line)).map(str::to_owned).collect()
        };
        let kept = text(&root().join(file("recording.yaml")));
        assert_eq!(but_calibration(&recording), but_calibration(&kept));
        assert!(kept.contains(&format!("calibration: ../../{KNOWN}\n")), "{kept}");
    }

    /// The machine that was recorded is the published one with what is marked as concealed, and nothing else.
    #[test]
    fn it_conceals_what_is_marked_and_nothing_else() {
        let published = text(&root().join(KNOWN));
        let published = &published[published.find("calibration: 1").unwrap()..];
        let full = text(&root().join(file("true.yaml")));
        let full = &full[full.find("calibration: 1").unwrap()..];
        let own = |text: &str| -> Vec<String> {
            let lines =
                text.lines().filter(|line| !line.starts_with("source:") && !line.ends_with("# concealed"));
            lines.map(str::to_owned).collect()
        };
        assert_eq!(own(full), own(published));
        assert_eq!(full.matches("# concealed").count(), 2);
    }

    #[test]
    fn its_effects_are_found_and_written_back() {
        let folder = folder("written-back");
        let improved = folder.join("improved.yaml");
        let improved = improved.to_str().unwrap();
        let recording = file("recording.yaml");
        let arguments =
            ["diagnose", &recording, "--format", "json", "--quiet", "--write-calibration", improved];
        let run = done(abbe(&arguments, ""));
        let diagnosis = json(&run);
        assert_eq!(diagnosis["schema"], "abbe-diagnosis/1");
        let truth = truth();
        assert_eq!(diagnosis["verdict"], truth.get("verdict").and_then(Node::text).unwrap());
        for key in ["findings", "instrument"] {
            same_effects(&diagnosis[key], truth.get(key).unwrap());
        }
        // The improved calibration reproduces what is said to be left, and a controller can use it.
        let (_, predicted) = simulated(&[improved, &recording], &folder.join("predicted"));
        let measured = text(&root().join(file("data.csv")));
        let left = left_of_a_circle(&measured, &predicted, [275.0, 140.0]);
        let after = diagnosis["after"]["rms"].as_f64().unwrap();
        assert!((left / after - 1.0).abs() < 0.02, "{left} is left, {after} is said to be");
        let (_, predicted) = simulated(&[KNOWN, &recording], &folder.join("known"));
        let left = left_of_a_circle(&measured, &predicted, [275.0, 140.0]);
        // Centre and radius are fitted to what is not held out; those of all rows leave less, but not much.
        let before = diagnosis["before"]["rms"].as_f64().unwrap();
        assert!(left < before && before < 1.05 * left, "{left} was left, {before} is said to have been");
        let points = text(&root().join("calibrations/postech-points.csv"));
        let compensated = done(abbe(&["compensate", improved], &points));
        let published = done(abbe(&["compensate", KNOWN], &points));
        // X runs forward: it stands behind by another half of the lost motion that was found.
        let found = diagnosis["findings"][0]["parameters"]["lost_motion"]["value"].as_f64().unwrap();
        let [new, old] = [compensated, published].map(|run| column(&run.out, "error_x"));
        for (new, old) in new.iter().zip(&old) {
            assert!((old - new - found / 2.0).abs() < 2e-5, "{new} {old} {found}");
        }
    }

    fn truth() -> Node {
        let source = SourceFile::new("truth.yaml", text(&root().join(file("truth.yaml"))));
        yaml::read(&source, &mut Diagnostics::new()).unwrap()
    }

    /// The same effects, in any order, and every true number inside the interval of the one that was found.
    fn same_effects(found: &Value, truth: &Node) {
        let found = found.as_array().unwrap();
        let truth = truth.items().unwrap();
        assert_eq!(found.len(), truth.len(), "{found:?}");
        for effect in truth {
            let word = |key: &str| effect.get(key).and_then(Node::text);
            let same = |own: &&Value| {
                own["term"].as_str() == word("term") && own["motion"].as_str() == word("motion")
            };
            let own = found.iter().find(same).unwrap_or_else(|| panic!("{:?} is not found", word("term")));
            for (name, value) in effect.get("parameters").unwrap().entries().unwrap() {
                let own = &own["parameters"][name.value.as_str()];
                let low = own["ci95"][0].as_f64().unwrap();
                let high = own["ci95"][1].as_f64().unwrap();
                let value = internal(value.text().unwrap());
                assert!(low <= value && value <= high, "{}: {value} is not in {low} to {high}", name.value);
            }
        }
    }

    /// A quantity of the truth in mm or rad.
    fn internal(text: &str) -> f64 {
        let (number, unit) = text.split_once(' ').unwrap();
        let factor = match unit {
            "mm" => 1.0,
            "um" => 1e-3,
            "deg" => 1_f64.to_radians(),
            _ => panic!("the unit {unit}"),
        };
        number.parse::<f64>().unwrap() * factor
    }

    /// What a prediction leaves of a ballbar's readings, root mean square, a centre and a radius fitted.
    fn left_of_a_circle(measured: &str, predicted: &str, center: [f64; 2]) -> f64 {
        let left = DVector::from_vec(column(measured, "dev")) - DVector::from_vec(column(predicted, "dev"));
        let [x, y] = [("x_cmd", center[0]), ("y_cmd", center[1])]
            .map(|(name, center)| column(measured, name).iter().map(|at| at - center).collect::<Vec<_>>());
        let design = DMatrix::from_fn(left.len(), 3, |row, column| match column {
            0 => 1.0,
            1 => x[row],
            _ => y[row],
        });
        let fitted = design.clone().svd(true, true).solve(&left, 1e-12).unwrap();
        ((left - design * fitted).norm_squared() / x.len() as f64).sqrt()
    }
}

/// A stage with a backlash that nobody knows, and a recording of it: small, so that a diagnosis takes a moment.
mod stage {
    use super::*;

    pub(super) const FULL: &str =
        "calibration: 1\nmachine: FX\nerrors: {EXX: [{backlash: {lost_motion: 8 um}}]}\n";
    pub(super) const KNOWN: &str = "calibration: 1\nmachine: FX\nerrors: {}\n";
    const PATH: &str = "path: 1\nline: {axis: X, from: 0 mm, to: 50 mm}\nfeed: 10 mm/s\nrate: 10 Hz\nruns: 3\ninstrument: {position: [x]}\nnoise: {white: 0.2 um}\nseed: 3\n";

    /// The folder with the recording, its data and the known calibration.
    pub(super) fn recorded(test: &str) -> PathBuf {
        let folder = folder(test);
        let [full, known, path] = [("full.yaml", FULL), ("known.yaml", KNOWN), ("path.yaml", PATH)]
            .map(|(name, text)| write(&folder, name, text));
        simulated(&[&full, &path, "--known", &known], &folder);
        folder
    }
}

fn names_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn joined(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_owned()
}

#[test]
fn every_format_says_the_same_each_time() {
    let folder = stage::recorded("formats");
    let recording = joined(&folder, "recording.yaml");
    let said = |format: &str| {
        let run = done(abbe(&["diagnose", &recording, "--format", format], ""));
        assert_eq!(run.err, "", "nobody watches: no progress");
        let again = done(abbe(&["diagnose", &recording, "--format", format, "--quiet"], ""));
        assert_eq!((&again.out, again.err.as_str()), (&run.out, ""));
        run.out
    };
    let value: Value = serde_json::from_str(&said("json")).unwrap();
    assert_eq!(value["verdict"], "left-out-physics");
    assert_eq!(value["findings"][0]["motion"], "EXX");
    assert_eq!(value["findings"][0]["term"], "backlash");
    let plain = said("text");
    assert!(plain.starts_with("Diagnosis of FX") && plain.contains("Backlash in EXX"), "{plain}");
    let html = said("html");
    assert!(html.starts_with("<!DOCTYPE html>") && html.trim_end().ends_with("</html>"), "{html}");
    assert!(!html.contains("http://") && !html.contains("src="), "the page fetches nothing");
    assert_eq!(done(abbe(&["diagnose", &recording], "")).out, plain, "text is the default");
}

#[test]
fn a_verdict_that_scripts_wait_for_is_a_status() {
    let folder = stage::recorded("fail-on");
    let recording = joined(&folder, "recording.yaml");
    let (report, improved) = (joined(&folder, "report.json"), joined(&folder, "improved.yaml"));
    let run = |more: &[&str]| abbe(&[&["diagnose", &recording, "--format", "json"], more].concat(), "");
    let plain = run(&[]);
    assert_eq!(json(&plain)["verdict"], "left-out-physics");
    // The report stands all the same, and what is to be written is written.
    let fails = run(&["--fail-on", "unexplained,left-out-physics", "--write-calibration", &improved]);
    assert_eq!((fails.status, fails.err.as_str()), (1, ""));
    assert_eq!(fails.out, plain.out);
    assert!(Path::new(&improved).exists());
    let passes = run(&["--fail-on", "unexplained,not-repeatable", "--output", &report]);
    assert_eq!((passes.status, passes.out.as_str()), (0, ""), "{}", passes.err);
    assert_eq!(text(Path::new(&report)), plain.out);
    assert_eq!(run(&["--fail-on", "wrong"]).status, 2);
    let over = run(&["--output", &recording, "--force"]);
    assert!(
        over.status == 2 && over.err.contains("is one of the files that this command reads or writes"),
        "{}",
        over.err
    );
    let both = run(&["--write-calibration", &improved, "--output", &improved, "--force"]);
    assert_eq!(both.status, 2, "{}", both.err);
}

/// The words of a page or a text, without marks and the ends of sentences; signs of print as a terminal shows them.
fn words(text: &str) -> Vec<String> {
    let plain = text.split('<').map(|piece| piece.split_once('>').map_or(piece, |(_, text)| text));
    let plain = plain.collect::<Vec<_>>().join(" ");
    let signs = [("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&"), ("\u{b1}", "+-"), ("\u{b5}", "u")];
    let plain = signs.iter().fold(plain, |plain, (sign, letters)| plain.replace(sign, letters));
    plain.split_whitespace().map(|word| word.trim_end_matches('.').to_owned()).collect()
}

#[test]
fn the_page_of_every_shipped_recording_begins_as_its_text_begins() {
    let recordings = ["postech-ballbar", "servo-rest", "guided-mount-1", "guided-mount-2"];
    for recording in recordings.map(|name| format!("recordings/{name}/recording.yaml")) {
        let said =
            |format: &str| done(abbe(&["diagnose", &recording, "--format", format, "--quiet"], "")).out;
        let (page, text) = (said("html"), said("text"));
        let (_, body) = page.split_once("<h1>").unwrap();
        let (summary, rest) = body.split_once("<section>").unwrap();
        // All that stands above the first heading.
        let (above, _) = text.split_once("\nWhat comes back\n---").unwrap();
        let page = words(&format!("<h1>{summary}"));
        let text = words(&above.replace('<', "&lt;").replace('>', "&gt;"));
        let verdict = |words: &[String]| words.split(|word| word == "motion").next().unwrap().to_vec();
        assert_eq!(verdict(&page), verdict(&text), "{recording}");
        // A cell of the table that is too wide for the text goes on below: the same words in another order.
        let [page, text] = [page, text].map(sorted);
        assert_eq!(page, text, "{recording}");
        // The first plot has every share of the JSON.
        let json: Value = serde_json::from_str(&said("json")).unwrap();
        let returns = json["returns"].as_array().unwrap();
        let (first, _) = rest.split_once("</section>").unwrap();
        assert!(first.starts_with("\n<h2>What comes back</h2>"), "{recording}");
        assert_eq!(first.matches("<figure>").count(), usize::from(!returns.is_empty()), "{recording}");
        let last = returns.last().map(|last| format!("does not come back: {}", percent(1.0 - share(last))));
        assert!(last.is_none_or(|last| first.contains(&last)), "{recording}: {first}");
    }
}

fn sorted(mut words: Vec<String>) -> Vec<String> {
    words.sort();
    words
}

fn share(returning: &Value) -> f64 {
    returning["share"].as_f64().unwrap()
}

/// A share with three digits that count.
fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    let places = if percent < 1.0 {
        3
    } else if percent < 10.0 {
        2
    } else {
        1
    };
    format!("{percent:.places$} %")
}

/// The page of the shipped recording says what the JSON and the written calibration say.
#[test]
fn a_page_holds_every_finding_its_plots_the_change_and_its_command() {
    let target = folder("page").join("improved.yaml");
    let recording = format!("{SHIPPED}/recording.yaml");
    let diagnose = |more: &[&str]| done(abbe(&[&["diagnose", recording.as_str()], more].concat(), "")).out;
    let page = diagnose(&["--format", "html", "--write-calibration", target.to_str().unwrap()]);
    let said: Value = serde_json::from_str(&diagnose(&["--format", "json"])).unwrap();
    assert!(page.len() < 1_500_000, "{}", page.len());
    for fetched in ["http", "<script", "src=", "href=", "url(", "NaN", "inf\""] {
        assert!(!page.contains(fetched), "{fetched}");
    }
    let findings = said["findings"].as_array().unwrap();
    assert!(!findings.is_empty());
    for finding in findings {
        let word = |key: &str| finding[key].as_str().unwrap();
        let bar = format!(">{} of {} ({})</text>", word("term"), word("motion"), word("meaning"));
        assert!(page.contains(&bar), "{bar}");
    }
    for title in [
        "Distribution of the residual",
        "Deviations, run 1, counter-clockwise",
        "Residual, run 1, clockwise",
        "Before, by position of X",
        "After, by position of Y",
        "Before and after, over time",
        "Mean of each run",
        "Before and after, by velocity of X",
        "Amplitudes by period along Y",
        "Amplitudes by frequency",
    ] {
        assert!(page.contains(&format!("class=\"t\">{title}</text>")), "{title}");
    }
    assert!(page.contains("0:1 relative to the circle of radius") && page.contains("100\u{a0}mm"));
    assert!(page.contains(&format!("abbe diagnose {recording} --format html")));
    assert!(page.contains("Hollow marks: held out") && page.contains("after, held out ("));
    // What the diff adds stands in the calibration that was written.
    let written = text(&target);
    let added: Vec<&str> =
        page.split("<span class=\"added\">+").skip(1).map(|line| line.split('<').next().unwrap()).collect();
    let terms = added
        .iter()
        .filter(|line| findings.iter().any(|finding| line.contains(finding["term"].as_str().unwrap())));
    assert_eq!(terms.count(), findings.len(), "{added:?}");
    for line in added.iter().filter(|line| !line.starts_with("++ ")) {
        assert!(written.contains(line), "{line}");
    }
}

#[test]
fn what_a_diagnosis_is_read_from_is_never_written_over() {
    let folder = stage::recorded("refused");
    let recording = joined(&folder, "recording.yaml");
    let before = names_in(&folder);
    for name in ["recording.yaml", "data.csv", "known.yaml"] {
        let target = folder.join(name);
        let kept = text(&target);
        let run = abbe(&["diagnose", &recording, "--write-calibration", target.to_str().unwrap()], "");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{name}");
        assert!(run.err.contains("one of the files that the diagnosis reads"), "{}", run.err);
        assert_eq!(text(&target), kept, "{name}");
    }
    for target in [joined(&folder, "no/such/folder.yaml"), folder.to_str().unwrap().to_owned()] {
        let run = abbe(&["diagnose", &recording, "--write-calibration", &target], "");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{target}");
    }
    assert_eq!(names_in(&folder), before);
}

#[test]
fn a_calibration_is_written_whole_and_replaces_what_was_there() {
    let folder = stage::recorded("replaced");
    let recording = joined(&folder, "recording.yaml");
    let target = joined(&folder, "improved.yaml");
    fs::write(&target, "something else\n").unwrap();
    let mut before = names_in(&folder);
    done(abbe(&["diagnose", &recording, "--write-calibration", &target], ""));
    let improved = text(Path::new(&target));
    assert!(improved.contains("backlash") && !improved.contains("something else"), "{improved}");
    assert_eq!(names_in(&folder), before, "nothing is left beside it");
    // With what it found as known, nothing is left out; what was known is written again, with a warning.
    let next = text(Path::new(&recording)).replace("known.yaml", "improved.yaml");
    let next = write(&folder, "next.yaml", &next);
    let again = joined(&folder, "again.yaml");
    let run = done(abbe(&["diagnose", &next, "--format", "json", "--write-calibration", &again], ""));
    assert_eq!(json(&run)["verdict"], "adequate");
    assert!(run.err.contains("again.yaml"), "{}", run.err);
    before.extend(["again.yaml".to_owned(), "next.yaml".to_owned()]);
    before.sort();
    assert_eq!(names_in(&folder), before);
    let errors = |text: &str| text[text.find("errors:").unwrap()..].to_owned();
    assert_eq!(errors(&text(Path::new(&again))), errors(&improved));
}

mod wrong_files {
    use super::*;

    /// A mill with curves that the order of its axes takes to different places.
    const ERRORS: &str = "errors:
  EXX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: um, values: [0, 9, -6, 12, 3, -8]}}]
  EBX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: urad, values: [0, 60, -20, -50, 10, 40]}}]
  ECX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: urad, values: [0, -30, 40, 70, 20, -60]}}]
  EAY: [{table: {axis: Y, start: 0 mm, step: 100 mm, unit: urad, values: [0, 45, -35, 25]}}]
";
    const PATH: &str = "path: 1
points: [{X: 20 mm, Y: 20 mm, Z: -90 mm}, {X: 480 mm}, {Y: 280 mm}, {X: 20 mm}, {Z: -10 mm}, {X: 480 mm}, {Y: 20 mm}, {X: 20 mm}]
feed: 50 mm/s
rate: 5 Hz
runs: 3
instrument: {position: [x, y, z]}
noise: {white: 0.5 um}
seed: 4
";

    fn calibration(machine: &str, errors: &str) -> String {
        format!("calibration: 1\nmachine: {machine}\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}}\n{errors}")
    }

    /// A recording of an XFYZ with these errors, beside files that say `machine` and `errors`.
    fn recorded(test: &str, machine: &str, errors: &str) -> PathBuf {
        let folder = folder(test);
        let truth = write(&folder, "truth.yaml", &calibration("XFYZ", ERRORS));
        let path = write(&folder, "path.yaml", PATH);
        let known = write(&folder, "known.yaml", &calibration(machine, errors));
        simulated(&[&truth, &path, "--known", &truth], &folder);
        let recording = joined(&folder, "recording.yaml");
        let wrong = text(Path::new(&recording)).replace("XFYZ", machine).replace("truth.yaml", "known.yaml");
        fs::write(&recording, wrong).unwrap();
        assert!(Path::new(&known).exists());
        folder
    }

    /// The diagnosis with its improved calibration.
    fn improved(folder: &Path) -> (Value, String) {
        let [recording, target] = ["recording.yaml", "improved.yaml"].map(|name| joined(folder, name));
        let run =
            done(abbe(&["diagnose", &recording, "--format", "json", "--write-calibration", &target], ""));
        (json(&run), text(Path::new(&target)))
    }

    #[test]
    fn a_wrong_sign_is_told_with_its_line_and_mended() {
        let wrong = ERRORS.replace("[0, -30, 40, 70, 20, -60]", "[0, 30, -40, -70, -20, 60]");
        let folder = recorded("wrong-sign", "XFYZ", &wrong);
        let (found, written) = improved(&folder);
        let change = &found["model"][0];
        assert_eq!((&change["path"], &change["change"]), (&"errors.ECX".into(), &"sign".into()), "{found}");
        assert!(change["file"].as_str().unwrap().ends_with("known.yaml"));
        let known = text(&folder.join("known.yaml"));
        let line = known.lines().position(|line| line.contains("ECX")).unwrap() + 1;
        assert_eq!(change["line"], line);
        assert_eq!(found["findings"], serde_json::json!([]));
        // With the mended file nothing is wrong.
        let next = text(&folder.join("recording.yaml")).replace("known.yaml", "improved.yaml");
        let next = write(&folder, "next.yaml", &next);
        let again = json(&done(abbe(&["diagnose", &next, "--format", "json"], "")));
        assert_eq!((&again["verdict"], &again["model"]), (&"adequate".into(), &serde_json::json!([])));
        assert_eq!(again["before"], found["after"]);
        assert!(written.contains("# Corrected: ECX has the wrong sign."), "{written}");
    }

    #[test]
    fn a_word_in_the_wrong_order_is_mended_and_what_it_says_can_be_replayed() {
        let folder = recorded("wrong-word", "FXYZ", ERRORS);
        let (found, written) = improved(&folder);
        let change = &found["model"][0];
        assert_eq!((&change["path"], &change["with"]), (&"topology".into(), &"XFYZ".into()), "{found}");
        assert!(written.contains("machine: XFYZ"), "{written}");
        // The recording still says the wrong word: the same axes in another order are replayed, with a warning.
        let [target, recording, out] =
            ["improved.yaml", "recording.yaml", "out"].map(|name| joined(&folder, name));
        let run = done(abbe(&["simulate", &target, &recording, "--output", &out], ""));
        assert!(run.err.contains("the same axes in another order"), "{}", run.err);
    }

    #[test]
    fn a_machine_file_is_written_beside_and_never_over() {
        let folder = recorded("wrong-file", "FXYZ", ERRORS);
        let machine = "# a mill of ours\nabbe: 1\nname: mill\ntopology: FXYZ # as drawn\n";
        write(&folder, "mill.yaml", machine);
        for name in ["known.yaml", "recording.yaml"] {
            let text = text(&folder.join(name)).replace("machine: FXYZ", "machine: mill.yaml");
            write(&folder, name, &text);
        }
        let (found, written) = improved(&folder);
        assert!(found["model"][0]["file"].as_str().unwrap().ends_with("mill.yaml"), "{found}");
        assert!(written.contains("machine: improved-XFYZ.yaml"), "{written}");
        assert_eq!(text(&folder.join("mill.yaml")), machine);
        assert_eq!(text(&folder.join("improved-XFYZ.yaml")), machine.replace("FXYZ", "XFYZ"));
        // What is there already is not written over, and then nothing is written at all.
        let kept = "something else\n";
        write(&folder, "other-XFYZ.yaml", kept);
        let [recording, target] = ["recording.yaml", "other.yaml"].map(|name| joined(&folder, name));
        let run = abbe(&["diagnose", &recording, "--write-calibration", &target], "");
        assert_eq!(run.status, 2, "{}", run.err);
        assert!(run.err.contains("never overwrites"), "{}", run.err);
        assert!(!Path::new(&target).exists());
        assert_eq!(text(&folder.join("other-XFYZ.yaml")), kept);
    }
}

#[test]
fn data_that_cannot_be_read_end_with_status_one_and_a_wrong_file_with_two() {
    let folder = stage::recorded("statuses");
    let recording = text(&folder.join("recording.yaml"));
    let data = text(&folder.join("data.csv"));
    let header = data.lines().next().unwrap();
    write(&folder, "broken.csv", &data.replacen("\n0.2,1,", "\n0.2,1,abc", 1));
    write(&folder, "empty.csv", "");
    write(&folder, "gaps.csv", &format!("{header}\n0,1,0,\n1,1,5,\n2,1,10,\n"));
    let target = joined(&folder, "improved.yaml");
    let with = |name: &str, old: &str, new: &str| {
        assert!(recording.contains(old), "{old}");
        write(&folder, name, &recording.replace(old, new))
    };
    let cases = [
        (with("a.yaml", "data.csv", "broken.csv"), 1, "broken.csv:4:7"),
        (with("b.yaml", "data.csv", "nowhere.csv"), 1, "nowhere.csv"),
        (with("c.yaml", "data.csv", "empty.csv"), 1, "empty.csv"),
        (with("d.yaml", "data.csv", "gaps.csv"), 1, "is empty"),
        (with("e.yaml", "machine: FX", "machine: nowhere.yaml"), 2, "E0622"),
        (with("f.yaml", "known.yaml", "nowhere.yaml"), 2, "E0623"),
        (with("g.yaml", "measured.x", "measured.q"), 2, "E0606"),
        (joined(&folder, "known.yaml"), 2, "E0602"),
        (joined(&folder, "nowhere.yaml"), 2, "nowhere.yaml"),
    ];
    for (file, status, words) in &cases {
        let run = abbe(&["diagnose", file, "--write-calibration", &target, "--format", "json"], "");
        assert_eq!((run.status, run.out.as_str()), (*status, ""), "{file}: {}", run.err);
        assert!(run.err.contains(words), "{file}: {}", run.err);
        assert!(!Path::new(&target).exists(), "{file}");
    }
    for arguments in [vec!["diagnose"], vec!["diagnose", "x.yaml", "--format", "yaml"]] {
        assert_eq!(abbe(&arguments, "").status, 2);
    }
    // One good recording does not make up for a bad one.
    let good = joined(&folder, "recording.yaml");
    assert_eq!(abbe(&["diagnose", &good, &cases[0].0], "").status, 1);
    assert_eq!(abbe(&["diagnose", &good, "--holdout", &cases[4].0], "").status, 2);
}

/// Without the programmed positions nothing can be told; the place is where the file lists its channels.
#[test]
fn a_recording_without_the_positions_that_it_needs_is_refused_at_its_channels() {
    let folder = folder("no-command");
    let rows: String = (0..60).map(|row| format!("{row},{}\n", f64::from(row % 7) * 0.1)).collect();
    write(&folder, "data.csv", &format!("t,d\n{rows}"));
    let recording = |machine: &str, instrument: &str, channel: &str, setup: &str| {
        format!(
            "recording: 1\nmachine: {machine}\ninstrument: {instrument}\ndata: data.csv\nchannels:\n  time: {{column: t, unit: s}}\n  {channel}\n{setup}"
        )
    };
    let deviation = "deviation: {column: d, unit: um}";
    let targets = "so the targets are unknown";
    let nothing = "so the readings can be compared with nothing";
    for (name, text, why, help) in [
        (
            "linear.yaml",
            recording("XYFZ", "linear", deviation, "setup: {axis: X}\n"),
            targets,
            "command.x: {column: ..., unit: mm}",
        ),
        (
            "ballbar.yaml",
            recording("XYFZ", "ballbar", deviation, "setup: {center: [0 mm, 0 mm, 0 mm], radius: 100 mm}\n"),
            "so the circle is unknown",
            "command.x: {column: ..., unit: mm}",
        ),
        (
            "actual.yaml",
            recording("XYFZ", "position", "actual.y: {column: d, unit: mm}", ""),
            nothing,
            "command.y: {column: ..., unit: mm}",
        ),
        (
            "angle.yaml",
            recording("FC", "position", "measured.c: {column: d, unit: arcsec}", ""),
            nothing,
            "command.c: {column: ..., unit: deg}",
        ),
    ] {
        let path = write(&folder, name, &text);
        let run = abbe(&["diagnose", &path, "--quiet"], "");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{name}: {}", run.err);
        assert!(run.err.contains("E0613") && run.err.contains(&format!("{name}:5:1")), "{name}: {}", run.err);
        assert!(run.err.contains(why) && run.err.contains(help), "{name}: {}", run.err);
    }
}

/// What the recording file says wrongly of its data is marked there.
#[test]
fn a_held_out_run_that_is_not_there_is_marked_in_the_recording_file() {
    let folder = folder("held-out");
    write(&folder, "data.csv", "t,run,x\n0,1,0\n1,1,1\n2,2,2\n");
    let text = "recording: 1\nmachine: FX\ninstrument: position\ndata: data.csv\nchannels:\n  time: {column: t, unit: s}\n  run: {column: run}\n  measured.x: {column: x, unit: mm}\nholdout: {runs: [7]}\n";
    let path = write(&folder, "r.yaml", text);
    let run = abbe(&["diagnose", &path], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""), "{}", run.err);
    assert!(run.err.contains("E0620") && run.err.contains("r.yaml:9:18"), "{}", run.err);
    assert!(
        run.err.contains("run 7 is to be held out") && run.err.contains("the runs are 1, 2"),
        "{}",
        run.err
    );
}

#[test]
fn recordings_of_two_machines_are_refused() {
    let folder = stage::recorded("two-machines");
    let other = text(&folder.join("recording.yaml")).replace("calibration: known.yaml\n", "");
    let other = write(&folder, "other.yaml", &other.replace("machine: FX", "machine: XF"));
    let run = abbe(&["diagnose", &joined(&folder, "recording.yaml"), &other], "");
    assert_eq!((run.status, run.out.as_str()), (2, ""));
    assert!(run.err.contains("E0625"), "{}", run.err);
}

/// At one length of the tool a pitch and a positioning error are the same. Recordings with two lengths tell them apart, whether each says
/// its own length or names a calibration of its own.
#[test]
fn tools_of_two_lengths_tell_an_angle_from_a_displacement() {
    let folder = folder("two-tools");
    let path = "path: 1\nline: {axis: X, from: 0 mm, to: 300 mm}\nruns: 3\nfeed: 1800 mm/min\nrate: 10 Hz\ninstrument: position\nnoise: {white: 0.3 um}\n";
    let path = write(&folder, "path.yaml", path);
    let numbers = |zt: u32, errors: &str| {
        format!("calibration: 1\nmachine: FX\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: {zt} mm}}\n{errors}")
    };
    let errors = "errors: {EXX: [{cyclic: {period: 40 mm, amplitude: 3 um, phase: 20 deg}}], EBX: [{backlash: {lost_motion: 30 urad}}]}\n";
    let record = |zt: u32| {
        let truth = write(&folder, "truth.yaml", &numbers(zt, errors));
        let output = folder.join(format!("tool-{zt}"));
        let (recording, _) = simulated(&[&truth, &path, "--seed", &zt.to_string()], &output);
        write(&output, "known.yaml", &numbers(zt, ""));
        write(&output, "recording.yaml", &format!("{recording}calibration: known.yaml\n"))
    };
    let (short, long) = (record(50), record(150));
    let found = |recordings: &[&str], more: &[&str]| {
        let run = done(abbe(&[&["diagnose", "--format", "json", "--quiet"], more, recordings].concat(), ""));
        let all = json(&run)["findings"].as_array().unwrap().clone();
        let name =
            |one: &Value| format!("{} {}", one["motion"].as_str().unwrap(), one["term"].as_str().unwrap());
        let also = |one: &Value| one["indistinguishable_from"].as_array().unwrap().len();
        all.iter().map(|one| (name(one), also(one))).collect::<Vec<_>>()
    };
    let alone = found(&[&short], &[]);
    assert_eq!(alone, [("EXX cyclic".to_owned(), 1), ("EXX backlash".to_owned(), 1)]);
    let right = [("EXX cyclic".to_owned(), 0), ("EBX backlash".to_owned(), 0)];
    assert_eq!(found(&[&short, &long], &[]), right);
    // The same with one calibration, and the length in the recording.
    let said = text(Path::new(&long))
        .replace("calibration: known.yaml", "calibration: ../tool-50/known.yaml\nconstants: {Zt: 150 mm}");
    let long = write(&folder.join("tool-150"), "said.yaml", &said);
    let improved = joined(&folder, "improved.yaml");
    assert_eq!(found(&[&short, &long], &["--write-calibration", &improved]), right);
    // What is written back is of the first calibration, and predicts the recording with the other tool.
    assert!(text(Path::new(&improved)).contains("Zt: 50 mm"));
    let (_, predicted) = simulated(&[&improved, &long], &folder.join("predicted"));
    let measured = text(&folder.join("tool-150/data.csv"));
    let off = column(&predicted, "x_meas")
        .into_iter()
        .zip(column(&measured, "x_meas"))
        .map(|(a, b)| (a - b).powi(2));
    let rms = (off.clone().sum::<f64>() / off.count() as f64).sqrt();
    assert!(rms < 0.000_35, "{rms}");
    // Other numbers are another calibration.
    let other = numbers(150, "errors: {EXX: 1 um}\n");
    write(&folder.join("tool-150"), "known.yaml", &other);
    let run = abbe(&["diagnose", &short, &joined(&folder, "tool-150/recording.yaml")], "");
    assert_eq!(run.status, 2);
    assert!(run.err.contains("E0625"), "{}", run.err);
}

/// `abbe simulate CALIBRATION RECORDING`.
mod replay {
    use super::*;

    const MACHINE: &str = "calibration: 1\nmachine: FY\nerrors: {}\n";
    const MILL: &str = "calibration: 1\nmachine: xyfz-mill\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors:\n  EXX: [{backlash: {lost_motion: 8 um}}, {expansion: {sensor: scale, coefficient: 12 um/m/K, reference: 20 degC}}]\n  EYY: [{lag: {gain: 30 1/s}}, {cyclic: {period: 10 mm, amplitude: 2 um, phase: 20 deg}}]\n  EBX: [{polynomial: {per: mm, unit: arcsec, coefficients: [0, 0.05]}}]\n  EZZ: [{compliance: {load: cutting, coefficient: 0.02 um/N}}]\n  EC0Y: 40 urad\n";
    const SURROUNDINGS: &str = "temperatures: {scale: {start: 20 degC, steps: [{at: 0 s, to: 30 degC}], time_constant: 20 s}}\nloads: {cutting: {unit: N, base: 20 N, pulses: {height: 200 N, period: 3 s, width: 1 s, start: 0 s}}}\n";

    /// A path whose readings have no noise is its own replay: the same commands, the same machine, the same instrument.
    #[test]
    fn a_recording_without_noise_is_its_own_replay() {
        let at = "path: 1\ntitle: all\nat: {X: 200 mm, Y: 140 mm, Z: -50 mm}\n";
        let circle = "circle: {plane: XY, radius: 60 mm, directions: [ccw, cw]}\n";
        let line = "line: {axis: X, from: 0 mm, to: 90 mm}\n";
        let sides = "line: {from: {X: 0 mm, Y: 0 mm}, to: {X: 90 mm, Y: 60 mm}}\n";
        for (number, (shape, instrument)) in [
            (circle, "position"),
            (circle, "{position: [x, y]}"),
            (circle, "{ballbar: {}}"),
            (line, "{linear: {axis: X}}"),
            (line, "{straightness: {axis: X, direction: Y}}"),
            (line, "{angular: {axis: X, direction: B}}"),
            (sides, "{probe: {normal: [0.6, 0, 0.8]}}"),
            (line, "position\ndrive: {axes: [X, Y]}"),
        ]
        .into_iter()
        .enumerate()
        {
            let folder = folder(&format!("own-{number}"));
            let calibration = write(&folder, "mill.yaml", MILL);
            let path = format!(
                "{at}{shape}feed: 2000 mm/min\nrate: 20 Hz\nruns: 2\nholdout: {{runs: [2]}}\ninstrument: {instrument}\n{SURROUNDINGS}"
            );
            let path = write(&folder, "path.yaml", &path);
            let (head, first) = simulated(&[&calibration, &path], &folder.join("first"));
            let recording = joined(&folder, "first/recording.yaml");
            let (head_again, again) = simulated(&[&calibration, &recording], &folder.join("again"));
            assert_eq!(head, head_again, "{instrument}");
            assert_eq!(first.lines().next(), again.lines().next(), "{instrument}");
            assert_eq!(first.lines().count(), again.lines().count(), "{instrument}");
            for (row, (first, again)) in first.lines().zip(again.lines()).enumerate().skip(1) {
                for (first, again) in first.split(',').zip(again.split(',')) {
                    let [first, again] = [first, again].map(|cell| cell.parse::<f64>().unwrap());
                    // Commands in the table are rounded to a picometre; rates of change feel it a little more.
                    assert!((first - again).abs() < 2e-8, "{instrument}, row {row}: {first} {again}");
                }
            }
        }
    }

    /// What is known leaves the concealed effect, half the lost motion to either side; the truth leaves the noise alone.
    #[test]
    fn what_a_calibration_leaves_is_the_difference() {
        let folder = stage::recorded("difference");
        let recording = joined(&folder, "recording.yaml");
        let measured = column(&text(&folder.join("data.csv")), "x_meas");
        let left = |calibration: &str| {
            let (_, data) = simulated(
                &[&joined(&folder, calibration), &recording],
                &folder.join(calibration.replace(".yaml", "")),
            );
            let left = measured.iter().zip(column(&data, "x_meas")).map(|(own, model)| (own - model).powi(2));
            (left.sum::<f64>() / measured.len() as f64).sqrt()
        };
        assert!((left("known.yaml") / 0.004 - 1.0).abs() < 0.02);
        assert!((left("full.yaml") / 0.0002 - 1.0).abs() < 0.1);
    }

    /// Known errors whose products with one another are larger than the noise: what is written leaves what is said to be left.
    #[test]
    fn large_known_errors_leave_what_is_said_to_be_left() {
        let folder = folder("large");
        let calibration = |play: &str| {
            format!(
                "calibration: 1\nmachine: FXYZ\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}}\nerrors: {{{play}EC0Y: 5 mrad, ECX: 1 mrad, EBY: -2 mrad}}\n"
            )
        };
        let known = write(&folder, "known.yaml", &calibration(""));
        let full = write(&folder, "full.yaml", &calibration("EXX: [{backlash: {lost_motion: 6 um}}], "));
        let path = "path: 1\nat: {Z: -50 mm}\nline: {from: {X: 20 mm, Y: 250 mm}, to: {X: 180 mm, Y: 10 mm}}\nfeed: 40 mm/s\nrate: 10 Hz\nruns: 4\ninstrument: position\nnoise: 0.3 um\nseed: 5\n";
        let path = write(&folder, "path.yaml", path);
        simulated(&[&full, &path, "--known", &known], &folder);
        let (recording, improved) = (joined(&folder, "recording.yaml"), joined(&folder, "improved.yaml"));
        let run = done(abbe(
            &["diagnose", &recording, "--format", "json", "--quiet", "--write-calibration", &improved],
            "",
        ));
        let diagnosis = json(&run);
        let findings = diagnosis["findings"].as_array().unwrap();
        assert!(findings.len() == 1 && findings[0]["motion"] == "EXX", "{findings:?}");
        assert_eq!(findings[0]["term"], "backlash");
        let measured = text(&folder.join("data.csv"));
        let (_, predicted) = simulated(&[&improved, &recording], &folder.join("predicted"));
        // The zero of each channel is free.
        let squares = |name: &str| {
            let rows = column(&measured, name).into_iter().zip(column(&predicted, name));
            let left: Vec<f64> = rows.map(|(measured, predicted)| measured - predicted).collect();
            let mean = left.iter().sum::<f64>() / left.len() as f64;
            left.iter().map(|left| (left - mean).powi(2)).sum::<f64>() / left.len() as f64
        };
        let left = (["x_meas", "y_meas", "z_meas"].map(squares).iter().sum::<f64>() / 3.0).sqrt();
        let after = diagnosis["after"]["rms"].as_f64().unwrap();
        assert!((left / after - 1.0).abs() < 0.02, "{left} is left, {after} is said to be");
    }

    #[test]
    fn what_cannot_be_replayed_ends_with_status_two() {
        let folder = stage::recorded("refusals");
        let recording = joined(&folder, "recording.yaml");
        let full = joined(&folder, "full.yaml");
        let other = write(&folder, "other.yaml", MACHINE);
        let warm = "calibration: 1\nmachine: FX\nerrors: {EXX: [{growth: {sensor: T1, coefficient: 1 um/K, reference: 20 degC}}]}\n";
        let warm = write(&folder, "warm.yaml", warm);
        write(&folder, "ring.csv", "t,x,y,d,n,m\n0,1,2,0,1,0\n1,2,3,0,0,1\n");
        let ring = "recording: 1\nmachine: FXY\ninstrument: probe\ndata: ring.csv\nchannels:\n  time: {column: t, unit: s}\n  command.x: {column: x, unit: mm}\n  command.y: {column: y, unit: mm}\n  deviation: {column: d, unit: mm}\n  normal.x: {column: n}\n  normal.y: {column: m}\n  normal.z: {column: n}\n";
        let ring = write(&folder, "ring.yaml", ring);
        let table = write(
            &folder,
            "table.yaml",
            "calibration: 1\nmachine: FXY\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nerrors: {}\n",
        );
        let output = joined(&folder, "out");
        for (arguments, words) in [
            (vec![full.as_str(), &recording, "--seed", "3"], "leave out --seed"),
            (vec![&other, &recording], "is a recording of FX"),
            (vec![&warm, &recording], "`T1`"),
            (vec![&table, &ring], "a different normal in each row"),
        ] {
            let run = abbe(&[&["simulate"], &arguments[..], &["--output", &output]].concat(), "");
            assert_eq!((run.status, run.out.as_str()), (2, ""), "{arguments:?}: {}", run.err);
            assert!(run.err.contains(words), "{arguments:?}: {}", run.err);
            assert!(!Path::new(&output).exists(), "{arguments:?}");
        }
        // A recording is never replaced by its own prediction.
        for force in [&[] as &[&str], &["--force"]] {
            let own = ["simulate", &full, &recording, "--output", folder.to_str().unwrap()];
            let run = abbe(&[&own, force].concat(), "");
            assert_eq!(run.status, 2);
            assert!(run.err.contains("is one of the files that this command reads"), "{}", run.err);
        }
    }
}
