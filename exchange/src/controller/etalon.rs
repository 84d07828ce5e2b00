//! The Etalon Exchange Format, variant Vendor. In: a geometry. Out: a file with a section for each error motion; and what such a
//! file says.
//!
//! Facts: ISG kernel, FCT "Volumetric compensation", Etalon Exchange Format. mm and rad; `//` begins a comment.

use std::fmt::Write;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::SourceFile;

use super::decimal::decimal;
use super::geometry::Pose;
use super::grid::Grid;
use super::job::{Controller, File, Job, Written};
use super::lines::{Line, lines};
use super::lost::Target;
use super::parameters;
use super::refused::Refused;
use super::volumetric::Volumetric;

/// The form of a file, for findings.
const FORM: &str = "a section is `[EXX]` with `VALUE = 0.001`, or with `Gridpoints = {`, lines of position and value, and `}`";

/// A controller that reads this form.
#[derive(Debug)]
pub(super) struct Etalon(pub(super) Volumetric);

impl Controller for Etalon {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        let all: Vec<Line<'_>> = lines(source, "//").collect();
        let mut rest = all.as_slice();
        while let Some((head, after)) = rest.split_first() {
            let length = after.iter().position(|line| line.text.starts_with('[')).unwrap_or(after.len());
            let (body, others) = after.split_at(length);
            self.section(*head, body, diagnostics);
            rest = others;
        }
    }

    fn target(&self) -> &dyn Target {
        &self.0
    }
}

impl Target for Etalon {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        self.0.correction(pose)
    }
}

impl Etalon {
    fn section(&mut self, head: Line<'_>, body: &[Line<'_>], diagnostics: &mut Diagnostics) {
        let name = head.text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        let Some(name) = name else { return head.malformed(FORM, diagnostics) };
        let Some(motion) = parameters::motion_of(name.trim()) else {
            let message = format!("`{name}` is not an error motion");
            return diagnostics.push(
                Diagnostic::error("E0804", head.span, message).help("write a name such as EXX or C0Y"),
            );
        };
        let axis = motion.chars().last();
        let axis = self.0.equations.axes.iter().position(|info| info.letter.chars().next() == axis);
        let grid = match body {
            [value] if value.text.starts_with("VALUE") => constant(*value, diagnostics),
            [open, points @ .., close] if open.text.starts_with("Gridpoints") && close.text == "}" => {
                gridpoints(*open, points, axis, diagnostics)
            }
            _ => return head.malformed(FORM, diagnostics),
        };
        self.0.parameters.extend(grid.map(|grid| (motion, grid)));
    }
}

fn constant(line: Line<'_>, diagnostics: &mut Diagnostics) -> Option<Grid> {
    let words: Vec<Line<'_>> = line.words().collect();
    match words.as_slice() {
        [_, equals, value] if equals.text == "=" => {
            value.number(diagnostics).map(|value| Grid { arguments: Vec::new(), values: vec![value] })
        }
        _ => {
            line.malformed(FORM, diagnostics);
            None
        }
    }
}

fn gridpoints(
    head: Line<'_>,
    points: &[Line<'_>],
    axis: Option<usize>,
    diagnostics: &mut Diagnostics,
) -> Option<Grid> {
    let (mut places, mut values) = (Vec::new(), Vec::new());
    for point in points {
        let numbers = point.words().map(|word| word.number(diagnostics)).collect::<Option<Vec<f64>>>()?;
        let [place, value] = numbers.as_slice() else {
            point.malformed(FORM, diagnostics);
            return None;
        };
        places.push(*place);
        values.push(*value);
    }
    let grid = axis.and_then(|axis| Grid::from_records(&[axis], &[places], &values));
    if grid.is_none() {
        let message = "a position occurs twice, or the machine has no such axis";
        diagnostics.push(Diagnostic::error("E0803", head.span, message).help(FORM));
    }
    grid
}

/// The controller without errors.
pub(super) fn controller(job: &Job<'_, '_>) -> Result<Etalon, Refused> {
    Volumetric::new(job.geometry).map(Etalon)
}

/// One file with a section for each error motion.
pub(super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let model = Volumetric::new(job.geometry)?;
    let parameters::Gathered { mut parameters, mut left_out } = parameters::gather(job, &model, 1)?;
    parameters.retain(|parameter| {
        let over = parameter.grid.arguments.first().map(|(axis, _)| *axis);
        let fits = over.is_none() || over == parameter.axis;
        if !fits {
            left_out.push(format!("{}: it depends on an axis other than its own", parameter.name));
        }
        fits
    });
    let mut text = parameters::preamble(job, &model);
    for parameter in &parameters {
        let _ = writeln!(text, "[{}]", parameter.name);
        let value =
            |record: usize| decimal(parameter.grid.values.get(record).copied().unwrap_or(f64::NAN), 12);
        match parameter.grid.arguments.first() {
            None => _ = writeln!(text, "VALUE = {}", value(0)),
            Some((_, nodes)) => {
                let _ = writeln!(text, "Gridpoints = {{");
                for (record, place) in nodes.iter().enumerate() {
                    let _ = writeln!(text, "{} {}", decimal(*place, 6), value(record));
                }
                let _ = writeln!(text, "}}");
            }
        }
    }
    let about = format!("{} error motions in Etalon's exchange format (Vendor)", parameters.len());
    let file = File { name: "volumetric.txt".to_owned(), axis: None, text, about };
    let mut loading = parameters::loading(&model, "ETALON_EXCHANGE", "volumetric.txt");
    let tip = model.tip.map(|part| decimal(part, 6)).join(" ");
    loading.push(format!(
        "the tip of the tool, which this format cannot contain: P0X P0Y P0Z = {tip} mm, in an ISG_CSV file"
    ));
    Ok(Written { files: vec![file], loading, left_out })
}
