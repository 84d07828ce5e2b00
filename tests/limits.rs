//! `abbe limits` and `abbe plan` as their users meet them: a path is simulated, and the recording is asked what it could show.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::cli::{Run, abbe};

/// X there and back, across a display without steps; one run is held out.
const PATH: &str = "path: 1\ntitle: X and back\nline: {axis: X, from: 0 mm, to: 200 mm}\nfeed: 3 m/min\nrate: 20 Hz\nruns: 4\ninstrument: {position: [x]}\nnoise: {white: 0.3 um}\nholdout: {runs: [4]}\nseed: 5\n";

const CALIBRATION: &str =
    "calibration: 1\nmachine: FXYZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors: {}\n";

struct Files {
    folder: PathBuf,
}

impl Files {
    fn new(test: &str, path: &str) -> Self {
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("limits").join(test);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("known.yaml"), CALIBRATION).unwrap();
        fs::write(folder.join("path.yaml"), path).unwrap();
        Self { folder }
    }

    fn name(&self, file: &str) -> String {
        self.folder.join(file).to_str().unwrap().to_owned()
    }

    /// The recording that the calibration with these errors shows.
    fn recorded(&self, errors: &str) -> String {
        let own = self.name("true.yaml");
        fs::write(&own, CALIBRATION.replace("{}\n", &format!("{errors}\n"))).unwrap();
        let (path, known, output) = (self.name("path.yaml"), self.name("known.yaml"), self.name(""));
        let run = abbe(&["simulate", &own, &path, "--output", &output, "--known", &known, "--force"], "");
        assert_eq!(run.status, 0, "{}", run.err);
        self.name("recording.yaml")
    }
}

fn json(run: &Run) -> Value {
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    serde_json::from_str(&run.out).unwrap()
}

fn limit<'v>(all: &'v Value, motion: &str, kind: &str) -> &'v Value {
    let limits = all["limits"].as_array().unwrap();
    limits.iter().find(|one| one["motion"] == motion && one["kind"] == kind).unwrap()
}

/// The size of the limit is what the simulation says too: a machine with half as much again is diagnosed, one with half of it is not.
#[test]
fn what_lies_above_the_limit_of_a_play_is_diagnosed_and_what_lies_below_is_not() {
    let files = Files::new("play", PATH);
    let quiet = files.recorded("{}");
    let run = abbe(&["limits", &quiet, "--only", "EXX,backlash", "--format", "json", "--quiet"], "");
    let all = json(&run);
    assert_eq!(all["schema"], "abbe-limits/1");
    let play = limit(&all, "EXX", "backlash");
    assert_eq!((&play["unit"], &play["size_of"]), (&Value::from("um"), &Value::from("lost motion")));
    let size = play["size"].as_f64().unwrap();
    // The standard error of a play in white noise is twice the noise over the root of the fitted readings: 0.027 um of 480.
    assert!(size > 0.08 && size < 0.33, "{size}");
    let half = play["half_interval"].as_f64().unwrap();
    assert!(half > 0.02 && half < 0.15, "{half}");
    let found = |times: f64| {
        let recording =
            files.recorded(&format!("{{EXX: [{{backlash: {{lost_motion: {} um}}}}]}}", times * size));
        let found = json(&abbe(&["diagnose", &recording, "--format", "json", "--quiet"], ""));
        let findings = found["findings"].as_array().unwrap();
        findings.iter().any(|one| one["term"] == "backlash" && one["motion"] == "EXX")
    };
    assert!(found(1.5) && !found(0.5));
}

#[test]
fn the_same_seed_gives_the_same_limits_and_the_page_needs_nothing_else() {
    let files = Files::new("page", PATH);
    let quiet = files.recorded("{}");
    let ask = |format: &str| {
        let arguments =
            ["limits", &quiet, "--only", "EXX,backlash", "--trials", "6", "--format", format, "--quiet"];
        abbe(&arguments, "").out
    };
    assert_eq!(ask("json"), ask("json"));
    let page = ask("html");
    assert!(page.starts_with("<!DOCTYPE html>") && page.contains("<svg") && page.contains("EXX backlash"));
    assert!(!page.contains("<script") && !page.contains("src=") && !page.contains("http-equiv"));
    assert!(page.contains("abbe limits ") && page.contains("--only EXX,backlash --trials 6 --seed 1"));
}

#[test]
fn where_all_that_is_asked_for_is_there_already_nothing_was_tested() {
    let files = Files::new("already", PATH);
    let played = files.recorded("{EXX: [{backlash: {lost_motion: 8 um}}]}");
    let ask = |format: &str| {
        abbe(&["limits", &played, "--only", "EXX,backlash", "--format", format, "--quiet"], "").out
    };
    for told in [ask("text"), ask("html")] {
        let text = told.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            text.contains("No effect was tested: each one that was asked for is in the recording already."),
            "{text}"
        );
        assert!(text.contains("as it is: left-out physics") && !text.contains("left-out-physics"), "{text}");
    }
}

#[test]
fn a_plan_tells_limits_and_what_to_drive_besides() {
    let files = Files::new("plan", PATH);
    let path = files.name("path.yaml");
    let ask = ["plan", &path, "--machine", "FXYZ", "--only", "EXX,backlash", "--trials", "8", "--quiet"];
    let run = abbe(&[&ask[..], &["--format", "json"]].concat(), "");
    let all = json(&run);
    let play = limit(&all, "EXX", "backlash");
    let size = play["size"].as_f64().unwrap();
    assert!(size > 0.08 && size < 0.4, "{size}");
    // One feed: a play and a loop that stays behind by v/K are one thing. Another feed tells them apart.
    let others = play["or_else"].as_array().unwrap();
    assert!(others.iter().any(|other| other["name"] == "EXX lag"), "{others:?}");
    let passes = all["passes"]["passes"].as_array().unwrap();
    let tells = |pass: &&Value| {
        pass["tells_apart"].as_array().unwrap().iter().any(|pair| pair["or_else"] == "EXX lag")
    };
    let telling = passes.iter().find(tells).unwrap();
    assert!(telling["drive"].as_str().unwrap().contains("as fast"), "{telling}");
    let text = abbe(&ask, "");
    assert!(text.out.contains("Extra passes") && text.out.contains("EXX backlash"), "{}", text.out);
}

#[test]
fn what_cannot_be_asked_is_said() {
    let files = Files::new("wrong", &PATH.replace("noise: {white: 0.3 um}\n", ""));
    let path = files.name("path.yaml");
    let misspelt = abbe(&["plan", &path, "--machine", "FXYZ", "--only", "backlas"], "");
    assert_eq!(misspelt.status, 2);
    assert!(misspelt.err.contains("did you mean `backlash`?"), "{}", misspelt.err);
    let silent = abbe(&["plan", &path, "--machine", "FXYZ"], "");
    assert_eq!(silent.status, 1);
    assert!(silent.err.contains("noise"), "{}", silent.err);
    let nameless = abbe(&["plan", &path], "");
    assert_eq!(nameless.status, 2);
    let still = Files::new("still", &PATH.replace("line: {axis: X, from: 0 mm, to: 200 mm}", "still: 20 s"));
    let recording = still.recorded("{}");
    let nothing = abbe(&["limits", &recording, "--only", "backlash", "--quiet"], "");
    assert_eq!((nothing.status, nothing.out.as_str()), (1, ""));
    assert!(nothing.err.contains("no effect can be injected"), "{}", nothing.err);
}
