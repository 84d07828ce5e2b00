//! Machine files written from descriptions. In: a machine of the oracle. Out: the text that a user would write for it.

use std::fmt::Write;

use crate::oracle::{ErrorMotion, Kind, Link, Machine, POINTING, Shape};

/// The whole file. Constants are declared where `declare` says so, and simply used otherwise.
pub(crate) fn text(machine: &Machine, declare: bool) -> String {
    let mut text = String::from("abbe: 1\nname: described\n");
    if machine.sensitive != [true; 3] {
        let letters: Vec<&str> = ["Z", "Y", "X"]
            .into_iter()
            .zip([2, 1, 0])
            .filter(|(_, axis)| machine.sensitive[*axis])
            .map(|(letter, _)| letter)
            .collect();
        writeln!(text, "sensitive: [{}]", letters.join(", ")).unwrap();
    }
    if machine.relative {
        text.push_str("motions: relative\n");
    }
    if machine.bed {
        text.push_str("reference: bed\n");
    }
    if machine.pointing {
        text.push_str("orientation: true\n");
    }
    if declare && !machine.constants().is_empty() {
        writeln!(text, "constants: [{}]", machine.constants().join(", ")).unwrap();
    }
    text.push_str("chain:\n");
    for (name, links) in [("workpiece", &machine.workpiece), ("tool", &machine.tool)] {
        if !links.is_empty() {
            writeln!(text, "  {name}:").unwrap();
            links.iter().for_each(|link| text.push_str(&written(link, machine.pointing)));
        }
    }
    text
}

fn written(link: &Link, pointing: bool) -> String {
    let (word, name) = match link.kind {
        Kind::Slide(letter) => ("slide", letter.to_string()),
        Kind::Rotary(letter) => ("rotary", letter.to_string()),
        Kind::Spindle => ("spindle", link.id.clone()),
        Kind::Fixed => ("fixed", link.id.clone()),
        Kind::Tool => ("tool", link.id.clone()),
        Kind::Part => ("part", link.id.clone()),
    };
    let mut text = format!("    - {word}: {name}\n");
    if name != link.id {
        writeln!(text, "      id: {}", link.id).unwrap();
    }
    if matches!(link.kind, Kind::Slide(_) | Kind::Rotary(_) | Kind::Spindle) {
        writeln!(text, "      along: {}", direction(link)).unwrap();
    }
    if pointing && link.kind == Kind::Tool {
        writeln!(text, "      direction: [{}]", POINTING.join(", ")).unwrap();
    }
    if link.turned != [0; 3] {
        let key = if link.kind == Kind::Fixed { "turned" } else { "leans" };
        let angles = ["A", "B", "C"].into_iter().zip(link.turned).filter(|(_, tenths)| *tenths != 0);
        let angles: Vec<String> =
            angles.map(|(letter, tenths)| format!("{letter}: {} deg", f64::from(tenths) / 10.0)).collect();
        writeln!(text, "      {key}: {{{}}}", angles.join(", ")).unwrap();
    }
    if link.origin.iter().any(|sum| !sum.is_empty()) {
        let key = if matches!(link.kind, Kind::Tool | Kind::Part) { "offset" } else { "origin" };
        let coordinates: Vec<String> = link.origin.iter().map(|sum| coordinate(sum)).collect();
        writeln!(text, "      {key}: [{}]", coordinates.join(", ")).unwrap();
    }
    if let Some(bed) = link.bed {
        writeln!(text, "      reference: {}", if bed { "bed" } else { "carriage" }).unwrap();
    }
    if let Some(errors) = &link.errors {
        text.push_str(&listed(errors, &link.id));
    }
    text
}

/// By its letter; as a vector where the link has an id of its own.
fn direction(link: &Link) -> String {
    let sign = if link.backwards { "-" } else { "+" };
    let letter = &"XYZ"[link.along..=link.along];
    let own_id = link.variable().is_some_and(|variable| !variable.eq_ignore_ascii_case(&link.id));
    if !own_id {
        return format!("{sign}{letter}");
    }
    let entries: [&str; 3] = std::array::from_fn(|axis| match (axis == link.along, link.backwards) {
        (true, true) => "-1",
        (true, false) => "1",
        _ => "0",
    });
    format!("[{}]", entries.join(", "))
}

fn coordinate(sum: &[(f64, Option<String>)]) -> String {
    let mut text = String::new();
    for (factor, name) in sum {
        let sign = match (*factor < 0.0, text.is_empty()) {
            (true, true) => "-",
            (true, false) => " - ",
            (false, true) => "",
            (false, false) => " + ",
        };
        let size = factor.abs();
        text.push_str(sign);
        match name {
            Some(name) if size == 1.0 => text.push_str(name),
            Some(name) => write!(text, "{size}*{name}").unwrap(),
            None => write!(text, "{size}").unwrap(),
        }
    }
    if text.is_empty() { "0".to_owned() } else { text }
}

/// A list where every error motion is a plain one, a mapping otherwise; alignments by all of their spellings.
fn listed(errors: &[ErrorMotion], id: &str) -> String {
    let plain = |error: &ErrorMotion| {
        error.symbol.is_none() && !error.opposite && error.travel.is_none() && !error.rotates
    };
    let names =
        errors.iter().enumerate().map(|(number, error)| spelled(&error.name(id), error.shape, number));
    if errors.iter().all(plain) {
        return format!("      errors: [{}]\n", names.collect::<Vec<_>>().join(", "));
    }
    let mut text = String::from("      errors:\n");
    for (name, error) in names.zip(errors) {
        writeln!(text, "        {name}:{}", details(error)).unwrap();
    }
    text
}

fn details(error: &ErrorMotion) -> String {
    let symbol = error.symbol.as_deref().unwrap_or_default();
    if !error.opposite && error.travel.is_none() && !error.rotates {
        return if symbol.is_empty() { String::new() } else { format!(" {symbol}") };
    }
    let mut parts = Vec::new();
    if !symbol.is_empty() {
        parts.push(format!("symbol: {symbol}"));
    }
    if error.opposite {
        parts.push("sign: -1".to_owned());
    }
    if let Some(travel) = &error.travel {
        parts.push(format!("travel: {travel}"));
    }
    if error.rotates {
        parts.push("rotates: true".to_owned());
    }
    format!(" {{{}}}", parts.join(", "))
}

/// `EC0Y`, `C0Y` and `COY` are one name.
fn spelled(name: &str, shape: Shape, number: usize) -> String {
    match (shape, number % 3) {
        (Shape::Alignment, 1) => name[1..].to_owned(),
        (Shape::Alignment, 2) => format!("{}O{}", &name[1..2], &name[3..]),
        _ => name.to_owned(),
    }
}
