//! The crates that a build compiles. In: what cargo says of the workspace. Out: for each build its crates, with their
//! licences and the folders of their sources. Cargo decides what is compiled; here nothing is.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// What is compiled differs between systems; the statement is of this one.
pub(crate) const SYSTEM: &str = "x86_64-unknown-linux-gnu";

/// A name and a version.
pub(crate) type Key = (String, String);

/// A crate of some build.
#[derive(Clone)]
pub(crate) struct Crate {
    pub(crate) name: String,
    pub(crate) version: String,
    pub(crate) licence: String,
    /// It is a crate of this workspace.
    pub(crate) own: bool,
    pub(crate) folder: PathBuf,
    /// The file of its library.
    pub(crate) root: PathBuf,
}

/// What cargo says of the workspace.
pub(crate) struct Workspace {
    crates: BTreeMap<Key, Crate>,
    /// What the crates of the workspace name in their manifests, their tests included.
    pub(crate) direct: BTreeSet<String>,
}

/// The crates of one build.
pub(crate) struct Build {
    pub(crate) title: &'static str,
    pub(crate) crates: Vec<Crate>,
}

impl Crate {
    pub(crate) fn key(&self) -> Key {
        (self.name.clone(), self.version.clone())
    }
}

impl Workspace {
    pub(crate) fn read() -> Result<Self, String> {
        let arguments = ["metadata", "--locked", "--format-version=1", "--all-features", "--filter-platform"];
        let metadata = cargo(&[&arguments[..], &[SYSTEM]].concat())?;
        let metadata: Value = serde_json::from_str(&metadata).map_err(|error| error.to_string())?;
        let packages = metadata["packages"].as_array().ok_or("cargo metadata names no packages")?;
        let mut workspace = Self { crates: BTreeMap::new(), direct: BTreeSet::new() };
        for package in packages {
            let found = described(package).ok_or_else(|| format!("not understood: {package}"))?;
            if found.own {
                workspace.direct.extend(named(package));
            }
            workspace.crates.insert(found.key(), found);
        }
        Ok(workspace)
    }
}

fn described(package: &Value) -> Option<Crate> {
    let targets = package["targets"].as_array()?;
    let library = targets.iter().find(|target| {
        let kinds = target["kind"].as_array().map_or(&[][..], Vec::as_slice);
        kinds
            .iter()
            .any(|kind| kind.as_str().is_some_and(|kind| kind.ends_with("lib") || kind == "proc-macro"))
    });
    Some(Crate {
        name: package["name"].as_str()?.to_owned(),
        version: package["version"].as_str()?.to_owned(),
        licence: package["license"].as_str().unwrap_or("not stated").to_owned(),
        own: package["source"].is_null(),
        folder: Path::new(package["manifest_path"].as_str()?).parent()?.to_owned(),
        root: library.or(targets.first())?["src_path"].as_str()?.into(),
    })
}

/// The crates of others in a manifest.
fn named(package: &Value) -> Vec<String> {
    let dependencies = package["dependencies"].as_array().map_or(&[][..], Vec::as_slice);
    let others = dependencies.iter().filter(|dependency| !dependency["source"].is_null());
    others.filter_map(|dependency| dependency["name"].as_str().map(str::to_owned)).collect()
}

/// From the smallest to the largest.
pub(crate) fn builds(workspace: &Workspace) -> Result<Vec<Build>, String> {
    let wanted: [(_, &[_]); 4] = [
        ("A controller: `abbe-runtime`", &["-p", "abbe-runtime", "--edges", "normal"]),
        ("The macro `machine!`: `abbe-macros`", &["-p", "abbe-macros", "--edges", "normal,build"]),
        ("A library for C: `abbe-c`", &["-p", "abbe-c", "--edges", "normal,build"]),
        ("The program: `abbe`", &["-p", "abbe", "--edges", "normal,build"]),
    ];
    let build = |(title, arguments): (_, &[_])| {
        let crates = compiled(arguments)?.into_iter().map(|key| {
            let found = workspace.crates.get(&key).cloned();
            found.ok_or_else(|| format!("cargo metadata does not know {} {}", key.0, key.1))
        });
        Ok(Build { title, crates: crates.collect::<Result<_, String>>()? })
    };
    wanted.into_iter().map(build).collect()
}

fn compiled(arguments: &[&str]) -> Result<BTreeSet<Key>, String> {
    let common = ["tree", "--locked", "--prefix", "none", "--no-dedupe", "--target", SYSTEM];
    let tree = cargo(&[&common, arguments].concat())?;
    let keys = tree.lines().map(|line| {
        let mut words = line.split(' ');
        let key = words.next().zip(words.next().and_then(|word| word.strip_prefix('v')));
        key.map(|(name, version)| (name.to_owned(), version.to_owned()))
            .ok_or_else(|| format!("cargo tree says `{line}`"))
    });
    keys.collect()
}

fn cargo(arguments: &[&str]) -> Result<String, String> {
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .map_err(|error| format!("cargo does not start: {error}"))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("cargo {} fails:\n{said}", arguments.join(" ")));
    }
    String::from_utf8(output.stdout).map_err(|error| error.to_string())
}
