//! Motors in the runtime: what a machine may say of them, and how corrections of theirs go through a servo cycle.
//!
//! In: a machine of two slides whose motors are crossed, or whose second slide has two. Out: commands by hand; a correction that fades in within its limit; and mistakes in the set-up.

use abbe_runtime::{
    AxisMemory, Compensator, Direction, ErrorMotion, Input, Kinematics, Limits, Memory, Sample, SetupError,
    Share, Supervisor, Term, TermState, Transition, Work,
};

/// Slides X and Y, and behind them the motors; error motions EXX, EYY and those of both motors.
struct Machine {
    following: Vec<Share>,
    squaring: Vec<Share>,
}

const fn share(motor: usize, of: usize, weight: f64) -> Share {
    Share { motor, of, weight }
}

/// A = X + Y, B = X - Y.
fn crossed() -> Machine {
    let following = vec![share(2, 0, 1.0), share(2, 1, 1.0), share(3, 0, 1.0), share(3, 1, -1.0)];
    Machine { following, squaring: Vec::new() }
}

impl Kinematics for Machine {
    fn axes(&self) -> usize {
        4
    }

    fn travels(&self) -> &[usize] {
        &[]
    }

    fn motions(&self) -> usize {
        4
    }

    fn error(&self, _: &[f64], _: &[f64], motions: &[f64]) -> [f64; 3] {
        [motions[0] + 0.5 * (motions[2] + motions[3]), motions[1] + 0.5 * (motions[2] - motions[3]), 0.0]
    }

    fn following(&self) -> &[Share] {
        &self.following
    }

    fn squaring(&self) -> &[Share] {
        &self.squaring
    }

    fn directions(&self, _: &[f64], directions: &mut [[f64; 3]]) {
        directions.copy_from_slice(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]]);
    }
}

/// A goes 100 um/m too far.
const LEAD: [Term<'static>; 1] = [Term::Polynomial { input: Input::Axis(2), coefficients: &[0.0, 1e-4] }];

#[test]
fn a_motor_goes_where_its_own_error_is_undone() {
    let machine = crossed();
    let motions = [&[][..], &[], &LEAD, &[]].map(|terms| ErrorMotion { terms });
    let mut states = [TermState::default()];
    let (mut directions, mut values) = ([[0.0; 3]; 4], [0.0; 4]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
    for (x, y) in [(0.0, 70.0), (30.0, 61.0), (100.0, -40.0)] {
        let sample = Sample {
            position: &[x, y, x + y, x - y],
            travel: &[],
            direction: &[Direction::Positive; 4],
            velocity: &[],
            temperature: &[],
            time_step: 0.0,
        };
        let mut command = [0.0; 4];
        compensator.compensate(&sample, &mut command).unwrap();
        // A stands right at c with c + 1e-4 c = x + y: what it lacks is half of X and half of Y, and B sees nothing of it.
        let a = (x + y) / 1.0001;
        let half = (x + y - a) / 2.0;
        let expected = [x - half, y - half, a, x - y];
        assert!(
            command.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9),
            "{command:?} is not {expected:?}"
        );
    }
}

#[test]
fn shares_that_name_what_the_machine_lacks_are_refused() {
    let beside = |following, squaring| Machine { following, squaring };
    for (machine, wrong) in [
        (beside(vec![share(2, 0, 1.0), share(4, 0, 1.0)], vec![]), 1),
        (beside(vec![share(2, 4, 1.0)], vec![]), 0),
        // A motor follows axes, and no other motor.
        (beside(vec![share(2, 0, 1.0), share(3, 2, 1.0)], vec![]), 1),
        (beside(vec![share(2, 0, f64::NAN)], vec![]), 0),
        (beside(vec![share(2, 0, 1.0)], vec![share(2, 4, 1.0)]), 1),
        (beside(vec![share(2, 0, 1.0)], vec![share(3, 0, 1.0)]), 1),
    ] {
        let motions = [ErrorMotion { terms: &[] }; 4];
        let (mut directions, mut values) = ([[0.0; 3]; 4], [0.0; 4]);
        let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
        let refused = Compensator::new(&machine, &motions, &mut [], work).map(|_| ()).unwrap_err();
        assert_eq!(refused, SetupError::Share { share: wrong });
    }
}

/// Y is sent 0.9 mm back, and both its motors with it; the first by 0.3 mm more for an error of its own. A correction of that length
/// fades in straight, since it never comes over the limit: of a motor counts what it has beside its slide.
#[test]
fn a_beam_counts_once_against_the_limit() {
    let machine =
        Machine { following: vec![share(2, 1, 1.0), share(3, 1, 1.0)], squaring: vec![share(2, 2, 1.0)] };
    let of = |value: f64| [Term::Constant { value }];
    let (of_slide, of_motor) = (of(0.9), of(0.3));
    let motions = [&[][..], &of_slide, &of_motor, &[]].map(|terms| ErrorMotion { terms });
    let mut states = [TermState::default(); 2];
    let (mut directions, mut values) = ([[0.0; 3]; 4], [0.0; 4]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work).unwrap();
    // sqrt(0.9^2 + 0.3^2) = 0.9487
    compensator.limits = Limits { compensation: Some(0.95), ..Limits::default() };
    let mut axes = [AxisMemory::default(); 4];
    let memory = Memory { axes: &mut axes, temperature: &mut [], silence: &mut [] };
    let mut supervisor = Supervisor::new(compensator, memory).unwrap();
    supervisor.transition = Transition { fade: 1.0, ..Transition::default() };
    let sample = Sample {
        position: &[10.0, 20.0, 20.0, 20.0],
        travel: &[],
        direction: &[Direction::Positive; 4],
        velocity: &[],
        temperature: &[],
        time_step: 0.1,
    };
    let mut command = [0.0; 4];
    for cycle in 1..=12 {
        let done = supervisor.cycle(&sample, &mut command);
        let part = f64::from(cycle.min(10)) / 10.0;
        let expected = [10.0, 20.0 - 0.9 * part, 20.0 - 1.2 * part, 20.0 - 0.9 * part];
        for (command, expected) in command.iter().zip(expected) {
            assert!((command - expected).abs() < 1e-9, "cycle {cycle}: {command} is not {expected}");
        }
        assert!((done.correction - part * (0.9_f64.powi(2) + 0.3_f64.powi(2)).sqrt()).abs() < 1e-9);
    }
}
