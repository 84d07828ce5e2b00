//! Mistakes in machine files: one folder for each case in `cases/machine/`.
//!
//! In: `machine.yaml`. Out: the findings as a user sees them, compared with `diagnostics.txt`; `UPDATE=1` writes that file
//! again. Every code that the compiler can give for a machine file must occur in one of the cases.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use model_dsl::diagnostic::{Diagnostics, Severity, render};
use model_dsl::source::SourceFile;

use crate::shipped::root;

/// Codes of findings that need files too large to keep; `bounded` makes them.
const ELSEWHERE: [&str; 1] = ["E0003"];

/// The case folders in order of their names.
pub(crate) fn cases() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("tests/cases/machine")).unwrap();
    let mut cases: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    cases.sort();
    cases
}

/// The findings of a case, and the place of each as line and column.
pub(crate) fn findings(case: &Path) -> (SourceFile, Diagnostics) {
    let text = fs::read_to_string(case.join("machine.yaml")).unwrap();
    let source = SourceFile::new("machine.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let compiled = model_dsl::compile(&source, &mut diagnostics);
    assert_eq!(
        compiled.is_none(),
        diagnostics.has_errors(),
        "{}: a machine exactly where no error is",
        case.display()
    );
    diagnostics.sort();
    (source, diagnostics)
}

#[test]
fn every_case_is_told_as_written() {
    let mut different = Vec::new();
    for case in cases() {
        let (source, diagnostics) = findings(&case);
        let told = render(&source, &diagnostics, false);
        let expected = case.join("diagnostics.txt");
        if std::env::var_os("UPDATE").is_some_and(|value| value == "1") {
            fs::write(&expected, &told).unwrap();
        } else if fs::read_to_string(&expected).unwrap_or_default() != told {
            different.push(format!("{}\n{told}", case.display()));
        }
    }
    assert!(
        different.is_empty(),
        "these differ; UPDATE=1 accepts them once read:\n\n{}",
        different.join("\n\n")
    );
}

/// Every finding says where, and what to write instead.
#[test]
fn every_finding_has_a_place_and_a_help() {
    for case in cases() {
        let (source, diagnostics) = findings(&case);
        assert!(!diagnostics.is_empty(), "{}: a case without a finding", case.display());
        for finding in &diagnostics {
            assert!(finding.help.is_some(), "{}: {} says not what to write", case.display(), finding.code);
            assert!(
                finding.span.end <= source.text().len(),
                "{}: {} lies outside",
                case.display(),
                finding.code
            );
            let letter = if finding.severity == Severity::Error { "E" } else { "W" };
            assert!(finding.code.starts_with(letter), "{}: {}", case.display(), finding.code);
        }
    }
}

#[test]
fn every_code_has_a_case() {
    let mut occurring = BTreeSet::new();
    for file in
        ["machine.rs", "machine", "yaml.rs", "yaml/events.rs", "yaml/tree.rs", "derivation.rs", "derivation"]
    {
        let path = root().join("model-dsl/src").join(file);
        sources(&path).iter().for_each(|path| occurring.extend(codes(&fs::read_to_string(path).unwrap())));
    }
    let mut covered: BTreeSet<String> = ELSEWHERE.iter().map(|code| (*code).to_owned()).collect();
    for case in cases() {
        covered.extend(findings(&case).1.iter().map(|finding| finding.code.to_owned()));
    }
    let missing: Vec<&String> = occurring.difference(&covered).collect();
    assert!(missing.is_empty(), "no case in tests/cases/machine gives {missing:?}");
}

/// The file, or the files of the folder.
fn sources(path: &Path) -> Vec<PathBuf> {
    if path.is_dir() {
        return fs::read_dir(path).unwrap().flat_map(|entry| sources(&entry.unwrap().path())).collect();
    }
    vec![path.to_owned()]
}

/// Everything between quotes that has the form of a code, in a line of code.
pub(crate) fn codes(text: &str) -> Vec<String> {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let quoted = lines.flat_map(|line| line.split('"').skip(1).step_by(2));
    let is_code = |word: &&str| {
        word.len() == 5 && word.starts_with(['E', 'W']) && word[1..].bytes().all(|byte| byte.is_ascii_digit())
    };
    quoted.filter(is_code).map(str::to_owned).collect()
}
