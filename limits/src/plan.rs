//! The limits of a path that was not driven yet. In: a machine, a path with its instrument and an assumed noise. Out: recordings of the
//! machine as it is known, one for each of several noises, of which [`limits`](crate::limits::limits) can be asked.

use model_dsl::Compiled;
use model_dsl::calibration::Calibration;
use simulation::{Plant, Scenario, simulate};

use crate::injection::base::Base;
use crate::made;
use crate::trial::Known;

/// So many noises are drawn: what is found in nine of ten must not rest on one of them.
pub const NOISES: u64 = 5;

/// Drives a path on the machine as it is known, under several noises.
///
/// # Errors
///
/// Why it cannot be driven or read.
pub fn driven(
    name: &str,
    compiled: &Compiled,
    calibration: &Calibration,
    (plant, scenario): (&Plant, &Scenario),
) -> Result<Vec<Known>, String> {
    (0..NOISES)
        .map(|noise| {
            let mut scenario = scenario.clone();
            scenario.measurement.seed = scenario.measurement.seed.wrapping_add(noise);
            let simulated = simulate(plant, &scenario).map_err(|error| error.to_string())?;
            let recording = made::recording(simulated, name)
                .ok_or_else(|| "the instrument needs the circle of the path".to_owned())?;
            let base = Base::new(name, compiled.clone(), Some(calibration.clone()), recording)?;
            Known::new(base)
        })
        .collect()
}
