//! Lowering polynomials to steps. In: polynomials over inputs. Out: a program in which equal
//! subexpressions, and opposite ones, are computed once.
//!
//! A sum is written by Horner's rule in the symbol that most of its monomials share, sines and
//! cosines first: that finds the frames of a rotary axis again, so that the rotated components
//! of one vector are computed once and used in both directions.

use std::collections::BTreeMap;

use num_traits::One;

use super::{Input, Program, Step, Value};
use crate::algebra::{Monomial, Polynomial, Rational, Symbol, to_f64};

/// A value with the sign under which it stands for an expression.
#[derive(Clone, Copy)]
struct Signed {
    value: Value,
    negative: bool,
}

impl Signed {
    fn opposite(self) -> Self {
        Self { negative: !self.negative, ..self }
    }
}

/// Builds one program out of polynomials.
pub struct Builder<'r> {
    resolve: &'r dyn Fn(&Symbol) -> Option<Input>,
    program: Program,
    /// Values that stand for symbols of the caller's making.
    defined: BTreeMap<Symbol, Value>,
    /// Equal steps are one step.
    known_steps: BTreeMap<Step, usize>,
    /// Equal polynomials, and opposite ones, are one value.
    known_sums: Vec<(Polynomial, Signed)>,
}

impl<'r> Builder<'r> {
    /// Begins a program; `resolve` says which input a symbol is.
    pub fn new(resolve: &'r dyn Fn(&Symbol) -> Option<Input>) -> Self {
        Self {
            resolve,
            program: Program::default(),
            defined: BTreeMap::new(),
            known_steps: BTreeMap::new(),
            known_sums: Vec::new(),
        }
    }

    /// Lets a symbol stand for a polynomial in the results that follow.
    pub fn define(&mut self, symbol: Symbol, polynomial: &Polynomial) {
        let signed = self.sum(polynomial);
        let value = self.plain(signed);
        self.defined.insert(symbol, value);
    }

    /// Adds a result.
    pub fn result(&mut self, polynomial: &Polynomial) {
        let signed = self.sum(polynomial);
        let value = self.plain(signed);
        self.program.results.push(value);
    }

    /// The finished program.
    pub fn finish(self) -> Program {
        self.program
    }

    fn sum(&mut self, polynomial: &Polynomial) -> Signed {
        let known = |wanted: &Polynomial| {
            self.known_sums.iter().find(|(known, _)| known == wanted).map(|(_, signed)| *signed)
        };
        if let Some(signed) = known(polynomial) {
            return signed;
        }
        if let Some(signed) = known(&-polynomial) {
            return signed.opposite();
        }
        let signed = match shared_symbol(polynomial) {
            Some(symbol) => self.horner(polynomial, &symbol),
            None => self.spelled_out(polynomial),
        };
        self.known_sums.push((polynomial.clone(), signed));
        signed
    }

    /// `symbol * quotient + rest`.
    fn horner(&mut self, polynomial: &Polynomial, symbol: &Symbol) -> Signed {
        let rest = polynomial.part(|monomial| monomial.power_of(symbol) == 0);
        let quotient: Polynomial = polynomial
            .terms()
            .filter_map(|(monomial, value)| {
                monomial.without_one(symbol).map(|lowered| Polynomial::monomial(lowered, value.clone()))
            })
            .collect();
        let factor = self.symbol(symbol);
        let quotient = self.sum(&quotient);
        let product = Signed { value: self.product(factor, quotient.value), negative: quotient.negative };
        if rest.is_zero() {
            return product;
        }
        let rest = self.sum(&rest);
        self.add(rest, product)
    }

    fn spelled_out(&mut self, polynomial: &Polynomial) -> Signed {
        let mut total: Option<Signed> = None;
        for (monomial, coefficient) in polynomial.terms() {
            let term = self.term(monomial, coefficient);
            total = Some(match total {
                Some(sum) => self.add(sum, term),
                None => term,
            });
        }
        total.unwrap_or(Signed { value: Value::Zero, negative: false })
    }

    fn term(&mut self, monomial: &Monomial, coefficient: &Rational) -> Signed {
        let negative = coefficient < &Rational::from_integer(0.into());
        let size = if negative { -coefficient } else { coefficient.clone() };
        let fixed = |factor: &&(Symbol, u32)| factor.0.fixed_value().is_some();
        let mut product = match fixed_product(monomial) {
            Some(value) => Some(self.float(to_f64(&size) * value)),
            None => (!size.is_one() || monomial.is_one()).then(|| self.number(&size)),
        };
        for (symbol, power) in monomial.factors().iter().filter(|factor| !fixed(factor)) {
            let factor = self.symbol(symbol);
            for _ in 0..*power {
                product = Some(match product {
                    Some(product) => self.product(product, factor),
                    None => factor,
                });
            }
        }
        Signed { value: product.unwrap_or(Value::Zero), negative }
    }

    fn number(&mut self, value: &Rational) -> Value {
        self.float(to_f64(value))
    }

    fn float(&mut self, value: f64) -> Value {
        let numbers = &mut self.program.numbers;
        let known = numbers.iter().position(|known| known.to_bits() == value.to_bits());
        Value::Number(known.unwrap_or_else(|| {
            numbers.push(value);
            numbers.len() - 1
        }))
    }

    fn symbol(&mut self, symbol: &Symbol) -> Value {
        if let Some(value) = symbol.fixed_value() {
            return self.float(value);
        }
        let defined = self.defined.get(symbol).copied();
        let known = defined.or_else(|| (self.resolve)(symbol).map(Value::Input));
        // A symbol that nobody gives has no value, and must not look as if it had one.
        known.unwrap_or_else(|| self.float(f64::NAN))
    }

    fn product(&mut self, left: Value, right: Value) -> Value {
        let one = |value: Value| matches!(value, Value::Number(number) if self.program.numbers.get(number) == Some(&1.0));
        if one(left) {
            return right;
        }
        if one(right) {
            return left;
        }
        self.step(Step::Mul(left.min(right), left.max(right)))
    }

    fn add(&mut self, left: Signed, right: Signed) -> Signed {
        let (a, b) = (left.value, right.value);
        match (left.negative, right.negative) {
            (false, true) => self.difference(a, b),
            (true, false) => self.difference(b, a),
            (_, negative) => Signed { value: self.step(Step::Add(a, b)), negative },
        }
    }

    /// `a - b`, which is the opposite of `b - a` where that is known already.
    fn difference(&mut self, a: Value, b: Value) -> Signed {
        match self.known_steps.get(&Step::Sub(b, a)) {
            Some(step) => Signed { value: Value::Step(*step), negative: true },
            None => Signed { value: self.step(Step::Sub(a, b)), negative: false },
        }
    }

    fn plain(&mut self, signed: Signed) -> Value {
        match signed {
            Signed { value: Value::Number(number), negative: true } => {
                let value = self.program.numbers.get(number).copied().unwrap_or(f64::NAN);
                self.float(-value)
            }
            Signed { value, negative: true } => self.step(Step::Neg(value)),
            Signed { value, negative: false } => value,
        }
    }

    fn step(&mut self, step: Step) -> Value {
        let next = self.program.steps.len();
        let number = *self.known_steps.entry(step).or_insert(next);
        if number == next {
            self.program.steps.push(step);
        }
        Value::Step(number)
    }
}

/// The product of the symbols of a monomial that are numbers in themselves; none where it has no such symbol.
fn fixed_product(monomial: &Monomial) -> Option<f64> {
    let fixed = |(symbol, power): &(Symbol, u32)| {
        Some(symbol.fixed_value()?.powi(i32::try_from(*power).unwrap_or(i32::MAX)))
    };
    monomial.factors().iter().filter_map(fixed).reduce(|product, factor| product * factor)
}

/// The symbol to factor out: one that two monomials or more share; sines and cosines before
/// others, then the most frequent, then the first in order.
fn shared_symbol(polynomial: &Polynomial) -> Option<Symbol> {
    let mut counts: BTreeMap<Symbol, usize> = BTreeMap::new();
    for (monomial, _) in polynomial.terms() {
        for (symbol, _) in monomial.factors() {
            *counts.entry(symbol.clone()).or_default() += 1;
        }
    }
    let shared = counts.into_iter().filter(|(_, count)| *count >= 2);
    let turning = |symbol: &Symbol| matches!(symbol, Symbol::Cos(_) | Symbol::Sin(_));
    let best = shared.min_by_key(|(symbol, count)| (!turning(symbol), usize::MAX - count));
    best.map(|(symbol, _)| symbol)
}
