//! Multivariate polynomials with exact coefficients.
//!
//! In: symbols and fractions. Out: a canonical form, so that equality of expressions is
//! equality of values. The one relation among symbols, sin(q)^2 + cos(q)^2 = 1, is kept by
//! rewriting every squared sine as 1 - cos(q)^2 when a product is formed, and the squared cosine of
//! an angle that never changes as its value where that is a fraction.

use std::collections::BTreeMap;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use num_traits::{One, Zero};

use super::{Monomial, Rational, Symbol, to_f64};

/// A sum of monomials with non-zero exact coefficients, in canonical (printing) order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polynomial(BTreeMap<Monomial, Rational>);

impl Polynomial {
    /// The empty sum.
    pub fn zero() -> Self {
        Self::default()
    }

    /// The number one.
    pub fn one() -> Self {
        Self::number(Rational::one())
    }

    /// A pure number.
    pub fn number(value: Rational) -> Self {
        Self::monomial(Monomial::one(), value)
    }

    /// A whole number.
    pub fn integer(value: i64) -> Self {
        Self::number(Rational::from_integer(value.into()))
    }

    /// One symbol.
    pub fn symbol(symbol: Symbol) -> Self {
        Self::monomial(Monomial::power(symbol, 1), Rational::one())
    }

    /// One monomial with its coefficient.
    pub fn monomial(monomial: Monomial, coefficient: Rational) -> Self {
        let mut sum = Self::zero();
        sum.accumulate(monomial, coefficient);
        sum
    }

    /// The monomials with their coefficients, in printing order.
    pub fn terms(&self) -> impl ExactSizeIterator<Item = (&Monomial, &Rational)> {
        self.0.iter()
    }

    /// The number of monomials.
    pub fn size(&self) -> usize {
        self.0.len()
    }

    /// Whether this is the empty sum.
    pub fn is_zero(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether this is the number one.
    pub fn is_one(&self) -> bool {
        self.as_number().is_some_and(|value| value.is_one())
    }

    /// The value, where the polynomial is a pure number.
    pub fn as_number(&self) -> Option<Rational> {
        match self.0.first_key_value() {
            None => Some(Rational::zero()),
            Some((monomial, value)) if monomial.is_one() => Some(value.clone()),
            Some(_) => None,
        }
    }

    /// The value, where the polynomial is made of numbers, and of sines and cosines of angles that never change.
    pub fn as_fixed(&self) -> Option<f64> {
        let is_fixed = self.symbols().iter().all(|symbol| symbol.fixed_value().is_some());
        is_fixed.then(|| self.evaluate(|_| f64::NAN))
    }

    /// Every symbol that occurs, in canonical order, once.
    pub fn symbols(&self) -> std::collections::BTreeSet<Symbol> {
        let factors = self.0.keys().flat_map(Monomial::factors);
        factors.map(|(symbol, _)| symbol.clone()).collect()
    }

    /// The part whose monomials satisfy `keep`.
    pub fn part(&self, mut keep: impl FnMut(&Monomial) -> bool) -> Self {
        let kept = self.0.iter().filter(|(monomial, _)| keep(monomial));
        Self(kept.map(|(monomial, value)| (monomial.clone(), value.clone())).collect())
    }

    /// The derivative with respect to one symbol, taking sines and cosines as symbols of their own.
    pub fn derivative(&self, symbol: &Symbol) -> Self {
        let mut sum = Self::zero();
        for (monomial, value) in &self.0 {
            if let Some(rest) = monomial.without_one(symbol) {
                let power = Rational::from_integer(monomial.power_of(symbol).into());
                sum.accumulate(rest, value * power);
            }
        }
        sum
    }

    /// The value with every symbol replaced by a number; sines and cosines of angles that never change are numbers already.
    pub fn evaluate(&self, mut value_of: impl FnMut(&Symbol) -> f64) -> f64 {
        let mut sum = 0.0;
        for (monomial, coefficient) in &self.0 {
            let mut product = to_f64(coefficient);
            for (symbol, power) in monomial.factors() {
                let value = symbol.fixed_value().unwrap_or_else(|| value_of(symbol));
                product *= value.powi(i32::try_from(*power).unwrap_or(i32::MAX));
            }
            sum += product;
        }
        sum
    }

    /// Whether the leading coefficient (the first in printing order) is negative.
    pub fn leads_negative(&self) -> bool {
        self.0.first_key_value().is_some_and(|(_, value)| value < &Rational::zero())
    }

    fn accumulate(&mut self, monomial: Monomial, coefficient: Rational) {
        if coefficient.is_zero() {
            return;
        }
        if let Some((symbol, square)) = reducible(&monomial) {
            return self.accumulate_reduced(&monomial, &symbol, square, &coefficient);
        }
        let slot = self.0.entry(monomial.clone()).or_insert_with(Rational::zero);
        *slot += coefficient;
        if slot.is_zero() {
            self.0.remove(&monomial);
        }
    }

    /// Adds `monomial * coefficient` with one square of a symbol of it rewritten.
    fn accumulate_reduced(
        &mut self,
        monomial: &Monomial,
        symbol: &Symbol,
        square: Square,
        coefficient: &Rational,
    ) {
        let Some(rest) = monomial.without_one(symbol).and_then(|once| once.without_one(symbol)) else {
            return;
        };
        match square {
            Square::OneMinus(cosine) => {
                let cosine = Monomial::power(cosine, 2);
                self.accumulate(rest.times(&cosine), -coefficient.clone());
                self.accumulate(rest, coefficient.clone());
            }
            Square::Number(value) => self.accumulate(rest, coefficient * value),
        }
    }
}

/// What the square of a symbol is written as.
enum Square {
    /// That of a sine: one minus the square of this cosine.
    OneMinus(Symbol),
    /// A fraction.
    Number(Rational),
}

/// A symbol whose square is in a monomial, and is written in another way.
fn reducible(monomial: &Monomial) -> Option<(Symbol, Square)> {
    let squared = monomial.factors().iter().filter(|(_, power)| *power >= 2);
    squared.filter_map(|(symbol, _)| Some((symbol.clone(), square(symbol)?))).next()
}

fn square(symbol: &Symbol) -> Option<Square> {
    match symbol {
        Symbol::Sin(name) => Some(Square::OneMinus(Symbol::Cos(name.clone()))),
        Symbol::FixedSin(angle) => Some(Square::OneMinus(Symbol::FixedCos(angle.clone()))),
        Symbol::FixedCos(angle) => angle.squared_cosine().map(Square::Number),
        _ => None,
    }
}

impl AddAssign<&Polynomial> for Polynomial {
    fn add_assign(&mut self, other: &Self) {
        for (monomial, value) in &other.0 {
            self.accumulate(monomial.clone(), value.clone());
        }
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: Self) -> Polynomial {
        let mut sum = self.clone();
        sum += other;
        sum
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: Self) -> Polynomial {
        self + &-other
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        Polynomial(self.0.iter().map(|(monomial, value)| (monomial.clone(), -value)).collect())
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: Self) -> Polynomial {
        let mut product = Polynomial::zero();
        for (left, left_value) in &self.0 {
            for (right, right_value) in &other.0 {
                product.accumulate(left.times(right), left_value * right_value);
            }
        }
        product
    }
}

impl FromIterator<Polynomial> for Polynomial {
    /// The sum of polynomials.
    fn from_iter<I: IntoIterator<Item = Polynomial>>(parts: I) -> Self {
        parts.into_iter().fold(Polynomial::zero(), |mut sum, part| {
            sum += &part;
            sum
        })
    }
}
