//! How many rows a second: one sample after the other, and in batches.
//!
//! In: shipped machines whose every error motion has a measured table, and random positions. Out: for each machine the
//! rows compensated in a second either way, on one core, after both have given the same bits; and what share of the memory's
//! bandwidth, as a copy has it, the slices of the batch take up.
//!
//! `cargo run --release -p abbe-generated --example batch [MACHINE [alone|batch]]`: with both words that one way is gone
//! once and nothing is timed, for a profiler.
#![expect(clippy::print_stdout, clippy::expect_used, reason = "a program to be read at a terminal")]

use std::hint::black_box;
use std::time::{Duration, Instant};

use abbe_generated::{excello_921, head_table_5axis, xyfz_mill};
use abbe_runtime::{
    Batch, BatchWork, Compensator, Direction, ErrorMotion, Kinematics, Lanes, Outcome, Refusal, Sample,
    Table, Term, TermState, Values, Work,
};

/// Rows in a batch: more than fit into a second-level cache.
const ROWS: usize = 100_000;

/// Nodes of a table.
const NODES: usize = 21;

/// What is given out: the commands of each axis, and an answer for each row.
type Given = (Vec<Vec<f64>>, Vec<Result<Outcome, Refusal>>);

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let wanted = |name: &str| words.first().is_none_or(|word| word == name);
    let way = words.get(1).map(String::as_str);
    if wanted("excello-921") {
        let constants = excello_921::Constants::from_array([100.0, -700.0, 150.0, 80.0, -120.0]);
        run("excello-921", &excello_921::Machine { constants }, way);
    }
    if wanted("xyfz-mill") {
        let constants = xyfz_mill::Constants::from_array([0.0, 20.0, -150.0]);
        run("xyfz-mill", &xyfz_mill::Machine { constants }, way);
    }
    if wanted("head-table-5axis") {
        run("head-table-5axis", &head_table_5axis::Machine::default(), way);
    }
}

/// Goes one way once, or compares both.
fn run<K: Kinematics>(name: &str, machine: &K, way: Option<&str>) {
    let rows = Rows::new(machine.axes());
    let curves = rows.curves(machine.motions());
    let terms: Vec<[Term<'_>; 1]> = curves
        .iter()
        .enumerate()
        .map(|(motion, [forward, reverse])| {
            let values = Values::Directed { forward, reverse };
            let table = Table::uniform(-300.0, 30.0, values).expect("the table is complete");
            // Six motions of each axis, as the machines have them; then those of alignment.
            [Term::Table { axis: motion / 6 % machine.axes(), table }]
        })
        .collect();
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let mut states = vec![TermState::default(); terms.len()];
    let (mut directions, mut values) = (vec![[0.0; 3]; machine.axes()], vec![0.0; motions.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let mut compensator = Compensator::new(machine, &motions, &mut states, work).expect("all is in order");
    let mut given = rows.nothing();
    match way {
        Some("alone") => rows.alone(&mut compensator, &mut given),
        Some(_) => rows.batch(&mut compensator, &mut given),
        None => rows.compare(name, &mut compensator),
    }
    black_box(&given);
}

/// The rows that are compensated: a vector for each axis.
struct Rows {
    position: Vec<Vec<f64>>,
    direction: Vec<Vec<Direction>>,
    time_step: Vec<f64>,
}

impl Rows {
    /// Random rows, the same in every run.
    fn new(axes: usize) -> Self {
        let mut draw = drawing(1);
        // The rotary axes of the machine that has them come last.
        let range = |axis: usize| if axis < 3 { 300.0 } else { 3.0 };
        Self {
            position: (0..axes)
                .map(|axis| (0..ROWS).map(|_| range(axis) * (2.0 * draw() - 1.0)).collect())
                .collect(),
            direction: (0..axes)
                .map(|_| {
                    let mut turn = || if draw() < 0.5 { Direction::Positive } else { Direction::Negative };
                    (0..ROWS).map(|_| turn()).collect()
                })
                .collect(),
            time_step: vec![0.001; ROWS],
        }
    }

    /// For each error motion a curve of up to 5 nm or 5 urad for either direction.
    fn curves(&self, motions: usize) -> Vec<[[f64; NODES]; 2]> {
        let mut draw = drawing(2);
        let mut curve = || std::array::from_fn(|_| 10e-6 * (draw() - 0.5));
        (0..motions).map(|_| [curve(), curve()]).collect()
    }

    fn nothing(&self) -> Given {
        (vec![vec![0.0; ROWS]; self.position.len()], vec![Ok(Outcome::default()); ROWS])
    }

    /// Says what both ways take, the faster of several times each, in turns.
    fn compare<K: Kinematics>(&self, name: &str, compensator: &mut Compensator<'_, K>) {
        let (mut alone, mut batch) = (self.nothing(), self.nothing());
        let (mut shortest_alone, mut shortest_batch) = (Duration::MAX, Duration::MAX);
        for _ in 0..15 {
            let start = Instant::now();
            self.alone(compensator, &mut alone);
            shortest_alone = shortest_alone.min(start.elapsed());
            let start = Instant::now();
            self.batch(compensator, &mut batch);
            shortest_batch = shortest_batch.min(start.elapsed());
        }
        assert!(alone == batch, "{name}: a batch is not its rows");
        let rate = |time: Duration| ROWS as f64 / time.as_secs_f64();
        let moved = rate(shortest_batch) * self.bytes_of_a_row() as f64;
        println!(
            "{name:18} alone {:7.3} million rows/s, batch {:7.3} million rows/s, {:5.2} times; {:5.2} GB/s, {:4.1} % of a copy's",
            rate(shortest_alone) * 1e-6,
            rate(shortest_batch) * 1e-6,
            shortest_alone.as_secs_f64() / shortest_batch.as_secs_f64(),
            moved * 1e-9,
            100.0 * moved / bandwidth(),
        );
    }

    /// What the slices of a batch hold of one row: what is read of it, and what is answered.
    fn bytes_of_a_row(&self) -> usize {
        let axis = size_of::<f64>() * 2 + size_of::<Direction>();
        self.position.len() * axis + size_of::<f64>() + size_of::<Result<Outcome, Refusal>>()
    }

    /// One sample after the other.
    fn alone<K: Kinematics>(&self, compensator: &mut Compensator<'_, K>, (out, answers): &mut Given) {
        let axes = self.position.len();
        let (mut position, mut command) = (vec![0.0; axes], vec![0.0; axes]);
        let mut direction = vec![Direction::Positive; axes];
        for (row, answer) in answers.iter_mut().enumerate() {
            for axis in 0..axes {
                position[axis] = self.position[axis][row];
                direction[axis] = self.direction[axis][row];
            }
            let sample = Sample {
                position: &position,
                travel: &[],
                direction: &direction,
                velocity: &[],
                temperature: &[],
                time_step: self.time_step[row],
            };
            *answer = compensator.compensate(black_box(&sample), &mut command);
            out.iter_mut().zip(&command).for_each(|(out, command)| out[row] = *command);
        }
    }

    /// All rows at once.
    fn batch<K: Kinematics>(&self, compensator: &mut Compensator<'_, K>, (out, answers): &mut Given) {
        let sizes = compensator.batch_sizes();
        let (mut lanes, mut numbers) = (vec![Lanes::default(); sizes.lanes], vec![0.0; sizes.numbers]);
        let mut directions = vec![Direction::Positive; sizes.directions];
        let work = BatchWork { lanes: &mut lanes, numbers: &mut numbers, directions: &mut directions };
        let batch = Batch {
            position: &self.position.iter().map(Vec::as_slice).collect::<Vec<_>>(),
            travel: &[],
            direction: &self.direction.iter().map(Vec::as_slice).collect::<Vec<_>>(),
            velocity: &[],
            temperature: &[],
            time_step: &self.time_step,
        };
        let mut out: Vec<_> = out.iter_mut().map(Vec::as_mut_slice).collect();
        compensator
            .compensate_batch(black_box(&batch), work, &mut out, answers)
            .expect("all slices have the same length");
    }
}

/// Bytes read and written in a second by a copy of more than the caches hold: the fastest of several.
fn bandwidth() -> f64 {
    let from = vec![1.0_f64; 1 << 24];
    let mut to = vec![0.0_f64; from.len()];
    let mut shortest = Duration::MAX;
    for _ in 0..5 {
        let start = Instant::now();
        to.copy_from_slice(black_box(&from));
        black_box(&mut to);
        shortest = shortest.min(start.elapsed());
    }
    2.0 * size_of_val(from.as_slice()) as f64 / shortest.as_secs_f64()
}

/// Random numbers from 0 to 1.
fn drawing(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}
