//! The error at a place. In: a compensator and a place. Out: the error there, of a machine that came forward and stands.

use abbe_runtime::{
    Compensator, Direction, ErrorMotion, Kinematics, Sample, Share, TermState, Work, states_needed,
};
use model_dsl::calibration::SensorReadings;

use super::Leaning;
use super::state::place_motors;
use super::table::Wanted;
use crate::calibrated::Calibrated;
use crate::failure::Failure;

/// The predicted error over positions.
pub struct Field<'f, 'c, K: Kinematics + ?Sized> {
    compensator: &'f mut Compensator<'c, K>,
    motors: Vec<Share>,
    /// Where the axes stand that are not moved.
    pub middle: Vec<f64>,
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
        Self { compensator, motors, middle, temperature, direction, velocity }
    }

    /// The error with some axes moved to places, mm, part frame; nothing where it is not finite.
    pub fn at(&mut self, moved: &[(usize, f64)]) -> Option<[f64; 3]> {
        let mut position = self.middle.clone();
        for (axis, place) in moved {
            *position.get_mut(*axis)? = *place;
        }
        place_motors(&self.motors, &mut position);
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
    let machine = wanted.machine(calibrated);
    let equations = &calibrated.equations;
    let mut states = vec![TermState::default(); states_needed(&motions)];
    let mut directions = vec![[0.0; 3]; equations.axes.len()];
    let (mut values, mut travel) = (vec![0.0; equations.motions.len()], vec![0.0; equations.travels.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work)
        .map_err(|error| Failure::wrong(format!("error: the calibration cannot be run: {error}")))?;
    let mut readings = SensorReadings::of_terms(&calibrated.calibration.sensors);
    let mut inputs = vec![f64::NAN; calibrated.calibration.sensors.len()];
    for ((number, _), value) in calibrated.calibration.sensors.inputs().zip(temperature) {
        if let Some(slot) = inputs.get_mut(number) {
            *slot = *value;
        }
    }
    let temperature = readings.update(|number| inputs.get(number).copied().unwrap_or(f64::NAN)).to_vec();
    let (direction, velocity) = (vec![Direction::Positive; middle.len()], vec![0.0; middle.len()]);
    let mut position = middle.to_vec();
    let motors = equations.following();
    let at = |moved: &[(usize, f64); 2]| {
        for (axis, place) in moved {
            if let Some(slot) = position.get_mut(*axis) {
                *slot = *place;
            }
        }
        place_motors(&motors, &mut position);
        let sample = Sample {
            position: &position,
            travel: &[],
            direction: &direction,
            velocity: &velocity,
            temperature: &temperature,
            time_step: 0.0,
        };
        // No place remembers the one before it.
        compensator.restart();
        let error = compensator.error(&sample).unwrap_or([f64::NAN; 3]);
        let tip = equations.rows.iter().filter_map(|row| error.get(row.direction.index()).copied());
        let lean =
            Leaning::new(equations, &machine, &motions).map(|mut leaning| leaning.take(&sample).without);
        tip.chain(lean.into_iter().flatten()).collect()
    };
    Ok(places.iter().map(at).collect())
}
