//! The course of a recording: the states of all its rows under a model, and what the calibration says there.
//!
//! In: a scene and a model. Out: states as the instrument shows them and as the drives have them, the programmed positions,
//! and the error that the calibration knows already, exactly, so that a model's own terms are all that is left to work out.

use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use model_dsl::exact::{Columns, Displaced};
use model_dsl::program::Column;

use crate::channel::Kind;
use crate::model::{Fitted, Model};
use crate::parallel;
use crate::position_loop::PositionLoop;
use crate::scene::Built;
use crate::states::{Driven, Rows, States};
use crate::study::Study;
use crate::terms::{Memory, Setting, Shape};

/// How many rows are worked on at a time: 2 KiB of each column, so that those of a dozen terms stay in a first-level cache.
pub(crate) const STRETCH: usize = 256;
/// How many rows are shared out among processors at a time: 16 stretches, so that each of 16 processors has one.
pub(crate) const BATCH: usize = 16 * STRETCH;

/// The states of one recording under a model: those that the instrument shows, and those of the drives.
pub(crate) struct Course {
    /// Behind the loops, shifted by the instrument's clock.
    pub(crate) shown: States,
    /// Behind the loops, on the drives' own clock; only where it differs and a drive's own feedback was recorded.
    pub(crate) drives: Option<States>,
    /// What the calibration says of the tip and of its rotation in every row.
    pub(crate) known: KnownError,
    /// The machine that was recorded.
    pub(crate) built: Arc<Built>,
}

/// The courses of all recordings of a study under a model.
pub(crate) fn courses(study: &Study<'_>, model: &Model) -> Vec<Arc<Course>> {
    (0..study.scenes.len()).map(|scene| Course::new(study, scene, model)).collect()
}

/// The error of the tip, and the rotation of the tool relative to the part, X, Y, Z each; the rotation only where a channel
/// shows it.
pub(crate) struct KnownError {
    pub(crate) tip: [Vec<f64>; 3],
    pub(crate) turn: Option<[Vec<f64>; 3]>,
    /// What of each error motion the drive's own feedback shows; `None` where there is nothing.
    pub(crate) drive: Vec<Option<Vec<f64>>>,
}

/// The last course of a recording. Most models do not change where the axes were: they share it, and the memory that it takes.
#[derive(Default)]
pub(crate) struct LastCourse(Mutex<Option<(Ways, Arc<Course>)>>);

/// What a model contributes to the course of a recording: how each axis is driven, and the offset of the instrument's clock, s.
#[derive(Clone, PartialEq)]
struct Ways {
    driven: Vec<Driven>,
    clock: f64,
}

impl Ways {
    fn new(study: &Study<'_>, scene: usize, model: &Model) -> Self {
        let loops = match study.scenes[scene].at_rest {
            true => vec![PositionLoop::default(); study.equations.axes.len()],
            false => loops(study, model),
        };
        // Only behind a loop does it matter where the feedback says that the axis begins.
        let zero = |axis: usize, position_loop: PositionLoop| match position_loop.acts() {
            true => feedback_zero(study, scene, model, axis),
            false => 0.0,
        };
        let driven = |(axis, position_loop): (usize, PositionLoop)| Driven {
            position_loop,
            zero: zero(axis, position_loop),
            crossing: model.crossing(axis),
            bends: model.bends(),
            underway: model.underway(),
        };
        let driven = loops.into_iter().enumerate().map(driven).collect();
        Self { driven, clock: model.setting(scene, Setting::Clock) }
    }
}

impl Course {
    /// The course of a recording under a model.
    pub(crate) fn new(study: &Study<'_>, scene: usize, model: &Model) -> Arc<Self> {
        let ways = Ways::new(study, scene, model);
        let last = &study.scenes[scene].last_course.0;
        // What a thread left that panicked is as good as any other course.
        let mut kept = last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, course)) = kept.as_ref().filter(|(before, _)| *before == ways) {
            return Arc::clone(course);
        }
        // The old course is freed first, so that two are never in memory.
        *kept = None;
        drop(kept);
        let course = Arc::new(Self::of(study, scene, &ways));
        let mut kept = last.lock().unwrap_or_else(PoisonError::into_inner);
        *kept = Some((ways, Arc::clone(&course)));
        course
    }

    fn of(study: &Study<'_>, scene: usize, ways: &Ways) -> Self {
        let recorded = &study.scenes[scene];
        let states = |clock: f64| States::new(recorded.recording, &recorded.given, &ways.driven, clock);
        let shown = states(ways.clock);
        let drives = (ways.clock != 0.0 && recorded.has_drives()).then(|| states(0.0));
        let known = KnownError::new(study, scene, &shown);
        let built = Arc::clone(&recorded.built);
        Self { shown, drives, known, built }
    }

    /// The states that a channel shows.
    pub(crate) fn states(&self, kind: Kind) -> &States {
        match (&self.drives, kind) {
            (Some(drives), Kind::Drive(_)) => drives,
            _ => &self.shown,
        }
    }
}

impl KnownError {
    /// Adds up the calibration's terms of each error motion, and computes what they do to the tool: one product of matrices with
    /// finite rotations per row. The calibration's position loops are not added here: the states contain them.
    fn new(study: &Study<'_>, scene: usize, states: &States) -> Self {
        let channels = &study.scenes[scene].channels;
        let turning = channels.iter().any(|channel| matches!(channel.kind, Kind::Turn(_) | Kind::Stage(_)));
        let rows = states.given.time.len();
        let none = || [0, 1, 2].map(|_| Vec::with_capacity(rows));
        let motions = study.equations.motions.len();
        let mut known = Self { tip: none(), turn: turning.then(none), drive: vec![None; motions] };
        let mut drives = Terms::of(study.known.iter().filter(answered));
        let mut terms = Terms::of(study.known.iter());
        for batch in pieces(0..rows, BATCH) {
            let view = states.rows(batch.clone());
            for (all, part) in known.drive.iter_mut().zip(drives.motions(&view, motions, true)) {
                if let Some(part) = part {
                    all.get_or_insert_with(|| Vec::with_capacity(rows)).extend(part);
                }
            }
            let motions = terms.motions(&view, motions, false);
            let stretches: Vec<Range<usize>> = pieces(batch.clone(), STRETCH).collect();
            let errors = parallel::counted(stretches.len(), batch.len() * motions.len(), |number| {
                let rows = stretches[number].clone();
                let motions = part(&motions, &(rows.start - batch.start..rows.end - batch.start));
                displaced(study, &study.scenes[scene].built, (&states.rows(rows), &motions), turning)
            });
            for part in errors {
                append(&mut known.tip, part.tip);
                if let (Some(all), Some(turn)) = (&mut known.turn, part.turn) {
                    append(all, turn);
                }
            }
        }
        known
    }
}

/// What known error motions do to the tool in a stretch of rows.
///
/// A motion can be unknown in a row: its sensor has no reading there. It counts as zero in the product of matrices. Directions in
/// which it acts to first order become NaN. The other directions stay known: it enters them only in products of two errors.
fn displaced(
    study: &Study<'_>,
    built: &Built,
    (view, motions): (&Rows<'_>, &[Option<&[f64]>]),
    turning: bool,
) -> Displaced {
    let (positions, travels) = inputs(study, view);
    let product = |motions: &[Option<&[f64]>]| {
        let columns = Columns { positions: &positions, travels: &travels, motions };
        built.exact.displaced(&columns, turning)
    };
    let unknown =
        |motion: &Option<&[f64]>| motion.is_some_and(|motion| motion.iter().any(|value| value.is_nan()));
    if !motions.iter().any(unknown) {
        return product(motions);
    }
    let known = mapped(motions, |value| if value.is_nan() { 0.0 } else { value });
    let gaps = mapped(motions, |value| 0.0 * value);
    let all = 0..view.len();
    let mut error = product(&part(&known, &all));
    let (interpreter, gaps) = (&built.interpreter, part(&gaps, &all));
    let seen = |of: &[[Column<'_>; 3]]| weighted_sum(of, &gaps, view.len());
    error.tip = plus(error.tip, &seen(&interpreter.lever_values(&positions, &travels)), &all);
    error.turn =
        error.turn.map(|turn| plus(turn, &seen(&interpreter.turn_values(&positions, &travels)), &all));
    error
}

/// Every motion with a function of each of its values.
fn mapped(motions: &[Option<&[f64]>], of: fn(f64) -> f64) -> Vec<Option<Vec<f64>>> {
    let column = |motion: &[f64]| motion.iter().map(|value| of(*value)).collect();
    motions.iter().map(|motion| motion.map(column)).collect()
}

/// Cuts rows into pieces of a size, the last of which may be shorter.
pub(crate) fn pieces(rows: Range<usize>, size: usize) -> impl Iterator<Item = Range<usize>> {
    rows.clone().step_by(size).map(move |from| from..(from + size).min(rows.end))
}

/// A stretch of the values of every error motion.
pub(crate) fn part<'m>(motions: &'m [Option<Vec<f64>>], rows: &Range<usize>) -> Vec<Option<&'m [f64]>> {
    motions.iter().map(|motion| motion.as_ref().map(|motion| &motion[rows.clone()])).collect()
}

/// Whether a known term enters inside a position loop, which answers it. A lag is none: the states contain it.
fn answered(known: &&Fitted) -> bool {
    known.effect.side().is_some_and(|side| side.answered_by().is_some())
}

fn append(sums: &mut [Vec<f64>; 3], parts: [Vec<f64>; 3]) {
    for (sum, part) in sums.iter_mut().zip(parts) {
        sum.extend(part);
    }
}

/// The position of every axis in a stretch of rows, and each travel of the equations, which is the position of its axis.
pub(crate) fn inputs<'s>(study: &Study<'_>, view: &Rows<'s>) -> (Vec<&'s [f64]>, Vec<&'s [f64]>) {
    let positions: Vec<&[f64]> =
        (0..study.equations.axes.len()).map(|axis| view.axis(axis).position).collect();
    let travels = study.equations.travels.iter().map(|travel| positions[travel.axis]).collect();
    (positions, travels)
}

/// The position loop of each axis: lags and inertias of the calibration and of the model add.
pub(crate) fn loops(study: &Study<'_>, model: &Model) -> Vec<PositionLoop> {
    let mut loops = vec![PositionLoop::default(); study.equations.axes.len()];
    for fitted in study.known.iter().chain(&model.effects) {
        if let (Shape::Lag { axis, inertia }, [lag]) = (&fitted.effect.shape, fitted.coefficients.as_slice())
        {
            loops[*axis].time_constant += lag;
            loops[*axis].inertia += inertia;
        }
    }
    loops
}

/// The zero of the drive's own feedback of an axis in a recording.
fn feedback_zero(study: &Study<'_>, scene: usize, model: &Model, axis: usize) -> f64 {
    let mut channels = study.scenes[scene].channels.iter();
    let channel = channels.position(|channel| channel.kind == Kind::Drive(axis));
    channel.map_or(0.0, |channel| model.setting(scene, Setting::Offset { channel }))
}

/// Terms whose memory runs through the rows of one recording, each term once: the error motions in which there are any, with
/// their terms.
pub(crate) struct Terms<'m> {
    motions: Vec<(usize, Vec<(&'m Fitted, Memory)>)>,
}

impl<'m> Terms<'m> {
    /// All terms of the machine in a model, at the beginning of a recording.
    pub(crate) fn new(model: &'m Model) -> Self {
        Self::of(model.effects.iter())
    }

    /// Some terms, at the beginning of a recording.
    pub(crate) fn of(fitted: impl Iterator<Item = &'m Fitted>) -> Self {
        let mut motions: Vec<(usize, Vec<(&Fitted, Memory)>)> = Vec::new();
        for fitted in fitted {
            let Some(motion) = fitted.effect.motion() else { continue };
            let term = (fitted, Memory::default());
            match motions.iter_mut().find(|(known, _)| *known == motion) {
                Some((_, terms)) => terms.push(term),
                None => motions.push((motion, vec![term])),
            }
        }
        Self { motions }
    }

    /// The value of every error motion in the next rows; on the drives' side alone where `drive` is set.
    pub(crate) fn motions(&mut self, rows: &Rows<'_>, motions: usize, drive: bool) -> Vec<Option<Vec<f64>>> {
        let work = rows.len() * self.motions.len();
        let parts =
            parallel::each(&mut self.motions, work, |(motion, terms)| (*motion, sum(terms, rows, drive)));
        let mut sums: Vec<Option<Vec<f64>>> = vec![None; motions];
        for (motion, part) in parts {
            sums[motion] = part;
        }
        sums
    }
}

/// The sum of terms of one error motion.
fn sum(terms: &mut [(&Fitted, Memory)], rows: &Rows<'_>, drive: bool) -> Option<Vec<f64>> {
    let mut sum: Option<Vec<f64>> = None;
    for (fitted, memory) in terms {
        if let Some(side) = fitted.effect.side().filter(|side| !drive || side.at_drive()) {
            let sum = sum.get_or_insert_with(|| vec![0.0; rows.len()]);
            fitted.effect.shape.add(&fitted.coefficients, side, rows, memory, sum);
        }
    }
    sum
}

/// The error in three directions: the sum, over all error motions, of lever arm times motion.
pub(crate) fn weighted_sum(
    levers: &[[Column<'_>; 3]],
    motions: &[Option<&[f64]>],
    rows: usize,
) -> [Vec<f64>; 3] {
    let mut error = [vec![0.0; rows], vec![0.0; rows], vec![0.0; rows]];
    for (levers, motion) in levers.iter().zip(motions) {
        let Some(motion) = motion else { continue };
        for (error, lever) in error.iter_mut().zip(levers) {
            match lever {
                Column::Same(0.0) => {}
                Column::Same(lever) => {
                    error.iter_mut().zip(*motion).for_each(|(error, motion)| *error += lever * motion)
                }
                Column::Rows(lever) => {
                    for ((error, lever), motion) in error.iter_mut().zip(lever.iter()).zip(*motion) {
                        *error += lever * motion;
                    }
                }
            }
        }
    }
    error
}

/// Sums in three directions, with what is known of these rows added to them.
pub(crate) fn plus(mut sums: [Vec<f64>; 3], known: &[Vec<f64>; 3], rows: &Range<usize>) -> [Vec<f64>; 3] {
    for (sum, known) in sums.iter_mut().zip(known) {
        sum.iter_mut().zip(&known[rows.clone()]).for_each(|(sum, known)| *sum += known);
    }
    sums
}
