//! The cross compensation as tables. In: what an axis does to another, or two axes to one. Out: one or two tables for each.

use super::super::effects::{Effect, Factor, LEAST, Product};

/// One or two tables that belong together.
pub(super) enum Piece {
    /// What an axis does, the same from both sides.
    Both(Effect),
    /// What an axis does, one table for each direction.
    Directed(Effect),
    /// What two axes do together.
    Product(Product),
}

impl Piece {
    /// How many tables it takes.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Both(_) => 1,
            Self::Directed(_) | Self::Product(_) => 2,
        }
    }

    /// The largest correction, mm; of a rotary axis as far from it as counts.
    pub(super) fn size(&self) -> f64 {
        match self {
            Self::Both(effect) | Self::Directed(effect) => effect.largest(),
            Self::Product(product) => product.largest,
        }
    }

    /// What an axis does to another.
    pub(super) fn of(effect: Effect) -> Self {
        if effect.directed() < LEAST { Self::Both(effect) } else { Self::Directed(effect) }
    }

    /// What the leadscrew table, which knows no direction, leaves of an axis's own effect.
    pub(super) fn own_rest(effect: Effect) -> Option<Self> {
        let mean = effect.mean();
        let less = |values: Vec<f64>| values.iter().zip(&mean).map(|(value, mean)| value - mean).collect();
        let rest = Effect { forward: less(effect.forward), reverse: less(effect.reverse), ..effect };
        (rest.largest() >= LEAST).then_some(Self::Directed(rest))
    }

    /// Its tables from an index on, the values of what moves an axis multiplied by `sign`.
    pub(super) fn tables(&self, index: usize, sign: f64) -> Vec<Table<'_>> {
        let signed = |values: &[f64]| values.iter().map(|value| sign * value).collect();
        match self {
            Self::Both(effect) => vec![Table::of(effect, signed(&effect.mean()), 0)],
            Self::Directed(effect) => {
                vec![
                    Table::of(effect, signed(&effect.forward), 1),
                    Table::of(effect, signed(&effect.reverse), -1),
                ]
            }
            Self::Product(Product { target, factors: [one, other], .. }) => {
                let table = |factor, values, by| {
                    let Factor { source, nodes, .. }: &Factor = factor;
                    Table {
                        input: *source,
                        output: *target,
                        nodes,
                        values,
                        direction: 0,
                        by,
                        is_factor: by == 0,
                    }
                };
                // The number of a table is its index and one.
                vec![table(one, signed(&one.values), index + 2), table(other, other.values.clone(), 0)]
            }
        }
    }
}

/// A table of the archive.
pub(super) struct Table<'p> {
    /// The axis whose setpoint is read.
    pub(super) input: usize,
    /// The axis that is moved.
    pub(super) output: usize,
    /// Positions of the input, mm or rad.
    pub(super) nodes: &'p [f64],
    /// The values.
    pub(super) values: Vec<f64>,
    /// 1 or -1: in one direction of the input alone; 0: in both.
    pub(super) direction: i8,
    /// The number of the table that it is multiplied by; 0: none.
    pub(super) by: usize,
    /// Whether it is only what another table is multiplied by.
    pub(super) is_factor: bool,
}

impl<'p> Table<'p> {
    fn of(effect: &'p Effect, values: Vec<f64>, direction: i8) -> Self {
        let (input, output, nodes) = (effect.source, effect.target, &effect.nodes);
        Self { input, output, nodes, values, direction, by: 0, is_factor: false }
    }
}
