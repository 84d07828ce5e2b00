//! Scores. In: a case and its diagnosis. Out: what a careful judge would write down: verdict, effects found, false
//! findings, intervals that hold the truth.

use std::f64::consts::TAU;

use diagnosis::diagnosis::{Diagnosis, Estimate, Finding, Interval, IntervalOf, ParameterValue, Verdict};
use model_dsl::calibration::{CalibratedTerm, SeriesInput};
use model_dsl::quantity::parse_unit;

use crate::case::{Case, Expected, Signal, rms};
use crate::effect::Planted;

/// How far one signal may be from another, in parts of its size, to be the same thing.
const SAME: f64 = 0.35;

/// The same where both are curves of one error motion: a table of a few nodes is a polynomial with corners.
const SAME_CURVE: f64 = 0.6;

/// From this energy on an effect is strong: ten standard deviations of white noise in all, about twice what the penalty for trying many
/// candidates takes.
pub(crate) const STRONG: f64 = 10.0;

/// How an effect was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum How {
    Named,
    Alias,
    Same,
    Together,
    Missed,
}

/// One interval held against the truth.
pub(crate) struct Held {
    pub(crate) term: &'static str,
    pub(crate) parameter: &'static str,
    pub(crate) inside: bool,
    /// Away from the truth, in standard deviations of the interval.
    pub(crate) away: f64,
    pub(crate) told: String,
}

/// The score of a case.
pub(crate) struct Score {
    pub(crate) verdict: &'static str,
    pub(crate) verdict_right: bool,
    /// For each planted effect how it was found.
    pub(crate) effects: Vec<How>,
    /// For each planted effect the root of its energy over the noise's: how far above white noise it stands in all.
    pub(crate) energies: Vec<f64>,
    /// The same where nobody knows the noise, for the effects that are strong by their energy; 0 for the others.
    pub(crate) evidence: Vec<f64>,
    /// How many findings there are.
    pub(crate) findings: usize,
    /// Findings that no effect accounts for.
    pub(crate) wrong: Vec<String>,
    /// How far the truth stands out beside what was claimed where nobody knows the noise, if some of that is wrong.
    pub(crate) mistaken: Option<f64>,
    pub(crate) held: Vec<Held>,
    /// Sensors, loads and axes that were named wrong.
    pub(crate) misnamed: usize,
    /// Whether sides are right, where the recording tells them.
    pub(crate) sides: Vec<bool>,
    /// Whether a dent was located.
    pub(crate) located: Option<bool>,
    /// The rms of what is left of the held-out data over that of its noise.
    pub(crate) holdout: Option<f64>,
    pub(crate) seconds: f64,
    pub(crate) rows: usize,
}

/// A finding or a setting, as an effect that can be simulated.
struct Claim {
    name: (String, &'static str),
    aliases: Vec<(String, &'static str)>,
    planted: Option<Planted>,
    signal: Option<Signal>,
}

impl Score {
    /// Scores a diagnosis.
    pub(crate) fn of(case: &Case, diagnosis: &Diagnosis, seconds: f64) -> Self {
        let names = &case.bench.names;
        let single = |planted: &Planted| case.signal(std::slice::from_ref(planted)).unwrap_or_default();
        let signals: Vec<Signal> = case.planted.iter().map(single).collect();
        let claims = claims(case, diagnosis);
        let truths: Vec<(String, &'static str)> =
            case.planted.iter().map(|planted| planted.name(names)).collect();
        let mut effects: Vec<How> = truths
            .iter()
            .map(|truth| match () {
                () if claims.iter().any(|claim| claim.name == *truth) => How::Named,
                () if claims.iter().any(|claim| claim.aliases.contains(truth)) => How::Alias,
                () => How::Missed,
            })
            .collect();
        let mut right: Vec<bool> = claims
            .iter()
            .map(|claim| truths.iter().any(|truth| claim.name == *truth || claim.aliases.contains(truth)))
            .collect();
        for (claim, right) in claims.iter().zip(&mut right) {
            for ((signal, truth), how) in signals.iter().zip(&truths).zip(&mut effects) {
                let curve = |name: &(String, &str)| matches!(name.1, "table" | "polynomial" | "cyclic");
                let curves = claim.name.0 == truth.0 && curve(&claim.name) && curve(truth);
                let bound = if curves { SAME_CURVE } else { SAME };
                if claim.signal.as_ref().is_some_and(|claimed| same(signal, claimed, bound)) {
                    *right = true;
                    *how = if *how == How::Missed { How::Same } else { *how };
                }
            }
        }
        together(case, &claims, &signals, &mut effects, &mut right);
        if case.expected == Expected::Dent {
            dent(case, diagnosis, &mut effects, &mut right);
        }
        let false_ones = claims.iter().zip(&right).filter(|(_, right)| !**right);
        // The files are right.
        let faults = diagnosis.model.iter().map(|change| format!("{} {}", change.path, change.change));
        let wrong: Vec<String> = false_ones.map(|(claim, _)| weighed(case, claim)).chain(faults).collect();
        let energies: Vec<f64> = signals.iter().map(|signal| case.energy(signal)).collect();
        let told =
            |(energy, signal): (&f64, &Signal)| if *energy > STRONG { case.evidence(signal) } else { 0.0 };
        let mut score = Self {
            verdict: diagnosis.verdict.word(),
            verdict_right: verdict_right(case, diagnosis),
            evidence: energies.iter().zip(&signals).map(told).collect(),
            energies,
            effects,
            findings: claims.len() + diagnosis.model.len(),
            mistaken: if wrong.is_empty() { None } else { mistaken(case, &claims) },
            wrong,
            held: Vec::new(),
            misnamed: 0,
            sides: Vec::new(),
            located: (case.expected == Expected::Dent).then(|| located(case, diagnosis)),
            holdout: None,
            seconds,
            rows: case.takes.iter().map(|take| take.simulated.time.len()).sum(),
        };
        if case.expected != Expected::Loose && case.expected != Expected::Dent {
            let factor = if diagnosis.after.unit == "deg" { 180.0 / std::f64::consts::PI } else { 1.0 };
            let left = diagnosis.after.holdout_rms.unwrap_or(diagnosis.after.rms);
            score.holdout = Some(left / (factor * case.held_out_noise()));
        }
        for planted in &case.planted {
            let name = planted.name(names);
            let mut found = diagnosis.findings.iter();
            if let Some(finding) = found.find(|finding| (finding.motion.clone(), finding.term) == name) {
                score.take_parameters(case, planted, finding);
                score.sides.extend(side(case, planted, finding));
            }
        }
        score
    }

    fn take_parameters(&mut self, case: &Case, planted: &Planted, finding: &Finding) {
        let Planted::Term { term, .. } = planted else { return };
        let sensor = |number: usize| case.sensor(finding.sensor().unwrap_or("")) == Some(number);
        let named = match term {
            CalibratedTerm::Expansion { sensor: own, .. } | CalibratedTerm::Growth { sensor: own, .. } => {
                sensor(*own)
            }
            _ => true,
        };
        if !named {
            self.misnamed += 1;
            return;
        }
        if !finding.alternatives.is_empty() {
            return;
        }
        let truths = truths(term);
        for parameter in &finding.parameters {
            let fitted = match &parameter.value {
                ParameterValue::Fitted(estimate) => vec![(parameter.name, 0, estimate)],
                ParameterValue::List(list) => list
                    .iter()
                    .enumerate()
                    .map(|(number, estimate)| (parameter.name, number, estimate))
                    .collect(),
                _ => continue,
            };
            for (name, number, estimate) in fitted {
                // The constant part of a curve cannot be told from a zero.
                if name == "values"
                    || name == "coefficients"
                        && number == 0
                        && matches!(term, CalibratedTerm::Polynomial { .. })
                {
                    continue;
                }
                let truth = truths
                    .iter()
                    .find(|(known, of, _)| *known == name && *of == number)
                    .map(|(.., truth)| *truth);
                let absent = if name == "coefficients" { Some(0.0) } else { None };
                if let Some(truth) = truth.or(absent) {
                    self.held.push(held(finding.term, name, truth, estimate));
                }
            }
        }
    }
}

/// What a diagnosis claims, with what each claim alone would show.
fn claims(case: &Case, diagnosis: &Diagnosis) -> Vec<Claim> {
    let mut claims: Vec<Claim> = diagnosis.findings.iter().map(|finding| claim(case, finding)).collect();
    for setting in diagnosis.settings.iter().filter(|setting| matches!(setting.term, "clock" | "cosine")) {
        let value = setting.parameters.iter().find_map(|parameter| match &parameter.value {
            ParameterValue::Fitted(estimate) => Some(internal(estimate.value, &estimate.unit)),
            _ => None,
        });
        let scene = setting.recording;
        let planted = value.map(|value| match setting.term {
            "clock" => Planted::Clock { scene, offset: value },
            _ => Planted::Cosine { scene, angle: value },
        });
        claims.push(Claim {
            name: ("instrument".to_owned(), setting.term),
            aliases: setting.alternatives.iter().map(|other| (other.motion.clone(), other.term)).collect(),
            signal: planted.clone().and_then(|planted| case.signal(&[planted])),
            planted,
        });
    }
    claims
}

fn claim(case: &Case, finding: &Finding) -> Claim {
    let mut term = finding.calibrated.clone();
    let own = finding.sensor().and_then(|name| case.sensor(name));
    if let (
        CalibratedTerm::Expansion { sensor, .. }
        | CalibratedTerm::Growth { sensor, .. }
        | CalibratedTerm::Polynomial { input: SeriesInput::Sensor(sensor), .. },
        Some(own),
    ) = (&mut term, own)
    {
        *sensor = own;
    }
    // The loop of an axis is the drive's in any case.
    let drive = finding.location.side == "drive" && !matches!(term, CalibratedTerm::Lag { .. });
    let drive = drive
        && case
            .bench
            .names
            .axes
            .iter()
            .enumerate()
            .any(|(axis, _)| case.bench.own(axis) == Some(finding.motion_number));
    let planted = Planted::Term { motion: finding.motion_number, term, drive };
    Claim {
        name: (finding.motion.clone(), finding.term),
        aliases: finding.alternatives.iter().map(|other| (other.motion.clone(), other.term)).collect(),
        signal: case.signal(std::slice::from_ref(&planted)),
        planted: Some(planted),
    }
}

/// How far the truth stands out beside claims, where each of them can be simulated.
fn mistaken(case: &Case, claims: &[Claim]) -> Option<f64> {
    let claimed: Option<Vec<Planted>> = claims.iter().map(|claim| claim.planted.clone()).collect();
    let (truth, claimed) = (case.signal(&case.planted)?, case.signal(&claimed?)?);
    let apart: Signal = truth.iter().zip(&claimed).map(|(truth, claimed)| truth - claimed).collect();
    Some(case.evidence(&apart))
}

fn weighed(case: &Case, claim: &Claim) -> String {
    let peak = claim
        .signal
        .as_ref()
        .map_or(f64::NAN, |signal| signal.iter().fold(0.0, |most: f64, value| most.max(value.abs())));
    let energy = claim.signal.as_ref().map_or(f64::NAN, |signal| case.energy(signal));
    format!("{} {} (peak {peak:.2}, energy {energy:.1})", claim.name.0, claim.name.1)
}

/// Whether a claimed signal reproduces a true one.
fn same(truth: &[f64], claimed: &[f64], bound: f64) -> bool {
    truth.len() == claimed.len() && distance(truth, claimed) < bound * rms(truth)
}

fn distance(left: &[f64], right: &[f64]) -> f64 {
    let sum: f64 = left.iter().zip(right).map(|(left, right)| (left - right) * (left - right)).sum();
    (sum / left.len().max(1) as f64).sqrt()
}

/// Effects that are missed by name, and claims without one, may still be the same sum.
fn together(case: &Case, claims: &[Claim], signals: &[Signal], effects: &mut [How], right: &mut [bool]) {
    if !effects.contains(&How::Missed) && right.iter().all(|right| *right) {
        return;
    }
    let sum = |without: Option<usize>| {
        let others = claims.iter().enumerate().filter(|(number, _)| Some(*number) != without);
        let planted: Vec<Planted> = others.filter_map(|(_, claim)| claim.planted.clone()).collect();
        case.signal(&planted)
    };
    let (Some(truth), Some(all)) = (case.signal(&case.planted), sum(None)) else { return };
    let left = distance(&truth, &all);
    for (signal, how) in signals.iter().zip(effects.iter_mut()) {
        if *how == How::Missed && left < SAME * rms(signal) {
            *how = How::Together;
        }
    }
    // What was claimed against what was found: a missed effect does not make the others false.
    let found = effects.iter().map(|how| *how != How::Missed);
    let found: Vec<bool> = found.collect();
    let met: Vec<Planted> = case
        .planted
        .iter()
        .zip(&found)
        .filter(|(_, found)| **found)
        .map(|(planted, _)| planted.clone())
        .collect();
    let sizes = signals.iter().zip(&found).filter(|(_, found)| **found).map(|(signal, _)| rms(signal));
    let smallest = sizes.fold(f64::INFINITY, f64::min);
    let Some(truth) = case.signal(&met).filter(|_| !met.is_empty()) else { return };
    let left = distance(&truth, &all);
    if left >= SAME * smallest {
        return;
    }
    for (number, right) in right.iter_mut().enumerate() {
        // Part of a sum that is right, and it would be less right without it.
        let needed = sum(Some(number)).is_some_and(|less| distance(&truth, &less) > 1.5 * left.max(1e-9));
        *right |= needed;
    }
}

/// A table or a run of smooth terms of the axis on which the dent is is no false finding.
fn dent(case: &Case, diagnosis: &Diagnosis, effects: &mut [How], right: &mut [bool]) {
    let Some(Planted::Dent { axis, .. }) = case.planted.first() else { return };
    for (finding, right) in diagnosis.findings.iter().zip(right) {
        *right |= matches!(&finding.calibrated, CalibratedTerm::Table { axis: own, .. } if own == axis);
    }
    if located(case, diagnosis) {
        effects[0] = How::Named;
    }
}

fn verdict_right(case: &Case, diagnosis: &Diagnosis) -> bool {
    match (case.expected, diagnosis.verdict) {
        (Expected::Adequate, Verdict::Adequate)
        | (Expected::LeftOut, Verdict::LeftOutPhysics)
        | (Expected::Loose, Verdict::NotRepeatable)
        | (Expected::Dent, Verdict::Unexplained) => true,
        (Expected::Dent, Verdict::LeftOutPhysics) => {
            diagnosis.findings.iter().any(|finding| finding.term == "table")
        }
        _ => false,
    }
}

/// Whether the interval of the dent was told, and not much wider than it is.
fn located(case: &Case, diagnosis: &Diagnosis) -> bool {
    let Some(&Planted::Dent { axis, at, width, .. }) = case.planted.first() else { return false };
    let letter = &case.bench.names.axes[axis].letter;
    let told = diagnosis.unexplained.iter().filter_map(|left| left.interval.as_ref());
    let told = told.chain(
        diagnosis
            .findings
            .iter()
            .filter(|found| found.term == "table")
            .filter_map(|found| found.location.interval.as_ref()),
    );
    let fits = |interval: &Interval| {
        let (from, to) = (internal(interval.from, interval.unit), internal(interval.to, interval.unit));
        let overlap = from <= at + width && to >= at - width;
        interval.of == IntervalOf::Axis(letter.clone()) && overlap && to - from <= 2.0 * 4.0 * width
    };
    told.into_iter().any(fits)
}

/// Whether the side of a finding is right, where the drive was recorded.
fn side(case: &Case, planted: &Planted, finding: &Finding) -> Option<bool> {
    let Planted::Term { term, drive, motion } = planted else { return None };
    let axis = (0..case.bench.names.axes.len()).find(|axis| case.bench.own(*axis) == Some(*motion))?;
    if !case.scenes.iter().all(|scene| scene.scenario.measurement.drives.contains(&axis)) {
        return None;
    }
    let drive = *drive || matches!(term, CalibratedTerm::Lag { .. });
    Some((finding.location.side == "drive") == drive)
}

/// The numbers of a term, by the name and the place of its parameter.
fn truths(term: &CalibratedTerm) -> Vec<(&'static str, usize, f64)> {
    let list = |values: &[f64]| {
        values.iter().enumerate().map(|(number, value)| ("coefficients", number, *value)).collect()
    };
    match term {
        CalibratedTerm::Constant { value } => vec![("value", 0, *value)],
        CalibratedTerm::Polynomial { coefficients, .. } | CalibratedTerm::Coupling { coefficients, .. } => {
            list(coefficients)
        }
        CalibratedTerm::Backlash { lost_motion, wind_up, .. } => {
            vec![("lost_motion", 0, *lost_motion), ("wind_up", 0, *wind_up)]
        }
        CalibratedTerm::ReversalSpike { height, decay, .. } => {
            vec![("height", 0, *height), ("decay", 0, *decay)]
        }
        &CalibratedTerm::Cyclic { period, amplitude, phase, .. } => {
            vec![("period", 0, period), ("amplitude", 0, amplitude), ("phase", 0, phase)]
        }
        &CalibratedTerm::Vibration { frequency, amplitude, phase } => {
            vec![("frequency", 0, frequency), ("amplitude", 0, amplitude), ("phase", 0, phase)]
        }
        CalibratedTerm::Lag { gain, .. } | CalibratedTerm::Acceleration { gain, .. } => {
            vec![("gain", 0, *gain)]
        }
        CalibratedTerm::Expansion { coefficient, .. } | CalibratedTerm::Compliance { coefficient, .. } => {
            vec![("coefficient", 0, *coefficient)]
        }
        CalibratedTerm::Growth { coefficient, time_constant, .. } => {
            vec![("coefficient", 0, *coefficient), ("time_constant", 0, *time_constant)]
        }
        CalibratedTerm::Drift { amplitude, time_constant } => {
            vec![("amplitude", 0, *amplitude), ("time_constant", 0, *time_constant)]
        }
        CalibratedTerm::Step { time, size } => vec![("time", 0, *time), ("size", 0, *size)],
        CalibratedTerm::Delay { time, .. } => vec![("time", 0, *time)],
        CalibratedTerm::Times { core, .. } => truths(core),
        CalibratedTerm::Table { .. } => Vec::new(),
    }
}

fn held(term: &'static str, parameter: &'static str, truth: f64, estimate: &Estimate) -> Held {
    let turn = |number: f64| internal(number, &estimate.unit);
    let (low, high) = (turn(estimate.ci95.0), turn(estimate.ci95.1));
    let value = turn(estimate.value);
    let truth = match parameter {
        "phase" => truth + TAU * ((value - truth) / TAU).round(),
        _ => truth,
    };
    let inside = match parameter {
        // A gain whose interval turns over at infinity.
        "gain" if low > high => truth >= low || truth <= high,
        _ => truth >= low.min(high) && truth <= low.max(high),
    };
    let sigma = (0.25 * (high - low).abs()).max(f64::MIN_POSITIVE);
    let told = format!("{term} {parameter} {truth:.6e} against {value:.6e} in {low:.6e}..{high:.6e}");
    Held { term, parameter, inside, away: (value - truth) / sigma, told }
}

/// A number in mm, rad, s, degC and N.
fn internal(number: f64, unit: &str) -> f64 {
    if unit.is_empty() {
        return number;
    }
    match parse_unit(unit) {
        Ok(unit) if unit.offset == 0.0 => number * unit.factor,
        _ => number,
    }
}
