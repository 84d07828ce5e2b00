//! Links between documents. In: every Markdown file of the repository. Out: the links that lead nowhere, and the pages that the
//! summary of the site lacks.

use std::collections::{BTreeMap, BTreeSet};
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

/// The prose without what stands in backquotes.
fn unquoted(text: &str) -> String {
    prose(text).split('`').step_by(2).collect::<Vec<_>>().join("`")
}

/// Where the links and pictures of a text lead.
pub(super) fn targets(text: &str) -> Vec<String> {
    let prose = prose(text);
    let links = prose.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().to_owned());
    links.collect()
}

/// The names of the headings, as they stand behind `#` in a link; a name that is there already is numbered.
fn anchors(text: &str) -> BTreeSet<String> {
    let prose = prose(text);
    let headings =
        prose.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |letter: char| letter.is_alphanumeric() || letter == '-' || letter == '_' || letter == ' ';
    let names = headings
        .map(|heading| heading.to_lowercase().chars().filter(|letter| kept(*letter)).collect())
        .map(|heading: String| heading.replace(' ', "-"));
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let numbered = |name: String| {
        let before = seen.entry(name.clone()).or_default();
        *before += 1;
        if *before == 1 { name } else { format!("{name}-{}", *before - 1) }
    };
    names.map(numbered).collect()
}

/// Whether a link leads to a file, and to a heading in it where it names one. A folder is no page of a site.
fn leads_somewhere(from: &Path, target: &str) -> bool {
    let (path, anchor) = target.split_once('#').unwrap_or((target, ""));
    let file = if path.is_empty() { from.to_owned() } else { from.parent().unwrap().join(path) };
    file.is_file()
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
fn headings_have_the_names_that_a_git_host_gives_them() {
    let names = anchors(
        "# A `key` of it\n\n## Again\n\n```sh\n# no heading\n```\n\n## Again\n\n## It's 2 %, or so\n",
    );
    assert_eq!(names, ["a-key-of-it", "again", "again-1", "its-2--or-so"].map(str::to_owned).into());
}

/// Links have one form, so that the tests see all of them, and those who lay out the site.
#[test]
fn links_and_pictures_have_one_form() {
    let mut other = Vec::new();
    for path in documents() {
        let text = unquoted(&fs::read_to_string(&path).unwrap());
        let defined = |line: &&str| line.starts_with('[') && line.contains("]: ");
        let marked = |line: &&str| ["<a ", "<img ", "href=", "src="].iter().any(|mark| line.contains(mark));
        let lines = text.lines().filter(|line| defined(line) || marked(line));
        other.extend(lines.map(|line| format!("{}: {line}", path.display())));
    }
    assert!(other.is_empty(), "a link is written as [text](target): {other:#?}");
}

/// The pages of the site, in the order of its summary.
pub(super) fn pages() -> Vec<PathBuf> {
    let folder = root().join("docs");
    let summary = fs::read_to_string(folder.join("SUMMARY.md")).unwrap();
    targets(&summary).iter().map(|target| folder.join(target).canonicalize().unwrap()).collect()
}

/// Every page of `docs`, and every page that a page of the site links to, so that no link leaves it.
#[test]
fn every_page_is_in_the_summary_of_the_site() {
    let pages = pages();
    let listed: BTreeSet<&PathBuf> = pages.iter().collect();
    assert_eq!(listed.len(), pages.len(), "a page stands in docs/SUMMARY.md once");
    let docs = root().canonicalize().unwrap().join("docs");
    let own = documents().into_iter().map(|path| path.canonicalize().unwrap());
    let own = own.filter(|path| path.starts_with(&docs) && !path.ends_with("SUMMARY.md"));
    let linked = pages.iter().flat_map(|page| {
        let targets = targets(&fs::read_to_string(page).unwrap());
        let paths = targets.into_iter().map(|target| target.split('#').next().unwrap().to_owned());
        let to_pages = paths.filter(|path| path.ends_with(".md") && !path.contains("://"));
        to_pages.map(|path| page.parent().unwrap().join(path).canonicalize().unwrap()).collect::<Vec<_>>()
    });
    let missing: BTreeSet<PathBuf> = own.chain(linked).filter(|path| !listed.contains(path)).collect();
    assert!(missing.is_empty(), "docs/SUMMARY.md lacks {missing:#?}");
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
    let folders =
        ["docs/guide/pictures", "docs/gallery"].map(|folder| fs::read_dir(root().join(folder)).unwrap());
    for entry in folders.into_iter().flatten() {
        let path = entry.unwrap().path().canonicalize().unwrap();
        assert!(shown.contains(&path), "{} is shown nowhere", path.display());
        let size = fs::metadata(&path).unwrap().len();
        // A drawing is text, and a page has many of them.
        let most = if path.extension().is_some_and(|kind| kind == "svg") { 60_000 } else { 150_000 };
        assert!(size < most, "{}: {size} bytes", path.display());
    }
}
