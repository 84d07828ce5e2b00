//! Travel: where each axis went over all recordings.
//!
//! In: the states of every recording. Out: for each axis the range of its positions, its typical step from row to row, and
//! how often it turned.

use std::sync::Arc;

use crate::course::Course;
use crate::noise::middle;
use crate::states::AxisStates;
use crate::study::Study;

/// What each axis did over all recordings: mm or rad.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Travel {
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// The typical step between rows while it moves; 0 where it is known at stations alone.
    pub(crate) step: f64,
    pub(crate) moves: bool,
    /// Whether it moves both ways. Only such an axis shows backlash: if an axis never reverses, its direction is a constant.
    pub(crate) turns: bool,
    /// The mean time from reversal to reversal, s; 0 where there is none.
    pub(crate) between: f64,
    /// The highest speed and the highest acceleration, without their signs.
    pub(crate) fastest: f64,
    pub(crate) hardest: f64,
}

impl Travel {
    /// The middle of its positions.
    pub(crate) fn center(&self) -> f64 {
        (self.low + self.high) / 2.0
    }

    /// Whether it moves, but is known nowhere on its way: not in two rows, one behind the other, between which it moved. Stations tell no
    /// waves: of stations at equal steps any period has others that look alike.
    pub(crate) fn is_known_at_stations_alone(&self) -> bool {
        self.moves && self.step == 0.0
    }

    /// The range of positions.
    pub(crate) fn range(&self) -> f64 {
        self.high - self.low
    }
}

/// The travel of every axis.
pub(crate) fn travels(study: &Study<'_>, courses: &[Arc<Course>]) -> Vec<Travel> {
    let observed: f64 = study.scenes.iter().map(|scene| scene.observed).sum();
    (0..study.equations.axes.len()).map(|axis| travel(courses, axis, observed)).collect()
}

/// The greatest size of what is known.
fn highest<'v>(values: impl Iterator<Item = &'v f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(0.0, |highest, value| f64::max(highest, value.abs()))
}

fn travel(courses: &[Arc<Course>], axis: usize, observed: f64) -> Travel {
    let axes = || courses.iter().map(|course| &course.shown.axes[axis]);
    let positions =
        axes().flat_map(|axis| axis.position.iter().copied()).filter(|position| position.is_finite());
    let (low, high) =
        positions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)));
    let mut steps: Vec<f64> = axes()
        .flat_map(|axis| axis.position.windows(2).map(|pair| (pair[1] - pair[0]).abs()))
        .filter(|step| *step > 1e-9 * (high - low))
        .collect();
    let step = middle(&mut steps).unwrap_or(0.0);
    let turned = |axis: &AxisStates| axis.since_reversal.iter().filter(|since| **since == 0.0).count();
    let reversals = crate::number(axes().map(turned).sum());
    let between = if reversals > 0.0 { observed / reversals } else { 0.0 };
    let moves = axes().any(|axis| axis.moves) && high > low;
    let fastest = highest(axes().flat_map(|axis| axis.velocity.iter()));
    let hardest = highest(axes().flat_map(|axis| axis.acceleration.iter()));
    let turns = turns(axes());
    Travel { low, high, step, moves, turns, between, fastest, hardest }
}

/// Whether an axis moves both ways: within a recording, or one way in one of them and the other way in another.
fn turns<'s>(mut axes: impl Iterator<Item = &'s AxisStates> + Clone) -> bool {
    let moved = axes.clone().filter(|axis| axis.moves);
    let mut directions = moved.filter_map(|axis| axis.direction.last());
    let first = directions.next();
    axes.any(turns_within) || directions.any(|other| Some(other) != first)
}

/// Whether an axis moves both ways in a recording. Before its first motion the direction is +1 by convention; a first motion the other way
/// is no reversal.
fn turns_within(axis: &AxisStates) -> bool {
    let other_way = |row: usize| {
        let is_reversal = axis.since_reversal[row] == 0.0 || axis.displaced.get(row) == Some(&true);
        is_reversal && (axis.direction[row] - axis.direction[row - 1]).abs() > 0.0
    };
    (1..axis.direction.len()).any(other_way)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEVER: f64 = f64::INFINITY;

    fn axis(direction: &[f64], since_reversal: &[f64], displaced: &[bool]) -> AxisStates {
        AxisStates {
            direction: direction.into(),
            since_reversal: since_reversal.into(),
            displaced: displaced.into(),
            moves: true,
            ..AxisStates::default()
        }
    }

    #[test]
    fn an_axis_turns_where_it_moves_both_ways_and_not_where_it_begins_to_move() {
        let forward = axis(&[1.0, 1.0, 1.0], &[NEVER; 3], &[]);
        let back = axis(&[1.0, -1.0, -1.0], &[NEVER; 3], &[]);
        let there_and_back = axis(&[1.0, 1.0, -1.0], &[NEVER, NEVER, 0.0], &[]);
        let strokes = axis(&[1.0, 1.0, -1.0, -1.0], &[NEVER; 4], &[false, false, true, false]);
        let same_strokes = axis(&[1.0, -1.0, -1.0, -1.0], &[NEVER; 4], &[false, false, true, false]);
        for (axes, both_ways) in [
            (vec![&forward], false),
            (vec![&back], false),
            (vec![&back, &same_strokes], false),
            (vec![&there_and_back], true),
            (vec![&strokes], true),
            (vec![&forward, &back], true),
        ] {
            assert_eq!(turns(axes.iter().copied()), both_ways, "{axes:?}");
        }
    }
}
