//! A volumetric file as a calibration. In: the file of a controller, and a machine. Out: its error motions as terms, counted as
//! the machine file counts them.

use model_dsl::calibration::{CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::source::{SourceFile, Span};

use super::geometry::Geometry;
use super::grid::Grid;
use super::job::Controller;
use super::parameters::motion_of;
use super::refused::Refused;
use super::saved::over_two;
use super::volumetric::Volumetric;
use super::{etalon, isg};

/// What an error motion may depart from a sum of functions of one axis each: mm or rad; files have twelve decimals.
const SAME: f64 = 1e-11;

/// Which form a volumetric file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumetricForm {
    /// ISG CSV.
    Isg,
    /// Etalon Exchange Format.
    Etalon,
}

/// The terms that a volumetric file adds to a calibration, with the numbers of their error motions. `known` gives the values
/// of the machine's constants. What is wrong in the file goes to `diagnostics`.
///
/// # Errors
/// A machine that has not three slides X, Y, Z.
pub fn volumetric_terms(
    equations: &Equations,
    known: &Calibration,
    source: &SourceFile,
    form: VolumetricForm,
    diagnostics: &mut Diagnostics,
) -> Result<Vec<(usize, CalibratedTerm)>, Refused> {
    let geometry = Geometry::new(equations, known);
    let model = Volumetric::new(&geometry)?;
    let mut model = match form {
        VolumetricForm::Isg => loaded(isg::Isg(model), source, diagnostics).0,
        VolumetricForm::Etalon => loaded(etalon::Etalon(model), source, diagnostics).0,
    };
    let mut terms = Vec::new();
    for (name, mut grid) in std::mem::take(&mut model.parameters) {
        let motion = equations.motions.iter().position(|motion| motion.name == name);
        let Some((motion, sign)) = motion.and_then(|motion| Some((motion, model.sign(&geometry, motion)?)))
        else {
            let unseen = equations.unseen.iter().any(|motion| motion.name == name);
            if grid.values.iter().any(|value| *value != 0.0) && unseen {
                let message = format!("{name} has no effect on {}", equations.machine);
                let warning = Diagnostic::warning("W0402", Span::default(), message);
                diagnostics.push(warning.help("it is left out, because it has no lever arm at the tool tip"));
            } else if grid.values.iter().any(|value| *value != 0.0) {
                let message = format!("{} has no error motion {name}", equations.machine);
                let help = "the machine file may assign an alignment error to the other axis: B0X instead of B0Z with the opposite sign";
                diagnostics.push(Diagnostic::error("E0804", Span::default(), message).help(help));
            }
            continue;
        };
        grid.values.iter_mut().for_each(|value| *value *= sign);
        match sum_of_curves(&grid).or_else(|| sum_over_rows(&grid)) {
            Some(curves) => terms.extend(curves.into_iter().map(|term| (motion, term))),
            None => {
                let message =
                    format!("{name} depends on more than two axes and is not a sum of functions of one axis");
                let help = "measure the axes separately, or keep this motion in the controller; terms of a calibration add";
                diagnostics.push(Diagnostic::error("E0803", Span::default(), message).help(help));
            }
        }
    }
    Ok(terms)
}

/// The form of a text that looks like the file of a volumetric compensation.
pub fn volumetric_form(text: &str) -> Option<VolumetricForm> {
    let told = |line: &&str| !line.is_empty() && !line.starts_with("//") && !line.starts_with('#');
    let first = text.lines().map(str::trim).find(told)?;
    if first.strip_prefix('[').is_some_and(|rest| motion_of(rest.trim_end_matches(']').trim()).is_some()) {
        return Some(VolumetricForm::Etalon);
    }
    first.split_whitespace().any(|word| motion_of(word).is_some()).then_some(VolumetricForm::Isg)
}

fn loaded<C: Controller>(mut controller: C, source: &SourceFile, diagnostics: &mut Diagnostics) -> C {
    controller.load(source, None, diagnostics);
    controller
}

/// For each row of a grid over two axes a table times a hat function, which is bilinear between the points as the controller is;
/// nothing where there are not two axes with two nodes each.
fn sum_over_rows(grid: &Grid) -> Option<Vec<CalibratedTerm>> {
    match grid.arguments.as_slice() {
        [(across, rows), (along, places)] if rows.len() > 1 && places.len() > 1 => {
            Some(over_two([(*across, rows), (*along, places)], &grid.values))
        }
        _ => None,
    }
}

/// A table for each argument, the first holding the value at the first nodes of all; nothing where they do not add up to the
/// grid. A constant where there is no argument.
fn sum_of_curves(grid: &Grid) -> Option<Vec<CalibratedTerm>> {
    let first = *grid.values.first()?;
    if grid.arguments.is_empty() {
        return Some(vec![CalibratedTerm::Constant { value: first }]);
    }
    let sizes: Vec<usize> = grid.arguments.iter().map(|(_, nodes)| nodes.len()).collect();
    let stride = |argument: usize| sizes.iter().skip(argument + 1).product::<usize>();
    let along = |argument: usize| -> Option<Vec<f64>> {
        (0..*sizes.get(argument)?)
            .map(|node| grid.values.get(node * stride(argument)).map(|value| value - first))
            .collect()
    };
    let curves: Vec<Vec<f64>> = (0..sizes.len()).map(along).collect::<Option<_>>()?;
    for (record, value) in grid.values.iter().enumerate() {
        let node = |argument: usize| record / stride(argument) % sizes[argument];
        let sum: f64 = curves.iter().enumerate().map(|(argument, curve)| curve[node(argument)]).sum();
        if (first + sum - value).abs() > SAME {
            return None;
        }
    }
    let tables = grid.arguments.iter().zip(curves).enumerate().map(|(number, ((axis, nodes), curve))| {
        let base = if number == 0 { first } else { 0.0 };
        let values = CurveValues::Both(curve.into_iter().map(|value| value + base).collect());
        CalibratedTerm::Table { axis: *axis, curve: Curve::new(CurveNodes::At(nodes.clone()), values) }
    });
    Some(tables.collect())
}
