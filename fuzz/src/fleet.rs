//! Fleet files: read, and the patterns in them held against names.

use std::path::Path;

use ::fleet::file;
use model_dsl::diagnostic::Diagnostics;

use super::text::{findings_hold, source};

/// The longest path of a file on Linux: no pattern is held against a longer one.
const LONGEST: usize = 4096;

/// Takes a file of any bytes as a fleet file.
pub fn run(bytes: &[u8]) {
    let Some(source) = source(bytes) else { return };
    let mut diagnostics = Diagnostics::new();
    let fleet = file::of(&source, Path::new("shop"), &mut diagnostics);
    findings_hold(&source, &diagnostics);
    assert_eq!(fleet.is_none(), diagnostics.has_errors(), "a fleet exactly where no error is");
    let Some(fleet) = fleet else { return };
    assert!(!fleet.machines.is_empty(), "a fleet without a machine");
    for machine in &fleet.machines {
        assert!(!machine.name.trim().is_empty() && !machine.recordings.is_empty(), "{machine:?}");
        // A pattern finds the time in any name, its own and all of the file, in bounded time.
        if let Some(time) = &machine.time {
            let text = source.text();
            let end =
                (0..=LONGEST.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
            let _ = time.find(&text[..end]);
            let found = time.find("mill-07/2026-07-09_225928/DD.MM.YYYY 20260709.yaml");
            assert!(found.is_none_or(|found| found.day().len() == 10), "{found:?}");
        }
    }
}
