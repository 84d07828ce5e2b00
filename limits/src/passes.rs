//! Extra passes that tell apart what a recording cannot. In: what is never told apart or never found, and a library of moves. Out: the
//! cheapest moves after which the diagnosis names it, each tried and not only promised.
//!
//! ```text
//! each move: recorded beside, the effect in both, diagnosed -> which effects are named alone now
//! greedy: the move that settles most of them for its time; then the next for what is left
//! ```

use rayon::prelude::*;
use recording::Recording;

use crate::injection::base::Base;
use crate::injection::case::Case;
use crate::injection::effect::Effect;
use crate::limits::{Limit, Limits};
use crate::moves::Move;
use crate::trial::{Known, diagnosed};

/// An extra pass and what it settles.
#[derive(Clone, Debug)]
pub struct Pass {
    /// What is driven: `X from 0 to 400 mm and back at 50 mm/s, Z at 200 mm`.
    pub words: String,
    /// How long it takes, s.
    pub time: f64,
    /// What would be named alone with it: `EXX backlash`.
    pub settles: Vec<String>,
}

/// What extra passes do for a recording.
#[derive(Clone, Debug, Default)]
pub struct Advice {
    /// The passes, in the order in which they were chosen: each counts on those before it.
    pub passes: Vec<Pass>,
    /// What no move of the library settles.
    pub left: Vec<String>,
}

/// The most passes that are advised: with more of them another path is the better advice.
const MOST: usize = 3;

/// An effect is asked at so many times its limit: what is not told apart there is not for want of size.
const CLEAR: f64 = 3.0;

/// Fixed time of a pass, s: it has to be programmed and started.
const START: f64 = 60.0;

/// What is to be settled.
struct Open<'l> {
    limit: &'l Limit,
    effect: Effect,
}

/// Chooses passes for what is not told apart. `progress` is told the part that is done.
pub fn advice(known: &Known, limits: &Limits, library: &[Move], progress: &(dyn Fn(f64) + Sync)) -> Advice {
    let mut open: Vec<Open<'_>> =
        limits.all.iter().filter_map(|limit| opened(known, limits, limit)).collect();
    let moves: Vec<(&Move, Base)> = library
        .iter()
        .filter_map(|one| Some((one, one.recorded(&known.base, known.left, limits.seed)?)))
        .collect();
    let mut advice = Advice::default();
    let mut chosen: Vec<usize> = Vec::new();
    while !open.is_empty() && advice.passes.len() < MOST {
        let round = advice.passes.len();
        let settled = settled(known, &moves, &chosen, &open, &|part| {
            progress((crate::number(round) + part) / crate::number(MOST));
        });
        let Some((best, names)) = cheapest(&moves, settled) else { break };
        open.retain(|one| !names.contains(&one.limit.name()));
        let (one, _) = &moves[best];
        advice.passes.push(Pass { words: one.words.clone(), time: one.time, settles: names });
        chosen.push(best);
    }
    advice.left = open.iter().map(|one| one.limit.name()).collect();
    advice
}

/// An effect that would not be named alone, at a size at which that is not for want of it.
fn opened<'l>(known: &Known, limits: &Limits, limit: &'l Limit) -> Option<Open<'l>> {
    let strength = match &limit.found {
        Some(found) if found.others.is_empty() => return None,
        Some(found) => CLEAR * found.strength,
        None => limit.largest,
    };
    let drawn = limit.subject.drawn(&known.base, limits.seed, 0)?;
    Some(Open { limit, effect: drawn.effect.at_strength(strength) })
}

/// Which effects each move settles beside those that were chosen: the moves by their numbers.
fn settled(
    known: &Known,
    moves: &[(&Move, Base)],
    chosen: &[usize],
    open: &[Open<'_>],
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<(usize, Vec<String>)> {
    let done = std::sync::atomic::AtomicUsize::new(0);
    let candidates: Vec<usize> = (0..moves.len()).filter(|number| !chosen.contains(number)).collect();
    let of = |number: &usize| {
        let with: Vec<&Base> = chosen.iter().chain([number]).map(|number| &moves[*number].1).collect();
        let named = open.iter().filter(|one| is_named(known, &with, one));
        let names = named.map(|one| one.limit.name()).collect();
        let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress(crate::number(done) / crate::number(candidates.len()));
        (*number, names)
    };
    candidates.par_iter().map(of).collect()
}

/// The move that settles most for its time.
fn cheapest(moves: &[(&Move, Base)], settled: Vec<(usize, Vec<String>)>) -> Option<(usize, Vec<String>)> {
    let worth =
        |(number, names): &(usize, Vec<String>)| crate::number(names.len()) / (START + moves[*number].0.time);
    settled
        .into_iter()
        .filter(|(_, names)| !names.is_empty())
        .max_by(|a, b| worth(a).total_cmp(&worth(b)).then(b.0.cmp(&a.0)))
}

/// Whether the diagnosis of the recording with passes beside it names an effect, and nothing else in its place.
fn is_named(known: &Known, passes: &[&Base], open: &Open<'_>) -> bool {
    let with = |base: &Base| -> Option<Recording> {
        let case = Case::with(0, base, (open.limit.subject.motion, open.effect), 0.0)?;
        Some(case.recording(base))
    };
    let mut recordings = Vec::new();
    for base in std::iter::once(&known.base).chain(passes.iter().copied()) {
        let Some(recording) = with(base) else { return false };
        recordings.push(recording);
    }
    let all: Vec<&Recording> = recordings.iter().collect();
    let Some(found) = diagnosed(&known.base, &all) else { return false };
    let motion = open.limit.motion.as_str();
    found.findings.iter().any(|finding| {
        finding.motion == motion
            && finding.term == open.limit.subject.term()
            && finding.alternatives.iter().all(|other| other.motion == motion && other.term == finding.term)
    })
}
