//! The update as a whole. In: inputs and options. Out: an [`Update`]: plain data for reports, and the calibration.

use model_dsl::calibration::Calibration;
use nalgebra::DVector;

use crate::coefficient::{Coefficient, Coefficients, coefficients, set};
use crate::datum::Freedom;
use crate::error::UpdateError;
use crate::nullspace::{Alike, relations};
use crate::points::{Machine, Point};
use crate::residuals::{Residual, residuals};
use crate::setup::{Rotation, Setup, rotations};
use crate::singular::{Decomposition, Scaling};
use crate::solution::{Problem, Solution};
use crate::{Inputs, Method, Options, ridge, select};

/// What was changed, and what that rests on. Lengths are in mm, angles in rad.
#[derive(Clone, Debug)]
pub struct Update {
    /// The machine's name.
    pub machine: String,
    /// What was asked.
    pub options: Options,
    /// The measured parts.
    pub parts: Vec<Part>,
    /// How many readings were fitted.
    pub points: usize,
    /// The directions in which the zero of every set-up was free.
    pub datum: Vec<&'static str>,
    /// How many zeros that are.
    pub zeros: usize,
    /// The fitted rotation of each part with a free datum. Rotations that the points do not show are left out.
    pub rotations: Vec<Rotation>,
    /// Hints, a sentence each: parts whose deviations a rotation explains, and whose recording has no `datum`.
    pub hints: Vec<String>,
    /// How many coefficients could be moved.
    pub unknowns: usize,
    /// The numerical rank of the scaled system.
    pub rank: usize,
    /// Singular values up to this count as zero.
    pub tolerance: f64,
    /// The singular values of the scaled system, in falling order.
    pub singular_values: Vec<f64>,
    /// The standard deviation of the noise, estimated from the residuals; `None` without degrees of freedom.
    pub noise: Option<f64>,
    /// The size that `ridge` expects of a relative change: its standard deviation.
    pub expected_change: Option<f64>,
    /// What is left at the fitted points, direction by direction.
    pub residuals: Vec<Residual>,
    /// What is left at the points of held-out runs, each with a zero of its own.
    pub held_out: Vec<Residual>,
    /// The root mean square of the leave-one-out residuals before and after the update; the zeros are fitted in both. `None` where a
    /// single reading determines a part of the model.
    pub leave_one_out: [Option<f64>; 2],
    /// The changes, the largest relative one first.
    pub changes: Vec<Change>,
    /// What the points do not show, or cannot tell apart.
    pub relations: Vec<Relation>,
    /// What was not moved.
    pub fixed: Vec<Fixed>,
    /// The calibration with the changes.
    pub calibration: Calibration,
}

/// One measured part, from one recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Its file.
    pub file: String,
    /// Its title.
    pub title: Option<String>,
    /// Readings that were fitted.
    pub points: usize,
    /// Readings of held-out runs.
    pub held_out: usize,
    /// Readings in rows that lack a position or a normal.
    pub left_out: usize,
    /// Axes of which it knows nothing: they are taken to stand at zero.
    pub standing: Vec<String>,
}

/// One changed coefficient.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// `EXX.polynomial[1]`: error motion, term, number; a sensor or another axis in brackets.
    pub name: String,
    /// The unit of its values.
    pub unit: String,
    /// As it was.
    pub before: f64,
    /// As it is.
    pub after: f64,
    /// The standard uncertainty of `after`, as far as the points show it; none where no reading is left to tell the
    /// noise.
    pub uncertainty: Option<f64>,
    /// The relative change dA of `A (1 + dA)`.
    pub change: f64,
    /// The largest displacement of a fitted point by this change, mm, with the zeros removed.
    pub effect: f64,
    /// Whether the points determine it alone: it has no part in any [`Relation`].
    pub determined: bool,
    /// Others that would do nearly as well in its place; `select` alone looks for them.
    pub alternatives: Vec<String>,
}

/// Coefficients that are collinear at the points, or one that no point shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Relation {
    /// The coefficient.
    pub name: String,
    /// Those that together make the same at every point; none where no point shows the coefficient at all.
    pub others: Vec<String>,
}

/// What was not moved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fixed {
    /// Its name.
    pub name: String,
    /// Why.
    pub reason: &'static str,
}

pub(crate) fn update(inputs: &Inputs<'_>, options: &Options) -> Result<Update, UpdateError> {
    let Coefficients { moving, fixed } = coefficients(inputs.calibration, &inputs.equations.names());
    if moving.is_empty() {
        return Err(UpdateError::NothingToMove);
    }
    let machine = Machine {
        equations: inputs.equations,
        calibration: inputs.calibration,
        coefficients: &moving,
        compensated: options.compensated,
    };
    let all = machine.points(&inputs.recordings)?;
    let (held_out, fitted): (Vec<&Point>, Vec<&Point>) = all.points.iter().partition(|point| point.held_out);
    if fitted.is_empty() {
        return Err(UpdateError::NoPoints);
    }
    let free = within_sensitive(inputs, options.datum);
    let freedom =
        Freedom { setups: &all.setups, directions: free, sensitive: within_sensitive(inputs, [true; 3]) };
    let problem = Problem::of(&fitted, &moving, freedom);
    let system = Decomposition::of(&problem.jacobian, Scaling::Greatest, options.tolerance)
        .ok_or(UpdateError::NoDecomposition)?;
    let solution = match options.method {
        Method::Svd => Some(system.solve(&problem)),
        Method::Ridge => ridge::solve(&problem),
        Method::Select => select::solve(&problem),
    };
    let finite = |solution: &Solution| solution.change.iter().all(|change| change.is_finite());
    let solution = solution.filter(finite).ok_or(UpdateError::NoDecomposition)?;
    let test = Problem::of(&held_out, &moving, freedom);
    let alike = relations(&system.null_space());
    let left = problem.left(&solution.change);
    let nothing = vec![0.0; problem.rows()];
    let rotations = rotations(&all, &fitted, &solution, freedom.sensitive);
    Ok(Update {
        machine: inputs.equations.machine.clone(),
        options: *options,
        points: fitted.len(),
        datum: ["X", "Y", "Z"]
            .into_iter()
            .zip(free)
            .filter(|(_, free)| *free)
            .map(|(name, _)| name)
            .collect(),
        zeros: problem.datum.freedoms().saturating_sub(rotations.len()),
        rotations,
        hints: hints(&all.parts, &all.setups),
        unknowns: moving.len(),
        rank: system.rank,
        tolerance: system.tolerance,
        singular_values: system.singular.clone(),
        noise: solution.noise,
        expected_change: solution.expected,
        residuals: residuals(&fitted, &problem.residual, &left),
        held_out: residuals(&held_out, &test.residual, &test.left(&solution.change)),
        leave_one_out: [
            problem.leave_one_out(&problem.residual, &nothing),
            problem.leave_one_out(&left, &solution.leverage),
        ],
        changes: changes(&moving, &problem, &solution, &alike),
        relations: alike.iter().map(|alike| relation(alike, &moving)).collect(),
        fixed,
        calibration: changed(inputs.calibration, &moving, &solution.change),
        parts: all.parts,
    })
}

/// Hints on parts whose deviations a rotation explains and whose recording has no `datum`, one for each recording.
fn hints(parts: &[Part], setups: &[Setup]) -> Vec<String> {
    let found = (0..parts.len()).filter_map(|number| {
        let mut own = setups.iter().filter(|setup| setup.recording == number);
        Some((parts.get(number)?.file.as_str(), own.find_map(|setup| setup.turned)?))
    });
    recording::clamped_anew(&found.collect::<Vec<_>>()).into_iter().collect()
}

/// Of the requested directions, those that the machine's equations contain.
fn within_sensitive(inputs: &Inputs<'_>, asked: [bool; 3]) -> [bool; 3] {
    let mut free = [false; 3];
    for row in &inputs.equations.rows {
        let direction = row.direction.index();
        if let (Some(slot), Some(asked)) = (free.get_mut(direction), asked.get(direction)) {
            *slot = *asked;
        }
    }
    free
}

fn changed(calibration: &Calibration, moving: &[Coefficient], change: &DVector<f64>) -> Calibration {
    let mut changed = calibration.clone();
    for (coefficient, change) in moving.iter().zip(change.iter()) {
        set(&mut changed, coefficient, coefficient.value * (1.0 + change));
    }
    changed
}

fn changes(moving: &[Coefficient], problem: &Problem, solution: &Solution, alike: &[Alike]) -> Vec<Change> {
    let name = |number: &usize| moving.get(*number).map(|coefficient| coefficient.name.clone());
    let shared =
        |number: usize| alike.iter().any(|one| one.coefficient == number || one.others.contains(&number));
    let one = |(number, coefficient): (usize, &Coefficient)| {
        let change = solution.change.get(number).copied().unwrap_or(0.0);
        let spread = solution.spread.get(number).copied().flatten();
        let alternatives = solution.alternatives.get(number).into_iter().flatten();
        Change {
            name: coefficient.name.clone(),
            unit: coefficient.unit.clone(),
            before: coefficient.value,
            after: coefficient.value * (1.0 + change),
            uncertainty: spread.map(|spread| spread * coefficient.value.abs()),
            change,
            effect: (problem.jacobian.column(number) * change).amax(),
            determined: !shared(number),
            alternatives: alternatives.filter_map(name).collect(),
        }
    };
    let moved = moving.iter().enumerate().filter(|(number, _)| solution.moved.get(*number) == Some(&true));
    let mut changes: Vec<Change> = moved.map(one).collect();
    changes.sort_by(|left, right| right.change.abs().total_cmp(&left.change.abs()));
    changes
}

fn relation(alike: &Alike, moving: &[Coefficient]) -> Relation {
    let name = |number: &usize| moving.get(*number).map_or(String::new(), |one| one.name.clone());
    Relation { name: name(&alike.coefficient), others: alike.others.iter().map(name).collect() }
}
