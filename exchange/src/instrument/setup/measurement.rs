//! One measurement of a set-up. In: its mapping and the machine's equations. Out: which motion it shows over which axis, and what
//! to do with its readings.

use model_dsl::calibration::MachineNames;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::{Equations, Motion};
use model_dsl::fields::Fields;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::suggest::nearest;
use model_dsl::yaml::Node;

use super::counting::{self, Deviations, Order, Targets};
use super::place::{self, Place};
use super::words::{choice, keys, word};

const KEYS: [&str; 14] = [
    "motion",
    "data",
    "axis",
    "at",
    "targets",
    "deviations",
    "runs",
    "remove",
    "reference",
    "turned",
    "placement",
    "reversal",
    "smooth",
    "resample",
];

/// The widest moving mean, in targets.
const WIDEST: f64 = 101.0;

/// One file, and what it shows.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The error motion: an index into [`Equations::motions`].
    pub motion: Spanned<usize>,
    /// The file, a path from the set-up's folder.
    pub data: Spanned<String>,
    /// The axis that moves: an index into [`Equations::axes`].
    pub axis: usize,
    /// Where it was taken, where the set-up says it; then lever arms are taken off.
    pub at: Option<Place>,
    /// How its targets count.
    pub targets: Targets,
    /// The column of a table that holds the targets, where it is named.
    pub target_column: Option<String>,
    /// How its deviations count.
    pub deviations: Deviations,
    /// The column of a table that holds the deviations, where it is named.
    pub deviation_column: Option<String>,
    /// Which way its runs go, where the set-up says it.
    pub runs: Option<Spanned<Order>>,
    /// What is taken off its curve.
    pub remove: Remove,
    /// The straightedge or square that it was measured against.
    pub reference: Option<Spanned<String>>,
    /// Whether that edge was turned over for it.
    pub turned: bool,
    /// Which of repeated set-ups of the same edge or square it is of, 1 for the first.
    pub placement: u8,
    /// What stands for the difference of the directions.
    pub reversal: Form,
    /// The number of targets in a moving mean, odd, 3 or more; none where nothing is smoothed.
    pub smooth: Option<usize>,
    /// The step of the table, mm or rad; none where its nodes are the targets.
    pub resample: Option<Spanned<f64>>,
}

impl Measurement {
    /// Whether both show one motion in one set-up of its edge.
    pub(crate) fn is_of(&self, other: &Self) -> bool {
        self.motion == other.motion && self.placement == other.placement
    }
}

/// What is taken off a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Remove {
    /// The least-squares line.
    Line,
    /// The line through the ends.
    Ends,
    /// Nothing.
    Nothing,
}

/// What stands in the calibration for the difference of the directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A table of its own for each direction.
    Tables,
    /// The mean of both directions, and a `backlash` of the mean difference.
    Backlash,
}

const REMOVES: [(&str, Remove); 3] =
    [("line", Remove::Line), ("ends", Remove::Ends), ("none", Remove::Nothing)];
const FORMS: [(&str, Form); 2] = [("tables", Form::Tables), ("backlash", Form::Backlash)];

/// Reads one item of `measurements`.
pub(super) fn read(node: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Measurement> {
    let wording = keys("a measurement");
    let fields = Fields::open(node, node.span, wording, &KEYS, diagnostics)?;
    let motion = fields.need("motion", wording, diagnostics);
    let motion = motion.and_then(|node| read_motion(node, equations, diagnostics));
    let data = fields.need("data", wording, diagnostics);
    let data = data.and_then(|node| word(node, "`data`", diagnostics));
    let (motion, data) = (motion?, data?);
    let known = equations.motions.get(motion.value)?;
    let axis = read_axis(&fields, motion, known, equations, diagnostics)?;
    let at = fields.get("at").and_then(|node| read_at(node, &fields, (axis, known), equations, diagnostics));
    let along = dimension(equations.axes.get(axis).is_some_and(|axis| axis.rotary));
    let counted = read_counted(&fields, (along, dimension(known.angular)), diagnostics)?;
    let ((targets, target_column), (deviations, deviation_column)) = counted;
    let straightness = is_straightness(known, motion.value, &equations.names());
    let runs = fields
        .get("runs")
        .and_then(|node| counting::order(node, diagnostics).map(|order| Spanned::new(order, node.span)));
    let reversal = fields.get("reversal").and_then(|node| choice(node, "`reversal`", &FORMS, diagnostics));
    let turned = read_flag(&fields, "turned", diagnostics)?;
    let reference = fields.get("reference").and_then(|node| word(node, "`reference`", diagnostics));
    if let Some(edge) = edge_of(&fields).filter(|_| !straightness) {
        diagnostics.push(no_edge(edge, &known.name, &fields));
    }
    let remove = read_remove(&fields, straightness, diagnostics);
    if let Some(name) = reference.filter(|_| straightness && remove != Remove::Line) {
        diagnostics.push(no_line(name.span, &known.name, &fields));
    }
    Some(Measurement {
        motion,
        data: data.map(str::to_owned),
        axis,
        at,
        targets,
        target_column,
        deviations,
        deviation_column,
        runs,
        remove,
        reference: reference.map(|name| name.map(str::to_owned)),
        turned,
        placement: read_placement(&fields, diagnostics)?,
        reversal: reversal.unwrap_or(Form::Tables),
        smooth: read_smooth(&fields, diagnostics),
        resample: read_resample(&fields, along, diagnostics),
    })
}

/// How targets and deviations count, each with the name of its column. Where a key is left out its default counts; where its value
/// was refused there is nothing.
#[expect(clippy::type_complexity, reason = "two pairs that are taken apart at once")]
fn read_counted(
    fields: &Fields<'_>,
    (along, of_motion): (Dimension, Dimension),
    diagnostics: &mut Diagnostics,
) -> Option<((Targets, Option<String>), (Deviations, Option<String>))> {
    let targets = fields
        .get("targets")
        .map(|node| counting::targets(node, fields.key_span("targets"), along, diagnostics));
    let deviations = fields.get("deviations").map(|node| {
        counting::deviations(node, fields.key_span("deviations"), (along, of_motion), diagnostics)
    });
    let targets = targets.unwrap_or_else(|| Some(Default::default()));
    let deviations = deviations.unwrap_or_else(|| Some(Default::default()));
    Some((targets?, deviations?))
}

/// What is taken off: of a straightness its line, unless the set-up says otherwise.
fn read_remove(fields: &Fields<'_>, straightness: bool, diagnostics: &mut Diagnostics) -> Remove {
    let usual = if straightness { Remove::Line } else { Remove::Nothing };
    let written = fields.get("remove").and_then(|node| choice(node, "`remove`", &REMOVES, diagnostics));
    written.unwrap_or(usual)
}

/// The slope of a line that stays in a straightness must not make a squareness too (E0910).
fn no_line(reference: Span, motion: &str, fields: &Fields<'_>) -> Diagnostic {
    let message =
        format!("a squareness needs the least-squares line of {motion}, so the line is not removed");
    let mistake = Diagnostic::error("E0910", fields.key_span("remove"), message);
    mistake.also(reference, "measured against a square").help("remove `remove` or `reference`")
}

/// Reads where a displacement was measured; a rotation is the same everywhere (E0910).
fn read_at(
    node: &Node,
    fields: &Fields<'_>,
    (axis, known): (usize, &Motion),
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<Place> {
    if known.angular {
        let message = format!("{} is a rotation, which is the same wherever it is measured", known.name);
        let mistake = Diagnostic::error("E0910", fields.key_span("at"), message);
        diagnostics.push(mistake.help("remove `at`; it is for subtracting lever arms from displacements"));
    }
    place::read(node, axis, equations, diagnostics)
}

fn dimension(angular: bool) -> Dimension {
    if angular { Dimension::ANGLE } else { Dimension::LENGTH }
}

/// Whether a motion is a displacement across the axis that moves: what an edge shows.
fn is_straightness(motion: &Motion, number: usize, names: &MachineNames) -> bool {
    let own = names.motions.get(number).and_then(|motion| names.own_axis(motion)).is_some();
    let slide = motion.axis.and_then(|axis| names.axes.get(axis)).is_some_and(|axis| !axis.rotary);
    !motion.angular && !motion.alignment && !own && slide
}

fn edge_of(fields: &Fields<'_>) -> Option<&'static str> {
    ["reference", "turned", "placement"].into_iter().find(|key| fields.get(key).is_some())
}

fn no_edge(key: &'static str, motion: &str, fields: &Fields<'_>) -> Diagnostic {
    let message = format!("{motion} is not measured against an edge, so `{key}` has no meaning");
    let help = "use an edge for the straightness of a slide, such as EYX";
    Diagnostic::error("E0912", fields.key_span(key), message).help(help)
}

fn read_motion(node: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Spanned<usize>> {
    let name = word(node, "`motion`", diagnostics)?;
    let names = equations.names();
    let Some(number) = names.motion(name.value) else {
        let message = format!("{} has no error motion `{}`", equations.machine, name.value);
        let mistake = Diagnostic::error("E0905", name.span, message);
        let measured = equations.motions.iter().filter(|motion| !motion.alignment);
        let listed: Vec<&str> = measured.map(|motion| motion.name.as_str()).collect();
        diagnostics.push(match nearest(name.value, listed.iter().copied()) {
            Some(near) => mistake.suggest(Some(near)),
            None => mistake.help(format!("its error motions are {}", listed.join(", "))),
        });
        return None;
    };
    if equations.motions.get(number).is_some_and(|motion| motion.alignment) {
        let message = format!("{} is an alignment error, which no single file shows", name.value);
        let help = "measure two straightnesses against one `reference`, or write the angle under `errors`";
        diagnostics.push(Diagnostic::error("E0905", name.span, message).help(help));
        return None;
    }
    Some(Spanned::new(number, name.span))
}

/// The axis that the set-up names, or that of the motion's link.
fn read_axis(
    fields: &Fields<'_>,
    motion: Spanned<usize>,
    known: &Motion,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<usize> {
    let letters: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
    let Some(node) = fields.get("axis") else {
        if known.axis.is_none() {
            let message =
                format!("{} does not belong to an axis, so the moving axis must be named", known.name);
            let help = format!("add `axis:` with one of {}", letters.join(", "));
            diagnostics.push(Diagnostic::error("E0906", motion.span, message).help(help));
        }
        return known.axis;
    };
    let letter = word(node, "`axis`", diagnostics)?;
    let found = letters.iter().position(|known| *known == letter.value);
    if found.is_none() {
        let message = format!("{} has no axis `{}`", equations.machine, letter.value);
        let help = format!("its axes are {}", letters.join(", "));
        diagnostics.push(Diagnostic::error("E0906", letter.span, message).help(help));
    }
    found
}

fn read_flag(fields: &Fields<'_>, key: &str, diagnostics: &mut Diagnostics) -> Option<bool> {
    match fields.get(key) {
        None => Some(false),
        Some(node) => choice(node, &format!("`{key}`"), &[("true", true), ("false", false)], diagnostics),
    }
}

/// The number of a set-up (E0907).
fn read_placement(fields: &Fields<'_>, diagnostics: &mut Diagnostics) -> Option<u8> {
    let Some(node) = fields.get("placement") else { return Some(1) };
    let number = quantity::read_number(node, "`placement`", diagnostics)?;
    let found = (1..=99).find(|placement: &u8| f64::from(*placement) == number.value);
    if found.is_none() {
        let message = "`placement` must be the number of a set-up of one edge or square: 1, 2, 3, up to 99";
        let help = "write `placement: 2` for the measurements after the second set-up";
        diagnostics.push(Diagnostic::error("E0907", number.span, message).help(help));
    }
    found
}

fn read_smooth(fields: &Fields<'_>, diagnostics: &mut Diagnostics) -> Option<usize> {
    let width = quantity::read_number(fields.get("smooth")?, "`smooth`", diagnostics)?;
    let odd = (3..=101).step_by(2).find(|odd| f64::from(*odd) == width.value);
    let found = odd.and_then(|odd: u8| (width.value <= WIDEST).then_some(usize::from(odd)));
    if found.is_none() {
        let message = "`smooth` must be the number of targets in a moving mean: 3, 5, 7, up to 101";
        diagnostics
            .push(Diagnostic::error("E0907", width.span, message).help("write `smooth: 3`, or leave it out"));
    }
    found
}

fn read_resample(
    fields: &Fields<'_>,
    axis: Dimension,
    diagnostics: &mut Diagnostics,
) -> Option<Spanned<f64>> {
    let step = quantity::read(fields.get("resample")?, axis, "`resample`", diagnostics)?;
    if step.value > 0.0 {
        return Some(step);
    }
    let mistake = Diagnostic::error("E0907", step.span, "`resample` must be a step greater than zero");
    diagnostics
        .push(mistake.help("write the step of the table, or leave it out to use the targets as nodes"));
    None
}
