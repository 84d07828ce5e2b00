//! Plain text. In: a sheet. Out: lines of at most about a hundred columns, to be held beside a printed report.

use super::letter::Letter;
use super::number::Number;
use super::sheet::{Sheet, Statement};
use super::tree::{Angle, Function};
use super::wrap;
use super::writer::{Signs, Writer, pieces};

/// Plain infix, as [`crate::expression::parse`] reads it.
pub(super) struct Plain;

impl Writer for Plain {
    fn signs(&self) -> &'static Signs {
        &Signs { plus: " + ", minus: " - ", leading_minus: "-", times: "*", open: "(", close: ")" }
    }

    fn letter(&self, letter: &Letter) -> String {
        letter.plain.clone()
    }

    fn number(&self, number: &Number) -> String {
        match (&number.decimal, &number.denominator) {
            (Some(decimal), _) => decimal.clone(),
            (None, Some(denominator)) => format!("{}/{denominator}", number.numerator),
            (None, None) => number.numerator.clone(),
        }
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("{base}^{exponent}")
    }

    fn function(&self, function: Function, argument: &str) -> String {
        format!("{}({argument})", function.word())
    }

    fn angle(&self, angle: &Angle) -> String {
        format!("{} deg", self.number(&angle.degrees))
    }
}

/// The whole page.
pub(super) fn page(sheet: &Sheet) -> String {
    let mut text = format!("{}\n", sheet.heading());
    if let Some(source) = &sheet.source {
        text.push_str(&wrap::words("Source: ", source));
    }
    for sentence in &sheet.chain {
        text.push_str(&wrap::words("", sentence));
    }
    if !sheet.brackets.is_empty() {
        text.push('\n');
        text.extend(sheet.brackets.iter().map(bracket));
    }
    for row in sheet.rows.iter().chain(&sheet.orientation) {
        text.push('\n');
        for statement in [&row.position, &row.error] {
            text.push_str(&equation(statement));
        }
    }
    text.push_str("\nError motions\n");
    text.push_str(&motions(sheet));
    text.push_str("\nPositions and constants\n");
    text.push_str(&quantities(sheet));
    text.push_str("\nConventions\n");
    for sentence in &sheet.conventions {
        text.push_str(&wrap::words("  - ", sentence));
    }
    text
}

/// A named bracket, as an equation file gives a letter: what is printed can be checked as it stands.
fn bracket(statement: &Statement) -> String {
    wrap::equation(&format!("let {} = ", statement.left.plain), &pieces(&Plain, &statement.right))
}

fn equation(statement: &Statement) -> String {
    wrap::equation(&format!("{} = ", statement.left.plain), &pieces(&Plain, &statement.right))
}

fn motions(sheet: &Sheet) -> String {
    let wide = widest(sheet.motions.iter().map(|motion| motion.letter.plain.as_str()));
    let wide_iso = widest(sheet.motions.iter().map(|motion| motion.iso.as_str()));
    // Where every symbol is the ISO name, one column says it.
    let unnamed = sheet.motions.iter().all(|motion| motion.letter.plain == motion.iso);
    let line = |motion: &super::sheet::MotionEntry| {
        let iso = if unnamed { String::new() } else { format!("{:wide_iso$}  ", motion.iso) };
        let head = format!("  {:wide$}  {iso}{:3}  ", motion.letter.plain, motion.unit);
        let against = if motion.against_iso { "; counted against the ISO sense" } else { "" };
        wrap::words(&head, &format!("{}{against}", motion.meaning))
    };
    sheet.motions.iter().map(line).collect()
}

fn quantities(sheet: &Sheet) -> String {
    let wide = widest(sheet.quantities.iter().map(|entry| entry.letter.plain.as_str()));
    let line = |entry: &super::sheet::QuantityEntry| {
        wrap::words(&format!("  {:wide$}  ", entry.letter.plain), &entry.meaning)
    };
    sheet.quantities.iter().map(line).collect()
}

fn widest<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or(0)
}
