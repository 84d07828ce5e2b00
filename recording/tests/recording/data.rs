//! Tables of data that are read, however they are written.

use abbe_recording::AngleUnit;

use crate::common::{header, packed, recording};

const TEXT: &str = "recording: 1
title: a line
machine: XYFZ
instrument: position
data: data.csv
channels:
  time: {column: t, unit: s}
  run: {column: n}
  command.x: {column: xc, unit: in}
  measured.x: {column: xm, unit: mm}
  temperature.bed: {column: T, unit: degF}
  load.drive: {column: U, unit: V}
";

/// Three rows; each of the forms below says the same.
const PLAIN: &str = "t,n,xc,xm,T,U\n10,1,1,25.5,32,0.5\n10.5,1,2,,50,-1e1\n11,2,-1,-25.25,212,3\n";

#[test]
fn columns_are_in_units_of_the_inside() {
    let read = recording(TEXT, PLAIN).unwrap();
    assert_eq!(read.file, "data.csv");
    assert_eq!(read.title.as_deref(), Some("a line"));
    assert_eq!(read.time, [0.0, 0.5, 1.0]);
    assert_eq!(read.run, [1, 1, 2]);
    assert_eq!(read.axes.len(), 3);
    assert_eq!(read.axes[0].command.as_deref().unwrap(), [25.4, 50.8, -25.4]);
    assert!(
        read.axes[1].command.is_none() && read.axes[0].actual.is_none() && read.axes[0].measured.is_none()
    );
    let measured = read.measured[0].as_deref().unwrap();
    assert_eq!((measured[0], measured[2]), (25.5, -25.25));
    assert!(measured[1].is_nan());
    assert!(read.measured[1].is_none() && read.deviation.is_none() && read.normal.is_none());
    let bed = &read.temperatures[0];
    assert_eq!((bed.name.as_str(), bed.unit.as_str()), ("bed", "degC"));
    assert_eq!(bed.values.iter().map(|value| value.round()).collect::<Vec<_>>(), [0.0, 10.0, 100.0]);
    let drive = &read.loads[0];
    assert_eq!((drive.name.as_str(), drive.unit.as_str()), ("drive", "V"));
    assert_eq!(drive.values, [0.5, -10.0, 3.0]);
    assert!(read.holdout.is_none() && read.notes.is_empty());
}

#[test]
fn every_way_to_write_it_says_the_same() {
    let plain = format!("{:?}", recording(TEXT, PLAIN).unwrap());
    let windows = PLAIN.replace('\n', "\r\n");
    let semicolons = PLAIN.replace(',', ";");
    let tabs = PLAIN.replace(',', "\t");
    let marked = format!("\u{feff}{PLAIN}");
    let spaced = PLAIN.replace(',', "  , ");
    let comments = format!("# a controller\n\n{}", PLAIN.replace("\n10.5", "\n# half\n\n10.5"));
    let units = PLAIN.replace("\n10,", "\n#unit,s,,in,mm,degF,\n10,");
    let no_last_break = PLAIN.trim_end().to_owned();
    let quoted = PLAIN.replace("t,n,xc", "\"t\",\"n\",\"xc\"").replace("25.5,", "\"25.5\",");
    let more_columns = "note,t,n,xc,xm,T,U,end\n\"a, b\",10,1,1,25.5,32,0.5,\n\"say \"\"x\"\"\",10.5,1,2,NaN,50,-1e1,x\n,11,2.0,-1,-25.25,212,3,\n";
    let words = PLAIN.replace(",,", ",null,");
    for text in [
        &windows,
        &semicolons,
        &tabs,
        &marked,
        &spaced,
        &comments,
        &units,
        &no_last_break,
        &quoted,
        &words,
        more_columns,
    ] {
        let read = recording(TEXT, text).unwrap_or_else(|error| panic!("{error}\nin\n{text}"));
        assert_eq!(format!("{read:?}"), plain, "{text}");
    }
    let read = header(TEXT).read_csv("data.csv", packed(PLAIN.as_bytes()).as_slice()).unwrap();
    assert_eq!(format!("{read:?}"), plain);
}

/// Packed or not is told by the bytes, so that a wrong name does no harm.
#[test]
fn files_are_read_by_what_they_hold() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("recording-files");
    std::fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in [
        ("a.csv", PLAIN.as_bytes().to_vec()),
        ("b.csv.gz", packed(PLAIN.as_bytes())),
        ("c.csv", packed(PLAIN.as_bytes())),
        ("d.csv.gz", PLAIN.as_bytes().to_vec()),
    ] {
        std::fs::write(folder.join(name), bytes).unwrap();
        let read = header(TEXT).read_data(&folder.join(name)).unwrap();
        assert_eq!(read.time, [0.0, 0.5, 1.0], "{name}");
    }
    let error = header(TEXT).read_data(&folder.join("none.csv")).unwrap_err();
    assert!(error.to_string().contains("none.csv: it cannot be read"), "{error}");
    let error = header(TEXT).read_data(&folder).unwrap_err();
    assert!(error.to_string().contains("a folder"), "{error}");
}

const RUNS: &str = "recording: 1
machine: FX
instrument: position
data: data.csv
channels:
  time: {column: t, unit: ms}
  run: {column: n}
  measured.x: {column: x, unit: mm}
";

#[test]
fn time_is_counted_from_the_first_row() {
    // Milliseconds since 1970.
    let read = recording(RUNS, "t,n,x\n1700000000000,1,0\n1700000000250,1,0\n1700000060000,7,0\n").unwrap();
    assert_eq!(read.time, [0.0, 0.25, 60.0]);
    assert_eq!(read.run, [1, 1, 7]);
    assert!(read.notes.is_empty());
}

/// Clocks that begin again are laid one after another, a mean step apart, and it is told.
#[test]
fn runs_with_clocks_of_their_own_follow_one_another() {
    let read = recording(RUNS, "t,n,x\n0,1,0\n1000,1,0\n4000,1,0\n0,2,0\n500,2,0\n500,3,0\n").unwrap();
    assert_eq!(read.time, [0.0, 1.0, 4.0, 6.0, 6.5, 7.0]);
    let [note] = read.notes.as_slice() else { panic!("{:?}", read.notes) };
    assert!(note.contains("run 2") && note.contains("pauses"), "{note}");
    // A clock that runs on through the pause is believed.
    let read = recording(RUNS, "t,n,x\n0,1,0\n1000,1,0\n60000,2,0\n61000,2,0\n").unwrap();
    assert_eq!(read.time, [0.0, 1.0, 60.0, 61.0]);
    assert!(read.notes.is_empty());
}

#[test]
fn held_out_runs_and_kept_columns() {
    let text =
        format!("{RUNS}holdout: {{runs: [2]}}\nextra: {{a: {{column: x}}, b: {{column: gone, unit: mm}}}}\n");
    let read = recording(&text, "t,n,x\n0,1,0\n1,2,0\n").unwrap();
    assert_eq!(read.holdout, Some(vec![2]));
    let [note] = read.notes.as_slice() else { panic!("{:?}", read.notes) };
    assert!(note.contains("`gone`"), "{note}");
}

#[test]
fn people_read_angles_in_the_unit_that_they_wrote() {
    for (unit, expected) in [
        ("deg", AngleUnit::Degree),
        ("arcsec", AngleUnit::Degree),
        ("rad", AngleUnit::Radian),
        ("mrad", AngleUnit::Radian),
    ] {
        let text = format!(
            "{{recording: 1, machine: FC, instrument: position, data: d.csv, channels: {{time: {{column: t, unit: s}}, measured.c: {{column: c, unit: {unit}}}}}}}"
        );
        let read = recording(&text, "t,c\n0,180\n").unwrap();
        assert_eq!(read.angle_unit, expected, "{unit}");
        let angle = read.axes[0].measured.as_deref().unwrap()[0];
        if unit == "deg" {
            assert!((angle - std::f64::consts::PI).abs() < 1e-15);
        }
    }
}
