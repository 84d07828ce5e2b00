//! Recordings as files.
//!
//! In: a simulated recording and the names that its head mentions. Out: the text of `recording.yaml` and the table of
//! `data.csv`; whoever calls writes the files. Numbers have nine decimal places, trailing zeros left out: a picometre in mm,
//! far below a micro-arcsecond in degrees.

use std::fmt::Write as _;
use std::io::{self, BufWriter, Write};

use model_dsl::calibration::AxisName;
use model_dsl::quoted;

use crate::instrument::{Channel, Instrument};
use crate::simulate::{Simulated, channel_name};

/// What the head of a recording names besides its columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Head {
    /// The machine: a shipped machine's name, a path from the recording's folder, or a topology word.
    pub machine: String,
    /// The calibration that is known, as a path from the recording's folder.
    pub calibration: Option<String>,
    /// The name of the data file in the recording's folder.
    pub data: String,
    /// The machine's axes.
    pub axes: Vec<AxisName>,
}

/// One channel with its column of the table.
struct Written<'s> {
    channel: String,
    column: String,
    unit: String,
    values: &'s [f64],
    /// Units of the file in one internal unit.
    factor: f64,
}

/// The text of the recording file.
pub fn recording(simulated: &Simulated, head: &Head) -> String {
    let mut text = String::from("recording: 1\n");
    let mut line = |key: &str, value: &str| {
        let _ = writeln!(text, "{key}: {}", scalar(value));
    };
    if let Some(title) = &simulated.title {
        line("title", title);
    }
    line("machine", &head.machine);
    if let Some(calibration) = &head.calibration {
        line("calibration", calibration);
    }
    line("instrument", simulated.instrument.name());
    line("data", &head.data);
    text.push_str("channels:\n  time: {column: t_s, unit: s}\n  run: {column: run}\n");
    for written in columns(simulated, &head.axes) {
        let (channel, column) = (scalar(&written.channel), scalar(&written.column));
        let unit = match written.unit.as_str() {
            "" => String::new(),
            unit => format!(", unit: {}", scalar(unit)),
        };
        let _ = writeln!(text, "  {channel}: {{column: {column}{unit}}}");
    }
    text.push_str(&setup(simulated, &head.axes));
    if !simulated.holdout.is_empty() {
        let runs: Vec<String> = simulated.holdout.iter().map(i64::to_string).collect();
        let _ = writeln!(text, "holdout: {{runs: [{}]}}", runs.join(", "));
    }
    text
}

/// Writes the table.
///
/// # Errors
///
/// What the writer refuses.
pub fn table(simulated: &Simulated, axes: &[AxisName], out: impl Write) -> io::Result<()> {
    let columns = columns(simulated, axes);
    let mut out = BufWriter::new(out);
    let names = columns.iter().map(|written| written.column.as_str());
    writeln!(out, "t_s,run,{}", names.collect::<Vec<_>>().join(","))?;
    let mut line = String::new();
    for (row, (time, run)) in simulated.time.iter().zip(&simulated.run).enumerate() {
        line.clear();
        number(&mut line, *time);
        let _ = write!(line, ",{run}");
        for written in &columns {
            line.push(',');
            number(&mut line, written.values.get(row).map_or(f64::NAN, |value| value * written.factor));
        }
        line.push('\n');
        out.write_all(line.as_bytes())?;
    }
    out.flush()
}

/// The columns after time and run, in order.
fn columns<'s>(simulated: &'s Simulated, axes: &[AxisName]) -> Vec<Written<'s>> {
    let mut columns = Columns::default();
    let letter =
        |axis: usize| axes.get(axis).map_or_else(String::new, |axis| axis.letter.to_ascii_lowercase());
    let turns = |axis: usize| axes.get(axis).is_some_and(|axis| axis.rotary);
    // A motor stands where its axes put it: a recording does not say it twice.
    let is_motor = |axis: usize| axes.get(axis).is_some_and(AxisName::is_motor);
    for (axis, values) in simulated.commands.iter().enumerate().filter(|(axis, _)| !is_motor(*axis)) {
        let letter = letter(axis);
        columns.add(format!("command.{letter}"), &format!("{letter}_cmd"), position(turns(axis)), values);
    }
    for (axis, values) in simulated.actual.iter().enumerate() {
        if let Some(values) = values {
            let letter = letter(axis);
            columns.add(format!("actual.{letter}"), &format!("{letter}_act"), position(turns(axis)), values);
        }
    }
    for reading in &simulated.readings {
        let channel = channel_name(reading.channel, axes);
        let (column, angular) = match reading.channel {
            Channel::Measured(_) => (channel.replace("measured.", "") + "_meas", false),
            Channel::Angle(axis) => (letter(axis) + "_meas", true),
            Channel::Deviation => ("dev".to_owned(), simulated.instrument.angular()),
        };
        // An angular instrument reads a few arcseconds; an axis's angle is in degrees like its command.
        let unit = if reading.channel == Channel::Deviation && angular { ARCSEC } else { position(angular) };
        columns.add(channel, &column, unit, &reading.values);
    }
    for (normals, letter) in simulated.normals.iter().flatten().zip(["x", "y", "z"]) {
        columns.add(format!("normal.{letter}"), &format!("n_{letter}"), ("", 1.0), normals);
    }
    for sensor in &simulated.temperatures {
        let name = &sensor.name;
        columns.add(format!("temperature.{name}"), &format!("T_{name}"), ("degC", 1.0), &sensor.values);
    }
    for load in &simulated.loads {
        let name = &load.name;
        columns.add(format!("load.{name}"), &format!("F_{name}"), (load.unit.as_str(), 1.0), &load.values);
    }
    columns.0
}

/// The unit of an angular instrument.
const ARCSEC: (&str, f64) = ("arcsec", 648_000.0 / std::f64::consts::PI);

fn position(rotary: bool) -> (&'static str, f64) {
    if rotary { ("deg", 180.0 / std::f64::consts::PI) } else { ("mm", 1.0) }
}

#[derive(Default)]
struct Columns<'s>(Vec<Written<'s>>);

impl<'s> Columns<'s> {
    fn add(&mut self, channel: String, column: &str, (unit, factor): (&str, f64), values: &'s [f64]) {
        let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
        let plain: String = column.chars().map(plain).collect();
        let taken =
            |name: &str| name == "t_s" || name == "run" || self.0.iter().any(|known| known.column == name);
        let mut column = plain.clone();
        let mut number = 2;
        while taken(&column) {
            column = format!("{plain}_{number}");
            number += 1;
        }
        self.0.push(Written { channel, column, unit: unit.to_owned(), values, factor });
    }
}

/// The set-up of an instrument, as a line of the recording.
fn setup(simulated: &Simulated, axes: &[AxisName]) -> String {
    let letter = |axis: usize| axes.get(axis).map_or("", |axis| axis.letter.as_str());
    match &simulated.instrument {
        Instrument::Position { .. } | Instrument::Probe { .. } if simulated.free_datum => {
            "setup: {datum: free}\n".to_owned()
        }
        Instrument::Position { .. } | Instrument::Probe { .. } => String::new(),
        Instrument::Ballbar { center, radius, .. } => {
            let lengths = center.unwrap_or_default().map(|entry| format!("{} mm", plain(entry)));
            let radius = plain(radius.unwrap_or_default());
            format!("setup: {{center: [{}], radius: {radius} mm}}\n", lengths.join(", "))
        }
        Instrument::Linear { axis, direction, .. } | Instrument::Straightness { axis, direction } => {
            format!("setup: {{axis: {}, direction: {}}}\n", letter(*axis), direction_of(*direction))
        }
        Instrument::Angular { axis, about } => {
            let axis = axis.map_or_else(String::new, |axis| format!("axis: {}, ", letter(axis)));
            format!("setup: {{{axis}direction: {}}}\n", direction_of(*about))
        }
    }
}

/// A direction as a letter where it is one of the frame's own.
fn direction_of(direction: [f64; 3]) -> String {
    let letters = ["X", "Y", "Z"];
    let along = letters.iter().zip(direction).filter(|(_, entry)| *entry != 0.0).collect::<Vec<_>>();
    match along.as_slice() {
        [(letter, 1.0)] => (**letter).to_owned(),
        [(letter, -1.0)] => format!("-{letter}"),
        _ => format!("[{}]", direction.map(|entry| format!("{entry}")).join(", ")),
    }
}

/// Nine places, without zeros at the end; nothing for a missing value.
fn number(line: &mut String, value: f64) {
    if !value.is_finite() {
        return;
    }
    let start = line.len();
    let _ = write!(line, "{value:.9}");
    let kept = line.trim_end_matches('0').trim_end_matches('.').len().max(start + 1);
    line.truncate(kept);
    if line.get(start..) == Some("-0") {
        line.remove(start);
    }
}

fn plain(value: f64) -> String {
    let mut text = String::new();
    number(&mut text, value);
    text
}

/// A word as YAML takes it back: plain where that is safe, quoted elsewhere.
fn scalar(text: &str) -> String {
    let safe = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '.' | '_' | '/' | '-' | ' ');
    let starts = |letter: char| letter.is_ascii_alphabetic() || matches!(letter, '.' | '_' | '/');
    let word = !matches!(text.to_ascii_lowercase().as_str(), "null" | "true" | "false" | "yes" | "no");
    if word && text.starts_with(starts) && text.chars().all(safe) && !text.ends_with(' ') {
        return text.to_owned();
    }
    quoted(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use model_dsl::{diagnostic::Diagnostics, source::SourceFile, yaml};

    #[test]
    fn numbers_are_short_and_keep_their_sign() {
        for (value, text) in [
            (0.0, "0"),
            (-1e-12, "0"),
            (-0.25, "-0.25"),
            (100.0, "100"),
            (332.9363, "332.9363"),
            (-1e-9, "-0.000000001"),
            (f64::NAN, ""),
        ] {
            assert_eq!(plain(value), text);
        }
        let mut line = "100".to_owned();
        number(&mut line, 0.0);
        assert_eq!(line, "1000", "what stood before is left alone");
    }

    #[test]
    fn yaml_takes_every_word_back() {
        for text in
            ["plain words", "a: b", "12 mm", "# no", "say \"\\\" \u{7}\u{b5}m", "", "- x", "null", "%"]
        {
            let source = SourceFile::new("test", format!("key: {}\n", scalar(text)));
            let tree = yaml::read(&source, &mut Diagnostics::new()).unwrap();
            assert_eq!(tree.get("key").and_then(|node| node.text()), Some(text));
        }
    }
}
