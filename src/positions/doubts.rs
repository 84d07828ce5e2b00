//! What a reader of compensated positions must know beside them. In: what rows are answered. Out: how many of them have an error motion that
//! is not small, or a direction of the tool that stays wrong, in a sentence each. It exists because such rows have numbers like all others.

use std::collections::BTreeMap;

use abbe_runtime::math::length;
use model_dsl::calibration::{LARGEST_ANGLE, LARGEST_DISPLACEMENT};
use model_dsl::equations::Equations;
use workshop::rows::Answer;

/// The share of an error of the tool's direction that counts as corrected when it is all that is left.
const CORRECTED: f64 = 0.05;

/// The error of the tool's direction that nobody misses, rad: a fifth of a second of arc, 1 um at a metre.
const UNSEEN: f64 = 1e-6;

/// Rows that were counted, and the largest number among them.
#[derive(Default)]
struct Counted {
    rows: u64,
    largest: f64,
}

/// What was counted over some rows.
#[derive(Default)]
pub(crate) struct Doubts {
    /// Of error motions that are not small, by their number: mm or rad.
    large: BTreeMap<usize, Counted>,
    /// Of what stays of the direction of the tool where rotary axes correct it, rad.
    left: Counted,
}

impl Doubts {
    /// Takes the answer of a row that is compensated.
    pub(crate) fn take(&mut self, answer: &Answer<'_>) {
        if let Some((motion, value)) = answer.large {
            self.large.entry(motion).or_default().take(value.abs());
        }
        let Some(lean) = answer.lean.filter(|_| answer.aimed) else { return };
        let [without, with] = [lean.without, lean.with].map(length);
        if with > UNSEEN && with > CORRECTED * without {
            self.left.take(with);
        }
    }

    /// Takes what other rows come to.
    pub(crate) fn add(&mut self, other: &Self) {
        other.large.iter().for_each(|(motion, counted)| self.large.entry(*motion).or_default().add(counted));
        self.left.add(&other.left);
    }

    /// What is to be said, a sentence for each.
    pub(crate) fn told(&self, equations: &Equations) -> Vec<String> {
        let large = self.large.iter().filter_map(|(motion, counted)| {
            let motion = equations.motions.get(*motion)?;
            Some(counted.told_large(&motion.name, motion.angular))
        });
        let left = (self.left.rows > 0).then(|| self.left.told_left());
        large.chain(left).collect()
    }
}

impl Counted {
    fn take(&mut self, number: f64) {
        self.rows = self.rows.saturating_add(1);
        self.largest = self.largest.max(number);
    }

    fn add(&mut self, other: &Self) {
        self.rows = self.rows.saturating_add(other.rows);
        self.largest = self.largest.max(other.largest);
    }

    fn rows(&self) -> String {
        if self.rows == 1 { "in 1 row".to_owned() } else { format!("in {} rows", self.rows) }
    }

    fn told_large(&self, name: &str, angular: bool) -> String {
        let (unit, factor, most) =
            if angular { ("mrad", 1e3, LARGEST_ANGLE) } else { ("mm", 1.0, LARGEST_DISPLACEMENT) };
        let (rows, largest, most) = (self.rows(), self.largest * factor, most * factor);
        format!(
            "warning: {name} is up to {largest:.1} {unit} {rows}; the equations are of first order, for up to {most} {unit}: check the units of its terms"
        )
    }

    fn told_left(&self) -> String {
        let (rows, largest) = (self.rows(), self.largest.to_degrees() * 3600.0);
        format!(
            "warning: the rotary axes leave up to {largest:.1} arcsec of the error of the tool's direction {rows}: no axis turns the tool \
             that way there, or their limit is too low"
        )
    }
}
