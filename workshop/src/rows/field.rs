//! The error at a place. In: a compensator and a place. Out: the error there, of a machine that came forward and stands.

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, Kinematics, Sample, Share, TermState, place_motors, states_needed,
};
use model_dsl::calibration::SensorReadings;

use super::table::Wanted;
use super::{Answering, Leaning, Room};
use crate::calibrated::Calibrated;
use crate::failure::Failure;

/// The predicted error over positions.
pub struct Field<'f, 'c, K: Kinematics + ?Sized> {
    compensator: &'f mut Compensator<'c, K>,
    motors: Vec<Share>,
    /// Where the axes stand that are not moved.
    pub middle: Vec<f64>,
    position: Vec<f64>,
    temperature: &'f [f64],
    direction: Vec<Direction>,
    velocity: Vec<f64>,
}

impl<'f, 'c, K: Kinematics + ?Sized> Field<'f, 'c, K> {
    /// The error around a place, mm and rad, at temperatures in degC.
    pub fn new(
        compensator: &'f mut Compensator<'c, K>,
        motors: Vec<Share>,
        middle: Vec<f64>,
        temperature: &'f [f64],
    ) -> Self {
        let (direction, velocity) = (vec![Direction::Positive; middle.len()], vec![0.0; middle.len()]);
        Self { compensator, motors, position: middle.clone(), middle, temperature, direction, velocity }
    }

    /// The error with some axes moved to places, mm, part frame; nothing where it is not finite.
    pub fn at(&mut self, moved: &[(usize, f64)]) -> Option<[f64; 3]> {
        self.position.clone_from(&self.middle);
        for (axis, place) in moved {
            *self.position.get_mut(*axis)? = *place;
        }
        place_motors(&self.motors, &mut self.position);
        // No place remembers the one before it.
        self.compensator.restart();
        let Self { compensator, position, temperature, direction, velocity, .. } = self;
        compensator.error(&standing(position, temperature, direction, velocity)).ok()
    }

    /// The state of the machine at the place that was asked last.
    fn sample(&self) -> Sample<'_> {
        standing(&self.position, self.temperature, &self.direction, &self.velocity)
    }
}

/// A machine that stands.
fn standing<'s>(
    position: &'s [f64],
    temperature: &'s [f64],
    direction: &'s [Direction],
    velocity: &'s [f64],
) -> Sample<'s> {
    Sample { position, travel: &[], direction, velocity, temperature, time_step: 0.0 }
}

/// The errors at places that do not follow each other: at each that of a machine that came forward and stands, in the order of
/// [`error_columns`](super::error_columns), mm and rad; NaN where it is not finite. `middle` is where axes stand that are not moved,
/// `temperature` that of each sensor that is read; `left_out` hears of terms that are left out.
///
/// # Errors
///
/// Terms that cannot be compensated, unless they may be left out.
pub fn errors(
    calibrated: &Calibrated,
    wanted: &Wanted,
    (middle, temperature): (&[f64], &[f64]),
    places: &[[(usize, f64); 2]],
    left_out: &mut dyn FnMut(String),
) -> Result<Vec<Vec<f64>>, Failure> {
    if !wanted.left_out {
        calibrated.refuse_uncompensable()?;
    }
    let terms = calibrated.terms(left_out);
    let motions: Vec<ErrorMotion<'_>> = terms.iter().map(|terms| ErrorMotion { terms }).collect();
    let answering = Answering::new(calibrated, &motions);
    let machine = answering.machine(wanted.tool);
    let equations = &calibrated.equations;
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut room = Room::new(equations);
    let mut compensator = room.compensator(machine, &motions, &mut states)?;
    let mut readings = SensorReadings::of_terms(&calibrated.calibration.sensors);
    let mut inputs = vec![f64::NAN; calibrated.calibration.sensors.len()];
    for ((number, _), value) in calibrated.calibration.sensors.inputs().zip(temperature) {
        if let Some(slot) = inputs.get_mut(number) {
            *slot = *value;
        }
    }
    let temperature = readings.update(|number| inputs.get(number).copied().unwrap_or(f64::NAN)).to_vec();
    let mut field = Field::new(&mut compensator, equations.following(), middle.to_vec(), &temperature);
    let at = |moved: &[(usize, f64); 2]| {
        let error = field.at(moved).unwrap_or([f64::NAN; 3]);
        let tip = equations.rows.iter().filter_map(|row| error.get(row.direction.index()).copied());
        let leaning = Leaning::new(equations, &motions);
        let lean = leaning.map(|mut leaning| leaning.take(machine, &field.sample()).without);
        tip.chain(lean.into_iter().flatten()).collect()
    };
    Ok(places.iter().map(at).collect())
}
