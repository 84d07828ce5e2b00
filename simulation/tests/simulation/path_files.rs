//! Path files: what they mean, and what their mistakes are told as.

use abbe_simulation::file::{self, PathFile};
use abbe_simulation::noise::{Correlated, Noise};
use abbe_simulation::path::{Shape, Stations, Stroke};
use abbe_simulation::{Datum, Instrument, Normal};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::common::Built;

const ERRORS: &str = "{EXX: [{backlash: {lost_motion: 5 um}}, {growth: {sensor: motor, coefficient: 1 um/K, reference: 20 degC}}]}";

/// A finding: its code, the text that is wrong, what to write instead.
type Finding = (&'static str, String, Option<String>);

fn read(word: &str, text: &str) -> (Option<PathFile>, Vec<Finding>) {
    let built = Built::of(word, if word == "XYFZ" { ERRORS } else { "{}" });
    let source = SourceFile::new("path.yaml", text);
    let mut findings = Diagnostics::new();
    let tree = yaml::read(&source, &mut findings).unwrap();
    let file = file::read(&tree, &built.machine, &built.names, &mut findings);
    if let Some(file) = &file {
        file.fit(&built.machine, &mut built.plant(), &mut findings);
    }
    findings.sort();
    let told = findings.iter().map(|one| (one.code, source.slice(one.span).to_owned(), one.help.clone()));
    (file, told.collect())
}

fn good(word: &str, text: &str) -> PathFile {
    let (file, findings) = read(word, text);
    assert_eq!(findings, []);
    file.unwrap()
}

const HEAD: &str = "path: 1\nat: {X: 10 mm, Z: [-5 mm, -10 mm]}\nfeed: 600 mm/min\nrate: 50 Hz\ntemperatures: {motor: {start: 20 degC}}\n";

#[test]
fn a_file_says_everything_that_a_scenario_holds() {
    let text = format!(
        "{HEAD}title: all of it\nruns: 4\npause: 2 s\nacceleration: 500 mm/s^2\ncircle: {{plane: XY, radius: 0.1 m, start: 90 deg, directions: [cw]}}\ninstrument: {{ballbar: {{eccentricity: {{y: 5 um}}, offset: 1 um}}}}\nclock: 2 ms\nnoise: {{white: 0.5 um, correlated: {{sigma: 1 um, time_constant: 1 min}}, resolution: 100 nm}}\nmissing: 0.5 %\nfixture: 2 um\ndrive: {{axes: [X, Y], sees: {{EXX: [backlash]}}}}\nholdout: {{runs: [4]}}\nseed: 9\n"
    );
    let file = good("XYFZ", &text);
    let (scenario, measurement) = (&file.scenario, &file.scenario.measurement);
    assert_eq!(scenario.path.at, [vec![10.0], vec![], vec![-5.0, -10.0]]);
    assert!((scenario.path.feed - 10.0).abs() < 1e-12);
    assert_eq!((scenario.path.acceleration, scenario.path.runs, scenario.path.pause), (Some(500.0), 4, 2.0));
    assert!(
        matches!(&scenario.path.shape, Shape::Circle { plane: [0, 1], counterclockwise, .. } if *counterclockwise == [false])
    );
    let Instrument::Ballbar { center: None, radius: None, eccentricity, .. } = measurement.instrument else {
        panic!("{:?}", measurement.instrument)
    };
    assert!((eccentricity[1] - 0.005).abs() < 1e-15);
    let correlated = Some(Correlated { sigma: 1e-3, time_constant: 60.0 });
    let noise = Noise { white: 0.5e-3, correlated, resolution: 100.0 * 1e-6, ..Noise::default() };
    assert_eq!(measurement.noise, noise);
    assert_eq!((measurement.clock, measurement.seed, measurement.missing.rate), (0.002, 9, 0.005));
    assert_eq!(
        (scenario.holdout.as_slice(), measurement.drives.as_slice()),
        ([4].as_slice(), [0, 1].as_slice())
    );
}

#[test]
fn a_part_lies_as_its_datum_says() {
    let of = |instrument: &str, datum: &str| {
        format!("{HEAD}circle: {{plane: XY, radius: 0.1 m}}\ninstrument: {instrument}\ndatum: {datum}\n")
    };
    let file = good("XYFZ", &of("{position: [x, y]}", "{x: 200 um, c: -0.5 mrad}"));
    let expected = Datum { displacement: [0.2, 0.0, 0.0], rotation: [0.0, 0.0, -5e-4] };
    assert_eq!(file.scenario.measurement.datum, Some(expected));
    let file = good("XYFZ", &of("{probe: {normal: Z}}", "{}"));
    assert_eq!(file.scenario.measurement.datum, Some(Datum::default()));
    let (_, findings) = read("XYFZ", &of("{position: [x, y]}", "{d: 1 deg, a: 1 mm}"));
    let codes: Vec<(&str, &str)> = findings.iter().map(|(code, text, _)| (*code, text.as_str())).collect();
    assert_eq!(codes, [("E0703", "d"), ("E0307", "mm")]);
}

#[test]
fn lines_go_with_one_axis_or_with_several() {
    let text = format!(
        "{HEAD}instrument: {{linear: {{axis: X, cosine: 1 mrad}}}}\nline: {{axis: X, from: 0 mm, to: 1 in, back: false, stations: {{count: 3, dwell: 2 s}}}}\n"
    );
    let file = good("XYFZ", &text);
    let Shape::Line { strokes, back: false, overrun: 0.0, stations } = file.scenario.path.shape else {
        panic!("{:?}", file.scenario.path.shape)
    };
    assert_eq!(strokes, [Stroke { axis: 0, from: 0.0, to: 25.4 }]);
    assert_eq!(stations, Some(Stations { count: 3, dwell: 2.0, readings: 1 }));
    let linear = Instrument::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: 1e-3 };
    assert_eq!(file.scenario.measurement.instrument, linear);
    let text = format!(
        "{HEAD}instrument: {{probe: {{normal: [0, 3, 4]}}}}\nline: {{from: {{X: 0 mm, Z: 0 mm}}, to: {{X: 3 mm, Z: 4 mm}}}}\n"
    );
    let file = good("XYFZ", &text);
    assert!(
        matches!(file.scenario.path.shape, Shape::Line { strokes, back: true, .. } if strokes.len() == 2)
    );
    let normal = Normal::Fixed([0.0, 0.6, 0.8]);
    assert_eq!(file.scenario.measurement.instrument, Instrument::Probe { normal });
}

#[test]
fn a_rotary_stage_takes_degrees_and_reads_angles() {
    let text = "path: 1\nline: {axis: C, from: 0 deg, to: 360 deg}\nfeed: 10 deg/s\nrate: 8 Hz\ninstrument: position\nnoise: 2 arcsec\n";
    let file = good("FC", text);
    let angles = Instrument::Position { directions: [false; 3], angles: vec![0] };
    assert_eq!(file.scenario.measurement.instrument, angles);
    assert!((file.scenario.path.feed - 10.0_f64.to_radians()).abs() < 1e-15);
}

#[test]
fn sensors_warm_up_and_differences_are_no_temperatures() {
    let text = HEAD.replace(
        "{start: 20 degC}",
        "{start: 68 degF, steps: [{at: 10 s, to: 40 degC}], time_constant: 5 min, swing: {amplitude: 0.5 K, period: 1 min}, noise: 0.02 K}",
    ) + "still: 1 min\ninstrument: position\nloads: {cut: {unit: N, pulses: {height: 80 N, period: 2 s, width: 1 s}}}\n";
    let file = good("XYFZ", &text);
    let sensor = &file.scenario.temperatures[0];
    assert!((sensor.start - 20.0).abs() < 1e-9);
    assert_eq!((sensor.steps.as_slice(), sensor.time_constant), ([(10.0, 40.0)].as_slice(), 300.0));
    assert_eq!((sensor.swing.unwrap().amplitude, sensor.noise), (0.5, Noise::white(0.02)));
    assert_eq!(file.scenario.loads[0].pulses.unwrap().height, 80.0);
}

/// Every mistake of its own, with its code, its place and what to write instead.
#[test]
fn mistakes_are_told_where_they_are() {
    let shape = "line: {axis: X, from: 0 mm, to: 9 mm}\n";
    let position = "instrument: position\n";
    let with = |rest: &str| format!("{HEAD}{rest}");
    let both = |rest: &str| format!("{HEAD}{shape}{position}{rest}");
    let cases = [
        (format!("path: 1\n{shape}{position}rate: 5 Hz\n"), "E0701", "path", "add `feed: ...`"),
        (both("").replace("path: 1", "path: 2"), "E0702", "2", "write `path: 1`"),
        ("recording: 1\n".to_owned(), "E0702", "recording", "begin a path file with `path: 1`"),
        ("calibration: 1\n".to_owned(), "E0702", "calibration", "begin a path file with `path: 1`"),
        (both("sede: 3\n"), "E0703", "sede", "did you mean `seed`?"),
        (
            with(&format!("{shape}instrument: {{linear: {{axis: X}}}}\ndatum: {{c: 1 deg}}\n")),
            "E0703",
            "datum",
            "leave `datum` out, or use `position` along x, y or z, or `probe`",
        ),
        (both("noise: {whyte: 1 um}\n"), "E0703", "whyte", "did you mean `white`?"),
        (both("missing: {blocks: 1}\n"), "E0701", "missing", "add `length: ...`"),
        (both("drive: 3\n"), "E0704", "3", "write `key: value` pairs, such as `axes: ...`"),
        (both("drive: {axes: [Q]}\n"), "E0705", "Q", "its axes are X, Y, Z"),
        (both("drive: {axes: [x]}\n"), "E0705", "x", "did you mean `X`?"),
        (with(position), "E0706", "path", "add one of line, circle, diamond, grid, spiral, points, still"),
        (both("still: 3 s\n"), "E0706", "still", "write one path file for each shape"),
        (with(&format!("{shape}instrument: balbar\n")), "E0707", "balbar", "did you mean `ballbar`?"),
        (
            with(&format!("{shape}instrument: {{probe: {{normal: X}}, linear: {{axis: X}}}}\n")),
            "E0707",
            "linear",
            "write one path file for each instrument",
        ),
        (both("runs: 0\n"), "E0708", "0", "write `1` or more"),
        (both("missing: 120 %\n"), "E0708", "120 %", "write a share such as `0.5 %`"),
        (
            both("fixture: -1 um\n"),
            "E0708",
            "-1 um",
            "write a larger value, or leave the key out if it is optional",
        ),
        (
            with(&format!("{position}circle: {{plane: XX, radius: 1 mm}}\n")),
            "E0709",
            "XX",
            "write two different slides, such as `XY`",
        ),
        (
            with(&format!("{shape}instrument: {{straightness: {{axis: X, direction: Q}}}}\n")),
            "E0709",
            "Q",
            "write `X`, `-X`, `Y`, `-Y`, `Z`, `-Z`, or three numbers: `[1, 0, 0]`",
        ),
        (
            with(&format!("{position}line: {{from: {{X: 0 mm, Y: 0 mm}}, to: {{X: 1 mm}}}}\n")),
            "E0710",
            "Y",
            "name it in both `from` and `to`; if it only stands still, name it in `at`",
        ),
        (with(&format!("{shape}instrument: {{position: [u]}}\n")), "E0705", "u", "its axes are X, Y, Z"),
        (
            both("").replace("motor", "engine"),
            "E0712",
            "line",
            "add `temperatures: {motor: {start: 20 degC}}`",
        ),
        (
            both("drive: {axes: [X], sees: {EXX: [growht]}}\n"),
            "E0714",
            "growht",
            "name a term of the calibration, in an axis's own motion such as EXX of X",
        ),
        (both("holdout: {runs: [2]}\n"), "E0715", "2", "name runs from 1 to `runs`"),
        (
            with(&format!("{position}circle: {{plane: XY, radius: 1 mm, directions: [ccw, cv]}}\n")),
            "E0716",
            "cv",
            "did you mean `cw`?",
        ),
        (both("loads: {cut: {unit: kg}}\n"), "E0716", "kg", "write one of N, V, A, %, count"),
        (
            with(&format!("{shape}instrument: ballbar\n")),
            "E0717",
            "instrument",
            "give the instrument its centre and radius, or drive a circle",
        ),
        (both("").replace("9 mm", "0 mm"), "E0717", "line", "give the path points that are apart"),
        (both("").replace("50 Hz", "1e12 Hz"), "E0717", "1e12 Hz", "write a lower rate, such as `100 Hz`"),
        (both("runs: 1000000000\n"), "E0717", "1000000000", "write fewer runs"),
        (
            both("").replace("600 mm/min", "1e-9 mm/min"),
            "E0717",
            "1e-9 mm/min",
            "write a higher feed, such as `1000 mm/min`",
        ),
        (
            both("seed: 99999999999999999999999\n"),
            "E0708",
            "99999999999999999999999",
            "write `4294967295` or less",
        ),
        (both("noise: 1 s\n"), "E0307", "s", "use a unit such as `mm`"),
        (both("clock: 3\n"), "E0306", "3", "write `3 s` if that is the unit"),
    ];
    for (text, code, place, help) in cases {
        let (_, findings) = read("XYFZ", &text);
        assert_eq!(findings, [(code, place.to_owned(), Some(help.to_owned()))], "{text}");
    }
}

#[test]
fn all_mistakes_are_told_in_one_run() {
    let text = "path: 3\nat: {Q: 1 mm}\nfeed: 1 s\nrate: -1 Hz\ncircle: {radius: 0 mm}\ninstrument: {ballbar: {radius: 1 s}}\nclock: 1 mm\n";
    let codes: Vec<&str> = read("XYFZ", text).1.iter().map(|(code, ..)| *code).collect();
    assert_eq!(codes, ["E0702", "E0705", "E0307", "E0708", "E0701", "E0708", "E0307", "E0307"]);
}

#[test]
fn numbers_without_measure_are_refused_at_once() {
    let line =
        |rest: &str| format!("{HEAD}instrument: position\nline: {{axis: X, from: 0 mm, to: 9 mm{rest}}}\n");
    for (text, code) in [
        (line(", stations: {count: 4000000000, dwell: 1 s}"), "E0717"),
        (line(", stations: {count: 9, dwell: 1 s, readings: 4000000000}"), "E0717"),
        (line("") + "runs: 4000000000\n", "E0717"),
        (line("").replace("50 Hz", "1e300 Hz"), "E0717"),
        (line("").replace("9 mm", "1e300 mm"), "E0717"),
        (line("") + "missing: {blocks: 4000000000, length: 1 s}\n", "E0708"),
        (
            format!(
                "{HEAD}instrument: position\ngrid: {{plane: XY, from: [0 mm, 0 mm], to: [1 mm, 1 mm], lines: 4000000000}}\n"
            ),
            "E0717",
        ),
        (
            format!("{HEAD}instrument: position\nspiral: {{plane: XY, outer: 1e200 mm, turns: 1e300}}\n"),
            "E0717",
        ),
    ] {
        let codes: Vec<&str> = read("XYFZ", &text).1.iter().map(|(code, ..)| *code).collect();
        assert_eq!(codes, [code], "{text}");
    }
}

#[test]
fn angles_and_directions_do_not_mix() {
    let text = "path: 1\nline: {axis: C, from: 0 deg, to: 9 deg}\nfeed: 1 deg/s\nrate: 1 Hz\ninstrument: {position: [x, c]}\n";
    assert_eq!(read("XFC", text).1[0].0, "E0704");
    let text = text.replace("[x, c]", "[x, y]").replace("axis: C", "axis: X").replace("deg", "mm");
    assert_eq!(
        good("XFC", &text).scenario.measurement.instrument,
        Instrument::Position { directions: [true, true, false], angles: Vec::new() }
    );
}
