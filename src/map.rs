//! The map of `abbe compensate --map`: the predicted error as arrows over the workspace. In: a calibrated machine and the
//! positions that were read. Out: one SVG drawing.
//!
//! The arrows are the first-order error of the tool tip relative to the part, actual minus commanded, with every axis at rest
//! after a motion forward, at the temperatures of the last row.

mod drawing;
mod space;

use abbe_runtime::{Compensator, Kinematics};
use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;

use space::Space;
use workshop::failure::Failure;
use workshop::rows::field::Field;

/// What a map is drawn from.
pub(crate) struct Map<'m> {
    equations: &'m Equations,
    space: Space,
    temperature: Vec<f64>,
    rows: u64,
}

impl<'m> Map<'m> {
    /// The map of a machine before any row was read.
    pub(crate) fn new(equations: &'m Equations, calibration: &Calibration) -> Self {
        Self { equations, space: Space::new(equations, calibration), temperature: Vec::new(), rows: 0 }
    }

    /// Takes a row that was read: the position of each axis and the temperature of each sensor.
    pub(crate) fn take(&mut self, position: &[f64], temperature: Vec<f64>) {
        self.space.take(position);
        self.temperature = temperature;
        self.rows += 1;
    }

    /// The drawing as a file of its own.
    pub(crate) fn draw<K: Kinematics + ?Sized>(
        &self,
        compensator: &mut Compensator<'_, K>,
    ) -> Result<String, Failure> {
        if self.rows == 0 && compensator.sensors() > 0 {
            return Err(Failure::no(
                "error: cannot draw a map: the calibration reads temperatures, but no row has them"
                    .to_owned(),
            ));
        }
        let slides = self.space.slides(self.equations);
        if slides.is_empty() {
            return Err(Failure::no(
                "error: cannot draw a map: no slide has a table in the calibration or two positions on standard input\n\
                 help: give two opposite corners of the workspace as rows"
                    .to_owned(),
            ));
        }
        let mut field =
            Field::new(compensator, self.equations.following(), self.space.middle(), &self.temperature);
        Ok(drawing::draw(self.equations, &self.space, &slides, &mut field))
    }
}
