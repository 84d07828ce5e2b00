//! Where a measurement was taken. In: `at` of a measurement. Out: positions of the axes that stood still, and the constants that say
//! where the instrument was in place of the tool tip.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::Spanned;
use model_dsl::yaml::Node;

use super::words::FORM;

/// The line on which a measurement was taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// Axes that stood still, by number, with their positions: mm or rad. All others stood at zero.
    pub axes: Vec<(usize, f64)>,
    /// Constants of the machine, by number, mm: where the instrument was, as a tool. All others are those of the set-up.
    pub constants: Vec<(usize, f64)>,
}

impl Place {
    /// Where an axis stood: mm or rad.
    pub(crate) fn position(&self, axis: usize) -> f64 {
        self.axes.iter().find(|(known, _)| *known == axis).map_or(0.0, |(_, position)| *position)
    }
}

/// Reads `at` of a measurement along `moving`.
pub(super) fn read(
    node: &Node,
    moving: usize,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<Place> {
    let Some(entries) = node.entries() else {
        let message =
            format!("`at` must be a mapping of axes and constants to positions, found {}", node.kind_name());
        let help = "write `at: {Y: 140 mm, Z: -50 mm, Zt: 80 mm}`";
        diagnostics.push(Diagnostic::error(FORM, node.span, message).help(help));
        return None;
    };
    let mut place = Place::default();
    for (name, value) in entries {
        read_one(&mut place, name, value, moving, equations, diagnostics);
    }
    Some(place)
}

fn read_one(
    place: &mut Place,
    name: &Spanned<String>,
    value: &Node,
    moving: usize,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) {
    let mut quantity = |dimension: Dimension| {
        let words = format!("`{}`", name.value);
        quantity::read(value, dimension, &words, diagnostics).map(|quantity| quantity.value)
    };
    if let Some(axis) = equations.axes.iter().position(|axis| axis.letter == name.value) {
        let rotary = equations.axes.get(axis).is_some_and(|axis| axis.rotary);
        let position = quantity(if rotary { Dimension::ANGLE } else { Dimension::LENGTH });
        place.axes.extend(position.map(|position| (axis, position)));
        if axis == moving {
            let message = format!("{} moves in this measurement, so it has no fixed position", name.value);
            let help = "remove it; the targets give its positions";
            diagnostics.push(Diagnostic::error("E0906", name.span, message).help(help));
        }
        return;
    }
    let constant = equations.offsets().find(|(_, constant)| *constant.name == *name.value);
    let constant = constant.map(|(number, _)| number);
    match constant {
        Some(constant) => place.constants.extend(quantity(Dimension::LENGTH).map(|value| (constant, value))),
        None => diagnostics.push(unknown(name, equations)),
    }
}

fn unknown(name: &Spanned<String>, equations: &Equations) -> Diagnostic {
    let message = format!("{} has no axis or constant `{}`", equations.machine, name.value);
    let letters = equations.axes.iter().map(|axis| axis.letter.clone());
    let known: Vec<String> =
        letters.chain(equations.offsets().map(|(_, constant)| constant.name.to_string())).collect();
    let help = format!("there are {}", known.join(", "));
    Diagnostic::error("E0906", name.span, message).help(help)
}
