//! The first stage of a job. In: a recording. Out: the rows of its result: what was recorded, what the diagnosis says, what it found.
//!
//! A recording that cannot be read has a result too: its row says why. One that cannot be read now, and may be the next time, has none.

use std::path::Path;

use diagnosis::diagnosis::{Diagnosis, Estimate, Finding, ParameterValue};
use diagnosis::report::{self, Origin};
use model_dsl::calibration::{self, Calibration};
use model_dsl::equations::Equations;
use recording::Moment;
use workshop::diagnosed::{Keep, diagnose};
use workshop::failure::Failure;
use workshop::recorded;

use crate::file::Fleet;
use crate::jobs::{Job, PutOff, endless, job as job_of};
use crate::results::{Filed, Table, moment, write, write_file};
use crate::shelf::Shelf;
use crate::table::Cell;

/// The word of a verdict for a recording that cannot be read.
pub(crate) const ERROR: &str = "error";

/// What is written about one recording.
struct Rows {
    recording: Vec<Cell>,
    verdict: Vec<Cell>,
    parameters: Vec<Vec<Cell>>,
}

/// Diagnoses a recording and files the result in place of an older one; tells where it is put off.
pub(crate) fn run(fleet: &Fleet, job: &Job, paged: bool, shelf: &Shelf) -> Result<Option<PutOff>, Failure> {
    let Some(machine) = fleet.machines.get(job.place.machine) else { return Ok(None) };
    let filed = Filed { machine: &machine.name, time: job.time, id: &job.place.id, key: &job.key };
    let rows = match diagnosis_of(&job.place.path, paged) {
        Ok((equations, diagnosis)) => {
            if paged {
                write_file(&filed.page(&fleet.results), page(job, &diagnosis).as_bytes())?;
            }
            found(job, machine.kind.as_deref(), &equations, &diagnosis)
        }
        Err(why) => match put_off(fleet, job, &why) {
            Some(put_off) => return Ok(Some(put_off)),
            None => unread(fleet, job, machine.kind.as_deref(), &why),
        },
    };
    write(&fleet.results, &filed, Table::Parameters, &rows.parameters)?;
    write(&fleet.results, &filed, Table::Verdicts, &[rows.verdict])?;
    write(&fleet.results, &filed, Table::Recordings, &[rows.recording])?;
    shelf.replace(&fleet.results, &filed)?;
    Ok(None)
}

/// Draws the page of a recording that was diagnosed without one; there is none of a recording that cannot be read.
pub(crate) fn draw(fleet: &Fleet, job: &Job) -> Result<(), Failure> {
    let Some(machine) = fleet.machines.get(job.place.machine) else { return Ok(()) };
    let filed = Filed { machine: &machine.name, time: job.time, id: &job.place.id, key: &job.key };
    match diagnosis_of(&job.place.path, true) {
        Ok((_, diagnosis)) => write_file(&filed.page(&fleet.results), page(job, &diagnosis).as_bytes()),
        Err(_) => Ok(()),
    }
}

/// Why a recording that could not be read may be read the next time; nothing where its files can be read whole, hold what they held when
/// the job was listed, and are refused in the same words again.
fn put_off(fleet: &Fleet, job: &Job, why: &Failure) -> Option<PutOff> {
    let again = match job_of(fleet, job.place.clone()) {
        Err(put_off) => return Some(put_off),
        Ok(again) => again,
    };
    let same = || diagnosis_of(&job.place.path, false).is_err_and(|again| words(&again) == words(why));
    let changes = || "its files have just changed".to_owned();
    let is_lasting = !words(why).is_empty() && again.key == job.key && same();
    (!is_lasting).then(|| PutOff { label: job.place.label.clone(), why: changes() })
}

fn words(why: &Failure) -> String {
    why.words().map(|words| words.text(false)).unwrap_or_default()
}

fn diagnosis_of(path: &Path, pictured: bool) -> Result<(Equations, Diagnosis), Failure> {
    if let Some(endless) = endless(path) {
        return Err(Failure::wrong(format!(
            "error: cannot read {}: it is a pipe or a device, not a file\nhelp: a recording of a fleet, and what it names, must be files",
            endless.display()
        )));
    }
    let recorded = [recorded::read(path, &())?];
    let keep = if pictured { Keep::Pictures } else { Keep::Nothing };
    let diagnosis = diagnose(&recorded, None, keep, &mut |_| {})?;
    let [recorded] = recorded;
    Ok((recorded.equations, diagnosis))
}

/// The page of a diagnosis.
fn page(job: &Job, diagnosis: &Diagnosis) -> String {
    let command = format!("abbe diagnose {} --format html", job.place.label);
    let program = concat!("abbe ", env!("CARGO_PKG_VERSION"));
    report::html(diagnosis, &Origin { command: &command, program, change: "" })
}

/// The cells with which every row of a job begins.
fn head(job: &Job) -> Vec<Cell> {
    vec![Cell::from(&*job.key), Cell::from(&*job.place.label)]
}

fn found(job: &Job, kind: Option<&str>, equations: &Equations, diagnosis: &Diagnosis) -> Rows {
    let summary = diagnosis.recordings.first().cloned().unwrap_or_default();
    let counts = [summary.rows, summary.samples, summary.missing, summary.outliers, summary.runs];
    let mut recording = head(job);
    recording.extend([Cell::from(kind.map(str::to_owned)), moment(job.time), Cell::from(summary.title)]);
    recording.push(Cell::from(summary.instrument));
    recording.extend(counts.map(Cell::from));
    recording.extend([Cell::from(env!("CARGO_PKG_VERSION")), Cell::None]);
    let (before, after) = (diagnosis.before, diagnosis.after);
    let mut verdict = head(job);
    verdict.extend([moment(job.time), Cell::from(diagnosis.verdict.word())]);
    verdict.extend([Cell::from(&*report::verdict(diagnosis)), Cell::from(diagnosis.findings.len())]);
    verdict.push(Cell::from(diagnosis.model.len()));
    let sizes = [
        diagnosis.noise.value,
        before.rms,
        after.rms,
        before.holdout_rms.unwrap_or(f64::NAN),
        after.holdout_rms.unwrap_or(f64::NAN),
    ];
    verdict.extend(sizes.map(Cell::from));
    verdict.push(Cell::from(before.unit));
    let findings = diagnosis.findings.iter().enumerate();
    let parameters =
        findings.flat_map(|(number, finding)| of_finding(job, equations, number, finding)).collect();
    Rows { recording, verdict, parameters }
}

fn of_finding(job: &Job, equations: &Equations, number: usize, finding: &Finding) -> Vec<Vec<Cell>> {
    let (calibration, family) = (calibration_of(equations, finding), family(finding));
    let fitted = finding.parameters.iter().flat_map(|parameter| parameter.estimates(finding.kind()));
    let row = |(name, estimate): (String, Estimate)| {
        let mut row = head(job);
        row.extend([
            moment(job.time),
            Cell::from(number),
            Cell::from(&*finding.motion),
            Cell::from(finding.term),
        ]);
        row.extend([Cell::Text(name), Cell::from(estimate.value)]);
        row.extend([estimate.ci95.0, estimate.ci95.1].map(Cell::from));
        row.extend([Cell::Text(estimate.unit), Cell::from(finding.share), Cell::from(finding.location.side)]);
        row.extend([finding.location.at_drive, finding.location.inside_loop].map(Cell::from));
        row.extend([Cell::from(&*family), Cell::from(&*calibration)]);
        row
    };
    fitted.map(row).collect()
}

/// What two findings must share to be the same effect, periods apart: motion, term, and the names of what it reads.
fn family(finding: &Finding) -> String {
    let names = finding.parameters.iter().filter_map(|parameter| match &parameter.value {
        ParameterValue::Name(name) => Some(format!(" {}={name}", parameter.name)),
        _ => None,
    });
    let side = if finding.location.at_drive { " at drive" } else { "" };
    format!("{} {}{}{side}", finding.motion, finding.term, names.collect::<String>())
}

/// The finding as a calibration that holds nothing else: what follows it reads it back.
fn calibration_of(equations: &Equations, finding: &Finding) -> String {
    let constants = equations.constants.iter().map(|constant| constant.default.unwrap_or_default()).collect();
    let mut alone = Calibration::new(equations.machine.clone(), constants);
    let term = finding.calibrated_in(&mut alone);
    let motion = finding.motion_number;
    let alone = match finding.location.inside_loop {
        true => alone.with_inside_loop(motion, term),
        false => alone.with(&[(motion, term)]),
    };
    calibration::write(&alone, &equations.names())
}

/// The result of a recording that cannot be read.
fn unread(fleet: &Fleet, job: &Job, kind: Option<&str>, why: &Failure) -> Rows {
    let words = words(why);
    // The same words wherever the folder of the fleet is.
    let folder = format!("{}/", fleet.folder.display());
    let words = if folder == "/" { words } else { words.replace(&folder, "") };
    let mut recording = head(job);
    recording.extend([Cell::from(kind.map(str::to_owned)), moment(job.time)]);
    recording.resize(11, Cell::None);
    recording.extend([Cell::from(env!("CARGO_PKG_VERSION")), Cell::from(&*words)]);
    let first = words.lines().next().unwrap_or_default();
    let mut verdict = head(job);
    verdict.extend([moment(job.time), Cell::from(ERROR), Cell::from(first)]);
    Rows { recording, verdict, parameters: Vec::new() }
}

/// The time of a row.
pub(crate) fn time_of(milliseconds: Option<i64>) -> Option<Moment> {
    Moment::new(milliseconds?.div_euclid(1000))
}
