//! Where the axes were: runs that begin anew, drives that lead, commands that are end points.

use std::fs;

use abbe_diagnosis::diagnosis::Diagnosis;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use simulation::Path;

use crate::beside::shared;
use crate::common::*;
use crate::recording::{Recording, read_header};
use crate::testing::*;

/// A recording that was found in the world, beside the repository; `None`, with a line, where it is not there.
fn found_in(file: &str, bench: &Bench) -> Option<Recording> {
    let path = shared(&format!("found/{file}"))?;
    let text = fs::read_to_string(&path).unwrap();
    let mut findings = Diagnostics::new();
    let root = yaml::read(&SourceFile::new(file, text), &mut findings).unwrap();
    let header = read_header(&root, bench.equations(), &mut findings).unwrap();
    let data = path.with_file_name(&header.data.value);
    Some(header.read_data(&data).unwrap_or_else(|error| panic!("{error}")))
}

fn alone(bench: &Bench, recording: &Recording) -> Diagnosis {
    diagnosed(bench, &bench.calibration("{}"), &[recording])
}

#[test]
fn sweeps_with_clocks_of_their_own_show_the_loop() {
    let bench = Bench::of("FX");
    let Some(recording) = found_in("gaps/sweep.yaml", &bench) else { return };
    let diagnosis = alone(&bench, &recording);
    assert_eq!(found(&diagnosis), ["EXX lag"]);
    let gain = &numbers(&diagnosis.findings[0], "gain")[0];
    assert!((gain.value - 25.3).abs() < 0.1, "{gain:?}");
}

#[test]
fn sweeps_one_way_through_gaps_show_what_they_have() {
    let bench = Bench::of("FX");
    let truth = bench.calibration(
        "{EXX: [{lag: {gain: 20 1/s}}, {polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.4]}}]}",
    );
    let plant = bench.plant(&truth);
    // Without a column of runs: three sweeps one way, and gaps of a minute between them.
    let sweep = |row: u32| 0.4 * f64::from(row.clamp(20, 520) - 20);
    let mut commands = simulation::Commands::default();
    for run in 0..3_u32 {
        commands.time.extend((0..600_u32).map(|row| 60.0 * f64::from(run) + 0.01 * f64::from(row)));
        commands.run.extend([1; 600]);
    }
    commands.positions = vec![(0..3).flat_map(|_| (0..600).map(sweep)).collect()];
    let mut measurement = simulation::Measurement::perfect(position("x"));
    measurement.noise = simulation::noise::Noise::white(5e-4);
    let recording = recording(simulation::replay(&plant, &commands, &measurement).unwrap());
    let diagnosis = alone(&bench, &recording);
    let mut names = found(&diagnosis);
    names.sort();
    assert_eq!(names, ["EXX lag", "EXX polynomial"]);
    let gain = &numbers(called(&diagnosis, "EXX lag"), "gain")[0];
    assert!(off(gain, 20.0) < FAR, "{gain:?}");
}

#[test]
fn a_drive_that_leads_is_not_blamed_on_the_other_axis_and_the_clock() {
    let bench = Bench::of("XFY");
    let known = bench.calibration("{EXX: [{lag: {gain: 40 1/s}}], EYY: [{lag: {gain: 40 1/s}}]}");
    for (known, gain) in [(&bench.calibration("{}"), -120.0), (&known, -250.0)] {
        let more = bench.calibration(&format!("{{EXX: [{{lag: {{gain: {gain} 1/s}}}}]}}"));
        let circles = Path { runs: 4, acceleration: Some(300.0), ..path(circle(40.0), 60.0, 50.0) };
        let recording = bench.record(&together(known, &more), &noisy(circles, position("xy"), 1e-3, 5));
        let diagnosis = diagnosed(&bench, known, &[&recording]);
        assert_eq!(found(&diagnosis), ["EXX lag"], "{gain}");
        assert!(diagnosis.settings.is_empty(), "{:?}", diagnosis.settings);
        let fitted = &numbers(&diagnosis.findings[0], "gain")[0];
        assert!(off(fitted, gain) < FAR && fitted.ci95.1 < 0.0, "{fitted:?}");
    }
}

#[test]
fn a_drive_that_shows_that_it_leads_is_said_to() {
    let bench = Bench::of("FX");
    let lines = Path { runs: 4, acceleration: Some(400.0), ..path(line(0, 0.0, 50.0), 30.0, 100.0) };
    let mut scenario = noisy(lines, position(""), 1e-3, 6);
    scenario.measurement.drives = vec![0];
    scenario.measurement.drive_noise = simulation::noise::Noise::white(1e-3);
    let truth = bench.calibration("{EXX: [{lag: {gain: -80 1/s}}]}");
    let diagnosis = alone(&bench, &bench.record(&truth, &scenario));
    assert_eq!(found(&diagnosis), ["EXX lag"]);
    let gain = &numbers(&diagnosis.findings[0], "gain")[0];
    assert!(off(gain, -80.0) < FAR && gain.ci95.1 < 0.0, "{gain:?}");
}

#[test]
fn a_command_that_is_an_end_point_is_said_to_be_one() {
    let bench = Bench::of("FA");
    let Some(recording) = found_in("targets/step-lagdelayfr.yaml", &bench) else { return };
    let diagnosis = alone(&bench, &recording);
    assert!(
        diagnosis.undecided.iter().any(|sentence| sentence.contains("is an end point")),
        "{:?}",
        diagnosis.undecided
    );
    // Friction holds the axis 0.4 deg short of every target, from both sides; the display's steps are 0.088 deg.
    assert!(found(&diagnosis).iter().all(|name| name == "EAA backlash"), "{:?}", found(&diagnosis));
    assert!(diagnosis.noise.value < 0.088, "{:?}", diagnosis.noise);
}
