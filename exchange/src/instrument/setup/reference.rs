//! What straightness was measured against. In: `references` of a set-up. Out: straightedges and squares by name, with what is
//! known of their angle.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::Fields;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use super::Setup;
use super::words::{FORM, keys};

/// A square: two edges whose angle is known.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Its name, by which measurements call it.
    pub name: Spanned<String>,
    /// The angle from the first edge to the second, minus a right angle: rad. The edges are those along the two axes, taken
    /// right-handed about the third.
    pub angle: Option<f64>,
    /// The standard uncertainty of that angle, rad; not known where there is none.
    pub uncertainty: Option<f64>,
}

/// Reads `references`.
pub(super) fn read(node: &Node, diagnostics: &mut Diagnostics) -> Vec<Reference> {
    let Some(entries) = node.entries() else {
        let message =
            format!("`references` must be a mapping of names to angles, found {}", node.kind_name());
        let help = "write `square: {angle: 2 urad, uncertainty: 0.5 urad}`";
        diagnostics.push(Diagnostic::error(FORM, node.span, message).help(help));
        return Vec::new();
    };
    entries.iter().filter_map(|(name, node)| read_one(name, node, diagnostics)).collect()
}

fn read_one(name: &Spanned<String>, node: &Node, diagnostics: &mut Diagnostics) -> Option<Reference> {
    let wording = keys("a reference");
    let fields = Fields::open(node, name.span, wording, &["angle", "uncertainty"], diagnostics)?;
    let mut read = |key: &str| {
        fields
            .get(key)
            .and_then(|node| quantity::read(node, Dimension::ANGLE, &format!("`{key}`"), diagnostics))
    };
    let (angle, uncertainty) = (read("angle"), read("uncertainty"));
    if let Some(wrong) = uncertainty.filter(|uncertainty| uncertainty.value < 0.0) {
        let mistake = Diagnostic::error("E0907", wrong.span, "an uncertainty cannot be below zero");
        diagnostics.push(mistake.help("write the standard uncertainty, such as `0.5 urad`"));
    }
    let (angle, uncertainty) = (angle.map(|angle| angle.value), uncertainty.map(|one| one.value));
    Some(Reference { name: name.clone(), angle, uncertainty })
}

/// Reports references that no measurement names, and names that no two measurements share (E0912).
pub(super) fn check(setup: &Setup, diagnostics: &mut Diagnostics) {
    let upright = |name: &str| -> usize {
        let own = setup.measurements.iter().filter(|one| !one.turned);
        own.filter(|one| one.reference.as_ref().is_some_and(|own| own.value == name)).count()
    };
    for reference in setup.references.iter().filter(|one| upright(&one.name.value) == 0) {
        let name = &reference.name.value;
        let message = format!("no measurement was made against `{name}`");
        let help =
            format!("add `reference: {name}` to the two straightness measurements, or remove the reference");
        diagnostics.push(Diagnostic::error("E0912", reference.name.span, message).help(help));
    }
    for one in setup.measurements.iter().filter(|one| !one.turned).filter_map(|one| one.reference.as_ref()) {
        if upright(&one.value) == 1 {
            diagnostics.push(alone(&one.value, one.span));
        }
    }
}

fn alone(name: &str, span: Span) -> Diagnostic {
    let message = format!("only one measurement was made against `{name}`");
    let help = "add the second measurement, or remove the reference; a squareness needs the straightnesses of two axes";
    Diagnostic::error("E0912", span, message).help(help)
}
