//! What a format loses. In: a geometry, and a controller with its files loaded. Out: the errors at the tool over the workspace
//! without compensation, with the controller's and with Abbe's own, and the difference of the two.

use abbe_runtime::Direction;
use abbe_runtime::math::length;

use super::geometry::{Geometry, Pose};
use super::refused::Refused;
use super::space::Space;

/// A controller with its files loaded, as its maker documents it.
pub trait Target {
    /// What it adds to the command of each axis at a pose, mm or rad; 0 where it corrects nothing.
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused>;
}

/// Lengths over many poses, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Size {
    /// The root of the mean square.
    pub rms: f64,
    /// The largest.
    pub largest: f64,
}

/// Errors at the tool over the workspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lost {
    /// How many poses were looked at.
    pub poses: usize,
    /// Without compensation.
    pub without: Size,
    /// With the controller's.
    pub with_files: Size,
    /// With Abbe's own: what no axis reaches, such as the turn of the tool's direction in a lathe.
    pub with_abbe: Size,
    /// The difference between the last two: what the format loses.
    pub lost: Size,
    /// What the files leave at the reference pose and Abbe's own compensation does not, X, Y, Z, mm: a shift of all positions
    /// that counts in none of them, as that without compensation does not. Where the zero of a part lies is measured anyway.
    /// On a machine whose part or tool turns it is no shift, and counts.
    pub shift: [f64; 3],
}

impl Lost {
    /// Compares a controller with Abbe's own compensation.
    ///
    /// # Errors
    /// Where one of the two gives no correction.
    pub fn new(geometry: &Geometry<'_>, space: &Space, target: &dyn Target) -> Result<Self, Refused> {
        let errors = |pose: &Pose| -> Result<[[f64; 3]; 3], Refused> {
            let own = geometry.remaining(pose, &geometry.correction(pose)?)?;
            let files = geometry.remaining(pose, &target.correction(pose)?)?;
            Ok([geometry.error(pose)?, files, own])
        };
        let turns = geometry.equations.axes.iter().any(|axis| axis.rotary);
        let [before, shift] = if turns { [[0.0; 3]; 2] } else { shifts(space, &errors)? };
        let poses = space.poses(geometry);
        let mut sums = [Sum::default(); 4];
        for pose in &poses {
            let [without, files, own] = errors(pose)?;
            let (without, files) = (difference(without, before), difference(files, shift));
            for (sum, error) in sums.iter_mut().zip([without, files, own, difference(files, own)]) {
                sum.take(length(error));
            }
        }
        let [without, with_files, with_abbe, lost] = sums.map(|sum| sum.size(poses.len()));
        Ok(Self { poses: poses.len(), without, with_files, with_abbe, lost, shift })
    }
}

/// What is left at the reference pose besides Abbe's own, over both directions: without compensation, and with the files.
fn shifts(
    space: &Space,
    errors: &impl Fn(&Pose) -> Result<[[f64; 3]; 3], Refused>,
) -> Result<[[f64; 3]; 2], Refused> {
    let at = |direction| {
        errors(&space.reference_pose(direction))
            .map(|[without, files, own]| [without, files].map(|error| difference(error, own)))
    };
    let (up, down) = (at(Direction::Positive)?, at(Direction::Negative)?);
    Ok(std::array::from_fn(|which| {
        std::array::from_fn(|axis| f64::midpoint(up[which][axis], down[which][axis]))
    }))
}

fn difference(one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| one[axis] - other[axis])
}

#[derive(Clone, Copy, Default)]
struct Sum {
    squares: f64,
    largest: f64,
}

impl Sum {
    fn take(&mut self, length: f64) {
        self.squares += length * length;
        self.largest = self.largest.max(length);
    }

    fn size(self, poses: usize) -> Size {
        let poses = f64::from(u32::try_from(poses.max(1)).unwrap_or(u32::MAX));
        Size { rms: (self.squares / poses).sqrt(), largest: self.largest }
    }
}
