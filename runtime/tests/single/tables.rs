//! Tables of 32 bits, against the same tables of 64.

use abbe_runtime::single::{self, Direction};
use abbe_runtime::{Table, Values};

use crate::{ROUNDING, drawn};

const VALUES: [f32; 9] = [0.003, -0.002, 0.011, 0.0, 0.0105, 0.04, -0.013, 0.002, 0.003];

/// The greatest value, and the greatest rise between two nodes.
const LARGEST: f64 = 0.04;
const RISE: f64 = 0.053;

/// What rounding leaves: a difference, the number of steps for each mm and their product round the place, which is at most this many steps
/// from the first node; the rise, its product and the sum round the value.
fn bound(steps: f64) -> f64 {
    ROUNDING * (3.0 * steps * RISE + 2.0 * RISE + LARGEST) * (1.0 + 1e-5)
}

fn of_64() -> [f64; 9] {
    VALUES.map(f64::from)
}

/// Positions within the table and around it, and next to its nodes.
fn positions(start: f32, step: f32) -> Vec<f32> {
    let mut draw = drawn(7);
    let anywhere = (0..5000).map(|_| start + step * (4.0 + 5.0 * draw()));
    let nodes = (0_u8..9).map(|node| start + step * f32::from(node));
    anywhere.chain(nodes.flat_map(|node| [node.next_down(), node, node.next_up()])).collect()
}

#[test]
fn even_tables() {
    for (start, step) in [(0.0, 55.0), (-200.0, 50.0), (0.0, -62.5), (900.0, 0.1)] {
        let found = single::Table::uniform(start, step, single::Values::Both(&VALUES)).unwrap();
        let of_64 = of_64();
        let expected = Table::uniform(f64::from(start), f64::from(step), Values::Both(&of_64)).unwrap();
        for position in positions(start, step) {
            let (found, expected) = (
                found.value(position, Direction::Positive),
                expected.value(f64::from(position), abbe_runtime::Direction::Positive),
            );
            let apart = (f64::from(found) - expected).abs();
            assert!(apart <= bound(9.0), "{start} {step} {position}: {found} is not {expected}");
        }
    }
}

#[test]
fn tables_that_repeat() {
    let (start, step) = (10.0, 45.0);
    let found =
        single::Table::uniform(start, step, single::Values::Both(&VALUES)).unwrap().repeating().unwrap();
    let of_64 = of_64();
    let expected =
        Table::uniform(f64::from(start), f64::from(step), Values::Both(&of_64)).unwrap().repeating().unwrap();
    let mut draw = drawn(11);
    for _ in 0..5000 {
        let position = 3600.0 * draw();
        let (found, expected) = (
            found.value(position, Direction::Positive),
            expected.value(f64::from(position), abbe_runtime::Direction::Positive),
        );
        // Ten turns of eight steps, and the quotient and the product that take whole turns away.
        assert!(
            (f64::from(found) - expected).abs() <= bound(2.0 * 82.0),
            "{position}: {found} is not {expected}"
        );
    }
}

#[test]
fn tables_with_nodes_of_their_own() {
    let at = [-310.0, -200.5, -90.0, -1.0, 0.0, 3.0, 70.0, 210.0, 305.0_f32];
    let found = single::Table::at(&at, single::Values::Both(&VALUES)).unwrap();
    let (at, of_64) = (at.map(f64::from), of_64());
    let expected = Table::at(&at, Values::Both(&of_64)).unwrap();
    let mut draw = drawn(13);
    for _ in 0..5000 {
        let position = 330.0 * draw();
        let (found, expected) = (
            found.value(position, Direction::Negative),
            expected.value(f64::from(position), abbe_runtime::Direction::Negative),
        );
        assert!((f64::from(found) - expected).abs() <= bound(1.0), "{position}: {found} is not {expected}");
    }
}

#[test]
fn nothing_is_read_from_nowhere() {
    let table = single::Table::uniform(0.0, 1.0, single::Values::Both(&VALUES)).unwrap();
    for repeats in [false, true] {
        let table = if repeats { table.repeating().unwrap() } else { table };
        assert!(table.value(f32::NAN, Direction::Positive).is_nan());
    }
    assert_eq!(table.value(-1e30, Direction::Positive), VALUES[0]);
    assert_eq!(table.value(1e30, Direction::Positive), VALUES[8]);
}
