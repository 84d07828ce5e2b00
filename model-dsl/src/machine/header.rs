//! The head of a machine file: version, names, sensitive directions and conventions.

use super::budget::{self, Budget};
use super::fields::{Fields, choice, items, keys, text};
use super::link::Reference;
use super::orientation::Orientation;
use crate::algebra::Axis;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};
use crate::yaml::Node;

/// What the head of a machine file says.
pub(super) struct Header {
    pub(super) name: String,
    pub(super) title: Option<String>,
    pub(super) source: Option<String>,
    pub(super) sensitive: Vec<Axis>,
    pub(super) sensitive_spans: Vec<(Axis, Span)>,
    pub(super) reference: Reference,
    pub(super) relative: bool,
    pub(super) orientation: Orientation,
    pub(super) budget: Spanned<Budget>,
}

impl Header {
    /// The head of a machine that is given by its topology word alone.
    pub(super) fn bare(word: &str) -> Self {
        Self {
            name: word.to_owned(),
            title: None,
            source: None,
            sensitive: Axis::ALL.to_vec(),
            sensitive_spans: Vec::new(),
            reference: Reference::Carriage,
            relative: false,
            orientation: Orientation::Left,
            budget: Spanned::new(Budget::Full, Span::default()),
        }
    }
}

/// Reads the head; mistakes are reported and replaced by the defaults.
pub(super) fn read(fields: Fields<'_>, diagnostics: &mut Diagnostics) -> Header {
    version(fields, diagnostics);
    let mut header = Header::bare("");
    if let Some(name) = fields.need("name", keys("a machine file"), diagnostics) {
        header.name = name_of(name, diagnostics).unwrap_or_default();
    }
    header.title = optional_text(fields.get("title"), "the title", diagnostics);
    header.source = optional_text(fields.get("source"), "the source", diagnostics);
    if let Some(node) = fields.get("sensitive") {
        header.sensitive_spans = sensitive(node, diagnostics);
        header.sensitive = header.sensitive_spans.iter().map(|(axis, _)| *axis).collect();
        header.sensitive.sort_unstable();
    }
    if let Some(node) = fields.get("reference") {
        header.reference = reference(node, diagnostics);
    }
    if let Some(node) = fields.get("motions") {
        let word = choice(node, "a convention for error motions", &["body", "relative"], diagnostics);
        header.relative = word == Some("relative");
    }
    if let Some(node) = fields.get("orientation") {
        header.orientation = orientation(node, diagnostics);
    }
    if let Some(node) = fields.get("budget") {
        header.budget = budget::read(node, diagnostics);
    }
    header
}

/// Reads the point about which rotations act.
pub(super) fn reference(node: &Node, diagnostics: &mut Diagnostics) -> Reference {
    match choice(node, "a reference point", &["carriage", "bed"], diagnostics) {
        Some("bed") => Reference::Bed,
        _ => Reference::Carriage,
    }
}

/// Reads a setting for the direction of the tool.
fn orientation(node: &Node, diagnostics: &mut Diagnostics) -> Orientation {
    let words = ["true", "uncorrected", "false"];
    match choice(node, "a setting for the direction of the tool", &words, diagnostics) {
        Some("true") => Orientation::Corrected,
        Some("uncorrected") => Orientation::Told,
        _ => Orientation::Left,
    }
}

fn version(fields: Fields<'_>, diagnostics: &mut Diagnostics) {
    let Some(node) = fields.need("abbe", keys("a machine file"), diagnostics) else { return };
    let Some(version) = text(node, "the version of the format", diagnostics) else { return };
    if version != "1" {
        diagnostics.push(
            Diagnostic::error("E0105", node.span, format!("version `{version}` of the format is unknown"))
                .label("this version")
                .help("write `abbe: 1`"),
        );
    }
}

fn name_of(node: &Node, diagnostics: &mut Diagnostics) -> Option<String> {
    let name = text(node, "the machine's name", diagnostics)?;
    let allowed = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    if name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(allowed) {
        return Some(name.to_owned());
    }
    diagnostics.push(
        Diagnostic::error("E0106", node.span, format!("`{name}` is not a valid name for a machine"))
            .label("this becomes the name of a file and of a Rust module")
            .help("begin with a letter, followed by letters, digits, `-` and `_`"),
    );
    None
}

fn optional_text(node: Option<&Node>, what: &str, diagnostics: &mut Diagnostics) -> Option<String> {
    text(node?, what, diagnostics).map(str::to_owned)
}

fn sensitive(node: &Node, diagnostics: &mut Diagnostics) -> Vec<(Axis, Span)> {
    let mut found: Vec<(Axis, Span)> = Vec::new();
    for item in items(node, "`sensitive`", diagnostics).unwrap_or_default() {
        let Some(word) = choice(item, "a direction", &["X", "Y", "Z"], diagnostics) else { continue };
        let axis = match word {
            "X" => Axis::X,
            "Y" => Axis::Y,
            _ => Axis::Z,
        };
        match found.iter().find(|(known, _)| *known == axis) {
            Some((_, first)) => diagnostics.push(
                Diagnostic::error("E0107", item.span, format!("direction {word} is listed twice"))
                    .label("again here")
                    .also(*first, "first here")
                    .help("name each direction once"),
            ),
            None => found.push((axis, item.span)),
        }
    }
    if found.is_empty() && !diagnostics.has_errors() {
        diagnostics.push(
            Diagnostic::error("E0108", node.span, "no direction is sensitive, so there is nothing to derive")
                .label("this list is empty")
                .help("leave `sensitive` out for all three directions"),
        );
    }
    found
}
