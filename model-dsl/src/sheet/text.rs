//! Plain text. In: a sheet. Out: lines of at most about a hundred columns, to be held beside a printed report.

use super::{
    Angle, Function, Letter, MotionEntry, Number, QuantityEntry, Sheet, SheetRow, Signs, Statement, Writer,
};
use super::{line, pieces, tree, wrap};
use crate::algebra::Polynomial;
use crate::equations::{Equations, Names};

/// Plain infix, as [`crate::expression::parse`] reads it.
pub struct Plain;

impl Writer for Plain {
    fn signs(&self) -> &'static Signs {
        &Signs::PLAIN
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
pub fn page(sheet: &Sheet) -> String {
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
    let line = |motion: &MotionEntry| {
        let iso = if unnamed { String::new() } else { format!("{:wide_iso$}  ", motion.iso) };
        let head = format!("  {:wide$}  {iso}{:3}  ", motion.letter.plain, motion.unit);
        let against = if motion.against_iso { "; counted against the ISO sense" } else { "" };
        wrap::words(&head, &format!("{}{against}", motion.meaning))
    };
    sheet.motions.iter().map(line).collect()
}

fn quantities(sheet: &Sheet) -> String {
    let wide = widest(sheet.quantities.iter().map(|entry| entry.letter.plain.as_str()));
    let line =
        |entry: &QuantityEntry| wrap::words(&format!("  {:wide$}  ", entry.letter.plain), &entry.meaning);
    sheet.quantities.iter().map(line).collect()
}

fn widest<'a>(names: impl Iterator<Item = &'a str>) -> usize {
    names.map(|name| name.chars().count()).max().unwrap_or(0)
}

/// The error of each direction as one line of plain text: `dPx = dxx - dxz + ...`. Before these stand the brackets that have a name,
/// `Ly = y - Ya + Yt`, where the machine has rotary axes.
pub fn error_lines(equations: &Equations, names: Names) -> Vec<String> {
    let sheet = Sheet::new(&Equations { orientation: Vec::new(), ..equations.clone() }, names);
    lines(&sheet, &sheet.rows)
}

/// The error of each part of the tool's direction as one line of plain text, `dI = EBX + ...`, with its own brackets before, as in
/// [`error_lines`]; none where it is not derived.
pub fn direction_error_lines(equations: &Equations, names: Names) -> Vec<String> {
    let sheet = Sheet::new(&Equations { rows: Vec::new(), ..equations.clone() }, names);
    lines(&sheet, &sheet.orientation)
}

/// The named brackets, then the errors of rows.
fn lines(sheet: &Sheet, rows: &[SheetRow]) -> Vec<String> {
    let line =
        |statement: &Statement| format!("{} = {}", statement.left.plain, line(&Plain, &statement.right));
    sheet.brackets.iter().chain(rows.iter().map(|row| &row.error)).map(line).collect()
}

/// A polynomial as plain infix text, `-x*cos(c) + Zt`, which [`crate::expression::parse`] reads back.
pub fn infix(polynomial: &Polynomial) -> String {
    line(&Plain, &tree::polynomial(polynomial))
}
