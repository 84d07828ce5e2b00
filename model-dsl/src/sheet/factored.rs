//! Polynomials with sines and cosines, factored. In: an expanded polynomial. Out: the same as sums of products of sums: the sines and
//! cosines of rotary axes are drawn out of what they multiply, so that lengths stand together again as in the frame that the axis turns.
//!
//! A polynomial without sines and cosines stays as it is: it is a sum of lengths already. Equal brackets come out equal, and opposite ones
//! too, since a bracket never begins with a minus sign; [`super::brackets`] names what occurs more than once.

use std::collections::{BTreeMap, BTreeSet};

use num_traits::One;

use crate::algebra::{Monomial, Polynomial, Rational, Symbol};

/// A sum of terms, in printing order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Sum(pub(super) Vec<Term>);

/// A number times symbols times a bracket.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Term {
    /// The number, with its sign.
    pub(super) value: Rational,
    /// The bracket, where there is one: two terms or more, the first of them not negative.
    pub(super) bracket: Option<Box<Sum>>,
    /// The symbols beside it.
    pub(super) symbols: Monomial,
}

/// A polynomial, sorted by its sines and cosines: what each product of them multiplies.
type Turned = BTreeMap<Monomial, Polynomial>;

impl Sum {
    /// Factors a polynomial. Both have the same value for all values of the symbols.
    pub(super) fn new(polynomial: &Polynomial) -> Self {
        Self(terms(polynomial))
    }

    /// The sum as a bracket that begins without a minus sign, and whether it is subtracted for that.
    pub(super) fn positive(self) -> (Self, bool) {
        let negative = self.0.first().is_some_and(|term| term.value < Rational::default());
        let terms = self.0.into_iter();
        let turned = |term: Term| Term { value: -term.value, ..term };
        if negative { (Self(terms.map(turned).collect()), true) } else { (Self(terms.collect()), false) }
    }

    /// Whether a sine or cosine stands in it.
    pub(super) fn turns(&self) -> bool {
        let inside = |term: &Term| term.bracket.as_deref().is_some_and(Self::turns);
        self.0.iter().any(|term| !turning(&term.symbols).is_one() || inside(term))
    }

    /// Every symbol in it.
    pub(super) fn symbols(&self) -> BTreeSet<Symbol> {
        let own = |term: &Term| -> Vec<Symbol> {
            let inside = term.bracket.iter().flat_map(|bracket| bracket.symbols());
            term.symbols.factors().iter().map(|(symbol, _)| symbol.clone()).chain(inside).collect()
        };
        self.0.iter().flat_map(own).collect()
    }

    /// How many symbols a reader meets.
    fn length(&self) -> usize {
        let own =
            |term: &Term| term.symbols.factors().len() + term.bracket.as_deref().map_or(0, Self::length);
        self.0.iter().map(own).sum()
    }
}

/// Whether any of these polynomials holds a sine or cosine.
pub(super) fn any_turns<'p>(mut polynomials: impl Iterator<Item = &'p Polynomial>) -> bool {
    polynomials.any(|polynomial| polynomial.terms().any(|(monomial, _)| !turning(monomial).is_one()))
}

/// The sines and cosines of a monomial.
fn turning(monomial: &Monomial) -> Monomial {
    split(monomial, true)
}

fn split(monomial: &Monomial, sines_and_cosines: bool) -> Monomial {
    let factors = monomial.factors().iter();
    let wanted = factors.filter(|(symbol, _)| is_turning(symbol) == sines_and_cosines);
    let powers = wanted.map(|(symbol, power)| Monomial::power(symbol.clone(), *power));
    powers.fold(Monomial::one(), |product, power| product.times(&power))
}

fn is_turning(symbol: &Symbol) -> bool {
    matches!(symbol, Symbol::Cos(_) | Symbol::Sin(_))
}

/// The terms, each where the first of its expanded monomials would stand.
fn terms(polynomial: &Polynomial) -> Vec<Term> {
    let mut turned = Turned::new();
    for (monomial, value) in polynomial.terms() {
        let part = turned.entry(turning(monomial)).or_default();
        *part += &Polynomial::monomial(split(monomial, false), value.clone());
    }
    let mut placed = placed_terms(&turned);
    placed.sort_by(|(left, _), (right, _)| left.cmp(right));
    placed.into_iter().map(|(_, term)| term).collect()
}

/// The terms of what is sorted by sines and cosines, with the first monomial of each. The one that most products share is drawn out of
/// these; of several the one that leaves the shortest text.
fn placed_terms(turned: &Turned) -> Vec<(Monomial, Term)> {
    let shared = shared_most(turned);
    let drawn = shared.iter().map(|symbol| drawn_out(turned, symbol));
    let length = |terms: &Vec<(Monomial, Term)>| -> usize {
        terms.iter().map(|(_, term)| Sum(vec![term.clone()]).length()).sum()
    };
    drawn
        .min_by_key(length)
        .unwrap_or_else(|| turned.iter().flat_map(|(front, part)| spelled(front, part)).collect())
}

/// `symbol * quotient + rest`.
fn drawn_out(turned: &Turned, symbol: &Symbol) -> Vec<(Monomial, Term)> {
    let (mut quotient, mut rest) = (Polynomial::zero(), Turned::new());
    for (front, part) in turned {
        match front.without_one(symbol) {
            Some(lowered) => quotient += &(part * &Polynomial::monomial(lowered, Rational::one())),
            None => drop(rest.insert(front.clone(), part.clone())),
        }
    }
    let mut found: Vec<_> = times(&Monomial::power(symbol.clone(), 1), &quotient).into_iter().collect();
    found.extend(placed_terms(&rest));
    found
}

/// What one product of sines and cosines multiplies; without any, each monomial by itself.
fn spelled(front: &Monomial, part: &Polynomial) -> Vec<(Monomial, Term)> {
    if front.is_one() {
        let plain = |(monomial, value): (&Monomial, &Rational)| {
            let term = Term { value: value.clone(), bracket: None, symbols: monomial.clone() };
            (monomial.clone(), term)
        };
        return part.terms().map(plain).collect();
    }
    times(front, part).into_iter().collect()
}

/// A product as one term, with the first monomial of the product.
fn times(front: &Monomial, part: &Polynomial) -> Option<(Monomial, Term)> {
    let first = part.terms().map(|(monomial, _)| monomial.times(front)).min()?;
    let mut inner = Sum::new(part);
    let term = if inner.0.len() == 1 {
        let only = inner.0.pop()?;
        Term { symbols: only.symbols.times(front), ..only }
    } else {
        let (bracket, negative) = inner.positive();
        let value = if negative { -Rational::one() } else { Rational::one() };
        Term { value, bracket: Some(Box::new(bracket)), symbols: front.clone() }
    };
    Some((first, term))
}

/// The sines and cosines that most products of them share, if two do.
fn shared_most(turned: &Turned) -> Vec<Symbol> {
    let mut counts: BTreeMap<&Symbol, usize> = BTreeMap::new();
    for (symbol, _) in turned.keys().flat_map(Monomial::factors) {
        *counts.entry(symbol).or_default() += 1;
    }
    let most = counts.values().copied().max().unwrap_or(0);
    let shared = counts.into_iter().filter(|(_, count)| *count == most && most > 1);
    shared.map(|(symbol, _)| symbol.clone()).collect()
}
