//! Rotary axes that correct the error of their own angle.
//!
//! In: a rotary table whose angle is wrong, among other errors. Out: where the tip really is, by finite rotations that the compensator
//! never sees.

use abbe_runtime::{
    AxisMemory, Compensator, Convergence, Direction, DirectionTracker, ErrorMotion, Input, Kinematics,
    Limits, Memory, Refusal, Sample, SetupError, State, Supervisor, Table, Term, TermState, Transition,
    Turning, Values, Work,
};
use proptest::prelude::*;

use crate::common::{at, with};

/// Slides X and Y over a table C that turns the part. Motions: EXX, EYY, EXC, ECC, EC0C.
#[derive(Debug)]
struct Table2 {
    turning: &'static [Turning],
}

const OWN: &[Turning] = &[Turning { axis: 2, motion: 3 }, Turning { axis: 2, motion: 4 }];
const MILL: Table2 = Table2 { turning: OWN };
/// The same, its angle left to the slides.
const CLAMPED: Table2 = Table2 { turning: &[] };

/// A place over the table as the part sees it, the table being turned by an angle.
fn in_part(c: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sine, cosine) = c.sin_cos();
    [cosine * x + sine * y, cosine * y - sine * x]
}

impl Table2 {
    fn equations([x, y, c]: [f64; 3], [exx, eyy, exc, ecc, ec0c]: [f64; 5]) -> [f64; 3] {
        let turned = ecc + ec0c;
        // The part turned further by a small angle sees the tip turned back: p + e y, q - e x.
        let [dx, dy] = in_part(c, [exx - exc + turned * y, eyy - turned * x]);
        [dx, dy, 0.0]
    }
}

impl Kinematics for Table2 {
    fn axes(&self) -> usize {
        3
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        5
    }
    fn error(&self, position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        match (position.try_into(), motions.try_into()) {
            (Ok(position), Ok(motions)) => Self::equations(position, motions),
            _ => [f64::NAN; 3],
        }
    }
    fn turning(&self) -> &[Turning] {
        self.turning
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        for (direction, slide) in directions.iter_mut().zip([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]) {
            let [x, y] = in_part(position[2], slide);
            *direction = [x, y, 0.0];
        }
    }
}

/// Where the tip really is in the part at a command, and the angle of the part, from the values of the error motions there.
fn real(command: &[f64], motions: &[ErrorMotion<'_>], sample: &Sample<'_>) -> ([f64; 2], f64) {
    let sample = Sample { position: command, ..*sample };
    let [exx, eyy, exc, ecc, ec0c]: [f64; 5] = motions
        .iter()
        .map(|motion| motion.value(&sample, &vec![TermState::default(); motion.terms.len()]))
        .collect::<Vec<_>>()
        .try_into()
        .unwrap();
    let angle = command[2] + ecc + ec0c;
    (in_part(angle, [command[0] + exx - exc, command[1] + eyy]), angle)
}

fn apart([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}

proptest! {
    /// However wrong the angle is, the table itself undoes all of it, and no slide moves.
    #[test]
    fn an_angle_is_corrected_on_its_own_axis(
        place in prop::array::uniform2(-300.0..300.0_f64), c in -7.0..7.0_f64, zero in -0.1..0.1_f64,
        values in prop::collection::vec(-0.02..0.02_f64, 8), slope in -1e-2..1e-2_f64, turned in any::<bool>(),
    ) {
        let table = Table::uniform(-7.0, 2.0, Values::Both(&values)).unwrap();
        let own = [
            Term::Table { axis: 2, table },
            Term::Polynomial { input: Input::Axis(2), coefficients: &[0.0, slope] },
            Term::Backlash { axis: 2, lost_motion: 1e-3, wind_up: 0.0, ramp: 0.0 },
        ];
        let zero = [Term::Constant { value: zero }];
        let motions = [&[][..], &[], &[], &own, &zero].map(|terms| ErrorMotion { terms });
        let direction = [if turned { Direction::Negative } else { Direction::Positive }; 3];
        let target = [place[0], place[1], c];
        let sample = Sample { direction: &direction, ..at(&target) };
        let mut command = [0.0; 3];
        let (outcome, _) = with(&MILL, &motions, |mill| mill.compensate(&sample, &mut command).unwrap());
        let (tip, angle) = real(&command, &motions, &sample);
        prop_assert_eq!([command[0], command[1]], place);
        prop_assert!((angle - c).abs() < 2e-10, "{} is not {}", angle, c);
        prop_assert!(apart(tip, in_part(c, place)) < 1e-7);
        prop_assert_eq!(outcome.remaining, [0.0; 3]);
        // The error told is that without any compensation.
        let whole = with(&CLAMPED, &motions, |mill| mill.error(&sample).unwrap()).0;
        prop_assert_eq!(outcome.error, whole);
    }

    /// Beside it the slides undo the other errors, with the lever arms of a table that stands at the angle wanted.
    #[test]
    fn the_slides_correct_the_rest(
        place in prop::array::uniform2(-300.0..300.0_f64), c in -3.0..3.0_f64,
        [a, b, d, e, f] in prop::array::uniform5(-1.0..1.0_f64),
    ) {
        let coefficients = [[0.1 * a, 1e-3 * b], [0.1 * b, 1e-3 * d], [0.1 * d, 0.01 * e], [1e-3 * e, 1e-3 * f]];
        let axes = [0, 1, 2, 2];
        let terms: Vec<[Term<'_>; 1]> = coefficients
            .iter()
            .zip(axes)
            .map(|(coefficients, axis)| [Term::Polynomial { input: Input::Axis(axis), coefficients }])
            .collect();
        let zero = [Term::Constant { value: 1e-3 * a }];
        let motions =
            [&terms[0][..], &terms[1], &terms[2], &terms[3], &zero].map(|terms| ErrorMotion { terms });
        let target = [place[0], place[1], c];
        let mut command = [0.0; 3];
        with(&MILL, &motions, |mill| mill.compensate(&at(&target), &mut command).unwrap());
        let (tip, angle) = real(&command, &motions, &at(&target));
        prop_assert!((angle - c).abs() < 2e-10);
        prop_assert!(apart(tip, in_part(c, place)) < 1e-7);
    }
}

#[test]
fn left_to_the_slides_the_table_stands_where_it_was_told() {
    let own = [Term::Constant { value: 1e-5 }];
    let motions = [&[][..], &[], &[], &own, &[]].map(|terms| ErrorMotion { terms });
    let mut command = [0.0; 3];
    let (outcome, _) =
        with(&CLAMPED, &motions, |mill| mill.compensate(&at(&[100.0, 0.0, 0.0]), &mut command).unwrap());
    // The part turned by 10 urad sees the tip 1 um too far towards -Y: Y goes 1 um further.
    assert_eq!(command[2].to_bits(), 0.0_f64.to_bits());
    assert!((command[1] - 0.001).abs() < 1e-9, "{command:?}");
    assert!((outcome.error[1] + 0.001).abs() < 1e-12);
}

#[test]
fn an_angle_that_is_not_found_or_over_its_limit_passes_unchanged() {
    let target = [10.0, 20.0, 1.0];
    let run = |own: &[Term<'_>], limits: Limits| {
        let motions = [&[][..], &[], &[], own, &[]].map(|terms| ErrorMotion { terms });
        let mut command = [0.0; 3];
        let (result, _) = with(&MILL, &motions, |mill| {
            mill.limits = limits;
            mill.compensate(&at(&target), &mut command)
        });
        (result, command)
    };
    let large = [Term::Constant { value: -0.25 }];
    let limit = |rotation| Limits { rotation: Some(rotation), ..Limits::default() };
    assert!(run(&large, limit(0.25)).0.is_ok());
    for refused in [0.2, f64::NAN] {
        let (result, command) = run(&large, limit(refused));
        assert!(matches!(result, Err(Refusal::OverRotationLimit { correction: 0.25, .. })), "{result:?}");
        assert_eq!(command, target);
    }
    // The limit of the slides is none of the table's.
    assert!(run(&large, Limits { compensation: Some(0.0), rotation: None }).0.is_ok());

    let steep = [Term::Polynomial { input: Input::Axis(2), coefficients: &[0.1, 1.0] }];
    let (result, command) = run(&steep, Limits::default());
    let Err(Refusal::AngleNotConverging { iterations: 20, angle }) = result else { panic!("{result:?}") };
    assert!(angle > 0.1 && command == target);

    let endless = [Term::Polynomial { input: Input::Axis(2), coefficients: &[1.0, 1e30, 1e30] }];
    assert_eq!(run(&endless, Limits::default()), (Err(Refusal::NotFinite), target));
}

#[test]
fn the_table_settles_as_the_convergence_says() {
    let own = [Term::Polynomial { input: Input::Axis(2), coefficients: &[0.0, 0.1] }];
    let motions = [&[][..], &[], &[], &own, &[]].map(|terms| ErrorMotion { terms });
    let mut command = [0.0; 3];
    let (result, _) = with(&MILL, &motions, |mill| {
        mill.convergence = Convergence { iterations: 3, tolerance: 1e-10 };
        mill.compensate(&at(&[0.0, 0.0, 1.0]), &mut command)
    });
    // Each step is a tenth of the one before: 0.1, 0.01, 0.001.
    let Err(Refusal::AngleNotConverging { iterations: 3, angle }) = result else { panic!("{result:?}") };
    assert!((angle - 0.001).abs() < 1e-12);
}

/// A step of the correction that a ramp spreads is made by the table, little by little, and what is not made yet remains.
#[test]
fn a_ramp_on_the_table_leaves_its_rest_to_later_cycles() {
    let own = [Term::Backlash { axis: 2, lost_motion: 2e-5, wind_up: 0.0, ramp: 0.01 }];
    let motions = [&[][..], &[], &[], &own, &[]].map(|terms| ErrorMotion { terms });
    let mut tracker = DirectionTracker::new(1e-9);
    tracker.update(1.0);
    let (rows, _) = with(&MILL, &motions, |mill| {
        let mut rows = Vec::new();
        for cycle in 0..30 {
            let c =
                if cycle < 10 { 1.0 + 1e-6 * f64::from(cycle) } else { 1.0 - 1e-6 * f64::from(cycle - 10) };
            let direction = [Direction::Positive, Direction::Positive, tracker.update(c)];
            let target = [100.0, 0.0, c];
            let sample = Sample { direction: &direction, ..at(&target) };
            let mut command = [0.0; 3];
            let outcome = mill.compensate(&sample, &mut command).unwrap();
            rows.push((command[2] - c, outcome));
        }
        rows
    });
    let (before, settled) = (&rows[9], &rows[29]);
    // Going up the table lags by half of 20 urad, and is told to go further; down it is the other way round.
    assert!((before.0 - 1e-5).abs() < 1e-12 && (settled.0 + 1e-5).abs() < 1e-12);
    assert!(before.1.remaining[1].abs() < 1e-12 && settled.1.remaining[1].abs() < 1e-12);
    for (made, outcome) in &rows[11..18] {
        // What is not made yet of the angle is left at the tip, 100 mm away.
        let left = -100.0 * (1e-5 + made);
        let length = outcome.remaining.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!(made.abs() < 1e-5 && (length - left.abs()).abs() < 1e-9, "{made} {:?}", outcome.remaining);
    }
}

#[test]
fn a_supervisor_turns_no_faster_than_its_rate() {
    let own = [Term::Constant { value: -1e-3 }];
    let motions = [&[][..], &[], &[], &own, &[]].map(|terms| ErrorMotion { terms });
    let mut states = [TermState::default()];
    let (mut directions, mut values) = ([[0.0; 3]; 3], [0.0; 5]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let compensator = Compensator::new(&MILL, &motions, &mut states, work).unwrap();
    let mut axes = [AxisMemory::default(); 3];
    let memory = Memory { axes: &mut axes, temperature: &mut [], silence: &mut [] };
    let mut supervisor = Supervisor::new(compensator, memory).unwrap();
    supervisor.transition =
        Transition { rotation_rate: Some(0.05), rate: Some(0.0), fade: 0.0, ..Transition::default() };
    let target = [0.0, 0.0, 1.0];
    for cycle in 1..=30 {
        let mut command = [0.0; 3];
        let done = supervisor.cycle(&at(&target), &mut command);
        // 0.05 rad/s are 50 urad a cycle of 1 ms; the rate of the slides, which is 0, does not hold the table.
        let expected = (5e-5 * f64::from(cycle)).min(1e-3);
        assert!((command[2] - 1.0 - expected).abs() < 1e-12, "{cycle}: {command:?}");
        assert_eq!((done.state, done.settling, done.correction), (State::Active, cycle < 20, 0.0));
    }
}

#[test]
fn wrong_entries_are_told_at_the_set_up() {
    const WRONG: [&[Turning]; 4] = [
        &[Turning { axis: 3, motion: 3 }],
        &[Turning { axis: 2, motion: 5 }],
        &[Turning { axis: 2, motion: 3 }, Turning { axis: 0, motion: 0 }],
        &[Turning { axis: 2, motion: 3 }; 7],
    ];
    let motions = [ErrorMotion::default(); 5];
    for (turning, entry) in WRONG.into_iter().zip([0, 0, 1, 6]) {
        let machine = Table2 { turning };
        let (mut directions, mut values) = ([[0.0; 3]; 3], [0.0; 5]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
        let result = Compensator::new(&machine, &motions, &mut [], work);
        assert_eq!(result.err(), Some(SetupError::Turning { turning: entry }));
    }
}
