//! Tables that other programs wrote, in `written/`, by `written/make.py`; what they hold is worked out here anew.

use std::path::PathBuf;

use abbe_recording::{DataError, Place, Recording};

use crate::common::{book_of, header};

/// The recording file for a table; `data` is its value of `data`, `channels` are those besides the run.
fn text(data: &str, channels: &str) -> String {
    format!(
        "recording: 1\nmachine: FX\ninstrument: position\ndata: {data}\nchannels: {{run: {{column: n}}, {channels}}}\n"
    )
}

fn path(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/recording/written").join(name)
}

fn read(name: &str, data: &str, channels: &str) -> Result<Recording, DataError> {
    header(&text(data, channels)).read_data(&path(name))
}

/// A table and its channels: the time, and x in mm.
fn holds(name: &str, data: &str, channels: &str) {
    holds_within(1e-12, name, data, channels);
}

/// The same with times that are as exact as so many seconds.
fn holds_within(exact: f64, name: &str, data: &str, channels: &str) {
    let read = read(name, data, channels).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.time.len(), 40, "{name}");
    for (row, time) in read.time.iter().enumerate() {
        let expected = 0.05 * row as f64;
        assert!((time - expected).abs() < exact, "{name}: row {row} at {time}, not at {expected}");
        assert_eq!(read.run[row], if row < 20 { 1 } else { 2 }, "{name}");
        let x = read.measured[0].as_deref().unwrap()[row];
        if row == 7 {
            assert!(x.is_nan(), "{name}: {x}");
        } else {
            assert!((x - 0.25 * row as f64).abs() < 1e-12, "{name}: row {row} has {x}");
        }
    }
}

const X: &str = "measured.x: {column: x, unit: mm}";

fn with_x(time: &str) -> String {
    format!("time: {time}, {X}")
}

#[test]
fn parquet_in_every_packing() {
    for packing in ["zstd", "snappy", "gzip", "lz4", "uncompressed"] {
        let name = format!("polars-{packing}.parquet");
        holds(&name, "x.parquet", &with_x("{column: t, unit: s}"));
        holds(&name, "x.parquet", &with_x("{column: when, unit: date}"));
    }
}

/// A packing that is not built in is told with those that are.
#[test]
fn parquet_packed_otherwise() {
    let error = read("pyarrow-brotli.parquet", "x", &with_x("{column: t, unit: s}")).unwrap_err().to_string();
    assert!(error.contains("brotli") && error.contains("write it with zstd, snappy, gzip or lz4"), "{error}");
}

#[test]
fn parquet_of_other_writers() {
    for name in ["pyarrow-pages-2.parquet", "pyarrow-int96.parquet", "duckdb.parquet", "fastparquet.parquet"]
    {
        holds(name, "x.parquet", &with_x("{column: t, unit: s}"));
        holds(name, "x.parquet", &with_x("{column: when, unit: date}"));
    }
    // Nineteen digits, of which none is lost: 0.05 s are to come out to the last place.
    for name in ["pyarrow-pages-2.parquet", "duckdb.parquet"] {
        holds(name, "x.parquet", &with_x("{column: ns, unit: ns}"));
        holds(name, "x.parquet", &with_x("{column: ns, unit: 0.001 us}"));
    }
}

#[test]
fn parquet_that_is_told_wrongly() {
    for (data, time, x, parts) in [
        ("x", "{column: when, unit: s}", X, ["column `when` contains dates", "`unit: date`"]),
        ("x", "{column: t, unit: date}", X, ["column `t` contains no dates", "`unit: s`"]),
        (
            "x",
            "{column: t, unit: s}",
            "measured.x: {column: when, unit: mm}",
            ["`when` contains dates", "only times"],
        ),
        (
            "x",
            "{column: t, unit: s}",
            "measured.x: {column: y, unit: mm}",
            ["no column `y`", "when, t, n, x"],
        ),
        ("{file: x, sheet: a}", "{column: t, unit: s}", X, ["`sheet` has no meaning", "remove `sheet`"]),
        (
            "{file: x, decimal: \",\"}",
            "{column: t, unit: s}",
            X,
            ["`decimal` has no meaning", "remove `decimal`"],
        ),
        (
            "{file: x, header: none}",
            "{column: t, unit: s}",
            X,
            ["`header` has no meaning", "remove `header`"],
        ),
    ] {
        let error = read("polars-zstd.parquet", data, &format!("time: {time}, {x}")).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn workbooks() {
    let data = "{file: x, sheet: run}";
    // Dates are numbers of days there, in floating point: one and a half microseconds between two of them.
    holds_within(1.5e-6, "openpyxl.xlsx", data, &with_x("{column: when, unit: date}"));
    holds("openpyxl.xlsx", data, &with_x("{column: t, unit: s}"));
    // XlsxWriter rounds them to milliseconds.
    holds_within(
        1.5e-3,
        "xlsxwriter.xlsx",
        "{file: x, header: 5}",
        &with_x("{column: [date, time], unit: date}"),
    );
}

#[test]
fn workbooks_that_are_told_wrongly() {
    let time = "time: {column: t, unit: s}";
    for (data, channels, parts) in [
        ("x", format!("{time}, {X}"), ["openpyxl.xlsx, cell D2: column `x`", "`none` is not a number"]),
        ("{file: x, sheet: rum}", format!("{time}, {X}"), ["no sheet `rum`", "notes, run"]),
        (
            "{file: x, sheet: run}",
            format!("{time}, measured.x: {{column: x, unit: um}}"),
            ["is in `mm` here and in `um`", "the same unit in both"],
        ),
        ("{file: x, sheet: run}", with_x("{column: when, unit: s}"), ["cell A2", "is a date, not a number"]),
        (
            "{file: x, sheet: run}",
            with_x("{column: t, unit: date}"),
            ["cell B2", "`0` is a number, not a date"],
        ),
        (
            "{file: x, sheet: run, separator: tab}",
            format!("{time}, {X}"),
            ["`separator` has no meaning", "remove"],
        ),
        ("{file: x, sheet: run, header: 99}", format!("{time}, {X}"), ["no row of column names", "sheet"]),
    ] {
        let error = read("openpyxl.xlsx", data, &channels).unwrap_err().to_string();
        assert!(parts.iter().all(|part| error.contains(part)), "{error}");
    }
}

#[test]
fn texts() {
    let comma = "{file: x, decimal: \",\"}";
    holds("comma.csv", comma, &with_x("{column: t, unit: s}"));
    holds("comma.csv", comma, &with_x("{column: when, unit: date}"));
    holds("tabs.txt", "x", &with_x("{column: t, unit: s}"));
    holds("tabs.txt", "x", &with_x("{column: [date, time], unit: date}"));
    holds("counts.csv", "x", "time: {column: when, unit: date}, measured.x: {column: x, unit: 0.5 um}");
    let error = read("comma.csv", "x", &with_x("{column: t, unit: s}")).unwrap_err().to_string();
    assert!(error.contains("comma.csv:2:28: column `t`") && error.contains("decimal: \",\""), "{error}");
}

/// numpy.savetxt writes no names; what is missing stands as 0 there.
#[test]
fn columns_by_number() {
    let text =
        "recording: 1\nmachine: FX\ninstrument: position\ndata: {file: x, separator: spaces, header: none}
channels: {time: {column: 1, unit: 50 ms}, run: {column: 2}, measured.x: {column: 3, unit: mm}}\n";
    let read = header(text).read_data(&path("savetxt.txt")).unwrap();
    assert_eq!((read.time.len(), read.run[19], read.run[20]), (40, 1, 2));
    assert!((read.time[39] - 1.95).abs() < 1e-12);
    assert_eq!(read.measured[0].as_deref().unwrap()[38..], [9.5, 9.75]);
}

/// What is said shows no byte of the file, and a way to a table.
#[test]
fn other_formats_are_named() {
    for (name, what, way) in [
        ("h5py.h5", "an HDF5 file", "h5py.File"),
        ("scipy.mat", "a MAT file", "scipy.io.loadmat"),
        ("nptdms.tdms", "a TDMS file", "nptdms.TdmsFile.read"),
        ("asammdf.mf4", "an MDF file", "asammdf.MDF"),
    ] {
        let error = read(name, "x", &with_x("{column: t, unit: s}")).unwrap_err();
        let shown = error.to_string();
        assert!(shown.contains(&format!("{name}: it is {what}, which Abbe does not read")), "{shown}");
        assert!(error.help.unwrap().contains(way) && shown.contains("to_parquet"), "{shown}");
        assert!(shown.chars().all(|letter| letter == '\n' || !letter.is_control()), "{shown:?}");
    }
}

/// `openpyxl-clock.xlsx`: a row of units, in which x is in um; a row without a time of day; a duration of 30 hours and some seconds.
fn clock(time: &str, unit: &str) -> Result<Recording, DataError> {
    let channels = format!("time: {time}, measured.x: {{column: x, unit: {unit}}}");
    let text = text("clock.xlsx", &channels).replace("run: {column: n}, ", "");
    header(&text).read_data(&path("openpyxl-clock.xlsx"))
}

#[test]
fn a_sheet_with_units_is_held_to_them() {
    let read = clock("{column: ran, unit: date}", "um").unwrap();
    // A sheet holds days, of which a number in floating point is exact to 2e-11 s.
    let mut seconds = read.time.iter().zip([0.0, 1.0, 2.0]);
    assert!(seconds.all(|(time, second)| (time - second).abs() < 1e-10), "{:?}", read.time);
    assert!((read.measured[0].as_deref().unwrap()[2] - 0.5e-3).abs() < 1e-15);
    let error = clock("{column: ran, unit: date}", "mm").unwrap_err();
    assert_eq!(error.place, Some(Place::Cell { row: 2, column: 5 }));
    assert!(error.message.contains("`um` here and in `mm`"), "{}", error.message);
}

/// A comment may stand above the row of units, and its mark may be written otherwise; at another place it is told.
#[test]
fn units_of_a_sheet_are_read_however_they_are_marked() {
    let channels = "time: {column: ran, unit: date}, measured.x: {column: x, unit: mm}";
    let text = text("clock.xlsx", channels).replace("run: {column: n}, ", "");
    let error = |new: &dyn Fn(String) -> String| {
        let bytes =
            book_of("openpyxl-clock.xlsx", "xl/worksheets/sheet1.xml", |sheet| new(sheet).into_bytes());
        header(&text).read_bytes("clock.xlsx", bytes).unwrap_err()
    };
    for mark in ["# unit", "#Units", "# UNITS:"] {
        let error = error(&|sheet| sheet.replace("#unit", mark));
        assert_eq!(error.place, Some(Place::Cell { row: 2, column: 5 }), "{mark}: {error}");
        assert!(error.message.contains("`um` here and in `mm`"), "{mark}: {error}");
    }
    let row = |sheet: &str, number: u32| {
        let begin = sheet.find(&format!("<row r=\"{number}\"")).unwrap();
        let end = begin + sheet[begin..].find("</row>").unwrap() + "</row>".len();
        (sheet[..begin].to_owned(), sheet[begin..end].to_owned(), sheet[end..].to_owned())
    };
    // The row of units below the first row of numbers.
    let late = error(&|sheet| {
        let (before, units, rest) = row(&sheet, 2);
        let (numbers, first, rest) = row(&rest, 3);
        let moved = units.replace("r=\"2\"", "r=\"3\"").replace("A2", "A3").replace("E2", "E3");
        let first = first.replace("r=\"3\"", "r=\"2\"");
        let first = ["A", "B", "C", "D"]
            .iter()
            .fold(first, |row, letter| row.replace(&format!("{letter}3\""), &format!("{letter}2\"")));
        before + &numbers + &first + &moved + &rest
    });
    assert_eq!(late.place, Some(Place::Cell { row: 3, column: 1 }), "{late}");
    assert!(late.message.contains("does not stand below the names"), "{late}");
}

#[test]
fn a_date_without_its_time_of_day_is_none() {
    let error = clock("{column: [day, clock], unit: date}", "um").unwrap_err();
    assert_eq!(error.place, Some(Place::Cell { row: 4, column: 1 }), "{error}");
}

/// `halsampler.txt` is by LinuxCNC's `halsampler -t` of a generator: a sine of 5 Hz and 2.5 about zero, and the sawtooth of the same, once
/// a millisecond. The first sample has the number 0 and is that of 1 ms.
#[test]
fn samples_of_a_hal() {
    let file = "recording: 1\nmachine: FX\ninstrument: position\n\
                data: {file: d, separator: spaces, header: none}\n\
                channels: {time: {column: 1, unit: ms}, command.x: {column: 3, unit: mm}, measured.x: {column: 2, unit: mm}}\n";
    let read = header(file).read_data(&path("halsampler.txt")).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.time.len(), 40);
    let (sine, sawtooth) = (read.measured[0].as_deref().unwrap(), read.axes[0].command.as_deref().unwrap());
    for (row, time) in read.time.iter().enumerate() {
        assert!((time - 1e-3 * row as f64).abs() < 1e-12, "row {row} at {time}");
        let turns = 5.0 * (time + 1e-3);
        // Six places are written.
        assert!((sine[row] - 2.5 * (std::f64::consts::TAU * turns).sin()).abs() < 1e-6, "row {row}");
        assert!((sawtooth[row] - (5.0 * turns - 2.5)).abs() < 1e-6, "row {row}");
    }
}

/// `xlsxwriter.xlsx` has titles in its first rows; in `openpyxl.xlsx` nothing stands above the names.
#[test]
fn names_in_a_sheet_stand_above_its_numbers() {
    for (file, first, line) in [("xlsxwriter.xlsx", "date", Some(5)), ("openpyxl.xlsx", "when", None)] {
        let names = abbe_recording::column_names(&path(file)).unwrap().unwrap();
        assert_eq!((names.names[0].as_str(), names.line), (first, line), "{file}");
    }
    let names = abbe_recording::column_names(&path("openpyxl-clock.xlsx")).unwrap().unwrap();
    assert_eq!((names.units[3].as_str(), names.dates), ("um", vec![true, true, true, false]));
}
