//! Infix expressions: text to polynomial.
//!
//! In: `(z + Z1 - Zt)*eyz`, as machine files write offsets and reports print equations.
//! Out: a canonical [`Polynomial`], or the first mistake with its place in the text.
//! Size is bounded, so that no text can make the reader run away.

use crate::algebra::{Polynomial, Symbol, decimal, sine_and_cosine};
use num_traits::{One, Zero};

/// The most monomials that an expression may expand to.
const MOST_TERMS: usize = 20_000;
/// The deepest nesting of parentheses and signs.
const MOST_NESTING: usize = 100;
/// The longest numerator or denominator: far beyond a double, and far from running away.
const MOST_BITS: u64 = 4096;
/// The most products of two monomials, and monomials added, that reading one expression may take.
const MOST_WORK: usize = 20_000;
/// The highest power that may be written.
const MOST_POWER: u32 = 16;

/// What is wrong with an expression, and the byte range of the text it concerns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpressionError {
    /// What is wrong, as a fragment that ends a sentence.
    pub message: String,
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

/// Reads an expression; `resolve` gives the symbol that a name stands for, or `None` for an unknown one.
pub fn parse(
    text: &str,
    resolve: &mut dyn FnMut(&str) -> Option<Symbol>,
) -> Result<Polynomial, ExpressionError> {
    let mut work = MOST_WORK;
    parse_within(text, resolve, &mut work)
}

/// Reads one of several expressions, whose reading may take so much work together: products of two monomials, and monomials
/// added. What this one takes is taken off; it may take no more than one that is read alone.
pub fn parse_within(
    text: &str,
    resolve: &mut dyn FnMut(&str) -> Option<Symbol>,
    work: &mut usize,
) -> Result<Polynomial, ExpressionError> {
    let allowed = MOST_WORK.min(*work);
    let mut parser =
        Parser { tokens: tokens(text)?, at: 0, end: text.len(), depth: 0, resolve, work: allowed };
    let value = parser.whole();
    *work -= allowed - parser.work;
    value
}

#[derive(Clone, Copy)]
struct Token<'a> {
    text: &'a str,
    start: usize,
}

impl Token<'_> {
    fn error(&self, message: impl Into<String>) -> ExpressionError {
        ExpressionError { message: message.into(), start: self.start, end: self.start + self.text.len() }
    }

    fn starts_with(&self, test: impl Fn(char) -> bool) -> bool {
        self.text.chars().next().is_some_and(test)
    }
}

fn tokens(text: &str) -> Result<Vec<Token<'_>>, ExpressionError> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let start = text.len() - rest.len();
        let length = if first.is_whitespace() {
            first.len_utf8()
        } else if first.is_ascii_alphabetic() {
            name_length(rest)
        } else if first.is_ascii_digit() || first == '.' {
            number_length(rest)
        } else if "+-*/^()".contains(first) {
            1
        } else {
            let token = Token { text: &rest[..first.len_utf8()], start };
            return Err(token.error(format!("`{first}` is not allowed in an expression")));
        };
        if !first.is_whitespace() {
            found.push(Token { text: &rest[..length], start });
        }
        rest = &rest[length..];
    }
    Ok(found)
}

/// The length of the name at the beginning: letters, digits and `_`, and between these once another axis, `EA(0Y)C`.
fn name_length(text: &str) -> usize {
    let plain = plain_length(text);
    let counted = || {
        let inside = text[plain..].strip_prefix("(0").or_else(|| text[plain..].strip_prefix("(O"))?;
        let from = plain_length(inside);
        let after = inside[from..].strip_prefix(')').filter(|_| from > 0)?;
        let link = plain_length(after);
        (link > 0).then(|| text.len() - after.len() + link)
    };
    counted().unwrap_or(plain)
}

fn plain_length(text: &str) -> usize {
    text.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(text.len())
}

/// The length of the number at the beginning: digits, one point, and an exponent if digits follow it.
fn number_length(text: &str) -> usize {
    let mantissa = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let Some(exponent) = text[mantissa..].strip_prefix(['e', 'E']) else { return mantissa };
    let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    let digits = unsigned.find(|c: char| !c.is_ascii_digit()).unwrap_or(unsigned.len());
    if digits == 0 { mantissa } else { text.len() - unsigned.len() + digits }
}

struct Parser<'a, 'r> {
    tokens: Vec<Token<'a>>,
    at: usize,
    end: usize,
    depth: usize,
    resolve: &'r mut dyn FnMut(&str) -> Option<Symbol>,
    /// How much may still be done.
    work: usize,
}

impl<'a> Parser<'a, '_> {
    fn whole(&mut self) -> Result<Polynomial, ExpressionError> {
        let value = self.sum()?;
        match self.peek() {
            None => Ok(value),
            Some(token) => Err(token.error(format!("unexpected `{}`", token.text))),
        }
    }

    fn peek(&self) -> Option<Token<'a>> {
        self.tokens.get(self.at).copied()
    }

    fn take(&mut self, text: &str) -> Option<Token<'a>> {
        let token = self.peek().filter(|token| token.text == text)?;
        self.at += 1;
        Some(token)
    }

    fn next(&mut self) -> Result<Token<'a>, ExpressionError> {
        let token = self.peek().ok_or(ExpressionError {
            message: "the expression ends too early".to_owned(),
            start: self.end,
            end: self.end,
        })?;
        self.at += 1;
        Ok(token)
    }

    fn sum(&mut self) -> Result<Polynomial, ExpressionError> {
        let mut sum = self.product()?;
        loop {
            let (token, part) = match (self.take("+"), self.take("-")) {
                (Some(token), _) => (token, self.product()?),
                (None, Some(token)) => (token, -&self.product()?),
                (None, None) => return Ok(sum),
            };
            self.spend(part.size(), &token)?;
            sum += &part;
        }
    }

    fn product(&mut self) -> Result<Polynomial, ExpressionError> {
        let mut product = self.signed()?;
        loop {
            if let Some(token) = self.take("*") {
                let factor = self.signed()?;
                product = self.bounded_product(&product, &factor, &token)?;
            } else if let Some(token) = self.take("/") {
                product = quotient(&product, &self.signed()?, &token)?;
            } else {
                return Ok(product);
            }
        }
    }

    fn signed(&mut self) -> Result<Polynomial, ExpressionError> {
        if let Some(token) = self.take("-") {
            return Ok(-&self.nested(&token, Self::signed)?);
        }
        match self.take("+") {
            Some(token) => self.nested(&token, Self::signed),
            None => self.power(),
        }
    }

    fn power(&mut self) -> Result<Polynomial, ExpressionError> {
        let base = self.atom()?;
        let Some(caret) = self.take("^") else { return Ok(base) };
        let token = self.next()?;
        let exponent = token.text.parse::<u32>().ok().filter(|power| *power <= MOST_POWER);
        let Some(exponent) = exponent else {
            return Err(token.error(format!("a power must be a whole number from 0 to {MOST_POWER}")));
        };
        let mut product = Polynomial::one();
        for _ in 0..exponent {
            product = self.bounded_product(&product, &base, &caret)?;
        }
        Ok(product)
    }

    fn atom(&mut self) -> Result<Polynomial, ExpressionError> {
        let token = self.next()?;
        if token.text == "(" {
            let inner = self.nested(&token, Self::sum)?;
            return self.close(&token).map(|()| inner);
        }
        if token.starts_with(|c| c.is_ascii_digit() || c == '.') {
            let value = decimal(token.text);
            return value.map(Polynomial::number).ok_or_else(|| token.error("this is not a number"));
        }
        if !token.starts_with(|c| c.is_ascii_alphabetic()) {
            return Err(token.error(format!("unexpected `{}`", token.text)));
        }
        match token.text {
            "sin" | "cos" if self.peek().is_some_and(|next| next.text == "(") => self.trigonometric(&token),
            name => self.symbol(&token, name),
        }
    }

    fn trigonometric(&mut self, function: &Token<'a>) -> Result<Polynomial, ExpressionError> {
        let open = self.next()?;
        let argument = self.next()?;
        if let Some(degrees) = decimal(argument.text).filter(|_| self.take("deg").is_some()) {
            self.close(&open)?;
            let (sine, cosine) = sine_and_cosine(&degrees);
            return Ok(if function.text == "sin" { sine } else { cosine });
        }
        self.close(&open)?;
        let axis = match (self.resolve)(argument.text) {
            Some(Symbol::Position(axis)) => axis,
            Some(_) => return Err(argument.error("a sine or cosine must take the position of an axis")),
            None => return Err(argument.error(format!("`{}` is unknown here", argument.text))),
        };
        let symbol = if function.text == "sin" { Symbol::Sin(axis) } else { Symbol::Cos(axis) };
        Ok(Polynomial::symbol(symbol))
    }

    fn symbol(&mut self, token: &Token<'a>, name: &str) -> Result<Polynomial, ExpressionError> {
        let symbol = (self.resolve)(name);
        symbol.map(Polynomial::symbol).ok_or_else(|| token.error(format!("`{name}` is unknown here")))
    }

    fn close(&mut self, open: &Token<'a>) -> Result<(), ExpressionError> {
        let closed = self.take(")").is_some();
        if closed { Ok(()) } else { Err(open.error("this parenthesis is not closed")) }
    }

    fn nested(
        &mut self,
        token: &Token<'a>,
        inner: impl FnOnce(&mut Self) -> Result<Polynomial, ExpressionError>,
    ) -> Result<Polynomial, ExpressionError> {
        if self.depth == MOST_NESTING {
            return Err(token.error("the expression is nested too deeply"));
        }
        self.depth += 1;
        let value = inner(self);
        self.depth -= 1;
        value
    }

    fn bounded_product(
        &mut self,
        left: &Polynomial,
        right: &Polynomial,
        token: &Token<'_>,
    ) -> Result<Polynomial, ExpressionError> {
        let size = left.size().saturating_mul(right.size());
        if size > MOST_TERMS {
            return Err(token.error("the product expands to too many terms"));
        }
        self.spend(size, token)?;
        let product = left * right;
        let bits = |value: &crate::algebra::Rational| value.numer().bits().max(value.denom().bits());
        if product.terms().any(|(_, value)| bits(value) > MOST_BITS) {
            return Err(token.error("the product contains a number with too many digits"));
        }
        Ok(product)
    }

    fn spend(&mut self, work: usize, token: &Token<'_>) -> Result<(), ExpressionError> {
        self.work = self
            .work
            .checked_sub(work)
            .ok_or_else(|| token.error("the expression expands to too many terms"))?;
        Ok(())
    }
}

fn quotient(
    dividend: &Polynomial,
    divisor: &Polynomial,
    token: &Token<'_>,
) -> Result<Polynomial, ExpressionError> {
    match divisor.as_number() {
        Some(number) if !number.is_zero() => {
            Ok(dividend * &Polynomial::number(crate::algebra::Rational::one() / number))
        }
        _ => Err(token.error("only division by a nonzero number is allowed")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Polynomial, ExpressionError> {
        parse(text, &mut |name| match name {
            "x" | "c" => Some(Symbol::Position(name.into())),
            "Z1" | "Zt" => Some(Symbol::Constant(name.into())),
            _ => None,
        })
    }

    #[test]
    fn precedence_signs_and_parentheses() {
        let cases = [
            ("-(x - Zt)*Z1", "Zt*Z1 - x*Z1"),
            ("2*x^2 - x*x", "x*x"),
            ("x - -Z1", "x + Z1"),
            ("-x^2", "0 - x*x"),
            ("(x + Z1)/2", "0.5*x + 0.5*Z1"),
            ("sin(c)^2 + cos(c)^2", "1"),
            ("sin(c)*sin(c)*cos(c)", "cos(c) - cos(c)^3"),
            ("sin(20 deg)^2*x + x*sin(70deg)^2", "x"),
            ("2*cos(45 deg)^2 - cos(60 deg)", "1/2"),
        ];
        for (left, right) in cases {
            assert_eq!(read(left), read(right), "{left}");
        }
    }

    #[test]
    fn mistakes_are_located() {
        let cases = [
            ("x + q", "`q` is unknown here", 4, 5),
            ("x +", "the expression ends too early", 3, 3),
            ("(x", "this parenthesis is not closed", 0, 1),
            ("x # 1", "`#` is not allowed in an expression", 2, 3),
            ("x/0", "only division by a nonzero number is allowed", 1, 2),
            ("x Zt", "unexpected `Zt`", 2, 4),
            ("x^99", "a power must be a whole number from 0 to 16", 2, 4),
            ("sin(Zt)", "a sine or cosine must take the position of an axis", 4, 6),
        ];
        for (text, message, start, end) in cases {
            let expected = ExpressionError { message: message.to_owned(), start, end };
            assert_eq!(read(text), Err(expected), "{text}");
        }
    }

    #[test]
    fn size_is_bounded() {
        assert!(read(&"(".repeat(100_000)).is_err());
        assert!(read(&"-".repeat(100_000)).is_err());
        assert!(read(&format!("{}x", "(x+Z1+Zt+c+1)^16*".repeat(8))).is_err());
        assert!(read(&format!("{}9{}", "(".repeat(50), ")^16".repeat(50))).is_err());
    }

    /// No step is large here, but there are many.
    #[test]
    fn work_is_bounded() {
        let told = |text: String| read(&text).map_err(|error| error.message);
        let too_much = Err("the expression expands to too many terms".to_owned());
        assert_eq!(told(format!("x{}", "*sin(c)".repeat(20_000))), too_much);
        assert_eq!(told(format!("x{}", "*(x + Z1 + Zt)".repeat(200))), too_much);
        assert_eq!(told(format!("x{}", " - x".repeat(200_000))), too_much);
        let mut left = 3;
        let mut read = |text: &str| {
            parse_within(text, &mut |name| Some(Symbol::Constant(name.into())), &mut left).is_ok()
        };
        assert!(read("a*b + c") && !read("a*b + c"));
    }
}
