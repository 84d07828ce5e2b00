//! The improved calibration. In: what was known of a machine, and a diagnosis. Out: a calibration file with the findings
//! added, which reads back as it was meant.

use std::path::Path;

use diagnosis::diagnosis::{Diagnosis, Finding};
use diagnosis::report;
use model_dsl::calibration::{self, CalibratedTerm, Calibration, SeriesInput};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use super::files::{Files, folder, write_whole};
use crate::commands::simulate::machine_name;
use crate::failure::Failure;
use crate::output::{rendered, warn};
use crate::recorded::Recorded;

/// Writes the known calibration with the findings added; without findings it is written as it is, with a warning.
pub(super) fn write(
    target: &Path,
    recorded: &Recorded,
    files: &Files,
    diagnosis: &Diagnosis,
) -> Result<(), Failure> {
    let names = recorded.equations.names();
    let improved = improved(known(target, recorded, files), &diagnosis.findings);
    let text = comments(recorded, files, diagnosis) + &calibration::write(&improved, &names);
    check(target, &text, &recorded.equations)?;
    write_whole(target, &text)?;
    tell(target, diagnosis);
    Ok(())
}

/// What is known of the machine, its machine file named from the target's folder.
fn known(target: &Path, recorded: &Recorded, files: &Files) -> Calibration {
    let folder = folder(target);
    match (&recorded.calibration, &files.calibration) {
        (Some(known), Some(path)) => {
            let mut known = known.calibration.clone();
            known.machine.value = machine_name(&known.machine.value, path, &folder);
            known
        }
        _ => {
            let machine = machine_name(&files.machine, &files.recording, &folder);
            let constants = recorded.equations.constants.iter();
            Calibration::new(
                machine,
                constants.map(|constant| constant.default.unwrap_or_default()).collect(),
            )
        }
    }
}

/// The calibration with the findings, each reading the sensor of its name.
fn improved(mut known: Calibration, findings: &[Finding]) -> Calibration {
    let mut terms = Vec::new();
    for finding in findings {
        let sensor = finding.sensor.as_ref().map(|name| known.sensor(name));
        terms.push((finding.motion_number, reading(finding.calibrated.clone(), sensor)));
    }
    known.with(&terms)
}

/// The term with the number of its sensor in the calibration that it goes into.
fn reading(mut term: CalibratedTerm, number: Option<usize>) -> CalibratedTerm {
    if let Some(number) = number {
        match &mut term {
            CalibratedTerm::Polynomial { input: SeriesInput::Sensor(sensor), .. }
            | CalibratedTerm::Expansion { sensor, .. }
            | CalibratedTerm::Growth { sensor, .. } => *sensor = number,
            _ => {}
        }
    }
    term
}

/// Where the numbers come from, as comments at the top.
fn comments(recorded: &Recorded, files: &Files, diagnosis: &Diagnosis) -> String {
    let recordings = diagnosis.recordings.iter().map(|recording| recording.file.as_str());
    let added = diagnosis.findings.iter().map(|finding| format!("{} of {}", finding.term, finding.motion));
    let added = match added.collect::<Vec<_>>().as_slice() {
        [] => "nothing".to_owned(),
        added => added.join(", "),
    };
    let known = files.calibration.as_ref().filter(|_| recorded.calibration.is_some());
    let known = known.map_or_else(
        || "nothing was; constants that the machine file does not give are 0".to_owned(),
        |path| path.display().to_string(),
    );
    let lines = [
        format!("Written by abbe diagnose from {}.", recordings.collect::<Vec<_>>().join(", ")),
        format!("Verdict: {}.", report::verdict(diagnosis)),
        rms(diagnosis),
        format!("Known before: {known}."),
        format!("Added: {added}."),
    ];
    lines.map(|line| format!("# {}\n", one_line(&line))).concat()
}

/// What the model leaves, before and after, in the units of the diagnosis.
fn rms(diagnosis: &Diagnosis) -> String {
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let held_out = before.holdout_rms.zip(after.holdout_rms).map(|(one, other)| {
        format!("; of the held-out ones {one:.6} {} before, {other:.6} {} after", before.unit, after.unit)
    });
    format!(
        "Rms of all samples {:.6} {} before, {:.6} {} after{}.",
        before.rms,
        before.unit,
        after.rms,
        after.unit,
        held_out.unwrap_or_default()
    )
}

/// A comment ends with its line: a file's name must not end it.
fn one_line(text: &str) -> String {
    let control =
        |letter: char| letter.is_control() || matches!(letter, '\u{2028}' | '\u{2029}' | '\u{feff}');
    text.chars().map(|letter| if control(letter) { ' ' } else { letter }).collect()
}

/// Nothing is written that the compiler would not take.
fn check(target: &Path, text: &str, equations: &Equations) -> Result<(), Failure> {
    let source = SourceFile::new(target.display().to_string(), text);
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics);
    let read = root.and_then(|root| calibration::read(&root, &equations.names(), &mut diagnostics));
    match read {
        Some(_) => Ok(()),
        None => Err(Failure::Wrong(format!(
            "{}\nerror: the calibration was not written, since it could not be read again; this is a fault of Abbe",
            rendered(&source, &diagnostics).trim_end()
        ))),
    }
}

/// What whoever uses the file should know.
fn tell(target: &Path, diagnosis: &Diagnosis) {
    let target = target.display();
    if diagnosis.findings.is_empty() {
        warn(&format!("warning: no term was found: {target} holds what was known before, and nothing more"));
    }
    for finding in diagnosis.findings.iter().filter(|finding| !finding.compensable) {
        warn(&format!(
            "note: {} of {} in {target} cannot be compensated in real time; abbe compensate needs --leave-out-uncompensable",
            finding.term, finding.motion
        ));
    }
}

#[cfg(test)]
mod tests;
