//! Completions and manual pages: made from the arguments that the program reads, so that they name every command and every
//! option, and none that is not there.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::beside::skipped;
use crate::cli::abbe;

/// The commands as the program's help lists them.
fn commands() -> Vec<String> {
    listed(&abbe(&["--help"], "").out)
}

/// The commands that a help lists; none where it has none.
pub(crate) fn listed(help: &str) -> Vec<String> {
    let Some(rows) = help.split("Commands:\n").nth(1) else { return Vec::new() };
    let rows = rows.split("\n\n").next().unwrap();
    let names = rows.lines().filter(|row| row.starts_with("  ") && !row.starts_with("   "));
    names.map(|row| row.split_whitespace().next().unwrap().to_owned()).filter(|name| name != "help").collect()
}

/// The long options of a command as its help lists them.
fn options(command: &str) -> Vec<String> {
    let help = abbe(&[command, "--help"], "").out;
    let lines =
        help.lines().filter_map(|line| line.trim_start().strip_prefix("-h, ").or(Some(line.trim_start())));
    lines
        .filter(|line| line.starts_with("--"))
        .map(|line| line.split([' ', ',']).next().unwrap().to_owned())
        .collect()
}

#[test]
fn every_shell_completes_every_command_and_option() {
    let names = commands();
    assert!(names.len() >= 11, "{names:?}");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let run = abbe(&["completions", shell], "");
        assert_eq!((run.status, run.err.as_str()), (0, ""), "{shell}");
        for name in &names {
            assert!(run.out.contains(name.as_str()), "{shell} knows no {name}");
            for option in options(name) {
                assert!(
                    run.out.contains(option.trim_start_matches('-')),
                    "{shell} knows no {option} of {name}"
                );
            }
        }
    }
    let run = abbe(&["completions", "csh"], "");
    assert!(run.status == 2 && run.err.contains("bash"), "{}", run.err);
}

/// Where the shell is there, it reads its script.
#[test]
fn bash_reads_its_completions() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("completions");
    fs::create_dir_all(&folder).unwrap();
    let script = folder.join("abbe.bash");
    fs::write(&script, abbe(&["completions", "bash"], "").out).unwrap();
    let text = format!(
        "source {}; COMP_WORDS=(abbe diagnose --wri); COMP_CWORD=2; _abbe abbe --wri diagnose; echo \"${{COMPREPLY[@]}}\"",
        script.display()
    );
    match Command::new("bash").args(["--norc", "-c", &text]).output() {
        Ok(output) => assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "--write-calibration"),
        Err(_) => skipped("there is no bash"),
    }
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("manuals/man1");
    let _ = fs::remove_dir_all(&folder);
    let run = abbe(&["man", "--output", folder.to_str().unwrap()], "");
    assert_eq!((run.status, run.out.as_str(), run.err.as_str()), (0, "", ""));
    let printed = abbe(&["man"], "").out;
    assert_eq!(fs::read_to_string(folder.join("abbe.1")).unwrap(), printed);
    let mut expected: Vec<String> = commands().iter().map(|name| format!("abbe-{name}.1")).collect();
    expected.push("abbe.1".to_owned());
    expected.sort();
    let mut found: Vec<String> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    assert_eq!(found, expected);
    for name in commands() {
        let page = fs::read_to_string(folder.join(format!("abbe-{name}.1"))).unwrap();
        let plain = page.replace('\\', "");
        assert!(plain.contains(&format!(".TH abbe-{name} 1 ")), "{page}");
        assert!(plain.contains("\n.SH EXAMPLES\nExamples (") && !plain.contains(".SH EXTRA"), "{page}");
        assert!(plain.contains(&format!("fBabbe {name}fR")), "the way to call it: {page}");
        for option in options(&name) {
            assert!(plain.contains(&option), "{name} {option}: {page}");
        }
        assert!(printed.replace('\\', "").contains(&format!("abbe-{name}(1)")), "{name}");
    }
}

#[test]
fn pages_that_cannot_be_written_are_told() {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("a-file");
    fs::write(&file, "").unwrap();
    let run = abbe(&["man", "--output", file.to_str().unwrap()], "");
    assert!(run.status == 2 && run.err.starts_with("error: cannot create "), "{}", run.err);
}
