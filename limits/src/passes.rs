//! Extra passes that tell apart what a recording cannot. In: what is never told apart or never found, and a library of moves. Out: the
//! cheapest moves after which the diagnosis names it, each tried and not only promised.
//!
//! ```text
//! each move: recorded beside, the effect in both, diagnosed -> which effects are named alone now
//! greedy: the move that settles most of them for its time; then the next for what is left
//! ```

use std::sync::atomic::{AtomicUsize, Ordering};

use diagnosis::diagnosis::Diagnosis;
use rayon::prelude::*;
use recording::Recording;

use crate::answer::{Advice, Limit, Limits, Pair, Pass};
use crate::injection::base::Base;
use crate::injection::case::Case;
use crate::injection::effect::Effect;
use crate::moves::Move;
use crate::trial::{Known, diagnosed, name};

/// The most passes that are advised: with more of them another path is the better advice.
const MOST: usize = 3;

/// An effect is asked at so many times its limit: what is not told apart there is not for want of size.
const CLEAR: f64 = 3.0;

/// Fixed time of a pass, s: it has to be programmed and started.
const START: f64 = 60.0;

/// An effect with all that it is not told apart from.
struct Open<'l> {
    limit: &'l Limit,
    effect: Effect,
    pairs: Vec<Pair>,
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
        let round = crate::number(advice.passes.len());
        let told = |part: f64| progress((round + part) / crate::number(MOST));
        let settled = settled(known, &moves, &chosen, &open, &told);
        let Some((best, pairs)) = cheapest(&moves, settled) else { break };
        open.iter_mut().for_each(|one| one.pairs.retain(|pair| !pairs.contains(pair)));
        open.retain(|one| !one.pairs.is_empty());
        let (one, _) = &moves[best];
        advice.passes.push(Pass { words: one.words.clone(), time: one.time, settles: pairs });
        chosen.push(best);
    }
    advice.left = open.into_iter().flat_map(|one| one.pairs).collect();
    advice
}

/// An effect that is not told apart, at a size at which that is not for want of it.
fn opened<'l>(known: &Known, limits: &Limits, limit: &'l Limit) -> Option<Open<'l>> {
    let pair = |other: Option<String>| Pair { effect: limit.name(), other };
    let (strength, pairs): (f64, Vec<Pair>) = match &limit.found {
        Some(found) => {
            let others = found.others.iter().map(|other| pair(Some(other.name.clone())));
            (CLEAR * found.strength, others.collect())
        }
        None => (limit.largest, vec![pair(None)]),
    };
    let drawn = limit.subject.drawn(&known.base, limits.seed, 0)?;
    (!pairs.is_empty()).then(|| Open { limit, effect: drawn.effect.at_strength(strength), pairs })
}

/// Which pairs each move settles beside those that were chosen: the moves by their numbers.
fn settled(
    known: &Known,
    moves: &[(&Move, Base)],
    chosen: &[usize],
    open: &[Open<'_>],
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<(usize, Vec<Pair>)> {
    let done = AtomicUsize::new(0);
    let candidates: Vec<usize> = (0..moves.len()).filter(|number| !chosen.contains(number)).collect();
    let of = |number: &usize| {
        let with: Vec<&Base> = chosen.iter().chain([number]).map(|number| &moves[*number].1).collect();
        let pairs = open.iter().flat_map(|one| told_apart(known, &with, one)).collect();
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress(crate::number(done) / crate::number(candidates.len()));
        (*number, pairs)
    };
    candidates.par_iter().map(of).collect()
}

/// The move that settles most for its time.
fn cheapest(moves: &[(&Move, Base)], settled: Vec<(usize, Vec<Pair>)>) -> Option<(usize, Vec<Pair>)> {
    let worth =
        |(number, pairs): &(usize, Vec<Pair>)| crate::number(pairs.len()) / (START + moves[*number].0.time);
    settled
        .into_iter()
        .filter(|(_, pairs)| !pairs.is_empty())
        .max_by(|a, b| worth(a).total_cmp(&worth(b)).then(b.0.cmp(&a.0)))
}

/// The pairs of an effect that the recording tells apart with passes beside it: its own name stands first, the other nowhere.
fn told_apart(known: &Known, passes: &[&Base], open: &Open<'_>) -> Vec<Pair> {
    let (motion, term) = (open.limit.motion.as_str(), open.limit.subject.kind.term());
    let Some(found) = together(known, passes, open) else { return Vec::new() };
    let own = found.findings.iter().find(|finding| finding.motion == motion && finding.kind() == term);
    let Some(own) = own else { return Vec::new() };
    let stays = |pair: &&Pair| {
        pair.other
            .as_ref()
            .is_none_or(|other| own.alternatives.iter().all(|one| name(&one.motion, one.term) != *other))
    };
    open.pairs.iter().filter(stays).cloned().collect()
}

/// The diagnosis of the recording and of passes beside it, with the effect in all of them.
fn together(known: &Known, passes: &[&Base], open: &Open<'_>) -> Option<Diagnosis> {
    let mut recordings = Vec::new();
    for base in std::iter::once(&known.base).chain(passes.iter().copied()) {
        let case = Case::with(0, base, (open.limit.subject.motion, open.effect), 0.0)?;
        recordings.push(case.recording(base));
    }
    let all: Vec<&Recording> = recordings.iter().collect();
    Some(diagnosed(&known.base, &all))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::{Question, limits};
    use crate::moves::library;
    use crate::testing::passes_of_x;

    /// At one height, read along X alone, a play of X along itself and a play of its pitch are one thing. At another height the pitch has
    /// another lever, and across it shows along Z. At the same height, whatever the feed, nothing tells them apart.
    #[test]
    fn another_height_or_direction_tells_a_displacement_from_a_pitch() {
        let known = Known::new(passes_of_x("FXZ", [true, false, false], 1e-3, 1)).unwrap();
        let question = Question { only: vec!["backlash".to_owned()], seed: 1, ..Question::default() };
        let found = limits(std::slice::from_ref(&known), &question, &|_| {}).unwrap();
        let play = &found.all[0];
        let others = &play.found.as_ref().unwrap().others;
        assert_eq!(play.name(), "EXX backlash");
        assert!(others.iter().any(|other| other.name == "EBX backlash"), "{others:?}");
        let library = library(&known.base);
        let advice = advice(&known, &found, &library, &|_| {});
        let pair = Pair { effect: "EXX backlash".to_owned(), other: Some("EBX backlash".to_owned()) };
        let shows_more = |words: &str| words.contains("Z at") || words.contains("three directions");
        let settling = advice.passes.iter().find(|pass| pass.settles.contains(&pair));
        assert!(settling.is_some_and(|pass| shows_more(&pass.words)), "{advice:#?}");
        let others: Vec<Move> = library.into_iter().filter(|one| !shows_more(&one.words)).collect();
        assert!(super::advice(&known, &found, &others, &|_| {}).left.contains(&pair));
    }
}
