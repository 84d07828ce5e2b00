//! Curves without a model: the mean of a residual at places of one state, joined by straight lines.
//!
//! In: places and values, unit by unit. Out: the curve of all units but one, so that each unit is predicted by others. The normal
//! equations of hat functions are tridiagonal; those of a unit are subtracted from the sum, and nothing is fitted twice.

/// Where a value lies among nodes: the node below, and the share of the way to the next one.
pub(super) type Place = (usize, f64);

/// Sums of hat functions over rows.
#[derive(Clone)]
pub(super) struct Sums {
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    right: Vec<f64>,
}

/// Where nothing was seen, neighbours are joined: by this share of what a row weighs, which moves no node that was seen.
const JOINED: f64 = 1e-6;

impl Sums {
    pub(super) fn new(nodes: usize) -> Self {
        Self { diagonal: vec![0.0; nodes], beside: vec![0.0; nodes], right: vec![0.0; nodes] }
    }

    pub(super) fn add(&mut self, (node, share): Place, value: f64) {
        let rest = 1.0 - share;
        self.diagonal[node] += rest * rest;
        self.right[node] += rest * value;
        if share > 0.0 {
            self.diagonal[node + 1] += share * share;
            self.beside[node] += rest * share;
            self.right[node + 1] += share * value;
        }
    }

    pub(super) fn plus(&mut self, other: &Self, sign: f64) {
        let parts = [(&mut self.diagonal, &other.diagonal), (&mut self.beside, &other.beside)];
        for (own, other) in parts.into_iter().chain([(&mut self.right, &other.right)]) {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += sign * other);
        }
    }

    /// Whether rows lie near a node.
    pub(super) fn seen(&self, node: usize) -> bool {
        self.diagonal[node] > SEEN
    }

    /// The heights of the nodes, by least squares. `ends` are nodes behind which the next one is no neighbour.
    pub(super) fn solve(&self, ends: &[usize]) -> Vec<f64> {
        let nodes = self.diagonal.len();
        let mut diagonal = self.diagonal.clone();
        let mut beside = self.beside.clone();
        for node in (1..nodes).filter(|node| !ends.contains(&(node - 1))) {
            diagonal[node - 1] += JOINED;
            diagonal[node] += JOINED;
            beside[node - 1] -= JOINED;
        }
        let mut right = self.right.clone();
        for node in 1..nodes {
            if diagonal[node - 1] > 0.0 {
                let factor = beside[node - 1] / diagonal[node - 1];
                diagonal[node] -= factor * beside[node - 1];
                right[node] -= factor * right[node - 1];
            }
        }
        let mut heights = vec![0.0; nodes];
        for node in (0..nodes).rev() {
            let after = if node + 1 < nodes { beside[node] * heights[node + 1] } else { 0.0 };
            heights[node] = if diagonal[node] > 0.0 { (right[node] - after) / diagonal[node] } else { 0.0 };
        }
        heights
    }
}

/// A node has been seen where rows weigh more than a hundredth of one there.
const SEEN: f64 = 0.01;

/// The height of a curve at a place.
pub(super) fn at(heights: &[f64], (node, share): Place) -> f64 {
    if share > 0.0 { heights[node] + share * (heights[node + 1] - heights[node]) } else { heights[node] }
}
