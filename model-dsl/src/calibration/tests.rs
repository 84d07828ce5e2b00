//! What is read from calibration files, and what is refused, with which code and at which text.

mod broken;
mod refused;
mod repeating;
mod whole;

use super::*;
use crate::source::SourceFile;
use crate::yaml;

/// A mill with a rotary table and a spindle, a constant without and one with a value of its own.
pub(super) fn names() -> MachineNames {
    let axis = |letter: &str, rotary| AxisName { letter: letter.to_owned(), rotary, follows: Vec::new() };
    let motion = |name: &str, angular, axis: Option<&str>| MotionName {
        name: name.to_owned(),
        angular,
        axis: axis.map(str::to_owned),
        own: matches!(name, "EXX" | "EYY" | "ECC"),
        counted: Vec::new(),
    };
    MachineNames {
        machine: "test-mill".to_owned(),
        constants: vec![("Xt".to_owned(), None), ("Zt".to_owned(), Some(120.0))],
        turning: None,
        axes: vec![axis("X", false), axis("Y", false), axis("C", true)],
        motions: vec![
            motion("EXX", false, Some("X")),
            motion("EBX", true, Some("X")),
            motion("EXY", false, Some("Y")),
            motion("EC0Y", true, Some("Y")),
            motion("ECC", true, Some("C")),
            motion("EZS", false, None),
        ],
        unseen: Vec::new(),
    }
}

pub(super) type Reported = Vec<(&'static str, String)>;

/// Reads a whole file: the calibration, and the codes with the texts that they point at.
pub(super) fn read_file(text: &str) -> (Option<Calibration>, Reported) {
    let (calibration, diagnostics, source) = read_with_diagnostics(text);
    let findings = diagnostics.iter().map(|one| (one.code, source.slice(one.span).to_owned()));
    (calibration, findings.collect())
}

pub(super) fn read_with_diagnostics(text: &str) -> (Option<Calibration>, Diagnostics, SourceFile) {
    let source = SourceFile::new("calibrations/test.yaml", text);
    let mut diagnostics = Diagnostics::new();
    let calibration = yaml::read(&source, &mut diagnostics).and_then(|root| {
        machine_of(&root, &mut diagnostics);
        read(&root, &names(), &mut diagnostics)
    });
    diagnostics.sort();
    (calibration, diagnostics, source)
}

/// A file with these error motions and all else in order.
pub(super) fn with_error_motions(errors: &str) -> String {
    format!("calibration: 1\nmachine: test-mill\nconstants: {{Xt: 0 mm}}\nerrors:\n  {errors}\n")
}

/// The terms of the first motion listed.
pub(super) fn terms(errors: &str) -> Vec<CalibratedTerm> {
    let (calibration, findings) = read_file(&with_error_motions(errors));
    assert_eq!(findings, [], "{errors}");
    let calibration = calibration.expect("a calibration");
    calibration.motions[0].terms.iter().map(|term| term.value.clone()).collect()
}

/// The term of a motion whose list holds it alone.
pub(super) fn term(errors: &str) -> CalibratedTerm {
    let mut terms = terms(errors);
    assert_eq!(terms.len(), 1, "{errors}");
    terms.remove(0)
}
