//! Squareness from lengths: a square that the machine made without correction, measured corner to corner. In: its lengths. Out: how
//! much the second axis of its plane leans towards the first.
//!
//! The corners are lettered as Marlin and Klipper letter them: A is at the least of both axes, D further along the first axis, B further
//! along the second, C opposite to A. The figure is a parallelogram: `AC^2 + BD^2 = 2 AB^2 + 2 AD^2` gives the side AB, and
//! `AC^2 - BD^2 = 4 AB AD cos A` the angle at A, whose cotangent is the lean.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::Fields;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use super::words::keys;

/// The planes, in the order of the factors.
const PLANES: [&str; 3] = ["XY", "XZ", "YZ"];

/// The lengths, corner to corner.
const LENGTHS: [&str; 3] = ["AC", "BD", "AD"];

/// The largest lean: one in ten is seen by eye, and is rather an exchange of letters.
const LARGEST: f64 = 0.1;

/// Reads `diagonals`: the leans in XY, XZ and YZ, 0 where a plane was not measured.
pub(super) fn read(node: &Node, name: Span, diagnostics: &mut Diagnostics) -> Option<Spanned<[f64; 3]>> {
    let fields = Fields::open(node, name, keys("`diagonals`"), &PLANES, diagnostics)?;
    if PLANES.iter().all(|plane| fields.get(plane).is_none()) {
        let mistake = Diagnostic::error("E0901", node.span, "`diagonals` names no plane");
        diagnostics.push(mistake.help("add `XY: {AC: 140.4 mm, BD: 140.8 mm, AD: 99.8 mm}`"));
        return None;
    }
    let mut leans = [0.0; 3];
    for (slot, plane) in leans.iter_mut().zip(PLANES) {
        if let Some((key, node)) = fields.entry(plane) {
            *slot = lean(node, key.span, diagnostics)?;
        }
    }
    Some(Spanned::new(leans, name))
}

/// How much the second axis leans towards the first, for each mm.
fn lean(node: &Node, name: Span, diagnostics: &mut Diagnostics) -> Option<f64> {
    let wording = keys("a square");
    let fields = Fields::open(node, name, wording, &LENGTHS, diagnostics)?;
    let mut length = |key: &str| {
        let node = fields.need(key, wording, diagnostics)?;
        quantity::read(node, Dimension::LENGTH, &format!("`{key}`"), diagnostics).map(|length| length.value)
    };
    let [ac, bd, ad] = LENGTHS.map(&mut length);
    let lean = parallelogram([ac?, bd?, ad?]);
    if lean.is_none() {
        let message = "these lengths are not those of a square with a lean of less than one in ten";
        let help = "give the diagonals AC and BD and the side AD along the first axis, all greater than zero";
        diagnostics.push(Diagnostic::error("E0926", node.span, message).help(help));
    }
    lean
}

/// The cotangent of the angle at A.
fn parallelogram([ac, bd, ad]: [f64; 3]) -> Option<f64> {
    let ab = ((ac * ac + bd * bd) / 2.0 - ad * ad).sqrt();
    let cosine = (ac * ac - bd * bd) / (4.0 * ab * ad);
    let lean = cosine / (1.0 - cosine * cosine).sqrt();
    // A length that is none makes what is no number, which is not small.
    ([ac, bd, ad].iter().all(|length| *length > 0.0) && lean.abs() < LARGEST).then_some(lean)
}
