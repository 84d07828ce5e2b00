//! Slides that do not stand at right angles, some of them only where a rotary axis has turned them, and one that turns as
//! it goes.
//!
//! In: random angles and errors, several cycles of one compensator. Out: the sums that the moved slides must make, written down here.

use abbe_runtime::{ErrorMotion, Kinematics, Term};
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

/// Zero is a right angle; the others are up to 1.4 rad from it.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 1 => Just(core::f64::consts::PI), 3 => -1.4..1.4_f64]
}

proptest! {
    /// One compensator for all cycles keeps nothing of where the slide stood in an earlier one.
    #[test]
    fn the_slides_make_the_error_wherever_the_axis_has_turned(
        angles in prop::collection::vec(angle(), 1..20), ex in -0.05..0.05_f64, ey in -0.05..0.05_f64,
    ) {
        let (ex_terms, ey_terms) = ([Term::Constant { value: ex }], [Term::Constant { value: ey }]);
        let motions = [&ex_terms, &ey_terms].map(|terms| ErrorMotion { terms });
        let (commands, _) = with(&Turned, &motions, |slides| {
            let mut cycle = |angle: f64| {
                let mut command = [f64::NAN; 3];
                slides.compensate(&at(&[3.0, -5.0, angle]), &mut command).map(|_| command)
            };
            angles.iter().map(|angle| cycle(*angle)).collect::<Vec<_>>()
        });
        for (command, angle) in commands.into_iter().zip(&angles) {
            let [u, v, c] = command.unwrap();
            // u + v sin(c) = -ex and v cos(c) = -ey: what the slides move, against the error.
            let (du, dv) = (u - 3.0, v + 5.0);
            prop_assert!((du + dv * angle.sin() + ex).abs() < 1e-9, "at {}", angle);
            prop_assert!((dv * angle.cos() + ey).abs() < 1e-9, "at {}", angle);
            prop_assert_eq!(c.to_bits(), angle.to_bits());
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

    /// Each cycle has a direction of its own, and takes nothing of the one before.
    #[test]
    fn a_slide_makes_its_share_wherever_its_path_has_turned(
        targets in prop::collection::vec(-3.0..3.0_f64, 9..30), ex in -0.05..0.05_f64, ey in -0.05..0.05_f64,
    ) {
        let (ex_terms, ey_terms) = ([Term::Constant { value: ex }], [Term::Constant { value: ey }]);
        let motions = [&ex_terms, &ey_terms].map(|terms| ErrorMotion { terms });
        let (answers, _) = with(&Bent, &motions, |slide| {
            let mut cycle = |target: f64| {
                let mut command = [f64::NAN];
                slide.compensate(&at(&[target]), &mut command).map(|outcome| (command[0], outcome.remaining))
            };
            targets.iter().map(|target| cycle(*target)).collect::<Vec<_>>()
        });
        for (target, answer) in targets.iter().zip(answers) {
            let (command, [x, y, _]) = answer.unwrap();
            let share = target.cos() * ex + target.sin() * ey;
            prop_assert!((command - (target - share)).abs() < 1e-9, "{} at {}", command, target);
            prop_assert!((x - (ex - share * target.cos())).abs() < 1e-9);
            prop_assert!((y - (ey - share * target.sin())).abs() < 1e-9);
        }
    }
}
