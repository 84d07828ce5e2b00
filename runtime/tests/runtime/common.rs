//! What the tests of the runtime share: samples, and small machines written by hand.
//!
//! In: positions and directions. Out: the same with everything else filled in. It exists so that a test shows only what it is about.

use abbe_runtime::{Compensator, Direction, ErrorMotion, Kinematics, Sample, TermState, Work, states_needed};

/// A sample at rest, all axes of which moved last in the positive direction; room for six axes.
pub(crate) fn at(position: &[f64]) -> Sample<'_> {
    static POSITIVE: [Direction; 6] = [Direction::Positive; 6];
    Sample {
        position,
        travel: &[],
        direction: &POSITIVE[..position.len()],
        velocity: &[],
        temperature: &[],
        time_step: 0.001,
    }
}

/// Builds a compensator in fresh storage, hands it to the test, and returns what the test makes of it, with the
/// memories as they are afterwards.
pub(crate) fn with<K: Kinematics, R>(
    kinematics: &K,
    motions: &[ErrorMotion<'_>],
    test: impl FnOnce(&mut Compensator<'_, K>) -> R,
) -> (R, Vec<TermState>) {
    let mut states = vec![TermState::default(); states_needed(motions)];
    let mut directions = vec![[f64::NAN; 3]; kinematics.axes()];
    let mut values = vec![f64::NAN; kinematics.motions()];
    let mut travel = vec![f64::NAN; kinematics.travels().len()];
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(kinematics, motions, &mut states, work).unwrap();
    let result = test(&mut compensator);
    (result, states)
}

/// One slide along X; its one error motion is EXX.
#[derive(Debug)]
pub(crate) struct Slide;

impl Kinematics for Slide {
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
        if position.len() == 1 && motions.len() == 1 { [motions[0], 0.0, 0.0] } else { [f64::NAN; 3] }
    }
    fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
        directions.fill([1.0, 0.0, 0.0]);
    }
}

/// A T-base lathe: the carriage Z holds the part, so that +Z of the axis moves the tip towards -Z of the part; the
/// slide X holds the tool. X and Z are sensitive. Motions: EXX, EZZ, EBX (lever: overhang and tip), EB0Z (lever: the
/// travel of Z).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lathe {
    /// Tool offsets Xt and Zt, mm.
    pub(crate) tool: [f64; 2],
}

impl Lathe {
    /// What the axes X and Z do to the tip.
    pub(crate) const DIRECTIONS: &'static [[f64; 3]] = &[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];
}

impl Kinematics for Lathe {
    fn axes(&self) -> usize {
        2
    }
    fn travels(&self) -> &[usize] {
        &[1]
    }
    fn motions(&self) -> usize {
        4
    }
    fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
        let (&[_, _], &[dz], &[exx, ezz, ebx, eb0z]) = (position, travel, motions) else {
            return [f64::NAN; 3];
        };
        let [xt, zt] = self.tool;
        [exx + zt * ebx - dz * eb0z, 0.0, -ezz - xt * ebx]
    }
    fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
        directions.copy_from_slice(Self::DIRECTIONS);
    }
}

/// Slides X, Y, Z on the tool's side and a rotary table C under the part. Motions: EXX, EYX, EXY, EYY, EZZ, EAX, EBX,
/// ECX and EC0Y, with the lever arms of a tool that hangs at (xt, yt, z + zt) from the slide X.
#[derive(Debug)]
pub(crate) struct TableMill {
    /// Tool offsets, mm.
    pub(crate) tool: [f64; 3],
}

impl TableMill {
    /// A vector of the bed in the frame of the part, which C has turned about Z.
    pub(crate) fn in_part(c: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = c.sin_cos();
        [cos * x + sin * y, cos * y - sin * x, z]
    }

    fn equations(&self, [_, y, z, c]: [f64; 4], motions: [f64; 9]) -> [f64; 3] {
        let [exx, eyx, exy, eyy, ezz, eax, ebx, ecx, ec0y] = motions;
        let [xt, yt, zt] = self.tool;
        let (ly, lz) = (y + yt, z + zt);
        let bed = [
            exx + exy - ly * ecx + lz * ebx - y * ec0y,
            eyx + eyy + xt * ecx - lz * eax,
            ezz + ly * eax - xt * ebx,
        ];
        Self::in_part(c, bed)
    }
}

impl Kinematics for TableMill {
    fn axes(&self) -> usize {
        4
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        9
    }
    fn error(&self, position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        match (position.try_into(), motions.try_into()) {
            (Ok(position), Ok(motions)) => self.equations(position, motions),
            _ => [f64::NAN; 3],
        }
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        let c = position[3];
        let slides = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (direction, slide) in directions.iter_mut().zip(slides) {
            *direction = Self::in_part(c, slide);
        }
        directions[3] = [0.0; 3];
    }
    fn resting(&self) -> &[bool] {
        &[false, false, false, true]
    }
    fn squares(&self) -> Option<[f64; 3]> {
        Some([1.0; 3])
    }
}

/// A slide W on a swivel B on a slide X: at B = 0 W moves the tip along Z, at 90 degrees along X as X itself does. The one error motion
/// is EZX.
#[derive(Debug)]
pub(crate) struct Swivel;

impl Kinematics for Swivel {
    fn axes(&self) -> usize {
        3
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        1
    }
    fn error(&self, _position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        [0.0, 0.0, motions[0]]
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        let (sine, cosine) = position[1].sin_cos();
        directions.copy_from_slice(&[[1.0, 0.0, 0.0], [0.0; 3], [sine, 0.0, cosine]]);
    }
    fn directions_vary(&self) -> bool {
        true
    }
}
