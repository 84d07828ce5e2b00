//! Suspects: every fault against what was found.
//!
//! In: what was found, and the columns of faults. Out: suspects. All models are compared under the noise that the search ended with.
//! Each consists of a fault and of those effects found that are still worth their price beside it. It is compared with the model
//! without a fault. A fault that makes most effects needless lowers the cost.

use super::Suspect;
use super::columns::{Suspected, Versions};
use super::fault::{FACTORS, Factor, Fault};
use super::verdict::Rest;
use crate::certainty::WIDTH_95;
use crate::channel::ChannelAt;
use crate::contest::{Contest, DECISIVE, Outcome};
use crate::engine::Found;
use crate::study::Study;

/// An amount has a name if it differs from that of the name by no more than this share, or if its interval holds it. Effects that were
/// found with the wrong files bias the amount. Once the files are changed, the interval must be no wider than this on either side. The
/// named factors lie a factor of 2 apart or more, so an interval of 10 % holds one of them at most.
pub(super) const NEAR: f64 = 0.1;

/// The faults in a contest with what was found.
pub(super) struct FaultContest<'v> {
    suspected: &'v [Suspected],
    contest: Contest,
    /// Twice the logarithm of how many candidates there were.
    tried: f64,
}

impl<'v> FaultContest<'v> {
    /// Lets the faults compete over all recordings.
    pub(super) fn new(study: &Study<'_>, found: &Found, versions: &'v Versions) -> Self {
        let suspected = versions.suspected.as_slice();
        let columns = |chunk: std::ops::Range<usize>, at: ChannelAt| {
            suspected[chunk].iter().map(|one| one.columns[at.scene][at.channel].clone()).collect::<Vec<_>>()
        };
        let contest = Contest::new(
            study,
            (found, &found.fit.model, &found.appraisal.weights),
            &versions.rows,
            suspected.len(),
            &columns,
        );
        let tried = 2.0 * crate::number(found.pool.len() + suspected.len()).ln();
        Self { suspected, contest, tried }
    }

    /// The faults that cost decisively less than what was found, the cheapest first.
    pub(super) fn suspects(&self) -> Vec<Suspect> {
        let known = self.contest.outcome(None).cost;
        let each = self.suspected.iter().enumerate();
        let mut suspects: Vec<Suspect> = each
            .filter_map(|(number, suspected)| {
                let outcome = self.contest.outcome(Some(number));
                let fault = suspected.fault.clone();
                let (amount, named) = amount_to_try(&fault, &outcome)?;
                let parameter = if named { 0.0 } else { self.contest.samples.max(2.0).ln() };
                let chance =
                    if named && amount == TURNED { turned_by_chance(outcome.deviation) } else { 0.0 };
                let gain = known - outcome.cost - self.tried - parameter + chance;
                let suspect = Suspect { fault, amount, gain, chance, named, others: Vec::new() };
                (gain > DECISIVE).then_some(suspect)
            })
            .collect();
        suspects.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        if let Some((first, rest)) = suspects.split_first_mut() {
            let alike = rest.iter().filter(|other| first.gain - other.gain < DECISIVE);
            first.others = alike.map(|other| (other.fault.clone(), other.amount)).collect();
        }
        suspects
    }

    /// The amount of the first fault beside what was found.
    pub(super) fn rest(&self) -> Option<Rest> {
        let outcome = self.suspected.first().map(|_| self.contest.outcome(Some(0)))?;
        Some(Rest { amount: outcome.amount, deviation: outcome.deviation })
    }
}

/// The amount to try, and whether it has a name. `None` if the fault cannot have the amount that was fitted.
fn amount_to_try(fault: &Fault, outcome: &Outcome) -> Option<(f64, bool)> {
    // An interval that holds 0 for the number itself tells no factor.
    let half = WIDTH_95 * outcome.deviation;
    let near = |from: f64, value: f64| from.abs() <= f64::max(NEAR * value.abs(), half) && half < value.abs();
    if fault.is_whole() {
        return near(outcome.amount - 1.0, 1.0).then_some((1.0, true));
    }
    let from = |factor: &&Factor| 1.0 + outcome.amount - factor.value;
    let named = FACTORS.iter().filter(|factor| fault.is_factor() && near(from(factor), factor.value));
    match named.min_by(|a, b| from(a).abs().total_cmp(&from(b).abs())) {
        Some(factor) => Some((factor.value - 1.0, true)),
        // A factor of 0 or below that is not -1 is no size that a number could have had: it is physics.
        None if fault.is_factor() && outcome.amount <= -1.0 => None,
        None => Some((outcome.amount, false)),
    }
}

/// The amount of a wrong sign: added to what the files say, -2 times that turns +1 into -1.
pub(super) const TURNED: f64 = -2.0;

/// Twice the log of how unlikely it is that a number came to be its own reversal by chance, within this standard deviation. All changes
/// from -3 to +1 times the number are taken to be equally likely: that range is 4 wide, with the reversal, -2, inside.
fn turned_by_chance(deviation: f64) -> f64 {
    let interval = 2.0 * WIDTH_95 * deviation;
    2.0 * (4.0 / interval.clamp(1e-3, 4.0)).ln()
}
