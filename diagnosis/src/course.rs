//! The course of a recording: the states of all its rows under a model, and what the calibration says there.
//!
//! In: a scene and a model. Out: states as the instrument shows them and as the drives have them, the programmed positions,
//! and the error that the calibration knows already, so that a model's own terms are all that is left to work out.

use model_dsl::program::Column;

use crate::model::{Fitted, Model, Place, Side};
use crate::states::{Rows, States};
use crate::study::{Kind, Study};
use crate::terms::{Memory, Setting, Shape};

/// How many rows are worked on at a time.
pub(crate) const STRETCH: usize = 256;

/// The states of one recording under a model: those that the instrument shows, and those of the drives.
pub(crate) struct Course {
    /// Behind the loops, shifted by the instrument's clock.
    pub(crate) shown: States,
    /// Behind the loops, on the drives' own clock; only where it differs.
    pub(crate) drives: Option<States>,
    /// What the calibration says of the tip and of its rotation in every row.
    pub(crate) known: KnownError,
}

/// The error of the tip, and the rotation of the tool relative to the part, X, Y, Z each; the rotation only where a channel
/// shows it.
pub(crate) struct KnownError {
    pub(crate) tip: [Vec<f64>; 3],
    pub(crate) turn: Option<[Vec<f64>; 3]>,
}

impl Course {
    /// The course of a recording under a model.
    pub(crate) fn new(study: &Study<'_>, scene: usize, model: &[Fitted]) -> Self {
        let known = &study.scenes[scene];
        let lags = if known.at_rest { vec![0.0; study.equations.axes.len()] } else { lags(study, model) };
        let clock = clock(scene, model);
        let states = |clock: f64| States::new(known.recording, &known.given, &lags, clock);
        let shown = states(clock);
        let drives = (clock != 0.0).then(|| states(0.0));
        let known = KnownError::new(study, scene, &shown);
        Self { shown, drives, known }
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
    /// Adds up the calibration's terms. Its loops are in the states already.
    fn new(study: &Study<'_>, scene: usize, states: &States) -> Self {
        let channels = &study.scenes[scene].channels;
        let turning = channels.iter().any(|channel| matches!(channel.kind, Kind::Turn(_) | Kind::Stage(_)));
        let rows = states.given.time.len();
        let none = || [0, 1, 2].map(|_| Vec::with_capacity(rows));
        let mut known = Self { tip: none(), turn: turning.then(none) };
        let mut terms = Terms::of(study.known.iter());
        let mut from = 0;
        while from < rows {
            let end = (from + STRETCH).min(rows);
            let view = states.rows(from..end);
            let motions = terms.motions(&view, study.equations.motions.len(), false);
            let (positions, travels) = inputs(study, &view);
            append(
                &mut known.tip,
                &study.interpreter.lever_values(&positions, &travels),
                &motions,
                end - from,
            );
            if let Some(turn) = &mut known.turn {
                append(turn, &study.interpreter.turn_values(&positions, &travels), &motions, end - from);
            }
            from = end;
        }
        known
    }
}

/// Appends the sum of arms times motions in a stretch of rows.
fn append(sums: &mut [Vec<f64>; 3], arms: &[[Column<'_>; 3]], motions: &[Option<Vec<f64>>], rows: usize) {
    for (sum, part) in sums.iter_mut().zip(weighted_sum(arms, motions, rows)) {
        sum.extend(part);
    }
}

/// The positions of all axes in a stretch of rows, and the free travels, which are positions by default.
pub(crate) fn inputs<'s>(study: &Study<'_>, view: &Rows<'s>) -> (Vec<&'s [f64]>, Vec<&'s [f64]>) {
    let positions: Vec<&[f64]> =
        (0..study.equations.axes.len()).map(|axis| view.axis(axis).position).collect();
    let travels = study.equations.travels.iter().map(|travel| positions[travel.axis]).collect();
    (positions, travels)
}

/// The time constant of each axis's position loop: those of the calibration and of the model add.
fn lags(study: &Study<'_>, model: &[Fitted]) -> Vec<f64> {
    let mut lags = vec![0.0; study.equations.axes.len()];
    for fitted in study.known.iter().chain(model) {
        if let (Shape::Lag { axis }, [lag]) = (&fitted.effect.shape, fitted.coefficients.as_slice()) {
            lags[*axis] += lag;
        }
    }
    lags.iter().map(|lag| lag.max(0.0)).collect()
}

fn clock(scene: usize, model: &[Fitted]) -> f64 {
    let clocks = model.iter().filter(|fitted| fitted.effect.setting_of(scene) == Some(Setting::Clock));
    clocks.filter_map(|fitted| fitted.coefficients.first()).sum()
}

/// Terms whose memory runs through the rows of one recording, each term once.
pub(crate) struct Terms<'m> {
    fitted: Vec<(&'m Fitted, Memory)>,
}

impl<'m> Terms<'m> {
    /// All terms of the machine in a model, at the beginning of a recording.
    pub(crate) fn new(model: &'m Model) -> Self {
        Self::of(model.iter())
    }

    fn of(fitted: impl Iterator<Item = &'m Fitted>) -> Self {
        let machine = fitted.filter(|fitted| fitted.effect.motion().is_some());
        Self { fitted: machine.map(|fitted| (fitted, Memory::default())).collect() }
    }

    /// The value of every error motion in the next stretch of rows; on the drives' side alone where `drive` is set.
    pub(crate) fn motions(&mut self, rows: &Rows<'_>, motions: usize, drive: bool) -> Vec<Option<Vec<f64>>> {
        let mut sums: Vec<Option<Vec<f64>>> = vec![None; motions];
        for (fitted, memory) in &mut self.fitted {
            if let Place::Motion { motion, side } = fitted.effect.place
                && (!drive || side == Side::Drive)
            {
                let sum = sums[motion].get_or_insert_with(|| vec![0.0; rows.len()]);
                fitted.effect.shape.add(&fitted.coefficients, rows, memory, sum);
            }
        }
        sums
    }
}

/// The sum of arms times motions, in three directions.
pub(crate) fn weighted_sum(
    levers: &[[Column<'_>; 3]],
    motions: &[Option<Vec<f64>>],
    rows: usize,
) -> [Vec<f64>; 3] {
    let mut error = [vec![0.0; rows], vec![0.0; rows], vec![0.0; rows]];
    for (levers, motion) in levers.iter().zip(motions) {
        let Some(motion) = motion else { continue };
        for (error, lever) in error.iter_mut().zip(levers) {
            match lever {
                Column::Same(0.0) => {}
                Column::Same(lever) => {
                    error.iter_mut().zip(motion).for_each(|(error, motion)| *error += lever * motion)
                }
                Column::Rows(lever) => {
                    for ((error, lever), motion) in error.iter_mut().zip(lever.iter()).zip(motion) {
                        *error += lever * motion;
                    }
                }
            }
        }
    }
    error
}
