//! Small recordings that are easily misread: displays, single readings that are wrong, walks, axes that go round, gaps, set-ups
//! that cannot be. In: the folders beside the repository, where they are. Out: one test for each kind.
//!
//! What is right stands in the list of those files, as whoever made them put it in. None of it is read off a diagnosis.

use serde_json::Value;

use crate::beside::shared;
use crate::cli::abbe;

/// The diagnosis of a recording of the folder, where it is.
fn diagnosis(file: &str) -> Option<Value> {
    let path = shared(&format!("found/{file}"))?;
    let run = abbe(&["diagnose", "--format", "json", "--quiet", &path.display().to_string()], "");
    assert_eq!(run.status, 0, "{file}: {}", run.err);
    Some(serde_json::from_str(&run.out).unwrap())
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
