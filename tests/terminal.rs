//! What a person sees at a terminal and a program in a pipe does not: colour, the width of the window, progress.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs};

use crate::beside::skipped;
use crate::cli::abbe;
use crate::shipped::root;

/// A diagnosis that takes a moment.
const RECORDING: &str = "recordings/postech-ballbar/recording.yaml";

/// A command at a terminal of 60 columns, which the program `script` makes; standard output and error as the terminal got
/// them. Of the environment it sees only where programs are: what a CI or a user sets there also decides about colour.
/// Nothing where there is no such program.
fn at_terminal(words: &str, environment: &[(&str, &str)]) -> Option<String> {
    let there = Command::new("script").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    if !there.is_ok_and(|status| status.success()) {
        skipped("the program `script` is not installed");
        return None;
    }
    let command = format!("stty cols 60 rows 40; {} {words}", env!("CARGO_BIN_EXE_abbe"));
    let mut script = Command::new("script");
    script.args(["--quiet", "--return", "--command", &command, "/dev/null"]).current_dir(root());
    let path = env::var_os("PATH").unwrap_or_default();
    script
        .env_clear()
        .env("PATH", path)
        .env("TERM", "xterm")
        .envs(environment.iter().copied())
        .stdin(Stdio::null());
    let output = script.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    Some(String::from_utf8(output.stdout).unwrap())
}

#[test]
fn a_pipe_gets_neither_colour_nor_progress() {
    let run = abbe(&["diagnose", RECORDING], "");
    assert_eq!(run.status, 0, "{}", run.err);
    assert!(!run.out.contains('\u{1b}'));
    assert_eq!(run.err, "");
    let colored = abbe(&["diagnose", RECORDING, "--color", "always"], "");
    assert!(colored.out.contains("\u{1b}["), "who asks for colour gets it");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("colour");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("wrong.yaml");
    fs::write(&file, "abbe: 1\nname: wrong\nunheardof: 1\n").unwrap();
    let wrong = ["derive", file.to_str().unwrap(), "--color"];
    for (choice, some) in [("always", true), ("never", false), ("auto", false)] {
        let run = abbe(&[&wrong[..], &[choice]].concat(), "");
        assert_eq!((run.status, run.err.contains('\u{1b}')), (2, some), "{choice}: {}", run.err);
    }
}

#[test]
fn a_terminal_gets_colour_unless_it_is_told_otherwise_and_lines_that_fit() {
    let words = format!("diagnose {RECORDING} --quiet");
    let Some(seen) = at_terminal(&words, &[]) else { return };
    assert!(seen.contains("\u{1b}["), "{seen}");
    let plain = [("NO_COLOR", "1"), ("TERM", "dumb")].map(|set| at_terminal(&words, &[set]).unwrap());
    for plain in plain.into_iter().chain(at_terminal(&format!("{words} --color never"), &[])) {
        assert!(!plain.contains('\u{1b}'), "{plain}");
        assert!(plain.lines().all(|line| line.trim_end().chars().count() <= 60), "{plain}");
    }
}

#[test]
fn quiet_commands_are_quiet_at_a_terminal_too() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("terminal");
    let folder = folder.to_str().unwrap();
    let simulated = "simulate recordings/postech-ballbar/true.yaml recordings/postech-ballbar/path.yaml";
    let words = format!("{simulated} --output {folder} --force --quiet");
    let Some(seen) = at_terminal(&words, &[]) else { return };
    assert_eq!(seen.lines().count(), 1, "the rows alone: {seen}");
    let evaluated = at_terminal(&format!("evaluate {RECORDING} --quiet"), &[]).unwrap();
    assert!(!evaluated.contains("evaluating"), "{evaluated}");
}
