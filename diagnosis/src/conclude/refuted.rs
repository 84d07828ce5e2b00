//! Claims that refute themselves: what no output may tell.
//!
//! In: findings as they would be told. Out: the one of the least share that its own numbers speak against: held-out readings lie no
//! nearer with it, its size may be nothing by its own interval, or its phase is not known. All findings pass here last, whatever
//! chose them.

use std::f64::consts::FRAC_PI_4;

use model_dsl::calibration::TermKind;

use crate::diagnosis::{Estimate, Finding, Parameter, ParameterValue};

/// Held-out readings must lie nearer by this share of their rms: less is the rounding of a printed figure.
const NEARER: f64 = 1e-3;

/// The number of the finding of the least share that is refuted.
pub(super) fn weakest(findings: &[Finding]) -> Option<usize> {
    // They stand in the order of their shares.
    findings.iter().rposition(refuted)
}

fn refuted(finding: &Finding) -> bool {
    let evidence = &finding.evidence;
    let pays = evidence.with < (1.0 - NEARER) * evidence.without;
    !pays || finding.parameters.iter().any(|parameter| may_be_nothing(finding.kind(), parameter))
}

/// Whether a parameter is not told apart from nothing.
fn may_be_nothing(term: TermKind, parameter: &Parameter) -> bool {
    match &parameter.value {
        ParameterValue::Fitted(estimate) if parameter.name == "phase" => half_width(estimate) > FRAC_PI_4,
        ParameterValue::Fitted(estimate) => SIZES.contains(&parameter.name) && holds_zero(estimate),
        // A polynomial is told from its power 1 on, a coupling and a table from any number: one that stands apart is enough.
        ParameterValue::List(list) => {
            let constants = usize::from(term == TermKind::Polynomial);
            let mut told = list.iter().skip(constants).filter(|one| one.ci95 != (0.0, 0.0)).peekable();
            told.peek().is_some() && told.all(holds_zero)
        }
        _ => false,
    }
}

/// Parameters that say how large a term is.
const SIZES: [&str; 7] = ["lost_motion", "height", "amplitude", "coefficient", "gain", "value", "offset"];

/// Whether an interval holds zero, or what is as good as zero beside the size. The interval of a size that is fitted by its logarithm never
/// holds zero itself.
fn holds_zero(estimate: &Estimate) -> bool {
    let (one, other) = estimate.ci95;
    let size = estimate.value.abs();
    one.min(other) <= NOTHING * size && one.max(other) >= -NOTHING * size
}

/// The share of a size that is as good as nothing. Where a 95 % interval reaches down to a thousandth, the logarithm of the size has a
/// standard deviation above 3.5: not even its power of ten is known. The five drifts and growths in which this was seen reached below 1e-80.
const NOTHING: f64 = 1e-3;

/// Half of the interval of a phase, rad: it must be known within a quarter of a turn.
fn half_width(estimate: &Estimate) -> f64 {
    let (one, other) = estimate.ci95;
    let half = 0.5 * (other - one).abs();
    if estimate.unit == "deg" { half.to_radians() } else { half }
}

#[cfg(test)]
mod tests;
