//! Recordings: the recording file, a line `=== data`, and the table. Read, evaluated, and diagnosed where the table is short.

use ::recording::{self, Recording};
use diagnosis::report::{self, Origin};
use model_dsl::Compiled;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::yaml;

use super::text::{findings_hold, machine, source};

/// Stands between the two files.
const BETWEEN: &[u8] = b"\n=== data\n";

/// The cost of a diagnosis grows with the rows, what can go wrong in it hardly.
const MOST_ROWS: usize = 40;

/// An evaluation is cheaper.
const MOST_EVALUATED: usize = 2_000;

/// Takes two files of any bytes as a recording and its table.
pub fn run(bytes: &[u8]) {
    let between = bytes.windows(BETWEEN.len()).position(|window| window == BETWEEN);
    let (head, data) = between.map_or((bytes, &[][..]), |at| (&bytes[..=at], &bytes[at + BETWEEN.len()..]));
    let Some(source) = source(head) else { return };
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics);
    let named = root.as_ref().and_then(|root| recording::machine_of(root, &mut diagnostics));
    let machine = machine(named.as_ref().map_or("", |name| &name.value));
    let header = root.and_then(|root| recording::read_header(&root, &machine.equations, &mut diagnostics));
    findings_hold(&source, &diagnostics);
    let Some(header) = header.filter(|_| !diagnostics.has_errors()) else {
        return assert!(diagnostics.has_errors(), "neither a recording nor an error");
    };
    match header.read_bytes("data", data.to_vec()) {
        Ok(recording) => studied(&machine, &recording),
        Err(error) => assert!(error.to_string().starts_with("error: "), "{error}"),
    }
}

fn studied(machine: &Compiled, recording: &Recording) {
    let rows = recording.time.len();
    assert_eq!(recording.run.len(), rows);
    assert!(recording.time.iter().all(|time| time.is_finite()), "a time that is not finite");
    if rows <= MOST_EVALUATED {
        let evaluation = evaluation::evaluate(&evaluation::Inputs {
            equations: &machine.equations,
            calibration: None,
            recording,
        });
        says_numbers(&evaluation::report::text(&evaluation));
        says_numbers(&evaluation::report::json(&evaluation));
        says_numbers(&evaluation::report::html(&evaluation, "abbe evaluate"));
    }
    if rows <= MOST_ROWS {
        let inputs = diagnosis::Inputs {
            equations: &machine.equations,
            calibration: None,
            recordings: vec![recording],
            holdout: None,
            calibration_file: None,
            chains: None,
        };
        let diagnosis = diagnosis::diagnose_with_pictures(&inputs, &mut |_| ());
        says_numbers(&report::text(&diagnosis));
        says_numbers(&report::json(&diagnosis));
        let origin = Origin { command: "abbe diagnose", program: "abbe", change: "" };
        says_numbers(&report::html(&diagnosis, &origin));
    }
}

/// No word of a report is what a computer writes for a number that is none.
fn says_numbers(report: &str) {
    assert!(!report.is_empty());
    let words = report.split(|letter: char| !letter.is_ascii_alphanumeric());
    let mut none = words.filter(|word| matches!(*word, "NaN" | "inf" | "infinity"));
    assert_eq!(none.next(), None, "{report}");
}
