//! What one recording cannot tell apart is told together; what two can, is not.

use abbe_diagnosis::diagnosis::{Diagnosis, Verdict};
use model_dsl::calibration::Calibration;
use simulation::{Instrument, Path};

use crate::common::*;
use crate::recording::Instrument as Placed;
use crate::testing::*;

fn at_heights(heights: &[f64], directions: &str, seed: u64) -> simulation::Scenario {
    let runs = 3 * u32::try_from(heights.len()).unwrap();
    let lines = path(line(0, 100.0, 400.0), 25.0, 5.0);
    let lines = Path { at: vec![vec![], vec![140.0], heights.to_vec()], runs, ..lines };
    noisy(lines, position(directions), 0.001, seed)
}

#[test]
fn one_height_leaves_a_pitch_beside_a_position_and_two_heights_name_it() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth = together(&known, &bench.calibration("{EBX: [{backlash: {lost_motion: 60 urad}}]}"));
    let low = bench.record(&truth, &at_heights(&[-100.0], "x", 1));
    let high = bench.record(&truth, &at_heights(&[-10.0], "x", 2));
    for alone in [&low, &high] {
        let diagnosis = diagnosed(&bench, &known, &[alone]);
        assert_eq!(diagnosis.findings.len(), 1);
        let names = names(called(&diagnosis, "EBX backlash"));
        assert!(names.contains(&"EXX backlash".to_owned()), "{names:?}");
        let finding = &diagnosis.findings[0];
        let other = finding.alternatives.iter().find(|other| other.term == "backlash").unwrap();
        assert!(other.separate_by.contains(" Z"), "{}", other.separate_by);
    }
    let diagnosis = diagnosed(&bench, &known, &[&low, &high]);
    assert_eq!(found(&diagnosis), ["EBX backlash"]);
    let names = names(&diagnosis.findings[0]);
    assert!(!names.contains(&"EXX backlash".to_owned()), "{names:?}");
    let lost = &numbers(&diagnosis.findings[0], "lost_motion")[0];
    assert!(off(lost, 60e-6) < FAR && lost.unit == "rad", "{lost:?}");
    // The same two heights in the runs of one recording say the same.
    let both = bench.record(&truth, &at_heights(&[-100.0, -10.0], "x", 3));
    assert_eq!(found(&diagnosed(&bench, &known, &[&both])), ["EBX backlash"]);
}

#[test]
fn a_squareness_and_a_leaning_guide_are_one_until_nothing_tells_them() {
    // First order: EC0Y adds to X what EXY linear in y adds. No recording of the tip separates them.
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth = together(&known, &bench.calibration("{EC0Y: 40 urad}"));
    let round =
        Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], runs: 3, ..path(circle(90.0), 25.0, 5.0) };
    let recording = bench.record(&truth, &noisy(round, position("xy"), 0.001, 4));
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    assert_eq!(found(&diagnosis), ["EC0Y constant"]);
    assert!(names(&diagnosis.findings[0]).contains(&"EXY polynomial".to_owned()));
}

#[test]
fn a_scale_and_a_coupling_are_told_apart_where_the_other_axis_stands_elsewhere() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    // The yaw of X changes with y: what that does in Y is proportional to x y. At one x it is a scale of Y.
    let truth = together(
        &known,
        &bench.calibration("{ECX: [{coupling: {axis: Y, per: mm, unit: urad, coefficients: [0.3]}}]}"),
    );
    let along_y = |x: f64, seed: u64| {
        let lines = path(line(1, 40.0, 240.0), 25.0, 6.0);
        let lines = Path { at: vec![vec![x], vec![], vec![-50.0]], runs: 3, ..lines };
        bench.record(&truth, &noisy(lines, position("y"), 0.001, seed))
    };
    let (left, right) = (along_y(100.0, 5), along_y(450.0, 6));
    let alone = diagnosed(&bench, &known, &[&right]);
    // At most four other names are told, the simplest; that it may be another is what counts.
    assert!(!called(&alone, "EYY polynomial").alternatives.is_empty());
    let both = diagnosed(&bench, &known, &[&left, &right]);
    assert_eq!(found(&both), ["ECX coupling"], "{:?}", both.findings.iter().map(names).collect::<Vec<_>>());
    let coefficient = &numbers(&both.findings[0], "coefficients")[0];
    assert!(off(coefficient, 0.3e-6) < FAR, "{coefficient:?}");
}

/// Circles that start at speed, read so many times a second.
fn round(rate: f64) -> Path {
    Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], runs: 3, ..path(circle(90.0), 20.0, rate) }
}

#[test]
fn equal_lags_and_a_late_clock_are_told_together() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let lags = bench.calibration("{EXX: [{lag: {gain: 1000 1/s}}], EYY: [{lag: {gain: 1000 1/s}}]}");
    // All the time the path is late by 1 ms, 20 um. Loops make the circle smaller by (20 / 90 / 1000)^2 / 2 of it: 2 nm.
    for late in [true, false] {
        let truth = if late { known.clone() } else { together(&known, &lags) };
        let mut scenario = noisy(round(20.0), position("xy"), 0.001, 7);
        scenario.measurement.clock = if late { 0.001 } else { 0.0 };
        let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &scenario)]);
        assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
        let of_findings: Vec<String> = diagnosis.findings.iter().flat_map(names).collect();
        let of_clock: Vec<_> = diagnosis.settings.iter().filter(|setting| setting.term == "clock").collect();
        let others = of_clock.iter().flat_map(|setting| &setting.alternatives);
        let of_settings: Vec<String> =
            others.map(|other| format!("{} {}", other.motion, other.term)).collect();
        let clock = !of_clock.is_empty() || of_findings.contains(&"instrument clock".to_owned());
        let lag = of_findings.iter().chain(&of_settings).any(|name| name.ends_with(" lag"));
        assert!(clock && lag, "late {late}: findings {of_findings:?}, clock {of_clock:?}");
        let kinds = ["lag", "clock"];
        assert!(
            diagnosis.findings.iter().all(|finding| kinds.contains(&finding.term)),
            "{:?}",
            found(&diagnosis)
        );
    }
}

#[test]
fn a_late_clock_on_a_round_path_is_no_scale() {
    // Rows 4 mm apart on a circle of 90 mm: between them the path is round, and its chord 22 um from it.
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let mut scenario = noisy(round(5.0), position("xy"), 0.001, 7);
    scenario.measurement.clock = 0.0025;
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&known, &scenario)]);
    let clock = setting(&diagnosis.settings, "clock", "offset");
    assert!(off(&clock, 0.0025) < FAR, "{clock:?}");
    assert!(diagnosis.findings.is_empty(), "{:?}", found(&diagnosis));
}

#[test]
fn a_ballbar_sees_the_difference_of_two_lags() {
    let bench = Bench::of("xyfz-mill");
    let known = bench.calibration(MILL);
    let truth =
        together(&known, &bench.calibration("{EXX: [{lag: {gain: 50 1/s}}], EYY: [{lag: {gain: 52 1/s}}]}"));
    let round =
        Path { at: vec![vec![250.0], vec![140.0], vec![-50.0]], runs: 3, ..path(circle(100.0), 30.0, 12.0) };
    let recording = bench.record(&truth, &noisy(round, ballbar([0.015, -0.01, 0.0]), 0.001, 8));
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
    assert!(found(&diagnosis).iter().all(|name| name.ends_with(" lag")), "{:?}", found(&diagnosis));
    // Whichever names it bears, what the lags do is explained to the noise.
    assert!(diagnosis.after.holdout_rms.unwrap() < 1.1 * 0.001);
    for (name, truth) in [("x", 0.015), ("y", -0.01)] {
        let estimate = setting(&diagnosis.settings, "eccentricity", name);
        assert!(
            off(&estimate, truth) < 2.0 && (estimate.value - truth).abs() < 0.001,
            "{name}: {estimate:?}"
        );
    }
}

#[test]
fn the_drives_own_feedback_tells_friction_from_play() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 6 um}}]}"));
    let lines = Path { runs: 3, ..path(line(0, 0.0, 300.0), 20.0, 8.0) };
    let mut scenario = noisy(lines, position("x"), 0.001, 9);
    let blind = diagnosed(&bench, &known, &[&bench.record(&truth, &scenario)]);
    assert_eq!(
        (found(&blind).as_slice(), blind.findings[0].location.side),
        (&["EXX backlash".to_owned()][..], "unknown")
    );
    scenario.measurement.drives = vec![0];
    scenario.measurement.drive_noise = simulation::noise::Noise::white(0.0005);
    let mut plant = bench.plant(&truth);
    let play = diagnosed(&bench, &known, &[&bench.recorded(&plant, &scenario)]);
    // Of the two terms of EXX, the known table is on neither side of concern; the play is the second.
    plant.see_at_drive(&bench.compiled.machine, "EXX", "backlash").unwrap();
    let friction = diagnosed(&bench, &known, &[&bench.recorded(&plant, &scenario)]);
    for (diagnosis, side) in [(play, "transmission"), (friction, "drive")] {
        assert_eq!(found(&diagnosis), ["EXX backlash"], "{side}");
        assert_eq!(diagnosis.findings[0].location.side, side);
        let lost = &numbers(&diagnosis.findings[0], "lost_motion")[0];
        assert!(off(lost, 0.006) < FAR, "{lost:?}");
    }
}

#[test]
fn a_slanted_beam_and_a_short_scale_are_told_together() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let lines = Path { runs: 3, ..path(line(0, 0.0, 300.0), 20.0, 8.0) };
    let beam = Instrument::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: 8e-3 };
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&known, &noisy(lines, beam, 0.001, 10))]);
    // 32 ppm of 300 mm: 10 um, as a scale of 32 ppm that is too short.
    let from_findings: Vec<String> = diagnosis.findings.iter().flat_map(names).collect();
    let of_setting = diagnosis.settings.iter().filter(|setting| setting.term == "cosine");
    let others: Vec<String> = of_setting
        .clone()
        .flat_map(|setting| &setting.alternatives)
        .map(|other| format!("{} {}", other.motion, other.term))
        .collect();
    let cosine = of_setting.count() > 0 || from_findings.contains(&"instrument cosine".to_owned());
    let scale = from_findings.iter().chain(&others).any(|name| name == "EXX polynomial");
    assert!(cosine && scale, "{from_findings:?} {:?}", diagnosis.settings);
    assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
}

#[test]
fn a_loop_that_rings_and_friction_inside_it_are_told_with_their_numbers() {
    let bench = Bench::of("FX");
    let known = bench.calibration("{}");
    let (gain, frequency, lost) = (48.0, 11.0, 0.024);
    let truth = bench.calibration(
        "{EXX: [{lag: {gain: 48 1/s, frequency: 11 Hz}}, {backlash: {lost_motion: 24 um, inside_loop: true}}]}",
    );
    let lines = Path { runs: 4, acceleration: Some(400.0), ..path(line(0, 0.0, 50.0), 30.0, 400.0) };
    let mut scenario = noisy(lines, position("x"), 0.002, 11);
    scenario.measurement.drives = vec![0];
    scenario.measurement.drive_noise = simulation::noise::Noise::white(0.002);
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &scenario)]);
    assert_eq!(found(&diagnosis), ["EXX lag", "EXX backlash"]);
    assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics);
    let [lag, friction] = &diagnosis.findings[..] else { panic!("{:?}", found(&diagnosis)) };
    assert!(friction.location.inside_loop && friction.location.side == "drive");
    let cases = [(lag, "gain", gain), (lag, "frequency", frequency), (friction, "lost_motion", lost)];
    for (finding, name, truth) in cases {
        let number = &numbers(finding, name)[0];
        assert!(off(number, truth) < FAR && (number.value / truth - 1.0).abs() < 0.01, "{name} {number:?}");
    }
    // Written back, it leaves nothing, in the drive's own feedback too.
    let improved =
        known.with(&[(0, lag.calibrated.clone())]).with_inside_loop(0, friction.calibrated.clone());
    let again = diagnosed(&bench, &improved, &[&bench.record(&truth, &scenario)]);
    assert_eq!((again.verdict, found(&again).len()), (Verdict::Adequate, 0), "{:?}", found(&again));
}

#[test]
fn a_loop_of_first_order_is_not_said_to_ring() {
    let bench = Bench::of("FX");
    let known = bench.calibration("{}");
    let truth = bench.calibration("{EXX: [{lag: {gain: 30 1/s}}]}");
    let lines = Path { runs: 4, acceleration: Some(400.0), ..path(line(0, 0.0, 50.0), 30.0, 200.0) };
    let mut scenario = noisy(lines, position("x"), 0.001, 12);
    scenario.measurement.drives = vec![0];
    scenario.measurement.drive_noise = simulation::noise::Noise::white(0.001);
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &scenario)]);
    assert_eq!(found(&diagnosis), ["EXX lag"]);
    assert!(!diagnosis.findings[0].parameters.iter().any(|parameter| parameter.name == "frequency"));
}

#[test]
fn play_is_found_at_stations_whose_overruns_were_not_recorded() {
    let bench = Bench::of("FX");
    let known = bench.calibration(STAGE);
    let truth = together(&known, &bench.calibration("{EXX: [{backlash: {lost_motion: 6 um}}]}"));
    let stations = simulation::path::Stations { count: 7, dwell: 4.0, readings: 1 };
    let shape = simulation::path::Shape::Line {
        strokes: vec![simulation::path::Stroke { axis: 0, from: 0.0, to: 300.0 }],
        back: true,
        overrun: 5.0,
        stations: Some(stations),
    };
    for seed in [21, 22, 23] {
        let lines = Path { runs: 5, ..path(shape.clone(), 30.0, 1.0) };
        let recorded =
            |of: &Calibration| bench.record(of, &noisy(lines.clone(), position("x"), 0.0003, seed));
        let diagnosis = diagnosed(&bench, &known, &[&recorded(&truth)]);
        assert_eq!(found(&diagnosis), ["EXX backlash"], "{seed}");
        let lost = &numbers(&diagnosis.findings[0], "lost_motion")[0];
        assert!(off(lost, 0.006) < FAR, "{seed}: {lost:?}");
        // And where the play is known already, nothing is made up.
        let again = diagnosed(&bench, &truth, &[&recorded(&truth)]);
        assert_eq!(
            (again.verdict, found(&again).len()),
            (Verdict::Adequate, 0),
            "{seed}: {:?}",
            found(&again)
        );
    }
}

#[test]
fn a_ballbar_with_its_centre_on_the_axes_and_not_on_the_tip_decides_nothing() {
    let bench = Bench::of("XYFZ");
    let known = bench.calibration("{}");
    let bar = ballbar([0.0; 3]);
    let mut recording = bench.record(&known, &noisy(path(circle(100.0), 25.0, 10.0), bar, 0.0005, 24));
    let (Placed::Ballbar { center, radius }, length) = (recording.instrument.clone(), 120.0) else {
        panic!()
    };
    assert_eq!(diagnosed(&bench, &known, &[&recording]).undecidable, None);
    recording.instrument = Placed::Ballbar { center: [center[0], center[1], center[2] + length], radius };
    let diagnosis = diagnosed(&bench, &known, &[&recording]);
    let because = diagnosis.undecidable.unwrap();
    assert!(
        because.contains("100.000 mm long") && because.contains("156.205 mm from its centre"),
        "{because}"
    );
    assert!(diagnosis.findings.is_empty());
}

/// Slow circles, read so often that a play of some micrometres takes several rows to cross.
fn slowly(seed: u64) -> simulation::Scenario {
    let at = vec![vec![250.0], vec![140.0], vec![-50.0]];
    noisy(Path { at, runs: 3, ..path(circle(90.0), 8.0, 30.0) }, position("xy"), 0.0005, seed)
}

/// The sentence about an axis that crosses its play.
fn crosses(diagnosis: &abbe_diagnosis::diagnosis::Diagnosis, letter: &str) -> bool {
    let begins = format!("This recording cannot show whether friction also holds {letter} for a moment");
    diagnosis.undecided.iter().any(|sentence| sentence.starts_with(&begins))
}

#[test]
fn a_known_play_that_is_free_holds_nothing_for_a_moment() {
    let bench = Bench::of("xyfz-mill");
    let known =
        together(&bench.calibration(MILL), &bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}"));
    let free = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um, wind_up: 9 um}}]}");
    let truth = together(&bench.calibration(MILL), &free);
    for seed in 1..5 {
        let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &slowly(seed))]);
        assert_eq!(diagnosis.verdict, Verdict::Adequate, "{seed}: {:?}", found(&diagnosis));
        assert!(crosses(&diagnosis, "X") && !crosses(&diagnosis, "Y"), "{:?}", diagnosis.undecided);
        // Nothing was found, and nothing else changes what is left.
        let (before, after) = (diagnosis.before.rms, diagnosis.after.rms);
        assert!((before - after).abs() < 0.005 * after, "{before} {after}");
    }
}

#[test]
fn a_play_that_is_found_beside_a_free_one_is_all_there_is() {
    let bench = Bench::of("xyfz-mill");
    let known =
        together(&bench.calibration(MILL), &bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}"));
    let free = "{EXX: [{backlash: {lost_motion: 9 um, wind_up: 9 um}}], \
                EYY: [{backlash: {lost_motion: 12 um, wind_up: 12 um}}]}";
    let truth = together(&bench.calibration(MILL), &bench.calibration(free));
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &slowly(11))]);
    assert_eq!(found(&diagnosis), ["EYY backlash"]);
    let lost = &numbers(&diagnosis.findings[0], "lost_motion")[0];
    assert!((lost.value - 0.012).abs() < 0.0002, "{lost:?}");
}

#[test]
fn a_spike_beside_a_play_that_acts_at_once_is_still_a_spike() {
    let bench = Bench::of("xyfz-mill");
    let known =
        together(&bench.calibration(MILL), &bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}"));
    let truth =
        together(&known, &bench.calibration("{EXX: [{reversal-spike: {height: 6 um, decay: 200 ms}}]}"));
    let diagnosis = diagnosed(&bench, &known, &[&bench.record(&truth, &slowly(21))]);
    assert_eq!(found(&diagnosis), ["EXX reversal-spike"]);
    assert!(!crosses(&diagnosis, "X"), "{:?}", diagnosis.undecided);
    let height = &numbers(&diagnosis.findings[0], "height")[0];
    assert!(off(height, 0.006) < FAR, "{height:?}");
}

/// The diagnosis of a slide that goes to and fro behind its position loop. The controller has 1000 cycles a second, and one row is recorded
/// every `cycles` of them.
fn recorded_each(cycles: usize, more: &str) -> Diagnosis {
    recorded_each_of(cycles, &format!("{{EXX: [{{lag: {{gain: 40 1/s}}}}{more}]}}"), "{}")
}

/// The same for a slide of which something is known.
fn recorded_each_of(cycles: usize, truth: &str, known: &str) -> Diagnosis {
    let bench = Bench::of("FX");
    let stroke =
        Path { acceleration: Some(500.0), runs: 4, pause: 0.5, ..path(line(0, 0.0, 120.0), 100.0, 1000.0) };
    let whole = bench.record(&bench.calibration(truth), &noisy(stroke, position("x"), 0.0005, 3));
    // From the first row of each run on, in which the slide rests.
    let rows: Vec<usize> = whole.runs().into_iter().flat_map(|(rows, _)| rows.step_by(cycles)).collect();
    diagnosed(&bench, &bench.calibration(known), &[&of_rows(&whole, &rows)])
}

/// The step of such rows, squared, over 12, is 1/30000 s^2 at 50 Hz: what an axis is off by per acceleration, if its command is taken as
/// straight between rows.
#[test]
fn a_command_that_bends_between_rows_is_no_acceleration() {
    for cycles in [20, 10, 4] {
        let diagnosis = recorded_each(cycles, "");
        assert_eq!(found(&diagnosis), ["EXX lag"], "{cycles}");
        let gain = &numbers(&diagnosis.findings[0], "gain")[0];
        assert!((gain.value - 40.0).abs() < 0.02, "{cycles}: {gain:?}");
        assert_eq!(diagnosis.verdict, Verdict::LeftOutPhysics, "{cycles}");
        let open = diagnosis.undecided.iter().any(|sentence| sentence.contains("commands bend between rows"));
        assert!(open, "{cycles}: {:?}", diagnosis.undecided);
    }
}

#[test]
fn a_loop_that_is_known_leaves_nothing_where_commands_bend() {
    let known = "{EXX: [{lag: {gain: 40 1/s}}]}";
    let diagnosis = recorded_each_of(20, known, known);
    assert_eq!(diagnosis.findings.len(), 0, "{:?}", found(&diagnosis));
    assert_eq!(diagnosis.verdict, Verdict::Adequate);
}

#[test]
fn an_acceleration_stays_one_beside_a_command_that_bends_little() {
    let diagnosis = recorded_each(10, ", {acceleration: {gain: 20000 1/s^2}}");
    assert_eq!(found(&diagnosis), ["EXX lag", "EXX acceleration"]);
}

/// The diagnosis of a slide that goes to and fro behind its position loop, each run without its first `seconds`.
fn cut_out(seconds: f64, truth: &str, known: &str) -> Diagnosis {
    let bench = Bench::of("FX");
    let stroke =
        Path { acceleration: Some(500.0), runs: 4, pause: 0.5, ..path(line(0, 0.0, 120.0), 100.0, 250.0) };
    let whole = bench.record(&bench.calibration(truth), &noisy(stroke, position("x"), 0.0005, 3));
    let is_late =
        |rows: &std::ops::Range<usize>, row: usize| whole.time[row] - whole.time[rows.start] >= seconds;
    let late = |rows: std::ops::Range<usize>| -> Vec<usize> {
        rows.clone().filter(|row| is_late(&rows, *row)).collect()
    };
    let rows: Vec<usize> = whole.runs().into_iter().flat_map(|(rows, _)| late(rows)).collect();
    diagnosed(&bench, &bench.calibration(known), &[&of_rows(&whole, &rows)])
}

/// A run that was cut out of a motion begins v/K = 2.5 mm behind its command, and one out of an acceleration less. Had it begun at rest, it
/// would fall back so far in its first rows: a jump that only comes at the beginning of a run. The slide gains speed for 0.2 s.
#[test]
fn a_run_that_is_cut_out_of_a_motion_shows_its_loop_and_nothing_else() {
    for seconds in [0.1, 0.35] {
        let diagnosis = cut_out(seconds, "{EXX: [{lag: {gain: 40 1/s}}]}", "{}");
        assert_eq!(found(&diagnosis), ["EXX lag"], "{seconds}");
        let gain = &numbers(&diagnosis.findings[0], "gain")[0];
        assert!((gain.value - 40.0).abs() < 0.05, "{seconds}: {gain:?}");
        let open = diagnosis.undecided.iter().any(|sentence| sentence.contains("it moved already"));
        assert!(open, "{seconds}: {:?}", diagnosis.undecided);
    }
}

#[test]
fn a_known_loop_leaves_nothing_where_runs_are_cut_out_of_a_motion() {
    let known = "{EXX: [{lag: {gain: 40 1/s}}]}";
    let diagnosis = cut_out(0.1, known, known);
    assert_eq!(diagnosis.findings.len(), 0, "{:?}", found(&diagnosis));
    assert_eq!(diagnosis.verdict, Verdict::Adequate);
}

#[test]
fn a_play_is_found_where_runs_are_cut_out_of_a_motion() {
    let diagnosis = cut_out(0.35, "{EXX: [{lag: {gain: 40 1/s}}, {backlash: {lost_motion: 6 um}}]}", "{}");
    let mut found = found(&diagnosis);
    found.sort();
    assert_eq!(found, ["EXX backlash", "EXX lag"]);
}
