//! Instruments: what is read of where the tool really stands.
//!
//! In: poses of the tool relative to the part, as they are and as they would be without errors. Out: readings in mm or
//! rad, the same as a recording holds: `measured.x|y|z`, `measured.<rotary axis>` or `deviation`.

use nalgebra::{Rotation3, Vector3};

use crate::plant::{Plant, Pose};

/// What measures, and how it is set up: part frame, mm, rad.
#[derive(Clone, Debug, PartialEq)]
pub enum Instrument {
    /// The tool tip relative to the part in some directions, and the angles of rotary axes by their numbers.
    Position {
        /// Which of X, Y, Z.
        directions: [bool; 3],
        /// Which rotary axes.
        angles: Vec<usize>,
    },
    /// The distance of the tool tip from a centre, minus the nominal radius.
    Ballbar {
        /// The declared centre; where it is none, the nominal tip at the centre of the path's circle.
        center: Option<[f64; 3]>,
        /// The nominal radius; where it is none, that of the path's circle.
        radius: Option<f64>,
        /// True centre minus declared centre.
        eccentricity: [f64; 3],
        /// Added to every reading: the bar's own length is known so badly.
        offset: f64,
    },
    /// The displacement along a direction, minus the commanded one.
    Linear {
        /// The axis that moves.
        axis: usize,
        /// The direction that is read, a unit vector.
        direction: [f64; 3],
        /// The angle between the beam and that direction, rad: readings are short by its cosine.
        cosine: f64,
    },
    /// The displacement across the axis that moves.
    Straightness {
        /// The axis that moves.
        axis: usize,
        /// The direction that is read, a unit vector.
        direction: [f64; 3],
    },
    /// The rotation of the tool relative to the part.
    Angular {
        /// The axis that moves, where one is named.
        axis: Option<usize>,
        /// The direction it is read about, right-handed, a unit vector.
        about: [f64; 3],
    },
    /// The displacement along the normal of a surface.
    Probe {
        /// Which way the surface looks.
        normal: Normal,
    },
}

impl Instrument {
    /// A bar about a declared centre (mm, part frame), without faults.
    pub fn ballbar(center: [f64; 3], radius: f64) -> Self {
        Self::Ballbar { center: Some(center), radius: Some(radius), eccentricity: [0.0; 3], offset: 0.0 }
    }

    /// A beam in a direction, without faults, along the axis that moves. Along a diagonal, where none is named, it reads what a probe in that
    /// direction reads.
    pub fn linear(axis: Option<usize>, direction: [f64; 3]) -> Self {
        match axis {
            Some(axis) => Self::Linear { axis, direction, cosine: 0.0 },
            None => Self::Probe { normal: Normal::Fixed(direction) },
        }
    }

    /// A reading in a direction across the axis that moves; as a probe where none is named.
    pub fn straightness(axis: Option<usize>, direction: [f64; 3]) -> Self {
        match axis {
            Some(axis) => Self::Straightness { axis, direction },
            None => Self::Probe { normal: Normal::Fixed(direction) },
        }
    }
}

/// Which way a surface looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// The same way everywhere: a unit vector.
    Fixed([f64; 3]),
    /// Away from a centre: a ring or a sphere. Directions that the centre lacks (NaN) do not count: a ring in XY has no Z.
    /// Where the centre is none, it is the nominal tip at the centre of the path's circle.
    Radial(Option<[f64; 3]>),
}

/// One channel of readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// `measured.x|y|z`, by the number of the direction.
    Measured(usize),
    /// `measured.<axis>` of a rotary axis, by the number of the axis.
    Angle(usize),
    /// `deviation`.
    Deviation,
}

/// A sample as an instrument meets it.
pub(crate) struct Seen<'s> {
    /// The tool as it stands, or stood, when the instrument looks.
    pub(crate) pose: Pose,
    /// The tool as it would stand by the command of this row.
    pub(crate) nominal: Pose,
    /// The command of this row.
    pub(crate) positions: &'s [f64],
    /// The nominal tip in the first row.
    pub(crate) start: Vector3<f64>,
}

impl Instrument {
    /// All three directions.
    pub fn position() -> Self {
        Self::Position { directions: [true; 3], angles: Vec::new() }
    }

    /// Its name in recordings.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Position { .. } => "position",
            Self::Ballbar { .. } => "ballbar",
            Self::Linear { .. } => "linear",
            Self::Straightness { .. } => "straightness",
            Self::Angular { .. } => "angular",
            Self::Probe { .. } => "probe",
        }
    }

    /// Its channels, in order.
    pub fn channels(&self) -> Vec<Channel> {
        match self {
            Self::Position { directions, angles } => {
                let directions = (0..3).filter(|direction| directions.get(*direction) == Some(&true));
                directions.map(Channel::Measured).chain(angles.iter().copied().map(Channel::Angle)).collect()
            }
            _ => vec![Channel::Deviation],
        }
    }

    /// Whether it reads angles.
    pub fn angular(&self) -> bool {
        match self {
            Self::Position { directions, .. } => *directions == [false; 3],
            Self::Angular { .. } => true,
            _ => false,
        }
    }

    /// Whether it measures points of a part.
    pub(crate) fn measures_parts(&self) -> bool {
        match self {
            Self::Position { directions, .. } => *directions != [false; 3],
            Self::Probe { .. } => true,
            _ => false,
        }
    }

    /// Whether it takes its centre or radius from the path's circle.
    pub(crate) fn needs_circle(&self) -> bool {
        matches!(
            self,
            Self::Ballbar { center: None, .. }
                | Self::Ballbar { radius: None, .. }
                | Self::Probe { normal: Normal::Radial(None) }
        )
    }

    /// The same instrument with what the path's circle says filled in.
    pub(crate) fn resolved(&self, circle: Option<([f64; 3], f64, [bool; 3])>) -> Self {
        let mut resolved = self.clone();
        match (&mut resolved, circle) {
            (Self::Ballbar { center, radius, .. }, Some((middle, size, _))) => {
                center.get_or_insert(middle);
                radius.get_or_insert(size);
            }
            (Self::Probe { normal: Normal::Radial(center @ None) }, Some((middle, _, plane))) => {
                let mut middle = middle;
                let across = middle.iter_mut().zip(plane).filter(|(_, inside)| !inside);
                across.for_each(|(entry, _)| *entry = f64::NAN);
                *center = Some(middle);
            }
            _ => {}
        }
        resolved
    }

    /// One reading.
    pub(crate) fn read(&self, channel: Channel, plant: &Plant, seen: &Seen<'_>) -> f64 {
        match (self, channel) {
            (_, Channel::Measured(direction)) => seen.pose.tip.get(direction).copied().unwrap_or(f64::NAN),
            (_, Channel::Angle(axis)) => angle(plant, axis, seen),
            (Self::Ballbar { center, radius, eccentricity, offset }, _) => {
                let center = Vector3::from(center.unwrap_or([f64::NAN; 3])) + Vector3::from(*eccentricity);
                (seen.pose.tip - center).norm() - radius.unwrap_or(f64::NAN) + offset
            }
            (Self::Linear { direction, cosine, .. }, _) => {
                let direction = Vector3::from(*direction);
                let length = direction.dot(&(seen.pose.tip - seen.start));
                cosine.cos() * length - direction.dot(&(seen.nominal.tip - seen.start))
            }
            (Self::Straightness { direction, .. }, _) => {
                Vector3::from(*direction).dot(&(seen.pose.tip - seen.nominal.tip))
            }
            (Self::Angular { about, .. }, _) => Vector3::from(*about).dot(&turned(seen)),
            (Self::Probe { normal }, _) => {
                normal.at(seen.nominal.tip).dot(&(seen.pose.tip - seen.nominal.tip))
            }
            (Self::Position { .. }, Channel::Deviation) => f64::NAN,
        }
    }
}

impl Normal {
    /// The unit vector at a nominal tip; zero at the centre itself.
    pub fn at(&self, tip: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Fixed(direction) => Vector3::from(*direction),
            Self::Radial(center) => {
                let away = tip - Vector3::from(center.unwrap_or([f64::NAN; 3]));
                let away = away.map(|entry| if entry.is_nan() { 0.0 } else { entry });
                away.try_normalize(0.0).unwrap_or_default()
            }
        }
    }
}

/// How the tool is turned against how it would be without errors: a rotation vector in the part's frame, rad.
fn turned(seen: &Seen<'_>) -> Vector3<f64> {
    rotation_vector(&(seen.pose.turn * seen.nominal.turn.inverse()))
}

/// The rotation vector of a rotation by less than half a turn, with full precision for the smallest angles: the skew part
/// of the matrix has the length of the sine.
fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let matrix = rotation.matrix();
    let skew = 0.5 * (matrix - matrix.transpose());
    let sine = Vector3::new(skew.m32, skew.m13, skew.m21);
    let length = sine.norm();
    if length > 0.0 { sine * (length.atan2(0.5 * (matrix.trace() - 1.0)) / length) } else { sine }
}

/// The angle of a rotary axis in the sense of its command.
fn angle(plant: &Plant, axis: usize, seen: &Seen<'_>) -> f64 {
    let command = seen.positions.get(axis).copied().unwrap_or(f64::NAN);
    let about = plant.turning_direction(axis, seen.positions);
    about.map_or(f64::NAN, |about| command + about.dot(&turned(seen)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_vectors_keep_small_angles_and_large_ones() {
        for length in [1e-12, 1e-6, 0.3, 2.0, 3.1] {
            let vector = Vector3::new(0.36, 0.48, -0.8) * length;
            let found = rotation_vector(&Rotation3::from_scaled_axis(vector));
            assert!((found - vector).norm() < 1e-15 + 1e-13 * length, "{length}");
        }
        assert_eq!(rotation_vector(&Rotation3::identity()), Vector3::zeros());
    }

    #[test]
    fn normals_of_a_ring_lie_in_its_plane() {
        let ring = Normal::Radial(Some([10.0, 20.0, f64::NAN]));
        assert_eq!(ring.at(Vector3::new(13.0, 24.0, 7.0)), Vector3::new(0.6, 0.8, 0.0));
        assert_eq!(ring.at(Vector3::new(10.0, 20.0, 7.0)), Vector3::zeros());
    }

    #[test]
    fn the_path_fills_in_what_is_left_out() {
        let ballbar =
            Instrument::Ballbar { center: None, radius: Some(99.0), eccentricity: [0.0; 3], offset: 0.0 };
        let resolved = ballbar.resolved(Some(([1.0, 2.0, 3.0], 100.0, [true, true, false])));
        assert!(matches!(
            resolved,
            Instrument::Ballbar { center: Some(center), radius: Some(radius), .. }
                if center == [1.0, 2.0, 3.0] && radius == 99.0
        ));
    }
}
