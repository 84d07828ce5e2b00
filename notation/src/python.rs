//! Equations for Python. In: a sheet. Out: a module without dependencies, whose functions take numbers, NumPy
//! arrays or SymPy symbols: whoever checks a machine in a notebook has its nominal position, its error and its lever arms.

use model_dsl::sheet::{
    Angle, Expression, Function, Letter, Number, Sheet, Signs, Statement, Writer, pieces, wrap,
};

/// Keywords of Python, and the names that the functions of the module use.
const RESERVED: [&str; 41] = [
    "False",
    "None",
    "True",
    "and",
    "as",
    "assert",
    "async",
    "await",
    "break",
    "class",
    "continue",
    "def",
    "del",
    "elif",
    "else",
    "except",
    "finally",
    "for",
    "from",
    "functions",
    "global",
    "if",
    "import",
    "in",
    "is",
    "lambda",
    "math",
    "motions",
    "nonlocal",
    "not",
    "operator",
    "or",
    "pass",
    "raise",
    "return",
    "try",
    "values",
    "while",
    "with",
    "yield",
    "_ratio",
];

struct Python;

impl Writer for Python {
    fn signs(&self) -> &'static Signs {
        &Signs::PLAIN
    }

    fn letter(&self, letter: &Letter) -> String {
        letter.unless_reserved(&RESERVED)
    }

    fn number(&self, number: &Number) -> String {
        match &number.denominator {
            Some(denominator) => format!("_ratio({}, {denominator})", number.numerator),
            None => number.numerator.clone(),
        }
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("{base}**{exponent}")
    }

    fn function(&self, function: Function, argument: &str) -> String {
        format!("functions.{}({argument})", function.word())
    }

    fn angle(&self, angle: &Angle) -> String {
        format!("{}*functions.pi", self.number(&angle.half_turns))
    }
}

/// The module.
pub(super) fn module(sheet: &Sheet) -> String {
    let source = sheet.source.as_ref().map(|source| format!("\nSource: {source}")).unwrap_or_default();
    let about = format!(
        "{}\n\nThe error equations of the tool tip relative to the part, to first order. Lengths in mm, angles in rad.{source}\n\n\
         Values are numbers; arrays with `functions=numpy`; symbols with `functions=sympy`.\n",
        sheet.heading()
    );
    let values = sheet.quantities.iter().map(|one| (one.letter.plain.as_str(), one.meaning.clone()));
    let motions = sheet.motions.iter().map(|one| {
        let against = if one.against_iso { ", counted against the ISO sense" } else { "" };
        (one.letter.plain.as_str(), format!("{}, {} ({}{against})", one.iso, one.meaning, one.unit))
    });
    let mut parts = vec![
        format!("\"\"\"{}\"\"\"\n\nimport math\nimport operator\n", quoted(&about)),
        dictionary("VALUES", "Positions, travels and constants.", values),
        dictionary("MOTIONS", "Error motions.", motions),
        nominal(sheet),
        error(sheet),
        levers(sheet),
    ];
    if !sheet.orientation.is_empty() {
        parts.extend([direction(sheet), direction_error(sheet)]);
    }
    parts.join("\n")
}

fn direction(sheet: &Sheet) -> String {
    let rows = sheet.orientation.iter().map(|row| entry(&row.position.left.plain, &row.whole));
    let about =
        "The direction of the tool without errors, from its tip towards the spindle: a vector of length 1.";
    function("direction(values, functions=math)", about, &values(sheet), rows)
}

fn direction_error(sheet: &Sheet) -> String {
    let rows = sheet.orientation.iter().map(|row| entry(&row.position.left.plain, &row.error.right));
    let about = "The error of the direction of the tool, rad; motions that are not given are 0.";
    let head = "direction_error(values, motions, functions=math)";
    function(head, about, &format!("{}{}", values(sheet), given(sheet)), rows)
}

fn nominal(sheet: &Sheet) -> String {
    let rows = sheet.rows.iter().map(|row| entry(&row.direction.to_string(), &row.whole));
    let about = "The position of the tool tip without errors, by direction, mm.";
    function("nominal(values, functions=math)", about, &values(sheet), rows)
}

fn error(sheet: &Sheet) -> String {
    let rows = sheet.rows.iter().map(|row| entry(&row.direction.to_string(), &row.error.right));
    let about = "The error of the tool tip, by direction, mm; motions that are not given are 0.";
    let names = format!("{}{}", values(sheet), given(sheet));
    function("error(values, motions, functions=math)", about, &names, rows)
}

/// The names of the error motions, as far as they are given.
fn given(sheet: &Sheet) -> String {
    let names = sheet.motions.iter().map(|motion| &motion.letter);
    names
        .map(|letter| format!("    {} = motions.get(\"{}\", 0)\n", Python.letter(letter), letter.plain))
        .collect()
}

fn levers(sheet: &Sheet) -> String {
    let arms = sheet.motions.iter().map(|motion| {
        let seen = sheet.rows.iter().zip(&motion.arms).filter_map(|(row, arm)| Some((row, arm.as_ref()?)));
        let entries: String = seen
            .map(|(row, arm)| {
                format!("    {}", entry(&row.direction.to_string(), arm)).replace('\n', "\n    ")
            })
            .map(|entry| format!("{}\n", entry.trim_end()))
            .collect();
        format!("        \"{}\": {{\n{entries}        }},\n", motion.letter.plain)
    });
    let about = "The lever arm of each error motion, by direction: mm for an angle, a pure number for a displacement.";
    function("levers(values, functions=math)", about, &values(sheet), arms)
}

/// A function that answers a dictionary.
fn function(head: &str, about: &str, names: &str, entries: impl Iterator<Item = String>) -> String {
    let entries: String = entries.collect();
    format!(
        "\ndef {head}:\n    \"\"\"{about}\"\"\"\n    _ratio = getattr(functions, \"Rational\", operator.truediv)\n{names}    \
         return {{\n{entries}    }}\n"
    )
}

/// The names of positions, travels and constants, and the brackets made of them.
fn values(sheet: &Sheet) -> String {
    let name = |letter: &Letter| format!("    {} = values[\"{}\"]\n", Python.letter(letter), letter.plain);
    let values = sheet.quantities.iter().map(|one| name(&one.letter));
    values.chain(sheet.brackets.iter().map(bracket)).collect()
}

/// A bracket under its name.
fn bracket(statement: &Statement) -> String {
    bracketed(&format!("    {} = (", Python.letter(&statement.left)), &statement.right, ")")
}

/// An expression under a key, in brackets, so that it may go on in the next line.
fn entry(key: &str, expression: &Expression) -> String {
    bracketed(&format!("        \"{key}\": ("), expression, "),")
}

/// An expression between a head that opens a bracket and a tail that closes it.
fn bracketed(head: &str, expression: &Expression, tail: &str) -> String {
    let mut pieces = pieces(&Python, expression);
    if let Some(last) = pieces.last_mut() {
        last.text.push_str(tail);
    }
    wrap::equation(head, &pieces)
}

/// Names with what they mean.
fn dictionary<'n>(name: &str, about: &str, entries: impl Iterator<Item = (&'n str, String)>) -> String {
    let entries: String = entries
        .map(|(name, meaning)| format!("    \"{name}\": \"{}\",\n", quoted(&meaning).replace('"', "'")))
        .collect();
    format!("# {about}\n{name} = {{\n{entries}}}\n")
}

/// Text inside quotation marks of Python.
fn quoted(text: &str) -> String {
    text.replace('\\', "\\\\").replace("\"\"\"", "'''").replace('\r', " ")
}
