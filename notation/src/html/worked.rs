//! The worked example of the conventions. In: an example in numbers. Out: the state, the formula with its numbers filled
//! in, and what it means, in words.

use std::collections::BTreeMap;

use pages::text::escape;

use crate::example::Example;
use crate::mathml::{letter, worked};
use model_dsl::algebra::Axis;
use model_dsl::equations::Equations;
use model_dsl::sheet::{Brackets, Sheet};

/// The part of the page.
pub(super) fn section(sheet: &Sheet, equations: &Equations, example: &Example) -> String {
    let (Some(motion), Some(entry)) =
        (equations.motions.get(example.motion), sheet.motions.get(example.motion))
    else {
        return String::new();
    };
    let values = values(equations, example);
    let micro = short(example.value * 1e6);
    let mut formulas = String::new();
    let mut meanings = Vec::new();
    // Of what is printed the value is chosen.
    let sign = if entry.against_iso { -1.0 } else { 1.0 };
    let error = example.error().map(|part| sign * part);
    for row in &sheet.rows {
        let direction = row.direction;
        let arm = equations.arm(direction, example.motion);
        if arm.is_zero() {
            continue;
        }
        let size = short(error[direction.index()] * 1e3);
        // Spelled out, so that each number stands where its name stood.
        let arm = Brackets::default().expression(&if entry.against_iso { -&arm } else { arm });
        let names = (&row.error.left, &arm, &entry.letter);
        formulas.push_str(&worked(names, &values, (&micro, &size)));
        meanings.push(meaning(direction, &size));
    }
    format!(
        "<h3>A worked example</h3>\n<p>Let {}. These numbers are an example; the calibration of a machine has the real ones. One \
         error motion is not zero: {}, that is {}{}, {}, is +{micro} \u{b5}rad. {}</p>\n<div class=\"wide\">\n{formulas}</div>\n\
         <p>{}</p>\n",
        state(equations, example),
        letter(&entry.letter),
        if entry.against_iso { "the opposite of " } else { "" },
        escape(&motion.name),
        escape(&motion.meaning),
        sense(equations, motion, entry.against_iso),
        escape(&meanings.join(" ")),
    )
}

/// By which hand what turns.
fn sense(equations: &Equations, motion: &model_dsl::equations::Motion, against_iso: bool) -> String {
    if !motion.angular {
        return String::new();
    }
    let about = motion.direction;
    let (from, to) = (about.next(), about.next().next());
    let (hand, from, to) = if against_iso { ("left", to, from) } else { ("right", from, to) };
    let what = if equations.relative {
        "Relative to the part, the tool".to_owned()
    } else {
        format!("The body {}", escape(&motion.link))
    };
    format!("{what} rotates by the {hand}-hand rule about {about}: {from} towards {to}.")
}

fn meaning(direction: Axis, size: &str) -> String {
    if size == "0" {
        return format!("In {direction} its position is correct.");
    }
    let (sign, digits) = match size.strip_prefix('-') {
        Some(digits) => ('\u{2212}', digits),
        None => ('+', size),
    };
    let back = if sign == '+' { '\u{2212}' } else { '+' };
    format!(
        "The tip is {digits} \u{b5}m too far towards {sign}{direction} of the part. Compensation moves the tip by {back}{digits} \
         \u{b5}m in {direction}."
    )
}

/// The numbers of the state, each after its name.
fn state(equations: &Equations, example: &Example) -> String {
    let all = quantities(equations, example);
    let written = all.iter().map(|(name, value, unit)| format!("{} = {value}{unit}", escape(name)));
    written.collect::<Vec<_>>().join(", ")
}

fn values(equations: &Equations, example: &Example) -> BTreeMap<String, String> {
    let quantities = quantities(equations, example).into_iter();
    quantities
        .map(|(name, value, unit)| (name, if unit == DEGREES { format!("{value}{unit}") } else { value }))
        .collect()
}

const DEGREES: &str = "\u{b0}";

/// Name, number and unit of every position, travel and constant.
fn quantities(equations: &Equations, example: &Example) -> Vec<(String, String, &'static str)> {
    let axes = equations.axes.iter().zip(&example.positions).map(|(axis, value)| {
        if axis.rotary {
            (axis.variable.to_string(), short(value.to_degrees()), DEGREES)
        } else {
            (axis.variable.to_string(), short(*value), " mm")
        }
    });
    let length = |name: &str, value: &f64| (name.to_owned(), short(*value), " mm");
    let travels = equations.travels.iter().zip(&example.travels);
    // The direction of the tool has no part in an error of its tip.
    let constants = equations.constants.iter().zip(&example.constants);
    let constants = constants.filter(|(own, _)| own.direction.is_none());
    axes.chain(travels.map(|(own, value)| length(&own.name, value)))
        .chain(constants.map(|(own, value)| length(&own.name, value)))
        .collect()
}

/// A number with at most three decimals, and no more zeros than needed.
fn short(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    if rounded == 0.0 { "0".to_owned() } else { format!("{rounded}") }
}
