//! One correction of a set-up: a file in which a controller keeps what it adds to commands. In: its mapping. Out: the file, and what
//! it does not say itself.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::fields::{self, Fields};
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::Spanned;
use model_dsl::yaml::Node;

use super::words::{FORM, choice, keys, word};
use crate::controller::{Kind, SavedWanted, Unit};

const KEYS: [&str; 8] = ["data", "axis", "type", "unit", "x", "y", "mesh", "skew"];

/// The types of LinuxCNC's screw tables.
const TYPES: [(&str, Kind); 2] = [("0", Kind::Actual), ("1", Kind::Trim)];

/// The units of length that LinuxCNC counts in.
const UNITS: [(&str, Unit); 2] = [("mm", Unit::MM), ("in", Unit::INCH)];

/// A file of corrections, and what the user says of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Correction {
    /// The file, a path from the set-up's folder.
    pub data: Spanned<String>,
    /// What it does not say itself.
    pub wanted: SavedWanted,
}

/// Reads `corrections`.
pub(super) fn read(
    node: &Node,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Correction>> {
    let items = fields::list(node, "`corrections`", FORM, diagnostics)?;
    if items.is_empty() {
        let mistake = Diagnostic::error("E0901", node.span, "`corrections` names no file");
        diagnostics.push(mistake.help("add `- {data: printer.cfg}`, or leave the key out"));
        return None;
    }
    items.iter().map(|item| read_one(item, equations, diagnostics)).collect()
}

fn read_one(node: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Correction> {
    let wording = keys("a correction");
    let fields = Fields::open(node, node.span, wording, &KEYS, diagnostics)?;
    let data = fields.need("data", wording, diagnostics);
    let data = data.and_then(|node| word(node, "`data`", diagnostics)).map(|name| name.map(str::to_owned));
    let axis = fields.get("axis").and_then(|node| axis(node, equations, diagnostics));
    let kind = fields.get("type").and_then(|node| choice(node, "`type`", &TYPES, diagnostics));
    let unit = fields.get("unit").and_then(|node| choice(node, "`unit`", &UNITS, diagnostics));
    let mut reach = |key| fields.get(key).and_then(|node| reach(node, key, diagnostics));
    let reach = [reach("x"), reach("y")];
    let mut name = |key: &str| {
        let name = fields.get(key).and_then(|node| word(node, &format!("`{key}`"), diagnostics))?;
        Some(name.value.to_owned())
    };
    let (mesh, skew) = (name("mesh"), name("skew"));
    Some(Correction { data: data?, wanted: SavedWanted { axis, kind, unit, reach, mesh, skew } })
}

fn axis(node: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<usize> {
    let letter = word(node, "`axis`", diagnostics)?;
    let found = equations.axes.iter().position(|axis| axis.letter == letter.value);
    if found.is_none() {
        let letters: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
        let message = format!("{} has no axis `{}`", equations.machine, letter.value);
        let help = format!("its axes are {}", letters.join(", "));
        diagnostics.push(Diagnostic::error("E0906", letter.span, message).help(help));
    }
    found
}

/// Two lengths, the lower first: mm.
fn reach(node: &Node, key: &str, diagnostics: &mut Diagnostics) -> Option<[f64; 2]> {
    let items = fields::list(node, &format!("`{key}`"), FORM, diagnostics)?;
    let mut end = |item| {
        quantity::read(item, Dimension::LENGTH, &format!("an end of `{key}`"), diagnostics)
            .map(|end| end.value)
    };
    let ends = match items {
        [from, to] => Some([end(from)?, end(to)?]),
        _ => None,
    };
    let rising = ends.filter(|[from, to]| from < to);
    if rising.is_none() {
        let message = format!("`{key}` must be the two ends of the mesh, the lower end first");
        let help = format!("write `{key}: [10 mm, 210 mm]`");
        diagnostics.push(Diagnostic::error(FORM, node.span, message).help(help));
    }
    rising
}
