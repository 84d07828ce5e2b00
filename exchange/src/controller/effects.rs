//! A correction taken apart. In: a geometry and its workspace. Out: what each axis alone does to the command of each, and what
//! two axes do together, as the tables of controllers have it.
//!
//! With r the reference pose, the correction of an axis is `c(r) + sum over j of f_j(q_j) + sum over j < l of g_jl(q_j, q_l)`
//! and what more than two axes do together: `f_j(q_j) = c(r with q_j) - c(r)`, and g_jl what these leave. A lever arm times an
//! angle, Abbe's offset, is one product in g_jl: its singular values find it, and the angle and the arm apart.

use abbe_runtime::Direction;
use nalgebra::DMatrix;

use super::geometry::{Geometry, Pose};
use super::nodes::Nodes;
use super::refused::Refused;
use super::space::Space;

/// What is smaller needs no table of its own, and counts as lost: mm.
pub(super) const LEAST: f64 = 1e-5;

/// An angle counts as what it moves at this distance from its axis, in mm: few points of a machine are farther away.
const ARM: f64 = 1000.0;

/// What a source axis alone adds to the command of a target axis, zero at the reference pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Effect {
    /// The axis whose position and direction count.
    pub source: usize,
    /// The axis whose command changes.
    pub target: usize,
    /// What the correction of the target moves, mm for each mm or rad of it.
    pub arm: f64,
    /// Positions of the source, mm or rad.
    pub nodes: Vec<f64>,
    /// The correction where the source came in its positive direction, mm or rad.
    pub forward: Vec<f64>,
    /// The correction where it came in its negative direction, mm or rad.
    pub reverse: Vec<f64>,
}

impl Effect {
    /// The correction whatever the direction: the mean of both, mm or rad.
    pub fn mean(&self) -> Vec<f64> {
        self.forward
            .iter()
            .zip(&self.reverse)
            .map(|(forward, reverse)| f64::midpoint(*forward, *reverse))
            .collect()
    }

    /// The largest correction, mm.
    pub fn largest(&self) -> f64 {
        self.arm * largest(self.forward.iter().chain(&self.reverse))
    }

    /// Half the largest difference between the directions, mm.
    pub fn directed(&self) -> f64 {
        let both = self.forward.iter().zip(&self.reverse);
        let halves: Vec<f64> = both.map(|(forward, reverse)| 0.5 * (forward - reverse)).collect();
        self.arm * largest(halves.iter())
    }
}

/// A function of one axis over nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// The axis.
    pub source: usize,
    /// Its positions, mm or rad.
    pub nodes: Vec<f64>,
    /// The values.
    pub values: Vec<f64>,
}

/// What two axes together add to the command of a third or of one of them: the product of two functions, mm or rad.
///
/// Both functions are scaled to the same largest value.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// The axis whose command changes.
    pub target: usize,
    /// One function, and the other.
    pub factors: [Factor; 2],
    /// The largest product, mm.
    pub largest: f64,
}

/// The correction of a machine around its reference pose.
#[derive(Debug)]
pub struct Effects<'g, 'c> {
    geometry: &'g Geometry<'c>,
    space: &'g Space,
    /// The correction at the reference pose, mm or rad.
    pub base: Vec<f64>,
}

impl<'g, 'c> Effects<'g, 'c> {
    /// The correction around the reference pose of a space.
    ///
    /// # Errors
    /// Where the correction cannot be computed there.
    pub fn new(geometry: &'g Geometry<'c>, space: &'g Space) -> Result<Self, Refused> {
        let mut effects = Self { geometry, space, base: Vec::new() };
        effects.base = effects.mean(&[], None)?;
        Ok(effects)
    }

    /// What an axis alone does to the commands of all that correct, those of no effect too.
    ///
    /// # Errors
    /// Where the correction cannot be computed.
    pub fn of(&self, source: usize, nodes: &[f64]) -> Result<Vec<Effect>, Refused> {
        let along = |from: Direction| -> Result<Vec<Vec<f64>>, Refused> {
            let at = |place: &f64| self.mean(&[(source, *place)], Some((source, from)));
            nodes.iter().map(at).collect()
        };
        let (forward, reverse) = (along(Direction::Positive)?, along(Direction::Negative)?);
        let column = |rows: &[Vec<f64>], target: usize| -> Vec<f64> {
            let base = self.base.get(target).copied().unwrap_or_default();
            rows.iter().map(|row| row.get(target).map_or(f64::NAN, |value| value - base)).collect()
        };
        let effect = |target| Effect {
            source,
            target,
            arm: self.arm(target),
            nodes: nodes.to_vec(),
            forward: column(&forward, target),
            reverse: column(&reverse, target),
        };
        Ok(self.correcting().map(effect).collect())
    }

    /// Where the values of tables over an axis are to stand: closer where an effect bends between the calibration's own nodes.
    ///
    /// # Errors
    /// Where the correction cannot be computed.
    pub fn nodes(&self, source: usize) -> Result<Nodes, Refused> {
        let range = self.space.ranges.get(source).copied().unwrap_or_default();
        let nodes = Nodes::new(self.geometry.equations, self.geometry.calibration, source, range);
        let own = nodes.own();
        let between: Vec<f64> = own.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
        let (at, midway) = (self.of(source, own)?, self.of(source, &between)?);
        let bends = at.iter().zip(&midway).any(|(at, midway)| {
            let straight = at.forward.windows(2).map(|pair| f64::midpoint(pair[0], pair[1]));
            straight.zip(&midway.forward).any(|(straight, value)| at.arm * (straight - value).abs() > LEAST)
        });
        Ok(nodes.curved(bends))
    }

    /// What two axes do together to the commands of all that correct, as products, down to a least size in mm.
    ///
    /// # Errors
    /// Where the correction cannot be computed.
    pub fn together(
        &self,
        [first, second]: [usize; 2],
        nodes: [&[f64]; 2],
        least: f64,
    ) -> Result<Vec<Product>, Refused> {
        let alone = [self.of(first, nodes[0])?, self.of(second, nodes[1])?];
        let mut rows = Vec::with_capacity(nodes[0].len());
        for place in nodes[0] {
            let at = |other: &f64| self.mean(&[(first, *place), (second, *other)], None);
            rows.push(nodes[1].iter().map(at).collect::<Result<Vec<_>, _>>()?);
        }
        let mut products = Vec::new();
        for (of_first, of_second) in alone[0].iter().zip(&alone[1]) {
            let target = of_first.target;
            let (means, others) = (of_first.mean(), of_second.mean());
            let base = self.base.get(target).copied().unwrap_or_default();
            let left = DMatrix::from_fn(nodes[0].len(), nodes[1].len(), |row, column| {
                rows[row][column][target] - base - means[row] - others[column]
            });
            let arm = of_first.arm;
            products.extend(split(left, least / arm).into_iter().map(|(one, other, largest)| Product {
                target,
                factors: [
                    Factor { source: first, nodes: nodes[0].to_vec(), values: one },
                    Factor { source: second, nodes: nodes[1].to_vec(), values: other },
                ],
                largest: arm * largest,
            }));
        }
        Ok(products)
    }

    /// The numbers of the axes that correct.
    pub fn correcting(&self) -> impl Iterator<Item = usize> + use<'g, 'c> {
        let axes = self.geometry.equations.axes.iter().enumerate();
        axes.filter(|(_, axis)| axis.corrects()).map(|(number, _)| number)
    }

    /// What a correction of an axis moves, mm for each mm or rad of it.
    fn arm(&self, axis: usize) -> f64 {
        let rotary = self.geometry.equations.axes.get(axis).is_some_and(|axis| axis.rotary);
        if rotary { ARM } else { 1.0 }
    }

    /// The correction with some axes moved from the reference pose, the mean over the directions that are not given.
    fn mean(&self, moved: &[(usize, f64)], coming: Option<(usize, Direction)>) -> Result<Vec<f64>, Refused> {
        let at = |direction| {
            let pose =
                moved.iter().fold(self.space.reference_pose(direction), |pose: Pose, (axis, place)| {
                    pose.moved(*axis, *place)
                });
            let pose = coming.map_or_else(|| pose.clone(), |(axis, from)| pose.coming(axis, from));
            self.geometry.correction(&pose)
        };
        let (up, down) = (at(Direction::Positive)?, at(Direction::Negative)?);
        Ok(up.iter().zip(&down).map(|(up, down)| f64::midpoint(*up, *down)).collect())
    }
}

/// The products that add up to a matrix, the largest first, each with its largest entry.
fn split(matrix: DMatrix<f64>, least: f64) -> Vec<(Vec<f64>, Vec<f64>, f64)> {
    if !matrix.iter().all(|entry| entry.is_finite()) || largest(matrix.iter()) < least {
        return Vec::new();
    }
    let decomposed = matrix.svd(true, true);
    let (Some(left), Some(right)) = (decomposed.u, decomposed.v_t) else { return Vec::new() };
    let mut products = Vec::new();
    for (number, size) in decomposed.singular_values.iter().enumerate() {
        let one: Vec<f64> = left.column(number).iter().map(|value| value * size).collect();
        let other: Vec<f64> = right.row(number).iter().copied().collect();
        let (high, wide) = (largest(one.iter()), largest(other.iter()));
        if high * wide < least {
            break;
        }
        // Alike in size, so that neither table can move an axis far by itself.
        let scale = (wide / high).sqrt();
        let one = one.iter().map(|value| value * scale).collect();
        let other = other.iter().map(|value| value / scale).collect();
        products.push((one, other, high * wide));
    }
    products
}

fn largest<'v>(values: impl Iterator<Item = &'v f64>) -> f64 {
    values.fold(0.0, |largest: f64, value| largest.max(value.abs()))
}
