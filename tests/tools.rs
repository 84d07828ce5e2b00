//! Tools of a calibration: each answers as a calibration with its constants would. In: files written here. Out: what the command line
//! answers, beside calibrations without tools.

use std::fs;
use std::path::PathBuf;

use crate::cli::{Run, abbe};

/// A mill whose X is turned by 20 urad about Y, which moves the tip by that times the length of the tool.
const ERRORS: &str = "errors:\n  EBX: 20 urad\n  EXX:\n    - polynomial: {unit: um, per: mm, coefficients: [0, 0.05]}\n    - backlash: {lost_motion: 10 um, wind_up: 4 mm}\n";
const TOOLS: &str = "tools:\n  T1: {Zt: 80 mm}\n  T12: {Xt: 5 mm, Zt: -1.5 in}\n  probe: {}\n";

fn file(name: &str, text: &str) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tools");
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_owned()
}

fn calibration(constants: &str, tools: &str) -> String {
    format!("calibration: 1\nmachine: FXYZ\nconstants: {{{constants}}}\n{tools}{ERRORS}")
}

fn compensated(calibration: &str, rows: &str) -> Run {
    abbe(&["compensate", calibration], rows)
}

#[test]
fn each_row_is_answered_with_its_tool() {
    let with = file("with.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", TOOLS));
    let names = ["", "T1", "12", "T12", "probe", "1", ""];
    let rows: String =
        names.iter().enumerate().map(|(row, tool)| format!("{},0,0,{tool}\n", 10 * row)).collect();
    let run = compensated(&with, &format!("x,y,z,tool\n{rows}"));
    assert_eq!((run.status, run.err.as_str()), (0, ""));

    // The same way with one tool throughout: what the terms remember is that of the way, whatever the tools.
    let alone = |constants: &str| {
        let one = file("one.yaml", &calibration(constants, ""));
        let rows: String = (0..names.len()).map(|row| format!("{},0,0\n", 10 * row)).collect();
        compensated(&one, &format!("x,y,z\n{rows}")).out
    };
    let of = |tool: &str| match tool {
        "T1" | "1" => alone("Xt: 0 mm, Yt: 0 mm, Zt: 80 mm"),
        "T12" | "12" => alone("Xt: 5 mm, Yt: 0 mm, Zt: -38.1 mm"),
        _ => alone("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm"),
    };
    for (row, (line, tool)) in run.out.lines().skip(1).zip(names).enumerate() {
        let expected = of(tool).lines().nth(row + 1).unwrap().to_owned();
        let (place, numbers) = expected.split_at(expected.match_indices(',').nth(2).unwrap().0);
        assert_eq!(line, format!("{place},{tool}{numbers}"), "row {row}");
    }
}

/// `--tool` is the tool of rows that name none; a row that names one has that.
#[test]
fn a_tool_is_named_once_for_all_rows() {
    let with = file("once.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", TOOLS));
    let alone = file("once-alone.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 80 mm", ""));
    let rows = "x,y,z\n0,0,0\n100,0,0\n";
    let expected = compensated(&alone, rows).out;
    for name in ["T1", "1"] {
        let run = abbe(&["compensate", &with, "--tool", name], rows);
        assert_eq!((run.status, run.err.as_str(), run.out.as_str()), (0, "", expected.as_str()));
    }
    assert_ne!(compensated(&with, rows).out, expected);
    let mixed = "x,y,z,tool\n0,0,0,\n100,0,0,probe\n";
    let named = "x,y,z,tool\n0,0,0,T1\n100,0,0,probe\n";
    let numbers = |text: &str| text.replace(",T1,", ",,");
    assert_eq!(
        abbe(&["compensate", &with, "--tool", "T1"], mixed).out,
        numbers(&compensated(&with, named).out)
    );
}

#[test]
fn the_map_is_that_of_the_named_tool() {
    let corners = "x,y,z\n0,0,0\n100,100,50\n";
    let drawn = |calibration: &str, name: &str, options: &[&str]| {
        let map = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tools").join(name);
        let map = map.to_str().unwrap();
        let run = abbe(&[&["compensate", calibration, "--map", map, "--force"], options].concat(), corners);
        assert_eq!((run.status, run.err.as_str()), (0, ""));
        fs::read_to_string(map).unwrap()
    };
    let with = file("map.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", TOOLS));
    let alone = file("map-alone.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 80 mm", ""));
    let expected = drawn(&alone, "alone.svg", &[]);
    assert_eq!(drawn(&with, "named.svg", &["--tool", "T1"]), expected);
    assert_ne!(drawn(&with, "none.svg", &[]), expected);
}

/// X pitches more and more along its way: the table of its error depends on the length of the tool.
#[test]
fn exported_files_are_those_of_the_named_tool() {
    let pitch = "errors:\n  EBX: [{polynomial: {unit: urad, per: mm, coefficients: [0, 0.1]}}]\n";
    let text = |length: u32, tools: &str| {
        format!(
            "calibration: 1\nmachine: FXYZ\nconstants: {{Xt: 0 mm, Yt: 0 mm, Zt: {length} mm}}\n{tools}{pitch}"
        )
    };
    let exported = |name: &str, text: &str, options: &[&str]| {
        let calibration = file(&format!("{name}.yaml"), text);
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("tools").join(name);
        fs::create_dir_all(&folder).unwrap();
        let output = folder.to_str().unwrap();
        let ways =
            ["--range", "X=0:100", "--range", "Y=0:100", "--range", "Z=0:100", "--output", output, "--force"];
        let run = abbe(&[&["export", "linuxcnc", &calibration], &ways[..], options].concat(), "");
        assert_eq!(run.status, 0, "{}", run.err);
        fs::read_to_string(folder.join("x.comp")).unwrap()
    };
    let expected = exported("export-alone", &text(80, ""), &[]);
    assert_eq!(exported("export-named", &text(150, TOOLS), &["--tool", "T1"]), expected);
    assert_ne!(exported("export-none", &text(150, TOOLS), &[]), expected);
}

/// The centre of a circle is where the tip is: the figures of a recording with a tool are those of a calibration with its constants.
#[test]
fn a_recording_is_evaluated_with_the_named_tool() {
    let recorded = fs::read_to_string("recordings/postech-ballbar/recording.yaml").unwrap();
    let data = fs::canonicalize("recordings/postech-ballbar/data.csv").unwrap();
    let evaluated = |name: &str, constants: &str, tools: &str, options: &[&str]| {
        let machine = format!("calibration: 1\nmachine: postech-mill\nconstants: {{{constants}}}\n{tools}");
        file(&format!("{name}-calibration.yaml"), &machine);
        let text = recorded
            .replace("../../calibrations/postech-mill.yaml", &format!("{name}-calibration.yaml"))
            .replace("data: data.csv", &format!("data: {}", data.display()));
        let recording = file(&format!("{name}.yaml"), &text);
        abbe(&[&["evaluate", &recording, "--format", "json", "--quiet"], options].concat(), "")
    };
    let tools = "tools: {long: {Xt: 30 mm, Zt: 90 mm}}\n";
    let alone = evaluated("evaluate-alone", "Xt: 30 mm, Yt: 0 mm, Zt: 90 mm", "", &[]);
    let named = evaluated("evaluate-named", "Xt: 0 mm, Yt: 0 mm, Zt: 120 mm", tools, &["--tool", "long"]);
    let none = evaluated("evaluate-none", "Xt: 0 mm, Yt: 0 mm, Zt: 120 mm", tools, &[]);
    assert_eq!((named.status, named.err.as_str()), (alone.status, ""));
    let figures = |run: &Run| {
        run.out.replace("evaluate-named", "evaluate-alone").replace("evaluate-none", "evaluate-alone")
    };
    assert_eq!(figures(&named), figures(&alone));
    assert_ne!(figures(&none), figures(&alone));
}

#[test]
fn a_name_that_no_tool_has_is_refused_before_anything_is_written() {
    let with = file("refused.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", TOOLS));
    let without = file("refused-none.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", ""));
    let told = |words: &[&str], help: &str| {
        let run = abbe(words, "x,y,z\n0,0,0\n");
        assert_eq!((run.status, run.out.as_str()), (2, ""), "{words:?}");
        assert!(run.err.contains(help), "{}", run.err);
    };
    for command in [&["compensate"][..], &["export", "linuxcnc"]] {
        let with = [command, &[&with, "--tool", "prob"]].concat();
        told(&with, "error: --tool: the calibration has no tool `prob`\nhelp: is it `probe`?");
        let other = [command, &[&without, "--tool", "T9"]].concat();
        told(&other, "help: write `tools: {T9: {Zt: -120 mm}}` in it");
        let without = [command, &[&without, "--tool", "T1"]].concat();
        told(&without, "help: write `tools: {T1: {Zt: -120 mm}}` in it");
    }
    told(
        &["evaluate", "recordings/postech-ballbar/recording.yaml", "--tool", "T1"],
        "error: --tool: the calibration has no tool `T1`",
    );
    let bare = fs::read_to_string("recordings/postech-ballbar/recording.yaml").unwrap();
    let data = fs::canonicalize("recordings/postech-ballbar/data.csv").unwrap();
    let bare = bare
        .replace("calibration: ../../calibrations/postech-mill.yaml\n", "")
        .replace("data: data.csv", &format!("data: {}", data.display()));
    let bare = file("bare.yaml", &bare);
    told(
        &["evaluate", &bare, "--tool", "T1"],
        "only a calibration has tools\nhelp: write `calibration: FILE`",
    );
}

#[test]
fn a_tool_that_is_not_there_is_told_with_its_row() {
    let with = file("known.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", TOOLS));
    let run = compensated(&with, "x,y,z,tool\n0,0,0,T1\n0,0,0,prob\n");
    assert_eq!(run.status, 1);
    for words in ["row 2 under the header", "the calibration has no tool `prob`", "is it `probe`?"] {
        assert!(run.err.contains(words), "{}", run.err);
    }
    let run = compensated(&with, "x,y,z,tool\n0,0,0,99\n");
    assert!(run.err.contains("there are T1, T12, probe"), "{}", run.err);
    // Where the calibration has none, the column is one of the user's own.
    let without = file("without.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", ""));
    let run = compensated(&without, "x,y,z,tool\n0,0,0,99\n");
    assert_eq!(run.status, 0);
    assert!(run.err.contains("column `tool` is copied to the output"), "{}", run.err);
}

#[test]
fn mistakes_in_tools_are_told_at_their_places() {
    for (tools, code, place) in [
        ("tools: [T1]\n", "E0404", "[T1]"),
        ("tools: {T1: 80 mm}\n", "E0404", "80 mm"),
        ("tools: {T1: {Zr: 80 mm}}\n", "E0405", "Zr"),
        ("tools: {T1: {Zt: 80}}\n", "E0306", "80"),
        ("tools: {T1: {Zt: 80 deg}}\n", "E0307", "deg"),
        ("tools: {T1: {Zt: 80 mm}, T1: {Zt: 90 mm}}\n", "E0005", "T1"),
    ] {
        let wrong = file("wrong.yaml", &calibration("Xt: 0 mm, Yt: 0 mm, Zt: 150 mm", tools));
        let run = compensated(&wrong, "x,y,z\n0,0,0\n");
        assert_eq!(run.status, 2, "{tools}");
        assert!(run.err.contains(&format!("error[{code}]")), "{tools}: {}", run.err);
        assert!(run.err.contains(place), "{tools}: {}", run.err);
    }
}

#[test]
fn the_table_of_linuxcnc_is_read() {
    let with = file("linuxcnc.yaml", &calibration("Xt: 1 mm, Yt: 0 mm, Zt: 40 mm", ""));
    let table = "; tools of the mill\nT1 P1 Z80 D6 ;end mill\nt12  P2 X-2.5 Y+0 Z+6e1 I10 J20 Q3\n\nT3 P3\n";
    let table = file("tool.tbl", table);
    let rows = "x,y,z,tool\n100,0,0,\n100,0,0,1\n100,0,0,T12\n100,0,0,3\n";
    let run = abbe(&["compensate", &with, "--tools", &table], rows);
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    let alone = |constants: &str| {
        let one = file("one-of-table.yaml", &calibration(constants, ""));
        compensated(&one, "x,y,z\n100,0,0\n").out.lines().nth(1).unwrap()["100,0,0".len()..].to_owned()
    };
    // A tool longer by 80 mm has its tip lower by 80 mm.
    let expected = [
        alone("Xt: 1 mm, Yt: 0 mm, Zt: 40 mm"),
        alone("Xt: 1 mm, Yt: 0 mm, Zt: -40 mm"),
        alone("Xt: 3.5 mm, Yt: 0 mm, Zt: -20 mm"),
        alone("Xt: 1 mm, Yt: 0 mm, Zt: 40 mm"),
    ];
    let found: Vec<&str> = run.out.lines().skip(1).collect();
    for ((line, tool), expected) in found.iter().zip(["", "1", "T12", "3"]).zip(expected) {
        assert_eq!(*line, format!("100,0,0,{tool}{expected}"));
    }
    // In inches.
    let inches = file("inches.tbl", "T1 Z1\n");
    let run =
        abbe(&["compensate", &with, "--tools", &inches, "--tools-unit", "in"], "x,y,z,tool\n100,0,0,1\n");
    assert_eq!(
        run.out.lines().nth(1).unwrap(),
        format!("100,0,0,1{}", alone("Xt: 1 mm, Yt: 0 mm, Zt: 14.6 mm"))
    );
}

#[test]
fn what_is_wrong_in_a_table_of_tools_is_told_at_its_place() {
    let with = file("table.yaml", &calibration("Xt: 1 mm, Yt: 0 mm, Zt: 40 mm", ""));
    for (table, code, place) in [
        ("T1 Z80x\n", "E0801", "80x"),
        ("P1 Z80\n", "E0802", "P1 Z80"),
        ("T1 E80\n", "E0802", "E80"),
        ("T1 Z80\nT1 Z90\n", "E0803", "T1"),
        ("T1 W80\n", "E0804", "W80"),
    ] {
        let table = file("wrong.tbl", table);
        let run = abbe(&["compensate", &with, "--tools", &table], "x,y,z,tool\n0,0,0,1\n");
        assert_eq!(run.status, 2, "{}", run.err);
        assert!(run.err.contains(&format!("error[{code}]")) && run.err.contains(place), "{}", run.err);
        assert_eq!(run.out, "");
    }
}
