//! The site as `.ci/site` built it. In: its folder, in `ABBE_SITE`. Out: the links and pictures that lead nowhere in it, and the pages
//! that it lacks. Without a site the test is skipped with a line: `.ci/run` builds one.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

use super::links::pages;
use crate::beside::skipped;
use crate::shipped::root;

/// Every file under a folder, from there.
fn files(folder: &Path) -> BTreeSet<PathBuf> {
    let (mut found, mut folders) = (BTreeSet::new(), vec![folder.to_owned()]);
    while let Some(next) = folders.pop() {
        for path in fs::read_dir(next).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(folder).unwrap().to_owned());
            }
        }
    }
    found
}

/// The values of an attribute in a page.
fn values<'p>(page: &'p str, attribute: &str) -> Vec<&'p str> {
    let start = format!(" {attribute}=\"");
    page.split(&start).skip(1).map(|rest| rest.split('"').next().unwrap()).collect()
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut all, part| {
        match part {
            Component::ParentDir => drop(all.pop()),
            Component::CurDir => {}
            other => all.push(other),
        }
        all
    })
}

#[test]
fn no_link_of_the_built_site_leads_nowhere() {
    let Some(site) = std::env::var_os("ABBE_SITE").map(PathBuf::from) else {
        skipped("no site is built: `.ci/site` builds it, and ABBE_SITE names its folder");
        return;
    };
    let files = files(&site);
    let texts: BTreeMap<&PathBuf, String> = files
        .iter()
        // This page is shown under any address, so that its links are those of the server's root.
        .filter(|path| path.extension().is_some_and(|kind| kind == "html") && !path.ends_with("404.html"))
        .map(|path| (path, fs::read_to_string(site.join(path)).unwrap()))
        .collect();
    let names: BTreeMap<&PathBuf, BTreeSet<&str>> =
        texts.iter().map(|(path, text)| (*path, values(text, "id").into_iter().collect())).collect();
    let repository = root().canonicalize().unwrap();
    for page in pages() {
        let built = page.strip_prefix(&repository).unwrap().with_extension("html");
        assert!(names.contains_key(&built), "the site has no {}", built.display());
    }
    assert!(
        files.iter().any(|path| path.to_string_lossy().starts_with("searchindex")),
        "a search needs its index"
    );
    let (mut broken, mut counted) = (Vec::new(), 0);
    for (path, text) in &texts {
        for target in values(text, "href").into_iter().chain(values(text, "src")) {
            if target.contains("://") || target.starts_with("data:") || target.starts_with("mailto:") {
                continue;
            }
            counted += 1;
            let (file, name) = target.split_once('#').unwrap_or((target, ""));
            let file =
                if file.is_empty() { (*path).clone() } else { plain(&path.with_file_name("").join(file)) };
            let named = name.is_empty() || names.get(&file).is_some_and(|names| names.contains(name));
            if !files.contains(&file) || !named {
                broken.push(format!("{}: {target}", path.display()));
            }
        }
    }
    assert!(counted > 1000, "{counted} links were found");
    assert!(broken.is_empty(), "these lead nowhere: {broken:#?}");
}
