//! Drilled plates on a coordinate measuring machine, each clamped there with a rotation of its own. In: the recordings beside the
//! repository, where they are, as they stand and with a free datum. Out: the squareness of the mill that drilled them, and how each lay.
//!
//! The bounds are those of the plates' page: documented rotations, and least squares by hand with a free shift and rotation for each
//! plate.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::beside::shared;
use crate::cli::abbe;

/// The plates, and how each lay, degrees.
const PLATES: [(&str, f64); 4] =
    [("D8131_1", 0.029), ("D8132_1", -0.019), ("D8133_1", -0.023), ("D8300_1", -0.027)];

/// The squareness of all four together, rad, and how far it may be off: twice its uncertainty.
const SQUARENESS: (f64, f64) = (24e-6, 10e-6);

/// What is left of the holes, mm: "5 um".
const LEFT: f64 = 0.006;

/// The plates as files in a folder of the test's own, whose recordings end with this; nothing where there are none.
fn plates(test: &str, end: &str) -> Option<(String, Vec<String>)> {
    let from = shared("recordings/plates")?;
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("plates").join(test);
    let _ = fs::remove_dir_all(&folder);
    let path = |path: &Path| path.to_str().unwrap().to_owned();
    let recordings = PLATES.map(|(name, _)| {
        let to = folder.join(name);
        fs::create_dir_all(&to).unwrap();
        // A copy of a file that is read only cannot be written to.
        fs::write(to.join("data.csv"), fs::read(from.join(name).join("data.csv")).unwrap()).unwrap();
        let text = fs::read_to_string(from.join(name).join("recording.yaml")).unwrap();
        fs::write(to.join("recording.yaml"), text + end).unwrap();
        path(&to.join("recording.yaml"))
    });
    Some((path(&from.join("mill.yaml")), recordings.into()))
}

fn json(command: &[&str], files: &[String]) -> Value {
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let run = abbe(&[command, &files, &["--format", "json", "--quiet"]].concat(), "");
    assert_eq!(run.status, 0, "{}{}", run.out, run.err);
    serde_json::from_str(&run.out).unwrap()
}

const FREE: &str = "setup: {datum: free}\n";

#[test]
fn an_update_with_free_datums_finds_the_squareness_of_the_mill() {
    let Some((mill, plates)) = plates("update", FREE) else { return };
    let updated = json(&["update", &mill], &plates);
    let changes = updated["changes"].as_array().unwrap();
    let squareness = changes.iter().find(|change| change["coefficient"] == "EC0Y.constant").unwrap();
    let value = squareness["after"].as_f64().unwrap();
    assert!((value - SQUARENESS.0).abs() < SQUARENESS.1, "{squareness}");
    let all = updated["residuals"].as_array().unwrap().last().unwrap();
    assert!(all["after"]["rms"].as_f64().unwrap() < LEFT, "{all}");
    let rotations = updated["datum"]["rotations"].as_array().unwrap();
    assert_eq!(rotations.len(), PLATES.len());
    for (rotation, (name, documented)) in rotations.iter().zip(PLATES) {
        assert_eq!(rotation["about"], "Z");
        let angle = rotation["angle"]["value"].as_f64().unwrap().to_degrees();
        // The documented fit had no squareness, which turns a plate by half of itself, 0.0007 deg; it is rounded to 0.001 deg.
        assert!((angle - documented).abs() < 0.0015, "{name}: {angle} deg");
    }
    assert_eq!(updated["hints"].as_array().unwrap().len(), 0);
    // The command line says the same of recordings that do not.
    let Some((mill, silent)) = self::plates("turned", "") else { return };
    assert_eq!(json(&["update", &mill, "--datum", "turned"], &silent)["changes"], updated["changes"]);
}

#[test]
fn a_diagnosis_with_free_datums_leaves_what_least_squares_leave() {
    let Some((_, plates)) = plates("diagnose", FREE) else { return };
    let found = json(&["diagnose"], &plates);
    assert!(found["after"]["rms"].as_f64().unwrap() < LEFT, "{}", found["after"]);
    let settings = found["instrument"].as_array().unwrap();
    assert_eq!(settings.len(), PLATES.len(), "{settings:#?}");
    for (setting, (name, documented)) in settings.iter().zip(PLATES) {
        assert_eq!(setting["term"], "datum");
        assert!(setting["recording"].as_str().unwrap().contains(name));
        let angle = setting["parameters"]["c"]["value"].as_f64().unwrap().to_degrees();
        // What else is found of the mill may turn a plate too: by what is left of its holes, 5 um, some 100 mm from its middle.
        assert!((angle - documented).abs() < 0.003, "{name}: {angle} deg");
    }
    // The plates have more in common than a squareness, and what is claimed of one may not contradict the squares.
    for finding in found["findings"].as_array().unwrap().iter().filter(|one| one["motion"] == "EC0Y") {
        let value = finding["parameters"]["value"]["value"].as_f64().unwrap();
        assert!((value - SQUARENESS.0).abs() < SQUARENESS.1, "{finding:#}");
    }
}

#[test]
fn plates_that_do_not_say_how_they_lay_are_told() {
    let Some((mill, plates)) = plates("silent", "") else { return };
    let updated = json(&["update", &mill], &plates);
    let found = json(&["diagnose"], &plates);
    let sentences = |list: &Value| -> Vec<String> {
        let all = list.as_array().unwrap().iter().map(|line| line.as_str().unwrap().to_owned());
        all.filter(|line| line.contains("`setup: {datum: free}`")).collect()
    };
    for told in [sentences(&updated["hints"]), sentences(&found["undecided"])] {
        let [sentence] = told.as_slice() else { panic!("{told:?}") };
        assert!(PLATES.iter().all(|(name, _)| sentence.contains(name)), "{sentence}");
    }
}
