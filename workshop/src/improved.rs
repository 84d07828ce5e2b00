//! The improved calibration. In: what was known of a machine, and a diagnosis. Out: a calibration file with the faults of the files
//! mended and the findings added, which reads back as it was meant; and a machine file beside it where the chain has another order.

mod kept;

use std::io::Write;
use std::path::{Path, PathBuf};

use diagnosis::diagnosis::{Diagnosis, Finding, WrongFile};
use diagnosis::report;
use model_dsl::calibration::{self, Calibration};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use similar::TextDiff;

use crate::failure::Failure;
use crate::named::{Files, machine_name};
use crate::recorded::Recorded;
use crate::told::{Listener, Words};
use crate::written::{self, comment, folder};

/// The improved calibration before it is written.
pub struct Improved {
    /// The text of the calibration file.
    pub text: String,
    /// The machine file that stands beside it, where the chain has another order than the file says.
    pub machine: Option<(PathBuf, SourceFile)>,
}

/// The known calibration mended, with the findings added, as it would stand at `target`.
pub fn calibration(
    target: &Path,
    recorded: &Recorded,
    files: &Files,
    diagnosis: &Diagnosis,
) -> Result<Improved, Failure> {
    let machine = machine_file(target, recorded, diagnosis);
    let improved = improved(mended(target, recorded, files, diagnosis)?, &diagnosis.findings);
    let names = equations(recorded, diagnosis).names();
    let text = commented(target, recorded, files, &calibration::write(&improved, &names))?;
    let text = comments(recorded, files, diagnosis) + &text;
    Ok(Improved { text, machine })
}

/// Writes the known calibration mended, with the findings added; without either it is written as it is, with a warning.
pub fn write(
    target: &Path,
    recorded: &Recorded,
    files: &Files,
    diagnosis: &Diagnosis,
    listener: &dyn Listener,
) -> Result<(), Failure> {
    let Improved { text, machine } = calibration(target, recorded, files, diagnosis)?;
    if let Some((path, _)) = &machine
        && path.exists()
    {
        return Err(Failure::wrong(format!(
            "error: {} already exists, and Abbe never overwrites a machine file\nhelp: move it away, or give --write-calibration \
             another name",
            path.display()
        )));
    }
    let beside = machine
        .map(|(path, source)| {
            let staged = written::staged(&path, |file| file.write_all(source.text().as_bytes()))?;
            Ok::<_, Failure>((path, staged))
        })
        .transpose()?;
    let calibration = written::staged_calibration(target, &text, equations(recorded, diagnosis))?;
    // The machine file first: no calibration may name one that is not there.
    if let Some((path, staged)) = beside {
        written::keep(staged, &path)?;
    }
    written::keep(calibration, target)?;
    tell(target, diagnosis, listener);
    Ok(())
}

/// The equations of the machine with the faults of its file mended.
fn equations<'e>(recorded: &'e Recorded, diagnosis: &'e Diagnosis) -> &'e Equations {
    diagnosis.mended.as_ref().map_or(&recorded.equations, |mended| &mended.equations)
}

/// The new calibration with the comments of the known one: where its numbers come from.
fn commented(target: &Path, recorded: &Recorded, files: &Files, text: &str) -> Result<String, Failure> {
    let (Some(old), Some(path)) = (&recorded.calibration, &files.calibration) else {
        return Ok(text.to_owned());
    };
    let before = calibration::write(&known(target, recorded, files)?, &recorded.equations.names());
    let kept = kept::kept(old.source.text(), &before, text);
    let of_head = match kept.head.is_empty() {
        true => String::new(),
        false => comment(&format!("{} says of itself:", path.display())) + &kept.head,
    };
    Ok(of_head + &kept.text)
}

/// The machine file that is written beside the calibration, where the chain has another order than the file says.
fn machine_file(target: &Path, recorded: &Recorded, diagnosis: &Diagnosis) -> Option<(PathBuf, SourceFile)> {
    let topology = recorded.topology.as_ref()?;
    let word = diagnosis.mended.as_ref()?.word.as_ref().filter(|word| **word != topology.word)?;
    let source = topology.file_with(word)?;
    let stem = target.file_stem()?.to_str()?;
    Some((folder(target).join(format!("{stem}-{word}.yaml")), source))
}

/// What the findings change in the known calibration, both as they would be written beside the recording: a unified diff.
/// Empty where there are none.
pub fn change(recorded: &Recorded, files: &Files, diagnosis: &Diagnosis) -> Result<String, Failure> {
    if diagnosis.findings.is_empty() && diagnosis.model.is_empty() {
        return Ok(String::new());
    }
    let equations = equations(recorded, diagnosis);
    let before = calibration::write(&known(&files.recording, recorded, files)?, &recorded.equations.names());
    let mended = mended(&files.recording, recorded, files, diagnosis)?;
    let after = calibration::write(&improved(mended, &diagnosis.findings), &equations.names());
    let difference = TextDiff::from_lines(&before, &after);
    Ok(difference.unified_diff().context_radius(3).header("known", "with the findings").to_string())
}

/// The same with the faults of the files mended.
fn mended(
    target: &Path,
    recorded: &Recorded,
    files: &Files,
    diagnosis: &Diagnosis,
) -> Result<Calibration, Failure> {
    let known = known(target, recorded, files)?;
    let Some(mended) = &diagnosis.mended else { return Ok(known) };
    let mut calibration = mended.calibration.clone();
    calibration.machine = known.machine;
    let word = recorded.topology.as_ref().zip(mended.word.as_ref());
    if let Some((_, word)) = word.filter(|(topology, word)| topology.word != **word) {
        let beside = machine_file(target, recorded, diagnosis)
            .and_then(|(path, _)| path.file_name()?.to_str().map(str::to_owned));
        calibration.machine.value = beside.unwrap_or_else(|| word.clone());
    }
    Ok(calibration)
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
        let (motion, term) = (finding.motion_number, finding.calibrated_in(&mut known));
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
        || "nothing; constants that the machine file does not give are 0".to_owned(),
        |path| path.display().to_string(),
    );
    let mended = diagnosis.model.iter().map(|change| change.fault.as_str()).collect::<Vec<_>>().join("; ");
    let mut lines = vec![
        format!("Written by abbe diagnose from {}.", recordings.collect::<Vec<_>>().join(", ")),
        format!("Verdict: {}.", report::verdict(diagnosis)),
        rms(diagnosis),
        format!("Known before: {known}."),
    ];
    if !mended.is_empty() {
        lines.push(format!("Corrected: {mended}."));
    }
    lines.push(format!("Added: {added}."));
    lines.iter().map(|line| comment(line)).collect()
}

/// What the model leaves, before and after, in the units of the diagnosis.
fn rms(diagnosis: &Diagnosis) -> String {
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let held_out = before.holdout_rms.zip(after.holdout_rms).map(|(one, other)| {
        format!("; of the held-out samples {one:.6} {} before, {other:.6} {} after", before.unit, after.unit)
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
fn tell(target: &Path, diagnosis: &Diagnosis, listener: &dyn Listener) {
    let warn = |text: String| listener.hear(&Words::from(text));
    let target = target.display();
    for change in diagnosis.model.iter().filter(|change| matches!(change.file, WrongFile::Recording(_))) {
        warn(format!("note: {target} does not correct {}: {}; {}", change.name, change.fault, change.remedy));
    }
    if diagnosis.findings.is_empty() && diagnosis.model.is_empty() {
        warn(format!("warning: no term was found: {target} contains only what was known before"));
    }
    for finding in diagnosis.findings.iter().filter(|finding| !finding.compensable) {
        warn(format!(
            "note: {} of {} in {target} cannot be compensated in real time; abbe compensate needs --leave-out-uncompensable",
            finding.term, finding.motion
        ));
    }
}

#[cfg(test)]
mod tests;
