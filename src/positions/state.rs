//! Rows as samples. In: a row of numbers and the rows before it. Out: the machine's state as
//! the runtime reads it: positions, directions, velocities, temperatures, time.

use abbe_runtime::{Direction, DirectionTracker, Sample};
use csv::ByteRecord;
use model_dsl::calibration::{SensorReadings, Sensors};

use super::{Column, Layout};

/// The machine's state, from row to row.
pub(crate) struct State<'s> {
    layout: Layout,
    /// Whether a term needs to know how fast the axes move.
    timed: bool,
    sensors: SensorReadings<'s>,
    input_columns: Vec<Option<Column>>,
    trackers: Vec<DirectionTracker>,
    previous: Option<(f64, Vec<f64>)>,
    position: Vec<f64>,
    travel: Vec<f64>,
    direction: Vec<Direction>,
    velocity: Vec<f64>,
    temperature: Vec<f64>,
    time_step: f64,
}

impl<'s> State<'s> {
    /// The state before the first row; `hysteresis` is in mm or rad, one for each axis.
    pub(crate) fn new(layout: Layout, timed: bool, sensors: &'s Sensors, hysteresis: &[f64]) -> Self {
        let axes = layout.axes.len();
        let mut input_columns = vec![None; sensors.len()];
        for ((index, _), column) in sensors.inputs().zip(&layout.sensors) {
            if let Some(slot) = input_columns.get_mut(index) {
                *slot = Some(*column);
            }
        }
        Self {
            timed,
            sensors: SensorReadings::new(sensors),
            input_columns,
            trackers: hysteresis.iter().map(|threshold| DirectionTracker::new(*threshold)).collect(),
            previous: None,
            position: vec![0.0; axes],
            travel: Vec::with_capacity(layout.travels.len()),
            direction: vec![Direction::default(); axes],
            velocity: vec![0.0; axes],
            temperature: vec![f64::NAN; sensors.len()],
            time_step: 0.0,
            layout,
        }
    }

    /// The columns of the file.
    pub(crate) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Takes a row; the error names the column and the text that is wrong in it.
    pub(crate) fn take(&mut self, row: &ByteRecord) -> Result<(), String> {
        if row.len() != self.layout.width {
            let hint = if row.len() > self.layout.width { "; a decimal comma would do that" } else { "" };
            return Err(format!("{} cells under {} columns{hint}", row.len(), self.layout.width));
        }
        self.check(row)?;
        self.read_positions(row)?;
        self.read_directions(row)?;
        self.read_time(row)?;
        self.read_temperatures(row)
    }

    /// The state as the runtime reads it.
    pub(crate) fn sample(&self) -> Sample<'_> {
        Sample {
            position: &self.position,
            travel: &self.travel,
            direction: &self.direction,
            velocity: &self.velocity,
            temperature: &self.temperature,
            time_step: self.time_step,
        }
    }

    /// Reads every number of the row once, so that a bad row leaves the state as it was.
    fn check(&self, row: &ByteRecord) -> Result<(), String> {
        let layout = &self.layout;
        let columns = layout.axes.iter().chain(&layout.sensors).chain(&layout.time);
        let travels = layout.travels.iter().flatten();
        columns.chain(travels).try_for_each(|column| self.number(row, *column).map(drop))?;
        for index in layout.directions.iter().flatten() {
            direction(text(row, *index), self.name(*index))?;
        }
        if let (Some(column), Some((before, from))) = (layout.time, &self.previous) {
            let step = self.number(row, column)? - before;
            if step < 0.0 {
                return Err(format!("the time goes back by {} s", -step));
            }
            let mut axes = layout.axes.iter().zip(from);
            let moves = axes.any(|(axis, from)| self.number(row, *axis).is_ok_and(|to| to != *from));
            if step == 0.0 && moves && self.timed {
                return Err("the axes move while the time stands still".to_owned());
            }
        }
        Ok(())
    }

    fn read_positions(&mut self, row: &ByteRecord) -> Result<(), String> {
        for (axis, column) in self.layout.axes.iter().enumerate() {
            self.position[axis] = self.number(row, *column)?;
        }
        self.travel.clear();
        if self.layout.travels.iter().any(Option::is_some) {
            // The layout has all travels or none.
            for column in self.layout.travels.iter().flatten() {
                let travel = self.number(row, *column)?;
                self.travel.push(travel);
            }
        }
        Ok(())
    }

    fn read_directions(&mut self, row: &ByteRecord) -> Result<(), String> {
        for (axis, column) in self.layout.directions.iter().enumerate() {
            self.direction[axis] = match column {
                Some(index) => direction(text(row, *index), self.name(*index))?,
                None => self.trackers[axis].update(self.position[axis]),
            };
        }
        Ok(())
    }

    fn read_time(&mut self, row: &ByteRecord) -> Result<(), String> {
        let Some(column) = self.layout.time else { return Ok(()) };
        let now = self.number(row, column)?;
        self.velocity.fill(0.0);
        if let Some((before, from)) = &self.previous {
            self.time_step = now - before;
            if self.time_step > 0.0 {
                let moved = self.position.iter().zip(from).map(|(to, from)| to - from);
                self.velocity.iter_mut().zip(moved).for_each(|(slot, moved)| *slot = moved / self.time_step);
            }
        }
        self.previous = Some((now, self.position.clone()));
        Ok(())
    }

    fn read_temperatures(&mut self, row: &ByteRecord) -> Result<(), String> {
        let mut inputs = vec![f64::NAN; self.input_columns.len()];
        for (slot, column) in inputs.iter_mut().zip(&self.input_columns) {
            if let Some(column) = column {
                *slot = self.number(row, *column)?;
            }
        }
        let all = self.sensors.update(|index| inputs.get(index).copied().unwrap_or(f64::NAN));
        self.temperature.copy_from_slice(all);
        Ok(())
    }

    fn name(&self, index: usize) -> &str {
        self.layout.header.get(index).map_or("", String::as_str)
    }

    fn number(&self, row: &ByteRecord, column: Column) -> Result<f64, String> {
        let text = text(row, column.index);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok((value + column.offset) * column.factor),
            _ => {
                let hint = if text.contains(',') { "; write a decimal point" } else { "" };
                Err(format!("column `{}`: `{text}` is not a number{hint}", self.name(column.index)))
            }
        }
    }
}

/// A cell as text; what is not UTF-8 is no number and no direction either.
fn text(row: &ByteRecord, index: usize) -> &str {
    let cell = row.get(index).unwrap_or_default();
    std::str::from_utf8(cell).map_or("(not UTF-8)", str::trim)
}

fn direction(text: &str, name: &str) -> Result<Direction, String> {
    match text.trim() {
        "1" | "+1" => Ok(Direction::Positive),
        "-1" => Ok(Direction::Negative),
        other => Err(format!("column `{name}`: `{other}` is not a direction, +1 or -1")),
    }
}
