//! How a file counts. In: `targets`, `deviations` and `runs` of a measurement. Out: where its targets lie on the machine, what
//! its deviations count from and in which sense, and which way its runs go.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::fields::Fields;
use model_dsl::quantity::{self, Dimension, Unit};
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use super::words::{choice, keys, unit, word};

/// How the targets of a file count: position = origin + sign * target.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Targets {
    /// Where they begin.
    pub begin: Begin,
    /// Whether they count against the axis: a sign of -1.
    pub against: bool,
    /// Their unit, where the set-up tells it.
    pub unit: Option<Unit>,
}

/// Where the targets of a file lie: mm, or rad for a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Begin {
    /// The position of the axis at the file's target 0.
    Origin(f64),
    /// The position of the axis at the target that lies furthest in its negative direction.
    MostNegative(f64),
}

impl Default for Begin {
    fn default() -> Self {
        Self::Origin(0.0)
    }
}

/// How the deviations of a file count.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviations {
    /// Whether the sensor counts against the ISO sense: a sign of -1.
    pub against: bool,
    /// Their unit, where the set-up tells it.
    pub unit: Option<Spanned<Unit>>,
    /// The position of the axis at which the motion is to be zero, mm or rad; else the instrument's zero stands.
    pub zero_at: Option<(f64, Span)>,
}

/// Which way the runs of a file go through its targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Runs 1, 3, 5 ascend, runs 2, 4, 6 descend.
    Alternating,
    /// All ascend.
    Ascending,
    /// All descend.
    Descending,
}

/// The words for the order of runs.
const ORDERS: [(&str, Order); 3] =
    [("alternating", Order::Alternating), ("ascending", Order::Ascending), ("descending", Order::Descending)];

/// A sign, and whether it is -1.
const SIGNS: [(&str, bool); 2] = [("1", false), ("-1", true)];

/// Reads `runs`.
pub(super) fn order(node: &Node, diagnostics: &mut Diagnostics) -> Option<Order> {
    choice(node, "`runs`", &ORDERS, diagnostics)
}

/// Reads `targets`, with the name of the column beside it.
pub(super) fn targets(
    node: &Node,
    name: Span,
    axis: Dimension,
    diagnostics: &mut Diagnostics,
) -> Option<(Targets, Option<String>)> {
    let known = ["origin", "most_negative", "sign", "unit", "column"];
    let fields = Fields::open(node, name, keys("`targets`"), &known, diagnostics)?;
    let mut position = |key: &str| {
        fields.get(key).and_then(|node| quantity::read(node, axis, &format!("`{key}`"), diagnostics))
    };
    let (origin, least) = (position("origin"), position("most_negative"));
    if fields.get("origin").is_some() && fields.get("most_negative").is_some() {
        diagnostics.push(both_begins(&fields));
    }
    let begin = match (origin, least) {
        (_, Some(least)) => Begin::MostNegative(least.value),
        (origin, None) => Begin::Origin(origin.map_or(0.0, |origin| origin.value)),
    };
    let against = sign(&fields, diagnostics)?;
    let unit = fields.get("unit").map(|node| unit(node, "the unit of the targets", axis, diagnostics));
    let unit = unit.flatten().map(|unit| unit.value);
    Some((Targets { begin, against, unit }, column(&fields, diagnostics)))
}

fn both_begins(fields: &Fields<'_>) -> Diagnostic {
    let message = "`origin` and `most_negative` both give the place of the targets";
    let mistake = Diagnostic::error("E0910", fields.key_span("most_negative"), message);
    mistake.also(fields.key_span("origin"), "also given here").help("keep one of the two")
}

/// Reads `deviations`, with the name of the column beside it.
pub(super) fn deviations(
    node: &Node,
    name: Span,
    (axis, motion): (Dimension, Dimension),
    diagnostics: &mut Diagnostics,
) -> Option<(Deviations, Option<String>)> {
    let known = ["sign", "unit", "column", "zero_at"];
    let fields = Fields::open(node, name, keys("`deviations`"), &known, diagnostics)?;
    let zero_at = fields.get("zero_at").and_then(|node| quantity::read(node, axis, "`zero_at`", diagnostics));
    let against = sign(&fields, diagnostics)?;
    let unit = fields.get("unit").map(|node| unit(node, "the unit of the deviations", motion, diagnostics));
    let zero_at = zero_at.map(|zero| (zero.value, zero.span));
    Some((Deviations { against, unit: unit.flatten(), zero_at }, column(&fields, diagnostics)))
}

fn sign(fields: &Fields<'_>, diagnostics: &mut Diagnostics) -> Option<bool> {
    match fields.get("sign") {
        None => Some(false),
        Some(node) if node.text() == Some("+1") => Some(false),
        Some(node) => choice(node, "`sign`", &SIGNS, diagnostics),
    }
}

fn column(fields: &Fields<'_>, diagnostics: &mut Diagnostics) -> Option<String> {
    let name = fields.get("column").and_then(|node| word(node, "`column`", diagnostics))?;
    Some(name.value.to_owned())
}
