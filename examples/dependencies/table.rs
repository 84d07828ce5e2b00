//! The statement as text. In: builds and the sources of their crates. Out: Markdown: a line for each build, and a table of
//! the crates that it adds to those before it.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use crate::crates::{Build, Crate, Key, SYSTEM};
use crate::unsafe_code::{Counts, Stance, counted, stance};

/// Folders of a crate that are not compiled into who uses it.
const LEFT_OUT: [&str; 5] = ["tests", "benches", "examples", "fuzz", "target"];

/// A crate and what is in it.
struct Row<'a> {
    of: &'a Crate,
    stance: Stance,
    counts: Counts,
}

pub(crate) fn markdown(builds: &[Build]) -> Result<String, String> {
    let mut summary =
        format!("| on `{SYSTEM}` | crates | Abbe's own | without unsafe code |\n| --- | --- | --- | --- |\n");
    let mut tables = String::new();
    let mut rows: BTreeMap<Key, Row> = BTreeMap::new();
    for Build { title, crates } in builds {
        let others = if rows.is_empty() { "" } else { "Besides those above:\n\n" };
        let new = crates.iter().filter(|of| !rows.contains_key(&of.key()));
        let new = new.map(looked_into).collect::<Result<Vec<Row>, String>>()?;
        put(&mut tables, &format!("\n### {title}\n\n{others}{}", table(&new)));
        rows.extend(new.into_iter().map(|row| (row.of.key(), row)));
        let own = crates.iter().filter(|of| of.own).count();
        let safe = crates.iter().filter(|of| rows.get(&of.key()).is_some_and(|row| row.counts.is_empty()));
        put(&mut summary, &format!("| {title} | {} | {own} | {} |", crates.len(), safe.count()));
    }
    Ok(format!("{summary}\n{}\n{tables}", copies(rows.keys())))
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| crate | version | licence | of unsafe code it says | blocks | functions | impls | traits | foreign |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for Row { of, stance, counts } in rows {
        let Counts { blocks, functions, implementations, traits, foreign } = counts;
        let said = match stance {
            Stance::Forbids => "forbidden",
            Stance::Denies => "denied",
            Stance::SometimesForbids => "forbidden under a condition",
            Stance::Silent => "",
        };
        let line = format!(
            "| {} | {} | {} | {said} | {blocks} | {functions} | {implementations} | {traits} | {foreign} |",
            of.name, of.version, of.licence
        );
        put(&mut text, &line);
    }
    text.trim_end().to_owned()
}

/// Crates that are compiled in two versions.
fn copies<'a>(keys: impl Iterator<Item = &'a Key>) -> String {
    let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for (name, version) in keys {
        versions.entry(name).or_default().push(version);
    }
    let several = versions.iter().filter(|(_, versions)| versions.len() > 1);
    let named: Vec<String> = several.map(|(name, all)| format!("`{name}` ({})", all.join(", "))).collect();
    if named.is_empty() {
        return "None is in two versions.".to_owned();
    }
    format!("In two versions: {}; `deny.toml` says why.", named.join(", "))
}

fn looked_into(of: &Crate) -> Result<Row<'_>, String> {
    let mut counts = Counts::default();
    for path in sources(&of.folder, of.own)? {
        counts += counted(&text(&path)?).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    let said = stance(&text(&of.root)?).map_err(|error| format!("{}: {error}", of.root.display()))?;
    Ok(Row { of, stance: said.max(by_manifest(&text(&of.folder.join("Cargo.toml"))?)), counts })
}

/// What the lints of a manifest say. Abbe's own crates take theirs from the workspace, which forbids it.
fn by_manifest(manifest: &str) -> Stance {
    let lint = manifest.split_once("unsafe_code").map_or("", |(_, after)| after);
    let level = lint.split('"').nth(1);
    match level {
        Some("forbid") => Stance::Forbids,
        Some("deny") => Stance::Denies,
        _ if manifest.contains("[lints]\nworkspace = true") => Stance::Forbids,
        _ => Stance::Silent,
    }
}

/// The Rust files of a crate. Abbe's own ones stand inside one another, so that only `src` and `build.rs` are taken.
fn sources(folder: &Path, own: bool) -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry.map_err(|error| error.to_string())?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() {
            if !LEFT_OUT.contains(&name.as_str()) && (!own || name == "src") {
                found.extend(sources(&path, false)?);
            }
        } else if name.ends_with(".rs") {
            found.push(path);
        }
    }
    Ok(found)
}

fn text(path: &Path) -> Result<String, String> {
    fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))
}

fn put(text: &mut String, line: &str) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{line}");
}
