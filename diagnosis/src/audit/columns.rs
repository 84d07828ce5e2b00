//! Columns: how the prediction of every channel changes with a fault.
//!
//! In: a study, the files as they were read, and faults. Out: for each fault a column of every channel, in rows that are spread over
//! the recordings. Error motions act to first order here. That is enough to compare faults: what is told of one comes from a search with
//! the files changed.

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;
use model_dsl::program::{Column, Interpreter};

use super::changed::{self, Changed};
use super::fault::{Fault, Scope, TermAt};
use crate::Inputs;
use crate::course::{BATCH, Course, Terms, pieces, plus, weighted_sum};
use crate::model::{Fitted, Model};
use crate::observations::{self, Sight};
use crate::parallel;
use crate::scene::Scene;
use crate::study::{self, Study};

/// The most rows of a recording that are compared. A fault as large as the noise then stands 70 standard deviations out, the square
/// root of this number, and one of a tenth of it 7.
const ROWS: usize = 5000;

/// A fault with its columns: for each scene and channel a number for each row that is looked at.
pub(super) struct Suspected {
    pub(super) fault: Fault,
    pub(super) columns: Vec<Vec<Vec<f64>>>,
}

/// The faults of which something can be seen.
pub(super) struct Versions {
    /// For each scene the rows that are looked at.
    pub(super) rows: Vec<Vec<usize>>,
    pub(super) suspected: Vec<Suspected>,
}

impl Versions {
    /// Works out the columns of faults, beside what was found.
    pub(super) fn new(study: &Study<'_>, model: &Model, inputs: &Inputs<'_>, faults: Vec<Fault>) -> Self {
        let mut terms = Vec::new();
        let known =
            inputs.calibration.map(|known| Files::known(study, known, &mut terms)).unwrap_or_default();
        let files: Vec<Files> =
            faults.into_iter().filter_map(|fault| Files::without(study, inputs, fault, &mut terms)).collect();
        let rows: Vec<Vec<usize>> = study.scenes.iter().map(|scene| spread(scene.rows())).collect();
        let scenes = rows.iter().enumerate();
        let scenes: Vec<Seen> =
            scenes.map(|(scene, rows)| Seen::new(study, scene, model, rows, &terms)).collect();
        let base: Vec<Predicted> = scenes.iter().map(|seen| seen.predicted(study, &known)).collect();
        let columns = |number: usize| -> Vec<Vec<Vec<f64>>> {
            let each = scenes.iter().zip(&base);
            each.map(|(seen, base)| seen.columns(study, &files[number], base)).collect()
        };
        let work = files.len() * rows.iter().map(Vec::len).sum::<usize>();
        let columns = parallel::counted(files.len(), work, columns);
        let suspected = files.into_iter().zip(columns).filter_map(|(file, columns)| {
            let seen = columns.iter().flatten().flatten().any(|value| *value != 0.0);
            file.fault.filter(|_| seen).map(|fault| Suspected { fault, columns })
        });
        let suspected: Vec<Suspected> = suspected.collect();
        let lost: Vec<bool> = suspected.iter().map(|one| is_lost(one, &suspected)).collect();
        let kept = suspected.into_iter().zip(lost).filter(|(_, lost)| !lost);
        Self { suspected: kept.map(|(one, _)| one).collect(), rows }
    }
}

/// Whether numbers that are moved elsewhere are not seen there. The recordings then show only that they are missing, and not where they
/// belong.
fn is_lost(one: &Suspected, all: &[Suspected]) -> bool {
    let sizes: Vec<Scope> = match one.fault {
        Fault::Moved { from, .. } => {
            vec![Scope::Motion(from), Scope::Term(TermAt { motion: from, place: 0 })]
        }
        Fault::Axis { of, .. } => vec![Scope::Term(of)],
        _ => return false,
    };
    let size = |scope: &Scope| all.iter().find(|other| other.fault == Fault::Size(*scope));
    sizes.iter().find_map(size).is_some_and(|size| {
        let [moved, there] = [one, size].map(|suspected| suspected.columns.iter().flatten().flatten());
        let (left, whole) = moved.zip(there).fold((0.0, 0.0), |(left, whole), (moved, there)| {
            (left + (moved + there) * (moved + there), whole + there * there)
        });
        left < LOST * whole
    })
}

/// Numbers are not seen where their sum of squares is below this share of what it was: a thousandth of the size, squared, is far below
/// any noise.
const LOST: f64 = 1e-6;

/// Rows in equal steps, not more than are looked at.
pub(crate) fn spread(rows: usize) -> Vec<usize> {
    (0..rows).step_by(rows.div_ceil(ROWS).max(1)).collect()
}

/// Files, as far as a prediction needs them.
#[derive(Default)]
struct Files {
    /// The fault that is taken out; `None` for the files as they were read.
    fault: Option<Fault>,
    /// The amount of it that was changed.
    step: f64,
    /// The machine of each recording, if its equations or constants are changed.
    interpreters: Option<Vec<Interpreter>>,
    /// The number of its error motions, and the axes of its free travels.
    motions: usize,
    travels: Vec<usize>,
    /// Pairs of an error motion and the number of a term in it.
    terms: Vec<(usize, usize)>,
}

impl Files {
    /// The files as they were read.
    fn known(study: &Study<'_>, calibration: &Calibration, terms: &mut Vec<Fitted>) -> Self {
        let numbers = numbered(study, calibration, &study.own, terms);
        let (motions, travels) = shape(study.equations);
        Self { motions, travels, terms: numbers, ..Self::default() }
    }

    /// The files with one step of a fault taken out; `None` if the fault does not fit them.
    fn without(
        study: &Study<'_>,
        inputs: &Inputs<'_>,
        fault: Fault,
        terms: &mut Vec<Fitted>,
    ) -> Option<Self> {
        let step = step(inputs, &fault);
        let known = inputs.calibration?;
        let numbers = changed::calibration(known, inputs.equations, &fault, step);
        // The readings of an instrument change no prediction: the contest is told what they would be.
        let other = match fault {
            Fault::Order(_) => Some(Changed::new(inputs, &fault, step)?),
            _ => None,
        };
        let with = other.as_ref().map_or_else(|| inputs.clone(), |other| other.inputs(inputs));
        let calibration = numbers.as_ref().or(with.calibration)?;
        let other_arms = other.is_some() || matches!(fault, Fault::Constant(_));
        let own: Vec<Option<usize>> =
            (0..with.equations.axes.len()).map(|axis| with.equations.own_motion(axis)).collect();
        let (motions, travels) = shape(with.equations);
        Some(Self {
            step,
            interpreters: other_arms.then(|| {
                let of_scene = |scene: &Scene<'_>| {
                    Interpreter::new(with.equations, &scene.recording.constants(&calibration.constants))
                };
                study.scenes.iter().map(of_scene).collect()
            }),
            motions,
            travels,
            terms: numbered(study, calibration, &own, terms),
            fault: Some(fault),
        })
    }

    /// The same without any error motion.
    fn nominal(&self) -> Self {
        Self { motions: self.motions, travels: self.travels.clone(), ..Self::default() }
    }
}

/// The number of error motions, and the axes of the free travels.
fn shape(equations: &Equations) -> (usize, Vec<usize>) {
    (equations.motions.len(), equations.travels.iter().map(|travel| travel.axis).collect())
}

/// The step by which a fault is changed to see what the prediction does. It is 1, since the prediction is proportional to every amount
/// but that of a shift; a shift takes the step that its fault names.
fn step(inputs: &Inputs<'_>, fault: &Fault) -> f64 {
    let Fault::Shift { at, quarters } = fault else { return 1.0 };
    let table = inputs.calibration.and_then(|known| changed::table(known, *at));
    table.and_then(changed::node_step).map_or(1.0, |step| f64::from(*quarters) / 4.0 * step.abs())
}

/// The terms of a calibration, as pairs of a motion and the number of a term in `terms`. Terms that are not in that list yet are added.
fn numbered(
    study: &Study<'_>,
    calibration: &Calibration,
    own: &[Option<usize>],
    terms: &mut Vec<Fitted>,
) -> Vec<(usize, usize)> {
    let mut number = |fitted: Fitted| match terms.iter().position(|known| same(known, &fitted)) {
        Some(number) => number,
        None => {
            terms.push(fitted);
            terms.len() - 1
        }
    };
    let known = study::known(Some(calibration), &study.loads, own).into_iter();
    known.filter_map(|fitted| Some((fitted.effect.motion()?, number(fitted)))).collect()
}

/// Whether two terms have the same value in every row, in whatever error motion.
fn same(one: &Fitted, other: &Fitted) -> bool {
    one.effect.shape == other.effect.shape
        && one.effect.side() == other.effect.side()
        && one.coefficients == other.coefficients
}

/// What is seen of a recording in the rows that are looked at.
struct Seen {
    scene: usize,
    positions: Vec<Vec<f64>>,
    /// What every channel sees.
    sights: Vec<Sight>,
    /// The values of all terms.
    terms: Vec<Vec<f64>>,
}

/// The tip and the rotation that files predict.
struct Predicted {
    tip: [Vec<f64>; 3],
    turn: [Vec<f64>; 3],
}

impl Seen {
    fn new(study: &Study<'_>, scene: usize, model: &Model, rows: &[usize], terms: &[Fitted]) -> Self {
        let course = Course::new(study, scene, model);
        let channels = &study.scenes[scene].channels;
        let none = |_| Sight { turning: false, directions: Vec::with_capacity(rows.len()) };
        let mut sights: Vec<Sight> = channels.iter().map(none).collect();
        let looked_at = |stretch: &std::ops::Range<usize>| {
            let first = rows.partition_point(|row| *row < stretch.start);
            let end = rows.partition_point(|row| *row < stretch.end);
            rows[first..end].iter().map(|row| row - stretch.start).collect::<Vec<usize>>()
        };
        let sight = |frame: &observations::Frame<'_>| -> Vec<Sight> {
            channels.iter().map(|channel| frame.sight(study, scene, channel, model)).collect()
        };
        observations::each_frame(study, scene, model, &course, sight, |stretch, parts| {
            let chosen = looked_at(&stretch);
            for (sight, part) in sights.iter_mut().zip(parts) {
                sight.turning = part.turning;
                sight.directions.extend(chosen.iter().map(|row| part.directions[*row]));
            }
        });
        let mut positions = vec![Vec::with_capacity(rows.len()); study.equations.axes.len()];
        let mut values = vec![Vec::with_capacity(rows.len()); terms.len()];
        let mut passing: Vec<Terms<'_>> = terms.iter().map(|term| Terms::of(std::iter::once(term))).collect();
        let motions = study.equations.motions.len();
        for batch in pieces(0..study.scenes[scene].rows(), BATCH) {
            let view = course.shown.rows(batch.clone());
            let chosen = looked_at(&batch);
            for (axis, positions) in positions.iter_mut().enumerate() {
                positions.extend(chosen.iter().map(|row| view.axis(axis).position[*row]));
            }
            let value =
                |term: &mut Terms<'_>| term.motions(&view, motions, false).into_iter().flatten().next();
            let parts = parallel::each(&mut passing, terms.len() * batch.len(), value);
            for (values, part) in values.iter_mut().zip(parts) {
                let at = |row: &usize| part.as_ref().map_or(0.0, |part| part[*row]);
                values.extend(chosen.iter().map(at));
            }
        }
        Self { scene, positions, sights, terms: values }
    }

    /// What files predict.
    fn predicted(&self, study: &Study<'_>, files: &Files) -> Predicted {
        let positions: Vec<&[f64]> = self.positions.iter().map(Vec::as_slice).collect();
        let travels: Vec<&[f64]> = files.travels.iter().map(|axis| positions[*axis]).collect();
        let changed = files.interpreters.as_ref().and_then(|interpreters| interpreters.get(self.scene));
        let interpreter = changed.unwrap_or(&study.scenes[self.scene].built.interpreter);
        let rows = positions.first().map_or(0, |position| position.len());
        let mut motions: Vec<Option<Vec<f64>>> = vec![None; files.motions];
        for (motion, term) in &files.terms {
            let sum = motions[*motion].get_or_insert_with(|| vec![0.0; rows]);
            sum.iter_mut().zip(&self.terms[*term]).for_each(|(sum, value)| *sum += value);
        }
        let motions: Vec<Option<&[f64]>> = motions.iter().map(Option::as_deref).collect();
        let through = |levers: &[[Column<'_>; 3]]| weighted_sum(levers, &motions, rows);
        let error = through(&interpreter.lever_values(&positions, &travels));
        let turning = self.sights.iter().any(|sight| sight.turning);
        let turn = match turning {
            true => through(&interpreter.turn_values(&positions, &travels)),
            false => [Vec::new(), Vec::new(), Vec::new()],
        };
        Predicted { tip: plus(error, &interpreter.nominal_columns(&positions), &(0..rows)), turn }
    }

    /// How the prediction of every channel changes for each unit of the fault.
    fn columns(&self, study: &Study<'_>, files: &Files, base: &Predicted) -> Vec<Vec<f64>> {
        let (from, to) = match files.fault {
            // All that is predicted beside the nominal path, in one recording.
            Some(Fault::Scale { recording }) if recording == self.scene => {
                (&self.predicted(study, &files.nominal()), base)
            }
            Some(Fault::Scale { .. }) => (base, base),
            _ => (base, &self.predicted(study, files)),
        };
        self.sights.iter().map(|sight| change(sight, from, to, files.step)).collect()
    }
}

/// The change that a channel sees, per unit of the fault; 0 where it is not known. A change that is the same in every row is taken out: it
/// is a zero of the instrument, or its centre.
fn change(sight: &Sight, from: &Predicted, to: &Predicted, step: f64) -> Vec<f64> {
    let (from, to) = if sight.turning { (&from.turn, &to.turn) } else { (&from.tip, &to.tip) };
    let changes = |d: usize| to[d].iter().zip(&from[d]).map(|(to, from)| to - from);
    let same = [0, 1, 2].map(|d| changes(d).find(|change| change.is_finite()).unwrap_or_default());
    let rows = sight.directions.iter().enumerate();
    rows.map(|(row, direction)| {
        let along = |d: usize| direction[d] * (to[d][row] - from[d][row] - same[d]);
        (along(0) + along(1) + along(2)) / step
    })
    .map(|value| if value.is_finite() { value } else { 0.0 })
    .collect()
}
