//! `abbe fleet` as its users meet it: what it says and its status, where recordings are wrong, cannot be read, or are not there yet.

#![cfg(unix)]

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

use crate::beside::skipped;
use crate::cli::abbe;
use crate::shipped::root;

/// A stage with three recordings: one is whole, one is wrong, and the data of one cannot be opened, as on a disk that does not answer.
fn stage(test: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fleet").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("stage")).unwrap();
    let lines = |row: i32| {
        let x = f64::from(if row < 200 { row } else { 400 - row });
        let off = if row < 200 { 0.002 } else { -0.002 };
        format!("{:.2},{x:.4},{:.6}\n", 0.1 * f64::from(row), x - off + 1e-4 * f64::from(row * 7919 % 13))
    };
    let table = "t,xc,xm\n".to_owned() + &(0..400).map(lines).collect::<String>();
    for (name, data) in
        [("2026-01-05", "2026-01-05.csv"), ("2026-01-12", "nothing.csv"), ("2026-01-19", "loop.csv")]
    {
        let text = format!(
            "recording: 1\nmachine: FX\ndate: {name}\ninstrument: position\ndata: {{file: {data}}}\nchannels: {{time: {{column: t, \
             unit: s}}, command.x: {{column: xc, unit: mm}}, measured.x: {{column: xm, unit: mm}}}}\n"
        );
        fs::write(folder.join(format!("stage/{name}.yaml")), text).unwrap();
    }
    fs::write(folder.join("stage/2026-01-05.csv"), table).unwrap();
    std::os::unix::fs::symlink("loop.csv", folder.join("stage/loop.csv")).unwrap();
    let file = folder.join("fleet.yaml");
    fs::write(&file, "fleet: 1\nmachines: {stage: {recordings: \"stage/*.yaml\"}}\n").unwrap();
    file.to_str().unwrap().to_owned()
}

#[test]
fn what_is_missing_is_said_by_words_and_status() {
    let fleet = stage("missing");
    let listed = abbe(&["fleet", "run", &fleet, "--list"], "");
    assert_eq!((listed.status, listed.out.lines().count()), (1, 2), "{}", listed.err);
    assert!(listed.err.contains("stage/2026-01-19.yaml is postponed to the next run"), "{}", listed.err);
    assert!(listed.err.contains("1 cannot be read now"), "{}", listed.err);
    let run = abbe(&["fleet", "run", &fleet], "");
    let last = "3 recordings: 1 diagnosed, 1 with errors, 2 followed again; 1 postponed to the next run";
    assert!(run.status == 0 && run.err.contains(last), "{}", run.err);
    let shown = abbe(&["fleet", "show", &fleet, "--until", "2026-02-01"], "");
    assert!(run.err.contains("stage/2026-01-12.yaml cannot be diagnosed:\n  error: "), "{}", run.err);
    assert!(run.err.contains("stage/nothing.csv"), "{}", run.err);
    assert!(
        shown.out.contains("stage: cannot be diagnosed (") && shown.out.contains("1 machine until"),
        "{}",
        shown.out
    );
    assert!(shown.out.contains("2 recordings, 1 with errors"), "{}", shown.out);
    assert!(shown.out.contains("cannot be diagnosed: stage/2026-01-12.yaml: error: "), "{}", shown.out);
    assert!(shown.err.contains("stage/2026-01-19.yaml is shown as its last result has it"), "{}", shown.err);
    let json = abbe(&["fleet", "show", &fleet, "--format", "json"], "").out;
    assert_eq!(serde_json::from_str::<Value>(&json).unwrap()["schema"], "abbe-fleet/1");
    assert!(abbe(&["fleet", "show", "--help"], "").out.contains("abbe-fleet/1"));
}

#[test]
fn a_day_before_the_first_recording_has_words_of_its_own() {
    let fleet = stage("until");
    let early = || abbe(&["fleet", "show", &fleet, "--until", "2025-12-31"], "");
    assert!(early().err.contains("contains no result"), "{}", early().err);
    abbe(&["fleet", "run", &fleet, "--quiet"], "");
    let words = "no recording with a result was made until 2025-12-31T23:59:59; the first is of 2026-01-05";
    assert!(early().status == 1 && early().err.contains(words), "{}", early().err);
}

#[test]
fn an_engine_does_the_jobs_and_fails_where_recordings_are_missing() {
    let Ok(version) = Command::new("python3").arg("--version").output() else {
        skipped("there is no Python");
        return;
    };
    assert!(version.status.success());
    let fleet = stage("engine");
    let program = "import sys, jobs\nfor names in jobs.rounds(sys.argv[1]):\n    [print(jobs.do(sys.argv[1], name)) for name in names]\n";
    let run = || {
        let mut python = Command::new("python3");
        python.args(["-c", program, &fleet]).current_dir(root().join("examples/fleet"));
        python.env("ABBE", env!("CARGO_BIN_EXE_abbe")).env("PYTHONDONTWRITEBYTECODE", "1").output().unwrap()
    };
    let first = run();
    let (out, err) = (String::from_utf8_lossy(&first.stdout), String::from_utf8_lossy(&first.stderr));
    assert_eq!(out.lines().count(), 3, "two are diagnosed and followed: {out}{err}");
    assert!(!first.status.success() && err.contains("stage/2026-01-19.yaml is postponed"), "{err}");
    let folder = PathBuf::from(&fleet).parent().unwrap().join("stage");
    fs::remove_file(folder.join("loop.csv")).unwrap();
    fs::copy(folder.join("2026-01-05.csv"), folder.join("loop.csv")).unwrap();
    let then = run();
    assert!(then.status.success(), "{}", String::from_utf8_lossy(&then.stderr));
}
