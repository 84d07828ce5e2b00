//! A recording in a mirror. In: a recording beside the repository, where it is, with positive and negative exchanged. Out: the effects that
//! it has as it stands; a machine does not know which of its directions is called positive.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use crate::beside::shared;
use crate::cli::abbe;

/// The folder of a recording whose columns from the third on are negative; nothing where there is none.
fn mirrored(name: &str) -> Option<PathBuf> {
    let from = shared(&format!("recordings/{name}"))?;
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("mirrored").join(name);
    drop(fs::remove_dir_all(&folder));
    fs::create_dir_all(&folder).unwrap();
    let table = fs::read_to_string(from.join("data.csv")).unwrap();
    let rows: Vec<String> = table.lines().enumerate().map(|(number, row)| negative(number, row)).collect();
    fs::write(folder.join("data.csv"), rows.join("\n") + "\n").unwrap();
    let recording = fs::read_to_string(from.join("recording.yaml")).unwrap();
    fs::write(folder.join("recording.yaml"), recording).unwrap();
    Some(folder.join("recording.yaml"))
}

fn negative(number: usize, row: &str) -> String {
    let cell = |(column, cell): (usize, &str)| match (number, column, cell) {
        (0, ..) | (_, 0 | 1, _) | (_, _, "") => cell.to_owned(),
        _ => cell.strip_prefix('-').map_or_else(|| format!("-{cell}"), str::to_owned),
    };
    row.split(',').enumerate().map(cell).collect::<Vec<_>>().join(",")
}

/// A wave of 0.25 mm and its harmonics, twice along the travel: a table would do as well, and say nothing of the next turn.
#[test]
fn the_wave_of_a_slit_is_a_wave_in_a_mirror_too() {
    let Some(recording) = mirrored("slit-11358-pos20") else { return };
    let run = abbe(&["diagnose", recording.to_str().unwrap(), "--format", "json", "--quiet"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let found: Value = serde_json::from_str(&run.out).unwrap();
    let findings = found["findings"].as_array().unwrap();
    assert!(findings.iter().all(|finding| finding["term"] != "table"), "{findings:#?}");
    let wave = findings.iter().find(|finding| finding["term"] == "cyclic").unwrap();
    let period = wave["parameters"]["period"]["value"].as_f64().unwrap();
    assert!((period - 0.25).abs() < 0.0025, "{wave:#}");
}
