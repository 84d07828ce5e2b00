//! The same files in other places give the same bytes. In: two copies of the shipped machines, calibrations and recordings,
//! in folders of different depth. Out: equal outputs of every command, in which no folder is named.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::shipped::{SHIPPED, root};

/// A copy of all data folders of the repository.
fn checkout(name: &str) -> PathBuf {
    let checkout = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("checkouts").join(name);
    if checkout.exists() {
        fs::remove_dir_all(&checkout).unwrap();
    }
    for folder in ["machines", "calibrations", "published", "recordings"] {
        copy(&root().join(folder), &checkout.join(folder));
    }
    checkout
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (path, name) = entry.map(|entry| (entry.path(), entry.file_name())).unwrap();
        if path.is_dir() {
            copy(&path, &to.join(name))
        } else {
            fs::copy(&path, to.join(name)).map(drop).unwrap()
        }
    }
}

/// What a command prints on both streams, run in a folder with names counted from it.
fn printed(arguments: &[&str], folder: &Path) -> Vec<u8> {
    let positions = fs::File::open(folder.join("calibrations/postech-points.csv")).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_abbe"));
    let output = command.args(arguments).current_dir(folder).stdin(positions).stderr(Stdio::piped()).output();
    let output = output.unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    [output.stdout, output.stderr].concat()
}

/// All files below a folder with their bytes, in order.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut found = Vec::new();
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            found.extend(contents(&path));
        } else {
            let bytes = fs::read(&path).unwrap();
            found.push((path, bytes));
        }
    }
    found
}

fn names_a_folder(bytes: &[u8]) -> bool {
    let checkouts = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let name = checkouts.to_str().unwrap().as_bytes();
    bytes.windows(name.len()).any(|window| window == name)
}

#[test]
fn two_checkouts_give_the_same_bytes() {
    let checkouts = [checkout("one"), checkout("another/of/greater/depth")];
    let recording = "recordings/postech-ballbar/recording.yaml";
    let (calibration, path) = ("calibrations/postech-mill.yaml", "recordings/postech-ballbar/path.yaml");
    let mut commands: Vec<Vec<String>> = Vec::new();
    let mut add =
        |arguments: &[&str]| commands.push(arguments.iter().map(|part| (*part).to_owned()).collect());
    for shipped in SHIPPED {
        let machine = format!("machines/{}.yaml", shipped.name);
        add(&["expand", &machine]);
        for format in ["text", "latex", "html", "json", "maxima", "svg"] {
            add(&["derive", &machine, "--format", format]);
        }
    }
    for format in ["text", "json", "html"] {
        add(&["evaluate", recording, "--format", format]);
    }
    add(&["diagnose", recording, "--format", "html", "--write-calibration", "made/new.yaml"]);
    add(&["compensate", calibration, "--map", "made/map.svg"]);
    add(&["simulate", calibration, path, "--output", "made", "--plot", "made/path.svg"]);
    for checkout in &checkouts {
        fs::create_dir(checkout.join("made")).unwrap();
    }
    for arguments in &commands {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let [one, other] = checkouts.each_ref().map(|checkout| printed(&arguments, checkout));
        assert!(one == other, "{arguments:?} depends on the folder");
        assert!(!names_a_folder(&one), "{arguments:?} names a folder of this computer");
    }
    let [one, other] = checkouts.each_ref().map(|checkout| contents(&checkout.join("made")));
    assert_eq!(one.len(), 5);
    for ((path, one), (_, other)) in one.iter().zip(&other) {
        assert!(one == other, "{} depends on the folder", path.display());
        assert!(!names_a_folder(one), "{} names a folder of this computer", path.display());
    }
}

/// What a build script writes is the same also where it gives the whole path, as build scripts do.
#[test]
fn code_of_two_checkouts() {
    let checkouts = [checkout("built"), checkout("build/of/greater/depth")];
    for shipped in SHIPPED {
        let file = format!("machines/{}.yaml", shipped.name);
        let [one, other] =
            checkouts.each_ref().map(|checkout| model_dsl::rust_for(checkout.join(&file)).unwrap());
        assert_eq!(one, other, "{}", shipped.name);
        let whole = checkouts.each_ref().map(|checkout| {
            let file = checkout.join(&file);
            printed(&["expand", file.to_str().unwrap()], checkout)
        });
        assert!(whole.iter().all(|code| *code == one.as_bytes()), "{}", shipped.name);
    }
}
