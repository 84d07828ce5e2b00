//! Instruments' files: the set-up, a line `=== data`, and the file of its first measurement, which serves for all of them. Read,
//! reduced, and the calibration written and read again.

use exchange::instrument::file::{self, Columns};
use exchange::instrument::{Findings, Measured, Setup, calibrate, report, setup};
use model_dsl::Compiled;
use model_dsl::calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use super::text::{findings_hold, machine, source};

/// Stands between the two files.
const BETWEEN: &[u8] = b"\n=== data\n";

/// Takes two files of any bytes as a set-up and its measurement.
pub fn run(bytes: &[u8]) {
    let between = bytes.windows(BETWEEN.len()).position(|window| window == BETWEEN);
    let (head, data) = between.map_or((bytes, &[][..]), |at| (&bytes[..=at], &bytes[at + BETWEEN.len()..]));
    let measured = measured(data);
    let Some(source) = source(head) else { return };
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics);
    let named = root.as_ref().and_then(|root| setup::machine_of(root, &mut diagnostics));
    let machine = machine(named.as_ref().map_or("", |name| &name.value));
    let read = root.filter(|_| named.is_some());
    let setup = read.and_then(|root| setup::read(&root, &machine.equations, &mut diagnostics));
    findings_hold(&source, &diagnostics);
    match (setup, measured) {
        (None, _) => assert!(diagnostics.has_errors(), "neither a set-up nor an error"),
        (Some(setup), Some(measured)) => reduced(&source, &setup, &measured, &machine),
        _ => {}
    }
}

fn measured(data: &[u8]) -> Option<Measured> {
    let mut diagnostics = Diagnostics::new();
    let source = file::text("data", data);
    let measured = file::read(source.clone(), &Columns::default(), &mut diagnostics);
    findings_hold(&source, &diagnostics);
    assert_eq!(measured.is_none(), diagnostics.has_errors(), "neither a measurement nor an error");
    measured
}

fn reduced(source: &SourceFile, setup: &Setup, measured: &Measured, machine: &Compiled) {
    let files = vec![measured.clone(); setup.measurements.len()];
    let mut findings = Findings::default();
    let outcome = calibrate(setup, &files, &machine.equations, &mut findings);
    findings_hold(source, &findings.setup);
    for found in &findings.data {
        findings_hold(&measured.source, found);
    }
    let Some(outcome) = outcome else {
        return assert!(findings.setup.has_errors(), "neither a calibration nor an error");
    };
    let shown = report::text(&outcome, &machine.equations);
    assert!(!shown.contains('\u{1b}'), "a file's own escape sequence reaches the terminal");
    report::json(&outcome, &machine.equations);
    let names = machine.equations.names();
    let text = calibration::write(&outcome.calibration, &names);
    let mut diagnostics = Diagnostics::new();
    let written = SourceFile::new("written.yaml", text);
    let root = yaml::read(&written, &mut diagnostics);
    let again = root.and_then(|root| calibration::read(&root, &names, &mut diagnostics));
    assert!(again.is_some(), "what is written is not read: {diagnostics:?}\n{}", written.text());
}
