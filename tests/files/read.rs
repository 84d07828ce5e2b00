//! Files that are read: of other systems, other programs and other countries, and things that are no files.
#![cfg(target_os = "linux")]

use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::Command;

use super::{
    CALIBRATION, MACHINE, READERS, data, folder, names, on_stage, program, run, stage, status, text,
};

/// Runs each reader on the stage with its file changed; gives the reader's arguments, status and error text.
fn changed(test: &str, change: impl Fn(&Path), mut told: impl FnMut(&[&str], &str, i32, &str)) {
    for (name, arguments) in READERS {
        let folder = folder(test);
        stage(&folder);
        change(&folder.join(name));
        let output = on_stage(arguments, &folder);
        let err = text(&output.stderr);
        told(arguments, name, status(&output), &err);
        assert!(!folder.join("out/recording.yaml").exists() || status(&output) == 0, "{arguments:?}");
    }
}

/// The file is named, and what it lacks is said.
#[test]
fn an_empty_file() {
    changed(
        "empty",
        |file| fs::write(file, "").unwrap(),
        |arguments, name, status, err| {
            assert!(status > 0 && err.contains(name) && err.contains("error"), "{arguments:?}: {err}");
        },
    );
}

#[test]
fn a_folder_in_place_of_a_file() {
    changed(
        "in-place",
        |file| {
            fs::remove_file(file).unwrap();
            fs::create_dir(file).unwrap();
        },
        |arguments, name, status, err| {
            assert!(status > 0 && err.contains(name), "{arguments:?}: {err}");
            assert!(err.contains("folder") || err.contains("directory"), "{arguments:?}: {err}");
        },
    );
}

#[test]
fn a_file_that_is_gone() {
    changed(
        "gone",
        |file| fs::remove_file(file).unwrap(),
        |arguments, name, status, err| {
            assert!(
                status > 0 && err.contains(name) && err.to_lowercase().contains("no such file"),
                "{arguments:?}: {err}"
            );
        },
    );
}

#[test]
fn bytes_that_are_no_text() {
    changed(
        "bytes",
        |file| fs::write(file, b"\xff\xfe\x00a\x00b\n\x80\x81").unwrap(),
        |arguments, name, status, err| {
            assert!(status > 0 && err.contains(name), "{arguments:?}: {err}");
            assert!(err.contains("UTF-8") || err.contains("plain text"), "{arguments:?}: {err}");
        },
    );
}

/// The marks of another system change nothing.
#[test]
fn line_ends_and_a_mark_before_the_text() {
    for (_, arguments) in READERS {
        let (plain, marked) = (folder("plain"), folder("marked"));
        stage(&plain);
        stage(&marked);
        for name in names(&marked) {
            let file = marked.join(name);
            let text = fs::read_to_string(&file).unwrap().replace('\n', "\r\n");
            fs::write(&file, format!("\u{feff}{text}")).unwrap();
        }
        let (plain, marked) = (on_stage(arguments, &plain), on_stage(arguments, &marked));
        assert_eq!(status(&marked), status(&plain), "{arguments:?}: {}", text(&marked.stderr));
        let other_name = |bytes: &[u8]| text(bytes).replace("/marked/", "/plain/").replace("\r\n", "\n");
        // The header of positions is given back as it came in, the mark taken away.
        assert_eq!(other_name(&marked.stdout), text(&plain.stdout), "{arguments:?}");
    }
}

/// A device without an end is not read to its end.
#[test]
fn a_file_without_end() {
    changed(
        "endless",
        |file| {
            fs::remove_file(file).unwrap();
            std::os::unix::fs::symlink("/dev/zero", file).unwrap();
        },
        |arguments, name, status, err| {
            assert!(status > 0 && err.contains(name) && err.len() < 10_000, "{arguments:?}: {err}");
            assert!(
                err.contains("larger than 8 MiB") || err.contains("longer than 1 MiB"),
                "{arguments:?}: {err}"
            );
        },
    );
}

/// A pipe in place of a file, as in `abbe derive <(...)`.
#[test]
fn a_named_pipe() {
    for (name, arguments) in READERS {
        // A recording in place of a path is read twice: as a file of one of two kinds, and then as a recording.
        if arguments[0] == "simulate" && name == "recording.yaml" {
            continue;
        }
        let folder = folder("read-pipe");
        stage(&folder);
        let file = folder.join(name);
        let content = fs::read(&file).unwrap();
        let plain = on_stage(arguments, &folder);
        fs::remove_file(&file).unwrap();
        assert!(Command::new("mkfifo").arg(&file).status().unwrap().success());
        let writer = std::thread::spawn(move || fs::write(&file, content).unwrap());
        let piped = on_stage(arguments, &folder);
        assert_eq!(
            (status(&piped), text(&piped.stdout)),
            (status(&plain), text(&plain.stdout)),
            "{arguments:?}: {}",
            text(&piped.stderr)
        );
        writer.join().unwrap();
    }
}

/// Names that are no text: the commands that take paths read them, those that take names or paths say what is wrong.
#[test]
fn names_that_are_no_text() {
    let folder = folder("names");
    let odd = folder.join(OsStr::from_bytes(b"gr\xf6\xdfe"));
    fs::create_dir(&odd).unwrap();
    stage(&odd);
    for (_, arguments) in READERS {
        let mut command = program();
        for argument in arguments {
            match argument.strip_prefix("@/") {
                Some(name) => command.arg(odd.join(name)),
                None => command.arg(argument),
            };
        }
        let positions = fs::File::open(odd.join("positions.csv")).unwrap();
        let output = command.stdin(positions).output().unwrap();
        let err = text(&output.stderr);
        if matches!(arguments[0], "derive" | "expand" | "check") {
            assert!(status(&output) == 2 && err.contains("UTF-8"), "{arguments:?}: {err}");
        } else {
            assert!(status(&output) <= 1 && !err.contains("error"), "{arguments:?}: {err}");
        }
    }
    let target = folder.join(OsStr::from_bytes(b"n\xe4u.yaml"));
    let recording = odd.join("recording.yaml");
    let output = run(&[
        "diagnose".as_ref(),
        recording.as_os_str(),
        "--write-calibration".as_ref(),
        target.as_os_str(),
    ]);
    // The new file would have to name the machine by a path that no YAML file can hold.
    assert_eq!(status(&output), 2, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("UTF-8") && !target.exists(), "{}", text(&output.stderr));
}

/// Compensation with positions as other countries write them: the row, the column and what to write.
#[test]
fn positions_of_other_countries() {
    let folder = folder("countries");
    stage(&folder);
    for (positions, parts) in [
        ("x\n1,5\n", &["row 1", "2 cells for 1 column", "decimal comma"][..]),
        ("x\n\"1,5\"\n", &["row 1", "column `x`", "`1,5` is not a number", "decimal point"]),
        ("x;note\n1,5;a\n", &["row 1", "column `x`", "`1,5` is not a number", "decimal point"]),
        ("x\n1 000\n", &["row 1", "`1 000` is not a number"]),
        ("x\n\u{2212}1\n", &["row 1", "is not a number"]),
    ] {
        fs::write(folder.join("positions.csv"), positions).unwrap();
        let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
        let err = text(&output.stderr);
        assert!(status(&output) > 0, "{positions}: {err}");
        for part in parts {
            assert!(err.contains(part), "{positions}: no {part:?} in {err}");
        }
    }
}

/// A table with semicolons means what the same table with commas means; a decimal comma is told where it stands.
#[test]
fn recordings_of_other_countries() {
    let (plain, other) = (folder("points"), folder("commas"));
    stage(&plain);
    stage(&other);
    fs::write(other.join("data.csv"), data().replace(',', ";")).unwrap();
    for arguments in
        [&["evaluate", "@/recording.yaml"][..], &["diagnose", "@/recording.yaml", "--format", "json"]]
    {
        let (plain, other) = (on_stage(arguments, &plain), on_stage(arguments, &other));
        assert_eq!(status(&other), status(&plain), "{}", text(&other.stderr));
        assert_eq!(text(&other.stdout).replace("/commas/", "/points/"), text(&plain.stdout));
    }
    let wholly = data().replace(',', ";").replace('.', ",");
    for (table, place) in [(wholly, "data.csv:2:7"), (data().replace("10.024", "10,024"), "data.csv:3:")] {
        fs::write(plain.join("data.csv"), table).unwrap();
        let output = on_stage(&["evaluate", "@/recording.yaml"], &plain);
        let err = text(&output.stderr);
        assert!(status(&output) == 1 && err.contains(place) && err.contains("decimal comma"), "{err}");
        assert!(err.contains("help:"), "{err}");
    }
}

/// YAML of other countries: a number is not read as two, and not in silence as another one.
#[test]
fn calibrations_of_other_countries() {
    for (wrong, part) in [("[0, 1,5 um]", "calibration.yaml:6"), ("\"1,5 um\"", "write a point: `1.5`")] {
        let folder = folder("yaml-commas");
        stage(&folder);
        let old = "[{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 1]}}]";
        fs::write(folder.join("calibration.yaml"), CALIBRATION.replace(old, wrong)).unwrap();
        let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
        let err = text(&output.stderr);
        assert!(
            status(&output) == 2 && err.contains("calibration.yaml:6") && err.contains(part),
            "{wrong}: {err}"
        );
        assert_eq!(output.stdout.len(), 0);
    }
}

/// Numbers at the edge of what a computer holds are refused where they stand, or give numbers.
#[test]
fn numbers_at_the_edge() {
    for edge in ["1e400", "1e308", "-1e308", "5e-324", "1e-400", "-0", "nan", "-inf"] {
        let files = [
            ("positions.csv", format!("x\n{edge}\n1\n")),
            ("calibration.yaml", CALIBRATION.replace("[0, 1]", &format!("[{edge}, {edge}]"))),
            ("calibration.yaml", CALIBRATION.replace("50 mm", &format!("{edge} mm"))),
            ("calibration.yaml", CALIBRATION.replace(" 1 mm", &format!(" {edge} mm"))),
            (
                "machine.yaml",
                MACHINE.replace("along: +X", &format!("along: +X, origin: [{edge}, 0, {edge} mm]")),
            ),
            ("data.csv", data().replace("10.024", edge)),
            ("path.yaml", super::PATH.replace("20 mm", &format!("{edge} mm"))),
            ("path.yaml", super::PATH.replace("600 mm/min", &format!("{edge} mm/min"))),
            ("path.yaml", super::PATH.replace("dwell: 1 s", &format!("dwell: {edge} s"))),
            ("path.yaml", super::PATH.replace("pause: 1 s", &format!("pause: {edge} s"))),
        ];
        for (name, content) in files {
            let folder = folder("edge");
            stage(&folder);
            fs::write(folder.join(name), &content).unwrap();
            for (_, arguments) in READERS.into_iter().filter(|(_, arguments)| reads(arguments, name)) {
                let output = on_stage(arguments, &folder);
                let told = text(&output.stdout);
                let status = status(&output);
                // What generated code says about itself in its comments is prose.
                let mut words = (told.lines().filter(|line| !line.trim_start().starts_with("//")))
                    .flat_map(|line| line.split(|letter: char| !letter.is_ascii_alphanumeric()));
                let none = words.find(|word| ["NaN", "inf", "Infinity", "infinity"].contains(word));
                // A row that was not taken is quoted in the error alone.
                assert_eq!(
                    none, None,
                    "{edge} in {name}, {arguments:?}, status {status}:\n{content}\n{told}"
                );
                let recorded = fs::read_to_string(folder.join("out/data.csv")).unwrap_or_default();
                assert!(
                    !recorded.contains("NaN") && !recorded.contains("inf"),
                    "{edge} in {name}: {recorded}"
                );
            }
        }
    }
}

/// Whether a command reads a file of the stage, itself or through another one.
fn reads(arguments: &[&str], name: &str) -> bool {
    let given = |file: &str| arguments.contains(&format!("@/{file}").as_str());
    match name {
        "positions.csv" => arguments[0] == "compensate",
        "data.csv" => given("recording.yaml"),
        "calibration.yaml" => given(name) || given("recording.yaml"),
        "machine.yaml" => true,
        _ => given(name),
    }
}
