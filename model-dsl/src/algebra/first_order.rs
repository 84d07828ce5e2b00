//! The first-order ring: an exact nominal part and one coefficient for each error motion.
//!
//! In: polynomials and error motions by number. Out: sums and products in which every product
//! of two errors is absent, because there is no place to write one.

use std::collections::BTreeMap;
use std::ops::{Add, Mul, Neg};

use super::Polynomial;

/// `nominal + sum of coefficient * error`, where errors multiply to nothing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FirstOrder {
    nominal: Polynomial,
    errors: BTreeMap<usize, Polynomial>,
}

impl FirstOrder {
    /// A quantity without error.
    pub fn nominal(nominal: Polynomial) -> Self {
        Self { nominal, errors: BTreeMap::new() }
    }

    /// One error motion, by its number, times a coefficient.
    pub fn error(motion: usize, coefficient: Polynomial) -> Self {
        let mut error = Self::default();
        error.insert(motion, coefficient);
        error
    }

    /// The part without errors.
    pub fn nominal_part(&self) -> &Polynomial {
        &self.nominal
    }

    /// The coefficient of each error motion, in order of its number; none is zero.
    pub fn error_part(&self) -> impl Iterator<Item = (usize, &Polynomial)> {
        self.errors.iter().map(|(motion, coefficient)| (*motion, coefficient))
    }

    fn insert(&mut self, motion: usize, coefficient: Polynomial) {
        if !coefficient.is_zero() {
            self.errors.insert(motion, coefficient);
        }
    }

    fn add_error(&mut self, motion: usize, coefficient: &Polynomial) {
        let sum = match self.errors.remove(&motion) {
            Some(present) => &present + coefficient,
            None => coefficient.clone(),
        };
        self.insert(motion, sum);
    }
}

impl Add for &FirstOrder {
    type Output = FirstOrder;
    fn add(self, other: Self) -> FirstOrder {
        let mut sum = self.clone();
        sum.nominal = &self.nominal + &other.nominal;
        for (motion, coefficient) in &other.errors {
            sum.add_error(*motion, coefficient);
        }
        sum
    }
}

impl Neg for &FirstOrder {
    type Output = FirstOrder;
    fn neg(self) -> FirstOrder {
        let errors = self.errors.iter().map(|(motion, coefficient)| (*motion, -coefficient));
        FirstOrder { nominal: -&self.nominal, errors: errors.collect() }
    }
}

impl Mul for &FirstOrder {
    type Output = FirstOrder;
    /// `(a + da)(b + db) = ab + (a db + b da)`: the product `da db` has no place to stand.
    fn mul(self, other: Self) -> FirstOrder {
        let mut product = FirstOrder::nominal(&self.nominal * &other.nominal);
        for (motion, coefficient) in &other.errors {
            product.add_error(*motion, &(&self.nominal * coefficient));
        }
        for (motion, coefficient) in &self.errors {
            product.add_error(*motion, &(&other.nominal * coefficient));
        }
        product
    }
}
