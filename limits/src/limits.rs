//! The limits of a recording. In: the recording with its machine. Out: for each kind of effect in each motion from which size on it
//! would be found, with which interval and by which names; and what no size tells.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use diagnosis::diagnosis::{Diagnosis, Finding};
use rayon::prelude::*;

use crate::answer::{Already, Found, Limit, Limits};
use crate::injection::base::Base;
use crate::injection::effect::Effect;
use crate::injection::kind::Kind;
use crate::posterior::Posterior;
use crate::search::{Effort, Searched, search};
use crate::size::{Scale, drawn};
use crate::subject::{Subject, subjects};
use crate::trial::{Known, Other, Trial};

/// What is asked.
#[derive(Clone, Debug, Default)]
pub struct Question {
    /// Kinds (`backlash`), motions (`EXX`) or axes (`X`) that are asked; all where there is none.
    pub only: Vec<String>,
    /// The effort for each.
    pub effort: Effort,
    /// The seed of all draws.
    pub seed: u64,
}

/// Asks what recordings could show that are alike but for their noise: one of a real machine, or several simulated ones. `progress` is
/// told the part that is done. Nothing where there is no recording.
pub fn limits(known: &[Known], question: &Question, progress: &(dyn Fn(f64) + Sync)) -> Option<Limits> {
    let base = &known.first()?.base;
    let alone = &known.first()?.alone;
    let asked = subjects(base, question.seed).into_iter().filter(|subject| question.asks(base, subject));
    let (shown, subjects): (Vec<Subject>, Vec<Subject>) = asked.partition(|subject| is_shown(subject, alone));
    let done = AtomicUsize::new(0);
    let told = Mutex::new(());
    let all = subjects.par_iter().filter_map(|subject| {
        let searched = search(known, subject, question.effort, question.seed);
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Ok(_one_at_a_time) = told.lock() {
            progress(crate::number(done) / crate::number(subjects.len()));
        }
        limit(base, subject, searched)
    });
    let all = all.collect();
    Some(Limits {
        file: base.name.clone(),
        title: base.recording.title.clone(),
        machine: base.names.machine.clone(),
        verdict: alone.verdict.word(),
        known: alone.findings.iter().map(|finding| format!("{} {}", finding.motion, finding.term)).collect(),
        rows: base.recording.time.len(),
        seed: question.seed,
        already: already(base, &shown),
        advice: None,
        all,
    })
}

/// Whether a recording shows a kind in a motion as it is. A wave more has a period of its own.
fn is_shown(subject: &Subject, alone: &Diagnosis) -> bool {
    let of_motion = |finding: &&Finding| {
        finding.motion_number == subject.motion || subject.alike.contains(&finding.motion_number)
    };
    let term = subject.kind.term();
    !subject.kind.is_wave() && alone.findings.iter().filter(of_motion).any(|finding| finding.kind() == term)
}

fn already(base: &Base, shown: &[Subject]) -> Vec<Already> {
    let mut all: Vec<Already> = Vec::new();
    for subject in shown {
        let one = Already {
            motion: base.names.motions[subject.motion].name.clone(),
            term: subject.kind.term().name().to_owned(),
        };
        if !all.contains(&one) {
            all.push(one);
        }
    }
    all
}

impl Question {
    /// Whether a subject is asked.
    fn asks(&self, base: &Base, subject: &Subject) -> bool {
        let names = [
            subject.kind.name(),
            base.names.motions[subject.motion].name.as_str(),
            base.names.axes[subject.axis].letter.as_str(),
        ];
        let (kinds, places): (Vec<&String>, Vec<&String>) =
            self.only.iter().partition(|word| Kind::of_name(word).is_some());
        let asked =
            |words: &[&String]| words.is_empty() || words.iter().any(|word| names.contains(&word.as_str()));
        asked(&kinds) && asked(&places)
    }
}

fn limit(base: &Base, subject: &Subject, searched: Searched) -> Option<Limit> {
    let Searched { posterior, trials } = searched;
    let first = trials.first()?;
    let effects: Vec<Effect> = trials.iter().map(|trial| trial.effect).collect();
    let name = |motion: &usize| base.names.motions[*motion].name.clone();
    Some(Limit {
        motion: name(&subject.motion),
        axis: base.names.axes[subject.axis].letter.clone(),
        alike: subject.alike.iter().map(name).collect(),
        drawn: drawn(base, &effects),
        scale: Scale::of(base, subject.motion, &first.effect),
        largest: trials.iter().map(|trial| trial.strength).fold(0.0, f64::max),
        instead: if posterior.is_none() {
            most(trials.iter().flat_map(|trial| &trial.instead))
        } else {
            Vec::new()
        },
        found: posterior.map(|posterior| found(posterior, &trials)),
        subject: subject.clone(),
        trials,
    })
}

fn found(posterior: Posterior, trials: &[Trial]) -> Found {
    let strength = posterior.limit();
    let hits: Vec<&Trial> = trials.iter().filter(|trial| trial.is_found).collect();
    let count = crate::number(hits.len().max(1));
    let first = crate::number(hits.iter().filter(|trial| trial.is_first).count()) / count;
    Found {
        uncertainty: posterior.uncertainty(),
        half: half(strength, &hits),
        first,
        others: others(&hits),
        posterior,
        strength,
    }
}

/// Half of the interval at a strength: the middle one of the trials that lie nearest, since an interval does not grow with the size.
fn half(strength: f64, hits: &[&Trial]) -> Option<f64> {
    let away = |trial: &Trial| (trial.strength / strength).ln().abs();
    let mut with: Vec<(f64, f64)> = hits
        .iter()
        .filter_map(|trial| {
            let (size, half) = trial.interval?;
            // Of a gain the interval of one over it is that of a strength; both are relative to the size that was found.
            Some((away(trial), half / size * trial.strength))
        })
        .collect();
    with.sort_by(|a, b| a.0.total_cmp(&b.0));
    with.truncate(NEAREST);
    let mut halves: Vec<f64> = with.into_iter().map(|(_, half)| half).collect();
    halves.sort_by(f64::total_cmp);
    halves.get(halves.len() / 2).copied().filter(|half| half.is_finite())
}

/// The trials whose intervals are looked at: an odd number has a middle.
const NEAREST: usize = 7;

/// The other names that stand beside the effect in at least half of the trials that found it.
fn others(hits: &[&Trial]) -> Vec<Other> {
    let mut counted: Vec<(Other, usize)> = Vec::new();
    for other in hits.iter().flat_map(|trial| &trial.others) {
        match counted.iter_mut().find(|(known, _)| known.name == other.name) {
            Some((known, count)) => {
                *count += 1;
                if known.separate_by.is_empty() {
                    known.separate_by.clone_from(&other.separate_by);
                }
            }
            None => counted.push((other.clone(), 1)),
        }
    }
    counted.retain(|(_, count)| 2 * count >= hits.len());
    counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counted.into_iter().map(|(other, _)| other).collect()
}

/// Names by how often they come.
fn most<'n>(names: impl Iterator<Item = &'n String>) -> Vec<String> {
    let mut counted: Vec<(&String, usize)> = Vec::new();
    for name in names {
        match counted.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += 1,
            None => counted.push((name, 1)),
        }
    }
    counted.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counted.into_iter().map(|(name, _)| name.clone()).collect()
}
