//! One name, one meaning. In: all names of a machine. Out: an error for each that would stand for two things.

use std::fmt;

use super::constants::Constant;
use super::draft::Chain;
use super::motion::Motion;
use super::motor::Motor;
use crate::algebra::Axis;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Span;

/// Checks that positions, constants, travels, symbols and ISO names are distinct. Names that become
/// fields of one record of the generated code stay distinct in lower case too, and none is that of the position or of the
/// error in a sensitive direction, or of the direction of the tool, as the equations print it.
pub(super) fn check_names(
    motions: &[Motion],
    constants: &[Constant],
    chain: &Chain<'_>,
    motors: &[Motor],
    printed: Printed<'_>,
    diagnostics: &mut Diagnostics,
) {
    let mut names = Names { taken: Vec::new(), printed };
    for drafted in chain.links.iter().filter(|drafted| drafted.link.is_axis()) {
        names.take(&drafted.link.variable(), What::Position, drafted.link.span, diagnostics);
    }
    for motor in motors {
        names.take(&motor.variable(), What::Position, motor.name.span, diagnostics);
    }
    for constant in constants {
        names.take(&constant.name, What::Constant, constant.span, diagnostics);
    }
    for motion in motions {
        let link = chain.links.get(motion.link).map(|drafted| drafted.link.span);
        let span = motion.span.or(link).unwrap_or_default();
        if let Some(travel) = &motion.travel {
            names.take(&travel.value, What::Travel, travel.span, diagnostics);
        }
        names.take(&motion.name, What::Motion, span, diagnostics);
    }
    for motion in motions.iter().filter(|motion| motion.symbol != motion.name) {
        names.take(&motion.symbol, What::Symbol, motion.symbol_span.unwrap_or_default(), diagnostics);
    }
}

/// What a name stands for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum What {
    Position,
    Constant,
    Travel,
    Motion,
    Symbol,
}

impl What {
    /// Whether names of this kind become fields of one record.
    fn makes_fields(self) -> bool {
        matches!(self, Self::Constant | Self::Travel | Self::Motion)
    }
}

impl fmt::Display for What {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Position => "the position of an axis",
            Self::Constant => "a constant",
            Self::Travel => "a travel",
            Self::Motion => "an error motion",
            Self::Symbol => "the symbol of an error motion",
        })
    }
}

/// Of what equations are printed.
#[derive(Clone, Copy)]
pub(super) struct Printed<'m> {
    /// The directions in which the tip is derived.
    pub(super) sensitive: &'m [Axis],
    /// Whether the direction of the tool is.
    pub(super) orientation: bool,
}

/// The names taken so far, what each stands for, and where; and of what equations are printed.
struct Names<'m> {
    taken: Vec<(String, What, Span)>,
    printed: Printed<'m>,
}

impl Names<'_> {
    fn take(&mut self, name: &str, what: What, span: Span, diagnostics: &mut Diagnostics) {
        let clash = |known: &str, other: What| {
            let one_record = what == other && what.makes_fields();
            known == name || one_record && known.eq_ignore_ascii_case(name)
        };
        if let Some(printed) = self.printed.meaning(name) {
            diagnostics.push(
                Diagnostic::error("E0135", span, format!("`{name}` would have two meanings"))
                    .label(format!("means {what} here, and {printed} in printed equations"))
                    .help(format!(
                        "choose another name, such as `{name}_` or `{}`",
                        name.to_ascii_lowercase()
                    )),
            );
        }
        match self.taken.iter().find(|(known, other, _)| clash(known, *other)) {
            // Two alignment errors may act over the same travel.
            Some((known, What::Travel, _)) if what == What::Travel && known == name => {}
            Some((known, other, first)) => diagnostics.push(
                Diagnostic::error("E0135", span, format!("`{name}` would have two meanings"))
                    .label(format!("means {what} here"))
                    .also(*first, format!("`{known}` means {other} here"))
                    .help("choose another name that differs in more than upper and lower case"),
            ),
            None => self.taken.push((name.to_owned(), what, span)),
        }
    }
}

impl Printed<'_> {
    /// What printed equations call by this name.
    fn meaning(&self, name: &str) -> Option<String> {
        let (error, plain) = name.strip_prefix('d').map_or((false, name), |rest| (true, rest));
        if self.orientation && Axis::ALL.iter().any(|axis| axis.direction_letter().to_string() == plain) {
            let what = if error { "the error of the tool's direction" } else { "the tool's direction" };
            return Some(what.to_owned());
        }
        let direction = plain.strip_prefix('P')?;
        let what = if error { "the error of the tool tip" } else { "the position of the tool tip" };
        if direction.is_empty() {
            return Some(what.to_owned());
        }
        let own = |axis: &&Axis| axis.letter().to_ascii_lowercase().to_string() == direction;
        self.sensitive.iter().find(own).map(|axis| format!("{what} in {axis}"))
    }
}
