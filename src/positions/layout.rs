//! Columns of a CSV file of positions. In: the header, and the row of units where there is
//! one. Out: the place and the scale of every quantity that the machine needs.

use std::collections::BTreeSet;

use abbe_runtime::Share;
use csv::ByteRecord;
use model_dsl::equations::Equations;
use model_dsl::quantity::{Dimension, parse_unit, unit_in_name};
use model_dsl::suggest::{is_slip, nearest};
use recording::cells::numbers_of_units;
use workshop::rows::output_columns;

use super::state::quoted;

/// What the machine and its calibration need from a row.
pub(crate) struct Wanted<'a> {
    /// The machine's equations: its axes and travels.
    pub(crate) equations: &'a Equations,
    /// The names of the sensors that come from columns.
    pub(crate) sensors: Vec<&'a str>,
    /// Why a time is needed, where one is.
    pub(crate) time: Option<String>,
    /// Whether anything reads a time that is there.
    pub(crate) timed: bool,
    /// Whether a column may name the tool of each row.
    pub(crate) tools: bool,
}

/// One column that is read.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    /// Its number in the row.
    pub(crate) index: usize,
    /// From the number written to mm, rad, s or degC.
    pub(crate) factor: f64,
    /// Added to the number before it is scaled.
    pub(crate) offset: f64,
}

/// Where everything stands in a row.
#[derive(Debug)]
pub(crate) struct Layout {
    /// The number of cells of a row.
    pub(crate) width: usize,
    /// The position of each axis that a program moves.
    pub(crate) axes: Vec<Column>,
    /// The motors, which stand where these put them.
    pub(crate) motors: Vec<Share>,
    /// The direction of each axis, where the file gives it.
    pub(crate) directions: Vec<Option<usize>>,
    /// Each free travel, where the file gives it.
    pub(crate) travels: Vec<Option<Column>>,
    /// The temperature of each sensor wanted, in degC.
    pub(crate) sensors: Vec<Column>,
    /// The time.
    pub(crate) time: Option<Column>,
    /// The name of the tool, where the file gives it.
    pub(crate) tool: Option<usize>,
    /// The header's cells.
    pub(crate) header: Vec<String>,
    /// The units written, one a column, where the file has a row of them.
    pub(crate) units: Option<Vec<String>>,
    /// Columns that nothing reads.
    pub(crate) unread: Vec<String>,
}

struct Reader<'a> {
    /// The header's cells, as they are written.
    header: Vec<String>,
    /// The names of the columns: a unit in brackets behind a name, as in `x [mm]`, is no part of it.
    names: Vec<String>,
    /// These units.
    units_of_names: Vec<Option<String>>,
    units: Option<Vec<String>>,
    read: Vec<bool>,
    mistakes: Vec<String>,
    wanted: &'a Wanted<'a>,
}

impl Layout {
    /// Reads the header and the units; every mistake is told.
    pub(crate) fn read(
        header: &ByteRecord,
        units: Option<&[String]>,
        wanted: &Wanted<'_>,
    ) -> Result<Self, Vec<String>> {
        let header: Vec<String> = header.iter().map(written).collect();
        let units =
            units.map(|units| unit_row(units, header.len())).transpose().map_err(|mistake| vec![mistake])?;
        if let [line] = header.as_slice()
            && named(line).0.split_whitespace().nth(1).is_some()
        {
            return Err(vec![format!(
                "the header `{}` has no commas, semicolons or tabs between the names; write `{}`",
                quoted(line),
                quoted(&line.split_whitespace().collect::<Vec<_>>().join(","))
            )]);
        }
        let (names, units_of_names) = header.iter().map(|cell| named(cell)).unzip();
        let read = vec![false; header.len()];
        let mut reader = Reader { header, names, units_of_names, units, read, mistakes: Vec::new(), wanted };
        if reader.names.first().is_some_and(|first| first.parse::<f64>().is_ok()) {
            return Err(vec![
                "the first row is not a header; write the names of the columns above it, such as `x,y,z`"
                    .to_owned(),
            ]);
        }
        reader.repeated();
        let layout = reader.layout();
        reader.slips();
        if reader.mistakes.is_empty() { Ok(layout) } else { Err(reader.mistakes) }
    }
}

/// A cell of the header as it is written.
fn written(cell: &[u8]) -> String {
    String::from_utf8_lossy(cell).trim().trim_start_matches('\u{feff}').to_owned()
}

impl Wanted<'_> {
    /// Whether a number of this column is read from every row, so that nothing but a comment can begin with `#` there.
    pub(crate) fn reads_number(&self, column: &[u8]) -> bool {
        let (name, _) = named(&written(column));
        let axes = &self.equations.axes;
        let of_axis =
            axes.iter().any(|axis| *axis.variable == *name || format!("dir_{}", axis.variable) == name);
        let of_travel = self.equations.travels.iter().any(|travel| *travel.name == *name);
        let sensor = name.strip_prefix("T_").is_some_and(|sensor| self.sensors.contains(&sensor));
        of_axis || of_travel || sensor || name == "t"
    }
}

/// The name of a column, and the unit in brackets behind it: `x [mm]`, `x (mm)`.
fn named(cell: &str) -> (String, Option<String>) {
    match unit_in_name(cell) {
        Some((name, unit)) => (name.to_owned(), Some(unit.to_owned())),
        None => (cell.to_owned(), None),
    }
}

/// The units of all columns, which stand behind the mark `#unit`.
fn unit_row(units: &[String], columns: usize) -> Result<Vec<String>, String> {
    if units.len() == columns {
        return Ok(units.to_vec());
    }
    Err(format!(
        "the row of units has {}; write `#unit` and then one unit for each column, empty if it has none",
        numbers_of_units(units.len(), columns)
    ))
}

impl Reader<'_> {
    /// A column may stand once, and not under a name that the output needs.
    fn repeated(&mut self) {
        for name in output_columns(self.wanted.equations) {
            if self.names.contains(&name) {
                self.mistakes.push(format!("column `{name}` has the name of an output column; rename it"));
            }
        }
        let mut known = BTreeSet::new();
        for name in self.names.iter().filter(|name| !name.is_empty()) {
            if !known.insert(name) {
                self.mistakes.push(format!("column `{}` occurs twice", quoted(name)));
            }
        }
    }

    /// A column that nothing reads, and that is nearly one that would be read: its sign, its tool or its time would be lost.
    fn slips(&mut self) {
        let axes = self.wanted.equations.axes.iter();
        let directions = axes.map(|axis| format!("dir_{}", axis.variable));
        let travels = self.wanted.equations.travels.iter().map(|travel| travel.name.to_string());
        let time = self.wanted.timed.then(|| "t".to_owned());
        let tool = self.wanted.tools.then(|| "tool".to_owned());
        let known: Vec<String> = directions.chain(travels).chain(time).chain(tool).collect();
        let absent: Vec<&String> = known.iter().filter(|name| !self.names.contains(name)).collect();
        let unread = self.names.iter().zip(&self.read).filter(|(_, read)| !**read).map(|(name, _)| name);
        for name in unread {
            let slip = absent.iter().find(|known| is_slip(name, known) && !is_other_direction(name, known));
            if let Some(known) = slip {
                let name = quoted(name);
                self.mistakes
                    .push(format!("nothing reads column `{name}`; did you mean `{known}`? Else rename it"));
            }
        }
    }

    fn layout(&mut self) -> Layout {
        let wanted = self.wanted;
        let equations = wanted.equations;
        let programmed = equations.axes.iter().filter(|axis| !axis.is_motor());
        let axes = programmed.map(|axis| {
            let what = format!("the position of axis {}", axis.letter);
            self.required(&axis.variable, if axis.rotary { "deg" } else { "mm" }, &what)
        });
        let axes = axes.collect();
        let directions =
            equations.axes.iter().map(|axis| self.find(&format!("dir_{}", axis.variable))).collect();
        let travels = self.travels();
        let sensors = wanted.sensors.iter().map(|name| {
            let what = format!("the temperature of sensor {name}, which the calibration uses");
            self.required(&format!("T_{name}"), "degC", &what)
        });
        let sensors = sensors.collect();
        let time = match &wanted.time {
            Some(why) => Some(self.required("t", "s", &format!("the time, which {why} needs"))),
            None => self.optional("t", "s"),
        };
        let tool = if wanted.tools { self.find("tool") } else { None };
        let unread = self.header.iter().zip(&self.read).filter(|(_, read)| !**read);
        Layout {
            width: self.header.len(),
            axes,
            motors: equations.following(),
            directions,
            travels,
            sensors,
            time,
            tool,
            unread: unread.map(|(name, _)| name.clone()).collect(),
            header: self.header.clone(),
            units: self.units.clone(),
        }
    }

    /// The free travels: all of them in columns, or none.
    fn travels(&mut self) -> Vec<Option<Column>> {
        let travels = &self.wanted.equations.travels;
        let columns: Vec<_> = travels.iter().map(|travel| self.optional(&travel.name, "mm")).collect();
        if columns.iter().any(Option::is_some) {
            for (travel, _) in travels.iter().zip(&columns).filter(|(_, column)| column.is_none()) {
                let name = &travel.name;
                self.mistakes.push(format!("there is no column `{name}`; give all travels or none"));
            }
        }
        columns
    }

    fn find(&mut self, name: &str) -> Option<usize> {
        let index = self.names.iter().position(|own| own == name)?;
        if let Some(read) = self.read.get_mut(index) {
            *read = true;
        }
        Some(index)
    }

    fn optional(&mut self, name: &str, default: &str) -> Option<Column> {
        let index = self.find(name)?;
        let below = self.units.as_ref().and_then(|units| units.get(index)).filter(|unit| !unit.is_empty());
        let beside = self.units_of_names.get(index).and_then(Option::as_ref);
        if let (Some(below), Some(beside)) = (below, beside)
            && below != beside
        {
            let (below, beside) = (quoted(below), quoted(beside));
            self.mistakes.push(format!(
                "column `{name}` has two units, `{beside}` in its name and `{below}` below it"
            ));
        }
        let unit = below.or(beside).map_or(default, String::as_str);
        let expected = match default {
            "deg" => Dimension::ANGLE,
            "s" => Dimension::TIME,
            "degC" => Dimension::TEMPERATURE,
            _ => Dimension::LENGTH,
        };
        match parse_unit(unit) {
            Ok(parsed) if parsed.dimension == expected => {
                Some(Column { index, factor: parsed.factor, offset: parsed.offset })
            }
            Ok(_) => {
                self.mistakes.push(format!(
                    "`{}` is not a unit for column `{name}`; write a unit such as `{default}`",
                    quoted(unit)
                ));
                None
            }
            Err(_) => {
                self.mistakes.push(format!("`{}` of column `{name}` is not a unit", quoted(unit)));
                None
            }
        }
    }

    fn required(&mut self, name: &str, default: &str, what: &str) -> Column {
        let known = self.names.iter().any(|own| own == name);
        if !known {
            let near = nearest(name, self.names.iter().map(String::as_str));
            let help = near.map(|near| format!("; did you mean `{}`?", quoted(near))).unwrap_or_default();
            self.mistakes.push(format!("there is no column `{name}`, {what}{help}"));
        }
        self.optional(name, default).unwrap_or(Column { index: 0, factor: 1.0, offset: 0.0 })
    }
}

/// Whether a column is the direction of another axis, of this machine or of another one.
fn is_other_direction(name: &str, known: &str) -> bool {
    let lower = name.to_lowercase();
    let letter = lower.strip_prefix("dir_").filter(|axis| axis.chars().count() == 1);
    letter.is_some() && lower != known
}
