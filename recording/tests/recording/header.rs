//! What a recording file that is right says.

use abbe_recording::{ChannelKind, Instrument};

use crate::common::{header, read};

const FULL: &str = "recording: 1
title: \"circle: both directions\"
machine: XFYZC
calibration: mill-7.yaml
instrument: position
data: circle.csv
channels:
  time: {column: t, unit: min}
  run: {column: n}
  command.x: {column: xc, unit: in}
  command.c: {column: cc, unit: deg}
  actual.x: {column: xa, unit: mil}
  measured.y: {column: ym, unit: um}
  measured.c: {column: cm, unit: arcsec}
  temperature.spindle: {column: T, unit: degF}
  load.feed drive: {column: I, unit: A}
holdout: {runs: [3, 1, 3]}
extra:
  counter.x: {column: c, unit: mm}
  remark: {column: r}
";

#[test]
fn every_channel_has_its_meaning() {
    let header = header(FULL);
    let kinds: Vec<_> = header.channels.iter().map(|channel| channel.kind.clone()).collect();
    // The axes of the machine are X, Y, Z, C.
    assert_eq!(
        kinds,
        [
            ChannelKind::Time,
            ChannelKind::Run,
            ChannelKind::Command(0),
            ChannelKind::Command(3),
            ChannelKind::Actual(0),
            ChannelKind::Measured(1),
            ChannelKind::MeasuredAngle(3),
            ChannelKind::Temperature("spindle".to_owned()),
            ChannelKind::Load("feed drive".to_owned()),
        ]
    );
    assert_eq!(header.title.as_deref(), Some("circle: both directions"));
    assert_eq!(header.machine.value, "XFYZC");
    assert_eq!(header.calibration.unwrap().value, "mill-7.yaml");
    assert_eq!(header.data.value, "circle.csv");
    assert_eq!(header.instrument, Instrument::Position);
    let held = header.holdout.as_ref().map(|runs| runs.iter().map(|run| run.value).collect());
    assert_eq!(held, Some(vec![1, 3]));
    assert_eq!(header.axes, ["X", "Y", "Z", "C"]);
    let extra: Vec<_> = header.extra.iter().map(|extra| extra.column.value.as_str()).collect();
    assert_eq!(extra, ["c", "r"]);
}

#[test]
fn a_title_is_what_was_written() {
    let titled = |written: &str| header(&FULL.replace("\"circle: both directions\"", written)).title;
    for (written, title) in [
        ("\" night 4 \"", " night 4 "),
        ("\"null\"", "null"),
        ("12:30:00", "12:30:00"),
        ("|\n  night 4", "night 4"),
    ] {
        assert_eq!(titled(written).as_deref(), Some(title), "{written}");
    }
}

/// The sizes of units are the definitions: 1 in = 25.4 mm, 32 degF = 0 degC, 3600 arcsec = 1 deg.
#[test]
fn numbers_become_those_of_the_inside() {
    let header = header(FULL);
    let value = |name: &str, number: f64| {
        header.channels.iter().find(|channel| channel.name.value == name).unwrap().to_internal(number)
    };
    let pi = std::f64::consts::PI;
    for (name, number, expected) in [
        ("time", 2.0, 120.0),
        ("run", 2.0, 2.0),
        ("command.x", 2.0, 50.8),
        ("command.c", 90.0, pi / 2.0),
        ("actual.x", 1000.0, 25.4),
        ("measured.y", 1500.0, 1.5),
        ("measured.c", 3600.0, pi / 180.0),
        ("temperature.spindle", 212.0, 100.0),
        ("temperature.spindle", 32.0, 0.0),
        ("load.feed drive", 3.5, 3.5),
    ] {
        assert!((value(name, number) - expected).abs() < 1e-12, "{name}: {}", value(name, number));
    }
}

/// A machine at rest seen by a drive, or a rotor seen by displacement sensors, has no command and is no mistake.
#[test]
fn what_measures_need_not_be_commanded() {
    for channels in [
        "actual.x: {column: a, unit: mm}",
        "measured.x: {column: a, unit: mm}",
        "measured.z: {column: a, unit: mm}, temperature.m: {column: b, unit: K}",
    ] {
        let text = format!(
            "{{recording: 1, machine: FX, instrument: position, data: d.csv, channels: {{time: {{column: t, unit: s}}, {channels}}}}}"
        );
        assert!(header(&text).holdout.is_none());
    }
}

#[test]
fn one_column_for_two_things_is_a_warning() {
    let text = "recording: 1
machine: FX
instrument: position
data: d.csv
channels:
  time: {column: t, unit: s}
  command.x: {column: pos, unit: mm}
  measured.x: {column: pos, unit: mm}
";
    let (header, found) = read(text);
    assert!(header.is_some());
    let [(warning, marked)] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!((warning.code, marked.as_str()), ("W0601", "pos"));
    assert!(text[..warning.span.start].ends_with("measured.x: {column: "));
    assert!(warning.help.as_deref().unwrap().contains("its own column"));
}
