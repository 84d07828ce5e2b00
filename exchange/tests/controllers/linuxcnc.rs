//! LinuxCNC's loader, as its source has it: what ends a table, what is left out, and what a trim is.

use abbe_exchange::controller::Kind;
use abbe_exchange::controller::linuxcnc::read;
use abbe_runtime::Direction;

fn trims(text: &str, kind: Kind, position: f64) -> [f64; 2] {
    let table = read(text, kind);
    [Direction::Positive, Direction::Negative].map(|direction| table.trim(position, direction))
}

#[test]
fn a_comment_ends_the_table_without_a_word() {
    let table = read("# screw of X\n0 0.1 0.2\n10 0.3 0.4\n", Kind::Trim);
    assert!(table.is_empty());
    assert_eq!(table.trim(5.0, Direction::Positive), 0.0);
    assert_eq!(table.findings.len(), 1);
    assert!(
        table.findings[0].contains("line 1") && table.findings[0].contains("2 lines"),
        "{:?}",
        table.findings
    );
    let table = read("0 0.1 0.2\n\n10 0.3 0.4\n", Kind::Trim);
    assert_eq!(table.len(), 1, "an empty line is no triplet either");
}

#[test]
fn what_follows_three_numbers_is_not_read() {
    assert_eq!(read("0 0.1 0.2 # at the end\n10 0.3 0.4 7 8\n", Kind::Trim).len(), 2);
}

#[test]
fn a_position_not_above_the_one_before_is_left_out() {
    let table = read("0 0.1 0.1\n10 0.2 0.2\n10 0.9 0.9\n20 0.3 0.3\n", Kind::Trim);
    assert_eq!((table.len(), table.findings.len()), (3, 1));
    assert!((table.trim(15.0, Direction::Positive) - 0.25).abs() < 1e-7);
}

#[test]
fn a_joint_takes_256_entries() {
    let text: String = (0..300).map(|number| format!("{number} 0.001 0.002\n")).collect();
    let table = read(&text, Kind::Trim);
    assert_eq!((table.len(), table.findings.len()), (256, 44));
}

#[test]
fn a_long_line_is_cut_where_the_buffer_ends() {
    // The fourth number begins what the loader takes for the next line: one number, no triplet.
    let line = format!("0 0.1 0.2{}7", " ".repeat(300));
    let table = read(&format!("{line}\n10 0.3 0.4\n"), Kind::Trim);
    assert_eq!(table.len(), 1);
}

#[test]
fn the_same_row_means_opposite_things_in_the_two_types() {
    let row = "0.000 0.002 -0.003\n";
    let [forward, reverse] = trims(row, Kind::Trim, 0.0);
    let [other_forward, other_reverse] = trims(row, Kind::Actual, 0.0);
    assert!((forward - 0.002).abs() < 1e-9 && (reverse + 0.003).abs() < 1e-9);
    assert!((other_forward + 0.002).abs() < 1e-9 && (other_reverse - 0.003).abs() < 1e-9);
}

#[test]
fn trims_run_straight_between_entries_and_stay_outside() {
    let text = "0 0.1 -0.1\n10 0.3 -0.5\n";
    for (position, expected) in [
        (-5.0, [0.1, -0.1]),
        (0.0, [0.1, -0.1]),
        (2.5, [0.15, -0.2]),
        (10.0, [0.3, -0.5]),
        (99.0, [0.3, -0.5]),
    ] {
        for (trim, expected) in trims(text, Kind::Trim, position).into_iter().zip(expected) {
            assert!((trim - expected).abs() < 1e-7, "{position}: {trim}, not {expected}");
        }
    }
}
