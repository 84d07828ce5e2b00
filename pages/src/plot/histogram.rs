//! Distributions. In: the edges of classes and the share of samples in each. Out: a plot of steps over one another.

use super::axis::Axis;
use super::cartesian::Cartesian;
use super::look::Look;
use super::series::{Draw, Series};

/// A distribution: `edges` in order, one more than `shares`, each of these a part of 1.
#[derive(Clone, Debug)]
pub struct Steps {
    /// Its name.
    pub name: String,
    /// Its colour and dash.
    pub look: Look,
    /// The ends of the classes.
    pub edges: Vec<f64>,
    /// The share of samples in each class.
    pub shares: Vec<f64>,
}

impl Steps {
    fn outline(&self) -> Vec<(f64, f64)> {
        let mut points = Vec::new();
        let percent = |share: f64| 100.0 * share;
        for (edges, share) in self.edges.windows(2).zip(&self.shares) {
            points.extend([(edges[0], percent(*share)), (edges[1], percent(*share))]);
        }
        if let (Some(first), Some(last)) = (points.first().copied(), points.last().copied()) {
            points.insert(0, (first.0, 0.0));
            points.push((last.0, 0.0));
        }
        points
    }
}

/// Distributions over one another, as steps.
pub fn histogram(title: &str, axis: Axis, distributions: &[Steps]) -> Cartesian {
    let shares = Axis::exactly("share of samples", "%").reaching(0.0);
    distributions.iter().fold(Cartesian::new(title, axis, shares), |plot, steps| {
        plot.series(Series::new(&steps.name, steps.look, Draw::Line, steps.outline()))
    })
}
