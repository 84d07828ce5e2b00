//! Tables with a column for each run.

use crate::common::{read, recording};

const ONE_WAY: &str = "recording: 1
machine: FX
instrument: linear
data: d
channels:
  time: {every: 10 s}
  command.x: {column: target, unit: mm}
  temperature.air: {column: T, unit: degC}
  deviation: {columns: [run 1, run 2, run 3], unit: um}
";

const TABLE: &str =
    "target,T,run 1,run 2,run 3,down 1,down 2,down 3\n0,20,1,2,3,-1,-2,-3\n100,21,4,,6,-4,-5,-6\n";

/// The table by hand: run after run, and the readings in mm.
#[test]
fn a_column_is_a_run() {
    let read = recording(ONE_WAY, TABLE).unwrap();
    assert_eq!(read.time, [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]);
    assert_eq!(read.run, [1, 1, 2, 2, 3, 3]);
    assert_eq!(read.axes[0].command.as_deref().unwrap(), [0.0, 100.0, 0.0, 100.0, 0.0, 100.0]);
    assert_eq!(read.temperatures[0].values, [20.0, 21.0, 20.0, 21.0, 20.0, 21.0]);
    let deviation = read.deviation.unwrap();
    assert_eq!(deviation[..3], [0.001, 0.004, 0.002]);
    assert!(deviation[3].is_nan());
    assert_eq!(deviation[4..], [0.003, 0.006]);
}

#[test]
fn the_way_back_runs_up_the_table() {
    let text = ONE_WAY.replace("run 3]", "run 3], back: [down 1, down 2, down 3]");
    let read = recording(&text, TABLE).unwrap();
    assert_eq!(read.run, [1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]);
    assert_eq!(
        read.axes[0].command.as_deref().unwrap()[..8],
        [0.0, 100.0, 100.0, 0.0, 0.0, 100.0, 100.0, 0.0]
    );
    let deviation = read.deviation.unwrap();
    assert_eq!(deviation[..5], [0.001, 0.004, -0.004, -0.001, 0.002]);
    assert_eq!(deviation[8..], [0.003, 0.006, -0.006, -0.003]);
    assert_eq!(read.time[11], 110.0);
    // Runs are held out by their numbers, without a channel that tells them.
    assert_eq!(recording(&format!("{text}holdout: {{runs: [3]}}\n"), TABLE).unwrap().holdout, Some(vec![3]));
    assert!(recording(&format!("{text}holdout: {{runs: [4]}}\n"), TABLE).is_err());
}

#[test]
fn mistakes() {
    let error = recording(ONE_WAY, &TABLE.replace(",6,", ",z,")).unwrap_err().to_string();
    assert!(error.contains("data.csv:3:11: channel `deviation`: `z` is not a number"), "{error}");
    let error = recording(ONE_WAY, &TABLE.replace("run 2", "run two")).unwrap_err().to_string();
    assert!(error.contains("no column `run 2` (channel `deviation`)"), "{error}");
    let empty = "target,T,run 1,run 2,run 3\n0,20,,,\n";
    let error = recording(ONE_WAY, empty).unwrap_err().to_string();
    assert!(error.contains("column `run 1`, `run 2`, `run 3` (channel `deviation`) is empty"), "{error}");
}

#[test]
fn what_the_recording_file_says_wrongly() {
    for (from, to, code, marked) in [
        ("{every: 10 s}", "{column: t, unit: s}", "E0629", "time"),
        ("{every: 10 s}", "{columns: [a, b, c], unit: s}", "E0603", "columns"),
        ("channels:\n", "channels:\n  run: {column: n}\n", "E0629", "run"),
        ("run 3]", "run 3], back: [down 1]", "E0629", "back"),
        ("run 3]", "run 3], column: a", "E0629", "column"),
        ("columns: [run 1, run 2, run 3]", "columns: []", "E0604", "[]"),
        ("columns: [run 1, run 2, run 3]", "column: a, back: [b]", "E0629", "back"),
        ("{column: T,", "{columns: [T1, T2],", "E0629", "deviation"),
    ] {
        let text = ONE_WAY.replace(from, to);
        let (_, found) = read(&text);
        let found: Vec<_> = found.iter().map(|(one, marked)| (one.code, marked.as_str())).collect();
        assert!(found.contains(&(code, marked)), "{found:?} has no {code} at {marked} in\n{text}");
    }
}
