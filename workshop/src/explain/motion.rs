//! What the name of an error motion means. In: a name of ISO 230-1 or ISO 230-7, in any spelling that files may use. Out: its page.

use std::fmt::Write;

use model_dsl::algebra::Axis;
use model_dsl::derivation::{NamedMotion, named};
use model_dsl::machine::MotionKind;
use textwrap::fill;

use super::page::WIDTH;

/// The page of an error motion; none for a name that is not one. Letter case does not matter.
pub(super) fn page(name: &str) -> Option<String> {
    let name = name.to_ascii_uppercase();
    let Some(motion) = named(&name) else { return of_motor(&name) };
    let mut text = format!("{}: {}\n\n", motion.name, motion.meaning);
    let mut paragraph = |words: &str| {
        // A page is text: writing to it cannot fail.
        let _ = writeln!(text, "{}", fill(words, WIDTH));
    };
    paragraph(&what(&motion));
    if motion.kind.alignment() {
        paragraph("");
        paragraph(&spellings(&motion));
        paragraph("");
        paragraph(&counted(&motion));
    }
    Some(text)
}

/// The page of the error of a motor, as motors are mostly called: a letter, and a number where several share an axis.
fn of_motor(name: &str) -> Option<String> {
    let motor = name.strip_prefix('E')?;
    let number = motor.strip_prefix(|first: char| first.is_ascii_uppercase())?;
    number.bytes().all(|digit| digit.is_ascii_digit()).then(|| {
        let words = format!(
            "An error motion, a length, mm of the motor's own travel: how motor {motor} deviates from its command. The machine \
             file must have such a motor in `transmission` or under the `drives` of a slide. The error moves every slide that \
             the motor moves."
        );
        format!("{name}: error of motor {motor}\n\n{}\n", fill(&words, WIDTH))
    })
}

fn what(motion: &NamedMotion) -> String {
    let axis = motion.axis;
    let unit = if motion.kind.angular() { "an angle, rad" } else { "a length, mm" };
    match motion.kind {
        MotionKind::Alignment(_) if !motion.rotary => format!(
            "An alignment error, {unit}: the line of motion of {axis} is rotated, but its carriage is not. It is counted from the frame before {axis}."
        ),
        MotionKind::Alignment(_) | MotionKind::Offset(_) => format!(
            "A location error, {unit}: where the axis of {axis} lies, at every position of {axis}. It is counted from the frame before {axis} in the chain."
        ),
        _ => format!(
            "An error motion, {unit}: how {axis} deviates from its command, at each of its positions. ISO 230-1 and ISO 230-7 use the same name."
        ),
    }
}

fn spellings(motion: &NamedMotion) -> String {
    let (letter, axis) = (motion.kind.letter(), motion.axis);
    let standard = if motion.rotary { ", the name in ISO 230-7 and the literature" } else { "" };
    format!(
        "Other spellings are {letter}0{axis} and, with the letter O, E{letter}O{axis} and {letter}O{axis}{standard}."
    )
}

/// What the name says that counts from another axis: that which was asked for, or one for example.
fn counted(motion: &NamedMotion) -> String {
    let (name, letter, axis) = (&motion.name, motion.kind.letter(), motion.axis);
    let letters = if motion.kind.angular() { "XYZ" } else { "ABC" };
    let own = direction(motion.kind.axis());
    let example = letters.chars().find(|other| *other != axis && !own.contains(*other));
    let from = motion.counted_from.clone().or_else(|| example.map(String::from)).unwrap_or_default();
    let counted = format!("E{letter}(0{from}){axis}");
    if own.contains(&from) {
        return format!("{counted} is refused (E0146): {from} runs in that direction and cannot show it.");
    }
    if motion.kind.angular() {
        return format!(
            "{counted}, in the notation of ISO 230-1, is the same error counted from {from}. It is accepted for {name} on a \
             machine on which both are equal, because nothing else lies between {from} and {axis}. Otherwise it is refused with \
             its meaning (E0146)."
        );
    }
    if "XYZUVW".contains(&from) {
        return format!("{counted} is refused (E0146): {from} is a slide and has no place of its own.");
    }
    format!(
        "{counted} is the same place counted from {from}, if {from} carries {axis}. Otherwise it is refused (E0146)."
    )
}

/// The letters of the axes that run in a direction, or turn about it.
fn direction(axis: Axis) -> &'static str {
    match axis {
        Axis::X => "XUA",
        Axis::Y => "YVB",
        Axis::Z => "ZWC",
    }
}
