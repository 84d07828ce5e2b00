//! Products of symbols. In: symbols with powers. Out: one canonical, ordered product.
//!
//! The order of monomials is the order in which sums are printed; the pure number is last.

use std::cmp::Ordering;

use super::Symbol;

/// A product of powers of symbols, in canonical order; the empty product is one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Monomial(Vec<(Symbol, u32)>);

impl Monomial {
    /// The empty product, one.
    pub fn one() -> Self {
        Self::default()
    }

    /// One symbol to a power; power 0 is one.
    pub fn power(symbol: Symbol, power: u32) -> Self {
        if power == 0 { Self::one() } else { Self(vec![(symbol, power)]) }
    }

    /// The factors in canonical order, each with its power, at least 1.
    pub fn factors(&self) -> &[(Symbol, u32)] {
        &self.0
    }

    /// Whether this is the empty product.
    pub fn is_one(&self) -> bool {
        self.0.is_empty()
    }

    /// The power of one symbol, 0 where it is absent.
    pub fn power_of(&self, symbol: &Symbol) -> u32 {
        self.0.iter().find(|(own, _)| own == symbol).map_or(0, |(_, power)| *power)
    }

    /// The product of two monomials.
    pub fn times(&self, other: &Self) -> Self {
        let mut factors = Vec::with_capacity(self.0.len() + other.0.len());
        let (mut left, mut right) = (self.0.iter().peekable(), other.0.iter().peekable());
        loop {
            let order = match (left.peek(), right.peek()) {
                (Some(a), Some(b)) => a.0.cmp(&b.0),
                (Some(_), None) => Ordering::Less,
                (None, Some(_)) => Ordering::Greater,
                (None, None) => return Self(factors),
            };
            let taken = match order {
                Ordering::Less => left.next().cloned(),
                Ordering::Greater => right.next().cloned(),
                Ordering::Equal => left
                    .next()
                    .zip(right.next())
                    .map(|((symbol, a), (_, b))| (symbol.clone(), a.saturating_add(*b))),
            };
            factors.extend(taken);
        }
    }

    /// The monomial with `symbol` lowered by one power; `None` where it is not a factor.
    pub fn without_one(&self, symbol: &Symbol) -> Option<Self> {
        let at = self.0.iter().position(|(own, _)| own == symbol)?;
        let mut factors = self.0.clone();
        match factors.get_mut(at) {
            Some((_, power)) if *power > 1 => *power -= 1,
            _ => drop(factors.remove(at)),
        }
        Some(Self(factors))
    }
}

impl Ord for Monomial {
    fn cmp(&self, other: &Self) -> Ordering {
        for ((a, a_power), (b, b_power)) in self.0.iter().zip(&other.0) {
            let order = a.cmp(b).then(b_power.cmp(a_power));
            if order != Ordering::Equal {
                return order;
            }
        }
        // A product comes before its own beginning, so that the number stands last.
        other.0.len().cmp(&self.0.len())
    }
}

impl PartialOrd for Monomial {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
