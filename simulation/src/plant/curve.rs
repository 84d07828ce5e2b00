//! Measured curves: piecewise linear, by direction, held constant outside.

use model_dsl::calibration::{Curve, CurveNodes, CurveValues};

use super::PlantError;

/// A curve with its nodes ascending.
#[derive(Clone, Debug)]
pub(super) struct PiecewiseLinear {
    nodes: Vec<f64>,
    forward: Vec<f64>,
    /// Empty where it is the same as forward.
    reverse: Vec<f64>,
    /// Whether it begins again after its last node.
    repeats: bool,
}

impl PiecewiseLinear {
    /// Takes a curve over; refuses one whose lists do not fit together or whose nodes are out of order.
    pub(super) fn of(curve: &Curve) -> Result<Self, PlantError> {
        let (mut forward, mut reverse) = match &curve.values {
            CurveValues::Both(values) => (values.clone(), Vec::new()),
            CurveValues::Directed { forward, reverse } => (forward.clone(), reverse.clone()),
        };
        let mut nodes: Vec<f64> = match &curve.nodes {
            CurveNodes::Uniform { start, step } => {
                (0_u32..).map(|number| start + step * f64::from(number)).take(forward.len()).collect()
            }
            CurveNodes::At(nodes) => nodes.clone(),
        };
        if nodes.first() > nodes.last() {
            nodes.reverse();
            forward.reverse();
            reverse.reverse();
        }
        let fits = !nodes.is_empty()
            && nodes.len() == forward.len()
            && (reverse.is_empty() || reverse.len() == nodes.len())
            && nodes.windows(2).all(|pair| pair.first() < pair.last());
        let repeats = curve.repeats;
        if fits { Ok(Self { nodes, forward, reverse, repeats }) } else { Err(PlantError::Table) }
    }

    /// The value at a position for a direction of motion.
    pub(super) fn value(&self, position: f64, direction: f64) -> f64 {
        let backwards = direction < 0.0 && !self.reverse.is_empty();
        let values = if backwards { &self.reverse } else { &self.forward };
        let position = self.within(position);
        let after = self.nodes.partition_point(|node| *node <= position);
        let at = |list: &[f64], index: usize| list.get(index).copied().unwrap_or(f64::NAN);
        if position.is_nan() {
            return f64::NAN;
        }
        if after == 0 || after == self.nodes.len() {
            return at(values, after.saturating_sub(1));
        }
        let (left, right) = (at(&self.nodes, after - 1), at(&self.nodes, after));
        let share = (position - left) / (right - left);
        at(values, after - 1) * (1.0 - share) + at(values, after) * share
    }

    /// A position without the whole turns of a curve that repeats.
    fn within(&self, position: f64) -> f64 {
        match (self.nodes.first(), self.nodes.last()) {
            (Some(first), Some(last)) if self.repeats => first + (position - first).rem_euclid(last - first),
            _ => position,
        }
    }
}
