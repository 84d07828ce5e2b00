//! Every mistake, its code and the text that it points at.

use super::*;

/// Reads error motions and compares codes and texts with those expected.
fn refused(errors: &str, expected: &[(&str, &str)]) {
    let (calibration, found) = read_file(&with_error_motions(errors));
    let found: Vec<(&str, &str)> = found.iter().map(|(code, text)| (*code, text.as_str())).collect();
    assert_eq!(found, expected, "{errors}");
    let failed = expected.iter().any(|(code, _)| code.starts_with('E'));
    assert_eq!(calibration.is_none(), failed, "{errors}");
}

fn refused_file(text: &str, expected: &[(&str, &str)]) {
    let (_, found) = read_file(text);
    let found: Vec<(&str, &str)> = found.iter().map(|(code, text)| (*code, text.as_str())).collect();
    assert_eq!(found, expected, "{text}");
}

/// Every finding of these error motions as `code message | help`.
fn words(errors: &str) -> Vec<String> {
    let (_, diagnostics, _) = read_with_diagnostics(&with_error_motions(errors));
    let all = diagnostics.iter();
    all.map(|one| format!("{} {} | {}", one.code, one.message, one.help.as_deref().unwrap_or(""))).collect()
}

/// A recording names its machine too, and may name a calibration: it is told by the version of its format.
#[test]
fn another_kind_of_file_is_named() {
    for (text, kind) in [
        ("abbe: 1\nname: m\n", "a machine file"),
        ("recording: 1\nmachine: m\ncalibration: known.yaml\n", "a recording file"),
        ("path: 1\nfeed: 1 mm/min\n", "a path file"),
        ("setup: 1\nmachine: m\n", "a set-up file"),
    ] {
        let mut diagnostics = Diagnostics::new();
        let root = crate::yaml::read(&SourceFile::new("f", text), &mut diagnostics).unwrap();
        let named = crate::calibration::machine_of(&root, &mut diagnostics);
        let told: Vec<&str> = diagnostics.iter().map(|one| one.message.as_str()).collect();
        assert!(named.is_none(), "{text}");
        assert_eq!(told, [format!("this is {kind}, not a calibration file")]);
    }
}

#[test]
fn top_level_keys_are_checked() {
    let good = "calibration: 1\nmachine: m\nconstants: {Xt: 0 mm}\n";
    refused_file(good, &[]);
    refused_file(&format!("{good}erors: {{}}\nbanana: 1\n"), &[("E0403", "erors"), ("E0403", "banana")]);
    refused_file("machine: m\nconstants: {Xt: 0 mm}\n", &[("E0401", "machine")]);
    refused_file("calibration: 1\nconstants: {Xt: 0 mm}\n", &[("E0401", "calibration")]);
    refused_file(
        "calibration: 2\nmachine: [m]\nconstants: {Xt: 0 mm}\n",
        &[("E0402", "2"), ("E0404", "[m]")],
    );
    refused_file(
        "calibration: [1]\nmachine: ''\nconstants: {Xt: 0 mm}\n",
        &[("E0402", "[1]"), ("E0404", "''")],
    );
    refused_file("- 1\n", &[("E0404", "- 1")]);
    refused_file("words\n", &[("E0404", "words")]);
    refused_file(&format!("{good}errors: [EXX]\nlimits: 1\n"), &[("E0404", "[EXX]"), ("E0404", "1")]);
    refused_file(&format!("{good}source: {{a: 1}}\n"), &[("E0404", "{a: 1}")]);
    refused_file(&format!("{good}machine: n\n"), &[("E0005", "machine")]);
}

#[test]
fn an_error_that_is_not_small_is_refused_where_it_stands() {
    refused("{EC0Y: 1 deg}", &[("E0430", "1 deg")]);
    refused("{EC0Y: -3 rad}", &[("E0430", "-3 rad")]);
    refused("{EC0Y: 10 mrad, EXX: -10 mm}", &[]);
    refused("{EXX: 0.5 in}", &[("E0430", "0.5 in")]);
    let table = "table: {start: 0 mm, step: 10 mm, unit: deg, values: [0, 0.1, -2]}";
    refused(&format!("{{EBX: [{{{table}}}]}}"), &[("E0430", "table")]);
    refused("{EBX: [{backlash: {lost_motion: 1 deg}}]}", &[("E0430", "backlash")]);
    refused("{EBX: [{cyclic: {period: 5 mm, amplitude: 1 deg, phase: 0 deg}}]}", &[("E0430", "cyclic")]);
    // An encoder may count from another zero.
    refused("{ECC: 45 deg}", &[]);
    // What the states make of it is not known here.
    // 1e3 nm times (q - 1000 mm)^2: a metre at the zero of the axis, and nothing at 1000 mm.
    refused("{EXX: [{polynomial: {unit: nm, per: mm, coefficients: [1e9, -2e6, 1e3]}}]}", &[]);
    refused("{EBX: [{polynomial: {unit: urad, per: mm, coefficients: [1e5, -200, 0.1]}}]}", &[]);
    refused("{EXX: [{drift: {amplitude: 20 mm, time_constant: 9000 min}}]}", &[]);
    assert_eq!(
        words("{EC0Y: 45 deg}"),
        [
            "E0430 785 mrad is not a small error | check the unit: the equations are of first order and neglect half the square of an angle"
        ]
    );
}

#[test]
fn constants_are_checked() {
    let file = |constants: &str| format!("calibration: 1\nmachine: m\nconstants: {constants}\n");
    refused_file(&file("{Xtt: 0 mm, Xt: 1 mm}"), &[("E0405", "Xtt")]);
    refused_file(&file("{Zt: 0 mm}"), &[("E0406", "constants")]);
    refused_file("calibration: 1\nmachine: m\n", &[("E0406", "machine")]);
    refused_file(&file("{Xt: 0 deg}"), &[("E0307", "deg")]);
    refused_file(&file("{Xt: 0}"), &[("E0306", "0")]);
    refused_file(&file("{Xt: }"), &[("E0308", "Xt")]);
    refused_file(&file("{Xt: '1,5 mm'}"), &[("E0303", "1,5")]);
    refused_file(&file("{Xt: 1,5 mm}"), &[("E0303", "1,5")]);
    refused_file(&file("{Xt: -1,5}"), &[("E0303", "-1,5")]);
    refused_file(&file("[Xt]"), &[("E0404", "[Xt]")]);
    refused_file(&file("{Xt: 0 mm, Xt: 1 mm}"), &[("E0005", "Xt")]);
}

#[test]
fn limits_are_checked() {
    let file =
        |limits: &str| format!("calibration: 1\nmachine: m\nconstants: {{Xt: 0 mm}}\nlimits: {limits}\n");
    refused_file(&file("{compensation: 0.2 deg}"), &[("E0307", "deg")]);
    refused_file(&file("{compensation: 0.2}"), &[("E0306", "0.2")]);
    refused_file(&file("{compensation: 0 mm}"), &[("E0419", "0 mm")]);
    refused_file(&file("{compensation: -1 mm}"), &[("E0419", "-1 mm")]);
    refused_file(&file("{rate: 0 mm/s}"), &[("E0419", "0 mm/s")]);
    refused_file(&file("{rate: 2 mm}"), &[("E0307", "mm")]);
    refused_file(&file("{hold: -1 s, fade: 0 s}"), &[("E0419", "-1 s"), ("E0419", "0 s")]);
    refused_file(&file("{compensaton: 1 mm}"), &[("E0403", "compensaton")]);
}

#[test]
fn motions_are_checked() {
    refused("{EXW: 1 um, EZZZZ: 1 um, XX: 1 um}", &[("E0407", "EXW"), ("E0407", "EZZZZ"), ("E0407", "XX")]);
    refused("{EC0Y: 1 urad, COY: 2 urad}", &[("E0408", "COY")]);
}

#[test]
fn the_value_of_a_motion_is_checked() {
    refused("EXX: 10 arcsec", &[("E0307", "arcsec")]);
    refused("EXX: 10", &[("E0306", "10")]);
    refused("EXX: 10 micron", &[("E0304", "micron")]);
    refused("EXX: {backlash: {lost_motion: 1 um}}", &[("E0404", "{backlash: {lost_motion: 1 um}}")]);
    refused("EXX:", &[("E0404", "EXX")]);
    refused("EXX: [10 um]", &[("E0410", "10 um")]);
    refused(
        "EXX: [{backlash: {lost_motion: 8,5 um, wind_up: 3,5 um}}]",
        &[("E0303", "8,5"), ("E0303", "3,5")],
    );
    refused("EXX: [{}]", &[("E0410", "{}")]);
    let two = "EXX: [{backlash: {lost_motion: 1 um}, lag: {gain: 1 1/s}}]";
    refused(two, &[("E0410", "lag")]);
    assert_eq!(
        words("EXX: 1 arcsec"),
        ["E0307 EXX must be a length, but `arcsec` is an angle | use a unit such as `mm`"]
    );
}

#[test]
fn terms_and_parameters_are_checked() {
    refused("EXX: [{backlsh: {lost_motion: 1 um}}]", &[("E0409", "backlsh")]);
    refused("EXX: [{eccentricity: {x: 1 um}}]", &[("E0409", "eccentricity")]);
    refused("EXX: [{backlash: {}}]", &[("E0411", "backlash")]);
    refused("EXX: [{backlash: }]", &[("E0404", "backlash")]);
    refused("EXX: [{backlash: 10 um}]", &[("E0404", "10 um")]);
    refused("EXX: [{backlash: {lost_motin: 1 um}}]", &[("E0411", "backlash"), ("E0412", "lost_motin")]);
    refused("EXX: [{drift: {axis: X}}]", &[("E0411", "drift"), ("E0411", "drift"), ("E0412", "axis")]);
    assert_eq!(words("EXX: [{backlsh: {}}]"), ["E0409 unknown term `backlsh` | did you mean `backlash`?"]);
    let helps = words("EXX: [{lag: {gian: 1 1/s}}]");
    assert_eq!(helps[0], "E0411 `lag` of EXX needs the parameter `gain` | add `gain: ...`");
    assert_eq!(helps[1], "E0412 `lag` of EXX has no parameter `gian` | did you mean `gain`?");
}

#[test]
fn every_parameter_of_every_term_must_be_there() {
    let cases = [("constant", 1), ("reversal-spike", 2), ("cyclic", 3), ("lag", 1), ("acceleration", 1)];
    let more = [("expansion", 3), ("growth", 3), ("drift", 2), ("vibration", 3), ("compliance", 2)];
    let lists = [("polynomial", 3), ("coupling", 4), ("table", 3)];
    for (name, count) in cases.into_iter().chain(more).chain(lists) {
        let expected = vec![("E0411", name); count];
        refused(&format!("EXX: [{{{name}: {{}}}}]"), &expected);
    }
}

#[test]
fn signs_are_checked() {
    refused("EXX: [{cyclic: {period: 0 mm, amplitude: 1 um, phase: 0 rad}}]", &[("E0419", "0 mm")]);
    refused("EXX: [{lag: {gain: 0 1/s}}]", &[("E0419", "0 1/s")]);
    // A drive that leads has no natural frequency.
    refused("EXX: [{lag: {gain: -1 1/s, frequency: 5 Hz}}]", &[("E0419", "-1 1/s")]);
    refused("EXX: [{acceleration: {gain: 0 1/s/s}}]", &[("E0419", "0 1/s/s")]);
    refused("EXX: [{reversal-spike: {height: 1 um, decay: 0 s}}]", &[("E0419", "0 s")]);
    refused("EXX: [{drift: {amplitude: 1 um, time_constant: -5 s}}]", &[("E0419", "-5 s")]);
    refused("EXX: [{vibration: {frequency: 0 Hz, amplitude: 1 um, phase: 0 rad}}]", &[("E0419", "0 Hz")]);
    refused("EXX: [{backlash: {lost_motion: 1 um, wind_up: -1 mm}}]", &[("E0419", "-1 mm")]);
    refused("EXX: [{backlash: {lost_motion: 1 um, ramp: -5 ms}}]", &[("E0419", "-5 ms")]);
    let growth = "EXX: [{growth: {sensor: a, coefficient: 1 um/K, reference: 20 degC, time_constant: 0 s}}]";
    refused(growth, &[("E0419", "0 s")]);
}

#[test]
fn kinds_are_checked() {
    refused(
        "EXX: [{backlash: {lost_motion: 1 arcsec, wind_up: 2 deg}}]",
        &[("E0307", "arcsec"), ("E0307", "deg")],
    );
    refused(
        "ECC: [{cyclic: {period: 1 mm, amplitude: 1 um, phase: 1}}]",
        &[("E0307", "mm"), ("E0307", "um"), ("E0306", "1")],
    );
    refused("EXX: [{backlash: {lost_motion: 1 um, ramp: 2 mm}}]", &[("E0307", "mm")]);
    refused("EXX: [{lag: {gain: 16 1/s, ramp: 2 ms}}]", &[("E0412", "ramp")]);
    refused("EXX: [{lag: {gain: 16 1/s, frequency: 0 Hz}}]", &[("E0419", "0 Hz")]);
    refused("EXX: [{backlash: {lost_motion: 1 um, inside_loop: maybe}}]", &[("E0427", "maybe")]);
    refused("EZS: [{backlash: {axis: Y, lost_motion: 1 um, inside_loop: true}}]", &[("E0427", "true")]);
    refused(
        "EXX: [{cyclic: {period: 1 mm, amplitude: 1 um, phase: 0 deg, inside_loop: true}}]",
        &[("E0412", "inside_loop")],
    );
    refused("EXX: [{lag: {gain: 16 s}}]", &[("E0307", "s")]);
    refused("EXX: [{acceleration: {gain: 16 1/s}}]", &[("E0307", "1/s")]);
    let growth = "EXX: [{growth: {sensor: a, coefficient: 11 um/m/K, reference: 20 mm}}]";
    refused(growth, &[("E0307", "um/m/K"), ("E0307", "mm")]);
    let expansion = "EXX: [{expansion: {sensor: a, coefficient: 11 um/K, reference: 20}}]";
    refused(expansion, &[("E0307", "um/K"), ("E0306", "20")]);
    refused("EZS: [{compliance: {load: f, coefficient: 1 um/K}}]", &[("E0424", "um/K")]);
    refused("EZS: [{compliance: {load: f, coefficient: 1}}]", &[("E0306", "1")]);
    refused("EZS: [{compliance: {load: [f], coefficient: x}}]", &[("E0404", "[f]"), ("E0301", "x")]);
}

#[test]
fn axes_are_checked() {
    refused("EXX: [{backlash: {lost_motion: 1 um, axis: x}}]", &[("E0414", "x")]);
    refused("EXX: [{backlash: {lost_motion: 1 um, axis: [X]}}]", &[("E0404", "[X]")]);
    refused("EZS: [{backlash: {lost_motion: 1 um}}]", &[("E0415", "backlash")]);
    refused("EXX: [{coupling: {axis: X, per: mm, unit: um, coefficients: [1]}}]", &[("E0420", "X")]);
    assert!(words("EXX: [{lag: {gain: 1 1/s, axis: x}}]")[0].ends_with("did you mean `X`?"));
    assert!(words("EXX: [{lag: {gain: 1 1/s, axis: Q}}]")[0].ends_with("its axes are X, Y, C"));
}

#[test]
fn polynomials_are_checked() {
    let polynomial = |inside: &str| format!("EXX: [{{polynomial: {{{inside}}}}}]");
    let both = polynomial("axis: X, sensor: a, per: mm, unit: um, coefficients: [1]");
    refused(&both, &[("E0416", "sensor")]);
    refused(&polynomial("unit: um, coefficients: [1]"), &[("E0411", "polynomial")]);
    refused(
        &polynomial("per: deg, unit: arcsec, coefficients: [1]"),
        &[("E0413", "deg"), ("E0413", "arcsec")],
    );
    refused(&polynomial("per: degC, unit: um, coefficients: [1]"), &[("E0413", "degC")]);
    refused(&polynomial("sensor: a, per: mm, unit: um, coefficients: [1]"), &[("E0413", "mm")]);
    refused(&polynomial("sensor: a, per: degF, unit: um, coefficients: [1]"), &[("E0421", "degF")]);
    refused(&polynomial("per: mm, unit: um, coefficients: []"), &[("E0417", "[]")]);
    refused(&polynomial("per: mm, unit: um, coefficients: 1"), &[("E0404", "1")]);
    let several = polynomial("per: mm, unit: um, coefficients: [1 um, .nan, x, 1, ~]");
    refused(&several, &[("E0309", "um"), ("E0302", ".nan"), ("E0301", "x"), ("E0308", "~")]);
    let huge = format!("per: nm, unit: m, coefficients: [{}1]", "0, ".repeat(60));
    refused(&polynomial(&huge), &[("E0302", "1")]);
    let message = "E0413 EXX must be a length, but `arcsec` is an angle | use a unit such as `mm`";
    assert_eq!(words(&polynomial("per: mm, unit: arcsec, coefficients: [1]")), [message]);
}

#[test]
fn tables_are_checked() {
    let table = |inside: &str| format!("EXX: [{{table: {{{inside}}}}}]");
    let uniform = "start: 0 mm, step: 1 mm, unit: um";
    refused(&table(uniform), &[("E0411", "table")]);
    refused(&table(&format!("{uniform}, values: []")), &[("E0417", "[]")]);
    refused(&table(&format!("{uniform}, values: 3")), &[("E0404", "3")]);
    refused(&table(&format!("{uniform}, values: [1, nan, .inf]")), &[("E0302", "nan"), ("E0302", ".inf")]);
    refused(&table(&format!("{uniform}, values: [1], at: [0 mm]")), &[("E0416", "at")]);
    refused(&table(&format!("{uniform}, values: [1], per: mm")), &[("E0416", "per")]);
    refused(&table(&format!("{uniform}, values: [1], forward: [1]")), &[("E0416", "values")]);
    refused(&table(&format!("{uniform}, forward: [1]")), &[("E0411", "table")]);
    refused(&table(&format!("{uniform}, forward: [1, 2], reverse: [1]")), &[("E0417", "[1]")]);
    refused(&table("unit: um, values: [1]"), &[("E0411", "table")]);
    refused(&table("start: 0 mm, unit: um, values: [1]"), &[("E0411", "table")]);
    refused(&table("start: 0 mm, step: 0 mm, unit: um, values: [1]"), &[("E0419", "0 mm")]);
    refused(&table("start: 0 mm, step: -1e-310 mm, unit: um, values: [1]"), &[("E0419", "-1e-310 mm")]);
    refused(
        &table("start: 0, step: 1 deg, unit: s, values: [1]"),
        &[("E0306", "0"), ("E0307", "deg"), ("E0413", "s")],
    );
}

#[test]
fn nodes_are_checked() {
    let table = |at: &str| format!("EXX: [{{table: {{{at}, unit: um, values: [1, 2, 3, 4]}}}}]");
    refused(&table("at: [0, 1, 2, 3], per: mm"), &[]);
    refused(&table("at: [0, 2, 2, 1], per: mm"), &[("E0418", "2"), ("E0418", "1")]);
    refused(&table("at: [3, 2, 4, 1], per: mm"), &[("E0418", "4")]);
    refused(&table("at: [0 mm, 1 in, 2 mm, 3 in]"), &[("E0418", "2 mm")]);
    refused(&table("at: [0, 1, 2], per: mm"), &[("E0417", "[0, 1, 2]")]);
    refused(&table("at: [0, 1, 2, 3], per: deg"), &[("E0413", "deg")]);
    refused(&table("at: [0 mm, 1 mm, 2 deg, 3]"), &[("E0307", "deg"), ("E0306", "3")]);
    refused(&table("at: [0, 1 mm, nan, 3], per: mm"), &[("E0309", "mm"), ("E0302", "nan")]);
    refused(&table("at: []"), &[("E0417", "[]")]);
}

#[test]
fn sensors_are_checked() {
    let file = |sensors: &str, used: &str| {
        let growth = format!("growth: {{sensor: {used}, coefficient: 1 um/K, reference: 20 degC}}");
        let head = "calibration: 1\nmachine: m\nconstants: {Xt: 0 mm}\n";
        format!("{head}sensors: {sensors}\nerrors: {{EZS: [{{{growth}}}]}}\n")
    };
    refused_file(&file("{body: {mean: [T1, T2]}}", "body"), &[]);
    refused_file(&file("{body: {mean: [T1, T2]}}", "T3"), &[("W0401", "body")]);
    refused_file(&file("{body: {mean: []}}", "body"), &[("E0422", "[]")]);
    refused_file(&file("{body: {mean: T1}}", "body"), &[("E0422", "T1")]);
    refused_file(&file("{body: {}}", "body"), &[("E0422", "body")]);
    refused_file(&file("{body: {mean: [T1], initial: T1}}", "body"), &[("E0422", "body")]);
    refused_file(&file("{body: {maen: [T1]}}", "body"), &[("E0422", "body"), ("E0403", "maen")]);
    refused_file(&file("{body: T1}", "body"), &[("E0404", "T1")]);
    refused_file(&file("{body: {initial: [T1]}}", "body"), &[("E0404", "[T1]")]);
    refused_file(&file("[body]", "body"), &[("E0404", "[body]")]);
    refused_file(
        &file("{a: {mean: [b, T1]}, b: {initial: c}, c: {mean: [a]}}", "a"),
        &[("E0423", "a"), ("E0423", "b"), ("E0423", "c")],
    );
    refused_file(&file("{a: {initial: a}}", "a"), &[("E0423", "a")]);
    refused_file(&file("{a: {mean: [T1]}}", "[a]"), &[("W0401", "a"), ("E0404", "[a]")]);
}

#[test]
fn long_chains_of_derived_sensors_are_read_in_time() {
    let links: Vec<_> = (0..10_000).map(|link| format!("s{}: {{initial: s{link}}}", link + 1)).collect();
    let text = format!(
        "calibration: 1\nmachine: m\nconstants: {{Xt: 0 mm}}\nsensors: {{{}}}\nerrors: {{EXX: [{{growth: {{sensor: s10000, coefficient: 1 um/K, reference: 20 degC}}}}]}}\n",
        links.join(", ")
    );
    refused_file(&text, &[]);
}

#[test]
fn all_mistakes_of_a_file_are_told_at_once() {
    let text = "\
calibration: 3
machine: mill
constants: {Xz: 1 deg}
limits: {compensation: 1 s}
errors:
  EXX: [{table: {axis: Q, start: 0 mm, step: 0 mm, unit: arcsec, values: [1, oops]}}, {lagg: {}}]
  EQQ: 1 um
";
    let expected = [
        ("E0402", "3"),
        ("E0406", "constants"),
        ("E0405", "Xz"),
        ("E0307", "deg"),
        ("E0307", "s"),
        ("E0414", "Q"),
        ("E0419", "0 mm"),
        ("E0413", "arcsec"),
        ("E0301", "oops"),
        ("E0409", "lagg"),
        ("E0407", "EQQ"),
    ];
    refused_file(text, &expected);
    let (_, diagnostics, _) = read_with_diagnostics(text);
    assert!(diagnostics.iter().all(|one| one.help.is_some()), "{diagnostics:?}");
}

#[test]
fn a_mistake_looks_like_this() {
    let text = with_error_motions("EBX: [{polynomial: {per: mm, unit: um, coefficients: [1, 2]}}]");
    let (_, diagnostics, source) = read_with_diagnostics(&text);
    let expected = "\
error[E0413]: EBX must be an angle, but `um` is a length
 --> calibrations/test.yaml:5:38
  |
5 |   EBX: [{polynomial: {per: mm, unit: um, coefficients: [1, 2]}}]
  |                                      ^^
  |
  = help: use a unit such as `urad`
";
    assert_eq!(crate::diagnostic::render(&source, &diagnostics, false), expected);
}

/// A play of EXX with these factors.
fn times(lost_motion: &str, factors: &str) -> String {
    format!("{{EXX: [{{backlash: {{lost_motion: {lost_motion}, times: {factors}}}}}]}}")
}

#[test]
fn factors_are_checked() {
    refused(&times("1 um/mm", "[{position: X}]"), &[]);
    refused(&times("1 um", "[{positon: X}]"), &[("E0428", "positon")]);
    refused(&times("1 um", "[{direction: X, speed: X}]"), &[("E0428", "speed")]);
    refused(&times("1 um", "[direction]"), &[("E0428", "direction")]);
    refused(&times("1 um", "[]"), &[("E0417", "[]")]);
    refused(&times("1 um", "{direction: X}"), &[("E0404", "{direction: X}")]);
    refused(&times("1 um", "[{direction: Q}]"), &[("E0414", "Q")]);
    refused(&times("1 um/mm", "[{position: X, over: 1 mm}]"), &[("E0412", "over")]);
    refused(&times("1 um", "[{fading: X}]"), &[("E0411", "fading")]);
    refused(&times("1 um", "[{fading: X, over: 0 mm/s}]"), &[("E0419", "0 mm/s")]);
    refused(&times("1 um", "[{fading: X, over: 1 mm}]"), &[("E0307", "mm")]);
    refused(&times("1 um/mm^4", "[{position: X, power: 4}]"), &[("E0419", "4")]);
    refused(&times("1 um/mm", "[{position: X, within: [2 mm, 1 mm]}]"), &[("E0418", "1 mm")]);
    refused(&times("1 um/mm", "[{position: X, within: [2 mm]}]"), &[("E0417", "[2 mm]")]);
    refused(&times("1 um/K", "[{play: T, reference: 20 degC, width: -1 K}]"), &[("E0419", "-1 K")]);
    refused(&times("1 um", "[{curve: X, at: [0 mm, 0 mm], values: [1, 2]}]"), &[("E0418", "0 mm")]);
    refused(&times("1 um", "[{curve: X, at: [0 mm, 1 mm], values: [1]}]"), &[("E0417", "values")]);
    // Of two factors each mistake is told.
    refused(&times("1 um", "[{direction: Q}, {speed: R}]"), &[("E0414", "Q"), ("E0414", "R")]);
}

#[test]
fn the_units_of_factors_are_checked() {
    refused(&times("20 nm/N", "[{load: feed}]"), &[]);
    refused(&times("20 nm/V", "[{load: feed}]"), &[]);
    refused(&times("20 nm", "[{load: feed}]"), &[("E0429", "nm")]);
    refused(
        &times("20 nm/mm", "[{position: X}, {temperature: T, reference: 20 degC}]"),
        &[("E0429", "nm/mm")],
    );
    refused(&times("20 nm/mm/K", "[{position: X}, {temperature: T, reference: 20 degC}]"), &[]);
    refused(&times("5", "[{position: X}]"), &[("E0306", "5")]);
    let told = words(&times("20 nm", "[{position: X}]"));
    let expected = "E0429 `lost_motion` of EXX must be a plain number with these factors, but `nm` is a length | use a unit such as \
                    `um/m`: its factors together are in `mm` and EXX is a length";
    assert_eq!(told, [expected]);
    // Of a list the unit is that of all its numbers, and what is not of the motion keeps its own.
    let table = |unit: &str| {
        format!(
            "{{EXX: [{{table: {{start: 0 mm, step: 1 mm, unit: {unit}, values: [1], times: [{{speed: X}}]}}}}]}}"
        )
    };
    refused(&table("um.s/mm"), &[]);
    refused(&table("um"), &[("E0413", "um")]);
    let wave =
        "{EXX: [{cyclic: {period: 10 mm/mm, amplitude: 1 um/mm, phase: 1 rad, times: [{position: X}]}}]}";
    refused(wave, &[("E0307", "mm/mm")]);
}

#[test]
fn terms_that_take_no_factors_say_so() {
    refused("{EXX: [{delay: {time: 1 ms, times: [{direction: X}]}}]}", &[("E0412", "times")]);
    refused("{EXX: [{delay: {time: 0 s}}]}", &[("E0419", "0 s")]);
    refused("{EXX: [{product: {value: 1 um}}]}", &[("E0411", "product")]);
    refused("{EXX: [{lag: {gain: 5 1/s, times: [{direction: X}]}}]}", &[]);
    let rings = "{EXX: [{lag: {gain: 5 1/s, frequency: 20 Hz, times: [{direction: X}]}}]}";
    refused(rings, &[("E0416", "times")]);
}
