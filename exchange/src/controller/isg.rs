//! ISG CSV: the error motions themselves, for the volumetric compensation of ISG's kernel and Beckhoff's TwinCAT CNC. In: a
//! geometry. Out: a file of blocks, each with a header of arguments and parameters; and what such a file says.
//!
//! Facts: ISG kernel, FCT "Volumetric compensation", ISG CSV format and list of parameters. Parameters are in mm and rad,
//! arguments in mm and degrees. `//` begins a comment, `#` a new block with a header of its own.

use std::fmt::Write;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;

use super::decimal::decimal;
use super::geometry::Pose;
use super::grid::Grid;
use super::job::{Controller, File, Job, Written};
use super::lines::{Line, lines};
use super::lost::Target;
use super::parameters::{self, Parameter};
use super::refused::Refused;
use super::volumetric::Volumetric;

/// The form of a line, for findings.
const FORM: &str = "a block is a header such as `X EXX EYX` and rows of as many numbers";

impl Controller for Isg {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        for block in blocks(source) {
            take(&mut self.0, &block, diagnostics);
        }
    }

    fn target(&self) -> &dyn Target {
        &self.0
    }
}

impl Target for Isg {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        self.0.correction(pose)
    }
}

/// A kernel that reads this form.
#[derive(Debug)]
pub(super) struct Isg(pub(super) Volumetric);

/// The kernel without errors.
pub(super) fn controller(job: &Job<'_, '_>) -> Result<Isg, Refused> {
    Volumetric::new(job.geometry).map(Isg)
}

/// One file with a block for each set of arguments.
pub(super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let model = Volumetric::new(job.geometry)?;
    let parameters::Gathered { parameters, left_out } = parameters::gather(job, &model, usize::MAX)?;
    let mut text = parameters::preamble(job, &model);
    let mut rest = parameters.as_slice();
    while let Some(first) = rest.first() {
        let alike = rest.iter().take_while(|next| next.grid.arguments == first.grid.arguments).count();
        let (block, others) = rest.split_at(alike);
        write_block(&mut text, job.geometry.equations, block);
        rest = others;
    }
    let tip = model.tip.map(|part| decimal(part, 6));
    let _ =
        writeln!(text, "#\n// The tip of the tool at zero of all axes, mm.\nP0X P0Y P0Z\n{}", tip.join(" "));
    let records = text.lines().count();
    let about = format!("{} error motions for the volumetric compensation", parameters.len());
    let file = File { name: "volumetric.csv".to_owned(), axis: None, text, about };
    let mut loading = parameters::loading(&model, "ISG_CSV", "volumetric.csv");
    loading.push(format!("max_records at least {records}"));
    Ok(Written { files: vec![file], loading, left_out })
}

fn write_block(text: &mut String, equations: &Equations, block: &[Parameter]) {
    let Some(first) = block.first() else { return };
    let arguments = &first.grid.arguments;
    let letter = |axis: &usize| equations.axes.get(*axis).map_or("", |info| info.letter.as_str());
    let header =
        arguments.iter().map(|(axis, _)| letter(axis)).chain(block.iter().map(|one| one.name.as_str()));
    let _ = writeln!(text, "#\n{}", header.collect::<Vec<_>>().join(" "));
    for record in 0..first.grid.values.len() {
        let places = first.grid.places(record).into_iter().map(|place| decimal(place, 6));
        let values =
            block.iter().map(|one| decimal(one.grid.values.get(record).copied().unwrap_or(f64::NAN), 12));
        let _ = writeln!(text, "{}", places.chain(values).collect::<Vec<_>>().join(" "));
    }
}

/// The lines of each block.
fn blocks(source: &SourceFile) -> Vec<Vec<Line<'_>>> {
    let mut blocks = vec![Vec::new()];
    for line in lines(source, "//") {
        if line.text.starts_with('#') {
            blocks.push(Vec::new());
        } else if let Some(block) = blocks.last_mut() {
            block.push(line);
        }
    }
    blocks.retain(|block| !block.is_empty());
    blocks
}

/// Takes the error motions of a block; what describes the machine itself is the controller's own.
fn take(model: &mut Volumetric, block: &[Line<'_>], diagnostics: &mut Diagnostics) {
    let Some((header, rows)) = block.split_first() else { return };
    let names: Vec<Line<'_>> = header.words().collect();
    let arguments: Vec<usize> = names
        .iter()
        .map_while(|name| model.equations.axes.iter().position(|axis| axis.letter == name.text))
        .collect();
    let Some(records) = numbers(rows, names.len(), diagnostics) else { return };
    let column = |number: usize| records.iter().map(|record| record[number]).collect::<Vec<f64>>();
    for (number, name) in names.iter().enumerate().skip(arguments.len()) {
        let tip = ["P0X", "P0Y", "P0Z"].iter().position(|tip| *tip == name.text);
        if let (Some(direction), [place]) = (tip, column(number).as_slice()) {
            model.set_tip(direction, *place);
            continue;
        }
        let Some(motion) = parameters::motion_of(name.text) else {
            if !parameters::is_description(name.text) {
                let message = format!("`{}` is not a parameter", name.text);
                let help = "write the arguments X, Y, Z, then error motions such as EXX or C0Y";
                diagnostics.push(Diagnostic::error("E0804", name.span, message).help(help));
            }
            continue;
        };
        let places: Vec<Vec<f64>> = (0..arguments.len()).map(column).collect();
        match Grid::from_records(&arguments, &places, &column(number)) {
            Some(grid) => _ = model.parameters.insert(motion, grid),
            None => {
                let help = "write each combination of its arguments in exactly one row";
                let message = "the rows of this block are not a full grid";
                diagnostics.push(Diagnostic::error("E0803", header.span, message).help(help));
                return;
            }
        }
    }
}

/// Rows of numbers, as many in each as the header has names.
fn numbers(rows: &[Line<'_>], width: usize, diagnostics: &mut Diagnostics) -> Option<Vec<Vec<f64>>> {
    let mut records = Vec::with_capacity(rows.len());
    for row in rows {
        let record: Option<Vec<f64>> = row.words().map(|word| word.number(diagnostics)).collect();
        let record = record?;
        if record.len() != width {
            row.malformed(FORM, diagnostics);
            return None;
        }
        records.push(record);
    }
    Some(records)
}
