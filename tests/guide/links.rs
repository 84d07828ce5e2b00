//! Links between documents. In: every Markdown file of the repository. Out: the links that lead nowhere.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::shipped::root;

/// Every Markdown file, but for what tools have built.
pub(super) fn documents() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root()];
    while let Some(folder) = folders.pop() {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                folders.push(path);
            } else if name.ends_with(".md") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The text without its fenced blocks.
fn prose(text: &str) -> String {
    text.split("\n```").step_by(2).collect::<Vec<_>>().join("\n")
}

/// Where the links and pictures of a text lead.
fn targets(text: &str) -> Vec<String> {
    let prose = prose(text);
    let links = prose.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().to_owned());
    links.collect()
}

/// The names of the headings, as they stand behind `#` in a link.
fn anchors(text: &str) -> BTreeSet<String> {
    let prose = prose(text);
    let headings =
        prose.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |letter: char| letter.is_alphanumeric() || letter == '-' || letter == '_' || letter == ' ';
    headings
        .map(|heading| heading.to_lowercase().chars().filter(|letter| kept(*letter)).collect())
        .map(|heading: String| heading.replace(' ', "-"))
        .collect()
}

fn leads_somewhere(from: &Path, target: &str) -> bool {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let file = if path.is_empty() { from.to_owned() } else { from.parent().unwrap().join(path) };
    file.exists()
        && (anchor.is_empty() || anchors(&fs::read_to_string(&file).unwrap_or_default()).contains(anchor))
}

#[test]
fn every_link_leads_somewhere() {
    let mut broken = Vec::new();
    let mut counted = 0;
    for path in documents() {
        for target in targets(&fs::read_to_string(&path).unwrap()) {
            counted += 1;
            let elsewhere = target.starts_with("https://") || target.starts_with("http://");
            if !elsewhere && !leads_somewhere(&path, &target) {
                broken.push(format!("{}: {target}", path.strip_prefix(root()).unwrap().display()));
            }
        }
    }
    assert!(counted > 50, "{counted} links were found");
    assert!(broken.is_empty(), "these lead nowhere: {broken:#?}");
}

#[test]
fn the_table_of_contents_names_every_chapter_and_the_readme_the_guide() {
    let guide = root().join("docs/guide");
    let listed = targets(&fs::read_to_string(guide.join("README.md")).unwrap());
    for path in documents().into_iter().filter(|path| path.parent() == Some(&guide)) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(name == "README.md" || listed.contains(&name), "{name} is not in docs/guide/README.md");
    }
    assert!(
        targets(&fs::read_to_string(root().join("README.md")).unwrap())
            .contains(&"docs/guide/README.md".to_owned())
    );
}

/// A picture that no document shows is one that nobody keeps.
#[test]
fn every_picture_is_shown() {
    let shown: BTreeSet<PathBuf> = documents()
        .iter()
        .flat_map(|path| {
            let folder = path.parent().unwrap().to_owned();
            targets(&fs::read_to_string(path).unwrap()).into_iter().map(move |target| folder.join(target))
        })
        .filter_map(|path| path.canonicalize().ok())
        .collect();
    for entry in fs::read_dir(root().join("docs/guide/pictures")).unwrap() {
        let path = entry.unwrap().path().canonicalize().unwrap();
        assert!(shown.contains(&path), "{} is shown nowhere", path.display());
        let size = fs::metadata(&path).unwrap().len();
        assert!(size < 150_000, "{}: {size} bytes", path.display());
    }
}
