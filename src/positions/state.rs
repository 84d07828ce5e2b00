//! Rows of text as samples. In: a row of cells and the rows before it. Out: the machine's state as the runtime reads it; or which
//! cell is wrong.

use abbe_runtime::{Direction, Sample};
use csv::ByteRecord;
use model_dsl::calibration::Calibration;
use recording::cells::counted;
use workshop::rows::FARTHEST;
use workshop::{rows, tools};

use super::{Column, Layout};

/// The machine's state, from row to row.
pub(crate) struct State<'s> {
    layout: Layout,
    /// The calibration, which has the tools.
    calibration: &'s Calibration,
    /// The number of the tool in this row; none: the constants of the calibration itself.
    tool: Option<usize>,
    state: rows::State<'s>,
    /// The numbers of the row that is read, in mm, rad, s or degC.
    position: Vec<f64>,
    travel: Vec<f64>,
    direction: Vec<Option<Direction>>,
    temperature: Vec<f64>,
}

impl<'s> State<'s> {
    /// The state before the first row; `hysteresis` is in mm or rad, one for each axis.
    pub(crate) fn new(layout: Layout, timed: bool, calibration: &'s Calibration, hysteresis: &[f64]) -> Self {
        Self {
            calibration,
            tool: None,
            state: rows::State::new(calibration, layout.motors.clone(), timed, hysteresis),
            position: Vec::with_capacity(layout.axes.len()),
            travel: Vec::with_capacity(layout.travels.len()),
            direction: Vec::with_capacity(layout.directions.len()),
            temperature: Vec::with_capacity(layout.sensors.len()),
            layout,
        }
    }

    /// Takes a row; the error names the column and the text that is wrong in it, and the state stays as it was.
    pub(crate) fn take(&mut self, row: &ByteRecord) -> Result<(), String> {
        if row.len() != self.layout.width {
            let hint =
                if row.len() > self.layout.width { "; a decimal comma could be the cause" } else { "" };
            let (cells, columns) = (counted(row.len(), "cell"), counted(self.layout.width, "column"));
            return Err(format!("{cells} for {columns}{hint}"));
        }
        let tool = self.find_tool(row)?;
        let layout = &self.layout;
        read_all(layout, row, &layout.axes, &mut self.position)?;
        let far = layout.axes.iter().zip(&self.position).find(|(_, place)| place.abs() > FARTHEST);
        if let Some((column, _)) = far {
            let name = quoted(name(layout, column.index));
            let text = quoted(text(row, column.index));
            return Err(format!(
                "column `{name}`: `{text}` is farther than any machine reaches; check the unit"
            ));
        }
        read_all(layout, row, &layout.sensors, &mut self.temperature)?;
        let time = layout.time.map(|column| read(layout, row, column)).transpose()?;
        // The layout has all travels or none.
        read_all(layout, row, layout.travels.iter().flatten(), &mut self.travel)?;
        self.direction.clear();
        for index in &layout.directions {
            let told = index.map(|index| direction(text(row, index), name(layout, index))).transpose()?;
            self.direction.push(told);
        }
        self.state.take(&rows::Row {
            position: &self.position,
            travel: &self.travel,
            direction: &self.direction,
            time,
            temperature: &self.temperature,
        })?;
        self.tool = tool;
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
            let help = tools::instead(self.calibration, name);
            format!("column `tool`: the calibration has no tool `{}`; {help}", quoted(name))
        })
    }

    /// The state as the runtime reads it.
    pub(crate) fn sample(&self) -> Sample<'_> {
        self.state.sample()
    }
}

/// Reads the numbers of some columns, in their order.
fn read_all<'c>(
    layout: &Layout,
    row: &ByteRecord,
    columns: impl IntoIterator<Item = &'c Column>,
    numbers: &mut Vec<f64>,
) -> Result<(), String> {
    numbers.clear();
    for column in columns {
        numbers.push(read(layout, row, *column)?);
    }
    Ok(())
}

fn name(layout: &Layout, index: usize) -> &str {
    layout.header.get(index).map_or("", String::as_str)
}

fn read(layout: &Layout, row: &ByteRecord, column: Column) -> Result<f64, String> {
    let text = text(row, column.index);
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok((value + column.offset) * column.factor),
        _ => {
            let hint = if text.contains(',') { "; write a decimal point" } else { "" };
            let name = quoted(name(layout, column.index));
            Err(format!("column `{name}`: `{}` is not a number{hint}", quoted(text)))
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
