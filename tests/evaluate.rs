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
        "The recording does not contain the overrun at the ends",
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
        run.out.contains("positioning of X, because X was read in motion, with a row every 0.050 s"),
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

#[test]
fn rows_without_times_are_readings_in_their_order() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("evaluate").join("order");
    fs::create_dir_all(&folder).unwrap();
    // Up 0, 100, 200, over the end, and back: 1 um of play, and 2 um of scale over 200 mm.
    let rows: String = (1..=3).map(|run| format!("{run},-5,\n{run},0,0\n{run},100,1\n{run},200,2\n{run},205,\n{run},200,3\n{run},100,2\n{run},0,1\n")).collect();
    fs::write(folder.join("data.csv"), format!("run,x,dev\n{rows}")).unwrap();
    let head = "recording: 1\nmachine: FX\ninstrument: linear\ndata: data.csv\nsetup: {axis: X}\nchannels:\n  run: {column: run}\n  command.x: {column: x, unit: mm}\n  deviation: {column: dev, unit: um}\n";
    let recording = folder.join("recording.yaml");
    fs::write(&recording, head).unwrap();
    let run = abbe(&["evaluate", recording.to_str().unwrap(), "--format", "json"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let all: Value = serde_json::from_str(&run.out).unwrap();
    let line = &all["positioning"][0];
    for (symbol, value) in [("B", 1.0), ("B_mean", -1.0), ("E", 3.0), ("M", 2.0), ("R", 1.0), ("A", 3.0)] {
        near(figure(line, symbol), value, 1e-9);
    }
    assert!(line["notes"].to_string().contains("Its rows were taken in order"), "{line}");
    // Nothing else may do without times.
    let diagnosed = abbe(&["diagnose", recording.to_str().unwrap()], "");
    assert!(diagnosed.status == 2 && diagnosed.err.contains("E0601"), "{}", diagnosed.err);
}

/// A laser's file of three targets and two runs there and back: 1 um and then 2 um of reversal.
const LASER: &str = "HEADER::\nFile type  : rtl\nOwner      : Linear\n\nTARGET DATA::\nTarget-count: 3\nTargets :\n0 100 200\nFlags: 0 0 2 0\n\nUSER-TEXT::\nMachine: Mill 7\nDate:2026-05-01\n\nRUNS::\nRun-count: 4\n\nDEVIATIONS::\n1 1 0\n1 2 2\n1 3 4\n2 3 5\n2 2 3\n2 1 1\n3 1 0\n3 2 2\n3 3 4\n4 3 6\n4 2 4\n4 1 2\n\nEOF::\n";

#[test]
fn a_laser_s_file_and_its_set_up_give_the_same_figures() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("evaluate").join("laser");
    fs::create_dir_all(&folder).unwrap();
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    fs::write(at("x's.rtl"), LASER).unwrap();
    let head = "setup: 1\nmachine: XYFZ\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nmeasurements:\n";
    // X carries the part: the laser reads the tool relative to it, whatever the machine file counts.
    fs::write(at("setup.yaml"), format!("{head}  - {{motion: EXX, data: \"x's.rtl\"}}\n")).unwrap();
    for file in ["x's.rtl", "setup.yaml"] {
        let run = abbe(&["evaluate", &at(file), "--format", "json"], "");
        assert_eq!((run.status, run.err.as_str()), (0, ""), "{file}");
        let all: Value = serde_json::from_str(&run.out).unwrap();
        let line = &all["positioning"][0];
        // Down 0.5 um above and below its mean: s = 0.7071 um, R down 2.83 um; R = 2 s + 1.5 um = 2.914 um, less than that.
        for (symbol, value) in [("B", 1.5), ("B_mean", -1.5), ("E_up", 4.0), ("E", 5.5), ("R_up", 0.0)] {
            near(figure(line, symbol), value, 1e-9);
        }
        near(figure(line, "R"), 1.5 + 2.0 * 0.5_f64.sqrt(), 1e-9);
        let text = abbe(&["evaluate", &at(file)], "").out;
        assert!(text.contains("machine: Mill 7;") && text.contains("date: 2026-05-01"), "{text}");
        assert!(
            text.contains("runs: 2 upwards, 2 downwards") && text.contains("temperatures: ____"),
            "{text}"
        );
    }
    assert!(abbe(&["evaluate", &at("x's.rtl")], "").out.contains("names neither its axis"));
    fs::write(
        at("two.yaml"),
        format!("{head}  - {{motion: EXX, data: \"x's.rtl\"}}\n  - {{motion: EYY, data: \"x's.rtl\"}}\n"),
    )
    .unwrap();
    let two = abbe(&["evaluate", &at("two.yaml")], "");
    assert!(two.status == 2 && two.err.contains("has 2 measurements"), "{}", two.err);
    fs::write(at("pitch.yaml"), format!("{head}  - {{motion: EYX, data: \"x's.rtl\"}}\n")).unwrap();
    let other = abbe(&["evaluate", &at("pitch.yaml")], "");
    assert!(other.status == 2 && other.err.contains("error[E0905]"), "{}", other.err);
}

#[test]
fn figures_of_a_nanometre_stage_are_shown_in_nanometres() {
    let path = format!("{STATIONS}instrument: {{linear: {{axis: X}}}}\n");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("evaluate").join("nano");
    fs::create_dir_all(&folder).unwrap();
    let at = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    fs::write(at("path.yaml"), path).unwrap();
    fs::write(at("known.yaml"), CALIBRATION.replace("0, 0.05", "0, 0.0001").replace("6 um", "0.012 um"))
        .unwrap();
    let run = abbe(&["simulate", &at("known.yaml"), &at("path.yaml"), "--output", &at("out"), "--force"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let text = abbe(&["evaluate", &at("out/recording.yaml")], "").out;
    // 12 nm of play; 0.1 nm/mm over 400 mm.
    let line =
        |symbol: &str| text.lines().find(|line| line.trim_start().starts_with(symbol)).unwrap().to_owned();
    assert!(line("B ").contains("12.00 nm") && line("M ").contains("40.00 nm"), "{text}");
    assert!(
        text.contains("other axes at: Y 140 mm, Z -50 mm")
            && text.contains("targets: 11 from 50 mm to 450 mm"),
        "{text}"
    );
}
