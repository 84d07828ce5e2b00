//! End points against axes that are known to run there, with and without dead time, and against commands that show the way.

use super::*;
use crate::testing::{normals, programmed};

const STEP: f64 = 0.1;

/// Where an axis stands behind a loop of 5 1/s, told so much time late, and short of its target by friction.
fn driven(command: &[f64], late: f64, friction: f64) -> Vec<f64> {
    let fine = 100;
    let mut place = command[0];
    let mut places = Vec::new();
    for row in 0..command.len() {
        for part in 0..fine {
            let at = crate::number(row) + f64::from(part) / f64::from(fine) - late / STEP;
            // The target that was in force at this instant.
            let told = (0..row).rev().find(|told| crate::number(*told) <= at).unwrap_or_default();
            let (goal, step) =
                (command[if at >= crate::number(row) { row } else { told }], STEP / f64::from(fine));
            let way = goal - place;
            if way.abs() > friction {
                place += 5.0 * (way - friction * way.signum()) * step;
            }
        }
        places.push(place);
    }
    places
}

fn targets(command: &[f64], actual: Vec<f64>) -> Targets {
    let time: Vec<f64> = (0..command.len()).map(|row| STEP * crate::number(row)).collect();
    let mut recording = programmed(&time, &[command.to_vec()]);
    recording.axes[0].actual = Some(actual);
    let given = Given::new(&recording, Vec::new(), Vec::new());
    Targets::new(&recording, &given, &["A"])
}

/// Between two targets, with this number of rows at each.
fn steps(rows: usize) -> Vec<f64> {
    (0..12 * rows).map(|row| if (row / rows).is_multiple_of(2) { 0.0 } else { 9.0 }).collect()
}

#[test]
fn with_dead_time_only_rows_at_rest_are_left() {
    let command = steps(30);
    let found = targets(&command, driven(&command, 0.25, 0.1));
    assert_eq!(found.axes, [0]);
    // 0.25 s late, and 9 e^(-5 t) is below a tenth of a degree after 0.9 s, below a thousandth after 1.8 s.
    for (number, rows) in found.on_the_way.chunks(30).enumerate().skip(1) {
        let left = rows.iter().position(|way| !way).unwrap();
        assert!((11..22).contains(&left), "{number}: {left}");
        assert!(rows[left..].iter().all(|way| !way));
    }
}

#[test]
fn a_target_that_is_left_too_soon_was_not_reached() {
    let command = steps(8);
    let found = targets(&command, driven(&command, 0.25, 0.1));
    assert_eq!(found.axes, [0]);
    assert!(found.on_the_way[8..].iter().all(|way| *way));
}

#[test]
fn a_command_that_shows_the_way_is_no_end_point() {
    // Sweeps with rests at both ends, followed at 5 1/s, with noise.
    let sweep = |row: usize| {
        let at = crate::number(row % 200);
        if at < 100.0 {
            (0.2 * (at - 20.0)).clamp(0.0, 12.0)
        } else {
            (12.0 - 0.2 * (at - 120.0)).clamp(0.0, 12.0)
        }
    };
    let command: Vec<f64> = (0..800).map(sweep).collect();
    let mut actual = driven(&command, 0.0, 0.05);
    actual.iter_mut().zip(normals(3, 800)).for_each(|(place, noise)| *place += 0.02 * noise);
    assert!(targets(&command, actual).axes.is_empty());
    // Stations at which the axis stands whenever it is read.
    let stations = steps(1);
    assert!(targets(&stations, stations.iter().map(|place| place + 0.01).collect()).axes.is_empty());
    assert!(targets(&[3.0; 50], vec![3.0; 50]).axes.is_empty());
    // An axis that stands, read with noise.
    assert!(targets(&[3.0; 50], normals(4, 50)).axes.is_empty());
}
