//! A measured curve: what the term `table` holds. In: nodes and values in mm and rad. Out: the same for the runtime.

use abbe_runtime::{Table, TableError, Values};

/// A measured curve over an axis.
#[derive(Clone, PartialEq, Debug)]
pub struct Curve {
    /// Where it was measured, in the axis's mm or rad.
    pub nodes: CurveNodes,
    /// What was measured there, mm or rad; one value a node.
    pub values: CurveValues,
    /// Whether it begins again after its last node, which then is the first one of the next turn; else its ends are held.
    pub repeats: bool,
}

/// The positions at which a curve was measured.
#[derive(Clone, PartialEq, Debug)]
pub enum CurveNodes {
    /// Equal steps; the step may be negative, but not zero.
    Uniform {
        /// The first node.
        start: f64,
        /// From one node to the next.
        step: f64,
    },
    /// Any positions, strictly ascending.
    At(Vec<f64>),
}

/// The values of a curve.
#[derive(Clone, PartialEq, Debug)]
pub enum CurveValues {
    /// The same in both directions of motion.
    Both(Vec<f64>),
    /// One curve for each direction of motion, of equal length.
    Directed {
        /// While the axis moves in its positive direction.
        forward: Vec<f64>,
        /// While it moves in its negative direction.
        reverse: Vec<f64>,
    },
}

impl Curve {
    /// A curve whose ends are held.
    pub fn new(nodes: CurveNodes, values: CurveValues) -> Self {
        Self { nodes, values, repeats: false }
    }

    /// After which way it repeats, mm or rad; nothing where its ends are held.
    pub fn period(&self) -> Option<f64> {
        let [first, last] = self.ends()?;
        self.repeats.then_some((last - first).abs())
    }

    /// Whether its first and its last node have one value, in both directions of motion.
    pub fn meets(&self) -> bool {
        let meets = |values: &[f64]| values.first() == values.last();
        match &self.values {
            CurveValues::Both(values) => meets(values),
            CurveValues::Directed { forward, reverse } => meets(forward) && meets(reverse),
        }
    }

    /// The curve as the runtime reads it.
    ///
    /// # Errors
    ///
    /// What the runtime refuses; a curve read from a file without findings has none of it.
    pub fn runtime(&self) -> Result<Table<'_>, TableError> {
        let values = match &self.values {
            CurveValues::Both(values) => Values::Both(values),
            CurveValues::Directed { forward, reverse } => Values::Directed { forward, reverse },
        };
        let table = match &self.nodes {
            CurveNodes::Uniform { start, step } => Table::uniform(*start, *step, values),
            CurveNodes::At(at) => Table::at(at, values),
        }?;
        if self.repeats { table.repeating() } else { Ok(table) }
    }

    /// The positions of its nodes, in the axis's mm or rad, in the order of the values.
    pub fn positions(&self) -> Vec<f64> {
        match &self.nodes {
            CurveNodes::At(places) => places.clone(),
            CurveNodes::Uniform { start, step } => {
                let numbers = std::iter::successors(Some(0.0), |number| Some(number + 1.0));
                numbers.take(self.values.forward().len()).map(|number| start + step * number).collect()
            }
        }
    }

    /// Its first and its last node; nothing where it has none.
    pub fn ends(&self) -> Option<[f64; 2]> {
        let positions = self.positions();
        Some([*positions.first()?, *positions.last()?])
    }
}

impl CurveValues {
    /// The values while the axis moves in its positive direction.
    pub fn forward(&self) -> &[f64] {
        match self {
            Self::Both(values) => values,
            Self::Directed { forward, .. } => forward,
        }
    }
}
