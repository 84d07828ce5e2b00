//! Tables of data that are not read: where, why, and what to write instead.

use abbe_recording::Place;
use model_dsl::source::Span;

use crate::common::{header, packed, read, recording};

const TEXT: &str = "recording: 1
machine: FX
instrument: position
data: data.csv
channels:
  time: {column: t_s, unit: s}
  run: {column: run}
  command.x: {column: x_cmd, unit: mm}
  measured.x: {column: x_meas, unit: mm}
";

const HEADER: &str = "t_s,run,x_cmd,x_meas\n";

/// Expects an error: the beginning of what is shown, and parts of the whole.
fn refused(data: &str, begins: &str, parts: &[&str]) {
    let error = recording(TEXT, data).unwrap_err();
    let shown = error.to_string();
    assert!(shown.starts_with(&format!("error: {begins}")), "{shown}\nis not\n{begins}");
    for part in parts {
        assert!(shown.contains(part), "{shown}\nlacks {part:?}");
    }
}

/// The same under the right header.
fn row(rows: &str, begins: &str, parts: &[&str]) {
    refused(&format!("{HEADER}{rows}"), begins, parts);
}

#[test]
fn headers() {
    refused("", "data.csv: the file is empty", &["row of column names"]);
    refused("\n\n# only this\n", "data.csv: the file is empty", &[]);
    refused(
        "t_s,run,x_comd,x_meas\n0,1,2,3\n",
        "data.csv:1:1: there is no column `x_cmd` (channel `command.x`)",
        &["did you mean `x_comd`?", "the columns are t_s, run, x_comd, x_meas"],
    );
    refused(
        "t,n,a,b\n",
        "data.csv:1:1: there are no columns `t_s` (channel `time`), `run`",
        &["the columns are t, n, a, b"],
    );
    refused(
        "# made by hand\nt_s,run,x_cmd,x_meas,x_cmd\n",
        "data.csv:2:22: column `x_cmd` occurs twice",
        &["its own name"],
    );
    refused("0,1,2,3\n", "data.csv:1:1: the first row has numbers", &["`t_s,run,x_cmd,x_meas`"]);
    refused(
        "# t_s,run,x_cmd,x_meas\n0,1,2,3\n",
        "data.csv:2:1: the first row has numbers",
        &["remove the `#`"],
    );
    let sixteen: Vec<u8> = "\u{feff}t_s,run\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let error = header(TEXT).read_bytes("data.csv", sixteen).unwrap_err().to_string();
    assert!(error.contains("it is text in UTF-16") && error.contains("as CSV in UTF-8"), "{error}");
    refused("\u{0}t_s,run\n", "data.csv:1:1: the file is not plain text", &["UTF-8"]);
    refused(
        "t_s;run,x_cmd\n",
        "data.csv:1:1: the names are separated by commas and semicolons",
        &["with commas"],
    );
}

#[test]
fn units_that_disagree() {
    row(
        "#unit,s,,mm,um\n0,1,2,3\n",
        "data.csv:2:13: column `x_meas` is in `um` here and in `mm`",
        &["same unit in both"],
    );
    row("#unit,s\n0,1,2,3\n", "data.csv:2:1: the row of units has 1 unit for 4 columns", &[]);
    row("0\n", "data.csv:2:2: the row has 1 cell, but the header has 4", &[]);
    row(
        "#unit,s,,mm\n0,1,2,3\n",
        "data.csv:2:1: the row of units has 3 units for 4 columns",
        &["one unit for each"],
    );
}

/// Without the row of units the numbers would be taken for those of the recording file: wrong by 25.4.
#[test]
fn units_are_read_however_they_are_marked() {
    let inches = "data.csv:";
    let told = "column `x_meas` is in `in` here and in `mm`";
    for (rows, place) in [
        ("#unit,s,,mm,in\n", "2:13"),
        ("# unit,s,,mm,in\n", "2:14"),
        ("#Unit,s,,mm,in\n", "2:13"),
        ("#UNITS,s,,mm,in\n", "2:14"),
        ("# units: s,,mm,in\n", "2:16"),
        ("\"#unit\",s,,mm,in\n", "2:15"),
        ("# laser of 12 May\n\n#unit,s,,mm,in\n", "4:13"),
    ] {
        row(&format!("{rows}0,1,2,3\n"), &format!("{inches}{place}: {told}"), &["same unit in both"]);
    }
    let nameless = TEXT.replace("data: data.csv", "data: {file: data.csv, header: none}");
    let nameless = ["t_s", "run}", "x_cmd", "x_meas"]
        .iter()
        .zip(["1", "2}", "3", "4"])
        .fold(nameless, |text, (name, number)| {
            text.replacen(&format!("column: {name}"), &format!("column: {number}"), 1)
        });
    let error = recording(&nameless, "#unit,s,,mm,in\n0,1,2,3\n").unwrap_err().to_string();
    assert!(error.contains(":1:13: column `4` is in `in` here and in `mm`"), "{error}");
}

#[test]
fn units_stand_below_the_names_and_nowhere_else() {
    let above = "data.csv:1:1: the row of units stands above the names of the columns";
    for mark in ["#unit", "# Units", "#  unit"] {
        refused(
            &format!("{mark},s,,mm,mm\n{HEADER}0,1,2,3\n"),
            above,
            &["write the names first, then `#unit`"],
        );
    }
    let below_titles = TEXT.replace("data: data.csv", "data: {file: data.csv, header: 3}");
    let error = recording(&below_titles, &format!("a title\n#unit,s,,mm,mm\n{HEADER}0,1,2,3\n")).unwrap_err();
    assert_eq!(error.place, Some(Place::Character { line: 2, column: 1 }), "{error}");
    row(
        "0,1,2,3\n# unit,s,,mm,in\n1,1,2,3\n",
        "data.csv:3:1: a row of units stands below rows of numbers",
        &["directly below the names"],
    );
    // Comments about units are comments.
    let comments = "# Units: mm\n# unit test, second try\n";
    let text = format!("{comments}{HEADER}# units are mm\n0,1,2,3\n# Units\n1,1,2,3\n");
    assert!(recording(TEXT, &text.replace(", second try", "")).is_ok());
}

#[test]
fn a_unit_behind_a_name_is_marked_where_it_stands() {
    refused(
        "t_s,run,x_cmd [in],x_meas\n0,1,2,3\n",
        "data.csv:1:9: column `x_cmd [in]` is in `in` here and in `mm`",
        &["same unit in both"],
    );
}

#[test]
fn excels_line_tells_the_separator() {
    let rows = "t_s;run;x_cmd;x_meas\n0;1;2;3\n1;1;2;4\n";
    for line in ["sep=;\n", "\u{feff}sep=;\r\n", "\"sep=;\"\n"] {
        let read = recording(TEXT, &format!("{line}{rows}")).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(read.measured[0].as_deref(), Some(&[3.0, 4.0][..]), "{line}");
    }
    let error = recording(TEXT, &format!("sep=;\n{}", rows.replace("2;4", "2;z"))).unwrap_err();
    assert_eq!(error.place, Some(Place::Character { line: 4, column: 7 }), "{error}");
}

#[test]
fn cells() {
    row(
        "0,1,2,3\n1,1,abc,3\n",
        "data.csv:3:5: column `x_cmd` (channel `command.x`): `abc` is not a number",
        &["cell empty"],
    );
    row("# one\r\n\r\n0,1,2,3\r\n1,1, 2, x\r\n", "data.csv:5:9: column `x_meas`", &["`x` is not a number"]);
    row("0,1,2,inf\n", "data.csv:2:7: column `x_meas`", &["`inf` is not a finite number"]);
    row("0,1,2,1e999\n", "data.csv:2:7: column `x_meas`", &["`1e999` is not a finite number"]);
    row("0,1,2,\u{2212}3\n", "data.csv:2:7: column `x_meas`", &["minus sign as `-`"]);
    row("0,1,\"2,5\",3\n", "data.csv:2:5: column `x_cmd`", &["`2,5` has a decimal comma", "`2.5`"]);
    refused(
        "t_s;run;x_cmd;x_meas\n0;1;2;3,25\n",
        "data.csv:2:7: column `x_meas`",
        &["`3,25` has a decimal comma", "`3.25`"],
    );
    // Characters are counted, not bytes.
    refused(
        "t_s,run,x_cmd,x_meas,\u{b5}\n0,1,2,3,4\n1,1,2,3,\n2,1,\u{b5}\u{b5},z,\n",
        "data.csv:4:5",
        &["`\u{b5}\u{b5}`"],
    );
    refused("\u{b5},t_s,run,x_cmd,x_meas\n\u{b5}\u{b5},0,1,2,z\n", "data.csv:2:10", &["`z` is not a number"]);
}

#[test]
fn rows() {
    row("", "data.csv: there is no row below the header", &[]);
    row(
        "0,1,2,3\n1,1,2\n",
        "data.csv:3:6: the row has 3 cells, but the header has 4: `1,1,2`",
        &["empty if nothing"],
    );
    row(
        "0,1,2,3,4\n",
        "data.csv:2:9: the row has 5 cells, but the header has 4",
        &["one cell for each column", "a decimal comma splits a number"],
    );
    row("0,1,1,2,5,3,5\n", "data.csv:2:9: the row has 7 cells", &["decimal commas"]);
    row(
        "0,1,2,\n1,1,2,nan\n",
        "data.csv: column `x_meas` (channel `measured.x`) is empty",
        &["remove the channel"],
    );
}

#[test]
fn times() {
    row(
        "0,1,2,3\n,1,2,3\n",
        "data.csv:3:1: column `t_s` (channel `time`): the row has no time",
        &["every row"],
    );
    row("0,1,2,3\n0,1,2,3\n", "data.csv:3:1: column `t_s`", &["`0` follows `0`", "more decimal places"]);
    let both = TEXT.replace("column: run", "column: t_s");
    // The shared column has a warning of its own.
    let data = format!("{HEADER}1,1,2,3\n1,1,2,3\n");
    let error = read(&both).0.unwrap().read_csv("data.csv", data.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("`time` and `run`") && !error.contains("decimal places"), "{error}");
    row("0,1,2,3\n5,1,2,3\n4,1,2,3\n", "data.csv:4:1: column `t_s`", &["`4` follows `5`", "channel `run`"]);
    row("0,1,2,3\n1,2,2,3\n0.5,1,2,3\n", "data.csv:4:1", &["run 1 also has rows further up"]);
    row("0,1,2,3\n1,2,2,3\n0.5,2,2,3\n", "data.csv:4:1", &["`0.5` follows `1`"]);
    row("-1e308,1,2,3\n1e308,1,2,3\n", "data.csv:3:1", &[]);
}

#[test]
fn runs() {
    row(
        "0,1.5,2,3\n",
        "data.csv:2:3: column `run` (channel `run`): `1.5` is not a whole number",
        &["1, 2, 3"],
    );
    row("0,one,2,3\n", "data.csv:2:3: column `run`", &["`one` is not a whole number"]);
    row("0,,2,3\n", "data.csv:2:3: column `run`", &["the row has no run"]);
    let held = format!("{TEXT}holdout: {{runs: [3]}}\n");
    let error = recording(&held, &format!("{HEADER}0,1,2,3\n1,2,2,3\n")).unwrap_err();
    assert_eq!(error.place, None);
    assert!(error.message.contains("run 3") && error.help.unwrap().contains("1, 2"));
    let marked = |error: Option<Box<(&'static str, Span)>>| {
        error.map(|place| (place.0, &held[place.1.start..place.1.end]))
    };
    assert_eq!(marked(error.recording), Some(("E0620", "3")));
    let error = recording(&held, &format!("{HEADER}0,3,2,3\n")).unwrap_err();
    assert!(error.message.contains("all runs are held out"));
    assert_eq!(marked(error.recording), Some(("E0620", "3")));
}

#[test]
fn what_the_recording_file_says_wrongly_of_a_table_is_marked_there() {
    let text = TEXT.replace("data: data.csv", "data: {file: data.csv, sheet: Data}");
    let error = recording(&text, &format!("{HEADER}0,1,2,3\n")).unwrap_err();
    let (code, span) = *error.recording.unwrap();
    assert_eq!((code, &text[span.start..span.end]), ("E0630", "sheet"));
    let text = TEXT.replace("data: data.csv", "data: {file: data.csv, decimal: \",\"}");
    let error = recording(&text, &format!("{HEADER}0,1,2,3\n")).unwrap_err().to_string();
    assert!(error.contains("data.csv:1:1: commas stand between the names"), "{error}");
    assert!(error.contains("remove `decimal`") && error.contains("semicolons or tabs"), "{error}");
}

#[test]
fn places_are_data_too() {
    let error = recording(TEXT, &format!("{HEADER}0,1,2,x\n")).unwrap_err();
    assert_eq!(error.place, Some(Place::Character { line: 2, column: 7 }));
    assert_eq!(error.file, "data.csv");
}

#[test]
fn broken_files() {
    let whole = packed(format!("{HEADER}{}", "0,1,2,3\n").as_bytes());
    let cut = &whole[..whole.len() - 6];
    let error = header(TEXT).read_csv("data.csv.gz", cut).unwrap_err();
    assert!(error.to_string().contains("cannot be read"), "{error}");
    let error = header(TEXT).read_csv("data", &b"PAR1\x15\x04"[..]).unwrap_err();
    assert!(error.to_string().contains("give the name of the file"), "{error}");
    // A line without an end costs a bounded amount of memory.
    let error = header(TEXT).read_csv("zeros", std::io::repeat(b'0')).unwrap_err();
    assert!(error.to_string().starts_with("error: zeros:1:1: the line is longer than 1 MiB"), "{error}");
}
