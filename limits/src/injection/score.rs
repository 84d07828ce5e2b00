//! Scores. In: a case, its diagnosis, and that of its base. Out: whether the effect was found by kind and size, what was
//! claimed besides, what is left beside what the base leaves, and whether the interval holds the truth.

use diagnosis::diagnosis::{Diagnosis, Estimate, Finding, IntervalOf, ParameterValue};
use model_dsl::calibration::{CalibratedTerm, TermKind};
use model_dsl::quantity::parse_unit;

use crate::injection::base::{Base, Signal};
use crate::injection::case::Case;
use crate::injection::columns::{difference, rms, straightened};
use crate::injection::effect::Effect;

/// How far a claimed effect may be from the injected one, in parts of its size: within a third it is the right size.
const SAME: f64 = 0.35;

/// What is left held out may be so much more than in the base before something is said to be missing.
pub const NEAR: f64 = 1.1;

/// Periods and frequencies closer than this are one wave: a screw and its neighbours in a table of pitches, or a motor and a gear, lie
/// farther apart.
const WAVE: f64 = 0.03;

/// How an effect was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// Its name stands there, or under `or else`, and its size is right.
    Named,
    /// What was claimed is the same in this recording, under another name.
    Same,
    /// Nothing that was claimed is it.
    Missed,
}

impl How {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Named => "named",
            Self::Same => "same",
            Self::Missed => "missed",
        }
    }
}

/// The score of one case.
pub struct Score {
    /// How the effect was found.
    pub how: How,
    /// The finding that is the effect, by number, where one is.
    pub hit: Option<usize>,
    /// Whether the finding is larger than the effect, because the base has the same effect and does not claim it.
    pub beside_unclaimed: bool,
    /// Claims that were neither injected nor are made of the base.
    pub extra: Vec<String>,
    /// The held-out figure over that of the base.
    pub left: Option<f64>,
    /// Whether the interval of the size holds what was injected beside what the base has; nothing where no interval of it
    /// was told, or the base has the same unclaimed.
    pub covered: Option<bool>,
    /// The verdict's word.
    pub verdict: &'static str,
}

/// How a finding stands to what was injected.
struct Match {
    named: bool,
    /// The base has the same effect and does not claim it: the finding is both together.
    beside_unclaimed: bool,
}

/// A finding with what it alone shows; nothing where that cannot be told.
struct Claim<'d> {
    finding: &'d Finding,
    signal: Option<Signal>,
}

impl Score {
    /// Scores the diagnosis of a case.
    pub fn of(case: &Case, base: &Base, found: &Diagnosis, alone: &Diagnosis) -> Self {
        let left = held_out(found).zip(held_out(alone)).map(|(case, base)| case / base);
        let whole = left.is_some_and(|left| left < NEAR);
        let injected = centred(case, base, &case.signal);
        let (claims, known) = (claims(case, base, found), claims(case, base, alone));
        let matched = |claim: &Claim<'_>| matched(case, base, claim, &known, &injected, whole);
        let matches: Vec<Option<Match>> = claims.iter().map(matched).collect();
        let best =
            |named: bool| matches.iter().position(|one| one.as_ref().is_some_and(|one| one.named == named));
        let hit = best(true).or_else(|| best(false));
        let pieces = hit.is_none() && together(&claims, &known, &injected);
        let how = match hit.and_then(|hit| matches[hit].as_ref()) {
            _ if located(case, base, found) => How::Named,
            Some(hit) if hit.named => How::Named,
            Some(_) => How::Same,
            None if pieces || setting(case, found) && whole => How::Same,
            None => How::Missed,
        };
        let covered = hit.and_then(|hit| {
            let clean = matches[hit].as_ref().is_some_and(|one| one.named && !one.beside_unclaimed);
            covered(case, base, claims[hit].finding, &known).filter(|_| clean)
        });
        // What was injected, told in several pieces, is no claim besides.
        let extra = if pieces { Vec::new() } else { extra(case, base, &claims, &known, hit) };
        let beside_unclaimed =
            hit.and_then(|hit| matches[hit].as_ref()).is_some_and(|one| one.beside_unclaimed);
        Self { how, hit, beside_unclaimed, extra, left, covered, verdict: found.verdict.word() }
    }
}

fn claims<'d>(case: &Case, base: &Base, diagnosis: &'d Diagnosis) -> Vec<Claim<'d>> {
    let claim = |finding: &'d Finding| {
        let signal = signal(base, finding).map(|signal| centred(case, base, &signal));
        Claim { finding, signal }
    };
    diagnosis.findings.iter().map(claim).collect()
}

fn held_out(diagnosis: &Diagnosis) -> Option<f64> {
    diagnosis.after.holdout_rms.filter(|rms| *rms > 0.0)
}

/// Whether a claim is the injected effect, alone or beside what the base has of the same.
fn matched(
    case: &Case,
    base: &Base,
    claim: &Claim<'_>,
    known: &[Claim<'_>],
    injected: &Signal,
    whole: bool,
) -> Option<Match> {
    let claimed = claim.signal.as_ref()?;
    let known: Vec<&Claim<'_>> =
        known.iter().filter(|known| same_label(known.finding, claim.finding)).collect();
    let of_base = known.iter().filter_map(|known| known.signal.as_ref());
    let more = of_base.fold(claimed.clone(), |sum, known| minus(&sum, known));
    let near = |claim: &Signal| size(&minus(claim, injected)) < SAME * size(injected);
    let is_right = near(&more) || near(claimed) || known.is_empty() && is_wave(case, claim, injected);
    let beside_unclaimed = !is_right;
    if beside_unclaimed && !(known.is_empty() && whole && larger(claimed, injected)) {
        return None;
    }
    Some(Match { named: is_named(case, base, claim.finding), beside_unclaimed })
}

/// Whether a claim is the injected wave by its period and its size. Over many cycles a small error of the period shifts its phase, so that
/// the two signals differ though the wave is right.
fn is_wave(case: &Case, claim: &Claim<'_>, injected: &Signal) -> bool {
    let near = apart(&case.effect, &claim.finding.calibrated).is_some_and(|apart| apart < WAVE);
    let larger = claim.signal.as_ref().map(|claimed| size(claimed) / size(injected) - 1.0);
    near && larger.is_some_and(|larger| larger.abs() < SAME)
}

/// By which share the period of a wave, or its frequency, is another one; none where the two are no waves of one kind.
fn apart(injected: &Effect, found: &CalibratedTerm) -> Option<f64> {
    let (injected, found) = match (injected, found) {
        (Effect::Cyclic { period, .. }, CalibratedTerm::Cyclic { period: found, .. }) => (period, found),
        (Effect::Vibration { frequency, .. }, CalibratedTerm::Vibration { frequency: found, .. }) => {
            (frequency, found)
        }
        _ => return None,
    };
    Some((found / injected - 1.0).abs())
}

/// Whether a claim is the injected effect, only larger: the base has its own share of it.
fn larger(claimed: &Signal, injected: &Signal) -> bool {
    let share = dot(claimed, injected) / dot(injected, injected).max(f64::MIN_POSITIVE);
    let scaled: Signal =
        injected.iter().map(|column| column.iter().map(|value| share * value).collect()).collect();
    share > 1.0 && size(&minus(claimed, &scaled)) < SAME * size(&scaled)
}

fn is_named(case: &Case, base: &Base, finding: &Finding) -> bool {
    let motion = base.names.motions[case.motion].name.as_str();
    let is = |of: &str, term: &str| of == motion && term == case.effect.term().name();
    let others = &finding.alternatives;
    is(&finding.motion, finding.term) || others.iter().any(|other| is(&other.motion, other.term))
}

/// Whether all that was claimed more than in the base is what was injected.
fn together(claims: &[Claim<'_>], known: &[Claim<'_>], injected: &Signal) -> bool {
    let added = claims.iter().filter_map(|claim| claim.signal.as_ref());
    let less = added.fold(injected.clone(), |left, claim| minus(&left, claim));
    let taken = known.iter().filter_map(|claim| claim.signal.as_ref());
    let left = taken.fold(less, |left, claim| plus(&left, claim));
    size(&left) < SAME * size(injected)
}

/// Whether a setting of the instrument stands for it: a late clock for a lag, a tilted beam for a scale.
fn setting(case: &Case, found: &Diagnosis) -> bool {
    let stands = match case.effect {
        Effect::Lag { .. } => "clock",
        Effect::Polynomial { .. } => "cosine",
        _ => return false,
    };
    found.settings.iter().any(|setting| setting.term == stands)
}

/// Whether what no term explains is told at the place of a bump.
fn located(case: &Case, base: &Base, found: &Diagnosis) -> bool {
    let Effect::Table { axis, at, width, .. } = case.effect else { return false };
    let letter = &base.names.axes[axis].letter;
    let told = found.unexplained.iter().filter_map(|left| left.interval.as_ref());
    let tables = found.findings.iter().filter(|finding| finding.kind() == TermKind::Table);
    let mut told = told.chain(tables.filter_map(|finding| finding.location.interval.as_ref()));
    told.any(|interval| {
        let (from, to) = (internal(interval.from, interval.unit), internal(interval.to, interval.unit));
        let here = from < at + 1.5 * width && to > at - 1.5 * width;
        // A bump is 4 to 5 widths long: what is said to be anywhere is not located.
        interval.of == IntervalOf::Axis(letter.clone()) && here && to - from < 10.0 * width
    })
}

/// What a finding alone shows in the readings.
fn signal(base: &Base, finding: &Finding) -> Option<Signal> {
    let signal = base.claimed(finding.motion_number, &finding.calibrated, finding.sensor())?;
    signal.iter().flatten().all(|value| value.is_finite()).then_some(signal)
}

/// A signal without what is free in any case: the zero of each reading; for an expansion the slope too, since its reference
/// temperature can be any. Rows without a reading do not count.
fn centred(case: &Case, base: &Base, signal: &Signal) -> Signal {
    let slope = match case.effect {
        Effect::Expansion { axis, .. } => base.path.axes[axis].as_ref().map(|axis| axis.position.clone()),
        _ => None,
    };
    let along = slope.unwrap_or_else(|| vec![0.0; base.path.clock.time.len()]);
    let there = base.residual();
    let column = |(column, there): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
        let seen =
            column.iter().zip(there).map(|(value, read)| if read.is_finite() { *value } else { f64::NAN });
        straightened(&seen.collect::<Vec<f64>>(), &along)
    };
    signal.iter().zip(&there).map(column).collect()
}

fn minus(left: &Signal, right: &Signal) -> Signal {
    left.iter().zip(right).map(|(left, right)| difference(left, right)).collect()
}

fn plus(left: &Signal, right: &Signal) -> Signal {
    let sum = |(left, right): (&Vec<f64>, &Vec<f64>)| left.iter().zip(right).map(|(l, r)| l + r).collect();
    left.iter().zip(right).map(sum).collect()
}

fn size(signal: &Signal) -> f64 {
    signal.iter().map(|column| rms(column).powi(2)).sum::<f64>().sqrt()
}

fn dot(left: &Signal, right: &Signal) -> f64 {
    let pairs = left.iter().flatten().zip(right.iter().flatten());
    pairs.map(|(left, right)| left * right).filter(|product| product.is_finite()).sum()
}

/// Claims that are neither the hit nor in the base; the injected name with another size is a miss and no claim besides.
fn extra(
    case: &Case,
    base: &Base,
    claims: &[Claim<'_>],
    known: &[Claim<'_>],
    hit: Option<usize>,
) -> Vec<String> {
    let of_base = |finding: &Finding| known.iter().any(|known| same_label(known.finding, finding));
    let claims = claims.iter().enumerate().filter(|(number, _)| Some(*number) != hit);
    let findings = claims.map(|(_, claim)| claim.finding);
    let own = |finding: &Finding| hit.is_none() && is_named(case, base, finding);
    let more = findings.filter(|finding| !of_base(finding) && !own(finding));
    more.map(|finding| format!("{} {}", finding.motion, finding.term)).collect()
}

/// Whether two findings are of one name, and of one wave where they are waves.
fn same_label(left: &Finding, right: &Finding) -> bool {
    let wave = |finding: &Finding| match finding.calibrated {
        CalibratedTerm::Cyclic { period, .. } => Some(period),
        CalibratedTerm::Vibration { frequency, .. } => Some(frequency),
        _ => None,
    };
    let alike = match (wave(left), wave(right)) {
        (Some(left), Some(right)) => (left - right).abs() < WAVE * right.abs(),
        _ => true,
    };
    left.motion == right.motion && left.term == right.term && alike
}

/// Whether the interval of the size holds what was injected and what the base has of it.
fn covered(case: &Case, base: &Base, finding: &Finding, known: &[Claim<'_>]) -> Option<bool> {
    let (name, place, injected) = case.effect.size()?;
    if finding.kind() != case.effect.term() || finding.motion != base.names.motions[case.motion].name {
        return None;
    }
    let found = estimate(finding, name, place)?;
    let known = known.iter().map(|known| known.finding).filter(|known| same_label(known, finding));
    let known = known.filter_map(|known| estimate(known, name, place));
    let known: Vec<f64> = known.map(|known| value_of(known, known.value)).collect();
    let (low, high) = (value_of(found, found.ci95.0), value_of(found, found.ci95.1));
    let truth = match case.effect {
        // What stays behind adds up: one over the gain.
        Effect::Lag { .. } | Effect::Acceleration { .. } => {
            1.0 / (1.0 / injected + known.iter().map(|gain| 1.0 / gain).sum::<f64>())
        }
        // Of waves of one period phases count too.
        Effect::Cyclic { .. } | Effect::Vibration { .. } if !known.is_empty() => return None,
        _ => injected + known.iter().sum::<f64>(),
    };
    Some(truth >= low.min(high) && truth <= low.max(high))
}

/// The size of a finding that is of the effect's term, and half of its interval of 95 %, in the effect's unit; of what stays behind a
/// gain, one over it.
pub fn interval(effect: &Effect, finding: &Finding) -> Option<(f64, f64)> {
    let (name, place, _) = effect.size()?;
    if finding.kind() != effect.term() {
        return None;
    }
    let found = estimate(finding, name, place)?;
    let [value, low, high] = [found.value, found.ci95.0, found.ci95.1].map(|number| value_of(found, number));
    match effect {
        Effect::Lag { .. } | Effect::Acceleration { .. } => {
            Some((1.0 / value.abs(), 0.5 * (1.0 / low - 1.0 / high).abs()))
        }
        _ => Some((value.abs(), 0.5 * (high - low).abs())),
    }
}

fn estimate<'f>(finding: &'f Finding, name: &str, place: usize) -> Option<&'f Estimate> {
    finding.parameters.iter().filter(|parameter| parameter.name == name).find_map(|parameter| {
        match &parameter.value {
            ParameterValue::Fitted(estimate) => Some(estimate),
            // The slope of a curve of higher power is that at one place.
            ParameterValue::List(list) if list.len() <= place + 1 => list.get(place),
            _ => None,
        }
    })
}

fn value_of(estimate: &Estimate, number: f64) -> f64 {
    internal(number, &estimate.unit)
}

/// A number in mm, rad, s, degC and N.
pub(crate) fn internal(number: f64, unit: &str) -> f64 {
    match parse_unit(unit) {
        Ok(unit) if unit.offset == 0.0 => number * unit.factor,
        _ => number,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(size: f64) -> Signal {
        vec![(0..40).map(|row| size * (0.3 * f64::from(row)).sin()).collect()]
    }

    #[test]
    fn the_same_shape_may_be_larger_where_the_base_has_a_share_but_never_smaller() {
        assert!(larger(&wave(2.5), &wave(1.0)));
        assert!(!larger(&wave(0.6), &wave(1.0)));
        let line: Signal = vec![(0..40).map(f64::from).collect()];
        assert!(!larger(&line, &wave(1.0)));
    }

    #[test]
    fn a_wave_is_told_by_its_period() {
        let injected = Effect::Cyclic { axis: 0, period: 10.0, amplitude: 1.0, phase: 0.0 };
        let found = |period| CalibratedTerm::Cyclic { axis: 0, period, amplitude: 2.0, phase: 3.0 };
        assert!(apart(&injected, &found(10.2)).is_some_and(|apart| (apart - 0.02).abs() < 1e-12));
        assert!(apart(&injected, &found(9.5)).is_some_and(|apart| apart > WAVE));
        let in_time = CalibratedTerm::Vibration { frequency: 10.0, amplitude: 1.0, phase: 0.0 };
        assert_eq!(apart(&injected, &in_time), None);
    }

    #[test]
    fn numbers_come_in_the_units_of_the_effects() {
        assert!((internal(4.0, "um") - 0.004).abs() < 1e-15);
        assert!((internal(180.0, "deg") - std::f64::consts::PI).abs() < 1e-12);
        assert!((internal(3.0, "") - 3.0).abs() < 1e-15);
    }
}
