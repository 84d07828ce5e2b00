//! The error at a place. In: a compensator and a place. Out: the error there, of a machine that came forward and stands.

use abbe_runtime::{Compensator, Direction, Kinematics, Sample};

/// The predicted error over positions.
pub struct Field<'f, 'c, K: Kinematics + ?Sized> {
    compensator: &'f mut Compensator<'c, K>,
    /// Where the axes stand that are not moved.
    pub middle: Vec<f64>,
    temperature: &'f [f64],
    direction: Vec<Direction>,
    velocity: Vec<f64>,
}

impl<'f, 'c, K: Kinematics + ?Sized> Field<'f, 'c, K> {
    /// The error around a place, mm and rad, at temperatures in degC.
    pub fn new(compensator: &'f mut Compensator<'c, K>, middle: Vec<f64>, temperature: &'f [f64]) -> Self {
        let (direction, velocity) = (vec![Direction::Positive; middle.len()], vec![0.0; middle.len()]);
        Self { compensator, middle, temperature, direction, velocity }
    }

    /// The error with some axes moved to places, mm, part frame; nothing where it is not finite.
    pub fn at(&mut self, moved: &[(usize, f64)]) -> Option<[f64; 3]> {
        let mut position = self.middle.clone();
        for (axis, place) in moved {
            *position.get_mut(*axis)? = *place;
        }
        let sample = Sample {
            position: &position,
            travel: &[],
            direction: &self.direction,
            velocity: &self.velocity,
            temperature: self.temperature,
            time_step: 0.0,
        };
        // No place remembers the one before it.
        self.compensator.restart();
        self.compensator.error(&sample).ok()
    }
}
