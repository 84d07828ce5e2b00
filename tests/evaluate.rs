//! `abbe evaluate` as its users meet it: a path is driven by `abbe simulate`, and its recording is evaluated.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::beside::shared;
use crate::cli::{Run, abbe};

const CALIBRATION: &str = "calibration: 1\nmachine: xyfz-mill\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nerrors:\n  EXX: [{polynomial: {per: mm, unit: um, coefficients: [0, 0.05]}}, {backlash: {lost_motion: 6 um}}]\n  EC0Y: 40 urad\n";

const STATIONS: &str = "path: 1\ntitle: stations of X\nat: {Y: 140 mm, Z: -50 mm}\nline: {axis: X, from: 50 mm, to: 450 mm, overrun: 2 mm, stations: {count: 11, dwell: 4 s}}\nfeed: 2 m/min\nruns: 5\nseed: 1\n";

const CIRCLE: &str = "path: 1\nat: {X: 275 mm, Y: 140 mm, Z: -50 mm}\ncircle: {plane: XY, radius: 100 mm, overshoot: 30 deg}\nfeed: 1000 mm/min\nrate: 50 Hz\ninstrument: ballbar\n";

/// Simulates a path and evaluates what it gives.
fn evaluated(test: &str, path: &str, format: &str) -> Run {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("evaluate").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let file = |name: &str, text: &str| {
        let file = folder.join(name);
        fs::write(&file, text).unwrap();
        file.to_str().unwrap().to_owned()
    };
    let (calibration, path) = (file("known.yaml", CALIBRATION), file("path.yaml", path));
    let output = folder.to_str().unwrap().to_owned();
    let run = abbe(&["simulate", &calibration, &path, "--output", &output, "--known", &calibration], "");
    assert_eq!(run.status, 0, "{}", run.err);
    abbe(&["evaluate", folder.join("recording.yaml").to_str().unwrap(), "--format", format], "")
}

/// The value of a figure in um.
fn figure(list: &Value, symbol: &str) -> f64 {
    let figures = list["figures"].as_array().unwrap();
    let figure = figures.iter().find(|figure| figure["figure"] == symbol).unwrap();
    assert_eq!(figure["unit"], "mm");
    1e3 * figure["value"].as_f64().unwrap_or_else(|| panic!("{figure}"))
}

#[track_caller]
fn near(own: f64, other: f64, bound: f64) {
    assert!((own - other).abs() <= bound, "{own} is not {other} within {bound}");
}

#[test]
fn stations_give_the_figures_of_scale_and_play() {
    for instrument in ["position", "{linear: {axis: X}}"] {
        let path = format!("{STATIONS}instrument: {instrument}\n");
        let run = evaluated(if instrument == "position" { "tip" } else { "beam" }, &path, "json");
        assert_eq!((run.status, run.err.as_str()), (0, ""));
        let all: Value = serde_json::from_str(&run.out).unwrap();
        assert_eq!(all["schema"], "abbe-evaluation/1");
        assert_eq!(all["not_given"].as_array().unwrap().len(), 0, "{}", run.out);
        let line = &all["positioning"][0];
        assert_eq!((&line["axes"][0], &line["kind"]), (&Value::from("X"), &Value::from("linear")));
        // 0.05 um/mm over 400 mm, and 6 um of play; the table has nine decimals of a millimetre.
        for (symbol, closed) in
            [("B", 6.0), ("B_mean", -6.0), ("R", 6.0), ("E", 26.0), ("M", 20.0), ("A", 26.0)]
        {
            near(figure(line, symbol), closed, 1e-4);
        }
        let counted = line["targets"].as_array().unwrap();
        assert_eq!(counted.iter().filter(|target| !target["reversal"].is_null()).count(), 11);
    }
}

#[test]
fn a_ballbar_gives_circular_deviations() {
    let run = evaluated("bar", CIRCLE, "json");
    assert_eq!(run.status, 0, "{}", run.err);
    let all: Value = serde_json::from_str(&run.out).unwrap();
    let circle = &all["circles"][0];
    let senses: Vec<&str> =
        circle["traces"].as_array().unwrap().iter().map(|trace| trace["sense"].as_str().unwrap()).collect();
    assert_eq!((circle["plane"].as_str(), senses), (Some("XY"), vec!["CCW", "CW"]));
    // The scale makes 5 um at the ends of X and nothing at those of Y: on the average 2.5 um.
    near(figure(circle, "D"), 2.5, 0.05);
    // No zone is narrower than the play or the ovals of scale and squareness, nor wider than all of them.
    for symbol in ["G_CCW", "G_CW", "G_b"] {
        assert!((6.0..6.0 + 5.0 + 4.0).contains(&figure(circle, symbol)), "{symbol}");
    }
    assert!(figure(circle, "G_b") <= figure(circle, "G_b_LS"));
    assert!(figure(circle, "G_b") >= figure(circle, "G_CCW").max(figure(circle, "G_CW")) - 1e-6);
}

#[test]
fn text_says_the_same_in_a_terminal_s_width() {
    let run = evaluated("text", &format!("{STATIONS}instrument: position\n"), "text");
    assert_eq!(run.status, 0);
    for part in [
        "Positioning of the slide X, at Y 140 mm, Z -50 mm",
        "26.00 um",
        "11 targets, 5 runs",
        "The overrun at the ends is not in the recording",
    ] {
        assert!(run.out.contains(part), "{part} in {}", run.out);
    }
    assert!(run.out.lines().skip(1).all(|line| line.chars().count() <= 100), "{}", run.out);
}

#[test]
fn what_gives_no_figure_ends_with_status_one_and_the_reason() {
    let path = "path: 1\nat: {Y: 140 mm}\nline: {axis: X, from: 0 mm, to: 50 mm}\nfeed: 10 mm/s\nrate: 20 Hz\ninstrument: position\n";
    let run = evaluated("motion", path, "text");
    assert_eq!((run.status, run.err.as_str()), (1, ""));
    assert!(
        run.out.contains("positioning of X, because X was read in motion, a row every 0.050 s"),
        "{}",
        run.out
    );
    let run = evaluated("motion-json", path, "json");
    let all: Value = serde_json::from_str(&run.out).unwrap();
    assert_eq!((run.status, &all["not_given"][0]["what"]), (1, &Value::from("positioning of X")));
    let missing = abbe(&["evaluate", "no-such-recording.yaml"], "");
    assert_eq!((missing.status, missing.out.as_str()), (2, ""));
    assert!(missing.err.contains("no-such-recording.yaml"), "{}", missing.err);
}

/// A cycle of ISO 230-2 on a real stage, whose owner has its figures: mean reversal 25.37 um, B 33.58 um, R up and down up to
/// 28.31 um, after a ratio of -1.00357 that he fitted and that is not in the recording. Which samples of a dwell count is his.
#[test]
fn a_real_cycle_agrees_with_its_owner_s_report() {
    let Some(recording) = shared("recordings/target-drive-x/recording.yaml") else { return };
    let run = abbe(&["evaluate", recording.to_str().unwrap(), "--format", "json"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let all: Value = serde_json::from_str(&run.out).unwrap();
    let line = &all["positioning"][0];
    near(figure(line, "B_mean"), -25.37, 0.5);
    near(figure(line, "B"), 33.58, 0.7);
    near(figure(line, "R_up").max(figure(line, "R_down")), 28.31, 0.7);
    assert_eq!(line["left_out"], serde_json::json!([-20.5, 20.5]));
}
