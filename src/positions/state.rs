//! Rows as samples. In: a row of numbers and the rows before it. Out: the machine's state as
//! the runtime reads it: positions, directions, velocities, temperatures, time.

use abbe_runtime::{Direction, DirectionTracker, Sample};
use csv::ByteRecord;
use model_dsl::calibration::{Calibration, SensorReadings};
use model_dsl::suggest::nearest;

use super::{Column, Layout};

/// The most tools that a message lists: more than a line of a terminal are not read.
const MOST_TOOLS_TOLD: usize = 10;

/// The machine's state, from row to row.
pub(crate) struct State<'s> {
    layout: Layout,
    /// Whether a term needs to know how fast the axes move.
    timed: bool,
    /// The calibration, which has the tools.
    calibration: &'s Calibration,
    /// The number of the tool in this row; none: the constants of the calibration itself.
    tool: Option<usize>,
    sensors: SensorReadings<'s>,
    input_columns: Vec<Option<Column>>,
    /// For each column that is read its number in this row, in mm, rad, s or degC.
    numbers: Vec<f64>,
    /// For each sensor its input in this row; NaN where it has none.
    inputs: Vec<f64>,
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
    pub(crate) fn new(layout: Layout, timed: bool, calibration: &'s Calibration, hysteresis: &[f64]) -> Self {
        let sensors = &calibration.sensors;
        let axes = layout.all_axes;
        let mut input_columns = vec![None; sensors.len()];
        for ((index, _), column) in sensors.inputs().zip(&layout.sensors) {
            if let Some(slot) = input_columns.get_mut(index) {
                *slot = Some(*column);
            }
        }
        Self {
            timed,
            calibration,
            tool: None,
            sensors: SensorReadings::of_terms(sensors),
            input_columns,
            numbers: vec![f64::NAN; layout.width],
            inputs: vec![f64::NAN; sensors.len()],
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

    /// Takes a row; the error names the column and the text that is wrong in it.
    pub(crate) fn take(&mut self, row: &ByteRecord) -> Result<(), String> {
        if row.len() != self.layout.width {
            let hint = if row.len() > self.layout.width { "; a decimal comma would do that" } else { "" };
            return Err(format!("{} cells under {} columns{hint}", row.len(), self.layout.width));
        }
        let tool = self.find_tool(row)?;
        self.check(row)?;
        self.tool = tool;
        self.read_positions();
        self.read_directions(row)?;
        self.read_time();
        self.read_temperatures();
        Ok(())
    }

    /// The number of the tool in the row that was taken last; none: the constants of the calibration itself.
    pub(crate) fn tool(&self) -> Option<usize> {
        self.tool
    }

    /// The tool that a row names; an empty cell names none.
    fn find_tool(&self, row: &ByteRecord) -> Result<Option<usize>, String> {
        let Some(index) = self.layout.tool else { return Ok(None) };
        let name = text(row, index);
        if name.is_empty() {
            return Ok(None);
        }
        let found = self.calibration.tool(name);
        found.map(Some).ok_or_else(|| {
            let tools = || self.calibration.tools.iter().map(|tool| tool.name.value.as_str());
            let help = match nearest(name, tools()) {
                Some(near) => format!("is it `{near}`?"),
                None => format!("there are {}", tools().take(MOST_TOOLS_TOLD).collect::<Vec<_>>().join(", ")),
            };
            format!("column `tool`: the calibration has no tool `{}`; {help}", quoted(name))
        })
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

    /// Reads every number of the row before any is used, so that a bad row leaves the state as it was.
    fn check(&mut self, row: &ByteRecord) -> Result<(), String> {
        let layout = &self.layout;
        let columns = layout.axes.iter().chain(&layout.sensors).chain(&layout.time);
        for column in columns.chain(layout.travels.iter().flatten()) {
            self.numbers[column.index] = self.read(row, *column)?;
        }
        for index in layout.directions.iter().flatten() {
            direction(text(row, *index), self.name(*index))?;
        }
        if let (Some(column), Some((before, from))) = (layout.time, &self.previous) {
            let step = self.number(column) - before;
            if step < 0.0 {
                return Err(format!("the time goes back by {} s", -step));
            }
            let mut axes = layout.axes.iter().zip(from);
            let moves = axes.any(|(axis, from)| self.number(*axis) != *from);
            if step == 0.0 && moves && self.timed {
                return Err("the axes move while the time stands still".to_owned());
            }
        }
        Ok(())
    }

    fn read_positions(&mut self) {
        for (axis, column) in self.layout.axes.iter().enumerate() {
            self.position[axis] = self.number(*column);
        }
        self.layout.motors.iter().for_each(|share| self.position[share.motor] = 0.0);
        for share in &self.layout.motors {
            self.position[share.motor] += share.weight * self.position[share.of];
        }
        self.travel.clear();
        if self.layout.travels.iter().any(Option::is_some) {
            // The layout has all travels or none.
            for column in self.layout.travels.iter().flatten() {
                let travel = self.number(*column);
                self.travel.push(travel);
            }
        }
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

    fn read_time(&mut self) {
        let Some(column) = self.layout.time else { return };
        let now = self.number(column);
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

    fn read_temperatures(&mut self) {
        for (slot, column) in self.inputs.iter_mut().zip(&self.input_columns) {
            if let Some(column) = column {
                *slot = self.numbers[column.index];
            }
        }
        let all = self.sensors.update(|index| self.inputs.get(index).copied().unwrap_or(f64::NAN));
        self.temperature.copy_from_slice(all);
    }

    /// The number of a column in the row that was checked last.
    fn number(&self, column: Column) -> f64 {
        self.numbers[column.index]
    }

    fn name(&self, index: usize) -> &str {
        self.layout.header.get(index).map_or("", String::as_str)
    }

    fn read(&self, row: &ByteRecord, column: Column) -> Result<f64, String> {
        let text = text(row, column.index);
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok((value + column.offset) * column.factor),
            _ => {
                let hint = if text.contains(',') { "; write a decimal point" } else { "" };
                let name = quoted(self.name(column.index));
                Err(format!("column `{name}`: `{}` is not a number{hint}", quoted(text)))
            }
        }
    }
}

/// Text of the input for a message: as much of it as a person reads, and nothing that steers a terminal.
pub(crate) fn quoted(text: &str) -> String {
    const MOST: usize = 40;
    let plain = |letter: char| if letter.is_control() { '\u{fffd}' } else { letter };
    let mut quoted: String = text.chars().take(MOST).map(plain).collect();
    if text.chars().nth(MOST).is_some() {
        quoted.push('\u{2026}');
    }
    quoted
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
        other => Err(format!("column `{}`: `{}` is not a direction, +1 or -1", quoted(name), quoted(other))),
    }
}
