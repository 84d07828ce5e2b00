//! Set-ups: how each part lay where it was measured.
//!
//! In: a recording, and the readings of one of its runs. Out: a [`Setup`]: where the recording says that the datum is free, how the part
//! lies ([`recording::PartPose`]); where it does not say so and a rotation explains the readings, that. After the solution: the [`Rotation`] of
//! each part that turned. A part is turned before anything is solved, so that what is solved for is of first order, however it was clamped.

use nalgebra::{DMatrix, DVector};
use recording::{Instrument, PartDatum, PartPose, PartReading, Recording, Turned, turned};

use crate::points::{Point, Points};
use crate::solution::Solution;

/// One set-up: one run of one recording.
#[derive(Clone, Debug)]
pub(crate) struct Setup {
    /// The recording, by its place among those given.
    pub(crate) recording: usize,
    /// The run.
    pub(crate) run: i64,
    /// How the part lies, where its datum is free.
    pub(crate) pose: Option<PartPose>,
    /// A rotation that nobody has spoken of.
    pub(crate) turned: Option<Turned>,
}

/// How a part was found to be turned where it was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Rotation {
    /// The recording's file.
    pub file: String,
    /// Its run.
    pub run: i64,
    /// What it is about: `X`, `Y` or `Z` of the part's frame.
    pub about: &'static str,
    /// The angle, right-handed, rad.
    pub angle: f64,
    /// Its standard uncertainty, rad; none where no reading is left to tell the noise.
    pub uncertainty: Option<f64>,
}

impl Setup {
    pub(crate) fn of(recording: &Recording, (number, run): (usize, i64), readings: &[PartReading]) -> Self {
        let free = recording.datum == PartDatum::Free;
        // Readings along normals show what the surface is, and it is not known how far along it they lie.
        let plain = recording.datum == PartDatum::Unsaid && recording.instrument == Instrument::Position;
        Self {
            recording: number,
            run,
            pose: free.then(|| PartPose::of(readings, false)),
            turned: if plain { turned(readings) } else { None },
        }
    }
}

/// What is free in one set-up: for each effect what it makes of the readings of that set-up.
pub(crate) fn effects(point: &Point, setup: &Setup, directions: [bool; 3]) -> Vec<f64> {
    let displaced = point.direction.iter().zip(directions);
    let displaced = displaced.filter(|(_, free)| *free).map(|(component, _)| *component);
    let rotations = setup.pose.map_or([false; 3], |pose| pose.rotations);
    let turned = point.levers.iter().zip(rotations).filter(|(_, seen)| *seen).map(|(lever, _)| *lever);
    displaced.chain(turned).collect()
}

/// The rotations of the parts whose datum is free, with what the solution leaves of them.
pub(crate) fn rotations(
    all: &Points,
    fitted: &[&Point],
    solution: &Solution,
    directions: [bool; 3],
) -> Vec<Rotation> {
    let mut found = Vec::new();
    for (number, setup) in all.setups.iter().enumerate() {
        let own: Vec<&Point> = fitted.iter().copied().filter(|point| point.setup == number).collect();
        let (Some(pose), false) = (setup.pose, own.is_empty()) else { continue };
        let axes: Vec<usize> = (0..3).filter(|axis| pose.rotations.get(*axis) == Some(&true)).collect();
        let Some(rest) = Rest::of(&own, setup, solution, directions) else { continue };
        let first = rest.effects - axes.len();
        let mut more = [0.0; 3];
        for (place, axis) in axes.iter().enumerate() {
            if let Some(slot) = more.get_mut(*axis) {
                *slot = rest.amount(first + place);
            }
        }
        let angles = pose.rotation_after(more);
        for (place, axis) in axes.iter().enumerate() {
            found.push(Rotation {
                file: all.parts.get(setup.recording).map_or(String::new(), |part| part.file.clone()),
                run: setup.run,
                about: ["X", "Y", "Z"].get(*axis).copied().unwrap_or("?"),
                angle: angles.get(*axis).copied().unwrap_or(f64::NAN),
                uncertainty: rest.uncertainty(first + place, solution),
            });
        }
    }
    found
}

/// What the solution leaves of one set-up, and what is free in it.
struct Rest {
    effects: usize,
    /// What least squares make each effect, from the readings.
    inverse: DMatrix<f64>,
    /// What each coefficient makes of the readings.
    shares: DMatrix<f64>,
    left: DVector<f64>,
}

impl Rest {
    fn of(own: &[&Point], setup: &Setup, solution: &Solution, directions: [bool; 3]) -> Option<Self> {
        let columns: Vec<Vec<f64>> = own.iter().map(|point| effects(point, setup, directions)).collect();
        let effects = columns.first().map_or(0, Vec::len);
        let at = |row: &[f64], column: usize| row.get(column).copied().unwrap_or(0.0);
        let free = DMatrix::from_fn(own.len(), effects, |row, column| {
            columns.get(row).map_or(0.0, |effects| at(effects, column))
        });
        let shares = DMatrix::from_fn(own.len(), solution.change.len(), |row, column| {
            own.get(row).map_or(0.0, |point| at(&point.shares, column))
        });
        let read = own.iter().map(|point| point.deviation - point.expected);
        let left = DVector::from_iterator(own.len(), read) - &shares * &solution.change;
        let inverse = free.pseudo_inverse(f64::EPSILON).ok()?;
        Some(Self { effects, inverse, shares, left })
    }

    fn amount(&self, effect: usize) -> f64 {
        (self.inverse.row(effect) * &self.left).sum()
    }

    /// The standard uncertainty of an effect: that of the readings, and that of the coefficients, which are free of what a set-up can
    /// make.
    fn uncertainty(&self, effect: usize, solution: &Solution) -> Option<f64> {
        let row = self.inverse.row(effect);
        let by_coefficients = row * &self.shares * solution.root.as_ref()?;
        Some((row.norm() * solution.noise?).hypot(by_coefficients.norm()))
    }
}
