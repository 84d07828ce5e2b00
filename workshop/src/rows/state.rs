//! The state of a machine from row to row. In: the numbers of a row. Out: positions, directions, velocities, temperatures and the time
//! step as the runtime reads them.

use std::iter;

use abbe_runtime::{Direction, DirectionTracker, Sample, Share, place_motors};
use model_dsl::calibration::{Calibration, SensorReadings};

/// No machine reaches farther, mm or rad: a thousand kilometres. What is beyond it is no position, and its last digits are coarser than a
/// nanometre.
pub const FARTHEST: f64 = 1e9;

/// The numbers of a row: mm, rad, s, degC.
#[derive(Clone, Copy, Debug)]
pub struct Row<'r> {
    /// The position of each axis that a program moves; motors stand where these put them.
    pub position: &'r [f64],
    /// Each free travel; empty where the positions stand for them.
    pub travel: &'r [f64],
    /// The direction in which each axis came, where the row tells.
    pub direction: &'r [Option<Direction>],
    /// The time, where the row tells.
    pub time: Option<f64>,
    /// The temperature of each sensor that the calibration reads, in the order of
    /// [`Sensors::inputs`](model_dsl::calibration::Sensors::inputs).
    pub temperature: &'r [f64],
}

/// The machine's state, from row to row.
pub struct State<'s> {
    /// Whether a term needs to know how fast the axes move.
    timed: bool,
    sensors: SensorReadings<'s>,
    /// The number of each sensor that rows give.
    numbers: Vec<usize>,
    /// For each sensor its input in this row; NaN where it has none.
    inputs: Vec<f64>,
    trackers: Vec<DirectionTracker>,
    motors: Vec<Share>,
    previous: Option<(f64, Vec<f64>)>,
    position: Vec<f64>,
    travel: Vec<f64>,
    direction: Vec<Direction>,
    velocity: Vec<f64>,
    temperature: Vec<f64>,
    time_step: f64,
}

impl<'s> State<'s> {
    /// The state before the first row. `timed`: whether a term needs the time ([`timed`](super::timed)). An axis has turned when it has
    /// moved back by its `hysteresis`, mm or rad, one for each axis, motors among them.
    pub fn new(calibration: &'s Calibration, motors: Vec<Share>, timed: bool, hysteresis: &[f64]) -> Self {
        let sensors = &calibration.sensors;
        let axes = hysteresis.len();
        Self {
            timed,
            sensors: SensorReadings::of_terms(sensors),
            numbers: sensors.inputs().map(|(number, _)| number).collect(),
            inputs: vec![f64::NAN; sensors.len()],
            trackers: hysteresis.iter().map(|threshold| DirectionTracker::new(*threshold)).collect(),
            motors,
            previous: None,
            position: vec![0.0; axes],
            travel: Vec::new(),
            direction: vec![Direction::default(); axes],
            velocity: vec![0.0; axes],
            temperature: vec![f64::NAN; sensors.len()],
            time_step: 0.0,
        }
    }

    /// Takes a row.
    ///
    /// # Errors
    ///
    /// Says why the time of the row cannot be; the state then stays as it was.
    pub fn take(&mut self, row: &Row<'_>) -> Result<(), String> {
        self.check_time(row)?;
        self.position.iter_mut().zip(row.position).for_each(|(slot, place)| *slot = *place);
        place_motors(&self.motors, &mut self.position);
        self.travel.clear();
        self.travel.extend_from_slice(row.travel);
        let axes = self.direction.iter_mut().zip(&mut self.trackers).zip(&self.position);
        for (((slot, tracker), place), told) in axes.zip(row.direction.iter().chain(iter::repeat(&None))) {
            *slot = told.unwrap_or_else(|| tracker.update(*place));
        }
        self.take_time(row.time);
        self.take_temperatures(row.temperature);
        Ok(())
    }

    /// The state as the runtime reads it.
    pub fn sample(&self) -> Sample<'_> {
        Sample {
            position: &self.position,
            travel: &self.travel,
            direction: &self.direction,
            velocity: &self.velocity,
            temperature: &self.temperature,
            time_step: self.time_step,
        }
    }

    fn check_time(&self, row: &Row<'_>) -> Result<(), String> {
        let (Some(now), Some((before, from))) = (row.time, &self.previous) else { return Ok(()) };
        let step = now - before;
        if step < 0.0 {
            return Err(format!("the time decreases by {} s", -step));
        }
        let moves = row.position.iter().zip(from).any(|(to, from)| to != from);
        if step == 0.0 && moves && self.timed {
            return Err("the axes move while the time does not advance".to_owned());
        }
        Ok(())
    }

    fn take_time(&mut self, now: Option<f64>) {
        let Some(now) = now else { return };
        self.velocity.fill(0.0);
        if let Some((before, from)) = &self.previous {
            self.time_step = now - before;
            if self.time_step > 0.0 {
                let moved = self.position.iter().zip(from).map(|(to, from)| to - from);
                self.velocity.iter_mut().zip(moved).for_each(|(slot, moved)| *slot = moved / self.time_step);
            }
        }
        let mut from = self.previous.take().map(|(_, from)| from).unwrap_or_default();
        from.clone_from(&self.position);
        self.previous = Some((now, from));
    }

    fn take_temperatures(&mut self, temperature: &[f64]) {
        for (number, value) in self.numbers.iter().zip(temperature) {
            if let Some(slot) = self.inputs.get_mut(*number) {
                *slot = *value;
            }
        }
        let all = self.sensors.update(|index| self.inputs.get(index).copied().unwrap_or(f64::NAN));
        self.temperature.copy_from_slice(all);
    }
}
