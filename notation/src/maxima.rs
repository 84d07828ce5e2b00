//! Input for Maxima. In: a sheet. Out: a batch file that assigns the error and the position of each direction, then those of the
//! direction of the tool where it is derived.
//!
//! Numbers are exact fractions, and a name that Maxima keeps for itself gets an underscore.

use model_dsl::sheet::{Angle, Function, Letter, Number, Sheet, Signs, Statement, Writer, pieces, wrap};

/// Words that mean something to Maxima, or whose assignment would change how it works.
const RESERVED: [&str; 44] = [
    "allbut",
    "and",
    "append",
    "arrays",
    "cos",
    "del",
    "demoivre",
    "diff",
    "do",
    "else",
    "elseif",
    "false",
    "for",
    "from",
    "functions",
    "if",
    "in",
    "inf",
    "infinity",
    "ind",
    "integrate",
    "labels",
    "lambda",
    "limit",
    "macros",
    "minf",
    "myoptions",
    "next",
    "noun",
    "not",
    "or",
    "props",
    "rules",
    "simp",
    "sin",
    "step",
    "sum",
    "then",
    "thru",
    "true",
    "und",
    "unless",
    "values",
    "while",
];

struct Maxima;

impl Writer for Maxima {
    fn signs(&self) -> &'static Signs {
        &Signs::PLAIN
    }

    fn letter(&self, letter: &Letter) -> String {
        letter.unless_reserved(&RESERVED)
    }

    fn number(&self, number: &Number) -> String {
        match &number.denominator {
            Some(denominator) => format!("{}/{denominator}", number.numerator),
            None => number.numerator.clone(),
        }
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("{base}^{exponent}")
    }

    fn function(&self, function: Function, argument: &str) -> String {
        format!("{}({argument})", function.word())
    }

    fn angle(&self, angle: &Angle) -> String {
        format!("{}*%pi", self.number(&angle.half_turns))
    }
}

/// The batch file.
pub(super) fn batch(sheet: &Sheet) -> String {
    let mut text = comment(&sheet.heading());
    if let Some(source) = &sheet.source {
        text.push_str(&comment(&format!("Source: {source}")));
    }
    text.push_str(&comment("Load with batchload(\"FILE\"). Lengths in mm, angles in rad."));
    for entry in &sheet.quantities {
        text.push_str(&comment(&format!("{}: {}", Maxima.letter(&entry.letter), entry.meaning)));
    }
    for motion in &sheet.motions {
        let against = if motion.against_iso { ", counted against the ISO sense" } else { "" };
        let name = Maxima.letter(&motion.letter);
        text.push_str(&comment(&format!(
            "{name}: {}, {} ({}{against})",
            motion.iso, motion.meaning, motion.unit
        )));
    }
    if !sheet.brackets.is_empty() {
        text.push('\n');
        text.extend(sheet.brackets.iter().map(assignment));
    }
    for row in sheet.rows.iter().chain(&sheet.orientation) {
        text.push('\n');
        text.push_str(&assignment(&row.error));
        text.push_str(&assignment(&row.position));
    }
    text
}

fn assignment(statement: &Statement) -> String {
    let mut pieces = pieces(&Maxima, &statement.right);
    if let Some(last) = pieces.last_mut() {
        last.text.push('$');
    }
    wrap::equation(&format!("{} : ", Maxima.letter(&statement.left)), &pieces)
}

/// A comment on one line; what would close it early or nest in it is pulled apart.
fn comment(text: &str) -> String {
    format!("/* {} */\n", text.replace("*/", "* /").replace("/*", "/ *").replace(['\n', '\r'], " "))
}
