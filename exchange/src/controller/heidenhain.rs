//! HEIDENHAIN axis error compensation (`.COM`), as a TNC 640 or a MANUALplus 620 has it. In: a correction taken apart. Out: a
//! table for each axis, with a column for each axis that depends on it; and what such a table does.
//!
//! Facts: HEIDENHAIN Technical Manual MANUALplus 620, "Nonlinear axis error compensation": AXISPOS counts from the machine
//! datum, BACKLASH holds the own axis's value in the negative direction, a column is named by the axis that it corrects. What a
//! positive number does is said in no document that could be read: the user says it. Columns begin under their names.

use std::fmt::Write;

use abbe_runtime::Direction;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::AxisInfo;
use model_dsl::source::SourceFile;

use super::decimal::decimal;
use super::effects::{Effect, Effects, LEAST};
use super::geometry::Pose;
use super::grid::Grid;
use super::job::{Controller, File, Job, Written};
use super::lines::{Line, lines};
use super::lost::Target;
use super::nodes::Spacing;
use super::options::Sense;
use super::refused::Refused;

/// The most entries of a table.
const MOST: usize = 256;

/// The form of a file, for findings.
const FORM: &str = "a table is `BEGIN AXIS_X.COM MM`, `NR AXISPOS BACKLASH X Y Z`, numbered rows, `[END]`";

/// What one axis's table does to one axis.
#[derive(Clone, Debug)]
struct Column {
    source: usize,
    target: usize,
    /// Over the source's position, in mm or deg.
    forward: Grid,
    reverse: Grid,
}

/// A control with its tables.
#[derive(Debug)]
pub(super) struct Heidenhain {
    letters: Vec<String>,
    units: Vec<f64>,
    moved: Vec<bool>,
    columns: Vec<Column>,
    sense: Sense,
}

/// The control without compensation.
///
/// # Errors
/// Where the user does not say what a number is.
pub(super) fn controller(job: &Job<'_, '_>) -> Result<Heidenhain, Refused> {
    let axes = &job.geometry.equations.axes;
    Ok(Heidenhain {
        letters: job.names(|_, letter| letter.to_owned())?,
        units: axes.iter().map(|axis| if axis.rotary { 1_f64.to_degrees() } else { 1.0 }).collect(),
        moved: axes.iter().map(AxisInfo::corrects).collect(),
        columns: Vec::new(),
        sense: sense(job)?,
    })
}

fn sense(job: &Job<'_, '_>) -> Result<Sense, Refused> {
    job.options.sense.ok_or_else(|| {
        Refused::new(
            "no public document says what a positive number in a .COM table means",
            "find out with an indicator (docs/controllers.md), then use --value error or --value correction",
        )
    })
}

impl Controller for Heidenhain {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        let all: Vec<Line<'_>> = lines(source, ";").collect();
        let [begin, header, rows @ .., end] = all.as_slice() else {
            let message = "the table has no header or no end";
            return diagnostics.push(
                Diagnostic::error("E0802", all.first().map_or(Default::default(), |line| line.span), message)
                    .help(FORM),
            );
        };
        if end.text != "[END]" {
            return end.malformed(FORM, diagnostics);
        }
        let Some(from) = self.source(begin.text) else { return begin.malformed(FORM, diagnostics) };
        self.take(from, *header, rows, diagnostics);
    }

    fn target(&self) -> &dyn Target {
        self
    }
}

impl Heidenhain {
    /// The axis of `BEGIN AXIS_X.COM MM`.
    fn source(&self, begin: &str) -> Option<usize> {
        let name = begin.strip_prefix("BEGIN AXIS_")?.strip_suffix(".COM MM")?;
        self.letters.iter().position(|letter| letter == name)
    }

    fn take(&mut self, source: usize, header: Line<'_>, rows: &[Line<'_>], diagnostics: &mut Diagnostics) {
        let names: Vec<Line<'_>> = header.words().collect();
        let [number, place, backlash, targets @ ..] = names.as_slice() else {
            return header.malformed(FORM, diagnostics);
        };
        if [number.text, place.text, backlash.text] != ["NR", "AXISPOS", "BACKLASH"] || rows.len() > MOST {
            return header.malformed(FORM, diagnostics);
        }
        let mut records = Vec::with_capacity(rows.len());
        for row in rows {
            let Some(numbers) =
                row.words().map(|word| word.number(diagnostics)).collect::<Option<Vec<f64>>>()
            else {
                return;
            };
            if numbers.len() != names.len() {
                return row.malformed(FORM, diagnostics);
            }
            records.push(numbers);
        }
        let column = |number: usize| records.iter().map(|record| record[number]).collect::<Vec<f64>>();
        let grid = |number: usize| Grid::from_records(&[0], &[column(1)], &column(number));
        for (number, name) in targets.iter().enumerate() {
            let Some(target) = self.letters.iter().position(|letter| letter == name.text) else {
                let message = format!("the machine has no axis `{}`", name.text);
                diagnostics.push(Diagnostic::error("E0804", name.span, message).help(FORM));
                return;
            };
            let reverse = if target == source { 2 } else { number + 3 };
            let Some((forward, reverse)) = grid(number + 3).zip(grid(reverse)) else {
                let message = "a position occurs twice";
                diagnostics.push(Diagnostic::error("E0803", header.span, message).help(FORM));
                return;
            };
            self.columns.push(Column { source, target, forward, reverse });
        }
    }
}

impl Target for Heidenhain {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let mut correction = vec![0.0; pose.position.len()];
        for column in &self.columns {
            let (Some(place), Some(unit)) = (pose.position.get(column.source), self.units.get(column.source))
            else {
                continue;
            };
            let grid = match pose.direction.get(column.source) {
                Some(Direction::Negative) => &column.reverse,
                _ => &column.forward,
            };
            if let Some(slot) =
                correction.get_mut(column.target).filter(|_| self.moved.get(column.target) == Some(&true))
            {
                let of_target = self.units.get(column.target).copied().unwrap_or(1.0);
                *slot += self.sense.sign() * grid.value(&[place * unit]) / of_target;
            }
        }
        Ok(correction)
    }
}

/// A table for each axis on which something depends.
pub(super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let control = controller(job)?;
    let effects = Effects::new(job.geometry, job.space)?;
    let mut written = Written::default();
    for source in 0..job.space.ranges.len() {
        let nodes =
            effects.nodes(source)?.at_any_places(Spacing { points: job.options.points, most: MOST })?;
        let mut columns = effects.of(source, &nodes)?;
        columns.retain(|effect| effect.target == source || effect.largest() >= LEAST);
        if columns.is_empty() {
            continue;
        }
        let name = format!("AXIS_{}.COM", control.letters.get(source).map_or("", String::as_str));
        let base = effects.base.get(source).copied().unwrap_or_default();
        let about = format!(
            "{} entries over {}, for {} axes",
            nodes.len(),
            job.geometry.equations.axes[source].letter,
            columns.len()
        );
        let text = table(&control, &name, source, &columns, base);
        written.files.push(File { name, axis: None, text, about });
    }
    written.loading = vec![
        "name each file in the configuration of its axis, and switch on the nonlinear compensation"
            .to_owned(),
        "AXISPOS is counted from the machine datum; the zero of the calibration must be at the datum"
            .to_owned(),
    ];
    Ok(written)
}

fn table(control: &Heidenhain, name: &str, source: usize, columns: &[Effect], base: f64) -> String {
    let letter = |effect: &Effect| control.letters.get(effect.target).cloned().unwrap_or_default();
    let names =
        ["NR", "AXISPOS", "BACKLASH"].map(ToOwned::to_owned).into_iter().chain(columns.iter().map(letter));
    let mut text = format!("BEGIN {name} MM\n{}\n", row(names));
    let Some(first) = columns.first() else { return text };
    let unit = control.units.get(source).copied().unwrap_or(1.0);
    let own = columns.iter().find(|effect| effect.target == source);
    let told = |value: Option<&f64>, base: f64, target: usize| {
        let of_target = control.units.get(target).copied().unwrap_or(1.0);
        // Degrees are worth more than millimetres, and have two decimals more.
        let decimals = if of_target > 1.0 { 8 } else { 6 };
        decimal(control.sense.sign() * of_target * (value.copied().unwrap_or_default() + base), decimals)
    };
    for (number, place) in first.nodes.iter().enumerate() {
        let backlash = own.map_or_else(|| decimal(0.0, 6), |own| told(own.reverse.get(number), base, source));
        let values = columns.iter().map(|effect| match effect.target == source {
            true => told(effect.forward.get(number), base, source),
            false => told(effect.mean().get(number), 0.0, effect.target),
        });
        let cells = [number.to_string(), decimal(place * unit, 6), backlash];
        let _ = writeln!(text, "{}", row(cells.into_iter().chain(values)));
    }
    text.push_str("[END]\n");
    text
}

/// Cells under their names.
fn row(cells: impl Iterator<Item = String>) -> String {
    let cells: Vec<String> = cells.map(|cell| format!("{cell:<14}")).collect();
    cells.concat().trim_end().to_owned()
}
