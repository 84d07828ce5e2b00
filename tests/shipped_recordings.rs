//! The recordings of real machines that are shipped: their licences, what is known of the machines, and that no diagnosis
//! contradicts it. In: `recordings/`. Out: what is missing or untrue.
//!
//! What is known is taken from the data a second time, by plain least squares, so that it is the data that are shipped and not
//! others.

use std::f64::consts::TAU;
use std::fs;

use nalgebra::{DMatrix, DVector};
use serde_json::Value;

use crate::cli::abbe;
use crate::shipped::root;

/// The folders whose data belong to others, each with what its licence is called.
const REAL: [(&str, &str); 3] =
    [("guided-mount-1", "BSD"), ("guided-mount-2", "BSD"), ("servo-rest", "CC BY 4.0")];

/// The largest file of data that a repository should hold, bytes.
const LARGEST: u64 = 300_000;

/// One turn of the worm of the first mount, degrees of its axis, by the table of its guide program.
const WORM_TURN: f64 = 1.6;

/// A count of the servo, degrees.
const COUNT: f64 = 360.0 / 4096.0;

fn text(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn diagnosis(folder: &str) -> Value {
    let recording = format!("recordings/{folder}/recording.yaml");
    let run = abbe(&["diagnose", &recording, "--format", "json", "--quiet"], "");
    assert_eq!(run.status, 0, "{}", run.err);
    serde_json::from_str(&run.out).unwrap()
}

/// The columns of a table by name; an empty cell is NaN.
fn columns<const N: usize>(folder: &str, names: [&str; N]) -> [Vec<f64>; N] {
    let text = text(&format!("recordings/{folder}/data.csv"));
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    names.map(|name| {
        let place = head.iter().position(|own| *own == name).unwrap();
        rows.iter().map(|row| row[place].parse().unwrap_or(f64::NAN)).collect()
    })
}

#[test]
fn every_folder_is_listed_with_its_licence() {
    let (list, notice) = (text("recordings/README.md"), text("NOTICE"));
    for entry in fs::read_dir(root().join("recordings")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(
            !path.is_dir() || list.contains(&format!("[{name}]({name}/README.md)")),
            "{name} is not listed"
        );
    }
    for (folder, licence) in REAL {
        let row = list.lines().find(|line| line.starts_with(&format!("| [{folder}]"))).unwrap();
        assert!(row.contains(licence), "{row}");
        let read = text(&format!("recordings/{folder}/README.md"));
        assert!(read.contains("commit ") && read.contains("What was done to the data"), "{folder}");
        assert!(notice.contains(&format!("recordings/{folder}/data.csv")), "{folder}");
        let size = fs::metadata(root().join(format!("recordings/{folder}/data.csv"))).unwrap().len();
        assert!(size < LARGEST, "{folder}: {size} bytes");
    }
    for folder in ["guided-mount-1", "guided-mount-2"] {
        let licence = text(&format!("recordings/{folder}/LICENSE"));
        for part in ["Copyright (c) 2013-2016", "Redistributions in binary form", "AS IS"] {
            assert!(licence.contains(part), "{folder}: {part}");
        }
    }
}

/// The amplitude of a wave of this period beside a cubic drift, in arcsec of the axis.
fn wave(folder: &str, period: f64) -> f64 {
    let [command, measured] = columns(folder, ["c_command_deg", "c_measured_deg"]);
    let rows: Vec<(f64, f64)> = command
        .iter()
        .zip(&measured)
        .filter(|(_, measured)| measured.is_finite())
        .map(|(c, measured)| (*c, 3600.0 * (measured - c)))
        .collect();
    let most = rows.iter().map(|row| row.0).fold(0.0, f64::max);
    let design = DMatrix::from_fn(rows.len(), 6, |row, column| {
        let c = rows[row].0;
        match i32::try_from(column).unwrap() {
            4 => (TAU * c / period).sin(),
            5 => (TAU * c / period).cos(),
            power => (c / most).powi(power),
        }
    });
    let read = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.1));
    let fitted = design.svd(true, true).solve(&read, 1e-12).unwrap();
    fitted[4].hypot(fitted[5])
}

#[test]
fn the_mounts_have_the_waves_that_are_told_of_them() {
    for (folder, period, arcsec, doubt) in
        [("guided-mount-1", WORM_TURN, 1.62, 0.11), ("guided-mount-2", 0.5106, 3.90, 0.12)]
    {
        let found = wave(folder, period);
        assert!((found - arcsec).abs() < doubt, "{folder}: {found} arcsec at {period} deg");
    }
}

/// What turns with a worm comes back in whole parts of its turn, and in no other.
#[test]
fn the_strongest_waves_of_the_first_mount_are_its_worm_and_the_fifth_of_it() {
    let found = diagnosis("guided-mount-1");
    let number = |finding: &Value, name: &str| finding["parameters"][name]["value"].as_f64().unwrap();
    let waves = found["findings"].as_array().unwrap().iter().filter(|one| one["term"] == "cyclic");
    let mut waves: Vec<(f64, f64)> =
        waves.map(|wave| (number(wave, "amplitude"), WORM_TURN / number(wave, "period"))).collect();
    waves.sort_by(|a, b| b.0.total_cmp(&a.0));
    assert!(waves.len() > 1, "{waves:?}");
    assert!((waves[0].1 - 1.0).abs() < 0.01 && (waves[1].1 - 5.0).abs() < 0.05, "{waves:?}");
}

#[test]
fn the_servo_stands_apart_by_its_play() {
    let [measured, last, pull] = columns("servo-rest", ["c_measured_deg", "last", "force"]);
    let mean = |side: f64| {
        let rows = measured.iter().zip(&last).zip(&pull);
        let rows: Vec<f64> = rows
            .filter(|((_, last), pull)| **last == side && **pull == 0.0)
            .map(|((measured, _), _)| *measured)
            .collect();
        rows.iter().sum::<f64>() / rows.len() as f64
    };
    let apart = (mean(-1.0) - mean(1.0)) / COUNT;
    // The owner has 5.33 counts, from one reading for each pull; the encoder shows whole counts.
    assert!((apart - 5.33).abs() < 0.5, "{apart} counts");
    let found = diagnosis("servo-rest");
    let compliance = found["findings"]
        .as_array()
        .unwrap()
        .iter()
        .find(|finding| finding["term"] == "compliance" && finding["parameters"]["load"] == "last_pull");
    let coefficient = &compliance.unwrap()["parameters"]["coefficient"];
    assert_eq!(coefficient["unit"], "deg/count");
    // From one side to the other: twice the coefficient, against counts.
    let ends = [0, 1].map(|end| -2.0 * coefficient["ci95"][end].as_f64().unwrap() / COUNT);
    assert!(ends[1] < 5.33 && 5.33 < ends[0], "{ends:?} counts");
}
