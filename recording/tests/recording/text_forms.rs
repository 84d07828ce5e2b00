//! Ways to write a text that the recording file tells: separators, headers, decimal signs, dates, counts.

use crate::common::{header, read, recording};

/// A recording of one stage whose data is written so, and with such a time.
fn text(data: &str, time: &str, x: &str) -> String {
    format!(
        "recording: 1\nmachine: FX\ninstrument: position\ndata: {data}\nchannels:\n  time: {time}\n  measured.x: {x}\n"
    )
}

const SECONDS: &str = "{column: t, unit: s}";
const X: &str = "{column: x, unit: mm}";

fn times(time: &str, data: &str) -> Vec<f64> {
    recording(&text("d", time, X), data).unwrap_or_else(|error| panic!("{error}")).time
}

fn refused(text: &str, data: &str, parts: &[&str]) {
    let error = recording(text, data).unwrap_err().to_string();
    for part in parts {
        assert!(error.contains(part), "{error}\nlacks {part:?}");
    }
}

/// Numbers of more digits than fit into one in floating point: 1 us is to be 1e-6 s to some digits.
#[test]
fn epochs_keep_their_digits() {
    for (unit, first, second, apart) in [
        ("s", "1785446117.123456789", "1785446117.123457789", 1e-6),
        ("ms", "1785446117123.456", "1785446117123.457", 1e-6),
        ("us", "1785446117123456", "1785446117123457", 1e-6),
        ("ns", "1785446117123456789", "1785446117123457789", 1e-6),
        // Ticks of Windows since 1601.
        ("100 ns", "134299197171234567", "134299197171234577", 1e-6),
        ("min", "29757435.0", "29757435.5", 30.0),
        ("h", "495957.25", "495957.75", 1800.0),
    ] {
        let found = times(&format!("{{column: t, unit: {unit}}}"), &format!("t,x\n{first},1\n{second},2\n"));
        assert!((found[1] / apart - 1.0).abs() < 1e-6, "{unit}: {found:?}");
    }
    assert_eq!(times(SECONDS, "t,x\n-0.75,1\n-0.25,2\n0.5,3\n1e1,4\n"), [0.0, 0.5, 1.25, 10.75]);
    assert_eq!(times(SECONDS, "t,x\n-3.25,1\n-2.5,2\n"), [0.0, 0.75]);
}

/// By hand: 23:15:17.123 at +02:00 is 21:15:17.123 of universal time.
#[test]
fn dates() {
    let dates = "{column: t, unit: date}";
    for (first, second, apart) in [
        ("2026-07-30T23:15:17.123+02:00", "2026-07-30T21:15:17.623Z", 0.5),
        ("2026-07-30 23:15:17.123+0200", "2026-07-30 23:15:17.123001+02", 1e-6),
        ("2026-07-30T23:15:17.123 +02:00", "2026-07-30T16:15:18.123-05:00", 1.0),
        ("2026-07-30T23:15:17.123456789", "2026-07-30T23:15:17.123456790", 1e-9),
        ("2026-07-30 23:59:59", "2026-07-31 00:00:01", 2.0),
        ("2026-02-28T12:00", "2026-03-01T12:00", 86_400.0),
        ("2024-02-28T12:00:00", "2024-03-01T12:00:00", 172_800.0),
        ("1969-12-31T23:59:59.5", "1970-01-01T00:00:00.25", 0.75),
    ] {
        let found = times(dates, &format!("t,x\n{first},1\n{second},2\n"));
        assert!((found[1] / apart - 1.0).abs() < 1e-6, "{first} {second}: {found:?}");
    }
    let two = "{column: [d, t], unit: date}";
    assert_eq!(times(two, "d,t,x\n2026-07-30,23:59:59.5,1\n2026-07-31,00:00:00,2\n"), [0.0, 0.5]);
    let of = |cell: &str| format!("t,x\n{cell},1\n");
    let dated = text("d", dates, X);
    for cell in [
        "30.07.2026 23:15",
        "2026-07-30",
        "23:15:17",
        "2026-02-30T12:00:00",
        "1785446117",
        "now",
        "2026-07-30T25:00:00",
    ] {
        refused(
            &dated,
            &of(cell),
            &[
                "d",
                &format!("data.csv:2:1: column `t` (channel `time`): `{cell}` is not a date"),
                "2026-07-30T23:15:17.123",
            ],
        );
    }
    refused(&dated, "t,x\n,1\n", &["data.csv:2:1", "the row has no time"]);
    refused(
        &dated,
        "t,x\n2026-07-30T23:15:17Z,1\n2026-07-30T23:15:18,2\n",
        &["data.csv:3:1", "one of them has a time zone"],
    );
    refused(
        &dated,
        "t,x\n2026-07-30T23:15:17Z,1\n2026-07-30T23:15:16.5Z,2\n",
        &["follows `2026-07-30T23:15:17`"],
    );
    refused(
        &text("d", SECONDS, X),
        &of("2026-07-30T23:15:17"),
        &["data.csv:2:1", "is a date, not a number", "`unit: date`"],
    );
}

/// `halsampler -t` writes the number of the sample and its values, set off by spaces.
#[test]
fn spaces_without_a_header() {
    let spaces = "{file: d, separator: spaces, header: none}";
    let sampled = text(spaces, "{column: 1, unit: 0.25 ms}", "{column: 3, unit: in}");
    let read = recording(&sampled, "100 0.5 1.0 \n101 0.5  -2.0\t\n  103 0.5 4\n").unwrap();
    assert_eq!(read.time, [0.0, 0.25e-3, 0.75e-3]);
    assert_eq!(read.measured[0].as_deref().unwrap(), [25.4, -50.8, 101.6]);
    refused(&sampled, "100 0.5 1.0\noverrun\n", &["data.csv:2:8", "the row has 1 cell, but 3 are needed"]);
    refused(
        &sampled,
        "100 0.5\n",
        &["data.csv:1:1: there is no column `3` (channel `measured.x`)", "the columns are 1, 2"],
    );
    // Without a column of times.
    let stepped = text(spaces, "{every: 0.5 s}", "{column: 1, unit: mm}");
    assert_eq!(recording(&stepped, "1\n2\n3\n").unwrap().time, [0.0, 0.5, 1.0]);
    // `camonitor` writes the name, the date, the time of day, the value, and what is wrong with it. These lines are its own, of EPICS 7.0.7
    // and EPICS 7.0.4, as its users show them.
    let monitored = text(spaces, "{column: [2, 3], unit: date}", "{column: 4, unit: mm}");
    let shown = "MY-DEVICE-PREFIX:AI            2025-02-06 00:49:49.136633 182\n\
                 MY-DEVICE-PREFIX:AI            2025-02-06 00:49:50.138049 183\n\
                 MY-DEVICE-PREFIX:AI            2025-02-06 00:49:51.139423 184\n";
    let read = recording(&monitored, shown).unwrap();
    assert!((read.time[2] - 2.002_79).abs() < 1e-9, "{:?}", read.time);
    assert_eq!(read.measured[0].as_deref().unwrap(), [182.0, 183.0, 184.0]);
    let shown = "TST{Tank:1}T-Sp                2020-08-06 02:41:05.251229 30  \n";
    assert_eq!(recording(&monitored, shown).unwrap().measured[0].as_deref().unwrap(), [30.0]);
    let lines =
        "S:X:RBV 2026-07-30 23:15:17.123456 1.234 \nS:X:RBV 2026-07-30 23:15:17.623456 1.25 HIGH MINOR\n";
    let read = recording(&monitored, lines).unwrap();
    assert!((read.time[1] - 0.5).abs() < 1e-12);
    assert_eq!(read.measured[0].as_deref().unwrap(), [1.234, 1.25]);
}

#[test]
fn headers_further_down() {
    let down = text("{file: d, header: 4}", SECONDS, X);
    let read = recording(&down, "Name;Scope\n\nt,x,t,x\nt;x;z\n0;1;2\n1;2;2\n").unwrap();
    assert_eq!(read.time, [0.0, 1.0]);
    refused(&down, "a\nb\n\n\nt,x\n0,1\n", &["line 4 should be the header row"]);
    refused(&down, "a\nb\n", &["line 4 should be the header row"]);
    let first = text("{file: d, header: 1}", SECONDS, X);
    assert_eq!(recording(&first, "t,x\n0,1\n2,1\n").unwrap().time, [0.0, 2.0]);
}

#[test]
fn units_in_the_names() {
    let read = recording(&text("d", SECONDS, X), "t [s],x (mm)\n0,1\n1,2\n").unwrap();
    assert_eq!(read.measured[0].as_deref().unwrap(), [1.0, 2.0]);
    let quoted = recording(&text("d", SECONDS, "{column: \"x [mm]\", unit: mm}"), "t,x [mm]\n0,1\n1,2\n");
    assert!(quoted.is_ok());
    // A name that is there as it is comes first; brackets without a unit are a part of the name.
    assert!(recording(&text("d", SECONDS, X), "t,x,x [um]\n0,1,2\n").is_ok());
    refused(&text("d", SECONDS, X), "t,x [left]\n0,1\n", &["no column `x`"]);
    refused(&text("d", SECONDS, X), "t,x [mm],x (mm)\n0,1,2\n", &["column `x` occurs twice"]);
    refused(
        &text("d", SECONDS, X),
        "t,x [um]\n0,1\n",
        &["data.csv:1:3: column `x [um]` is in `um` here and in `mm`"],
    );
    let counts = text("d", SECONDS, "{column: x, unit: 0.5 um}");
    assert_eq!(recording(&counts, "t,x [counts]\n0,4\n").unwrap().measured[0].as_deref().unwrap(), [0.002]);
    refused(&counts, "t,x [um]\n0,1\n", &["is in `um` here and in `0.5 um`"]);
    refused(&counts, "t,x\n#unit,s,mm\n0,1\n", &["is in `mm` here and in `0.5 um`"]);
}

#[test]
fn decimal_commas() {
    let comma = text("{file: d, decimal: \",\"}", SECONDS, X);
    for data in ["t;x\n0,5;-1,25\n1;2e-1\n", "t\tx\n0,5\t-1,25\n1\t0,2\n"] {
        let read = recording(&comma, data).unwrap();
        assert_eq!(read.time, [0.0, 0.5]);
        assert_eq!(read.measured[0].as_deref().unwrap(), [-1.25, 0.2]);
    }
    refused(&comma, "t;x\n0,5;1.250\n", &["data.csv:2:5", "`1.250` has a point", "remove `decimal`"]);
    refused(&comma, "t;x\n0,5;1,2,3\n", &["data.csv:2:5", "`1,2,3` is not a number"]);
    refused(&text("d", SECONDS, X), "t;x\n0;1,5\n", &["`1,5` has a decimal comma", "decimal: \",\""]);
}

/// A tenth of a degree, as a PLC holds it; what is 0 in degF is -32 5/9 in degC.
#[test]
fn multiples_of_units() {
    let hot = format!("{}  temperature.bed: {{column: T, unit: 0.1 degF}}\n", text("d", SECONDS, X));
    let read = recording(&hot, "t,x,T\n0,1,500\n1,1,0\n").unwrap();
    assert!((read.temperatures[0].values[0] - 10.0).abs() < 1e-12);
    assert!((read.temperatures[0].values[1] + 32.0 / 1.8).abs() < 1e-12);
}

#[test]
fn what_the_recording_file_says_wrongly() {
    for (data, time, x, code, marked) in [
        ("{file: d, separator: pipe}", SECONDS, X, "E0630", "pipe"),
        ("{file: d, header: first}", SECONDS, X, "E0630", "first"),
        ("{file: d, header: 0}", SECONDS, X, "E0630", "0"),
        ("{file: d, decimal: comma}", SECONDS, X, "E0630", "comma"),
        ("{file: d, decimal: \",\", separator: comma}", SECONDS, X, "E0604", "separator"),
        ("{separator: tab}", SECONDS, X, "E0601", "data"),
        ("{file: d, sheets: a}", SECONDS, X, "E0603", "sheets"),
        ("d", "{every: 0 s}", X, "E0629", "0 s"),
        ("d", "{every: 1 mm}", X, "E0307", "mm"),
        ("d", "{every: 1 s, column: t}", X, "E0629", "column"),
        ("d", "{column: [a, b], unit: s}", X, "E0604", "[a, b]"),
        ("d", "{column: [a, b, c], unit: date}", X, "E0604", "[a, b, c]"),
        ("d", SECONDS, "{column: x, unit: date}", "E0609", "date"),
        ("d", SECONDS, "{column: x, unit: 0 mm}", "E0629", "0 mm"),
        ("d", SECONDS, "{column: x, unit: -1 mm}", "E0629", "-1 mm"),
        ("d", SECONDS, "{column: x, unit: 0.1 urad}", "E0609", "0.1 urad"),
        ("d", SECONDS, "{every: 1 s}", "E0603", "every"),
    ] {
        let (_, found) = read(&text(data, time, x));
        let found: Vec<_> = found.iter().map(|(one, marked)| (one.code, marked.as_str())).collect();
        assert!(found.contains(&(code, marked)), "{found:?} has no {code} at {marked}");
    }
    assert!(header(&text("{file: a.csv, sheet: b}", SECONDS, X)).form.sheet.is_some());
}
