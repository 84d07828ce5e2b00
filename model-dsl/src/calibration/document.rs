//! The calibration file as a whole: its top-level keys, constants, limits and error motions.

use super::fields::{Fields, keys, word};
use super::names::{MachineNames, MotionName};
use super::parameters::Context;
use super::read_term::{Item, read_item, read_plain};
use super::sensors::{Sensors, read_derived};
use super::small::refuse_large;
use super::tools::read_tools;
use super::{CalibratedMotion, Calibration, Limits, Ramp};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::another_kind;
use crate::quantity::{self, Dimension};
use crate::source::{Span, Spanned};
use crate::suggest::nearest;
use crate::yaml::{Node, NodeKind};
use std::collections::BTreeMap;

const KEYS: [&str; 8] =
    ["calibration", "machine", "source", "constants", "tools", "limits", "sensors", "errors"];

/// Reads the name of the machine that a calibration is for, and nothing else.
///
/// Findings: E0401 there is none, E0402 this is another kind of file, E0404 it is not a name, or the file is no mapping at all. [`read`] does not repeat them.
pub fn machine_of(root: &Node, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    if let Some(kind) = another_kind(root, "calibration") {
        let message = format!("this is {kind}, not a calibration file");
        let mistake = Diagnostic::error("E0402", first_key(root), message);
        diagnostics
            .push(mistake.help("a calibration file begins with `calibration: 1` and names its machine"));
        return None;
    }
    if root.entries().is_none() {
        let message = format!("a calibration must be a mapping of keys, found {}", root.kind_name());
        let mistake = Diagnostic::error("E0404", root.span, message);
        diagnostics.push(mistake.help("begin with `calibration: 1` and `machine: ...`"));
        return None;
    }
    let Some(node) = root.get("machine") else {
        let mistake = Diagnostic::error("E0401", first_key(root), "a calibration needs the key `machine`");
        diagnostics.push(mistake.help("add `machine: ...`, the name of a machine or the path of its file"));
        return None;
    };
    word(node, "`machine`", diagnostics)
}

/// Reads a calibration against the names of its machine.
///
/// Every finding is reported: the codes are listed in this module's head. Nothing is returned where one is an error.
pub fn read(root: &Node, names: &MachineNames, diagnostics: &mut Diagnostics) -> Option<Calibration> {
    root.entries()?;
    let mut own = Diagnostics::new();
    let calibration = read_all(root, names, &mut own);
    let failed = own.has_errors();
    diagnostics.extend(own);
    if failed { None } else { calibration }
}

fn read_all(root: &Node, names: &MachineNames, diagnostics: &mut Diagnostics) -> Option<Calibration> {
    let fields = Fields::open(root, first_key(root), keys("a calibration"), &KEYS, diagnostics)?;
    if let Some(version) = fields.need("calibration", keys("a calibration"), diagnostics) {
        check_version(version, diagnostics);
    }
    let source = fields.get("source").and_then(|node| word(node, "`source`", diagnostics));
    let constants = read_constants(&fields, names, diagnostics);
    let tools = present(&fields, "tools").map(|node| read_tools(node, names, &constants, diagnostics));
    let limits =
        present(&fields, "limits").map(|node| read_limits(node, fields.key_span("limits"), diagnostics));
    let sensors = present(&fields, "sensors").map(|node| read_derived(node, diagnostics));
    let mut sensors = sensors.unwrap_or_default();
    let errors = present(&fields, "errors");
    let [motions, unseen] =
        errors.map(|node| read_motions(node, names, &mut sensors, diagnostics)).unwrap_or_default();
    sensors.warn_unused(diagnostics);
    let machine = word(root.get("machine")?, "`machine`", &mut Diagnostics::new())?;
    Some(Calibration {
        machine,
        source: source.map(|text| text.value),
        constants,
        tools: tools.unwrap_or_default(),
        limits: limits.unwrap_or_default(),
        sensors,
        motions,
        unseen,
    })
}

/// The value of a key, where there is the key and anything behind it.
fn present<'n>(fields: &Fields<'n>, key: &str) -> Option<&'n Node> {
    fields.get(key).filter(|node| node.kind != NodeKind::Null)
}

fn first_key(root: &Node) -> Span {
    let first = root.entries().and_then(<[_]>::first);
    first.map_or(root.span, |(key, _)| key.span)
}

fn check_version(node: &Node, diagnostics: &mut Diagnostics) {
    if node.text() == Some("1") {
        return;
    }
    let message = match node.text() {
        Some(text) => format!("version `{text}` of the calibration format is unknown"),
        None => format!("`calibration` must be the version of the format, found {}", node.kind_name()),
    };
    diagnostics.push(Diagnostic::error("E0402", node.span, message).help("write `calibration: 1`"));
}

/// The machine's constants in its order; 0 for one that is reported.
fn read_constants(fields: &Fields<'_>, names: &MachineNames, diagnostics: &mut Diagnostics) -> Vec<f64> {
    let mut given = BTreeMap::new();
    if let Some(node) = present(fields, "constants") {
        let Some(entries) = node.entries() else {
            let message =
                format!("`constants` must be a mapping of names to lengths, found {}", node.kind_name());
            diagnostics.push(Diagnostic::error("E0404", node.span, message).help("write `{Xt: 0 mm}`"));
            return Vec::new();
        };
        for (name, value) in entries {
            check_constant(name, names, diagnostics);
            let words = format!("`{}`", name.value);
            let value = quantity::read(value, Dimension::LENGTH, &words, diagnostics);
            given.insert(name.value.as_str(), value.map_or(0.0, |value| value.value));
        }
    }
    let missing_at = fields.key_span(if fields.get("constants").is_some() { "constants" } else { "machine" });
    let values = names.constants.iter().map(|(name, default)| {
        let value = given.get(name.as_str()).copied().or(*default);
        if value.is_none() {
            diagnostics.push(missing_constant(name, names, missing_at));
        }
        value.unwrap_or(0.0)
    });
    values.collect()
}

fn missing_constant(name: &str, names: &MachineNames, span: Span) -> Diagnostic {
    let message = format!("{} needs a value for its constant `{name}`", names.machine);
    Diagnostic::error("E0406", span, message).help(format!("add `{name}: ... mm` to `constants`"))
}

pub(super) fn check_constant(name: &Spanned<String>, names: &MachineNames, diagnostics: &mut Diagnostics) {
    let mut known = names.offsets().map(|(known, _)| known.as_str());
    if known.clone().any(|known| known == name.value) {
        return;
    }
    let message = format!("{} has no constant `{}`", names.machine, name.value);
    let mistake = Diagnostic::error("E0405", name.span, message);
    let near = nearest(&name.value, known.by_ref());
    let listed: Vec<_> = names.offsets().map(|(known, _)| known.as_str()).collect();
    let is_part = names.constants.iter().any(|(part, _)| *part == name.value);
    diagnostics.push(match (near, listed.as_slice()) {
        _ if is_part => mistake.help(
            "it is a part of the tool's direction: write `direction: [0, 1, 0]` for a tool under `tools`",
        ),
        (Some(near), _) => mistake.suggest(Some(near)),
        (None, []) => mistake.help("leave it out: the machine has no constants"),
        (None, listed) => mistake.help(format!("its constants are {}", listed.join(", "))),
    });
}

/// A limit of zero forbids what it limits; only the time for which a reading is held may be zero.
fn read_limits(node: &Node, name: Span, diagnostics: &mut Diagnostics) -> Limits {
    let known = ["compensation", "rotation", "rate", "rotation_rate", "hold", "fade"];
    let Some(fields) = Fields::open(node, name, keys("`limits`"), &known, diagnostics) else {
        return Limits::default();
    };
    let mut read = |key: &str, dimension: Dimension, example: &str| {
        let words = format!("`{key}`");
        let value = fields.get(key).and_then(|node| quantity::read(node, dimension, &words, diagnostics))?;
        if value.value > 0.0 || key == "hold" && value.value == 0.0 {
            return Some(value);
        }
        let least = if key == "hold" { "not be below zero" } else { "be greater than zero" };
        let mistake = Diagnostic::error("E0419", value.span, format!("{words} must {least}"));
        diagnostics.push(mistake.help(format!("write {example}")));
        None
    };
    Limits {
        compensation: read(
            "compensation",
            Dimension::LENGTH,
            "the largest correction that may be applied, such as `0.2 mm`",
        ),
        rotation: read(
            "rotation",
            Dimension::ANGLE,
            "the largest correction of a rotary axis that may be applied, such as `60 arcsec`",
        ),
        rate: read(
            "rate",
            Dimension::LENGTH.per(Dimension::TIME),
            "the fastest change of a correction that the drives can follow, such as `2 mm/s`",
        ),
        rotation_rate: read(
            "rotation_rate",
            Dimension::ANGLE.per(Dimension::TIME),
            "the fastest change of a rotary axis's correction that its drive can follow, such as `1 mrad/s`",
        ),
        hold: read(
            "hold",
            Dimension::TIME,
            "how long the last reading of a silent sensor stays valid, such as `10 s`",
        ),
        fade: read(
            "fade",
            Dimension::TIME,
            "the time over which a correction is blended in or out, such as `1 s`",
        ),
    }
}

fn read_motions(
    node: &Node,
    names: &MachineNames,
    sensors: &mut Sensors,
    diagnostics: &mut Diagnostics,
) -> [Vec<CalibratedMotion>; 2] {
    let Some(entries) = node.entries() else {
        let message =
            format!("`errors` must be a mapping of error motions to terms, found {}", node.kind_name());
        diagnostics.push(
            Diagnostic::error("E0404", node.span, message)
                .help("write one line `EXX: [...]` for each error motion"),
        );
        return Default::default();
    };
    let mut places = BTreeMap::new();
    let (mut motions, mut unseen) = (Vec::new(), Vec::new());
    for (name, value) in entries {
        let (listed, motion, known) = match (names.motion(&name.value), names.unseen_motion(&name.value)) {
            (Some(motion), _) => (&mut motions, motion, &names.motions),
            (None, Some(motion)) => {
                diagnostics.push(without_effect(name, names));
                (&mut unseen, motion, &names.unseen)
            }
            (None, None) => {
                diagnostics.push(unknown_motion(name, names));
                continue;
            }
        };
        let Some(known) = known.get(motion) else { continue };
        if let Some(first) = places.insert(known.name.as_str(), name.span) {
            diagnostics.push(repeated_motion(known, name, first));
        }
        let items = read_terms(known, value, names, sensors, diagnostics);
        let ramped = items.iter().enumerate().filter(|(_, item)| item.ramp > 0.0);
        let ramps = ramped.map(|(term, item)| Ramp { term, time: item.ramp }).collect();
        let answered = items.iter().enumerate().filter(|(_, item)| item.inside_loop);
        let inside_loop = answered.map(|(term, _)| term).collect();
        let terms = items.into_iter().map(|item| item.term).collect();
        listed.push(CalibratedMotion { motion, span: name.span, terms, ramps, inside_loop });
    }
    [motions, unseen]
}

fn without_effect(name: &Spanned<String>, names: &MachineNames) -> Diagnostic {
    let message = format!("{} has no effect on {}", name.value, names.machine);
    Diagnostic::warning("W0402", name.span, message)
        .label("it has no lever arm at the tool tip")
        .help("keep its numbers if a tool or part at another place needs them; Abbe reads them and writes them back")
}

fn unknown_motion(name: &Spanned<String>, names: &MachineNames) -> Diagnostic {
    let message = format!("{} has no error motion `{}`", names.machine, name.value);
    let mistake = Diagnostic::error("E0407", name.span, message);
    if let Some(reason) = names.miscounted(&name.value) {
        return mistake
            .label(reason)
            .help("write the alignment error without an axis; it is counted from the frame before its link");
    }
    // A motion of a link is no suggestion for an alignment error: both may be angles, and mean other things.
    let aligns = |name: &str| name.contains('0');
    let alike = names.motions.iter().map(|motion| motion.name.as_str());
    let alike: Vec<&str> = alike.filter(|known| aligns(known) == aligns(&name.value)).collect();
    match nearest(&name.value, alike.iter().copied()) {
        Some(near) if !aligns(&name.value) => mistake.suggest(Some(near)),
        _ if aligns(&name.value) => mistake.help(format!(
            "its alignment errors are {}; list any other one under `errors` in the machine file (it is counted from another axis)",
            if alike.is_empty() { "none".to_owned() } else { alike.join(", ") }
        )),
        _ => mistake.help(format!("its error motions are {}", alike.join(", "))),
    }
}

fn repeated_motion(known: &MotionName, name: &Spanned<String>, first: Span) -> Diagnostic {
    let known = &known.name;
    let message = format!("{known} is given twice");
    let mistake = Diagnostic::error("E0408", name.span, message).also(first, "first given here");
    mistake.help(format!(
        "put all terms of {known} into one list; spellings such as C0Y and EC0Y are the same motion"
    ))
}

fn read_terms(
    motion: &MotionName,
    node: &Node,
    names: &MachineNames,
    sensors: &mut Sensors,
    diagnostics: &mut Diagnostics,
) -> Vec<Item> {
    let mut context = Context { names, motion, sensors, diagnostics };
    let items = read_items(node, &mut context);
    items.iter().for_each(|item| refuse_large(&item.term, &mut context));
    items
}

fn read_items(node: &Node, context: &mut Context<'_>) -> Vec<Item> {
    let motion = context.motion;
    match &node.kind {
        NodeKind::Scalar(_) => read_plain(node, context).into_iter().collect(),
        NodeKind::Sequence(items) => items.iter().filter_map(|item| read_item(item, context)).collect(),
        NodeKind::Null | NodeKind::Mapping(_) => {
            let message =
                format!("{} must be a quantity or a list of terms, found {}", motion.name, node.kind_name());
            let help = format!(
                "write `{}: [{{backlash: {{lost_motion: ...}}}}]`, or begin each term with `-`",
                motion.name
            );
            context.diagnostics.push(Diagnostic::error("E0404", node.span, message).help(help));
            Vec::new()
        }
    }
}
