//! Topology words: `XYFZ` and every other order of one to six axes with one F, the bed.
//!
//! In: a word, read from the part to the tool. Out: the chain that it stands for. The word is
//! checked, never guessed.

use super::draft::{Chain, DraftedLink};
use super::link::{Along, Branch, Link, LinkKind, Reference};
use super::turned::Turned;
use crate::algebra::{Axis, Polynomial, Symbol};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Span;

/// The letters that may stand in a topology word beside F.
const AXES: &str = "XYZABC";

/// A checked topology word: the letters before F and after it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopologyWord {
    /// Axes that carry the part, from the part to the bed.
    pub workpiece: Vec<char>,
    /// Axes that carry the tool, from the bed to the tool.
    pub tool: Vec<char>,
}

impl TopologyWord {
    /// Checks a word; each mistake is reported at `span`.
    pub fn parse(word: &str, span: Span, diagnostics: &mut Diagnostics) -> Option<Self> {
        let before = diagnostics.iter().count();
        for (code, message, help) in mistakes(word) {
            diagnostics.push(
                Diagnostic::error(code, span, format!("`{word}` is not a topology: {message}"))
                    .label("this word")
                    .help(help),
            );
        }
        if diagnostics.iter().count() > before {
            return None;
        }
        let (workpiece, tool) = word.split_once('F')?;
        Some(Self { workpiece: workpiece.chars().collect(), tool: tool.chars().collect() })
    }
}

fn mistakes(word: &str) -> Vec<(&'static str, String, String)> {
    let upper = word.to_ascii_uppercase();
    if upper != word && mistakes(&upper).is_empty() {
        return vec![("E0112", "axes and the bed are upper case".to_owned(), format!("write `{upper}`"))];
    }
    let mut found = Vec::new();
    let example = "write the letters from the part to the tool, with F as the bed: XYFZ".to_owned();
    match word.matches('F').count() {
        0 => found.push(("E0110", "it has no F, the bed".to_owned(), example)),
        1 => {}
        _ => found.push(("E0111", "it has more than one F".to_owned(), example)),
    }
    let axes: Vec<char> = word.chars().filter(|letter| *letter != 'F').collect();
    let unknown: Vec<char> = axes.iter().copied().filter(|letter| !AXES.contains(*letter)).collect();
    if let Some(letter) = unknown.first() {
        let help = "use X Y Z A B C, in upper case; for U V W write out the chain".to_owned();
        found.push(("E0112", format!("`{letter}` is not an axis"), help));
    }
    let repeated = axes.iter().enumerate().find(|(at, letter)| axes[..*at].contains(letter));
    if let Some((_, letter)) = repeated {
        found.push((
            "E0113",
            format!("axis {letter} occurs twice"),
            "use each axis once; in a chain, name a second slide U, V or W".to_owned(),
        ));
    }
    if axes.is_empty() {
        found.push(("E0114", "it has no axis".to_owned(), "name one to six of X Y Z A B C".to_owned()));
    }
    found
}

/// The chain that a word stands for: origins at [0, 0, 0], each axis along its own letter,
/// minus on the part's branch, and a tool at [Xt, Yt, Zt].
pub(super) fn expand(word: &str, span: Span, diagnostics: &mut Diagnostics) -> Option<Chain<'static>> {
    let parsed = TopologyWord::parse(word, span, diagnostics)?;
    let workpiece = parsed.workpiece.iter().rev().map(|letter| (*letter, Branch::Workpiece));
    let tool = parsed.tool.iter().map(|letter| (*letter, Branch::Tool));
    let mut links: Vec<_> =
        workpiece.chain(tool).map(|(letter, branch)| axis(letter, branch, span)).collect();
    links.push(tip(span));
    Some(Chain { topology: Some(word.to_owned()), links })
}

fn axis(letter: char, branch: Branch, span: Span) -> DraftedLink<'static> {
    let sign = if branch == Branch::Workpiece { -1 } else { 1 };
    let (kind, axis) = match letter {
        'A' => (LinkKind::Rotary(letter), Axis::X),
        'B' => (LinkKind::Rotary(letter), Axis::Y),
        'C' => (LinkKind::Rotary(letter), Axis::Z),
        'X' => (LinkKind::Slide(letter), Axis::X),
        'Y' => (LinkKind::Slide(letter), Axis::Y),
        _ => (LinkKind::Slide(letter), Axis::Z),
    };
    drafted(letter.to_string(), kind, branch, Along { axis, sign }, zero(), span)
}

fn tip(span: Span) -> DraftedLink<'static> {
    let offset = ["Xt", "Yt", "Zt"].map(|name| Polynomial::symbol(Symbol::Constant(name.into())));
    let along = Along { axis: Axis::Z, sign: 1 };
    drafted("tip".to_owned(), LinkKind::Tool, Branch::Tool, along, offset, span)
}

fn zero() -> [Polynomial; 3] {
    [Polynomial::zero(), Polynomial::zero(), Polynomial::zero()]
}

fn drafted(
    id: String,
    kind: LinkKind,
    branch: Branch,
    along: Along,
    origin: [Polynomial; 3],
    span: Span,
) -> DraftedLink<'static> {
    let (turned, reference) = (Turned::default(), Reference::Carriage);
    let link = Link { id, kind, branch, along, origin, turned, reference, corrects: true, span };
    DraftedLink { link, origin_spans: [span; 3], errors: None, direction: None, drives: None }
}

/// A commented machine file to start from; every mistake in the word is reported.
pub fn template(word: &str, diagnostics: &mut Diagnostics) -> Option<String> {
    let parsed = TopologyWord::parse(word, Span { start: 0, end: word.len() }, diagnostics)?;
    let mut text = format!(
        "# A machine file for Abbe: the topology, without numbers that a measurement would change.\n\
         # The numbers of one machine are in a calibration file.\n\
         abbe: 1\n\
         name: my-{}\n\
         title: A {word} machine\n\n\
         # `topology: {word}` means the chain below. Write one or the other.\n\
         # Letters before F carry the part, letters after F carry the tool.\n\
         # sensitive: [X, Y, Z]   # the directions to derive and compensate; all three by default\n\
         # reference: carriage    # rotations act about the origin that travels with the carriage; or: bed\n\
         # motions: body          # an error motion moves its own body; or: relative, as an instrument reads it\n\
         chain:\n  workpiece:             # from the bed towards the part\n",
        word.to_ascii_lowercase()
    );
    if parsed.workpiece.is_empty() {
        text.push_str("    []\n");
    }
    for letter in parsed.workpiece.iter().rev() {
        text.push_str(&axis_template(*letter, '-'));
    }
    text.push_str("  tool:                  # from the bed towards the tool tip\n");
    for letter in &parsed.tool {
        text.push_str(&axis_template(*letter, '+'));
    }
    text.push_str("    - tool: tip\n      offset: [Xt, Yt, Zt]   # from the last frame to the tip, mm\n");
    Some(text)
}

fn axis_template(letter: char, sign: char) -> String {
    let kind = if "ABC".contains(letter) { "rotary" } else { "slide" };
    let sense = if sign == '-' { "   # positive motion of the part's body runs the other way" } else { "" };
    format!(
        "    - {kind}: {letter}\n      along: {sign}{letter}{sense}\n      origin: [0, 0, 0]   # of its frame at zero, in the frame before it: mm, or names of constants\n"
    )
}
