//! The limit of one kind of effect. In: a recording, a kind in a motion. Out: from which size on nine of ten are found, by trials.
//!
//! ```text
//! large -> found: the interval of its size tells where the limit may lie -> trials where each tells most -> the limit
//!       \-> not found, nor three and ten times as large: no limit; what was claimed in its place
//! ```

use crate::injection::case::strength_of;
use crate::posterior::Posterior;
use crate::subject::Subject;
use crate::trial::{Known, Trial, trial};

/// How a search is led.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// The most trials of one kind in one motion.
    pub trials: usize,
    /// The relative uncertainty of the limit that ends it.
    pub uncertainty: f64,
}

impl Default for Effort {
    /// Some twelve trials know the limit to an eighth, where the share found rises as steeply as most do; where places or moments that
    /// are drawn make it rise slowly, forty do.
    fn default() -> Self {
        Self { trials: 40, uncertainty: 0.12 }
    }
}

/// What trials of one kind in one motion showed.
#[derive(Clone, Debug)]
pub struct Searched {
    /// The limit; nothing where no size was found.
    pub posterior: Option<Posterior>,
    /// All trials, in order.
    pub trials: Vec<Trial>,
}

/// The first sizes, as the largest value in the readings over the root mean square of what the diagnosis leaves of the recording as it
/// is. What is not found at a hundred times all that conceals it is not concealed: it cannot be told from something else.
const LARGE: [f64; 3] = [10.0, 30.0, 100.0];

/// Half of the effects are claimed at some five standard errors of the size, nine of ten at seven; half an interval of 95 % has two.
/// Over the kinds of a simulated line and of a circle the limit was 2.6 to 4.7 halves.
const ERRORS: f64 = 3.5;

/// What is known so of the logarithm of the limit: twice the scatter of those.
const SPREAD: f64 = 0.45;

/// The same where the size that was found has no interval: a quarter of the first size is taken for the limit, within a factor of four.
const VAGUE: f64 = 1.4;

/// So many draws that agree are no chance: of signs one series in 128.
const DRAWS: usize = 8;

/// A size from which on all trials find an effect is told apart in a few trials, to a third of the uncertainty that is asked of a share.
const FIXED: f64 = 1.0 / 3.0;

/// The shares at which trials are made in turn: below nine of ten, where they tell more, and at two places, since the width is asked too.
const SHARES: [f64; 3] = [0.85, 0.5, 0.7];

/// Searches the limit. Trial `t` is made in the recording `t` modulo their number: one real one, or several noises of a simulated one.
pub fn search(known: &[Known], subject: &Subject, effort: Effort, seed: u64) -> Searched {
    let mut series = Series { known, subject, seed, drawn: 0, trials: Vec::new() };
    let posterior = series.begin().map(|begun| series.narrow(begun, effort));
    Searched { posterior, trials: series.trials }
}

struct Series<'s> {
    known: &'s [Known],
    subject: &'s Subject,
    seed: u64,
    drawn: usize,
    trials: Vec<Trial>,
}

impl Series<'_> {
    /// Large effects, until one is found.
    fn begin(&mut self) -> Option<Posterior> {
        for size in LARGE {
            let Known { base, left, .. } = self.known.first()?;
            let allowed = self.subject.drawn(base, self.seed, self.drawn)?;
            let strength = strength_of(base, &allowed, size * left)?;
            let Some(first) = self.at(strength) else { continue };
            if !first.is_found {
                continue;
            }
            let (size, spread) = match first.interval {
                Some((_, half)) if half > 0.0 && half.is_finite() => ((ERRORS * half).min(strength), SPREAD),
                _ => (strength / 4.0, VAGUE),
            };
            let mut posterior =
                if self.is_fixed() { Posterior::sharp(size, spread) } else { Posterior::new(size, spread) };
            posterior.observe(strength, true);
            return Some(posterior);
        }
        None
    }

    /// Whether nothing is drawn: one recording, and an effect that has nothing but its size.
    fn is_fixed(&self) -> bool {
        let [known] = self.known else { return false };
        let drawn =
            |trial: usize| self.subject.drawn(&known.base, self.seed, trial).map(|drawn| drawn.effect);
        (1..DRAWS).all(|trial| drawn(trial) == drawn(0))
    }

    /// Trials where each tells most.
    fn narrow(&mut self, mut posterior: Posterior, effort: Effort) -> Posterior {
        let (shares, uncertainty): (&[f64], f64) = if self.is_fixed() {
            (&[0.5], FIXED * effort.uncertainty)
        } else {
            (&SHARES, effort.uncertainty)
        };
        while self.drawn < effort.trials && posterior.uncertainty() > uncertainty {
            let strength = posterior.reaches(shares[self.drawn % shares.len()]);
            let found = self.at(strength).is_some_and(|trial| trial.is_found);
            posterior.observe(strength, found);
        }
        posterior
    }

    /// One trial with a fresh draw; nothing where no effect of that strength is one of its kind.
    fn at(&mut self, strength: f64) -> Option<Trial> {
        let known = &self.known[self.drawn % self.known.len()];
        let drawn = self.subject.drawn(&known.base, self.seed, self.drawn);
        self.drawn += 1;
        let allowed = drawn?;
        let trial = trial(known, allowed.motion, allowed.effect.at_strength(strength))?;
        self.trials.push(trial.clone());
        Some(trial)
    }
}

#[cfg(test)]
mod tests {
    use model_dsl::calibration::TermKind;

    use super::*;
    use crate::injection::kind::Kind;
    use crate::limits::{Question, limits};
    use crate::testing::passes_of_x;
    use crate::trial::trial;

    /// In white noise the size of a play is known by theory: its standard error is twice the noise over the root of the fitted readings.
    /// A claim takes some standard errors; nine of ten a few more. And what is half again as large is found in fresh noise, what is half as
    /// large is not.
    #[test]
    fn the_limit_of_a_play_in_white_noise_is_some_standard_errors() {
        let noise = 1e-3;
        let known: Vec<Known> = (1..4)
            .map(|seed| Known::new(passes_of_x("FX", [true, false, false], noise, seed)).unwrap())
            .collect();
        let base = &known[0].base;
        let question = Question { only: vec!["backlash".to_owned()], seed: 1, ..Question::default() };
        let found = limits(&known, &question, &|_| {}).unwrap();
        let limit =
            found.all.iter().find(|limit| limit.subject.kind == Kind::Term(TermKind::Backlash)).unwrap();
        let strength = limit.found.as_ref().unwrap().strength;
        let fitted = base.recording.run.iter().filter(|run| **run < 3).count();
        let error = 2.0 * noise / crate::number(fitted).sqrt();
        assert!((3.0..12.0).contains(&(strength / error)), "{strength} is {} errors", strength / error);
        let motion = base.names.motion("EXX").unwrap();
        let share = |strength: f64| {
            let effect = limit.trials[0].effect.at_strength(strength);
            let fresh = (11..17).filter_map(|seed| {
                let known = Known::new(passes_of_x("FX", [true, false, false], noise, seed)).ok()?;
                trial(&known, motion, effect).map(|trial| trial.is_found)
            });
            fresh.filter(|found| *found).count()
        };
        assert!(share(1.5 * strength) >= 5, "{} of 6 at 1.5 times", share(1.5 * strength));
        assert!(share(0.5 * strength) <= 2, "{} of 6 at half", share(0.5 * strength));
    }
}
