//! Shapes: the terms of all regressors in some rows.
//!
//! In: regressors and the states of the machine. Out: the columns of each, before any lever arm. Regressors of different error
//! motions often have the same term: each different one is worked out once.

use super::Regressor;
use crate::parallel;
use crate::side::Side;
use crate::states::Rows;
use crate::terms::{Memory, Shape};

/// The terms of all regressors, each different one worked out once.
pub(super) struct Shapes {
    different: Vec<Different>,
    /// Of each regressor: the number of its shape, or of the two that its slope is taken from.
    of: Vec<Use>,
    slopes: Vec<Vec<Vec<f64>>>,
}

/// A term as it comes in on a side.
struct Different {
    shape: Shape,
    side: Side,
    memory: Memory,
    columns: Vec<Vec<f64>>,
}

enum Use {
    Shape(usize),
    /// How the position changes with the inertia of the axis's loop.
    Inertia {
        axis: usize,
        place: usize,
    },
    Slope {
        parts: Vec<Part>,
        place: usize,
    },
}

/// How a term with its coefficients changes with its nonlinear parameter.
enum Part {
    /// A wave changes by its phase, which its own two columns tell.
    Wave { number: usize, sine: f64, cosine: f64 },
    /// Any other term: the difference between two values of the parameter.
    Difference { low: usize, high: usize, step: f64, coefficients: Vec<f64> },
}

/// The relative step by which slopes are taken.
const SLOPE_STEP: f64 = 1e-4;

impl Shapes {
    /// Nothing worked out yet.
    pub(super) fn new(regressors: &[Regressor]) -> Self {
        let mut shapes = Self { different: Vec::new(), of: Vec::new(), slopes: Vec::new() };
        for regressor in regressors {
            let shape = &regressor.effect.shape;
            // What an instrument does comes in behind everything.
            let side = regressor.effect.side().unwrap_or(Side::After);
            let place = shapes.slopes.len();
            let usage = match &regressor.slope {
                Some(_) if let Shape::Lag { axis, .. } = *shape => Use::Inertia { axis, place },
                Some(terms) => {
                    let parts = terms
                        .iter()
                        .filter_map(|(shape, coefficients)| shapes.part(shape, side, coefficients));
                    Use::Slope { parts: parts.collect(), place }
                }
                None => Use::Shape(shapes.number(shape.clone(), side)),
            };
            if !matches!(usage, Use::Shape(_)) {
                shapes.slopes.push(vec![Vec::new()]);
            }
            shapes.of.push(usage);
        }
        shapes
    }

    fn part(&mut self, shape: &Shape, side: Side, coefficients: &[f64]) -> Option<Part> {
        if let (true, [sine, cosine]) = (shape.core().is_wave(), coefficients) {
            return Some(Part::Wave {
                number: self.number(shape.clone(), side),
                sine: *sine,
                cosine: *cosine,
            });
        }
        let value = shape.nonlinear()?.value;
        let step = value * SLOPE_STEP;
        let low = self.number(shape.with_nonlinear(value - step), side);
        let high = self.number(shape.with_nonlinear(value + step), side);
        Some(Part::Difference { low, high, step: 2.0 * step, coefficients: coefficients.to_vec() })
    }

    fn number(&mut self, shape: Shape, side: Side) -> usize {
        let same = |known: &Different| known.shape == shape && alike(&shape, known.side, side);
        if let Some(known) = self.different.iter().position(same) {
            return known;
        }
        let columns = vec![Vec::new(); shape.columns()];
        self.different.push(Different { shape, side, memory: Memory::default(), columns });
        self.different.len() - 1
    }

    /// Works out the next rows.
    pub(super) fn fill(&mut self, view: &Rows<'_>) {
        let work = view.len() * self.different.len();
        parallel::each(&mut self.different, work, |known| {
            known.shape.fill_on(known.side, view, &mut known.memory, &mut known.columns);
        });
        for usage in &self.of {
            match usage {
                Use::Shape(_) => {}
                Use::Inertia { axis, place } => self.slopes[*place][0] = view.axis(*axis).inertia_slope(),
                Use::Slope { parts, place } => self.slopes[*place][0] = slope(&self.different, parts, view),
            }
        }
    }

    /// The columns of a regressor in the rows that were filled last.
    pub(super) fn columns(&self, regressor: usize) -> &[Vec<f64>] {
        match &self.of[regressor] {
            Use::Shape(number) => &self.different[*number].columns,
            Use::Inertia { place, .. } | Use::Slope { place, .. } => &self.slopes[*place],
        }
    }
}

/// How the sum of some terms changes with the nonlinear parameter that they share, in each row.
fn slope(different: &[Different], parts: &[Part], view: &Rows<'_>) -> Vec<f64> {
    let mut slope = vec![0.0; view.len()];
    for part in parts {
        match part {
            Part::Wave { number, sine, cosine } => {
                let wave = &different[*number];
                let [sines, cosines] = wave.columns.as_slice() else { continue };
                let phases = wave.shape.phase_slope(view);
                for (row, (slope, phase)) in slope.iter_mut().zip(phases).enumerate() {
                    *slope += phase * (sine * cosines[row] - cosine * sines[row]);
                }
            }
            Part::Difference { low, high, step, coefficients } => {
                let columns = different[*low].columns.iter().zip(&different[*high].columns);
                for ((low, high), coefficient) in columns.zip(coefficients) {
                    for (row, slope) in slope.iter_mut().enumerate() {
                        *slope += (high[row] - low[row]) / step * coefficient;
                    }
                }
            }
        }
    }
    slope
}

/// Whether a term is the same on both sides.
fn alike(shape: &Shape, one: Side, other: Side) -> bool {
    let play = matches!(shape, Shape::Backlash { .. });
    one.answered_by() == other.answered_by() && (!play || one == other)
}
