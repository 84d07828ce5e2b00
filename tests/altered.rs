//! Recordings that were altered as no machine would notice. In: a recording beside the repository, where it is, with positive and negative
//! exchanged, with a part of its runs, or without its beginning. Out: the effects that it has as it stands.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::beside::shared;
use crate::cli::abbe;

/// What is found in a recording whose rows were altered; nothing where there is no such recording.
fn findings(name: &str, alter: fn(&str, Vec<&str>) -> Vec<String>) -> Option<Vec<Value>> {
    let from = shared(&format!("recordings/{name}"))?;
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("altered").join(name);
    drop(fs::remove_dir_all(&folder));
    fs::create_dir_all(&folder).unwrap();
    let table = fs::read_to_string(from.join("data.csv")).unwrap();
    let (head, rows) = table.split_once('\n').unwrap();
    let rows = alter(head, rows.lines().collect()).join("\n");
    fs::write(folder.join("data.csv"), format!("{head}\n{rows}\n")).unwrap();
    let recording = folder.join("recording.yaml");
    fs::copy(from.join("recording.yaml"), &recording).unwrap();
    let run = abbe(&["diagnose", recording.to_str().unwrap(), "--format", "json", "--quiet"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let found: Value = serde_json::from_str(&run.out).unwrap();
    Some(found["findings"].as_array().unwrap().clone())
}

/// All columns but time and run in a mirror: a machine does not know which of its directions is called positive.
fn mirrored(head: &str, rows: Vec<&str>) -> Vec<String> {
    let stays: Vec<bool> = head.split(',').map(|name| ["t", "time_s", "run"].contains(&name)).collect();
    let cell = |(column, cell): (usize, &str)| {
        if stays[column] || cell.is_empty() {
            return cell.to_owned();
        }
        cell.strip_prefix('-').map_or_else(|| format!("-{cell}"), str::to_owned)
    };
    let row = |row: &str| row.split(',').enumerate().map(cell).collect::<Vec<_>>().join(",");
    rows.into_iter().map(row).collect()
}

fn as_it_stands(_: &str, rows: Vec<&str>) -> Vec<String> {
    rows.into_iter().map(str::to_owned).collect()
}

/// The last four fifths: the recorder was switched on later.
fn begun_later(_: &str, rows: Vec<&str>) -> Vec<String> {
    rows[rows.len() / 5..].iter().map(|row| (*row).to_owned()).collect()
}

/// The first three runs in a mirror: they show a wave and its harmonics as all runs do, in a quarter of the time.
fn three_mirrored(head: &str, rows: Vec<&str>) -> Vec<String> {
    let run = head.split(',').position(|name| name == "run").unwrap();
    let first = |row: &&str| ["1", "2", "3"].contains(&row.split(',').nth(run).unwrap());
    mirrored(head, rows.into_iter().filter(first).collect())
}

fn value(finding: &Value, parameter: &str) -> f64 {
    finding["parameters"][parameter]["value"].as_f64().unwrap()
}

/// A wave of 0.25 mm and its harmonics, twice along the travel: a table would do as well, and say nothing of the next turn.
#[test]
fn the_wave_of_a_slit_is_a_wave_in_a_mirror_too() {
    let Some(findings) = findings("slit-11358-pos20", three_mirrored) else { return };
    assert!(findings.iter().all(|finding| finding["term"] != "table"), "{findings:#?}");
    let wave = findings.iter().find(|finding| finding["term"] == "cyclic").unwrap();
    assert!((value(wave, "period") - 0.25).abs() < 0.0025, "{wave:#}");
}

/// A telescope mount that goes one way: in a mirror it goes the negative way from the first row on, and has no play for that.
#[test]
fn the_worm_of_a_mount_is_a_wave_in_a_mirror_too() {
    let Some(findings) = findings("mount-avx-e", mirrored) else { return };
    let wave = findings.iter().find(|finding| finding["term"] == "cyclic").unwrap();
    let (period, unit) = (value(wave, "period"), &wave["parameters"]["period"]["unit"]);
    assert!(unit == "deg" && (period - 2.5).abs() < 0.06, "{wave:#}");
}

/// The mill mostly stands in Z, where its display of 0.1 mm shows nothing. That rest says nothing of what Z does while it moves: two position
/// loops, of 122 to 132 1/s by hand in the whole recording, and no form beside them.
#[test]
fn the_loops_of_a_mill_are_loops_without_the_beginning_too() {
    for alter in [as_it_stands, begun_later] {
        let Some(findings) = findings("smart-mill-01", alter) else { return };
        let mut names: Vec<String> =
            findings.iter().map(|finding| format!("{} {}", finding["motion"], finding["term"])).collect();
        names.sort();
        assert_eq!(names, [r#""EYY" "lag""#, r#""EZZ" "lag""#], "{findings:#?}");
        let is_near = |finding: &Value| (value(finding, "gain") / 127.0 - 1.0).abs() < 0.25;
        assert!(findings.iter().all(is_near), "{findings:#?}");
    }
}
