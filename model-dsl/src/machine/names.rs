//! One name, one meaning. In: all names of a machine. Out: an error for each that would stand for two things.

use std::fmt;

use super::constants::Constant;
use super::draft::Chain;
use super::motion::Motion;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Span;

/// Checks that positions, constants, travels, symbols and ISO names are distinct. Names that become
/// fields of one record of the generated code stay distinct in lower case too.
pub(super) fn check_names(
    motions: &[Motion],
    constants: &[Constant],
    chain: &Chain<'_>,
    diagnostics: &mut Diagnostics,
) {
    let mut names = Names::default();
    for drafted in chain.links.iter().filter(|drafted| drafted.link.is_axis()) {
        names.take(&drafted.link.variable(), What::Position, drafted.link.span, diagnostics);
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

/// The names taken so far, what each stands for, and where.
#[derive(Default)]
struct Names(Vec<(String, What, Span)>);

impl Names {
    fn take(&mut self, name: &str, what: What, span: Span, diagnostics: &mut Diagnostics) {
        let clash = |known: &str, other: What| {
            let one_record = what == other && what.makes_fields();
            known == name || one_record && known.eq_ignore_ascii_case(name)
        };
        match self.0.iter().find(|(known, other, _)| clash(known, *other)) {
            // Two alignment errors may act over the same travel.
            Some((known, What::Travel, _)) if what == What::Travel && known == name => {}
            Some((known, other, first)) => diagnostics.push(
                Diagnostic::error("E0135", span, format!("`{name}` would stand for two things"))
                    .label(format!("stands for {what} here"))
                    .also(*first, format!("`{known}` stands for {other} here"))
                    .help("choose another name; upper and lower case alone do not tell two of a kind apart"),
            ),
            None => self.0.push((name.to_owned(), what, span)),
        }
    }
}
