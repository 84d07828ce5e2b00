//! Slides that do not stand at right angles, some of them only where a rotary axis has turned them, and one that turns as
//! it goes.
//!
//! In: random angles and errors, several rows side by side. Out: the sums that the moved slides must make, written down
//! here; and that a row side by side with others is answered as it is alone.

use abbe_runtime::{Batch, BatchWork, Direction, ErrorMotion, Kinematics, Lanes, Outcome, Refusal, Term};
use proptest::prelude::*;

use crate::common::{at, with};

/// A slide along X, and one that a rotary axis turns from Y towards X; the errors are those of the tip in X and Y.
struct Turned;

impl Kinematics for Turned {
    fn axes(&self) -> usize {
        3
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        2
    }
    fn error(&self, _position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        [motions[0], motions[1], 0.0]
    }
    fn error_lanes(&self, _position: &[Lanes], _travel: &[Lanes], motions: &[Lanes]) -> Option<[Lanes; 3]> {
        Some([motions[0], motions[1], Lanes::from(0.0)])
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        let (sine, cosine) = position[2].sin_cos();
        directions.copy_from_slice(&[[1.0, 0.0, 0.0], [sine, cosine, 0.0], [0.0; 3]]);
    }
}

/// A single slide on a path that turns from X towards Y as it goes, by a rad for each mm.
struct Bent;

impl Kinematics for Bent {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        2
    }
    fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        Turned.error(position, travel, motions)
    }
    fn error_lanes(&self, position: &[Lanes], travel: &[Lanes], motions: &[Lanes]) -> Option<[Lanes; 3]> {
        Turned.error_lanes(position, travel, motions)
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        let (sine, cosine) = position[0].sin_cos();
        directions.fill([cosine, sine, 0.0]);
    }
}

/// Two slides in directions that are known when the code is compiled.
struct Known(&'static [[f64; 3]; 2]);

impl Kinematics for Known {
    fn axes(&self) -> usize {
        2
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        2
    }
    fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        Turned.error(position, travel, motions)
    }
    fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
        directions.copy_from_slice(self.0);
    }
    fn directions_vary(&self) -> bool {
        false
    }
    fn fixed_directions(&self) -> Option<&'static [[f64; 3]]> {
        Some(self.0)
    }
}

/// A column for each axis, of targets or commands.
type Columns<const AXES: usize> = [Vec<f64>; AXES];

/// The commands of all rows, and their answers.
fn side_by_side<const AXES: usize>(
    machine: &impl Kinematics,
    motions: &[ErrorMotion<'_>],
    targets: &Columns<AXES>,
) -> (Columns<AXES>, Vec<Result<Outcome, Refusal>>) {
    let rows = targets[0].len();
    let (directions, time_step) = (vec![Direction::Positive; rows], vec![0.0; rows]);
    let mut commands = [(); AXES].map(|()| vec![f64::NAN; rows]);
    let mut answers = vec![Err(Refusal::NotFinite); rows];
    let (result, _) = with(machine, motions, |compensator| {
        let sizes = compensator.batch_sizes();
        let mut lanes = vec![Lanes::from(f64::NAN); sizes.lanes];
        let mut numbers = vec![f64::NAN; sizes.numbers];
        let mut spare = vec![Direction::Negative; sizes.directions];
        let work = BatchWork { lanes: &mut lanes, numbers: &mut numbers, directions: &mut spare };
        let batch = Batch {
            position: &targets.each_ref().map(Vec::as_slice),
            travel: &[],
            direction: &[&directions[..]; AXES],
            velocity: &[],
            temperature: &[],
            time_step: &time_step,
        };
        let mut out = commands.each_mut().map(Vec::as_mut_slice);
        compensator.compensate_batch(&batch, work, &mut out, &mut answers)
    });
    result.unwrap();
    (commands, answers)
}

/// Zero is a right angle; the others are up to 1.4 rad from it.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => Just(core::f64::consts::PI), 3 => -1.4..1.4_f64]
}

proptest! {
    #[test]
    fn the_slides_make_the_error_whatever_stands_beside(
        angles in prop::collection::vec(angle(), 1..20), ex in -0.05..0.05_f64, ey in -0.05..0.05_f64,
    ) {
        let (ex_terms, ey_terms) = ([Term::Constant { value: ex }], [Term::Constant { value: ey }]);
        let motions = [&ex_terms, &ey_terms].map(|terms| ErrorMotion { terms });
        let places = |step: f64| (0..angles.len()).map(|row| step * row as f64).collect::<Vec<f64>>();
        let targets = [places(3.0), places(-5.0), angles.clone()];
        let ([u, v, c], answers) = side_by_side(&Turned, &motions, &targets);
        // One compensator for all cycles keeps nothing of where the slide stood in an earlier one.
        let target = |row: usize| [targets[0][row], targets[1][row], angles[row]];
        let (one_after_the_other, _) = with(&Turned, &motions, |one| {
            let mut command = [f64::NAN; 3];
            let mut cycle = |row| one.compensate(&at(&target(row)), &mut command).map(|_| command);
            (0..angles.len()).map(&mut cycle).collect::<Vec<_>>()
        });
        for (row, angle) in angles.iter().enumerate() {
            // u + v sin(c) = -ex and v cos(c) = -ey: what the slides move, against the error.
            let (du, dv) = (u[row] - targets[0][row], v[row] - targets[1][row]);
            prop_assert!((du + dv * angle.sin() + ex).abs() < 1e-9, "row {} at {}", row, angle);
            prop_assert!((dv * angle.cos() + ey).abs() < 1e-9, "row {} at {}", row, angle);
            let mut alone = [f64::NAN; 3];
            let (answer, _) = with(&Turned, &motions, |one| one.compensate(&at(&target(row)), &mut alone));
            prop_assert_eq!(&answers[row], &answer);
            prop_assert_eq!(one_after_the_other[row], Ok(alone));
            prop_assert_eq!([u[row], v[row], c[row]].map(f64::to_bits), alone.map(f64::to_bits));
        }
    }

    #[test]
    fn slides_in_known_directions_make_the_error(ex in -0.05..0.05_f64, ey in -0.05..0.05_f64, at_x in -9.0..9.0_f64) {
        const UPRIGHT: Known = Known(&[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]);
        const LEANING: Known = Known(&[[1.0, 0.0, 0.0], [0.6, 0.8, 0.0]]);
        let (ex_terms, ey_terms) = ([Term::Constant { value: ex }], [Term::Constant { value: ey }]);
        let motions = [&ex_terms, &ey_terms].map(|terms| ErrorMotion { terms });
        let target = [at_x, -2.0 * at_x];
        for (machine, moves) in [(UPRIGHT, [ey, -ex]), (LEANING, [-ex + 0.75 * ey, -1.25 * ey])] {
            let mut command = [f64::NAN; 2];
            // Once more in the same place: what was found for the first cycle serves all.
            let (answers, _) = with(&machine, &motions, |slides| {
                [0, 1].map(|_| slides.compensate(&at(&target), &mut command))
            });
            for answer in answers {
                prop_assert!(answer.unwrap().remaining.iter().all(|left| left.abs() < 1e-12));
            }
            for ((command, target), moves) in command.iter().zip(target).zip(moves) {
                prop_assert!((command - target - moves).abs() < 1e-12, "{} from {}", command, target);
            }
        }
    }

    /// Each row has a direction of its own, and takes nothing of the block before.
    #[test]
    fn a_slide_makes_its_share_wherever_its_path_has_turned(
        targets in prop::collection::vec(-3.0..3.0_f64, 9..30), ex in -0.05..0.05_f64, ey in -0.05..0.05_f64,
    ) {
        let (ex_terms, ey_terms) = ([Term::Constant { value: ex }], [Term::Constant { value: ey }]);
        let motions = [&ex_terms, &ey_terms].map(|terms| ErrorMotion { terms });
        let columns = [targets];
            let ([commands], answers) = side_by_side(&Bent, &motions, &columns);
        for ((target, command), answer) in columns[0].iter().zip(commands).zip(answers) {
            let share = target.cos() * ex + target.sin() * ey;
            prop_assert!((command - (target - share)).abs() < 1e-9, "{} at {}", command, target);
            let [x, y, _] = answer.unwrap().remaining;
            prop_assert!((x - (ex - share * target.cos())).abs() < 1e-9);
            prop_assert!((y - (ey - share * target.sin())).abs() < 1e-9);
        }
    }
}
