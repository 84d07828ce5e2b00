//! The examples at the end of every help. In: the help of every command. Out: the commands that show fewer than two, the examples that
//! do not fit on a line, and those that do not run.
//!
//! All of them run in one folder, in the order of the commands, beside copies of the repository's folders. What an example speaks of
//! without a folder is written by an example before it, or is a file of the user's ([`users_files`]): a recording, a path, a measured
//! part, a fleet, results of a fleet from elsewhere.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::beside::skipped;
use crate::cli::abbe;
use crate::manuals::listed;
use crate::shipped::root;

/// The folders that examples speak of.
const FOLDERS: [&str; 5] = ["calibrations", "docs/cases", "machines", "published", "recordings"];

/// Probed points of a mill, as far as its tables go.
const PART: &str = "path: 1\ntitle: a part\nat: {Z: -50 mm}\ngrid: {plane: XY, from: [0 mm, 0 mm], to: [500 mm, 250 mm], lines: 3}\nfeed: 6000 mm/min\nrate: 2 Hz\ninstrument: position\nnoise: {white: 0.5 um}\nseed: 1\n";

/// Two machines with a recording each.
const FLEET: &str = "fleet: 1\nmachines:\n  mill-1: {recordings: recordings/postech-ballbar/recording.yaml}\n  servo-1: {recordings: recordings/servo-rest/recording.yaml}\n";

/// A command, by the words that call it, and its help.
struct Helped {
    words: Vec<String>,
    help: String,
}

impl Helped {
    /// The command lines of its examples.
    fn examples(&self) -> Vec<&str> {
        let Some(examples) = self.help.split("\nExamples (").nth(1) else { return Vec::new() };
        examples
            .lines()
            .filter_map(|line| line.strip_prefix("  "))
            .filter(|line| !line.starts_with(' '))
            .collect()
    }
}

/// Every command and every command of a command, as the helps list them.
fn helped() -> Vec<Helped> {
    let (mut found, mut open) = (Vec::new(), vec![Vec::new()]);
    while let Some(words) = open.pop() {
        let called: Vec<&str> = words.iter().map(String::as_str).chain(["--help"]).collect();
        let help = abbe(&called, "").out;
        let mut own: Vec<Vec<String>> =
            listed(&help).into_iter().map(|name| words.iter().cloned().chain([name]).collect()).collect();
        own.reverse();
        open.extend(own);
        found.push(Helped { words, help });
    }
    assert!(found.len() >= 25, "{} commands", found.len());
    found
}

#[test]
fn every_help_has_two_examples_of_its_command() {
    let mut poor = Vec::new();
    for command in helped() {
        let called = format!("abbe {}", command.words.join(" "));
        // A command that is broken into two lines cannot be copied.
        let lines = command.help.split("\nExamples (").skip(1).flat_map(str::lines).skip(2);
        for line in lines.filter(|line| !line.starts_with("      ")) {
            assert!(line.starts_with("  ") && line.contains("abbe "), "{line:?} of {called}");
        }
        let examples = command.examples();
        if examples.iter().filter(|line| line.contains(called.trim())).count() < 2 {
            poor.push(called);
        }
    }
    assert!(poor.is_empty(), "src/arguments/examples.rs has fewer than two examples of {poor:#?}");
}

fn copied(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().map(|entry| entry.unwrap()) {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copied(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs a command line in a folder in which `abbe` is the program.
fn run(folder: &Path, line: &str) -> Result<(), String> {
    let program = Path::new(env!("CARGO_BIN_EXE_abbe")).parent().unwrap();
    let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
    let shell = Command::new("bash")
        .args(["--norc", "-e", "-o", "pipefail", "-c", line])
        .current_dir(folder)
        .env("PATH", path)
        .output()
        .unwrap();
    if shell.status.success() {
        return Ok(());
    }
    Err(format!("{line}\n{}", String::from_utf8_lossy(&shell.stderr)))
}

/// The files of the user's: what a stranger would have of a machine.
fn users_files(folder: &Path) {
    fs::write(folder.join("fleet.yaml"), FLEET).unwrap();
    fs::write(folder.join("grid.yaml"), PART).unwrap();
    for line in [
        "abbe new path FX --output path.yaml",
        "abbe new calibration FX --output stage.yaml",
        "abbe simulate stage.yaml path.yaml --output recording.yaml",
        "abbe simulate recordings/postech-ballbar/true.yaml grid.yaml --output part.yaml",
        "abbe fleet run --quiet && cp -r results results-2 && mv results results-3",
    ] {
        run(folder, line).unwrap();
    }
}

#[test]
fn every_example_runs() {
    if Command::new("bash").args(["--norc", "-c", "true"]).status().is_err() {
        skipped("there is no bash");
        return;
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("examples");
    let _ = fs::remove_dir_all(&folder);
    for name in FOLDERS {
        copied(&root().join(name), &folder.join(name));
    }
    users_files(&folder);
    let commands = helped();
    let lines: Vec<&str> = commands.iter().flat_map(Helped::examples).collect();
    let failed: Vec<String> = lines.iter().filter_map(|line| run(&folder, line).err()).collect();
    assert!(
        lines.len() > 50 && failed.is_empty(),
        "{} examples, of which fail: {}",
        lines.len(),
        failed.join("\n")
    );
}
