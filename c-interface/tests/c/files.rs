//! Files that a library of one machine takes, and those that it refuses. In: calibrations and machine files. Out: a controller,
//! or the mistake with its code and place.

use crate::stage::{Folder, MACHINE, calibration, loaded};

const EMPTY: &str = "errors: {}\n";

fn refused(name: &str, text: &str) -> String {
    let folder = Folder::new();
    match loaded(&folder.file(name, text)) {
        Ok(_) => panic!("taken: {text}"),
        Err(why) => why,
    }
}

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no `{part}` in\n{text}");
    }
}

#[test]
fn the_machine_by_its_name_is_taken() {
    let folder = Folder::new();
    assert!(loaded(&folder.file("numbers.yaml", &calibration(EMPTY))).is_ok());
}

#[test]
fn another_machine_is_refused_at_its_name() {
    let text = calibration(EMPTY).replace("machine: stage", "machine: xyfz-mill");
    has(
        &refused("numbers.yaml", &text),
        &["E0426", "numbers.yaml:2:10", "this is another machine", "machine: stage"],
    );
}

/// The file has the right name and other equations than those that were compiled in.
#[test]
fn a_machine_file_that_says_something_else_is_refused() {
    let folder = Folder::new();
    folder.file("machine.yaml", MACHINE);
    let text = calibration(EMPTY).replace("machine: stage", "machine: machine.yaml");
    let why = loaded(&folder.file("numbers.yaml", &text)).err().unwrap();
    has(&why, &["E0426", "numbers.yaml:2:10", "the names or equations", "abbe expand --c-abi machine.yaml"]);
}

#[test]
fn a_machine_file_with_mistakes_is_refused_with_them() {
    let folder = Folder::new();
    folder.file("machine.yaml", "abbe: 1\nname: stage\ntopology: FQ\n");
    let text = calibration(EMPTY).replace("machine: stage", "machine: machine.yaml");
    let why = loaded(&folder.file("numbers.yaml", &text)).err().unwrap();
    has(&why, &["E0426", "this file is not a machine file", "machine.yaml:3:"]);
}

#[test]
fn a_term_that_no_controller_knows_is_refused() {
    let text = calibration("errors: {EXX: [{drift: {amplitude: 3 um, time_constant: 10 min}}]}\n");
    has(&refused("numbers.yaml", &text), &["E0425", "numbers.yaml:4:17", "drift"]);
}

#[test]
fn mistakes_of_the_calibration_are_told_with_their_places() {
    let text = calibration("errors: {EXX: [{constant: {value: 3}}], EYY: 1 um}\n");
    has(&refused("numbers.yaml", &text), &["numbers.yaml:4:35", "E0407"]);
    has(&refused("empty.yaml", ""), &["error"]);
    has(&refused("binary.yaml", "\u{0}"), &["error"]);
}

#[test]
fn a_file_that_is_none_or_too_large_is_refused() {
    let folder = Folder::new();
    has(&loaded(&folder.file("x", "").with_file_name("y")).err().unwrap(), &["cannot read", "No such file"]);
    has(&loaded(std::env::temp_dir().as_path()).err().unwrap(), &["cannot read"]);
    has(&loaded("/dev/zero".as_ref()).err().unwrap(), &["cannot read", "larger than 8 MiB"]);
}
