//! Tests of the readers and of the reduction, with files written here, by a writer that shares nothing with the readers.

mod formats;
mod laws;
mod sets;
mod setups;

use super::file::{self, Columns};
use super::setup;
use super::{Findings, Measured, Outcome, Setup, calibrate};
use model_dsl::calibration::CalibratedTerm;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::{compile_word, yaml};

/// A text as the instrument writes it: a run is whether it ascends, and its deviations by target.
fn rtl(targets: &[f64], runs: &[(bool, Vec<f64>)]) -> String {
    let mut text =
        String::from("HEADER::\nFile type  : rtl\nOwner      : Linear\nVersion no : V20.02.02\n\n");
    text += &format!("TARGET DATA::\nFiletype  : ISO\nTarget-count: {}\nTargets :\n", targets.len());
    for line in targets.chunks(5) {
        let line: Vec<String> = line.iter().map(|target| format!("{target:>12.6}")).collect();
        text += &(line.join("  ") + " \n");
    }
    text += "Flags: 0 0 2 0\n\nUSER-TEXT::\nMachine: M\nDate:2026-05-01 10:00:00\nTITLE:\n\n";
    text += &format!("RUNS::\nRun-count: {}\n\nDEVIATIONS::\nRun Target Data:\n", runs.len());
    for (number, (ascends, values)) in runs.iter().enumerate() {
        let mut rows: Vec<(usize, &f64)> = values.iter().enumerate().collect();
        if !ascends {
            rows.reverse();
        }
        for (target, value) in rows {
            text += &format!("{}   {}      {value}\n", number + 1, target + 1);
        }
    }
    (text + "\nENVIRONMENT::\nAir temp   : 20.1\n\nEOF::\n").replace('\n', "\r\n")
}

/// Readings as a plain table in mm and um.
fn table(targets: &[f64], runs: &[(bool, Vec<f64>)]) -> String {
    let mut text = String::from("run,direction,target,deviation\n#unit,,,mm,um\n");
    for (number, (ascends, values)) in runs.iter().enumerate() {
        for (target, value) in targets.iter().zip(values) {
            text += &format!("{},{},{target},{value}\n", number + 1, if *ascends { "+1" } else { "-1" });
        }
    }
    text
}

fn machine(word: &str) -> Equations {
    compile_word(word, &mut Diagnostics::new()).unwrap().equations
}

fn read(text: impl AsRef<[u8]>) -> (Option<Measured>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let measured = file::read(file::text("data", text.as_ref()), &Columns::default(), &mut diagnostics);
    (measured, diagnostics)
}

/// The findings as code and marked text.
fn told(source: &SourceFile, diagnostics: &Diagnostics) -> Vec<(&'static str, String)> {
    diagnostics.iter().map(|one| (one.code, source.slice(one.span).to_owned())).collect()
}

fn setup_of(text: &str, equations: &Equations) -> (Option<Setup>, Vec<(&'static str, String)>) {
    let source = SourceFile::new("setup.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics).unwrap();
    let named = setup::machine_of(&root, &mut diagnostics);
    let setup = named.and_then(|_| setup::read(&root, equations, &mut diagnostics));
    let found = told(&source, &diagnostics);
    (setup, found)
}

const HEAD: &str = "setup: 1\nmachine: m\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\nmeasurements:\n";

/// What a set-up makes of files, and the findings at places of the set-up.
fn outcome(
    word: &str,
    measurements: &str,
    files: &[String],
) -> (Option<Outcome>, Vec<(&'static str, String)>, Findings) {
    let equations = machine(word);
    let text = if measurements.starts_with("setup") {
        measurements.to_owned()
    } else {
        format!("{HEAD}{measurements}")
    };
    let (setup, found) = setup_of(&text, &equations);
    let setup = setup.unwrap_or_else(|| panic!("{found:?}"));
    let files: Vec<Measured> = files.iter().map(|text| read(text).0.unwrap()).collect();
    let mut findings = Findings::default();
    let outcome = calibrate(&setup, &files, &equations, &mut findings);
    let found = told(&SourceFile::new("setup.yaml", text), &findings.setup);
    (outcome, found, findings)
}

/// The only table of a calibration: its nodes, forward and reverse.
fn values(outcome: &Outcome) -> (Vec<f64>, Vec<f64>, Option<Vec<f64>>) {
    let table = &outcome.motions[0].table;
    let terms = &outcome.calibration.motions[0].terms;
    assert!(matches!(terms[0].value, CalibratedTerm::Table { .. }));
    (table.nodes.clone(), table.forward.clone(), table.reverse.clone())
}

fn assert_near(found: &[f64], expected: &[f64], within: f64) {
    assert_eq!(found.len(), expected.len(), "{found:?}\n{expected:?}");
    let near = found.iter().zip(expected).all(|(one, other)| (one - other).abs() <= within);
    assert!(near, "{found:?}\n{expected:?}");
}
