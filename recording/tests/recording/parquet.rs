//! Tables in Parquet, written by the library's own writer.

use std::fs::File;
use std::path::PathBuf;
use std::sync::Arc;

use parquet::data_type::{DoubleType, FloatType, Int64Type};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use crate::common::header;

const TEXT: &str = "recording: 1
machine: FX
instrument: position
data: data.parquet
channels:
  time: {column: t, unit: ms}
  run: {column: n}
  measured.x: {column: x, unit: in}
";

/// Two groups of rows; `x` is missing where it is NaN.
fn write(name: &str, groups: &[(&[f64], &[i64], &[f32])]) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let schema = "message table { required double t; required int64 n; optional float x; optional binary word (UTF8); }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut writer = SerializedFileWriter::new(File::create(&path).unwrap(), schema, Arc::default()).unwrap();
    for (time, run, x) in groups {
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(time, None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(run, None, None).unwrap();
        column.close().unwrap();
        let levels: Vec<i16> = x.iter().map(|value| i16::from(!value.is_nan())).collect();
        let there: Vec<f32> = x.iter().copied().filter(|value| !value.is_nan()).collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<FloatType>().write_batch(&there, Some(&levels), None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let none = vec![0; x.len()];
        column.typed::<parquet::data_type::ByteArrayType>().write_batch(&[], Some(&none), None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
    }
    writer.close().unwrap();
    path
}

#[test]
fn columns_come_back() {
    let path = write(
        "good.parquet",
        &[(&[5.0, 6.0, 9.0], &[1, 1, 1], &[1.0, f32::NAN, -2.0]), (&[10.0, 11.0], &[1, 2], &[f32::NAN, 0.5])],
    );
    let read = header(TEXT).read_data(&path).unwrap();
    assert_eq!(read.time, [0.0, 0.001, 0.004, 0.005, 0.006]);
    assert_eq!(read.run, [1, 1, 1, 1, 2]);
    let x = read.measured[0].as_deref().unwrap();
    assert!(x[1].is_nan() && x[3].is_nan());
    assert_eq!([x[0], x[2], x[4]], [25.4, -50.8, 12.7]);
}

#[test]
fn mistakes_name_the_row() {
    let path = write("back.parquet", &[(&[5.0], &[1], &[1.0]), (&[6.0, 5.5], &[1, 1], &[1.0, 1.0])]);
    let error = header(TEXT).read_data(&path).unwrap_err().to_string();
    assert!(
        error.contains("back.parquet, row 3: column `t`") && error.contains("`5.5` comes after `6`"),
        "{error}"
    );
    let text = TEXT.replace("column: x", "column: word");
    let error = header(&text).read_data(&path).unwrap_err().to_string();
    assert!(error.contains("column `word` holds text"), "{error}");
    let text = TEXT.replace("column: x", "column: y");
    let error = header(&text).read_data(&path).unwrap_err().to_string();
    assert!(error.contains("no column `y`") && error.contains("t, n, x, word"), "{error}");
    std::fs::write(&path, b"PAR1 and nothing else").unwrap();
    let error = header(TEXT).read_data(&path).unwrap_err().to_string();
    assert!(error.contains("cannot be read"), "{error}");
}
