//! The notation tree and how polynomials become one: order, signs and brackets are settled here.
//!
//! In: polynomials, and lever arms with their error motions. Out: a tree in which a sum carries the sign of
//! each of its parts and a bracket stands wherever a reader needs one.

use num_traits::{One, Signed as _};

use super::letter::Letter;
use super::number::Number;
use crate::algebra::{FixedAngle, Monomial, Polynomial, Rational, Symbol};

/// A sine or cosine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// The cosine.
    Cos,
    /// The sine.
    Sin,
}

impl Function {
    /// `cos` or `sin`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Cos => "cos",
            Self::Sin => "sin",
        }
    }
}

/// An angle that never changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Angle {
    /// In degrees.
    pub degrees: Number,
    /// As a multiple of pi.
    pub half_turns: Number,
}

impl Angle {
    fn new(angle: &FixedAngle) -> Self {
        let half_turn = Rational::from_integer(180.into());
        Self {
            degrees: Number::new(angle.degrees()),
            half_turns: Number::new(&(angle.degrees() / half_turn)),
        }
    }
}

/// One part of a sum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signed {
    /// Whether it is subtracted.
    pub negative: bool,
    /// The part without its sign.
    pub value: Expression,
}

/// An expression as it is written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Expression {
    /// Parts with their signs; never empty.
    Sum(Vec<Signed>),
    /// Factors; a sum among them stands in a [`Expression::Group`].
    Product(Vec<Expression>),
    /// A letter or function to a power of 2 or more.
    Power(Box<Expression>, u32),
    /// A sine or cosine of a position.
    Function(Function, Letter),
    /// A sine or cosine of an angle that never changes.
    Fixed(Function, Angle),
    /// A name.
    Letter(Letter),
    /// A number, not negative.
    Number(Number),
    /// Something in brackets.
    Group(Box<Expression>),
}

/// A polynomial as a sum.
pub(super) fn polynomial(polynomial: &Polynomial) -> Expression {
    sum(parts(polynomial))
}

/// Parts as a sum; nothing is zero.
pub(super) fn sum(parts: Vec<Signed>) -> Expression {
    if parts.is_empty() {
        return Expression::Number(Number::new(&Rational::default()));
    }
    Expression::Sum(parts)
}

/// The monomials of a polynomial with their signs, in printing order.
pub(super) fn parts(polynomial: &Polynomial) -> Vec<Signed> {
    polynomial
        .terms()
        .map(|(monomial, value)| Signed {
            negative: value.is_negative(),
            value: product(factors(monomial, value)),
        })
        .collect()
}

/// A number, a bracket and symbols as one product with its sign.
pub(super) fn signed_product(value: &Rational, bracket: Option<Expression>, symbols: &Monomial) -> Signed {
    let written = match bracket {
        None => factors(symbols, value),
        Some(bracket) => {
            let mut written = written_factors(symbols, value);
            let after_number = usize::from(!value.abs().is_one());
            written.insert(after_number.min(written.len()), bracket);
            written
        }
    };
    Signed { negative: value.is_negative(), value: product(written) }
}

/// A product, with a letter as its last factor; the number 1 is dropped.
pub(super) fn times(value: Expression, letter: Letter) -> Expression {
    let mut found = match value {
        Expression::Product(factors) => factors,
        one if one == Expression::Number(Number::new(&Rational::one())) => Vec::new(),
        other => vec![other],
    };
    found.push(Expression::Letter(letter));
    product(found)
}

/// A letter with a plus sign.
pub(super) fn plus(letter: Letter) -> Signed {
    Signed { negative: false, value: Expression::Letter(letter) }
}

fn product(mut factors: Vec<Expression>) -> Expression {
    match factors.pop() {
        Some(only) if factors.is_empty() => only,
        last => Expression::Product(factors.into_iter().chain(last).collect()),
    }
}

/// The factors of a monomial; the number 1 stands alone or not at all.
fn factors(monomial: &Monomial, value: &Rational) -> Vec<Expression> {
    let factors = written_factors(monomial, value);
    if factors.is_empty() { vec![Expression::Number(Number::new(&Rational::one()))] } else { factors }
}

fn written_factors(monomial: &Monomial, value: &Rational) -> Vec<Expression> {
    let number = (!value.abs().is_one()).then(|| Expression::Number(Number::new(value)));
    number
        .into_iter()
        .chain(monomial.factors().iter().map(|(symbol, exponent)| power(symbol, *exponent)))
        .collect()
}

fn power(symbol: &Symbol, exponent: u32) -> Expression {
    let letter = Letter::named(symbol.name());
    let base = match symbol {
        Symbol::Cos(_) => Expression::Function(Function::Cos, letter),
        Symbol::Sin(_) => Expression::Function(Function::Sin, letter),
        Symbol::FixedCos(angle) => Expression::Fixed(Function::Cos, Angle::new(angle)),
        Symbol::FixedSin(angle) => Expression::Fixed(Function::Sin, Angle::new(angle)),
        _ => Expression::Letter(letter),
    };
    if exponent == 1 { base } else { Expression::Power(Box::new(base), exponent) }
}
