//! Batches: many samples at once answer what each of them would alone.
//!
//! In: random calibrations, and rows that are fit to be compensated or not. Out: the bits of the same rows, one after the
//! other.

use abbe_runtime::{
    Batch, BatchWork, Compensator, Convergence, Direction, ErrorMotion, Factor, Input, Kinematics, Lanes,
    Limits, Outcome, Real, Refusal, Sample, Table, Term, TermState, Values, Within,
};
use proptest::prelude::*;

use crate::common::{Lathe, Slide, Swivel, TableMill, at, with};

/// Rows as a caller has them: a vector for each quantity.
#[derive(Clone, Debug, Default)]
struct Rows {
    position: Vec<Vec<f64>>,
    travel: Vec<Vec<f64>>,
    direction: Vec<Vec<Direction>>,
    velocity: Vec<Vec<f64>>,
    temperature: Vec<Vec<f64>>,
    time_step: Vec<f64>,
}

/// What is written and answered, in words that show every bit but those of NaN.
#[derive(PartialEq, Debug)]
struct Told {
    out: Vec<Vec<u64>>,
    answers: Vec<String>,
    states: String,
}

fn slices<T>(columns: &[Vec<T>], rows: std::ops::Range<usize>) -> Vec<&[T]> {
    columns.iter().map(|column| &column[rows.clone()]).collect()
}

fn row<T: Copy>(columns: &[Vec<T>], row: usize) -> Vec<T> {
    columns.iter().map(|column| column[row]).collect()
}

/// A batch in fresh storage.
fn batch<K: Kinematics>(
    compensator: &mut Compensator<'_, K>,
    rows: &Rows,
    range: std::ops::Range<usize>,
    out: &mut [&mut [f64]],
) -> Result<Vec<Result<Outcome, Refusal>>, Refusal> {
    let sizes = compensator.batch_sizes();
    let mut lanes = vec![Lanes::from(f64::NAN); sizes.lanes];
    let mut numbers = vec![f64::NAN; sizes.numbers];
    let mut directions = vec![Direction::Negative; sizes.directions];
    let work = BatchWork { lanes: &mut lanes, numbers: &mut numbers, directions: &mut directions };
    let mut answers = vec![Err(Refusal::NotFinite); range.len()];
    let samples = Batch {
        position: &slices(&rows.position, range.clone()),
        travel: &slices(&rows.travel, range.clone()),
        direction: &slices(&rows.direction, range.clone()),
        velocity: &slices(&rows.velocity, range.clone()),
        temperature: &slices(&rows.temperature, range.clone()),
        time_step: &rows.time_step[range],
    };
    compensator.compensate_batch(&samples, work, out, &mut answers)?;
    Ok(answers)
}

/// How a compensator is set.
#[derive(Clone, Copy, Debug)]
struct Setting {
    enabled: bool,
    limits: Limits,
    convergence: Convergence,
}

impl Default for Setting {
    fn default() -> Self {
        Self { enabled: true, limits: Limits::default(), convergence: Convergence::default() }
    }
}

impl Setting {
    fn give<K: Kinematics>(self, compensator: &mut Compensator<'_, K>) {
        compensator.enabled = self.enabled;
        compensator.limits = self.limits;
        compensator.convergence = self.convergence;
    }
}

/// All rows in two batches, cut where it may be.
fn together<K: Kinematics>(
    machine: &K,
    motions: &[ErrorMotion<'_>],
    setting: Setting,
    rows: &Rows,
    cut: usize,
) -> Told {
    let count = rows.time_step.len();
    let cut = cut.min(count);
    let mut out = vec![vec![0.5; count]; machine.axes()];
    let (answers, states) = with(machine, motions, |compensator| {
        setting.give(compensator);
        let (mut before, mut after): (Vec<_>, Vec<_>) =
            out.iter_mut().map(|column| column.split_at_mut(cut)).unzip();
        let mut answers = batch(compensator, rows, 0..cut, &mut before).unwrap();
        answers.extend(batch(compensator, rows, cut..count, &mut after).unwrap());
        answers
    });
    told(&out, &answers, &states)
}

/// All rows one after the other.
fn alone<K: Kinematics>(machine: &K, motions: &[ErrorMotion<'_>], setting: Setting, rows: &Rows) -> Told {
    let count = rows.time_step.len();
    let mut out = vec![vec![0.5; count]; machine.axes()];
    let (answers, states) = with(machine, motions, |compensator| {
        setting.give(compensator);
        let answer = |number: usize| {
            let mut command = vec![0.25; machine.axes()];
            let sample = Sample {
                position: &row(&rows.position, number),
                travel: &row(&rows.travel, number),
                direction: &row(&rows.direction, number),
                velocity: &row(&rows.velocity, number),
                temperature: &row(&rows.temperature, number),
                time_step: rows.time_step[number],
            };
            let answer = compensator.compensate(&sample, &mut command);
            out.iter_mut().zip(command).for_each(|(out, command)| out[number] = command);
            answer
        };
        (0..count).map(answer).collect::<Vec<_>>()
    });
    told(&out, &answers, &states)
}

fn told(out: &[Vec<f64>], answers: &[Result<Outcome, Refusal>], states: &[TermState]) -> Told {
    Told {
        out: out.iter().map(|column| column.iter().map(|number| number.to_bits()).collect()).collect(),
        // `{:?}` writes a number with as many digits as tell it from its neighbours.
        answers: answers.iter().map(|answer| format!("{answer:?}")).collect(),
        states: format!("{states:?}"),
    }
}

/// A machine without lanes of its own.
struct Plain<K>(K);

impl<K: Kinematics> Kinematics for Plain<K> {
    fn axes(&self) -> usize {
        self.0.axes()
    }
    fn travels(&self) -> &[usize] {
        self.0.travels()
    }
    fn motions(&self) -> usize {
        self.0.motions()
    }
    fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        self.0.error(position, travel, motions)
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        self.0.directions(position, directions);
    }
}

/// A machine whose directions are the same everywhere, and are known when the code is compiled or not.
struct Steady<K>(K, Option<&'static [[f64; 3]]>);

impl<K: Kinematics> Kinematics for Steady<K> {
    fn axes(&self) -> usize {
        self.0.axes()
    }
    fn travels(&self) -> &[usize] {
        self.0.travels()
    }
    fn motions(&self) -> usize {
        self.0.motions()
    }
    fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        self.0.error(position, travel, motions)
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        self.0.directions(position, directions);
    }
    fn directions_vary(&self) -> bool {
        false
    }
    fn fixed_directions(&self) -> Option<&'static [[f64; 3]]> {
        self.1
    }
}

/// The numbers from which a term is made.
#[derive(Clone, Debug)]
struct Plan {
    kind: u8,
    axis: usize,
    numbers: [f64; 6],
    time: f64,
}

impl Plan {
    /// A term of an error motion in mm or, with `scale` small, in rad. Axes are counted round the machine's.
    fn term(&self, axes: usize, ramps: bool) -> Term<'_> {
        let axis = self.axis % axes;
        let [a, b, ..] = self.numbers;
        let curves = Values::Directed { forward: &self.numbers[..4], reverse: &self.numbers[2..] };
        match self.kind {
            0 => Term::Constant { value: a },
            1 => Term::Polynomial { input: Input::Axis(axis), coefficients: &self.numbers[..self.axis] },
            2 => Term::Polynomial { input: Input::Sensor(0), coefficients: &self.numbers[..2] },
            3 => Term::Coupling { axis, coefficients: &self.numbers[..1] },
            4 => Term::Table { axis, table: Table::uniform(-150.0, 100.0, curves).unwrap() },
            5 => Term::Table {
                axis,
                table: Table::uniform(200.0, -75.0, Values::Both(&self.numbers[..1])).unwrap(),
            },
            6 => Term::Table { axis, table: Table::at(&[-100.0, -0.0, 50.0, 275.5], curves).unwrap() },
            7 => Term::Backlash { axis, lost_motion: a, wind_up: 0.0, ramp: 0.0 },
            8 => Term::Backlash { axis, lost_motion: a, wind_up: 200.0 * self.time, ramp: 0.0 },
            9 => Term::Cyclic { axis, period: 7.5, amplitude: a, phase: 100.0 * b },
            10 => Term::Expansion { axis, sensor: 1, coefficient: 1e-3 * a, reference: 20.0 },
            11 => Term::Growth { sensor: 0, coefficient: 0.1 * a, reference: 20.0, time_constant: 0.0 },
            12 => Term::Growth { sensor: 1, coefficient: 0.1 * a, reference: 20.0, time_constant: self.time },
            13 if ramps => Term::Backlash { axis, lost_motion: a, wind_up: 0.0, ramp: self.time },
            14..24 => Term::Factor(self.factor(axis)),
            _ => Term::Lag { axis, gain: 1000.0 },
        }
    }
}

impl Plan {
    /// A factor, not far above 1, so that commands are found.
    fn factor(&self, axis: usize) -> Factor<'_> {
        let [a, b, ..] = self.numbers;
        let within = Within { from: -1.0, to: 1.0 };
        match self.kind {
            14 => Factor::Position { axis, power: 1, within },
            15 => Factor::Position { axis, power: 3, within },
            16 => Factor::Direction { axis },
            17 => Factor::Velocity { axis, within },
            18 => Factor::Speed { axis, within: Within { from: 0.0, to: 1.0 } },
            19 => Factor::Fading { axis, over: 2.0 },
            20 => {
                let time_constant = if a < 0.0 { 0.0 } else { self.time };
                Factor::Temperature {
                    sensor: 1,
                    reference: 20.0,
                    time_constant,
                    within: Within { from: 19.5, to: 21.0 },
                }
            }
            21 => Factor::Play { sensor: 0, reference: 20.0, width: self.time },
            22 => Factor::Warmth { axis, time_constant: self.time, rise: 0.1 },
            _ => Factor::Turn { axis, period: 30.0, phase: 100.0 * b },
        }
    }
}

fn plan() -> impl Strategy<Value = Plan> {
    let numbers = prop::array::uniform6(-0.01..0.01_f64);
    (0..25_u8, 0..4_usize, numbers, 0.01..1.0_f64).prop_map(|(kind, axis, numbers, time)| Plan {
        kind,
        axis,
        numbers,
        time,
    })
}

/// Up to three terms for each of so many error motions.
fn plans(motions: usize) -> impl Strategy<Value = Vec<Vec<Plan>>> {
    prop::collection::vec(prop::collection::vec(plan(), 0..3), motions)
}

/// A number of a range, or one of its edges, or seldom one that no sample may hold.
fn number(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    let edges = prop::sample::select(vec![-150.0, -50.0, 50.0, 200.0, 0.0, -0.0]);
    let bad = prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0]);
    prop_oneof![150 => range, 20 => edges, 1 => bad]
}

fn columns(count: usize, rows: usize, range: std::ops::Range<f64>) -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(number(range), rows), count)
}

/// Rows of a machine with so many axes and travels; travels are given in every other case.
fn rows(axes: usize, travels: usize) -> impl Strategy<Value = Rows> {
    (0..35_usize, any::<bool>()).prop_flat_map(move |(count, given)| {
        let direction =
            any::<bool>().prop_map(|up| if up { Direction::Positive } else { Direction::Negative });
        (
            columns(axes, count, -300.0..300.0),
            columns(if given { travels } else { 0 }, count, -300.0..300.0),
            prop::collection::vec(prop::collection::vec(direction, count), axes),
            columns(axes, count, -5.0..5.0),
            columns(3, count, 10.0..40.0),
            prop::collection::vec(number(0.0..0.1), count),
        )
            .prop_map(|(position, travel, direction, velocity, temperature, time_step)| Rows {
                position,
                travel,
                direction,
                velocity,
                temperature,
                time_step,
            })
    })
}

fn setting() -> impl Strategy<Value = Setting> {
    let limit = prop::option::of(prop_oneof![0.0..0.2_f64, Just(f64::NAN)]);
    let steps = prop_oneof![3 => Just(20), 1 => 0..4_u32];
    (prop::bool::weighted(0.9), limit, steps).prop_map(|(enabled, compensation, iterations)| Setting {
        enabled,
        limits: Limits { compensation, ..Limits::default() },
        convergence: Convergence { iterations, ..Convergence::default() },
    })
}

/// Terms of which no factor is the last one.
fn closed(mut terms: Vec<Term<'_>>) -> Vec<Term<'_>> {
    if matches!(terms.last(), Some(Term::Factor(_))) {
        terms.push(Term::Constant { value: 0.003 });
    }
    terms
}

/// Hands the terms of plans to a test as error motions.
fn planned<R>(
    plans: &[Vec<Plan>],
    axes: usize,
    ramps: bool,
    test: impl FnOnce(&[ErrorMotion<'_>]) -> R,
) -> R {
    let terms: Vec<Vec<Term<'_>>> = plans
        .iter()
        .map(|plans| plans.iter().map(|plan| plan.term(axes, ramps)).collect())
        .map(closed)
        .collect();
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    test(&motions)
}

proptest! {
    #[test]
    fn a_mill_in_lanes(
        tool in prop::array::uniform3(-1.0..1.0_f64), plans in plans(9), rows in rows(4, 0), setting in setting(),
        cut in 0..35_usize, ramps in prop::bool::weighted(0.2),
    ) {
        let machine = TableMill { tool };
        planned(&plans, 4, ramps, |motions| {
            prop_assert_eq!(together(&machine, motions, setting, &rows, cut), alone(&machine, motions, setting, &rows));
            Ok(())
        })?;
    }

    #[test]
    fn machines_that_answer_row_by_row(
        tool in prop::array::uniform2(-1.0..1.0_f64), plans in plans(4), rows in rows(2, 1), setting in setting(),
        cut in 0..35_usize, ramps in prop::bool::weighted(0.2),
    ) {
        let machine = Plain(Lathe { tool });
        planned(&plans, 2, ramps, |motions| {
            prop_assert_eq!(together(&machine, motions, setting, &rows, cut), alone(&machine, motions, setting, &rows));
            Ok(())
        })?;
    }

    #[test]
    fn directions_that_stay_the_same_give_the_same_commands(
        tool in prop::array::uniform2(-1.0..1.0_f64), plans in plans(4), rows in rows(2, 1), setting in setting(),
        cut in 0..35_usize, ramps in prop::bool::weighted(0.2),
    ) {
        let machines = [Some(Lathe::DIRECTIONS), None].map(|known| Steady(Lathe { tool }, known));
        planned(&plans, 2, ramps, |motions| {
            let [of_known, of_found] = machines.each_ref().map(|machine| alone(machine, motions, setting, &rows));
            for (machine, told) in machines.iter().zip([&of_known, &of_found]) {
                prop_assert_eq!(&together(machine, motions, setting, &rows, cut), told);
            }
            prop_assert_eq!(&alone(&Plain(Lathe { tool }), motions, setting, &rows), &of_found);
            // The sign of a zero is nothing that a drive could tell.
            let numbers = |told: &Told| -> Vec<f64> { told.out.iter().flatten().copied().map(f64::from_bits).collect() };
            let alike = |(a, b): (f64, f64)| a == b || (a.is_nan() && b.is_nan());
            prop_assert!(numbers(&of_known).into_iter().zip(numbers(&of_found)).all(alike));
            let plain = |answers: &[String]| answers.join(" ").replace("-0.0", "0.0");
            prop_assert_eq!(plain(&of_known.answers), plain(&of_found.answers));
            Ok(())
        })?;
    }

    #[test]
    fn lanes_do_what_numbers_do(
        a in prop::array::uniform8(any::<f64>()), b in prop::array::uniform8(any::<f64>()),
    ) {
        let (x, y) = (Lanes::new(a), Lanes::new(b));
        let same = |lanes: Lanes, of: fn(f64, f64) -> f64| (0..Lanes::WIDTH).all(|lane| {
            let (found, expected) = (lanes.lane(lane), of(a[lane], b[lane]));
            found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan()
        });
        prop_assert_eq!(Lanes::from_fn(|lane| a[lane]).numbers().map(f64::to_bits), a.map(f64::to_bits));
        prop_assert!(same(x + y, |a, b| a + b));
        prop_assert!(same(x - y, |a, b| a - b));
        prop_assert!(same(x * y, |a, b| a * b));
        prop_assert!(same(x / y, |a, b| a / b));
        prop_assert!(same(-x, |a, _| -a));
        prop_assert!(same(Real::sqrt(x), |a, _| a.sqrt()));
        prop_assert!(same(x.sin_cos().0, |a, _| abbe_runtime::math::sin_cos(a).0));
        prop_assert!(same(x.sin_cos().1, |a, _| abbe_runtime::math::sin_cos(a).1));
    }
}

/// Rows on both sides of a singular pose, in it, and far from it.
#[test]
fn rows_near_a_singular_pose_are_refused_as_each_alone() {
    let term = [Term::Constant { value: 0.01 }];
    let motions = [ErrorMotion { terms: &term }];
    let quarter = std::f64::consts::FRAC_PI_2;
    let angles =
        vec![0.0, 1.0, quarter - 0.0141, quarter - 0.0142, quarter, quarter + 1e-3, quarter + 0.1, 3.0, -1.0];
    let rows = Rows {
        direction: vec![vec![Direction::Positive; 9]; 3],
        position: vec![vec![100.0; 9], angles.clone(), vec![10.0; 9]],
        time_step: vec![0.001; 9],
        ..Rows::default()
    };
    let mut out = vec![vec![0.0; 9]; 3];
    let mut columns: Vec<&mut [f64]> = out.iter_mut().map(Vec::as_mut_slice).collect();
    let (answers, _) =
        with(&Swivel, &motions, |compensator| batch(compensator, &rows, 0..9, &mut columns).unwrap());
    let refused: Vec<usize> =
        (0..9).filter(|row| matches!(answers[*row], Err(Refusal::NearSingular { .. }))).collect();
    assert_eq!(refused, [2, 5]);
    for (number, answer) in answers.iter().enumerate() {
        let mut alone = [0.0; 3];
        let position = row(&rows.position, number);
        let (expected, _) =
            with(&Swivel, &motions, |compensator| compensator.compensate(&at(&position), &mut alone));
        assert_eq!(*answer, expected);
        assert_eq!(row(&out, number), alone, "row {number}");
    }
}

/// A slide whose rows end in every way there is, each of them among rows that end otherwise.
#[test]
fn each_row_is_refused_for_its_own_reason() {
    // 0.01 of scale up to 100 mm, and ten times the travel beyond: no search settles there.
    let table = Table::at(&[0.0, 100.0, 200.0], Values::Both(&[0.0, 1.0, 1001.0])).unwrap();
    let exx = [Term::Table { axis: 0, table }];
    let motions = [ErrorMotion { terms: &exx }];
    let position = vec![50.0, f64::NAN, 10.0, 150.0, 99.0, 0.0, 20.0, f64::INFINITY, -5.0, 30.0];
    let mut time_step = vec![0.001; 10];
    time_step[2] = -0.5;
    let rows = Rows {
        direction: vec![vec![Direction::Positive; 10]],
        position: vec![position.clone()],
        time_step,
        ..Rows::default()
    };
    let mut out = vec![0.0; 10];
    let (answers, _) = with(&Slide, &motions, |compensator| {
        compensator.limits = Limits { compensation: Some(0.9), ..Limits::default() };
        batch(compensator, &rows, 0..10, &mut [&mut out]).unwrap()
    });
    assert_eq!(answers[1], Err(Refusal::NotFinite));
    assert_eq!(answers[2], Err(Refusal::NegativeTimeStep { time_step: -0.5 }));
    assert!(matches!(answers[3], Err(Refusal::NotConverging { iterations: 20, .. })), "{:?}", answers[3]);
    assert!(matches!(answers[4], Err(Refusal::OverLimit { limit: 0.9, .. })), "{:?}", answers[4]);
    assert_eq!(answers[7], Err(Refusal::NotFinite));
    for (row, answer) in answers.iter().enumerate() {
        match answer {
            // c + 0.01 c = target above 0, and no error below.
            Ok(_) => assert!(
                (out[row] - position[row] / if position[row] > 0.0 { 1.01 } else { 1.0 }).abs() < 1e-9
            ),
            Err(_) => assert_eq!(out[row].to_bits(), position[row].to_bits(), "row {row}"),
        }
    }
    assert_eq!(answers.iter().filter(|answer| answer.is_ok()).count(), 5);
}

#[test]
fn rows_that_are_refused_tell_nothing_of_those_after_them() {
    let exx = [Term::Constant { value: 0.25 }];
    let motions =
        [ErrorMotion { terms: &exx }, ErrorMotion::default(), ErrorMotion::default(), ErrorMotion::default()];
    let machine = Steady(Lathe { tool: [0.0; 2] }, None);
    let (bad, count) = (Lanes::WIDTH, Lanes::WIDTH + 3);
    let position = (0..count).map(|row| if row < bad { f64::NAN } else { 5.0 }).collect();
    let rows = Rows {
        position: vec![position, vec![7.0; count]],
        direction: vec![vec![Direction::Positive; count]; 2],
        time_step: vec![0.0; count],
        ..Rows::default()
    };
    let told = together(&machine, &motions, Setting::default(), &rows, 0);
    assert_eq!(told, alone(&machine, &motions, Setting::default(), &rows));
    assert_eq!(told.out[0][bad..], [4.75_f64.to_bits(); 3]);
}

/// A slide along X beside which, wherever it is not at 5, the tip is said to be infinitely far in Y.
struct Lost;

impl Kinematics for Lost {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        1
    }
    fn error(&self, position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        [motions[0], if position == [5.0] { 0.0 } else { f64::INFINITY }, 0.0]
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        Slide.directions(position, directions);
    }
}

#[test]
fn an_error_without_bounds_is_refused_where_no_axis_reaches_it() {
    let exx = [Term::Constant { value: 0.25 }];
    let motions = [ErrorMotion { terms: &exx }];
    let rows = Rows {
        position: vec![vec![5.0; 3]],
        direction: vec![vec![Direction::Positive; 3]],
        time_step: vec![0.0; 3],
        ..Rows::default()
    };
    let setting = Setting::default();
    let known = Steady(Lost, Some(&[[1.0, 0.0, 0.0]]));
    for told in [
        alone(&Lost, &motions, setting, &rows),
        alone(&known, &motions, setting, &rows),
        together(&known, &motions, setting, &rows, 0),
    ] {
        assert_eq!(told.out, [[5.0_f64.to_bits(); 3]]);
        assert!(told.answers.iter().all(|answer| answer.starts_with("Err(NotConverging")), "{told:?}");
    }
}

#[test]
fn slices_of_a_wrong_length_are_refused_and_nothing_is_written() {
    let growth = [Term::Growth { sensor: 0, coefficient: 1.0, reference: 20.0, time_constant: 0.0 }];
    let motions = [ErrorMotion { terms: &growth }];
    let good = Rows {
        position: vec![vec![1.0; 3]],
        direction: vec![vec![Direction::Positive; 3]],
        temperature: vec![vec![20.0; 3]],
        time_step: vec![0.0; 3],
        ..Rows::default()
    };
    let told = |rows: &Rows, out: &mut [&mut [f64]]| {
        let sizes = with(&Slide, &motions, |compensator| compensator.batch_sizes()).0;
        let mut lanes = vec![Lanes::default(); sizes.lanes];
        let mut numbers = vec![0.0; sizes.numbers];
        let mut directions = vec![Direction::Positive; sizes.directions];
        let work = BatchWork { lanes: &mut lanes, numbers: &mut numbers, directions: &mut directions };
        let all = Batch {
            position: &slices(&rows.position, 0..rows.position[0].len()),
            travel: &slices(&rows.travel, 0..3),
            direction: &slices(&rows.direction, 0..rows.direction[0].len()),
            velocity: &slices(&rows.velocity, 0..3),
            temperature: &slices(&rows.temperature, 0..3),
            time_step: &rows.time_step,
        };
        let mut answers = [Err(Refusal::NotFinite); 3];
        with(&Slide, &motions, |compensator| compensator.compensate_batch(&all, work, out, &mut answers)).0
    };
    let refused = |slice, expected, found| Err(Refusal::Length { slice, expected, found });
    let mut out = [7.0; 3];
    let short = Rows { position: vec![vec![1.0; 2]], ..good.clone() };
    assert_eq!(told(&short, &mut [&mut out]), refused("position", 3, 2));
    let short = Rows { direction: vec![vec![Direction::Positive; 4]], ..good.clone() };
    assert_eq!(told(&short, &mut [&mut out]), refused("direction", 3, 4));
    let short = Rows { time_step: vec![0.0; 1], ..good.clone() };
    assert_eq!(told(&short, &mut [&mut out]), refused("time_step", 3, 1));
    let none = Rows { temperature: vec![], ..good.clone() };
    assert_eq!(told(&none, &mut [&mut out]), refused("temperature", 1, 0));
    let more = Rows { velocity: vec![vec![0.0; 3]; 2], ..good.clone() };
    assert_eq!(told(&more, &mut [&mut out]), refused("velocity", 1, 2));
    let more = Rows { travel: vec![vec![0.0; 3]], ..good.clone() };
    assert_eq!(told(&more, &mut [&mut out]), refused("travel", 0, 1));
    assert_eq!(told(&good, &mut []), refused("out", 1, 0));
    assert_eq!(told(&good, &mut [&mut [0.0; 2]]), refused("out", 3, 2));
    assert_eq!(out, [7.0; 3]);
    assert_eq!(told(&good, &mut [&mut out]), Ok(()));
    assert_eq!(out, [1.0; 3]);
}

#[test]
fn storage_of_a_wrong_length_is_refused() {
    let motions = [ErrorMotion::default()];
    let sizes = with(&Slide, &motions, |compensator| compensator.batch_sizes()).0;
    for short in 0..3 {
        let less = |place: usize, length: usize| if place == short { length - 1 } else { length };
        let mut lanes = vec![Lanes::default(); less(0, sizes.lanes)];
        let mut numbers = vec![0.0; less(1, sizes.numbers)];
        let mut directions = vec![Direction::Positive; less(2, sizes.directions)];
        let work = BatchWork { lanes: &mut lanes, numbers: &mut numbers, directions: &mut directions };
        let none = Batch {
            position: &[&[]],
            travel: &[],
            direction: &[&[]],
            velocity: &[],
            temperature: &[],
            time_step: &[],
        };
        let refusal = with(&Slide, &motions, |c| c.compensate_batch(&none, work, &mut [&mut []], &mut [])).0;
        let name = ["work.lanes", "work.numbers", "work.directions"][short];
        assert!(matches!(refusal, Err(Refusal::Length { slice, .. }) if slice == name), "{refusal:?}");
    }
}
