//! The course of a recording: the states of all its rows under a model, and what the calibration says there.
//!
//! In: a scene and a model. Out: states as the instrument shows them and as the drives have them, the programmed positions,
//! and the error that the calibration knows already, so that a model's own terms are all that is left to work out.

use model_dsl::program::Column;

use crate::model::{Fitted, Model, Place};
use crate::position_loop::PositionLoop;
use crate::states::{Driven, Rows, States};
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
    /// What of each error motion the drive's own feedback shows; `None` where there is nothing.
    pub(crate) drive: Vec<Option<Vec<f64>>>,
}

impl Course {
    /// The course of a recording under a model.
    pub(crate) fn new(study: &Study<'_>, scene: usize, model: &[Fitted]) -> Self {
        let known = &study.scenes[scene];
        let driven: Vec<Driven> = if known.at_rest {
            vec![Driven::default(); study.equations.axes.len()]
        } else {
            let loops = loops(study, model).into_iter().enumerate();
            let zero = |axis: usize| feedback_zero(study, scene, model, axis);
            loops.map(|(axis, position_loop)| Driven { position_loop, zero: zero(axis) }).collect()
        };
        let clock = clock(scene, model);
        let states = |clock: f64| States::new(known.recording, &known.given, &driven, clock);
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
        let motions = study.equations.motions.len();
        let mut known = Self { tip: none(), turn: turning.then(none), drive: vec![None; motions] };
        let mut drives = Terms::of(study.known.iter().filter(answered));
        let mut terms = Terms::of(study.known.iter());
        let mut from = 0;
        while from < rows {
            let end = (from + STRETCH).min(rows);
            let view = states.rows(from..end);
            for (all, part) in known.drive.iter_mut().zip(drives.motions(&view, motions, true)) {
                if let Some(part) = part {
                    all.get_or_insert_with(|| Vec::with_capacity(rows)).extend(part);
                }
            }
            let motions = terms.motions(&view, motions, false);
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

/// Whether a term that is known acts inside a position loop. A lag is in the states.
fn answered(known: &&Fitted) -> bool {
    known.effect.side().is_some_and(|side| side.answered_by().is_some())
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

/// The position loop of each axis: lags and inertias of the calibration and of the model add.
fn loops(study: &Study<'_>, model: &[Fitted]) -> Vec<PositionLoop> {
    let mut loops = vec![PositionLoop::default(); study.equations.axes.len()];
    for fitted in study.known.iter().chain(model) {
        if let (Shape::Lag { axis, inertia }, [lag]) = (&fitted.effect.shape, fitted.coefficients.as_slice())
        {
            loops[*axis].time_constant += lag;
            loops[*axis].inertia += inertia;
        }
    }
    for one in &mut loops {
        one.time_constant = one.time_constant.max(0.0);
    }
    loops
}

/// The zero of the drive's own feedback of an axis in a recording.
fn feedback_zero(study: &Study<'_>, scene: usize, model: &[Fitted], axis: usize) -> f64 {
    let mut channels = study.scenes[scene].channels.iter();
    let Some(channel) = channels.position(|channel| channel.kind == Kind::Drive(axis)) else { return 0.0 };
    let zero = Some(Setting::Offset { channel });
    let zeros = model.iter().filter(|fitted| fitted.effect.setting_of(scene) == zero);
    zeros.filter_map(|fitted| fitted.coefficients.first()).sum()
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
                && (!drive || side.at_drive())
            {
                let sum = sums[motion].get_or_insert_with(|| vec![0.0; rows.len()]);
                fitted.effect.shape.add(&fitted.coefficients, side.answered_by(), rows, memory, sum);
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
