//! The user's guide, followed to the letter: every command of every chapter is run, in order, in a folder of the chapter's
//! own, and what the guide shows is compared with what is printed.
//!
//! In: `docs/guide`. Out: nothing, or the chapter, the command and the difference. Four comments steer it, each before a block:
//! `<!-- writes: FILE -->` makes the block a file; `<!-- prints -->` holds it against the standard output of the last command
//! and `<!-- warns -->` against its standard error, where a line `...` stands for any lines; `<!-- ends: N -->` lets a command
//! end with that status.

mod gallery;
mod links;
mod pictures;
mod site;

use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::beside::skipped;
use crate::shipped::root;

/// What a comment asks of the block behind it.
#[derive(Clone, Debug, PartialEq)]
enum Wish {
    Writes(String),
    Prints,
    Warns,
    Ends(i32),
}

/// A fenced block: the language behind the fence, its text, and the comment before it.
#[derive(Debug)]
struct Block {
    wish: Option<Wish>,
    language: String,
    text: String,
}

fn wish(line: &str) -> Option<Wish> {
    let inside = line.strip_prefix("<!-- ")?.strip_suffix(" -->")?;
    let (word, rest) = inside.split_once(": ").unwrap_or((inside, ""));
    Some(match word {
        "writes" => Wish::Writes(rest.to_owned()),
        "prints" => Wish::Prints,
        "warns" => Wish::Warns,
        "ends" => Wish::Ends(rest.parse().unwrap()),
        _ => panic!("no such wish: {line}"),
    })
}

fn blocks(text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let (mut open, mut before): (Option<Block>, Option<Wish>) = (None, None);
    for line in text.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(block), None) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, Some(language)) => {
                let language = language.to_owned();
                open = Some(Block { wish: before.take(), language, text: String::new() });
            }
            (None, None) if line.starts_with("<!--") => before = wish(line),
            (None, None) => {
                assert!(before.is_none(), "a comment stands right before its block, not before {line:?}");
            }
        }
    }
    assert!(open.is_none(), "a block is not closed");
    blocks
}

/// Whether a text is what is shown, where `...` on a line of its own stands for any lines.
fn shows(shown: &str, printed: &str) -> bool {
    let pieces: Vec<Vec<&str>> =
        shown.lines().collect::<Vec<_>>().split(|line| line.trim() == "...").map(<[&str]>::to_vec).collect();
    let lines: Vec<&str> = printed.lines().map(str::trim_end).collect();
    let mut from = 0;
    for (number, piece) in pieces.iter().enumerate() {
        let last = number + 1 == pieces.len();
        let fits = |at: &usize| lines.get(*at..at + piece.len()) == Some(piece.as_slice());
        let mut places: Vec<usize> = (from..=lines.len()).filter(fits).collect();
        if number == 0 {
            places.retain(|at| *at == 0);
        }
        if last {
            places.retain(|at| at + piece.len() == lines.len());
        }
        let Some(at) = places.first() else { return false };
        from = at + piece.len();
    }
    true
}

#[test]
fn dots_stand_for_any_lines() {
    assert!(shows("a\nb\n", "a\nb\n") && shows("a\n...\n", "a\nb\nc\n") && shows("...\nc\n", "a\nb\nc\n"));
    assert!(shows("a\n...\nd\n", "a\nb\nd\n") && !shows("a\n...\ne\n", "a\nb\nd\n"));
    assert!(!shows("a\n", "a\nb\n") && !shows("b\n", "a\nb\n"));
}

/// Where all chapters have their folders: the program as `abbe` in `bin`, the repository as `abbe` beside the chapters.
fn table() -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("guide");
    fs::create_dir_all(folder.join("bin")).unwrap();
    for (link, target) in
        [("bin/abbe", PathBuf::from(env!("CARGO_BIN_EXE_abbe"))), ("abbe", root().canonicalize().unwrap())]
    {
        let link = folder.join(link);
        if fs::read_link(&link).ok().as_ref() != Some(&target) {
            let _ = fs::remove_file(&link);
            // Chapters are followed at the same time; who is first makes the link.
            if let Err(error) = symlink(&target, &link) {
                assert_eq!(error.kind(), std::io::ErrorKind::AlreadyExists);
            }
        }
    }
    folder
}

/// What a command left behind.
struct Left {
    command: String,
    out: String,
    err: String,
}

fn run(folder: &Path, block: &Block) -> Left {
    let bin = folder.parent().unwrap().join("bin");
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap_or_default());
    let output = Command::new("bash")
        .args(["--norc", "-e", "-c", &block.text])
        .current_dir(folder)
        .env("PATH", path)
        .env("CARGO_NET_OFFLINE", "true")
        .env("CARGO_TERM_COLOR", "never")
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    let meant = if let Some(Wish::Ends(status)) = block.wish { status } else { 0 };
    assert_eq!(output.status.code(), Some(meant), "{}\n{out}\n{err}", block.text);
    Left { command: block.text.clone(), out, err }
}

/// Follows one chapter from its beginning.
fn follow(chapter: &str) {
    follow_page(chapter, &format!("docs/guide/{chapter}.md"));
}

/// Follows one page in a folder of its own.
fn follow_page(chapter: &str, page: &str) {
    if Command::new("bash").args(["--norc", "-c", "true"]).status().is_err() {
        skipped("there is no bash");
        return;
    }
    let folder = table().join(chapter);
    fs::create_dir_all(&folder).unwrap();
    for entry in fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
        // What cargo built stays: it is built again where it is out of date.
        if entry.is_file() {
            fs::remove_file(entry).unwrap();
        } else if !entry.ends_with("target") {
            fs::remove_dir_all(entry).unwrap();
        }
    }
    let text = fs::read_to_string(root().join(page)).unwrap();
    let (mut last, mut commands) = (None, 0);
    for block in blocks(&text) {
        match &block.wish {
            Some(Wish::Writes(name)) => write(&folder, name, &block.text),
            Some(wish @ (Wish::Prints | Wish::Warns)) => {
                let left: &Left = last.as_ref().expect("a command before what it prints");
                let printed = if *wish == Wish::Prints { &left.out } else { &left.err };
                assert!(
                    shows(&block.text, printed),
                    "{chapter}.md: {}prints\n{printed}\nand not\n{}",
                    left.command,
                    block.text
                );
            }
            Some(Wish::Ends(_)) | None if block.language == "sh" => {
                last = Some(run(&folder, &block));
                commands += 1;
            }
            Some(Wish::Ends(_)) => panic!("{chapter}.md: only a command ends"),
            None => {}
        }
    }
    assert!(commands > 0, "{chapter}.md has no command");
}

fn write(folder: &Path, name: &str, text: &str) {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, text).unwrap();
    if name == "Cargo.toml" {
        // The versions that are there without a network.
        fs::copy(root().join("Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    }
}

/// The chapters that have commands; the others hold none.
const FOLLOWED: [&str; 6] =
    ["calibration", "diagnosis", "evaluate", "first-machine", "signs", "your-own-crate"];

#[test]
fn every_chapter_is_followed() {
    for path in links::documents().into_iter().filter(|path| path.starts_with(root().join("docs/guide"))) {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let has = fs::read_to_string(&path).unwrap().contains("\n```sh\n");
        assert_eq!(has, FOLLOWED.contains(&name.as_str()), "{name}: FOLLOWED has the chapters with commands");
    }
}

#[test]
fn first_machine() {
    follow("first-machine");
}

#[test]
fn calibration() {
    follow("calibration");
}

#[test]
fn diagnosis() {
    follow("diagnosis");
}

#[test]
fn evaluate() {
    follow("evaluate");
}

#[test]
fn signs() {
    follow("signs");
}

#[test]
fn controllers() {
    follow_page("controllers", "docs/controllers.md");
}

#[test]
fn your_own_crate() {
    follow("your-own-crate");
}
