//! Cycles of which only the stations were recorded.
//!
//! In: the places of every run. Out: the same, places that were read twice taken apart, with marks where an overrun must have
//! been that the recording lacks.
//!
//! An instrument that is triggered at stations writes no row at the overrun: the station at the end of the travel is read
//! twice, once from each side, and its two readings follow each other. Where a run turns only at such places, its stations
//! are all that was recorded, and its first place was approached by an overrun too. Where a run turns at a place that was read
//! once, that place is the overrun itself, and nothing is taken for granted. Runs that go one way only are looked at beside
//! their neighbours: the last place of one and the first of the next are then the station that was read twice.

use std::ops::Range;

use super::{REST, Stop};
use crate::course::{Course, cell, dot};

/// The least cosine between a motion and the way back for a turn on one line.
const BACK: f64 = 0.999;

/// Marks what was approached by an overrun that was not recorded, and takes places apart that were read from both sides of it.
pub(super) fn complete(course: &Course<'_>, runs: &mut [Vec<Stop>]) {
    let kinds: Vec<Option<bool>> = runs.iter_mut().map(|run| mark_turns(course, run)).collect();
    let neighbours: Vec<bool> =
        runs.iter().zip(runs.iter().skip(1)).map(|(one, next)| turns_between(course, one, next)).collect();
    for (number, (run, kind)) in runs.iter_mut().zip(kinds).enumerate() {
        let beside = |other: Option<usize>| other.and_then(|other| neighbours.get(other)) == Some(&true);
        let entered = kind.unwrap_or_else(|| beside(number.checked_sub(1)) || beside(Some(number)));
        if let Some(first) = run.first_mut() {
            first.entered = entered;
        }
    }
}

/// Takes the turns of a run that were read twice apart. Out: whether all turns were; nothing where there is none.
fn mark_turns(course: &Course<'_>, run: &mut Vec<Stop>) -> Option<bool> {
    let mut rows: Vec<usize> = run.iter().map(|stop| stop.rows.len()).collect();
    rows.sort_unstable();
    let usual = rows.get(rows.len() / 2).copied()?;
    let turns = turns(course, run);
    if turns.is_empty() {
        return None;
    }
    // Stands at one place between which commands are missing may be one stand: they are no evidence.
    let twice = |turn: &Range<usize>| {
        let stop = run.get(turn.start).filter(|_| turn.len() == 1);
        stop.is_some_and(|stop| stop.rows.len() == 2 * usual && left(course, stop))
    };
    if !turns.iter().all(twice) {
        return Some(false);
    }
    for turn in turns.into_iter().rev() {
        let Some(stop) = run.get_mut(turn.start) else { continue };
        let middle = stop.rows.start + stop.rows.len() / 2;
        let again = Stop {
            position: stop.position.clone(),
            rows: middle..stop.rows.end,
            rested: stop.rested,
            entered: true,
        };
        stop.rows.end = middle;
        run.insert(turn.end, again);
    }
    Some(true)
}

/// Whether there is time for an overrun between the two halves of a stand: rows in motion that fall together have none.
fn left(course: &Course<'_>, stop: &Stop) -> bool {
    let middle = stop.rows.start + stop.rows.len() / 2;
    let time = |row: usize| cell(&course.recording.time, row);
    middle.checked_sub(1).is_some_and(|before| time(middle) - time(before) >= REST)
}

/// The stands at which the motion goes back, those at one place together.
fn turns(course: &Course<'_>, run: &[Stop]) -> Vec<Range<usize>> {
    let mut places: Vec<Range<usize>> = Vec::new();
    for (number, stop) in run.iter().enumerate() {
        let last = places.last_mut().filter(|place| {
            run.get(place.start).is_some_and(|first| super::same(course, &first.position, &stop.position))
        });
        match last {
            Some(place) => place.end = number + 1,
            None => places.push(number..number + 1),
        }
    }
    let at = |place: &Range<usize>| run.get(place.start);
    let turns = places.windows(3).filter(|three| {
        let [before, turn, after] = three else { return false };
        let (Some(before), Some(turn), Some(after)) = (at(before), at(turn), at(after)) else { return false };
        opposed(&step(before, turn), &step(turn, after))
    });
    turns.filter_map(|three| three.get(1).cloned()).collect()
}

/// Whether a run begins where the one before it ended, and goes back.
fn turns_between(course: &Course<'_>, one: &[Stop], next: &[Stop]) -> bool {
    let ([.., before, last], [first, after, ..]) = (one, next) else { return false };
    (last.rested && first.rested)
        && super::same(course, &last.position, &first.position)
        && opposed(&step(before, last), &step(first, after))
}

fn step(from: &Stop, to: &Stop) -> Vec<f64> {
    to.position.iter().zip(&from.position).map(|(to, from)| to - from).collect()
}

fn opposed(one: &[f64], other: &[f64]) -> bool {
    dot(one, other) < -BACK * dot(one, one).sqrt() * dot(other, other).sqrt()
}
