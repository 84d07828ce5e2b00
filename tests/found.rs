//! Small recordings that are easily misread: displays, single readings that are wrong, walks, axes that go round, gaps, rounded
//! commands, lengths alone, equal loops, set-ups that cannot be. In: the folders beside the repository, where they are. Out: one test for each kind.
//!
//! What is right stands in the list of those files, as whoever made them put it in. None of it is read off a diagnosis.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::beside::shared;
use crate::cli::abbe;

/// The diagnosis of a recording of the folder, where it is.
fn diagnosis(file: &str) -> Option<Value> {
    together(&[file])
}

/// The diagnosis of several recordings of the folder together.
fn together(files: &[&str]) -> Option<Value> {
    let mut paths = Vec::new();
    for file in files {
        paths.push(shared(&format!("found/{file}"))?.display().to_string());
    }
    Some(diagnosed(&paths))
}

fn diagnosed(paths: &[String]) -> Value {
    let mut arguments = vec!["diagnose", "--format", "json", "--quiet"];
    arguments.extend(paths.iter().map(String::as_str));
    let run = abbe(&arguments, "");
    assert_eq!(run.status, 0, "{paths:?}: {}", run.err);
    serde_json::from_str(&run.out).unwrap()
}

/// The diagnosis of what the simulation makes of a calibration and a path of the folder, with a calibration that is known.
fn simulated(truth: &str, path: &str, known: Option<&str>) -> Option<Value> {
    let [truth_file, path] = [truth, path].map(|file| shared(&format!("found/{file}")));
    let (truth_file, path) = (truth_file?, path?);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("found").join(truth.trim_end_matches(".yaml"));
    drop(fs::remove_dir_all(&folder));
    let [truth_file, path, output] = [&truth_file, &path, &folder].map(|file| file.display().to_string());
    let run = abbe(&["simulate", &truth_file, &path, "--output", &output], "");
    assert_eq!(run.status, 0, "{}", run.err);
    let recording = folder.join("recording.yaml");
    if let Some(known) = known {
        fs::copy(shared(&format!("found/{known}"))?, folder.join("known.yaml")).unwrap();
        let text = fs::read_to_string(&recording).unwrap();
        fs::write(&recording, format!("{text}calibration: known.yaml\n")).unwrap();
    }
    Some(diagnosed(&[recording.display().to_string()]))
}

fn names(found: &Value) -> Vec<String> {
    let findings = found["findings"].as_array().unwrap().iter();
    findings
        .map(|one| format!("{} {}", one["motion"].as_str().unwrap(), one["term"].as_str().unwrap()))
        .collect()
}

/// A number of the first finding of a term.
fn number(found: &Value, term: &str, name: &str) -> f64 {
    let finding = found["findings"].as_array().unwrap().iter().find(|one| one["term"] == term);
    let finding = finding.unwrap_or_else(|| panic!("no {term} in {:?}", names(found)));
    finding["parameters"][name]["value"].as_f64().unwrap()
}

fn outliers(found: &Value) -> u64 {
    found["recordings"][0]["outliers"].as_u64().unwrap()
}

#[test]
fn a_display_is_no_coarser_than_the_differences_that_occur() {
    // The same stations, and those 0.3 mm further on: 0.6 um of play.
    for file in ["display/round-a.yaml", "display/round-b.yaml"] {
        let Some(found) = diagnosis(file) else { return };
        assert_eq!(names(&found), ["EXX backlash"], "{file}");
        assert!((number(&found, "backlash", "lost_motion") - 0.000_6).abs() < 0.000_05, "{file}");
    }
    // The same with one reading of 1 mm.
    for (file, wrong) in [("display/sentinel-0.yaml", 0), ("display/sentinel-1.yaml", 1)] {
        let Some(found) = diagnosis(file) else { return };
        assert!((number(&found, "backlash", "lost_motion") - 0.000_302).abs() < 0.000_02, "{file}");
        assert_eq!(outliers(&found), wrong, "{file}");
    }
}

#[test]
fn one_reading_that_is_wrong_hides_no_play() {
    let Some(found) = diagnosis("outliers/spike-1.yaml") else { return };
    assert_eq!(names(&found), ["EXX backlash"]);
    assert!((number(&found, "backlash", "lost_motion") - 0.004_95).abs() < 0.000_05);
    assert_eq!(outliers(&found), 1);
}

#[test]
fn a_walk_is_nothing_of_the_machine_and_has_no_outliers() {
    for file in ["walks/walk-1.yaml", "walks/walk-2.yaml"] {
        let Some(found) = diagnosis(file) else { return };
        assert_eq!(names(&found), [""; 0], "{file}");
        assert_eq!(outliers(&found), 0, "{file}");
        assert!(["adequate", "undecided"].contains(&found["verdict"].as_str().unwrap()), "{file}");
    }
}

#[test]
fn what_comes_back_once_a_turn_is_a_wave_of_a_turn() {
    // 2 arcsec and 1 arcsec of play, at whole degrees and 0.123 degrees further on.
    let arcsec = 1.0 / 3600.0;
    for file in ["rotary/rotary-once-a-turn.yaml", "rotary/rotary-whole-degrees.yaml"] {
        let Some(found) = diagnosis(file) else { return };
        assert_eq!(names(&found), ["ECC cyclic", "ECC backlash"], "{file}");
        assert!((number(&found, "cyclic", "period") - 360.0).abs() < 1e-9, "{file}");
        assert!((number(&found, "cyclic", "amplitude") - 2.0 * arcsec).abs() < 0.1 * arcsec, "{file}");
        assert!((number(&found, "backlash", "lost_motion") - arcsec).abs() < 0.1 * arcsec, "{file}");
    }
}

#[test]
fn every_run_begins_at_rest_and_its_clock_may_begin_again() {
    let Some(found) = diagnosis("gaps/sweep.yaml") else { return };
    assert_eq!(names(&found), ["EXX lag"]);
    assert!((number(&found, "lag", "gain") - 25.3).abs() < 0.1);
}

#[test]
fn a_wave_is_found_under_a_sensor_that_wanders() {
    let Some(found) = diagnosis("waves/wave-in-wander/recording.yaml") else { return };
    assert_eq!(names(&found), ["ECC cyclic"]);
    assert!((number(&found, "cyclic", "period") - 0.5106).abs() < 0.001);
    assert!((number(&found, "cyclic", "amplitude") * 3600.0 - 3.9).abs() < 0.3);
}

#[test]
fn a_set_up_that_cannot_be_is_told_in_the_verdict() {
    for file in ["setup/r2.yaml", "setup/r4.yaml"] {
        let Some(found) = diagnosis(file) else { return };
        assert_eq!(found["verdict"], "undecided", "{file}");
        assert_eq!(names(&found), [""; 0], "{file}");
    }
}

#[test]
fn a_place_that_comes_back_is_no_outlier() {
    let Some(found) = diagnosis("outliers/bump-a.yaml") else { return };
    assert_eq!(names(&found), ["EXX table"]);
    let values = found["findings"][0]["parameters"]["values"].as_array().unwrap().iter();
    let highest = values.map(|one| one["value"].as_f64().unwrap()).fold(f64::NEG_INFINITY, f64::max);
    assert!((highest - 0.01).abs() < 0.000_5, "{highest}");
    assert_eq!(outliers(&found), 0);
}

#[test]
fn the_rounding_of_a_command_is_noise_of_the_command() {
    // A lag of 10 ms at one speed, which play may be too.
    let Some(found) = diagnosis("rounded-command/command-rounded-r01.yaml") else { return };
    assert_eq!(names(&found), ["EXX lag"]);
    assert!((number(&found, "lag", "gain") - 100.0).abs() < 6.0);
}

#[test]
fn a_wave_is_found_where_the_slides_stand_at_whole_millimetres() {
    let Some(found) = simulated("rounding/true-rounding.yaml", "rounding/path-rounding.yaml", None) else {
        return;
    };
    assert_eq!(names(&found), ["EXX cyclic"]);
    assert!((number(&found, "cyclic", "amplitude") - 0.005).abs() < 0.000_05);
}

#[test]
fn a_large_squareness_that_is_known_is_no_physics_left_out() {
    let known = "second-order/known-5mrad.yaml";
    let Some(found) = simulated(known, "second-order/path-5mrad.yaml", Some(known)) else { return };
    assert_eq!(found["verdict"], "adequate");
    assert_eq!(names(&found), [""; 0]);
}

#[test]
fn lengths_show_the_scale_and_the_squareness_of_a_printer() {
    let Some(found) = together(&["lengths/ac.yaml", "lengths/bd.yaml", "lengths/ad.yaml"]) else { return };
    assert_eq!(names(&found), ["EYY polynomial", "EC0Y constant"]);
    assert!((number(&found, "constant", "value") - 3547e-6).abs() < 120e-6);
    let slope = found["findings"][0]["parameters"]["coefficients"][1]["value"].as_f64().unwrap();
    assert!((slope + 3834e-6).abs() < 120e-6, "{slope}");
}

#[test]
fn equal_loops_are_no_list_of_waves_and_spikes() {
    let Some(found) = diagnosis("loops/c0.yaml") else { return };
    for axis in ["EXX lag", "EYY lag"] {
        assert!(names(&found).contains(&axis.to_owned()), "{:?}", names(&found));
    }
    let [low, high] =
        [0, 1].map(|end| found["findings"][0]["parameters"]["gain"]["ci95"][end].as_f64().unwrap());
    assert!(low < 33.3 && 33.3 < high, "{low} {high}");
}
