//! Ridge: least squares held towards the present calibration.
//!
//! In: a problem. Out: the relative changes that minimise `|residual - J dA|^2 + strength |dA|^2`. Every coefficient is as
//! free as every other to change by a share of itself; what the points do not show stays. The strength is the one of least
//! generalised cross-validation, `rows |left|^2 / (rows - trace)^2`.

use crate::singular::{Decomposition, Scaling};
use crate::solution::{Problem, Solution, noise};

/// How many strengths are tried for each factor of ten.
const STEPS: i32 = 20;

/// The strengths that are tried, in factors of ten of the greatest squared singular value.
const DECADES: std::ops::RangeInclusive<i32> = -14..=3;

/// Solves a problem; nothing where its singular values cannot be computed.
pub(crate) fn solve(problem: &Problem) -> Option<Solution> {
    let decomposition = Decomposition::of(&problem.jacobian, Scaling::None, None)?;
    let singular: Vec<f64> = decomposition.counted().collect();
    let strength = strength(problem, &decomposition, &singular);
    let factors: Vec<f64> = singular.iter().map(|s| s / (s * s + strength)).collect();
    let weights: Vec<f64> = singular.iter().map(|s| s * s / (s * s + strength)).collect();
    let change = decomposition.combined(&problem.residual, &factors);
    let left = problem.left(&change);
    let noise = noise(left.norm_squared(), problem.free_rows() - weights.iter().sum::<f64>());
    // What a coefficient may still be when the points have spoken: all of what was expected where they do not see it.
    let unknown = decomposition.spread(&singular.iter().map(|_| 1.0).collect::<Vec<f64>>());
    let known: Vec<f64> = singular.iter().map(|s| (strength / (s * s + strength)).sqrt()).collect();
    let remaining = decomposition.spread(&known);
    let expected = noise.filter(|_| strength > 0.0).map(|noise| noise / strength.sqrt());
    let spread = remaining.iter().zip(&unknown).map(|(remaining, seen)| {
        expected.map(|expected| expected * (1.0 - seen * seen + remaining * remaining).max(0.0).sqrt())
    });
    let root =
        expected.map(|expected| decomposition.root(&all_of(known, problem.jacobian.ncols())) * expected);
    Some(Solution {
        root,
        moved: decomposition.seen().to_vec(),
        spread: spread.collect(),
        leverage: decomposition.leverage(&weights),
        noise,
        expected,
        alternatives: vec![Vec::new(); change.len()],
        change,
    })
}

/// The factors of all singular directions: what the points do not show is as free as it was expected to be.
fn all_of(mut known: Vec<f64>, count: usize) -> Vec<f64> {
    known.resize(count, 1.0);
    known
}

/// The strength of least generalised cross-validation.
fn strength(problem: &Problem, decomposition: &Decomposition, singular: &[f64]) -> f64 {
    let greatest = singular.first().copied().unwrap_or(1.0);
    let components = decomposition.components(&problem.residual);
    let explained: f64 = components.iter().map(|component| component * component).sum();
    let outside = (problem.residual.norm_squared() - explained).max(0.0);
    let rows = problem.free_rows();
    let score = |strength: f64| {
        let share = |s: &f64| strength / (s * s + strength);
        let left: f64 = singular.iter().zip(&components).map(|(s, g)| (share(s) * g).powi(2)).sum();
        let free = rows - singular.iter().map(|s| 1.0 - share(s)).sum::<f64>();
        if free > 1e-6 { (left + outside) / (free * free) } else { f64::INFINITY }
    };
    let steps = DECADES.start() * STEPS..=DECADES.end() * STEPS;
    let strengths = steps.map(|step| greatest * greatest * 10_f64.powf(f64::from(step) / f64::from(STEPS)));
    // From the strongest: of two that do alike, the one that changes less.
    let tried: Vec<(f64, f64)> = strengths.rev().map(|strength| (score(strength), strength)).collect();
    let best = tried
        .iter()
        .fold((f64::INFINITY, greatest * greatest), |best, one| if one.0 < best.0 { *one } else { best });
    best.1
}
