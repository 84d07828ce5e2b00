//! The three notations of a formula. In: its parts. Out: plain text, LaTeX, MathML.

use pages::text::escape;

use super::Math;
use crate::latex::escape as escape_latex;

/// How a notation spells the parts of a formula.
pub(super) trait Spelling {
    fn quantity(&self, number: &str, unit: &str) -> String;
    fn symbol(&self, letter: &str, of: &str) -> String;
    fn times(&self) -> &'static str;
    fn signs(&self) -> [&'static str; 3];
    fn quotient(&self, above: &str, below: &str, bracketed: bool) -> String;
    fn power(&self, base: &str, exponent: usize) -> String;
    fn function(&self, name: &str, argument: &str) -> String;
    fn brackets(&self, inner: &str) -> String;
    fn size(&self, inner: &str) -> String;
    fn since(&self, time: &str) -> String;
    fn held(&self, inner: &str) -> String;
}

/// A formula in a notation.
pub(super) fn spelled(math: &Math, by: &impl Spelling) -> String {
    match math {
        Math::Quantity(value, unit) => by.quantity(&rounded(*value), unit),
        Math::Symbol(letter, of) => by.symbol(letter, of),
        Math::Product(factors) => {
            let alone = factors.len() == 1;
            let each = factors.iter().map(|factor| match factor {
                Math::Sum(_) if !alone => by.brackets(&spelled(factor, by)),
                other => spelled(other, by),
            });
            each.collect::<Vec<_>>().join(by.times())
        }
        Math::Sum(parts) => {
            let [leading, plus, minus] = by.signs();
            let mut text = String::new();
            for (number, (negative, part)) in parts.iter().enumerate() {
                text += match (number, negative) {
                    (0, true) => leading,
                    (0, false) => "",
                    (_, true) => minus,
                    (_, false) => plus,
                };
                text += &spelled(part, by);
            }
            text
        }
        Math::Quotient(above, below) => {
            let bracketed = matches!(**below, Math::Sum(_) | Math::Product(_) | Math::Quantity(..));
            by.quotient(&spelled(above, by), &spelled(below, by), bracketed)
        }
        Math::Power(base, exponent) => by.power(&spelled(base, by), *exponent),
        Math::Function(name, argument) => by.function(name, &spelled(argument, by)),
        Math::Size(inner) => by.size(&spelled(inner, by)),
        Math::Since(time) => by.since(&by.quantity(&rounded(*time), "s")),
        Math::Held(inner) => by.held(&spelled(inner, by)),
    }
}

/// A number in four digits: it is for people, who have the exact one in the file.
fn rounded(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&magnitude) {
        // As many as are needed for four digits: times ten until four stand before the point.
        let decimals = std::iter::successors(Some(magnitude), |larger| Some(larger * 10.0))
            .take_while(|larger| value != 0.0 && *larger < 1000.0)
            .count();
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{value:.3e}");
        match text.split_once('e') {
            Some((digits, exponent)) => {
                format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
            }
            None => text,
        }
    }
}

pub(super) struct Plain;

impl Spelling for Plain {
    fn quantity(&self, number: &str, unit: &str) -> String {
        if unit.is_empty() { number.to_owned() } else { format!("{number} {unit}") }
    }
    fn symbol(&self, letter: &str, of: &str) -> String {
        if of.is_empty() { letter.to_owned() } else { format!("{letter}_{of}") }
    }
    fn times(&self) -> &'static str {
        " * "
    }
    fn signs(&self) -> [&'static str; 3] {
        ["-", " + ", " - "]
    }
    fn quotient(&self, above: &str, below: &str, bracketed: bool) -> String {
        if bracketed { format!("{above}/({below})") } else { format!("{above}/{below}") }
    }
    fn power(&self, base: &str, exponent: usize) -> String {
        format!("{base}^{exponent}")
    }
    fn function(&self, name: &str, argument: &str) -> String {
        format!("{name}({argument})")
    }
    fn brackets(&self, inner: &str) -> String {
        format!("({inner})")
    }
    fn size(&self, inner: &str) -> String {
        format!("|{inner}|")
    }
    fn since(&self, time: &str) -> String {
        format!("(1 from t = {time} on)")
    }
    fn held(&self, inner: &str) -> String {
        format!("[{inner}]")
    }
}

pub(super) struct Latex;

impl Spelling for Latex {
    fn quantity(&self, number: &str, unit: &str) -> String {
        let number = match number.split_once('e') {
            Some((digits, exponent)) => format!("{digits}\\cdot 10^{{{exponent}}}"),
            None => number.to_owned(),
        };
        if unit.is_empty() { number } else { format!("{number}\\,\\mathrm{{{}}}", latex_unit(unit)) }
    }
    fn symbol(&self, letter: &str, of: &str) -> String {
        let letter = if letter == "2 pi" { "2\\pi" } else { letter };
        if of.is_empty() {
            letter.to_owned()
        } else {
            format!("{letter}_{{\\mathrm{{{}}}}}", escape_latex(of))
        }
    }
    fn times(&self) -> &'static str {
        "\\,"
    }
    fn signs(&self) -> [&'static str; 3] {
        ["-", " + ", " - "]
    }
    fn quotient(&self, above: &str, below: &str, _bracketed: bool) -> String {
        format!("\\frac{{{above}}}{{{below}}}")
    }
    fn power(&self, base: &str, exponent: usize) -> String {
        format!("{{{base}}}^{{{exponent}}}")
    }
    fn function(&self, name: &str, argument: &str) -> String {
        let name = match name {
            "sin" | "exp" => format!("\\{name}"),
            other => other.to_owned(),
        };
        format!("{name}\\left({argument}\\right)")
    }
    fn brackets(&self, inner: &str) -> String {
        format!("\\left({inner}\\right)")
    }
    fn size(&self, inner: &str) -> String {
        format!("\\left|{inner}\\right|")
    }
    fn since(&self, time: &str) -> String {
        format!("\\left[t \\ge {time}\\right]")
    }
    fn held(&self, inner: &str) -> String {
        format!("\\left[{inner}\\right]")
    }
}

fn latex_unit(unit: &str) -> String {
    unit.split_once('^')
        .map_or_else(|| escape_latex(unit), |(base, power)| format!("{}^{{{power}}}", escape_latex(base)))
}

pub(super) struct MathMl;

impl Spelling for MathMl {
    fn quantity(&self, number: &str, unit: &str) -> String {
        let number = number.replace('-', "\u{2212}");
        if unit.is_empty() {
            format!("<mn>{number}</mn>")
        } else {
            format!("<mn>{number}</mn><mspace width=\"0.2em\"/><mtext>{}</mtext>", escape(unit))
        }
    }
    fn symbol(&self, letter: &str, of: &str) -> String {
        let letter = match letter {
            "2 pi" => "<mn>2</mn><mi>\u{3c0}</mi>".to_owned(),
            other => format!("<mi>{}</mi>", escape(other)),
        };
        if of.is_empty() { letter } else { format!("<msub>{letter}<mtext>{}</mtext></msub>", escape(of)) }
    }
    fn times(&self) -> &'static str {
        "<mo>\u{b7}</mo>"
    }
    fn signs(&self) -> [&'static str; 3] {
        ["<mo form=\"prefix\">\u{2212}</mo>", "<mo>+</mo>", "<mo>\u{2212}</mo>"]
    }
    fn quotient(&self, above: &str, below: &str, _bracketed: bool) -> String {
        format!("<mfrac><mrow>{above}</mrow><mrow>{below}</mrow></mfrac>")
    }
    fn power(&self, base: &str, exponent: usize) -> String {
        format!("<msup><mrow>{base}</mrow><mn>{exponent}</mn></msup>")
    }
    fn function(&self, name: &str, argument: &str) -> String {
        format!("<mi>{}</mi><mo>(</mo>{argument}<mo>)</mo>", escape(name))
    }
    fn brackets(&self, inner: &str) -> String {
        format!("<mo>(</mo>{inner}<mo>)</mo>")
    }
    fn size(&self, inner: &str) -> String {
        format!("<mo>|</mo>{inner}<mo>|</mo>")
    }
    fn since(&self, time: &str) -> String {
        format!("<mo>[</mo><mi>t</mi><mo>\u{2265}</mo>{time}<mo>]</mo>")
    }
    fn held(&self, inner: &str) -> String {
        format!("<mo>[</mo>{inner}<mo>]</mo>")
    }
}
