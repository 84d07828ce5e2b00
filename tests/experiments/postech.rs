//! The mill of POSTECH and RIST: 21 error components, from the printed table to what is left after compensation.
//!
//! In: the shipped calibration, the seven points of the paper and the diagonal through them, both ways. Out: how far the
//! exact machine stands from where it was wanted, without and with compensation, with the machine's 5 um steps, and with
//! the play of Y left out. Of the second order in the errors is what theory leaves.

use model_dsl::calibration::{CalibratedTerm, Calibration};
use simulation::{Commands, Plant};

use super::bench::{Bench, driven};
use crate::shipped::root;

/// The points of figure 8, mm; the paper prints the first three and the last.
const POINTS: [[f64; 3]; 7] = [
    [20.0, 20.0, -50.0],
    [100.0, 60.0, -50.0],
    [180.0, 100.0, -50.0],
    [260.0, 140.0, -50.0],
    [340.0, 180.0, -50.0],
    [420.0, 220.0, -50.0],
    [520.0, 260.0, -50.0],
];

/// The resolution that the paper gives the machine, mm.
const RESOLUTION: f64 = 0.005;

fn bench() -> (Bench, Calibration) {
    let bench = Bench::of("machines/postech-mill.yaml");
    let calibration = bench.calibration_of("calibrations/postech-mill.yaml");
    (bench, calibration)
}

/// The calibration without the play of Y: the table alone.
fn without_play(calibration: &Calibration) -> Calibration {
    let mut table = calibration.clone();
    for listed in &mut table.motions {
        listed.terms.retain(|term| !matches!(term.value, CalibratedTerm::Backlash { .. }));
    }
    table
}

/// From a place before them through all places, over the end and back through all of them; and which rows are wanted.
fn there_and_back(places: &[[f64; 3]]) -> (Commands, usize) {
    let (first, last) = (places[0], places[places.len() - 1]);
    let beside = |place: [f64; 3], by: f64| [place[0] + by, place[1] + by, place[2]];
    let mut way = vec![beside(first, -10.0)];
    way.extend_from_slice(places);
    way.push(beside(last, 10.0));
    way.extend(places.iter().rev());
    let column = |axis: usize| way.iter().map(|place| place[axis]).collect();
    let time: Vec<f64> = way.iter().scan(0.0, |time, _| Some(std::mem::replace(time, *time + 1.0))).collect();
    let commands = Commands {
        run: vec![1; way.len()],
        positions: (0..3).map(column).collect(),
        time,
        ..Commands::default()
    };
    (commands, places.len())
}

/// What a machine with steps makes of commands.
fn in_steps(commands: &Commands, step: f64) -> Commands {
    let round = |column: &Vec<f64>| column.iter().map(|place| (place / step).round() * step).collect();
    Commands { positions: commands.positions.iter().map(round).collect(), ..commands.clone() }
}

/// Where the tool stands against where it was wanted: forwards, then backwards in the order of the way; mm.
struct Misses {
    wanted: Vec<[f64; 3]>,
    error: Vec<[f64; 3]>,
    count: usize,
}

impl Misses {
    fn of(plant: &Plant, wanted: &Commands, sent: &Commands, count: usize) -> Self {
        let place = |row: usize| -> Vec<f64> { wanted.positions.iter().map(|column| column[row]).collect() };
        let rows: Vec<usize> = (1..=count).chain(count + 2..count * 2 + 2).collect();
        let stands = driven(plant, sent);
        let nominal: Vec<[f64; 3]> = rows.iter().map(|row| plant.nominal(&place(*row)).tip.into()).collect();
        let less = |(row, nominal): (&usize, &[f64; 3])| {
            std::array::from_fn(|axis| stands[*row][axis] - nominal[axis])
        };
        Self { error: rows.iter().zip(&nominal).map(less).collect(), wanted: nominal, count }
    }

    /// The largest distance from where the tool was wanted, um.
    fn largest(&self) -> f64 {
        self.distances().into_iter().fold(0.0, f64::max)
    }

    fn distances(&self) -> Vec<f64> {
        self.error
            .iter()
            .map(|error| 1e3 * error.iter().map(|part| part * part).sum::<f64>().sqrt())
            .collect()
    }

    /// What an interferometer along the diagonal reads too much, from its zero at the first point, um.
    fn along(&self) -> Vec<f64> {
        let (first, last) = (self.wanted[0], self.wanted[self.count - 1]);
        let way: [f64; 3] = std::array::from_fn(|axis| last[axis] - first[axis]);
        let length = way.iter().map(|part| part * part).sum::<f64>().sqrt();
        let read = |error: &[f64; 3]| (0..3).map(|axis| 1e3 * error[axis] * way[axis] / length).sum::<f64>();
        self.error.iter().map(|error| read(error) - read(&self.error[0])).collect()
    }

    /// The largest reading of either sign.
    fn largest_along(&self) -> f64 {
        self.along().into_iter().fold(0.0, |largest, reading| reading.abs().max(largest))
    }
}

/// The machine through places, there and back: by a controller with what it knows, if it compensates, and by drives that
/// move in steps, if they do.
fn misses(places: &[[f64; 3]], known: Option<&Calibration>, step: Option<f64>) -> Misses {
    let (bench, calibration) = bench();
    let (wanted, count) = there_and_back(places);
    let sent = known.map_or_else(|| wanted.clone(), |known| bench.compensated(known, &wanted).0);
    let sent = step.map_or(sent.clone(), |step| in_steps(&sent, step));
    Misses::of(&bench.plant(&calibration), &wanted, &sent, count)
}

/// The diagonal in steps of a fiftieth.
fn diagonal() -> Vec<[f64; 3]> {
    let [from, to] = [POINTS[0], POINTS[6]];
    (0..=50)
        .map(|step| std::array::from_fn(|axis| from[axis] + (to[axis] - from[axis]) * f64::from(step) / 50.0))
        .collect()
}

#[track_caller]
fn about(found: f64, page: f64) {
    assert!((found - page).abs() <= 0.051, "{found} is not {page}");
}

/// Arcseconds times mm in um.
const ARCSEC: f64 = 4.848_137e-3;

/// The last point by hand: entries of table 1 between 495 and 550 mm of X, 252 and 280 mm of Y, -44 and -55 mm of Z, with
/// the tip 120 mm below the head and 70 mm above the table's zero.
fn last_by_hand(back: bool) -> [f64; 3] {
    let between = |from: f64, to: f64, share: f64| from + (to - from) * share;
    let x = |from, to| between(from, to, 25.0 / 55.0);
    let y = |from, to| between(from, to, 8.0 / 28.0);
    let z = |from, to| between(from, to, 6.0 / 11.0);
    let (pitch_x, yaw_x, roll_x) = (x(32.5, 37.0), x(8.0, 7.5), x(7.4, 7.7));
    let (pitch_y, yaw_y, roll_y) = (y(7.0, 7.0), y(8.5, 8.5), y(12.4, 13.6));
    let (pitch_z, yaw_z) = (z(4.0, 3.0), z(-2.5, -1.5));
    let play = if back { 5.0 } else { -5.0 };
    [
        x(63.0, 70.0)
            + y(0.2, -0.3)
            + z(1.0, 0.4)
            + ARCSEC * (70.0 * (pitch_x + roll_y) - 260.0 * (yaw_x + yaw_y) + 120.0 * yaw_z)
            - 260.0 * 0.272,
        x(3.0, 3.5)
            + y(5.3, 5.3)
            + play
            + z(3.3, 1.8)
            + ARCSEC * (520.0 * yaw_x - 70.0 * (roll_x + pitch_y) - 120.0 * pitch_z),
        x(0.6, 1.3)
            + y(1.0, 2.8)
            + z(2.0, -1.5)
            + ARCSEC * (260.0 * (roll_x + pitch_y) - 520.0 * pitch_x)
            + 520.0 * 0.0295
            + 260.0 * 0.065_38,
    ]
}

#[test]
fn the_last_point_is_off_as_the_table_says_by_hand() {
    let found = misses(&POINTS, None, None);
    for (row, back) in [(6, false), (7, true)] {
        for (error, by_hand) in found.error[row].iter().zip(last_by_hand(back)) {
            // What is of second order: some 4e-4 rad of all rotations times some 0.09 mm of all displacements.
            assert!((1e3 * error - by_hand).abs() < 0.04, "{error} mm, {by_hand} um by hand");
        }
    }
}

/// "Over +-40 um": the distance from the target at the far end. What a laser along the diagonal reads is less.
#[test]
fn without_compensation_the_far_end_is_forty_micrometres_off() {
    for places in [POINTS.to_vec(), diagonal()] {
        let found = misses(&places, None, None);
        let distances = found.distances();
        about(distances[found.count - 1], 39.8);
        about(distances[found.count], 45.4);
        about(found.largest(), 45.4);
        about(found.largest_along(), 11.5);
    }
}

#[test]
fn compensation_leaves_only_the_second_order() {
    let (_, calibration) = bench();
    for places in [POINTS.to_vec(), diagonal()] {
        let found = misses(&places, Some(&calibration), None);
        assert!(found.largest() < 0.04, "{}", found.largest());
    }
}

/// What stands between 0.02 um and the paper's +-10 um: the machine's steps of 5 um, and a play that a table without
/// directions does not correct. Each leaves what it must, and both together stay below 10 um.
#[test]
fn steps_and_play_make_the_published_ten_micrometres() {
    let (_, calibration) = bench();
    let table = without_play(&calibration);
    let second_order = 0.04;
    let half = 1e3 * RESOLUTION / 2.0;
    let rows = [(POINTS.to_vec(), 3.1, 5.0, 7.1), (diagonal(), 3.8, 5.0, 7.9)];
    for (places, steps, play, both) in rows {
        let found = misses(&places, Some(&calibration), Some(RESOLUTION)).largest();
        about(found, steps);
        assert!(found <= 3.0_f64.sqrt() * half + second_order, "{found}");
        let found = misses(&places, Some(&table), None).largest();
        about(found, play);
        let found = misses(&places, Some(&table), Some(RESOLUTION)).largest();
        about(found, both);
        assert!(found <= (2.0 * half * half + (5.0 + half).powi(2)).sqrt() + second_order, "{found}");
        assert!(found < 10.0);
    }
}

/// What is assumed moves the figure: the tool's length by little, the sign of the squareness by so much that it is decided.
#[test]
fn the_forty_micrometres_bear_the_assumptions() {
    let bench = Bench::of("machines/postech-mill.yaml");
    let text = std::fs::read_to_string(root().join("calibrations/postech-mill.yaml")).unwrap();
    let (wanted, count) = there_and_back(&POINTS);
    let far = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let plant = bench.plant(&bench.calibration(&text.replace(from, to)));
        Misses::of(&plant, &wanted, &wanted, count).distances()[count - 1]
    };
    about(far("Zt: 120 mm", "Zt: 60 mm"), 47.2);
    about(far("Zt: 120 mm", "Zt: 200 mm"), 36.8);
    about(far("EC0Y: 272 urad", "EC0Y: -272 urad"), 137.6);
    about(far("EC0Y: 272 urad", "EC0Y: 272 arcsec"), 284.2);
    // The step of the printed points ends at 500 mm; the paper prints 520.
    let mut points = POINTS;
    points[6][0] = 500.0;
    about(misses(&points, None, None).distances()[6], 35.4);
}
