//! Axes that are not square, as firmware corrects them. In: skew factors, or tangents. Out: what is added to a command, and the
//! error that this takes away.

use nalgebra::{Matrix3, Vector3};

/// What is added to the commands of X, Y, Z for each mm of X, Y, Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::controller) struct Skew(Matrix3<f64>);

impl Skew {
    /// Marlin's and Klipper's factors. Both command
    ///
    /// ```text
    /// x' = x - y xy - z (xz - xy yz)
    /// y' = y - z yz
    /// ```
    ///
    /// (Marlin: `Planner::skew` in `planner.h`; Klipper: `calc_skew` in `skew_correction.py`), which is the exact inverse of the
    /// error `x + y xy + z xz`, `y + z yz`: a positive factor says that the tool goes too far towards +X, or +Y, as Y, or Z, grows.
    pub(in crate::controller) fn of_factors([xy, xz, yz]: [f64; 3]) -> Self {
        Self(Matrix3::new(0.0, -xy, -(xz - xy * yz), 0.0, 0.0, -yz, 0.0, 0.0, 0.0))
    }

    /// The factors of which the correction is made.
    pub(in crate::controller) fn factors(&self) -> [f64; 3] {
        let (xy, yz) = (-self.0[(0, 1)], -self.0[(1, 2)]);
        [xy, xy * yz - self.0[(0, 2)], yz]
    }

    /// RepRapFirmware's tangents (`M556`). It commands
    ///
    /// ```text
    /// x' = x + y tanXY + z tanXZ
    /// y' = y + z tanYZ
    /// ```
    ///
    /// or, with `P1`, adds `x tanXY` to y in place of `y tanXY` to x (`Move::AxisTransform`): the sign is the opposite of Marlin's.
    pub(in crate::controller) fn of_tangents([xy, yz, xz]: [f64; 3], to_y: bool) -> Self {
        let [of_x, of_y] = if to_y { [0.0, xy] } else { [xy, 0.0] };
        Self(Matrix3::new(0.0, of_x, xz, of_y, 0.0, yz, 0.0, 0.0, 0.0))
    }

    /// The tangents, in the order of the letters of `M556`: X is that of XY, Y that of YZ, Z that of XZ.
    pub(in crate::controller) fn tangents(&self) -> [f64; 3] {
        [self.0[(0, 1)], self.0[(1, 2)], self.0[(0, 2)]]
    }

    /// What is added to x, y, z.
    pub(in crate::controller) fn correction(&self, position: [f64; 3]) -> [f64; 3] {
        (self.0 * Vector3::from(position)).into()
    }

    /// The error that the firmware takes for granted: how far the tool is off in each direction (the rows), for each mm that is
    /// commanded to X, Y, Z (the columns). The command of q is `(1 + C) q`, so that the error of a command is `(1 + C)^-1 - 1`
    /// times it. Nothing where the skew has no inverse.
    pub(super) fn errors(&self) -> Option<[[f64; 3]; 3]> {
        let inverse = (Matrix3::identity() + self.0).try_inverse()?;
        Some((inverse - Matrix3::identity()).transpose().into())
    }
}
