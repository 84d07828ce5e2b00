//! MathML Core. In: trees. Out: `math` elements that a browser sets without help of a script.
//!
//! An equation is a table of lines, since browsers do not break formulas themselves.

use std::collections::BTreeMap;

use pages::text::escape;

use model_dsl::sheet::{
    Angle, Base, Expression, Function, Letter, Number, Signs, Statement, Writer, line, pieces, text::Plain,
    wrap,
};

/// The widest line of an equation, measured in characters of plain text.
const EQUATION_WIDTH: usize = 84;
/// The widest line of a lever arm in a table.
const ARM_WIDTH: usize = 24;

struct MathMl;

impl Writer for MathMl {
    fn signs(&self) -> &'static Signs {
        &Signs {
            plus: "<mo form=\"infix\">+</mo>",
            minus: "<mo form=\"infix\">−</mo>",
            leading_minus: "<mo form=\"prefix\">−</mo>",
            times: "<mo>&#x2062;</mo><mspace width=\"0.17em\"/>",
            open: "<mo stretchy=\"false\">(</mo>",
            close: "<mo stretchy=\"false\">)</mo>",
        }
    }

    fn letter(&self, letter: &Letter) -> String {
        let base = match &letter.base {
            Base::Letter(one) => format!("<mi>{}</mi>", escape(&one.to_string())),
            Base::Word(word) => format!("<mi>{}</mi>", escape(word)),
            Base::Greek(greek) => format!("<mi>{}</mi>", greek.character),
        };
        let difference = if letter.difference { "<mi mathvariant=\"normal\">Δ</mi>" } else { "" };
        match &letter.subscript {
            Some(subscript) => {
                let subscript = format!("<mi mathvariant=\"normal\">{}</mi>", escape(subscript));
                format!("{difference}<msub>{base}{subscript}</msub>")
            }
            None => format!("{difference}{base}"),
        }
    }

    fn number(&self, number: &Number) -> String {
        match (&number.decimal, &number.denominator) {
            (Some(decimal), _) => format!("<mn>{decimal}</mn>"),
            (None, Some(denominator)) => {
                format!("<mfrac><mn>{}</mn><mn>{denominator}</mn></mfrac>", number.numerator)
            }
            (None, None) => format!("<mn>{}</mn>", number.numerator),
        }
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("<msup><mrow>{base}</mrow><mn>{exponent}</mn></msup>")
    }

    fn function(&self, function: Function, argument: &str) -> String {
        let Signs { open, close, .. } = self.signs();
        format!("<mi>{}</mi><mo>&#x2061;</mo>{open}{argument}{close}", function.word())
    }

    fn angle(&self, angle: &Angle) -> String {
        format!("{}<mi mathvariant=\"normal\">°</mi>", self.number(&angle.degrees))
    }
}

/// The same with numbers in the place of names.
struct Filled<'v> {
    /// By the name in plain text, as it is to be read, sign included.
    values: &'v BTreeMap<String, String>,
}

impl Writer for Filled<'_> {
    fn signs(&self) -> &'static Signs {
        &Signs {
            plus: "<mo form=\"infix\">+</mo>",
            minus: "<mo form=\"infix\">−</mo>",
            leading_minus: "<mo form=\"prefix\">−</mo>",
            times: "<mo>×</mo>",
            open: "<mo stretchy=\"false\">(</mo>",
            close: "<mo stretchy=\"false\">)</mo>",
        }
    }

    fn letter(&self, letter: &Letter) -> String {
        match self.values.get(&letter.plain) {
            Some(value) => in_a_sum(value),
            None => MathMl.letter(letter),
        }
    }

    fn number(&self, number: &Number) -> String {
        MathMl.number(number)
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        MathMl.power(base, exponent)
    }

    fn function(&self, function: Function, argument: &str) -> String {
        MathMl.function(function, argument)
    }

    fn angle(&self, angle: &Angle) -> String {
        MathMl.angle(angle)
    }
}

/// A number as it stands in a sum or product: in brackets where it is negative.
fn in_a_sum(value: &str) -> String {
    let Signs { leading_minus, open, close, .. } = MathMl.signs();
    match value.strip_prefix('-') {
        Some(digits) => format!("{open}{leading_minus}<mn>{}</mn>{close}", escape(digits)),
        None => format!("<mn>{}</mn>", escape(value)),
    }
}

/// One error motion worked through: `dPx = (z - Zt) e = (200 - 70) mm x 10 urad = +1.3 um`.
pub(super) fn worked(
    (error, arm, motion): (&Letter, &Expression, &Letter),
    values: &BTreeMap<String, String>,
    (value, result): (&str, &str),
) -> String {
    let Signs { open, close, leading_minus, .. } = MathMl.signs();
    let (symbols, numbers) = (line(&MathMl, arm), line(&Filled { values }, arm));
    let unit = |unit: &str| format!("<mspace width=\"0.2em\"/><mi mathvariant=\"normal\">{unit}</mi>");
    let result = match result.strip_prefix('-') {
        Some(digits) => format!("{leading_minus}<mn>{digits}</mn>"),
        None => format!("<mo form=\"prefix\">+</mo><mn>{result}</mn>"),
    };
    format!(
        "<math display=\"block\">{}<mo>=</mo>{open}{symbols}{close}{}<mo>=</mo>{open}{numbers}{close}{}\
         <mo>×</mo><mn>{value}</mn>{}<mo>=</mo>{result}{}</math>\n",
        MathMl.letter(error),
        MathMl.letter(motion),
        unit("mm"),
        unit("µrad"),
        unit("µm")
    )
}

/// A letter in running text.
pub(super) fn letter(letter: &Letter) -> String {
    format!("<math>{}</math>", MathMl.letter(letter))
}

/// A lever arm in a table.
pub(super) fn arm(arm: &Expression) -> String {
    stacked(arm, ARM_WIDTH)
}

/// A part of an equation, beside its name.
pub(super) fn part(part: &Expression) -> String {
    stacked(part, EQUATION_WIDTH)
}

/// An expression on several lines where it is long.
fn stacked(expression: &Expression, width: usize) -> String {
    let lines = lines(expression, width);
    match lines.as_slice() {
        [line] => format!("<math>{line}</math>"),
        lines => {
            let rows: String = lines.iter().map(|line| format!("<mtr><mtd>{line}</mtd></mtr>")).collect();
            format!("<math><mtable class=\"lines\">{rows}</mtable></math>")
        }
    }
}

/// An equation set on its own.
pub(super) fn equation(statement: &Statement) -> String {
    let left = MathMl.letter(&statement.left);
    let mut heads = std::iter::once(format!("<mtd>{left}</mtd><mtd><mo>=</mo></mtd>"));
    let rows: String = lines(&statement.right, EQUATION_WIDTH)
        .into_iter()
        .map(|line| {
            let head = heads.next().unwrap_or_else(|| "<mtd></mtd><mtd></mtd>".to_owned());
            format!("<mtr>{head}<mtd>{line}</mtd></mtr>\n")
        })
        .collect();
    format!("<math display=\"block\"><mtable class=\"equation\">\n{rows}</mtable></math>\n")
}

fn lines(expression: &Expression, width: usize) -> Vec<String> {
    let written = pieces(&MathMl, expression);
    let plain = pieces(&Plain, expression);
    let set = |line: &wrap::Line| {
        let indent = if line.inside { "<mspace width=\"2em\"/>" } else { "" };
        format!("{indent}{}", wrap::join(&written, line))
    };
    wrap::lines(&plain, width).iter().map(set).collect()
}
