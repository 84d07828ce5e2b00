//! The improved calibration. In: what was known of a machine, and a diagnosis. Out: a calibration file with the findings
//! added, which reads back as it was meant.

use std::path::Path;

use diagnosis::diagnosis::{Diagnosis, Finding};
use diagnosis::report;
use model_dsl::calibration::{self, Calibration};
use similar::TextDiff;

use super::files::Files;
use crate::commands::simulate::machine_name;
use crate::failure::Failure;
use crate::output::warn;
use crate::recorded::Recorded;
use crate::written::{self, comment, folder};

/// Writes the known calibration with the findings added; without findings it is written as it is, with a warning.
pub(super) fn write(
    target: &Path,
    recorded: &Recorded,
    files: &Files,
    diagnosis: &Diagnosis,
) -> Result<(), Failure> {
    let names = recorded.equations.names();
    let improved = improved(known(target, recorded, files)?, &diagnosis.findings);
    let text = comments(recorded, files, diagnosis) + &calibration::write(&improved, &names);
    written::calibration(target, &text, &recorded.equations)?;
    tell(target, diagnosis);
    Ok(())
}

/// What the findings change in the known calibration, both as they would be written beside the recording: a unified diff.
/// Empty where there are none.
pub(super) fn change(recorded: &Recorded, files: &Files, diagnosis: &Diagnosis) -> Result<String, Failure> {
    if diagnosis.findings.is_empty() {
        return Ok(String::new());
    }
    let names = recorded.equations.names();
    let known = known(&files.recording, recorded, files)?;
    let before = calibration::write(&known, &names);
    let after = calibration::write(&improved(known, &diagnosis.findings), &names);
    let difference = TextDiff::from_lines(&before, &after);
    Ok(difference.unified_diff().context_radius(3).header("known", "with the findings").to_string())
}

/// What is known of the machine, its machine file named from the target's folder.
fn known(target: &Path, recorded: &Recorded, files: &Files) -> Result<Calibration, Failure> {
    let folder = folder(target);
    match (&recorded.calibration, &files.calibration) {
        (Some(known), Some(path)) => {
            let mut known = known.calibration.clone();
            known.machine.value = machine_name(&known.machine.value, path, &folder)?;
            Ok(known)
        }
        _ => {
            let machine = machine_name(&files.machine, &files.recording, &folder)?;
            let constants = recorded.equations.constants.iter();
            Ok(Calibration::new(
                machine,
                constants.map(|constant| constant.default.unwrap_or_default()).collect(),
            ))
        }
    }
}

/// The calibration with the findings, each reading the sensor of its name.
fn improved(mut known: Calibration, findings: &[Finding]) -> Calibration {
    for finding in findings {
        let sensor = finding.sensor.as_ref().map(|name| known.sensor(name));
        let (motion, mut term) = (finding.motion_number, finding.calibrated.clone());
        if let Some(sensor) = sensor {
            term = term.with_sensor(sensor);
        }
        known = if finding.location.inside_loop {
            known.with_inside_loop(motion, term)
        } else {
            known.with(&[(motion, term)])
        };
    }
    known
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
    lines.map(|line| comment(&line)).concat()
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
