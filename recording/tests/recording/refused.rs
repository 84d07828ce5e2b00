//! What a recording file may not say: every code, at the words that are wrong, with what to write instead.

use model_dsl::diagnostic::Severity;

use crate::common::read;

const POSITION: &str = "recording: 1
machine: XYFZ
instrument: position
data: data.csv
channels:
  time: {column: t, unit: s}
  run: {column: n}
  command.x: {column: xc, unit: mm}
  measured.x: {column: xm, unit: mm}
holdout: {runs: [3]}
";

const BALLBAR: &str = "recording: 1
machine: XYFZ
instrument: ballbar
data: data.csv
channels:
  time: {column: t, unit: s}
  command.x: {column: xc, unit: mm}
  command.y: {column: yc, unit: mm}
  deviation: {column: dev, unit: um}
setup: {center: [1 mm, 2 mm, 3 mm], radius: 150 mm}
";

const LATHE: &str = "recording: 1
machine: lathe
instrument: linear
data: data.csv
channels:
  time: {column: t, unit: s}
  command.x: {column: xc, unit: mm}
  command.z: {column: zc, unit: mm}
  deviation: {column: dev, unit: um}
setup: {axis: X}
";

/// Replaces one part of a file that is right, and expects one error: its code, the text marked, a part of the help.
fn refused(base: &str, part: &str, with: &str, code: &str, marked: &str, help: &str) {
    let (_, clean) = read(base);
    assert!(clean.is_empty(), "{clean:#?}");
    assert!(base.contains(part), "{part}");
    let text = base.replacen(part, with, 1);
    let (header, found) = read(&text);
    let [(one, text_marked)] = found.as_slice() else { panic!("{found:#?}\nin\n{text}") };
    assert_eq!((one.code, text_marked.as_str()), (code, marked), "{}\nin\n{text}", one.message);
    assert_eq!(one.severity, Severity::Error);
    let told = one.help.as_deref().unwrap_or_default();
    assert!(told.contains(help), "{told:?} lacks {help:?}");
    assert!(header.is_none(), "{text}");
}

#[test]
fn keys() {
    refused(POSITION, "machine: XYFZ\n", "", "E0601", "recording", "add `machine: ...`");
    refused(POSITION, "instrument: position\n", "", "E0601", "recording", "add `instrument: ...`");
    refused(POSITION, "data: data.csv\n", "", "E0601", "recording", "add `data: ...`");
    refused(
        POSITION,
        "  time: {column: t, unit: s}\n",
        "",
        "E0601",
        "channels",
        "time: {column: ..., unit: s}",
    );
    refused(POSITION, "{column: xm, unit: mm}", "{unit: mm}", "E0601", "measured.x", "add `column: ...`");
    refused(POSITION, "{runs: [3]}", "{}", "E0601", "holdout", "add `runs: ...`");
    refused(POSITION, "recording: 1", "recording: 2", "E0602", "2", "write `recording: 1`");
    refused(POSITION, "recording: 1", "calibration: 1", "E0602", "calibration", "begin with `recording: 1`");
    refused(POSITION, "recording: 1", "abbe: 1", "E0602", "abbe", "begin with `recording: 1`");
    refused(POSITION, "data:", "titel: x\ndata:", "E0603", "titel", "did you mean `title`?");
    refused(
        POSITION,
        "{column: xm, unit",
        "{column: xm, units: mm, unit",
        "E0603",
        "units",
        "did you mean `unit`?",
    );
    refused(POSITION, "{runs: [3]}", "{runs: [3], run: 3}", "E0603", "run", "did you mean `runs`?");
    refused(
        BALLBAR,
        "radius: 150 mm",
        "radius: 150 mm, centre: x",
        "E0603",
        "centre",
        "did you mean `center`?",
    );
}

#[test]
fn forms() {
    refused(POSITION, "data: data.csv", "data: [a, b]", "E0604", "[a, b]", "single word or number");
    refused(POSITION, "{column: xm, unit: mm}", "xm", "E0604", "xm", "column: ...");
    refused(POSITION, "{runs: [3]}", "{runs: 3}", "E0604", "3", "[a, b, c]");
    refused(BALLBAR, "[1 mm, 2 mm, 3 mm]", "[1 mm, 2 mm]", "E0604", "[1 mm, 2 mm]", "not sensitive");
    refused(POSITION, "holdout:", "extra: [c]\nholdout:", "E0604", "[c]", "counter.x: {column: c, unit: mm}");
}

#[test]
fn instruments_and_channels() {
    refused(
        POSITION,
        "instrument: position",
        "instrument: positon",
        "E0605",
        "positon",
        "did you mean `position`?",
    );
    refused(POSITION, "instrument: position", "instrument: camera", "E0605", "camera", "ballbar, linear");
    refused(POSITION, "command.x", "comand.x", "E0606", "comand.x", "did you mean `command.x`?");
    refused(POSITION, "command.x", "command.X", "E0606", "command.X", "did you mean `command.x`?");
    refused(POSITION, "command.x: {", "temp.oil: {", "E0606", "temp.oil", "did you mean `temperature.oil`?");
    refused(POSITION, "command.x: {", "temperature: {", "E0606", "temperature", "temperature.<name>");
    refused(POSITION, "command.x: {", "banana: {", "E0606", "banana", "channels are time, run");
    refused(POSITION, "command.x", "command.b", "E0607", "command.b", "its axes are x, y, z");
    refused(POSITION, "command.x", "actual.u", "E0607", "actual.u", "its axes are x, y, z");
    refused(POSITION, "measured.x", "measured.c", "E0607", "measured.c", "its axes are x, y, z");
    refused(BALLBAR, "command.y", "measured.y", "E0612", "measured.y", "`deviation`");
    refused(
        BALLBAR,
        "command.y: {column: yc, unit: mm}",
        "normal.y: {column: yc}",
        "E0612",
        "normal.y",
        "only with `probe`",
    );
    refused(POSITION, "command.x", "deviation", "E0612", "deviation", "`measured.x`");
    refused(POSITION, "  measured.x: {column: xm, unit: mm}\n", "", "E0613", "channels", "`actual.x`");
    refused(
        BALLBAR,
        "  deviation: {column: dev, unit: um}\n",
        "",
        "E0613",
        "channels",
        "deviation: {column: ..., unit: mm}",
    );
}

/// A channel with a mistake may be the missing one: nothing is said twice. This one stands where the others do not.
#[test]
fn what_is_there_wrongly_is_not_missing() {
    refused(POSITION, "measured.x", "mesured.x", "E0606", "mesured.x", "did you mean `measured.x`?");
    refused(POSITION, "time: {column: t, unit: s}", "time: {column: t}", "E0610", "time", "add `unit: s`");
}

#[test]
fn insensitive_directions() {
    let position = LATHE
        .replace("linear", "position")
        .replace("deviation", "measured.x")
        .replace("setup: {axis: X}\n", "");
    refused(
        &position,
        "measured.x",
        "measured.y",
        "E0608",
        "measured.y",
        "its sensitive directions are X, Z",
    );
    refused(LATHE, "axis: X", "direction: Y", "E0608", "Y", "its sensitive directions are X, Z");
    refused(
        LATHE,
        "axis: X",
        "direction: [1, 1, 0]",
        "E0608",
        "[1, 1, 0]",
        "its sensitive directions are X, Z",
    );
}

#[test]
fn units() {
    refused(POSITION, "xc, unit: mm", "xc, unit: deg", "E0609", "deg", "such as `mm`");
    refused(POSITION, "xm, unit: mm", "xm, unit: s", "E0609", "s", "such as `mm`");
    refused(POSITION, "t, unit: s", "t, unit: mm", "E0609", "mm", "such as `s`");
    refused(POSITION, "t, unit: s", "t, unit: mm/s", "E0609", "mm/s", "such as `s`");
    refused(BALLBAR, "unit: um", "unit: urad", "E0609", "urad", "such as `mm`");
    let rotary = POSITION.replace("XYFZ", "FC").replace(".x", ".c").replace("unit: mm", "unit: deg");
    refused(
        &rotary,
        "cc, unit: deg".replace("cc", "xc").as_str(),
        "xc, unit: mm",
        "E0609",
        "mm",
        "such as `deg`",
    );
    let warm = POSITION.replace(
        "holdout",
        "  temperature.a: {column: T, unit: degC}\n  load.f: {column: F, unit: N}\nholdout",
    );
    refused(&warm, "T, unit: degC", "T, unit: mm", "E0609", "mm", "such as `degC`");
    refused(&warm, "F, unit: N", "F, unit: degC", "E0609", "degC", "such as `N`");
    refused(&warm, "F, unit: N", "F", "E0610", "load.f", "add `unit: N`");
    refused(POSITION, "{column: xm, unit: mm}", "{column: xm}", "E0610", "measured.x", "add `unit: mm`");
    refused(POSITION, "run: {column: n}", "run: {column: n, unit: s}", "E0611", "unit", "leave `unit` out");
    refused(POSITION, "xm, unit: mm", "xm, unit: micron", "E0304", "micron", "did you mean `um`?");
}

#[test]
fn probes() {
    let probe = BALLBAR
        .replace("ballbar", "probe")
        .replace("setup: {center: [1 mm, 2 mm, 3 mm], radius: 150 mm}\n", "");
    let all = "  normal.x: {column: nx}\n  normal.y: {column: ny}\n  normal.z: {column: nz}\n";
    let normals = format!("{probe}{all}");
    refused(&normals, all, "", "E0614", "probe", "normal.z");
    refused(&normals, "  normal.y: {column: ny}\n", "", "E0614", "normal.x", "each sensitive direction");
    let both = format!("{all}setup: {{direction: Z}}\n");
    refused(&normals, all, &both, "E0618", "Z", "leave one of them out");
    refused(&normals, "{column: nz}", "{column: nz, unit: mm}", "E0611", "unit", "leave `unit` out");
}

#[test]
fn set_ups() {
    refused(BALLBAR, "center: [1 mm, 2 mm, 3 mm], ", "", "E0615", "setup", "add `center:");
    refused(BALLBAR, ", radius: 150 mm", "", "E0615", "setup", "add `radius: 150 mm`");
    refused(LATHE, "setup: {axis: X}\n", "", "E0615", "linear", "add `axis: X`");
    refused(
        LATHE,
        "axis: X",
        "center: [1 mm, 0 mm, 2 mm], axis: X",
        "E0616",
        "center",
        "`axis` and `direction`",
    );
    refused(BALLBAR, "radius: 150 mm", "radius: 150 mm, axis: X", "E0616", "axis", "`center` and `radius`");
    refused(POSITION, "holdout", "setup: {radius: 1 mm}\nholdout", "E0616", "radius", "leave it out");
    refused(LATHE, "axis: X", "axis: Y", "E0607", "Y", "its axes are X, Z");
    refused(LATHE, "axis: X", "axis: x", "E0607", "x", "did you mean `X`?");
    refused(LATHE, "axis: X", "axis: X, direction: B", "E0617", "B", "write X, Y or Z");
    refused(LATHE, "axis: X", "direction: [0, 0, 0]", "E0617", "[0, 0, 0]", "[1, 1, 0]");
    refused(LATHE, "axis: X", "direction: [1, 0]", "E0617", "[1, 0]", "[1, 1, 0]");
    refused(LATHE, "axis: X", "axis: X, direction: Z", "E0618", "Z", "straightness");
    refused(BALLBAR, "radius: 150 mm", "radius: 0 mm", "E0621", "0 mm", "such as `150 mm`");
    refused(BALLBAR, "radius: 150 mm", "radius: -1 mm", "E0621", "-1 mm", "such as `150 mm`");
    refused(BALLBAR, "radius: 150 mm", "radius: 150", "E0306", "150", "150 mm");
    refused(BALLBAR, "2 mm, 3 mm", "2 mm, 3 deg", "E0307", "deg", "mm");
}

#[test]
fn datums() {
    let of = |value: &str| format!("setup: {{datum: {value}}}\nholdout");
    refused(POSITION, "holdout", &of("turned"), "E0604", "turned", "`datum: fixed` if it stayed clamped");
    refused(POSITION, "holdout", &of("[free]"), "E0604", "[free]", "");
    refused(
        BALLBAR,
        "radius: 150 mm",
        "radius: 150 mm, datum: free",
        "E0616",
        "datum",
        "`center` and `radius`",
    );
    refused(LATHE, "axis: X", "axis: X, datum: free", "E0616", "datum", "`axis` and `direction`");
    // The angle of a rotary stage and a drive's own feedback say nothing of a part.
    let stage = "{recording: 1, machine: FC, instrument: position, data: d.csv, setup: {},
        channels: {time: {column: t, unit: s}, measured.c: {column: c, unit: deg}}}";
    refused(stage, "setup: {}", "setup: {datum: free}", "E0618", "free", "add the channel `measured.x`");
}

#[test]
fn straightness_and_angles() {
    let straight = LATHE.replace("linear", "straightness").replace("axis: X", "axis: X, direction: Z");
    refused(&straight, ", direction: Z", "", "E0615", "setup", "add `direction: Y`");
    refused(&straight, "direction: Z", "direction: -X", "E0618", "-X", "use the instrument `linear`");
    refused(&straight, "direction: Z", "direction: [1, 0, 3]", "E0618", "[1, 0, 3]", "at right angles");
    let angular = LATHE
        .replace("linear", "angular")
        .replace("unit: um", "unit: urad")
        .replace("axis: X", "axis: X, direction: B");
    refused(&angular, ", direction: B", "", "E0615", "setup", "such as `direction: B`");
    refused(&angular, "unit: urad", "unit: um", "E0609", "um", "such as `deg`");
    refused(&angular, "direction: B", "direction: D", "E0617", "D", "write A, B or C");
    let rotary =
        "{recording: 1, machine: FC, instrument: angular, data: d.csv, setup: {axis: C, direction: C},
        channels: {time: {column: t, unit: s}, deviation: {column: d, unit: mrad}}}";
    let on_turning_axis = rotary.replace("direction: C", "direction: X").replace("mrad", "um");
    for instrument in ["linear", "straightness"] {
        let text = on_turning_axis.replace("angular", instrument);
        let (_, found) = read(&text);
        let [(one, marked)] = found.as_slice() else { panic!("{found:#?}") };
        assert_eq!((one.code, marked.as_str()), ("E0618", "C"));
        assert!(one.help.as_deref().unwrap().contains("`angular`"));
    }
}

#[test]
fn held_out_runs() {
    refused(POSITION, "  run: {column: n}\n", "", "E0619", "runs", "run: {column: ...}");
    refused(POSITION, "[3]", "[3, b]", "E0620", "b", "runs: [3]");
    refused(POSITION, "[3]", "[1.5]", "E0620", "1.5", "runs: [3]");
    refused(POSITION, "[3]", "[]", "E0620", "[]", "leave `holdout` out");
}

/// All mistakes of a file are told in one run, and neither step repeats what the other told.
#[test]
fn all_mistakes_are_told() {
    let text = BALLBAR
        .replace("command.x", "comand.x")
        .replace("unit: um", "unit: s")
        .replace("radius: 150 mm", "radius: 0 mm")
        .replace("data: data.csv", "dta: data.csv");
    let (_, found) = read(&text);
    let mut codes: Vec<_> = found.iter().map(|(one, _)| one.code).collect();
    codes.sort_unstable();
    assert_eq!(codes, ["E0601", "E0603", "E0606", "E0609", "E0621"]);
    for text in ["[]", "recording", "3"] {
        let (_, found) = read(text);
        assert_eq!(found.iter().map(|(one, _)| one.code).collect::<Vec<_>>(), ["E0604"], "{text}");
    }
}
