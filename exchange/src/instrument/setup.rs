//! The set-up file: what no instrument writes into its own. In: its tree and the machine's equations. Out: for each measurement
//! the error motion that it shows, how its file counts and what is to be done with it; and what the calibration holds besides.
//!
//! A set-up is the head of a calibration file (`machine`, `constants`, `limits`, `sensors`, and under `errors` what is known
//! otherwise) with `measurements` in place of the numbers. That head is read by [`model_dsl::calibration`] itself.

mod correction;
mod counting;
mod diagonals;
mod measurement;
mod place;
mod reference;
mod words;

use model_dsl::calibration::{self, CalibratedTerm, Calibration};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::fields::{self, Fields};
use model_dsl::kind::another_kind;
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::{Node, NodeKind, Scalar};

pub use correction::Correction;
pub use counting::{Begin, Deviations, Order, Targets};
pub use measurement::{Form, Measurement, Remove};
pub use place::Place;
pub use reference::Reference;
pub(super) use words::as_dimension;
use words::{FORM, first_key, keys, word};

const KEYS: [&str; 12] = [
    "setup",
    "machine",
    "source",
    "constants",
    "limits",
    "sensors",
    "errors",
    "volumetric",
    "corrections",
    "diagonals",
    "references",
    "measurements",
];

/// The keys that a set-up has in common with a calibration file.
const OF_CALIBRATION: [&str; 6] = ["machine", "source", "constants", "limits", "sensors", "errors"];

/// A set-up file.
#[derive(Clone, Debug)]
pub struct Setup {
    /// What the calibration holds besides the measurements: constants, limits, error motions known otherwise.
    pub known: Calibration,
    /// Straightedges and squares, in the file's order.
    pub references: Vec<Reference>,
    /// The file of a volumetric compensation whose error motions are taken over.
    pub volumetric: Option<Spanned<String>>,
    /// Files of controllers whose corrections are taken over, in the file's order.
    pub corrections: Vec<Correction>,
    /// How much Y leans towards X, Z towards X and Z towards Y, for each mm, as the lengths of squares show it; and where they stand.
    pub diagonals: Option<Spanned<[f64; 3]>>,
    /// The measurements, in the file's order; none only where there is another file.
    pub measurements: Vec<Measurement>,
}

/// Reads the name of the machine that was measured, and nothing else.
///
/// Findings: E0901 there is none, E0902 this is another kind of file, E0904 it is not a name, or the file is no mapping.
pub fn machine_of(root: &Node, diagnostics: &mut Diagnostics) -> Option<Spanned<String>> {
    if root.entries().is_none() {
        let message = format!("a set-up must be a mapping of keys, found {}", root.kind_name());
        let mistake = Diagnostic::error(FORM, root.span, message);
        diagnostics.push(mistake.help("begin with `setup: 1` and `machine: ...`"));
        return None;
    }
    if let Some(kind) = another_kind(root, "setup") {
        let message = format!("this is {kind}, not a set-up file");
        let mistake = Diagnostic::error("E0902", first_key(root), message);
        diagnostics.push(mistake.help("begin with `setup: 1`, and name the machine and the measurements"));
        return None;
    }
    let Some(node) = root.get("machine") else {
        let mistake = Diagnostic::error("E0901", first_key(root), "a set-up needs the key `machine`");
        let help = "add `machine: ...`, the name of a machine, the path of its file, or a topology word";
        diagnostics.push(mistake.help(help));
        return None;
    };
    word(node, "`machine`", diagnostics).map(|name| name.map(str::to_owned))
}

/// Reads everything that the set-up file says, for a machine whose equations are known.
///
/// Every finding is reported: the codes are listed in [`super`], those of the head in [`calibration`]. Nothing is returned where
/// one is an error.
pub fn read(root: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Setup> {
    root.entries()?;
    let mut own = Diagnostics::new();
    let setup = read_all(root, equations, &mut own);
    let failed = own.has_errors();
    diagnostics.extend(own);
    setup.filter(|_| !failed)
}

fn read_all(root: &Node, equations: &Equations, diagnostics: &mut Diagnostics) -> Option<Setup> {
    let wording = keys("a set-up");
    let fields = Fields::open(root, first_key(root), wording, &KEYS, diagnostics)?;
    if let Some(version) = fields.need("setup", wording, diagnostics) {
        check_version(version, diagnostics);
    }
    let known = calibration::read(&head(root), &equations.names(), diagnostics);
    let references = fields.get("references").map(|node| reference::read(node, diagnostics));
    let references = references.unwrap_or_default();
    let volumetric = fields.get("volumetric").map(|node| word(node, "`volumetric`", diagnostics));
    let volumetric = volumetric.map(|name| name.map(|name| name.map(str::to_owned)));
    let corrections = fields.get("corrections").map(|node| correction::read(node, equations, diagnostics));
    let diagonals = fields.entry("diagonals").map(|(key, node)| diagonals::read(node, key.span, diagnostics));
    let is_other = volumetric.is_some() || corrections.is_some() || diagonals.is_some();
    let measurements = match fields.get("measurements") {
        None if is_other => Some(Vec::new()),
        _ => {
            let measurements = fields.need("measurements", wording, diagnostics);
            measurements.and_then(|node| read_measurements(node, equations, diagnostics))
        }
    };
    let volumetric = match volumetric {
        Some(name) => Some(name?),
        None => None,
    };
    let corrections = match corrections {
        Some(corrections) => corrections?,
        None => Vec::new(),
    };
    let diagonals = match diagonals {
        Some(diagonals) => Some(diagonals?),
        None => None,
    };
    let (known, measurements) = (known?, measurements?);
    let setup = Setup { known, references, volumetric, corrections, diagonals, measurements };
    setup.check(equations, diagnostics);
    Some(setup)
}

fn check_version(node: &Node, diagnostics: &mut Diagnostics) {
    if node.text() == Some("1") {
        return;
    }
    let message = match node.text() {
        Some(text) => format!("version `{text}` of the set-up format is unknown"),
        None => format!("`setup` must be the version of the format, found {}", node.kind_name()),
    };
    diagnostics.push(Diagnostic::error("E0902", node.span, message).help("write `setup: 1`"));
}

/// The head of a set-up as a calibration file: the keys that both have, with their own places.
fn head(root: &Node) -> Node {
    let version = Scalar { text: "1".to_owned(), quoted: false };
    let place = first_key(root);
    let version = (
        Spanned::new("calibration".to_owned(), place),
        Node { span: place, kind: NodeKind::Scalar(version) },
    );
    let entries = root.entries().unwrap_or(&[]).iter();
    let shared = entries.filter(|(key, _)| OF_CALIBRATION.contains(&key.value.as_str())).cloned();
    Node { span: root.span, kind: NodeKind::Mapping(std::iter::once(version).chain(shared).collect()) }
}

fn read_measurements(
    node: &Node,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Measurement>> {
    let items = fields::list(node, "`measurements`", FORM, diagnostics)?;
    if items.is_empty() {
        let mistake = Diagnostic::error("E0901", node.span, "`measurements` names no measurement");
        diagnostics.push(mistake.help("add `- {motion: EXX, data: x.rtl}`"));
        return None;
    }
    Some(items.iter().filter_map(|item| measurement::read(item, equations, diagnostics)).collect())
}

impl Setup {
    /// The files whose error motions are taken over.
    pub fn taken(&self) -> impl Iterator<Item = &Spanned<String>> {
        self.volumetric.iter().chain(self.corrections.iter().map(|one| &one.data))
    }

    /// Takes the error motions of a file over into what is known; each must be given nowhere else (E0911), and be small (E0430). `place` is where the
    /// set-up names the file.
    pub fn take(
        &mut self,
        terms: &[(usize, CalibratedTerm)],
        place: Span,
        equations: &Equations,
        diagnostics: &mut Diagnostics,
    ) {
        for (number, motion) in equations.motions.iter().enumerate() {
            let measured = self.measurements.iter().find(|one| one.motion.value == number);
            let given = self.known.motions.iter().find(|known| known.motion == number);
            let other = measured.map(|one| one.motion.span).or(given.map(|known| known.span));
            if let (true, Some(other)) = (terms.iter().any(|(taken, _)| *taken == number), other) {
                // What another file gave stands at no place of the set-up.
                let (here, mistake) = if other == Span::default() {
                    (place, format!("this gives {}, which another file already gives", motion.name))
                } else {
                    (other, format!("{} is given here and also by a file or by lengths", motion.name))
                };
                let mistake = Diagnostic::error("E0911", here, mistake).also(place, "also given by this");
                diagnostics.push(mistake.help("remove it here or from the file"));
            }
        }
        let names = equations.names();
        diagnostics.extend(terms.iter().find_map(|(number, term)| {
            let term = Spanned::new(term.clone(), place);
            calibration::not_small(&term, names.motions.get(*number)?, &names)
        }));
        self.known = self.known.with(terms);
    }

    /// What holds between the parts of a set-up.
    fn check(&self, equations: &Equations, diagnostics: &mut Diagnostics) {
        for (number, one) in self.measurements.iter().enumerate() {
            let before = self.measurements.get(..number).unwrap_or(&[]);
            let same = |other: &&Measurement| other.is_of(one) && other.turned == one.turned;
            let name = equations.motions.get(one.motion.value).map_or("", |motion| &motion.name);
            if let Some(first) = before.iter().find(same) {
                diagnostics.push(measured_twice(name, one.motion.span, first.motion.span));
            }
            let given = self.known.motions.iter().find(|known| known.motion == one.motion.value);
            if let Some(given) = given {
                let message = format!("{name} is measured and also given under `errors`");
                let mistake = Diagnostic::error("E0911", one.motion.span, message);
                let help = "remove one of the two; the measurement is the whole motion";
                diagnostics.push(mistake.also(given.span, "given here").help(help));
            }
            self.check_turned(one, name, diagnostics);
        }
        reference::check(self, diagnostics);
    }

    /// A reversal needs the measurement before the edge was turned over too.
    fn check_turned(&self, one: &Measurement, name: &str, diagnostics: &mut Diagnostics) {
        let upright = |other: &Measurement| other.is_of(one) && !other.turned;
        if one.turned && !self.measurements.iter().any(upright) {
            let message = format!("{name} is measured only with the edge turned over");
            let help = "give both set-ups for a reversal, or remove `turned` if the edge was not turned over between two";
            diagnostics.push(Diagnostic::error("E0912", one.motion.span, message).help(help));
        }
    }
}

fn measured_twice(name: &str, again: Span, first: Span) -> Diagnostic {
    let mistake = Diagnostic::error("E0911", again, format!("{name} is measured twice"));
    let help = "put all runs of a motion into one file; use `turned: true` for the second set-up of a reversal, and `placement: \
                2` for an edge that was set up again";
    mistake.also(first, "first measured here").help(help)
}
