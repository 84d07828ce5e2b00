//! The laws of tables and of directions.
//!
//! In: random nodes, values and positions. Out: interpolation, held ends, equal answers of equal tables; refusals.

use abbe_runtime::{Direction, DirectionTracker, Table, TableError, Values};
use proptest::prelude::*;

const FORWARD: Direction = Direction::Positive;

fn values() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-1.0..1.0_f64, 1..12)
}

/// Ascending nodes with a value each.
fn nodes() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    prop::collection::vec((0.01..50.0_f64, -1.0..1.0_f64), 1..12).prop_map(|steps| {
        let mut at = -80.0;
        steps
            .into_iter()
            .map(|(step, value)| {
                at += step;
                (at, value)
            })
            .unzip()
    })
}

proptest! {
    #[test]
    fn a_node_gives_its_value((at, values) in nodes()) {
        let table = Table::at(&at, Values::Both(&values)).unwrap();
        for (&node, &value) in at.iter().zip(&values) {
            prop_assert_eq!(table.value(node, FORWARD), value);
        }
    }

    #[test]
    fn between_nodes_it_is_the_chord((at, values) in nodes(), part in 0.0..1.0_f64) {
        let table = Table::at(&at, Values::Both(&values)).unwrap();
        for (node, value) in at.windows(2).zip(values.windows(2)) {
            let position = node[0] * (1.0 - part) + node[1] * part;
            let chord = value[0] * (1.0 - part) + value[1] * part;
            // A node is read to the last digit of the position, over steps down to 0.01.
            prop_assert!((table.value(position, FORWARD) - chord).abs() < 1e-10);
        }
    }

    #[test]
    fn it_is_continuous_and_no_steeper_than_its_steepest_chord(
        values in values(), start in -90.0..90.0_f64, step in 0.5..40.0_f64, at in -600.0..600.0_f64, by in 0.0..1.0_f64,
    ) {
        let table = Table::uniform(start, step, Values::Both(&values)).unwrap();
        let change = (table.value(at + by, FORWARD) - table.value(at, FORWARD)).abs();
        let slope = values.windows(2).fold(0.0, |most: f64, pair| most.max((pair[1] - pair[0]).abs())) / step;
        prop_assert!(change <= slope * by + 1e-12);
    }

    #[test]
    fn uniform_and_listed_nodes_agree(
        values in values(), start in -90.0..90.0_f64, step in 0.5..40.0_f64, position in -200.0..600.0_f64,
    ) {
        let at: Vec<f64> = (0..values.len()).map(|k| start + step * k as f64).collect();
        let uniform = Table::uniform(start, step, Values::Both(&values)).unwrap();
        let listed = Table::at(&at, Values::Both(&values)).unwrap();
        prop_assert!((uniform.value(position, FORWARD) - listed.value(position, FORWARD)).abs() < 1e-11);
    }

    #[test]
    fn beside_a_node_even_and_listed_ones_agree_to_what_even_ones_tell_apart(
        values in values(), start in -90.0..90.0_f64, step in 0.5..40.0_f64, node in 0..12_usize, off in -1e-8..1e-8_f64,
    ) {
        let at: Vec<f64> = (0..values.len()).map(|k| start + step * k as f64).collect();
        let uniform = Table::uniform(start, step, Values::Both(&values)).unwrap();
        let listed = Table::at(&at, Values::Both(&values)).unwrap();
        let position = start + step * (node as f64 + off);
        // Within 2^-29 of a step below a node is at the node; no step here changes a value by more than 2.
        let apart = 2.0_f64.powi(-28) + 1e-11;
        prop_assert!((uniform.value(position, FORWARD) - listed.value(position, FORWARD)).abs() < apart);
    }

    #[test]
    fn ends_of_even_nodes_are_held(
        values in values(), step in 0.5..40.0_f64, falls in any::<bool>(), beyond in prop_oneof![0.0..1e-7_f64, 0.0..1e6_f64],
    ) {
        let step = if falls { -step } else { step };
        let table = Table::uniform(0.0, step, Values::Both(&values)).unwrap();
        let (first, last) = (values[0], values[values.len() - 1]);
        // The last node of a table lies where its step is rounded to.
        let end = step * (values.len() - 1) as f64 * (1.0 + 1e-15);
        for beyond in [beyond.copysign(step), f64::INFINITY.copysign(step)] {
            prop_assert_eq!(table.value(-beyond, FORWARD), first);
            prop_assert_eq!(table.value(end + beyond, FORWARD), last);
        }
    }

    #[test]
    fn a_descending_table_is_the_ascending_one_read_from_its_other_end(
        values in values(), start in -90.0..90.0_f64, step in 0.5..40.0_f64, position in -600.0..600.0_f64,
    ) {
        let descending = Table::uniform(start, -step, Values::Both(&values)).unwrap();
        let turned: Vec<f64> = values.iter().rev().copied().collect();
        let end = start - step * (values.len() - 1) as f64;
        let ascending = Table::uniform(end, step, Values::Both(&turned)).unwrap();
        prop_assert!((descending.value(position, FORWARD) - ascending.value(position, FORWARD)).abs() < 1e-11);
    }

    #[test]
    fn ends_are_held((at, values) in nodes(), beyond in 0.0..1e6_f64) {
        let table = Table::at(&at, Values::Both(&values)).unwrap();
        prop_assert_eq!(table.value(at[0] - beyond, FORWARD), values[0]);
        prop_assert_eq!(table.value(at[at.len() - 1] + beyond, FORWARD), values[values.len() - 1]);
        prop_assert_eq!(table.value(f64::INFINITY, FORWARD), values[values.len() - 1]);
        prop_assert_eq!(table.value(f64::NEG_INFINITY, FORWARD), values[0]);
    }

    #[test]
    fn each_direction_reads_its_own_curve(
        pairs in prop::collection::vec((-1.0..1.0_f64, 2.0..3.0_f64), 1..9), position in -50.0..150.0_f64,
    ) {
        let (forward, reverse): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let both = Table::uniform(0.0, 10.0, Values::Directed { forward: &forward, reverse: &reverse }).unwrap();
        let one = |values| Table::uniform(0.0, 10.0, Values::Both(values)).unwrap().value(position, FORWARD);
        prop_assert_eq!(both.value(position, Direction::Positive), one(&forward));
        prop_assert_eq!(both.value(position, Direction::Negative), one(&reverse));
    }

    #[test]
    fn dither_within_the_threshold_never_turns(
        dither in prop::collection::vec(0.0..1.0_f64, 1..200), forward in any::<bool>(),
    ) {
        let mut tracker = DirectionTracker::new(1.0);
        let sign = if forward { 1.0 } else { -1.0 };
        tracker.update(0.0);
        let going = tracker.update(sign * 10.0);
        prop_assert_eq!(going.sign(), sign);
        for back in dither {
            prop_assert_eq!(tracker.update(sign * (10.0 - back)), going);
        }
    }

    #[test]
    fn a_real_reversal_turns_exactly_once(
        noise in prop::collection::vec(-0.4..0.4_f64, 400), threshold in 0.81..3.0_f64,
    ) {
        // Up to 50 and back in steps smaller than the noise: the direction may turn but once.
        let mut tracker = DirectionTracker::new(threshold);
        let seen: Vec<Direction> = noise.iter().enumerate().map(|(k, noise)| {
            tracker.update(50.0 - (k as f64 - 200.0).abs() * 0.25 + noise)
        }).collect();
        let turns: Vec<usize> = (1..seen.len()).filter(|&k| seen[k] != seen[k - 1]).collect();
        prop_assert_eq!(turns.len(), 1);
        // Not before the top, and not later than the threshold and twice the noise allow.
        let latest = 200.0 + (threshold + 0.8) / 0.25 + 1.0;
        prop_assert!(turns[0] > 197 && (turns[0] as f64) <= latest, "{:?}", turns);
    }
}

#[test]
fn published_descending_table() {
    let table = Table::uniform(0.0, -55.0, Values::Both(&[0.0, 0.002, 0.006])).unwrap();
    assert_eq!(table.value(-27.5, FORWARD), 0.001);
    assert_eq!(table.value(-82.5, FORWARD), 0.004);
    assert_eq!(table.value(10.0, FORWARD), 0.0);
    assert_eq!(table.value(-400.0, FORWARD), 0.006);
}

#[test]
fn a_table_of_the_most_nodes_is_read_to_its_end() {
    let mut values = vec![0.0; 16_777_217];
    (values[16_777_213], values[16_777_214], values[16_777_215]) = (1.0, 2.0, 4.0);
    let table = Table::uniform(0.0, 1.0, Values::Both(&values[..16_777_216])).unwrap();
    assert_eq!(table.value(16_777_213.5, FORWARD), 1.5);
    assert_eq!(table.value(16_777_214.75, FORWARD), 3.5);
    assert_eq!(table.value(16_777_215.0, FORWARD), 4.0);
    assert_eq!(table.value(1e15, FORWARD), 4.0);
    assert_eq!(Table::uniform(0.0, 1.0, Values::Both(&values)), Err(TableError::TooLong));
}

#[test]
fn nan_gives_nan() {
    for values in [&[5.0][..], &[5.0, 6.0, 7.0]] {
        let uniform = Table::uniform(0.0, 1.0, Values::Both(values)).unwrap();
        assert!(uniform.value(f64::NAN, FORWARD).is_nan());
    }
    let listed = Table::at(&[0.0, 1.0], Values::Both(&[5.0, 5.0])).unwrap();
    assert!(listed.value(f64::NAN, FORWARD).is_nan());
}

#[test]
fn bad_tables_are_refused() {
    use TableError::{Empty, Lengths, NotAscending, NotFinite, Step};
    let two = Values::Both(&[1.0, 2.0]);
    let uneven = Values::Directed { forward: &[1.0, 2.0], reverse: &[1.0] };
    let uniform = |start, step, values| Table::uniform(start, step, values).unwrap_err();
    assert_eq!(uniform(0.0, 1.0, Values::Both(&[])), Empty);
    assert_eq!(uniform(0.0, 0.0, two), Step);
    assert_eq!(uniform(0.0, -1e-310, two), Step);
    assert_eq!(uniform(0.0, f64::NAN, two), Step);
    assert_eq!(uniform(0.0, f64::INFINITY, two), Step);
    assert_eq!(uniform(f64::NAN, 1.0, two), NotFinite);
    assert_eq!(uniform(0.0, 1.0, Values::Both(&[1.0, f64::NAN])), NotFinite);
    let reverse = &[f64::INFINITY, 0.0];
    assert_eq!(uniform(0.0, 1.0, Values::Directed { forward: &[0.0, 0.0], reverse }), NotFinite);
    assert_eq!(uniform(0.0, 1.0, uneven), Lengths { expected: 2, found: 1 });
    let at = |nodes, values| Table::at(nodes, values).unwrap_err();
    assert_eq!(at(&[], Values::Both(&[])), Empty);
    assert_eq!(at(&[0.0, 1.0, 2.0], two), Lengths { expected: 3, found: 2 });
    assert_eq!(at(&[0.0, 1.0], uneven), Lengths { expected: 2, found: 1 });
    assert_eq!(at(&[0.0, 0.0], two), NotAscending { index: 1 });
    assert_eq!(at(&[0.0, 2.0, 1.0], Values::Both(&[0.0; 3])), NotAscending { index: 2 });
    assert_eq!(at(&[0.0, f64::NAN], two), NotFinite);
}

#[test]
fn direction_before_the_first_motion_is_positive() {
    let mut tracker = DirectionTracker::new(0.5);
    assert_eq!(tracker.direction(), Direction::Positive);
    assert_eq!(tracker.update(3.0), Direction::Positive);
    assert_eq!(tracker.update(2.5), Direction::Positive); // by the threshold, not by more
    assert_eq!(tracker.update(2.4), Direction::Negative);
}

#[test]
fn the_way_back_counts_from_the_furthest_point() {
    let mut tracker = DirectionTracker::new(1.0);
    for position in [0.0, 10.0, 9.5, 9.2] {
        assert_eq!(tracker.update(position), Direction::Positive);
    }
    // Small steps add up: no single one exceeds the threshold.
    assert_eq!(tracker.update(8.9), Direction::Negative);
    assert_eq!(tracker.update(9.8), Direction::Negative);
    assert_eq!(tracker.update(10.0), Direction::Positive);
}

#[test]
fn positions_that_are_no_numbers_are_ignored() {
    let mut tracker = DirectionTracker::new(1.0);
    assert_eq!(tracker.threshold(), 1.0);
    for position in [f64::NAN, 5.0, f64::NEG_INFINITY, f64::NAN, 4.5] {
        assert_eq!(tracker.update(position), Direction::Positive);
    }
    assert_eq!(tracker.update(3.0), Direction::Negative);
}

#[test]
fn a_threshold_of_zero_turns_at_every_step_back() {
    for threshold in [0.0, -1.0, f64::NAN] {
        let mut tracker = DirectionTracker::new(threshold);
        assert_eq!(tracker.threshold(), 0.0);
        tracker.update(1.0);
        assert_eq!(tracker.update(1.0), Direction::Positive);
        assert_eq!(tracker.update(1.0 - 1e-15), Direction::Negative);
        assert_eq!(tracker.update(1.0), Direction::Positive);
    }
}

proptest! {
    /// A table that repeats has the same value a whole number of turns away, on even nodes and on listed ones, alone and side by side.
    #[test]
    fn a_table_that_repeats_is_the_same_after_any_turn(
        values in prop::collection::vec(-1.0..1.0_f64, 2..12), start in -10.0..10.0_f64, backwards in any::<bool>(),
        place in 0.0..1.0_f64, turns in -50..50_i32,
    ) {
        let mut values = values;
        values.extend(values.first().copied());
        let step = if backwards { -0.5 } else { 0.5 };
        let length = 0.5 * (values.len() - 1) as f64;
        let even = Table::uniform(start, step, Values::Both(&values)).unwrap();
        let mut at: Vec<f64> = (0..values.len()).map(|node| start + step * node as f64).collect();
        let mut listed = values.clone();
        if backwards {
            at.reverse();
            listed.reverse();
        }
        let at = Table::at(&at, Values::Both(&listed)).unwrap();
        let here = start + step.signum() * place * length;
        let held = even.value(here, Direction::Positive);
        let there = here + f64::from(turns) * length;
        for table in [even.repeating().unwrap(), at.repeating().unwrap()] {
            let found = table.value(there, Direction::Positive);
            // Rounding of the place, times the steepest part of the curve.
            prop_assert!((found - held).abs() < 1e-11, "{found} is not {held}");
        }
    }
}

#[test]
fn a_table_that_repeats_jumps_where_its_ends_differ_and_knows_no_other_end() {
    let table = Table::uniform(0.0, 90.0, Values::Both(&[0.0, 1.0, 2.0, 3.0, 4.0])).unwrap();
    let turn = table.repeating().unwrap();
    let read = |table: &Table<'_>, place| table.value(place, Direction::Negative);
    assert_eq!([-45.0, 405.0, 360.0].map(|place| read(&table, place)), [0.0, 4.0, 4.0]);
    assert_eq!([-45.0, 405.0, 360.0].map(|place| read(&turn, place)), [3.5, 0.5, 0.0]);
    assert!(read(&turn, f64::NAN).is_nan() && read(&turn, f64::INFINITY).is_nan());
    for lone in [Table::uniform(0.0, 1.0, Values::Both(&[1.0])), Table::at(&[0.0], Values::Both(&[1.0]))] {
        assert_eq!(lone.unwrap().repeating(), Err(TableError::Lone));
    }
}
