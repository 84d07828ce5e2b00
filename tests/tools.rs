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
    assert!(run.err.contains("column `tool` is carried along"), "{}", run.err);
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
