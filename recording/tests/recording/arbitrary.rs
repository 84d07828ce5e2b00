//! Whatever the files hold, they are read or refused, and what is read keeps the promises of its type.

use abbe_recording::Recording;
use proptest::prelude::*;

use crate::common::{header, packed, read};

const TEXT: &str = "recording: 1
machine: XYFZ
instrument: probe
data: data.csv
channels:
  time: {column: t, unit: min}
  run: {column: n}
  command.x: {column: x, unit: in}
  deviation: {column: d, unit: um}
  normal.x: {column: i}
  normal.y: {column: j}
  normal.z: {column: k}
  temperature.a: {column: T, unit: degF}
";

fn promises(read: &Recording) {
    let rows = read.time.len();
    assert!(rows > 0 && read.run.len() == rows);
    assert_eq!(read.time[0], 0.0);
    assert!(read.time.windows(2).all(|pair| pair[0] < pair[1]));
    let normals = read.normal.as_ref().unwrap();
    let columns = [read.axes[0].command.as_ref().unwrap(), read.deviation.as_ref().unwrap()];
    for column in columns.into_iter().chain(normals).chain([&read.temperatures[0].values]) {
        assert_eq!(column.len(), rows);
        assert!(column.iter().all(|value| !value.is_infinite()));
    }
    for row in 0..rows {
        let length: f64 = normals.iter().map(|normal| normal[row] * normal[row]).sum();
        assert!(length.is_nan() || (length - 1.0).abs() < 1e-9, "{length}");
    }
}

/// A piece of a table, right or wrong.
fn piece() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => (-50i32..50).prop_map(|number| number.to_string()),
        4 => Just(",".to_owned()),
        2 => any::<f64>().prop_map(|number| number.to_string()),
        2 => Just("\n".to_owned()),
        1 => prop::sample::select(vec!["", "nan", "inf", "null", "\"", "#", "#unit", ";", "\t", "\r\n", "1,5", "t", "-", "e9"])
            .prop_map(str::to_owned),
    ]
}

proptest! {
    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let header = header(TEXT);
        let _ = header.read_csv("data.csv", bytes.as_slice());
        let _ = header.read_csv("data.csv.gz", [&[0x1f, 0x8b][..], &bytes].concat().as_slice());
        let under = [b"t,n,x,d,i,j,k,T\n", bytes.as_slice()].concat();
        let _ = header.read_csv("data.csv", under.as_slice());
        if let Ok(read) = header.read_csv("data.csv.gz", packed(&under).as_slice()) {
            promises(&read);
        }
    }

    #[test]
    fn any_table(rows in prop::collection::vec(prop::collection::vec(piece(), 8), 0..12), start in any::<f64>()) {
        let header = header(TEXT);
        let mut text = "t,n,x,d,i,j,k,T\n".to_owned();
        for (number, row) in rows.iter().enumerate() {
            let row = row.join(",");
            text.push_str(&format!("{},1,{row}\n", start + number as f64));
        }
        if let Ok(read) = header.read_csv("data.csv", text.as_bytes()) {
            promises(&read);
        }
    }

    /// Rows of numbers are read whatever the numbers are, unless a normal has no direction.
    #[test]
    fn numbers_come_back(cells in prop::collection::vec(prop::collection::vec(-1e6..1e6f64, 6), 1..20)) {
        let mut text = "t,n,x,d,i,j,k,T\n".to_owned();
        for (number, row) in cells.iter().enumerate() {
            let row: Vec<String> = row.iter().map(f64::to_string).collect();
            text.push_str(&format!("{number},3,{}\n", row.join(",")));
        }
        let read = header(TEXT).read_csv("data.csv", text.as_bytes()).unwrap();
        promises(&read);
        for (row, cells) in cells.iter().enumerate() {
            prop_assert_eq!(read.axes[0].command.as_ref().unwrap()[row], cells[0] * 25.4);
            prop_assert_eq!(read.deviation.as_ref().unwrap()[row], cells[1] * 1e-3);
        }
    }

    #[test]
    fn any_recording_file(text in "\\PC{0,200}", line in 0usize..14, with in "[ a-zA-Z0-9.:{}\\[\\],-]{0,30}") {
        let _ = read(&text);
        let _ = read(&format!("recording: 1\nmachine: XYFZ\n{text}"));
        let lines = TEXT.lines().enumerate();
        let lines: Vec<&str> = lines.map(|(at, old)| if at == line { with.as_str() } else { old }).collect();
        let _ = read(&lines.join("\n"));
    }
}
