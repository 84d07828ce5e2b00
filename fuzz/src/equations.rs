//! Files of printed equations: held against three machines.

use model_dsl::check;
use model_dsl::diagnostic::Diagnostics;

use super::text::{findings_hold, machine, source};

/// Takes a file of any bytes as a set of equations.
pub fn run(bytes: &[u8]) {
    let Some(source) = source(bytes) else { return };
    for name in ["excello-921", "nist-turning-center", "trunnion-5axis"] {
        let machine = machine(name);
        let mut diagnostics = Diagnostics::new();
        let report = check::check(&machine.machine, &machine.equations, &source, &mut diagnostics);
        findings_hold(&source, &diagnostics);
        match report {
            Some(report) => assert!(!report.text().is_empty()),
            None => assert!(diagnostics.has_errors(), "neither a report nor an error"),
        }
    }
}
