//! Which blocks are held out.

use super::*;
use crate::testing::{Bench, line, path, position, scenario};

/// The numbers of the held-out blocks of one run of 1200 rows, twelve blocks of 100, in which the axis turns at some rows.
fn held_out_of(turns: &[usize]) -> Vec<usize> {
    let bench = Bench::of("FX");
    let any = scenario(path(line(0, 0.0, 300.0), 20.0, 20.0), position("x"));
    let mut recording = bench.record(&bench.calibration("{}"), &any);
    let (mut command, mut way, mut step) = (Vec::new(), 0.0, 1.0);
    for row in 0..1200 {
        command.push(way);
        if turns.contains(&row) {
            step = -step;
        }
        way += step;
    }
    recording.time = (0..1200).map(f64::from).collect();
    recording.run = vec![1; 1200];
    recording.axes[0].command = Some(command);
    let blocks = blocks(&recording);
    assert_eq!(blocks.len(), 12);
    (0..12).filter(|number| blocks[*number].held_out).collect()
}

#[test]
fn every_fourth_block_is_held_out() {
    assert_eq!(held_out_of(&[]), [2, 6, 10], "no change of speed");
    assert_eq!(
        held_out_of(&[150, 250, 350, 450, 550, 650, 750, 850]),
        [2, 6, 10],
        "as many there as elsewhere"
    );
}

#[test]
fn blocks_in_which_the_axis_turns_are_among_those_that_are_held_out() {
    assert_eq!(held_out_of(&[50, 150, 350, 450, 550, 750, 850, 950]), [1, 5, 9], "three of eight");
    assert_eq!(held_out_of(&[150, 350, 550, 750]), [1, 5, 9], "half of them");
}

/// What is held out as a whole cannot be fitted.
#[test]
fn not_all_turns_are_held_out() {
    assert_eq!(held_out_of(&[150, 550, 950]), [2, 6, 10]);
}

/// What happens before the first fitted row or behind the last is foretold by nothing.
#[test]
fn neither_the_first_nor_the_last_block_is_held_out_for_its_turns() {
    assert_eq!(held_out_of(&[50, 150, 550, 750]), [1, 5, 9], "two of four, but neither block 0 nor block 11");
}
