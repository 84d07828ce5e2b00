//! The validated machine: a topology without numbers that a measurement would change.
//!
//! In: a machine file as text. Out: a [`Machine`], in which every name is resolved, every
//! link stands in its branch and every error motion on its link, or a list of located
//! mistakes. What a machine means, its equations, is the business of [`crate::derivation`].

mod budget;
mod chain;
mod constants;
mod draft;
mod drive;
mod fields;
mod header;
mod link;
mod motion;
mod motor;
mod names;
mod orientation;
mod pointing;
mod read_along;
mod read_link;
mod read_motion;
pub(crate) mod reference;
mod topology;
mod turned;
mod usual_motions;
mod words;

pub use constants::Constant;
pub use drive::{Drive, Element, ElementKind};
pub use link::{Along, Branch, Link, LinkKind, Reference};
pub(crate) use motion::body_sign;
pub use motion::{Motion, MotionKind, MotionName, parse_name, without_reference};
pub use motor::{Beam, Motor, Moved};
pub use orientation::Orientation;
pub(crate) use read_link::own_direction;
pub(crate) use read_motion::kind_of;
pub use reference::Counted;
pub use topology::{TopologyWord, template};
pub use turned::Turned;

use crate::algebra::{Axis, Name};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::kind::another_kind;
use crate::source::{SourceFile, Span};
use crate::yaml::Node;

/// A machine's kinematic chain and the error motions of its links.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The machine's name, by which calibrations and recordings refer to it.
    pub name: String,
    /// A line for people.
    pub title: Option<String>,
    /// Where the model was published.
    pub source: Option<String>,
    /// The topology word, where the file has one.
    pub topology: Option<String>,
    /// The directions derived and compensated, in the part's frame.
    pub sensitive: Vec<Axis>,
    /// Where the file lists the sensitive directions itself, the place of each.
    pub sensitive_spans: Vec<(Axis, Span)>,
    /// Whether error motions are those of the tool relative to the part (`motions: relative`).
    pub relative: bool,
    /// What becomes of the direction of the tool.
    pub orientation: Orientation,
    /// The named offsets, in order of first mention or as declared.
    pub constants: Vec<Constant>,
    /// The links of both branches, each branch from the bed outwards, the part's branch first.
    pub links: Vec<Link>,
    /// The error motions: by axis, then by direction, alignment errors last; behind them those of motors.
    pub motions: Vec<Motion>,
    /// The motors that move several axes, or that share one.
    pub motors: Vec<Motor>,
    /// What the file says of the drives of axes.
    pub drives: Vec<Drive>,
}

impl Machine {
    /// The links of one branch, from the bed outwards, with their numbers in [`Machine::links`].
    pub fn branch(&self, branch: Branch) -> impl Iterator<Item = (usize, &Link)> {
        self.links.iter().enumerate().filter(move |(_, link)| link.branch == branch)
    }

    /// The direction of the tool from its tip towards the spindle, in the tool's frame: along the spindle that carries it, +Z where
    /// none does. A rotary axis between both carries the tool, and no spindle then; nor where a body between both is turned, as the
    /// angle head in a spindle is.
    pub fn tool_axis(&self) -> Along {
        tool_axis(self.links.iter())
    }

    /// The names of the parts of the tool's direction in its frame, where each tool of a calibration has one.
    pub fn tool_direction(&self) -> Option<[&Name; 3]> {
        let part = |axis| self.constants.iter().find(|constant| constant.direction == Some(axis));
        let [x, y, z] = Axis::ALL.map(|axis| part(axis).map(|constant| &constant.name));
        Some([x?, y?, z?])
    }

    /// What an alignment error is, counted from each other axis that shows it, by its number in [`Machine::motions`]; none for any
    /// other error motion.
    pub fn counted(&self, motion: usize) -> Vec<Counted> {
        let placed = reference::placed(&self.links, &self.motions, self.relative);
        placed.get(motion).map(|own| reference::counted(&self.links, &placed, own)).unwrap_or_default()
    }

    /// The links that a program moves, in the order X Y Z U V W A B C, with their numbers.
    pub fn axes(&self) -> Vec<(usize, &Link)> {
        let mut axes: Vec<_> = self.links.iter().enumerate().filter(|(_, link)| link.is_axis()).collect();
        axes.sort_by_key(|(_, link)| link.kind.axis_rank());
        axes
    }
}

/// The direction of a tool without one of its own.
fn tool_axis<'l>(links: impl DoubleEndedIterator<Item = &'l Link>) -> Along {
    let outwards = links.rev().filter(|link| link.branch == Branch::Tool);
    let mut behind =
        outwards.take_while(|link| !matches!(link.kind, LinkKind::Rotary(_)) && link.turned.is_none());
    let spindle = behind.find(|link| link.kind == LinkKind::Spindle);
    spindle.map(|spindle| spindle.along).unwrap_or_default()
}

/// Reads a bare topology word (`XYFZ`, `FX`) as a machine of that name. The tip of a single stage is its
/// carriage: the offset of its tool is zero where a calibration gives no other.
pub fn from_word(word: &str, span: Span, diagnostics: &mut Diagnostics) -> Option<Machine> {
    let chain = topology::expand(word, span, diagnostics)?;
    let header = header::Header::bare(word);
    let mut machine = build(header, chain, constants::Declared::None, Default::default(), diagnostics)?;
    if machine.axes().len() == 1 {
        machine.constants.iter_mut().for_each(|constant| constant.default = Some(0.0));
    }
    Some(machine)
}

/// Reads a machine file. Every mistake is reported; the machine is given where there is no error.
pub fn read(source: &SourceFile, diagnostics: &mut Diagnostics) -> Option<Machine> {
    let root = crate::yaml::read(source, diagnostics)?;
    read_node(&root, diagnostics)
}

fn read_node(root: &Node, diagnostics: &mut Diagnostics) -> Option<Machine> {
    if let Some(kind) = another_kind(root, "abbe") {
        let place = fields::place(root);
        diagnostics.push(
            Diagnostic::error("E0119", place, format!("this is {kind}, not a machine file"))
                .label("a machine file begins with `abbe: 1`")
                .help("give the machine file, or the machine that its key `machine` names"),
        );
        return None;
    }
    let fields = fields::open(root, "a machine file", &KEYS, diagnostics)?;
    let header = header::read(fields, diagnostics);
    let declared = constants::declared(fields.get("constants"), diagnostics);
    let chain = chain::read(root, fields, header.reference, diagnostics);
    let motors = chain.as_ref().map(|chain| motor::read(fields, chain, diagnostics)).unwrap_or_default();
    let drives = drive::read(fields.get("drive"), &motors, diagnostics);
    let machine = build(header, chain?, declared, (drives, motors), diagnostics)?;
    (!diagnostics.has_errors()).then_some(machine)
}

/// The keys of a machine file.
const KEYS: [&str; 14] = [
    "abbe",
    "name",
    "title",
    "source",
    "sensitive",
    "reference",
    "motions",
    "orientation",
    "budget",
    "constants",
    "topology",
    "chain",
    "transmission",
    "drive",
];

fn build(
    header: header::Header,
    chain: draft::Chain<'_>,
    declared: constants::Declared,
    (drives, motors): (Vec<Drive>, Vec<Motor>),
    diagnostics: &mut Diagnostics,
) -> Option<Machine> {
    let motions = read_motion::collect(&chain, diagnostics);
    let motions = budget::kept(header.budget, &chain, motions, diagnostics);
    read_motion::check_references(&motions, &chain, header.relative, diagnostics);
    let motions = [motions, motor::motions(&motors, &chain)].concat();
    let tool_axis = tool_axis(chain.links.iter().map(|drafted| &drafted.link));
    let constants = constants::settle(declared, &chain, diagnostics);
    let pointing = (tool_axis, header.orientation.is_derived());
    let constants = pointing::settle(constants, &chain, pointing, diagnostics);
    drive::settle(&drives, &chain, &motors, diagnostics);
    let links_are_distinct = !diagnostics.iter().any(|known| matches!(known.code, "E0123" | "E0124"));
    if links_are_distinct {
        let printed =
            names::Printed { sensitive: &header.sensitive, orientation: header.orientation.is_derived() };
        names::check_names(&motions, &constants, &chain, &motors, printed, diagnostics);
    }
    if diagnostics.has_errors() {
        return None;
    }
    Some(Machine {
        name: header.name,
        title: header.title,
        source: header.source,
        topology: chain.topology,
        sensitive: header.sensitive,
        sensitive_spans: header.sensitive_spans,
        relative: header.relative,
        orientation: header.orientation,
        constants,
        links: chain.links.into_iter().map(|drafted| drafted.link).collect(),
        motions,
        motors,
        drives,
    })
}
