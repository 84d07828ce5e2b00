//! One name, one meaning. In: all names of a machine. Out: an error for each that would stand for two things.

use super::constants::Constant;
use super::draft::Chain;
use super::motion::Motion;
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::Span;

/// One name means one thing: positions, constants, travels, symbols and ISO names are distinct.
/// Constants stay distinct in lower case too, since they become fields of generated code.
pub(super) fn check_names(
    motions: &[Motion],
    constants: &[Constant],
    chain: &Chain<'_>,
    diagnostics: &mut Diagnostics,
) {
    let mut names = Names::default();
    for drafted in chain.links.iter().filter(|drafted| drafted.link.is_axis()) {
        names.take(&drafted.link.variable(), "the position of an axis", drafted.link.span, diagnostics);
    }
    for constant in constants {
        names.take(&constant.name, CONSTANT, constant.span, diagnostics);
    }
    for motion in motions {
        let link = chain.links.get(motion.link).map(|drafted| drafted.link.span);
        let span = motion.span.or(link).unwrap_or_default();
        if let Some(travel) = &motion.travel {
            names.take(&travel.value, TRAVEL, travel.span, diagnostics);
        }
        names.take(&motion.symbol, "an error motion", span, diagnostics);
        if motion.symbol != motion.name {
            names.take(&motion.name, "an error motion", span, diagnostics);
        }
    }
}

const CONSTANT: &str = "a constant";
const TRAVEL: &str = "a travel";

/// The names taken so far, what each stands for, and where.
#[derive(Default)]
struct Names(Vec<(String, &'static str, Span)>);

impl Names {
    fn take(&mut self, name: &str, what: &'static str, span: Span, diagnostics: &mut Diagnostics) {
        let same = |known: &str, other: &str| {
            known == name || (what == CONSTANT && other == CONSTANT && known.eq_ignore_ascii_case(name))
        };
        match self.0.iter().find(|(known, other, _)| same(known, other)) {
            Some((_, other, _)) if what == TRAVEL && *other == TRAVEL => {}
            Some((known, other, first)) => diagnostics.push(
                Diagnostic::error("E0135", span, format!("`{name}` would stand for two things"))
                    .label(format!("for {what} here"))
                    .also(*first, format!("`{known}` stands for {other} here"))
                    .help("choose another name; upper and lower case do not tell constants apart"),
            ),
            None => self.0.push((name.to_owned(), what, span)),
        }
    }
}
