//! Standard input and output: readers that go away, devices that are full, other languages.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::Read;
use std::process::Stdio;

use super::{LIMITS, PLAN, folder, on_stage, placed, program, run, stage, status, text};

/// Every command that prints, in its forms; `@` is the folder of the stage.
const PRINTERS: [&[&str]; 27] = [
    &["derive", "trunnion-5axis"],
    &["derive", "trunnion-5axis", "--format", "html"],
    &["derive", "@/machine.yaml", "--format", "json"],
    &["derive", "trunnion-5axis", "--format", "latex"],
    &["derive", "trunnion-5axis", "--format", "maxima"],
    &["check", "@/machine.yaml", "@/stage.eqs"],
    &["expand", "trunnion-5axis"],
    &["compensate", "@/calibration.yaml"],
    &["compensate", "@/calibration.yaml", "--summary"],
    &["diagnose", "@/recording.yaml"],
    &["diagnose", "@/recording.yaml", "--format", "json"],
    &["diagnose", "@/recording.yaml", "--format", "html"],
    &["evaluate", "@/recording.yaml"],
    &["evaluate", "@/recording.yaml", "--format", "json"],
    &["evaluate", "@/recording.yaml", "--format", "html"],
    &["update", "@/calibration.yaml", "@/recording.yaml"],
    &["calibrate", "@/set-up.yaml"],
    &["calibrate", "@/set-up.yaml", "--format", "json"],
    &["export", "linuxcnc", "@/calibration.yaml", "--output", "@/", "--force", "--range", "X=0:100"],
    LIMITS,
    PLAN,
    &["fleet", "run", "@/fleet.yaml", "--list"],
    &["new", "XYFZ"],
    &["explain"],
    &["explain", "backlash"],
    &["completions", "bash"],
    &["man"],
];

/// A command that the list forgets would not be tested.
#[test]
fn every_command_is_listed() {
    let help = text(&run(&["--help"]).stdout);
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    // What a command does may take more lines, which stand further in.
    let commands = commands.take_while(|line| !line.is_empty()).filter_map(|line| line.strip_prefix("  "));
    let commands = commands.filter_map(|line| line.split(' ').next().filter(|name| !name.is_empty()));
    let mut count = 0;
    for command in commands.filter(|command| *command != "help" && *command != "simulate") {
        assert!(PRINTERS.iter().any(|printer| printer[0] == command), "{command}");
        count += 1;
    }
    assert!(count > 8, "{help}");
}

/// `abbe ... | head -1`, and a reader that reads nothing at all.
#[test]
fn a_reader_that_goes_away() {
    let folder = folder("closed");
    stage(&folder);
    let many: String = (0..20_000).map(|row| format!("{row}\n")).collect();
    fs::write(folder.join("positions.csv"), format!("x\n{many}")).unwrap();
    for arguments in PRINTERS {
        for bytes in [0, 1] {
            let positions = fs::File::open(folder.join("positions.csv")).unwrap();
            let mut command = program();
            command.args(placed(arguments, &folder)).stdin(positions);
            let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
            let mut out = child.stdout.take().unwrap();
            out.read_exact(&mut vec![0; bytes]).unwrap();
            drop(out);
            let output = child.wait_with_output().unwrap();
            let err = text(&output.stderr);
            // The data may say no; nobody is told that nobody listens.
            assert!(status(&output) <= 1, "{arguments:?}: {err}");
            assert!(!err.contains("pipe") && !err.contains("cannot write"), "{arguments:?}: {err}");
        }
    }
}

/// What a command says by its status, and what else it writes, does not depend on who reads its report.
#[test]
fn a_reader_that_goes_away_hides_nothing() {
    let folder = folder("closed-status");
    stage(&folder);
    let verdicts = "adequate,undecided,unexplained,left-out-physics,not-repeatable";
    for (arguments, expected) in [
        (&["diagnose", "@/recording.yaml", "--fail-on", verdicts][..], 1),
        (&["diagnose", "@/recording.yaml", "--write-calibration", "/proc/new.yaml"], 2),
        (&["calibrate", "@/set-up.yaml", "--output", "/proc/new.yaml"], 2),
    ] {
        let mut command = program();
        command.args(placed(arguments, &folder)).stdin(Stdio::null());
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(status(&output), expected, "{arguments:?}: {}", text(&output.stderr));
    }
}

/// A report that could not be written was not made: no script may take it for one.
#[test]
fn an_output_that_is_full() {
    let folder = folder("full-output");
    stage(&folder);
    for arguments in PRINTERS {
        let positions = fs::File::open(folder.join("positions.csv")).unwrap();
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut command = program();
        command.args(placed(arguments, &folder)).stdin(positions).stdout(full);
        let output = command.output().unwrap();
        let err = text(&output.stderr);
        assert_eq!(status(&output), 2, "{arguments:?}: {err}");
        assert!(err.contains("error: cannot write to standard output"), "{arguments:?}: {err}");
    }
}

/// Warnings that nobody can read are lost, the work is done.
#[test]
fn a_standard_error_that_is_full() {
    let folder = folder("full-error");
    stage(&folder);
    for arguments in PRINTERS.iter().copied().filter(|arguments| arguments[0] != "update") {
        let output = |stderr: Stdio| {
            let positions = fs::File::open(folder.join("positions.csv")).unwrap();
            let mut command = program();
            command.args(placed(arguments, &folder)).stdin(positions).stderr(stderr);
            command.stdout(Stdio::piped()).spawn().unwrap().wait_with_output().unwrap()
        };
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let (full, read) = (output(full.into()), output(Stdio::piped()));
        assert_eq!(
            (full.status.code(), text(&full.stdout)),
            (read.status.code(), text(&read.stdout)),
            "{arguments:?}"
        );
    }
}

/// A number is written and read with a point in every country.
#[test]
fn the_language_of_the_system() {
    let folder = folder("language");
    stage(&folder);
    for arguments in PRINTERS {
        let output = |language: &str| {
            let positions = fs::File::open(folder.join("positions.csv")).unwrap();
            let mut command = program();
            for name in ["LC_ALL", "LC_NUMERIC", "LANG", "LANGUAGE"] {
                command.env(name, language);
            }
            let output = command.args(placed(arguments, &folder)).stdin(positions).output().unwrap();
            (status(&output), output.stdout, output.stderr)
        };
        assert!(output("de_DE.UTF-8") == output("C"), "{arguments:?} depends on the language");
        assert!(output("tr_TR.ISO-8859-9") == output("C"), "{arguments:?} depends on the language");
    }
}

#[test]
fn positions_that_never_come() {
    let folder = folder("empty-input");
    stage(&folder);
    fs::write(folder.join("positions.csv"), "").unwrap();
    let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
    assert_eq!((status(&output), output.stdout.len()), (1, 0));
    assert!(text(&output.stderr).contains("standard input is empty"), "{}", text(&output.stderr));
    let mut folder_as_input = program();
    folder_as_input.args(placed(&["compensate", "@/calibration.yaml"], &folder));
    let output = folder_as_input.stdin(fs::File::open(&folder).unwrap()).output().unwrap();
    assert_eq!(status(&output), 2, "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("cannot read standard input"), "{}", text(&output.stderr));
}

/// A row that goes on and on is not kept, and not shown.
#[test]
fn a_row_without_end() {
    let folder = folder("endless-row");
    stage(&folder);
    let line = "1".repeat(3 << 20);
    let quoted = format!("x\n\"{}", "1\n".repeat(2 << 20));
    for positions in [format!("x\n{line}\n"), format!("x\n1\n{line}"), quoted, line] {
        fs::write(folder.join("positions.csv"), positions).unwrap();
        let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
        let err = text(&output.stderr);
        assert_eq!(status(&output), 1, "{}", err.len());
        assert!(err.contains("longer than 1 MiB") && err.len() < 1000, "{} bytes", err.len());
    }
    let many: String = (0..400_000).map(|row| format!("{}\n", row % 100)).collect();
    fs::write(folder.join("positions.csv"), format!("x\n{many}")).unwrap();
    let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
    assert_eq!(
        (status(&output), text(&output.stdout).lines().count()),
        (0, 400_001),
        "{}",
        text(&output.stderr)
    );
}

/// What stands in a file steers no terminal.
#[test]
fn escape_sequences_of_a_file() {
    let folder = folder("escapes");
    stage(&folder);
    for positions in [
        "x\n\u{1b}[31m1\n",
        "\u{1b}[2Jnote,x\na,1\n",
        "x,x\u{1b}c,x\u{1b}c\n1,2,3\n",
        "x\n#unit,\u{1b}c\n1\n",
    ] {
        fs::write(folder.join("positions.csv"), positions).unwrap();
        let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
        status(&output);
        let err = text(&output.stderr);
        assert!(!err.is_empty() && !err.contains('\u{1b}'), "{err:?}");
    }
}

/// A header as long as a row may be, with as many names as it can hold.
#[test]
fn a_header_of_many_columns() {
    let folder = folder("wide");
    stage(&folder);
    let names: String = (0..140_000).map(|number| format!(",{number:x}")).collect();
    let cells = ",1".repeat(140_000);
    fs::write(folder.join("positions.csv"), format!("x{names}\n1{cells}\n")).unwrap();
    let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
    let err = text(&output.stderr);
    assert_eq!(status(&output), 0, "{err}");
    assert!(err.contains("139980 more columns") && err.lines().count() < 30, "{err}");
    fs::write(folder.join("positions.csv"), format!("x{}\n", ",same".repeat(100_000))).unwrap();
    let output = on_stage(&["compensate", "@/calibration.yaml"], &folder);
    assert_eq!(status(&output), 2);
    assert!(text(&output.stderr).lines().count() <= 101);
}
