//! The formats: what is read of them, and what is wrong with broken ones, with its code and place.

use super::super::{Flagged, Sense};
use super::{read, rtl, table, told};
use model_dsl::diagnostic::Severity;

const TARGETS: [f64; 4] = [0.0, 50.0, 100.0, 150.0];

fn runs() -> Vec<(bool, Vec<f64>)> {
    vec![(true, vec![0.1, 0.2, 0.3, 0.4]), (false, vec![1.1, 1.2, 1.3, 1.4])]
}

#[test]
fn a_linear_measurement_is_read_whole() {
    let (measured, found) = read(rtl(&TARGETS, &runs()));
    let measured = measured.unwrap();
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(measured.targets, TARGETS);
    assert_eq!(measured.flagged, Some(Flagged::BothWays));
    assert_eq!(measured.target_unit.unwrap().factor, 1.0);
    assert_eq!(measured.deviation_unit.unwrap().factor, 1e-3);
    assert_eq!(measured.about[1], ("Date".to_owned(), "2026-05-01 10:00:00".to_owned()));
    let listed: Vec<_> = measured.runs.iter().map(|run| run.listed(&measured.targets)).collect();
    assert_eq!(listed, [Some(Sense::Ascending), Some(Sense::Descending)]);
    let second: Vec<(usize, f64)> =
        measured.runs[1].readings.iter().map(|one| (one.target, one.deviation)).collect();
    assert_eq!(second, [(3, 1.4), (2, 1.3), (1, 1.2), (0, 1.1)]);
}

#[test]
fn sections_may_come_in_any_order_and_lines_end_in_either_way() {
    let text = rtl(&TARGETS, &runs()).replace("\r\n", "\n");
    let (head, rest) = text.split_once("RUNS::").unwrap();
    let (runs_section, rest) = rest.split_once("DEVIATIONS::").unwrap();
    let moved = format!("RUNS::{runs_section}{head}EQUIPMENT::\nLaser: 1\nDEVIATIONS::{rest}");
    let (measured, found) = read(moved);
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(measured.unwrap().runs.len(), 2);
}

#[test]
fn of_an_angular_measurement_the_units_are_not_known() {
    let text = rtl(&TARGETS, &runs()).replace("Linear", "Angular").replace("rtl", "rta");
    let measured = read(text).0.unwrap();
    assert_eq!((measured.target_unit, measured.deviation_unit), (None, None));
}

#[test]
fn free_text_in_another_encoding_does_not_stop_the_reading() {
    // "shi" and "yong" in GBK, of which the second bytes are no UTF-8.
    let text = rtl(&TARGETS, &runs());
    let (before, after) = text.split_once("Machine: M").unwrap();
    let bytes = [before.as_bytes(), b"Machine: \xca\xd4\xd3\xc3", after.as_bytes()].concat();
    let (measured, found) = read(bytes);
    assert!(found.is_empty(), "{found:?}");
    assert_eq!(measured.unwrap().runs[0].readings.len(), 4);
}

#[test]
fn a_broken_file_is_marked_where_it_is_broken() {
    let whole = rtl(&TARGETS, &runs());
    let cases: [(&str, &str, &str, &str); 14] = [
        ("Target-count: 4", "Target-count: 5", "E0924", "5"),
        ("Target-count: 4", "Target-count: 99999999999", "E0926", "99999999999"),
        ("  150.000000", "  15O.000000", "E0925", "15O.000000"),
        ("  150.000000", "  50.0", "E0928", "50.0"),
        ("  150.000000", "  nan", "E0925", "nan"),
        ("2   4      1.4", "2   5      1.4", "E0926", "5"),
        ("2   4      1.4", "2   0      1.4", "E0926", "0"),
        ("2   4      1.4", "3   4      1.4", "E0926", "3"),
        ("2   4      1.4", "2   3      1.4", "E0927", "2   3      1.3"),
        ("2   4      1.4", "2   4      1.4e999", "E0925", "1.4e999"),
        ("2   4      1.4", "2   4", "E0923", "2   4"),
        ("2   4      1.4", "2   4   1,4", "E0925", "1,4"),
        ("DEVIATIONS::", "DEVIATION::", "E0923", "EOF::"),
        ("TARGET DATA::", "TARGET::", "E0923", "EOF::"),
    ];
    for (from, to, code, marked) in cases {
        let text = whole.replacen(from, to, 1);
        assert_ne!(text, whole, "{from}");
        let (measured, found) = read(&text);
        assert!(measured.is_none(), "{to}");
        let source = super::file::text("data", text.as_bytes());
        assert_eq!(told(&source, &found).first(), Some(&(code, marked.to_owned())), "{to}");
        assert!(found.iter().all(|one| one.help.is_some()), "{to}");
    }
}

#[test]
fn runs_that_were_broken_off_and_files_without_end_are_told_and_read() {
    let whole = rtl(&TARGETS, &runs());
    for (text, codes) in [
        (whole.replace("2   1      1.1\r\n", ""), vec!["W0901"]),
        (whole.replace("Run-count: 2", "Run-count: 4"), vec!["W0901"]),
        (whole.replace("EOF::\r\n", ""), vec!["W0902"]),
    ] {
        let (measured, found) = read(text);
        assert!(measured.is_some());
        let warned = found.iter().filter(|one| one.severity == Severity::Warning);
        assert_eq!(warned.map(|one| one.code).collect::<Vec<_>>(), codes);
        assert_eq!(found.len(), codes.len());
    }
}

/// Wherever a file is cut off, it is refused, or its loss is told.
#[test]
fn a_file_that_is_cut_off_is_never_taken_for_a_whole_one() {
    let whole = rtl(&TARGETS, &runs());
    let end = whole.find("EOF::").unwrap();
    for length in 0..end {
        let (measured, found) = read(&whole[..length]);
        assert!(measured.is_none() || !found.is_empty(), "cut to {length} bytes: {:?}", &whole[..length]);
    }
}

#[test]
fn samples_over_time_are_refused_with_what_they_are() {
    let mut bytes = b"HEADER::\r\nOwner: CARTO-Dynamic\r\nFile Type: rtx\r\nVelocity: 0\r\nSample rate: 50000\r\nSample no: 3\r\nActual sample rate: 50000\r\nData:\r\n".to_vec();
    for sample in [0.1_f64, f64::NAN, -3.5] {
        bytes.extend(sample.to_le_bytes());
    }
    bytes.extend(b"EOF::\r\n");
    let (measured, found) = read(&bytes);
    assert!(measured.is_none());
    let [only] = found.iter().collect::<Vec<_>>()[..] else { panic!("{found:?}") };
    assert_eq!(only.code, "E0922");
    assert!(only.message.contains("3 samples at 50000 Hz"), "{}", only.message);
    assert!(super::file::is_dynamic(&bytes));
}

#[test]
fn what_is_no_file_of_an_instrument_is_said_to_be_none() {
    for bytes in [&b""[..], b" \r\n", b"\x00\x01\x02", b"\xff\xfea\x00b\x00"] {
        let (measured, found) = read(bytes);
        assert!(measured.is_none());
        assert_eq!(found.iter().map(|one| one.code).collect::<Vec<_>>(), ["E0921"], "{bytes:?}");
    }
}

#[test]
fn a_plain_table_says_the_same() {
    let (ours, found) = read(table(&TARGETS, &runs()));
    assert!(found.is_empty(), "{found:?}");
    let (ours, theirs) = (ours.unwrap(), read(rtl(&TARGETS, &runs())).0.unwrap());
    assert_eq!(ours.targets, theirs.targets);
    assert_eq!((ours.target_unit, ours.deviation_unit), (theirs.target_unit, theirs.deviation_unit));
    let told: Vec<_> = ours.runs.iter().map(|run| run.told).collect();
    assert_eq!(told, [Some(Sense::Ascending), Some(Sense::Descending)]);
}

#[test]
fn a_table_may_be_separated_by_semicolons_quoted_and_commented() {
    let text = "\u{feff}# by the lab\n\"Target\";\"Deviation\"\n#unit;in;mil\n\n 0;1\n# turned\n-0.0;\n10;\"-2\"\n20;nan\n";
    let (measured, found) = read(text);
    let measured = measured.unwrap();
    assert_eq!(measured.targets, [0.0, 10.0, 20.0]);
    assert_eq!(measured.deviation_unit.unwrap().factor, 25.4e-3);
    let readings: Vec<f64> = measured.runs[0].readings.iter().map(|one| one.deviation).collect();
    assert_eq!(readings, [1.0, -2.0]);
    assert_eq!(found.iter().map(|one| one.code).collect::<Vec<_>>(), ["W0901"]);
}

#[test]
fn a_broken_table_is_marked_where_it_is_broken() {
    let cases = [
        ("target,value\n0,1\n", "E0929", "target,value"),
        ("target,deviation,target\n0,1,2\n", "E0929", "target"),
        ("target,deviation\n#unit,mm\n0,1\n", "E0924", "#unit,mm"),
        ("target,deviation\n#unit,mm,um,s\n0,1\n", "E0924", "#unit,mm,um,s"),
        ("target,deviation\n#unit,mm,micro\n0,1\n", "E0304", "micro"),
        ("target,deviation\n0,1,5\n", "E0924", "0,1,5"),
        ("target,deviation\n0,inf\n", "E0925", "inf"),
        ("target,deviation\n,1\n", "E0925", ""),
        ("target,deviation\n0,1\n0,2\n", "E0927", "0,2"),
        ("target [mm],deviation [um]\n#unit,in,um\n0,1\n", "E0909", "in"),
        ("target (laser),deviation (um)\n0,1\n", "E0929", "target (laser),deviation (um)"),
        ("run,target,deviation\n0,0,1\n", "E0926", "0"),
        ("run,target,deviation\n1.5,0,1\n", "E0926", "1.5"),
        ("direction,target,deviation\nup,0,1\n", "E0926", "up"),
        ("target,deviation\n", "E0923", "target,deviation"),
        ("# nothing but a comment\n#unit,mm\n", "E0923", ""),
        ("# Units,mm,um\ntarget,deviation\n0,1\n", "E0924", "# Units,mm,um"),
        ("target,deviation\n0,1\n# unit,in,mil\n10,2\n", "E0924", "# unit,in,mil"),
        ("target,deviation,EXX\n0,#DIV/0!,1\n", "E0925", "#DIV/0!"),
    ];
    for (text, code, marked) in cases {
        let (measured, found) = read(text);
        assert!(measured.is_none(), "{text}");
        let source = super::file::text("data", text.as_bytes());
        assert_eq!(told(&source, &found), [(code, marked.to_owned())], "{text}");
    }
}

/// A row of units that is taken for a comment makes every number wrong by 25.4.
#[test]
fn units_are_read_however_they_are_marked() {
    for units in [
        "#unit,in,mil\n",
        "# unit,in,mil\n",
        "#Unit,in,mil\n",
        "#  UNITS: in,mil\n",
        "\"#unit\",in,mil\n",
        "# by the lab\n\n#Units,in,mil\n",
    ] {
        let (measured, found) = read(format!("target,deviation\n{units}0,1\n# units are not mm\n10,2\n"));
        let measured = measured.unwrap_or_else(|| panic!("{units}: {found:?}"));
        let units_read = [measured.target_unit, measured.deviation_unit].map(|unit| unit.unwrap().factor);
        assert_eq!(units_read, [25.4, 25.4e-3], "{units}");
    }
}

#[test]
fn quotes_hold_cells_together_and_excels_line_tells_the_separator() {
    for text in [
        "\"target\",\"deviation\",\"note\"\n\"0\",\"1\",\"a,b\"\n\"10\",\"2\",\"c\"\n",
        "\"target\",deviation,\"a;b\"\n0,1,\"x;y\"\n10,2,\n",
        "sep=;\ntarget;deviation\n0;1\n10;2\n",
        "\u{feff}sep=;\r\n# by the lab\r\ntarget;deviation\r\n0;1\r\n10;2\r\n",
    ] {
        let (measured, found) = read(text);
        let measured = measured.unwrap_or_else(|| panic!("{text}: {found:?}"));
        let readings: Vec<f64> = measured.runs[0].readings.iter().map(|one| one.deviation).collect();
        assert_eq!((measured.targets, readings), (vec![0.0, 10.0], vec![1.0, 2.0]), "{text}");
    }
}

#[test]
fn a_cell_that_is_no_number_is_told_what_to_write() {
    let empty = "leave the cell empty if nothing was measured";
    let alone = "write the number alone, and its unit behind the name of the column";
    for (cell, help) in [
        ("#DIV/0!", empty),
        ("-", empty),
        ("n/a", empty),
        ("10 um", alone),
        ("\"1,5\"", "write a point: `1.5`"),
        ("\"1,000\"", "write `1000` if the comma separates thousands"),
    ] {
        let (measured, found) = read(format!("target,deviation\n0,1\n10,{cell}\n"));
        assert!(measured.is_none(), "{cell}");
        let [one] = &found.iter().collect::<Vec<_>>()[..] else { panic!("{cell}: {found:?}") };
        assert_eq!(one.code, "E0925", "{cell}");
        assert!(one.help.as_ref().is_some_and(|told| told.contains(help)), "{cell}: {one:?}");
    }
}

#[test]
fn of_two_columns_that_may_be_meant_the_set_up_must_name_one() {
    let like = super::Columns {
        targets_like: vec!["X".to_owned()],
        deviations_like: vec!["EXX".to_owned()],
        ..Default::default()
    };
    let read = |text: &str, columns: &super::Columns<'_>| {
        let mut found = model_dsl::diagnostic::Diagnostics::new();
        let source = super::file::text("d", text.as_bytes());
        let measured = super::file::read(source.clone(), columns, &mut found);
        (measured, told(&source, &found), found)
    };
    let deviations = "x [mm],deviation [um],EXX [um]\n0,1,20\n10,2,30\n";
    let targets = "x [mm],position [mm],deviation [um]\n0,1,2\n3,4,5\n";
    for (text, marked, both, key) in [
        (
            deviations,
            "EXX [um]",
            "`deviation [um]` or in column `EXX [um]`",
            "`deviations: {column: deviation}`",
        ),
        (targets, "x [mm]", "`position [mm]` or in column `x [mm]`", "`targets: {column: position}`"),
    ] {
        let (measured, told, found) = read(text, &like);
        assert!(measured.is_none(), "{text}");
        assert_eq!(told, [("E0929", marked.to_owned())]);
        let one = found.iter().next().unwrap();
        assert!(one.message.contains(both) && one.help.as_ref().unwrap().contains(key), "{one:?}");
    }
    let named = super::Columns { deviation: Some("EXX"), ..like };
    let measured = read(deviations, &named).0.unwrap();
    assert_eq!(measured.runs[0].readings[1].deviation, 30.0);
}

#[test]
fn a_column_that_the_set_up_names_is_taken() {
    let columns = super::Columns { target: Some("x"), deviation: Some("EYX"), ..Default::default() };
    let mut found = model_dsl::diagnostic::Diagnostics::new();
    let text = "x,deviation,EYX\n#unit,mm,um,um\n0,1,5\n10,2,6\n";
    let measured = super::file::read(super::file::text("d", text.as_bytes()), &columns, &mut found).unwrap();
    let readings: Vec<f64> = measured.runs[0].readings.iter().map(|one| one.deviation).collect();
    assert_eq!(readings, [5.0, 6.0]);
}

#[test]
fn a_unit_may_stand_behind_the_name_of_a_column() {
    let like = super::Columns { targets_like: vec!["X".to_owned()], ..Default::default() };
    let bare = "x,deviation\n#unit,mm,um\n0,1\n10,2\n";
    let both = "x [mm],deviation\n#unit,mm,um\n0,1\n10,2\n";
    for text in [bare, both, "x [mm],deviation [um]\n0,1\n10,2\n", "X (mm);\"Deviation (um)\"\n0;1\n10;2\n"] {
        let mut found = model_dsl::diagnostic::Diagnostics::new();
        let measured = super::file::read(super::file::text("d", text.as_bytes()), &like, &mut found);
        let measured = measured.unwrap_or_else(|| panic!("{text}: {found:?}"));
        let units = [measured.target_unit, measured.deviation_unit].map(|unit| unit.unwrap().factor);
        assert_eq!((measured.targets, units), (vec![0.0, 10.0], [1.0, 1e-3]), "{text}");
    }
}
