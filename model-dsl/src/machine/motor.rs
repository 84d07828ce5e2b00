//! Motors that move several axes, and motors that share one. In: the `transmission` of a machine file and the `drives` of its slides.
//! Out: for each motor where it stands when its axes stand somewhere, and what its own error does to the bodies of the chain.
//!
//! Both are one thing: a linear map from the errors of motors to the error motions of links. Behind a crossed transmission the slides
//! have the inverse of what the motors follow; on a beam two motors make a displacement at its reference point and a rotation.

mod beam;
mod transmission;

use num_traits::One;

use super::draft::Chain;
use super::fields::Fields;
use super::link::{Link, LinkKind};
use super::motion::{Motion, MotionKind, parse_name};
use super::words::is_name;
use crate::algebra::{Axis, Name, Rational};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};

/// One motor.
#[derive(Clone, Debug)]
pub struct Motor {
    /// Its name, and where the file gives it: `A` of a crossed transmission, `Y1` on a beam.
    pub name: Spanned<String>,
    /// Where it stands: for each slide that it follows, by its number in [`super::Machine::links`], how far it goes for each mm.
    pub follows: Vec<(usize, Rational)>,
    /// What one mm of its own error does to bodies.
    pub moves: Vec<Moved>,
    /// Where it stands on a beam that it can turn.
    pub beam: Option<Beam>,
}

/// What the error of a motor does to one body, for each mm of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The number of the link in [`super::Machine::links`].
    pub link: usize,
    /// A displacement, or a rotation.
    pub kind: MotionKind,
    /// In bed directions: a pure number for a displacement, rad for each mm for a rotation.
    pub weight: Rational,
}

/// Where a motor stands on its beam.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Beam {
    /// About which direction the beam turns where its motors differ.
    pub about: Axis,
    /// How far the motor goes for each rad by which the beam turns about that direction of the bed: mm.
    pub arm: Rational,
    /// Whether the motors turn the beam back themselves: each has a command of its own.
    pub corrects: bool,
}

impl Motor {
    /// The name of its position, `a` for motor A: mm of its own travel.
    pub fn variable(&self) -> Name {
        self.name.value.to_ascii_lowercase().into()
    }

    /// The error motion of a motor: how far it is from where it was sent, in mm of its own travel.
    fn motion(&self, number: usize, chain: &Chain<'_>) -> Option<Motion> {
        let home = self.moves.first()?;
        let link = &chain.links.get(home.link)?.link;
        let name = own_error(&self.name.value);
        let plain = Motion::plain(home.link, link, home.kind, Some(self.name.span));
        Some(Motion { symbol: name.clone(), name, motor: Some(number), ..plain })
    }
}

/// The name of the error motion of a motor: `EA`, `EY1`.
fn own_error(motor: &str) -> String {
    format!("E{motor}")
}

/// Reads all motors of a machine; every mistake is reported.
pub(super) fn read(fields: Fields<'_>, chain: &Chain<'_>, diagnostics: &mut Diagnostics) -> Vec<Motor> {
    let mut motors = transmission::read(fields.get("transmission"), chain, diagnostics);
    motors.extend(beam::read(chain, &motors, diagnostics));
    for (place, motor) in motors.iter().enumerate() {
        check_name(&motor.name, chain, &motors[..place], diagnostics);
    }
    motors
}

/// The error motions of motors, in their order.
pub(super) fn motions(motors: &[Motor], chain: &Chain<'_>) -> Vec<Motion> {
    motors.iter().enumerate().filter_map(|(number, motor)| motor.motion(number, chain)).collect()
}

/// A motor has a name that nothing else has, nor its error motion.
fn check_name(name: &Spanned<String>, chain: &Chain<'_>, before: &[Motor], diagnostics: &mut Diagnostics) {
    let error = own_error(&name.value);
    let links = || chain.links.iter().map(|drafted| &drafted.link);
    let is_link = |link: &&Link| link.id == name.value || link.variable().eq_ignore_ascii_case(&name.value);
    let reason = if !is_name(&name.value) {
        Some("a name begins with a letter, followed by letters, digits and `_`".to_owned())
    } else if let Some(link) = links().find(is_link) {
        Some(format!("link {} of the chain has this name", link.id))
    } else if let Some(link) = links().find(|link| parse_name(&error, &link.id).is_some()) {
        Some(format!("its error {error} would be an error motion of {}", link.id))
    } else {
        let same = before.iter().find(|motor| motor.name.value.eq_ignore_ascii_case(&name.value));
        same.map(|motor| format!("another motor {} has this name", motor.name.value))
    };
    if let Some(reason) = reason {
        let message = format!("`{}` cannot name a motor", name.value);
        diagnostics.push(
            Diagnostic::error("E0148", name.span, message)
                .label(reason)
                .help("choose another name, such as `A` and `B` for a belt, or `Y1` and `Y2` for a beam"),
        );
    }
}

/// The slide of a letter; anything else is reported, with what motors may move.
fn slide(letter: &str, span: Span, chain: &Chain<'_>, diagnostics: &mut Diagnostics) -> Option<usize> {
    let of = |drafted: &super::draft::DraftedLink<'_>| drafted.link.kind.letter().map(String::from);
    let found = chain.links.iter().position(|drafted| of(drafted).as_deref() == Some(letter));
    let is_slide = |number: &usize| {
        chain.links.get(*number).is_some_and(|drafted| matches!(drafted.link.kind, LinkKind::Slide(_)))
    };
    if let Some(number) = found.filter(is_slide) {
        return Some(number);
    }
    let slides = chain.links.iter().filter(|drafted| matches!(drafted.link.kind, LinkKind::Slide(_)));
    let slides: Vec<String> = slides.filter_map(of).collect();
    let (message, label) = match found {
        Some(_) => (format!("{letter} is a rotary axis"), "a transmission combines slides"),
        None => (format!("the chain has no slide {letter}"), "a motor moves slides of the chain"),
    };
    let help = format!("the slides of this machine are {}", slides.join(", "));
    diagnostics.push(Diagnostic::error("E0149", span, message).label(label).help(help));
    None
}

/// 1 or -1.
fn signed(sign: i64) -> Rational {
    if sign < 0 { -Rational::one() } else { Rational::one() }
}
