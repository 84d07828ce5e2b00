//! The skew and the mesh that come nearest to a correction. In: the correction of a machine over its workspace. Out: the numbers of
//! the firmware's model.

use abbe_runtime::Direction;
use nalgebra::{Matrix4, Vector4};

use crate::controller::effects::{Effects, LEAST};
use crate::controller::job::Job;
use crate::controller::nodes::Spacing;
use crate::controller::refused::Refused;
use crate::controller::saved::{Mesh, Skew};

/// The skew by least squares over the poses of the workspace: x and y of the correction each as a constant and a slope over x, y
/// and z. The slopes that the firmware knows are taken: of x over y and z, of y over z.
///
/// # Errors
/// Where the correction cannot be computed.
pub(super) fn skew(job: &Job<'_, '_>, axes: [usize; 3]) -> Result<Skew, Refused> {
    let (mut normal, mut right) = (Matrix4::zeros(), [Vector4::zeros(); 2]);
    for pose in job.space.poses(job.geometry) {
        let correction = job.geometry.correction(&pose)?;
        let at = |values: &[f64], axis: usize| values.get(axis).copied().unwrap_or_default();
        let [x, y, z] = axes.map(|axis| at(&pose.position, axis));
        let place = Vector4::new(1.0, x, y, z);
        normal += place * place.transpose();
        for (sum, axis) in right.iter_mut().zip(axes) {
            *sum += place * at(&correction, axis);
        }
    }
    let inverse = normal.try_inverse().ok_or_else(|| {
        Refused::new(
            "the workspace has no extent in one of the axes",
            "give the travel of each axis with --range",
        )
    })?;
    let [of_x, of_y] = right.map(|sum| inverse * sum);
    Ok(Skew::of_tangents([of_x[2], of_y[3], of_x[3]], false))
}

/// The mesh: what is added to Z over X and Y, with Z at the reference, the mean of both directions. Nothing where it is
/// everywhere the same.
///
/// # Errors
/// Where the correction cannot be computed, or more points are asked for than the firmware takes.
pub(super) fn mesh(job: &Job<'_, '_>, [x, y, z]: [usize; 3], most: usize) -> Result<Option<Mesh>, Refused> {
    let effects = Effects::new(job.geometry, job.space)?;
    let spacing = Spacing { points: job.options.points, most };
    let places = [effects.nodes(x)?.spread_evenly(spacing)?, effects.nodes(y)?.spread_evenly(spacing)?];
    let mut heights = Vec::new();
    for row in &places[1] {
        for place in &places[0] {
            let at = |direction| -> Result<f64, Refused> {
                let pose = job.space.reference_pose(direction).moved(x, *place).moved(y, *row);
                Ok(job.geometry.correction(&pose)?.get(z).copied().unwrap_or(f64::NAN))
            };
            heights.push(f64::midpoint(at(Direction::Positive)?, at(Direction::Negative)?));
        }
    }
    let (low, high) = heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height: &f64| {
        (low.min(*height), high.max(*height))
    });
    Ok((high - low >= LEAST).then(|| Mesh::new(['X', 'Y'], places, heights)).flatten())
}
