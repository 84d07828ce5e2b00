//! The object `abbe-diagnosis/1`, for programs that read a diagnosis. In: a diagnosis. Out: JSON; `docs/reference/diagnosis.md` describes
//! its keys. A number that is not finite is `null`.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use super::figure::change;
use super::told;
use notation::Formula;

use crate::diagnosis::{
    Alternative, Change, Denied, Diagnosis, Estimate, Evidence, Finding, Form, Interval, IntervalOf,
    NoiseSummary, OverTravel, Parameter, ParameterValue, Repeatability, Repeats, Residual, Returning,
    SettingFinding, Summary, Unexplained,
};

/// The diagnosis as one JSON object with the schema `abbe-diagnosis/1`.
pub fn json(diagnosis: &Diagnosis) -> String {
    // Every value is a number, a text, a list or a map with text as keys: writing them cannot fail.
    let mut text = serde_json::to_string_pretty(&report(diagnosis)).unwrap_or_default();
    text.push('\n');
    text
}

#[derive(Serialize)]
struct ReportJson<'d> {
    schema: &'static str,
    machine: &'d str,
    verdict: &'static str,
    noise: NoiseJson,
    before: ResidualJson,
    after: ResidualJson,
    returns: Vec<ReturnsJson<'d>>,
    /// What to change in the files. `after`, `findings` and all that follows are computed with the files changed.
    model: Vec<ChangeJson<'d>>,
    findings: Vec<FindingJson<'d>>,
    instrument: Vec<SettingJson<'d>>,
    unexplained: Option<UnexplainedJson<'d>>,
    repeatability: Option<RepeatabilityJson<'d>>,
    /// The effects that an adequate recording excludes, and the size above which each would have been found.
    denied: Vec<DeniedJson<'d>>,
    undecided: &'d [String],
    recordings: Vec<RecordingJson<'d>>,
}

#[derive(Serialize)]
struct DeniedJson<'d> {
    motion: &'d str,
    term: &'static str,
    above: f64,
    unit: &'static str,
    period: Option<f64>,
    period_unit: Option<&'static str>,
}

#[derive(Serialize)]
struct NoiseJson {
    value: f64,
    unit: &'static str,
    white: f64,
    wander: f64,
    /// s
    time_constant: f64,
}

#[derive(Serialize)]
struct ResidualJson {
    rms: f64,
    holdout_rms: Option<f64>,
    unit: &'static str,
}

#[derive(Serialize)]
struct ReturnsJson<'d> {
    channel: &'d str,
    state: &'d str,
    share: f64,
    left: AmountJson,
    recording: Option<&'d str>,
}

/// A fault of a file.
#[derive(Serialize)]
struct ChangeJson<'d> {
    file: &'d str,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    path: &'d str,
    change: &'static str,
    /// The other place, where two are exchanged or one is moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    with: Option<&'d str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    parameters: Option<Parameters<'d>>,
    fault: &'d str,
    remedy: &'d str,
    share: f64,
    evidence_rms: EvidenceJson,
    indistinguishable_from: &'d [String],
}

/// A number that was not fitted, with its unit.
#[derive(Serialize)]
struct AmountJson {
    value: f64,
    unit: &'static str,
}

#[derive(Serialize)]
struct FindingJson<'d> {
    motion: &'d str,
    meaning: &'d str,
    term: &'static str,
    parameters: Parameters<'d>,
    #[serde(skip_serializing_if = "Option::is_none")]
    over_travel: Option<OverTravelJson<'d>>,
    share: f64,
    r#where: WhereJson<'d>,
    evidence: String,
    evidence_rms: EvidenceJson,
    explanation: &'d str,
    #[serde(skip_serializing_if = "Option::is_none")]
    form: Option<FormJson<'d>>,
    compensable: bool,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    repeats_with: Vec<RepeatsJson>,
    indistinguishable_from: Vec<AlternativeJson<'d>>,
}

/// How far a finding goes over the travel of an axis.
#[derive(Serialize)]
struct OverTravelJson<'d> {
    axis: &'d str,
    #[serde(flatten)]
    range: EstimateJson<'d>,
}

/// The form of a finding that has no name of its own.
#[derive(Serialize)]
struct FormJson<'d> {
    equation: &'d str,
    latex: &'d str,
    mathml: &'d str,
    words: &'d str,
    physics: &'d [&'static str],
}

/// An element of the axis that a wave repeats with.
#[derive(Serialize)]
struct RepeatsJson {
    element: &'static str,
    period: AmountJson,
    harmonic: u32,
}

#[derive(Serialize)]
struct WhereJson<'d> {
    link: Option<&'d str>,
    side: &'static str,
    state: &'static str,
    detail: &'d str,
    #[serde(skip_serializing_if = "Option::is_none")]
    interval: Option<IntervalJson<'d>>,
}

#[derive(Clone, Copy, Serialize)]
struct IntervalJson<'d> {
    /// The axis's letter, `time` or `frequency`.
    axis: &'d str,
    from: f64,
    to: f64,
    unit: &'static str,
}

#[derive(Serialize)]
struct EvidenceJson {
    with: f64,
    without: f64,
    unit: &'static str,
}

#[derive(Serialize)]
struct AlternativeJson<'d> {
    motion: &'d str,
    term: &'static str,
    separate_by: &'d str,
}

#[derive(Serialize)]
struct SettingJson<'d> {
    term: &'static str,
    parameters: Parameters<'d>,
    recording: Option<&'d str>,
    indistinguishable_from: Vec<AlternativeJson<'d>>,
}

#[derive(Serialize)]
struct UnexplainedJson<'d> {
    link: Option<&'d str>,
    direction: &'d str,
    state: &'static str,
    interval: Option<IntervalJson<'d>>,
    /// The same in the form of a finding's.
    r#where: WhereJson<'d>,
    rms: f64,
    unit: &'static str,
    detail: &'d str,
    table_of: Option<&'d str>,
}

#[derive(Serialize)]
struct RepeatabilityJson<'d> {
    between_runs: f64,
    expected: f64,
    unit: &'static str,
    detail: &'d str,
}

#[derive(Serialize)]
struct RecordingJson<'d> {
    file: &'d str,
    title: Option<&'d str>,
    instrument: &'static str,
    rows: usize,
    runs: usize,
    samples: usize,
    missing: usize,
    outliers: usize,
    held_out: &'d str,
}

/// The parameters of a term: an object with a key each, in their order.
struct Parameters<'d>(&'d [Parameter]);

impl Serialize for Parameters<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for parameter in self.0 {
            map.serialize_entry(parameter.name, &Value::from(&parameter.value))?;
        }
        map.end()
    }
}

/// The value of a parameter.
#[derive(Serialize)]
#[serde(untagged)]
enum Value<'d> {
    Name(&'d str),
    Given { value: f64, unit: &'d str },
    Places(Vec<Place<'d>>),
    Fitted(EstimateJson<'d>),
    List(Vec<EstimateJson<'d>>),
}

/// A node of a table.
#[derive(Serialize)]
struct Place<'d> {
    value: f64,
    unit: &'d str,
}

#[derive(Serialize)]
struct EstimateJson<'d> {
    value: f64,
    ci95: [f64; 2],
    unit: &'d str,
}

impl<'d> From<&'d ParameterValue> for Value<'d> {
    fn from(value: &'d ParameterValue) -> Self {
        match value {
            ParameterValue::Name(name) => Self::Name(name),
            ParameterValue::Given(value, unit) => Self::Given { value: *value, unit },
            ParameterValue::Places(places, unit) => {
                Self::Places(places.iter().map(|value| Place { value: *value, unit }).collect())
            }
            ParameterValue::Fitted(fitted) => Self::Fitted(estimate(fitted)),
            ParameterValue::List(list) => Self::List(list.iter().map(estimate).collect()),
        }
    }
}

fn estimate(estimate: &Estimate) -> EstimateJson<'_> {
    let (one, other) = estimate.ci95;
    EstimateJson { value: estimate.value, ci95: [one.min(other), one.max(other)], unit: &estimate.unit }
}

fn report(diagnosis: &Diagnosis) -> ReportJson<'_> {
    ReportJson {
        schema: "abbe-diagnosis/1",
        machine: &diagnosis.machine,
        verdict: diagnosis.verdict.word(),
        noise: noise(&diagnosis.noise),
        before: residual(&diagnosis.before),
        after: residual(&diagnosis.after),
        returns: diagnosis.returns.iter().map(|one| returning(one, diagnosis)).collect(),
        model: diagnosis.model.iter().map(change_of_file).collect(),
        findings: diagnosis.findings.iter().map(finding).collect(),
        instrument: diagnosis.settings.iter().map(|one| setting(one, diagnosis)).collect(),
        unexplained: diagnosis.unexplained.as_ref().map(unexplained),
        repeatability: diagnosis.repeatability.as_ref().map(repeatability),
        denied: diagnosis.denied.iter().map(denied).collect(),
        undecided: &diagnosis.undecided,
        recordings: diagnosis.recordings.iter().map(recording).collect(),
    }
}

fn denied(one: &Denied) -> DeniedJson<'_> {
    let (period, period_unit) = one.period.unzip();
    DeniedJson { motion: &one.motion, term: one.term, above: one.above, unit: one.unit, period, period_unit }
}

fn noise(noise: &NoiseSummary) -> NoiseJson {
    let &NoiseSummary { value, unit, white, wander, time_constant } = noise;
    NoiseJson { value, unit, white, wander, time_constant }
}

fn residual(residual: &Residual) -> ResidualJson {
    let &Residual { rms, holdout_rms, unit } = residual;
    ResidualJson { rms, holdout_rms, unit }
}

fn returning<'d>(one: &'d Returning, diagnosis: &'d Diagnosis) -> ReturnsJson<'d> {
    ReturnsJson {
        channel: &one.channel,
        state: &one.state,
        share: one.share,
        left: AmountJson { value: one.left, unit: one.unit },
        recording: diagnosis.file_of(one.recording),
    }
}

fn change_of_file(change: &Change) -> ChangeJson<'_> {
    ChangeJson {
        file: &change.name,
        line: change.line,
        path: &change.path,
        change: change.change,
        with: change.with.as_deref(),
        parameters: change.amount.as_ref().map(|_| Parameters(change.amount.as_slice())),
        fault: &change.fault,
        remedy: &change.remedy,
        share: change.share,
        evidence_rms: evidence_rms(&change.evidence),
        indistinguishable_from: &change.alternatives,
    }
}

fn finding(finding: &Finding) -> FindingJson<'_> {
    let location = &finding.location;
    FindingJson {
        motion: &finding.motion,
        meaning: &finding.motion_meaning,
        term: finding.term,
        parameters: Parameters(&finding.parameters),
        over_travel: finding.over_travel.as_ref().map(over_travel),
        share: finding.share,
        r#where: WhereJson {
            link: Some(&location.link),
            side: location.side,
            state: location.state,
            detail: &location.detail,
            interval: location.interval.as_ref().map(interval),
        },
        evidence: evidence(&finding.evidence),
        evidence_rms: evidence_rms(&finding.evidence),
        explanation: &finding.explanation,
        form: finding.form.as_ref().map(form),
        compensable: finding.compensable,
        repeats_with: finding.repeats_with.iter().map(repeats).collect(),
        indistinguishable_from: alternatives(&finding.alternatives),
    }
}

fn over_travel(over: &OverTravel) -> OverTravelJson<'_> {
    OverTravelJson { axis: &over.axis, range: estimate(&over.range) }
}

fn form(form: &Form) -> FormJson<'_> {
    let Formula { text, latex, mathml } = &form.equation;
    FormJson { equation: text, latex, mathml, words: &form.words, physics: &form.physics }
}

fn repeats(one: &Repeats) -> RepeatsJson {
    let &Repeats { element, period, unit, harmonic } = one;
    RepeatsJson { element: element.word(), period: AmountJson { value: period, unit }, harmonic }
}

fn evidence_rms(evidence: &Evidence) -> EvidenceJson {
    let &Evidence { with, without, unit, .. } = evidence;
    EvidenceJson { with, without, unit }
}

/// How the held-out rms changes if the finding is removed: a sentence without its full stop.
fn evidence(evidence: &Evidence) -> String {
    match change(evidence.with, evidence.without, evidence.unit) {
        Some((with, without)) => {
            let of = evidence.drive.as_ref().map(|axis| format!(" of the drive's feedback of {axis}"));
            format!("removing it raises the held-out rms{} from {with} to {without}", of.unwrap_or_default())
        }
        None => "no data could be held out".to_owned(),
    }
}

fn interval(interval: &Interval) -> IntervalJson<'_> {
    let axis = match &interval.of {
        IntervalOf::Axis(letter) => letter,
        IntervalOf::Frequency => "frequency",
    };
    IntervalJson { axis, from: interval.from, to: interval.to, unit: interval.unit }
}

fn alternatives(alternatives: &[Alternative]) -> Vec<AlternativeJson<'_>> {
    told(alternatives)
        .map(|Alternative { motion, term, separate_by }| AlternativeJson { motion, term, separate_by })
        .collect()
}

fn setting<'d>(setting: &'d SettingFinding, diagnosis: &'d Diagnosis) -> SettingJson<'d> {
    SettingJson {
        term: setting.term,
        parameters: Parameters(&setting.parameters),
        recording: diagnosis.file_of(setting.recording),
        indistinguishable_from: alternatives(&setting.alternatives),
    }
}

fn unexplained(unexplained: &Unexplained) -> UnexplainedJson<'_> {
    let link = unexplained.link.as_deref();
    let interval = unexplained.interval.as_ref().map(interval);
    UnexplainedJson {
        link,
        direction: &unexplained.direction,
        state: unexplained.state,
        interval,
        r#where: WhereJson {
            link,
            side: "unknown",
            state: unexplained.state,
            detail: &unexplained.detail,
            interval,
        },
        rms: unexplained.rms,
        unit: unexplained.unit,
        detail: &unexplained.detail,
        table_of: unexplained.table_of.as_deref(),
    }
}

fn repeatability(repeatability: &Repeatability) -> RepeatabilityJson<'_> {
    let Repeatability { between_runs, expected, unit, detail } = repeatability;
    RepeatabilityJson { between_runs: *between_runs, expected: *expected, unit, detail }
}

fn recording(summary: &Summary) -> RecordingJson<'_> {
    RecordingJson {
        file: &summary.file,
        title: summary.title.as_deref(),
        instrument: summary.instrument,
        rows: summary.rows,
        runs: summary.runs,
        samples: summary.samples,
        missing: summary.missing,
        outliers: summary.outliers,
        held_out: &summary.held_out,
    }
}
