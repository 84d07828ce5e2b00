//! What the tests of the whole share: known errors, a diagnosis, and what it says of a parameter.

use abbe_diagnosis::diagnosis::{Diagnosis, Estimate, Finding, ParameterValue, SettingFinding};
use abbe_diagnosis::{Inputs, diagnose};
use model_dsl::calibration::Calibration;

use crate::recording::Recording;
use crate::testing::Bench;

/// Known errors of a mill, larger than what is concealed below them.
pub(crate) const MILL: &str = "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.03, -5e-5]}}], \
    EYX: [{table: {axis: X, start: 0 mm, step: 100 mm, unit: um, values: [0, 3, -2, 4, 1, 0]}}], \
    EYY: [{polynomial: {axis: Y, per: mm, unit: um, coefficients: [0, -0.04]}}], EBX: 20 urad, EC0Y: 60 urad}";

/// Known errors of a single stage.
pub(crate) const STAGE: &str =
    "{EXX: [{table: {axis: X, start: 0 mm, step: 60 mm, unit: um, values: [0, 6, 11, 8, 14, 20]}}]}";

/// The diagnosis of recordings of a machine.
pub(crate) fn diagnosed(bench: &Bench, known: &Calibration, recordings: &[&Recording]) -> Diagnosis {
    with_holdout(bench, known, recordings, None)
}

/// The diagnosis with a recording that is held out.
pub(crate) fn with_holdout(
    bench: &Bench,
    known: &Calibration,
    recordings: &[&Recording],
    holdout: Option<&Recording>,
) -> Diagnosis {
    let inputs = Inputs { holdout, ..bench.inputs(known, recordings) };
    let mut done = 0.0;
    let diagnosis = diagnose(&inputs, &mut |progress| {
        assert!((0.0..=1.0).contains(&progress.done), "{progress:?}");
        done = progress.done;
    });
    assert!(done.is_finite());
    diagnosis
}

/// The findings by their names: `EXX backlash`.
pub(crate) fn found(diagnosis: &Diagnosis) -> Vec<String> {
    diagnosis.findings.iter().map(|finding| format!("{} {}", finding.motion, finding.term)).collect()
}

/// All names of a finding: its own, then those that cannot be told from it.
pub(crate) fn names(finding: &Finding) -> Vec<String> {
    let others = finding.alternatives.iter().map(|other| format!("{} {}", other.motion, other.term));
    std::iter::once(format!("{} {}", finding.motion, finding.term)).chain(others).collect()
}

/// The finding that bears a name, its own or another.
#[track_caller]
pub(crate) fn called<'d>(diagnosis: &'d Diagnosis, name: &str) -> &'d Finding {
    let finding = diagnosis.findings.iter().find(|finding| names(finding).iter().any(|known| known == name));
    let Some(finding) = finding else {
        let found: Vec<_> = diagnosis.findings.iter().map(names).collect();
        panic!("no {name} in {found:?}, {:?}", diagnosis.unexplained)
    };
    finding
}

/// The fitted numbers of a parameter.
#[track_caller]
pub(crate) fn numbers(finding: &Finding, name: &str) -> Vec<Estimate> {
    match finding.parameters.iter().find(|parameter| parameter.name == name).map(|parameter| &parameter.value)
    {
        Some(ParameterValue::Fitted(estimate)) => vec![estimate.clone()],
        Some(ParameterValue::List(list)) => list.clone(),
        other => panic!("{name} of {} {} is {other:?}", finding.motion, finding.term),
    }
}

/// The fitted number of a setting of an instrument.
#[track_caller]
pub(crate) fn setting(settings: &[SettingFinding], term: &str, name: &str) -> Estimate {
    let of_term = settings.iter().filter(|setting| setting.term == term);
    let parameter = of_term.flat_map(|setting| &setting.parameters).find(|parameter| parameter.name == name);
    match parameter.map(|parameter| &parameter.value) {
        Some(ParameterValue::Fitted(estimate)) => estimate.clone(),
        other => panic!("{term} {name}: {other:?} in {settings:?}"),
    }
}

/// How far a number is from the truth, in half widths of its interval.
pub(crate) fn off(estimate: &Estimate, truth: f64) -> f64 {
    let side = if truth > estimate.value {
        estimate.ci95.1 - estimate.value
    } else {
        estimate.value - estimate.ci95.0
    };
    (truth - estimate.value).abs() / side
}

/// 3.3 standard deviations: what is this far off is wrong, whatever the noise.
pub(crate) const FAR: f64 = 1.7;

/// All columns of a recording but its runs.
pub(crate) fn columns(recording: &mut Recording) -> Vec<&mut Vec<f64>> {
    let axes = recording.axes.iter_mut();
    let axes = axes.flat_map(|axis| [&mut axis.command, &mut axis.actual, &mut axis.measured]).flatten();
    let named = recording.temperatures.iter_mut().chain(&mut recording.loads);
    let read = recording.measured.iter_mut().chain([&mut recording.deviation]).flatten();
    [&mut recording.time]
        .into_iter()
        .chain(axes)
        .chain(read)
        .chain(named.map(|one| &mut one.values))
        .collect()
}

/// A recording of these rows, in this order; their times are not changed.
pub(crate) fn of_rows(recording: &Recording, rows: &[usize]) -> Recording {
    let mut changed = recording.clone();
    for column in columns(&mut changed) {
        *column = rows.iter().map(|row| column[*row]).collect();
    }
    changed.run = rows.iter().map(|row| recording.run[*row]).collect();
    changed
}
