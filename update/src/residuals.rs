//! Figures of residuals. In: what is left at points. Out: for each direction the greatest, the mean and the standard
//! deviation of its absolute values, as table 1 of NISTIR 6722 has them.

use nalgebra::DVector;

use crate::number;
use crate::points::Point;

/// What is left along the readings of one direction, before and after.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// `X`, `Y` or `Z`; `oblique` for all directions that are none of these, `all` for every reading.
    pub direction: &'static str,
    /// How many readings.
    pub points: usize,
    /// With the calibration as it was.
    pub before: Figures,
    /// With the updated one.
    pub after: Figures,
}

/// Figures of the absolute values of what is left, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// The greatest.
    pub max: f64,
    /// The mean.
    pub mean: f64,
    /// The standard deviation about the mean; 0 of a single reading.
    pub std: f64,
    /// The root mean square.
    pub rms: f64,
}

/// The sine of what a normal may be off a direction of the frame: a degree.
const OFF: f64 = 0.0175;

/// The figures of all directions that occur, and of all readings together.
pub(crate) fn residuals(points: &[&Point], before: &DVector<f64>, after: &DVector<f64>) -> Vec<Residual> {
    let names = ["X", "Y", "Z", "oblique", "all"];
    let rows = |name: &str| -> Vec<usize> {
        let rows = points.iter().enumerate();
        rows.filter(|(_, point)| name == "all" || direction(point) == name).map(|(row, _)| row).collect()
    };
    let one = |name: &'static str| {
        let rows = rows(name);
        let of = |left: &DVector<f64>| {
            figures(
                &rows.iter().filter_map(|row| left.get(*row)).map(|left| left.abs()).collect::<Vec<f64>>(),
            )
        };
        Residual { direction: name, points: rows.len(), before: of(before), after: of(after) }
    };
    names.into_iter().map(one).filter(|residual| residual.points > 0).collect()
}

fn direction(point: &Point) -> &'static str {
    let across = |part: usize| 1.0 - point.direction.get(part).map_or(0.0, |component| component * component);
    let names = ["X", "Y", "Z"].into_iter().enumerate();
    names.filter(|(part, _)| across(*part) < OFF * OFF).map(|(_, name)| name).next().unwrap_or("oblique")
}

fn figures(sizes: &[f64]) -> Figures {
    let count = number(sizes.len()).max(1.0);
    let mean = sizes.iter().sum::<f64>() / count;
    let spread: f64 = sizes.iter().map(|size| (size - mean).powi(2)).sum();
    Figures {
        max: sizes.iter().copied().fold(0.0, f64::max),
        mean,
        std: (spread / (count - 1.0).max(1.0)).sqrt(),
        rms: (sizes.iter().map(|size| size * size).sum::<f64>() / count).sqrt(),
    }
}
