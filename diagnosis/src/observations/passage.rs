//! The passage of a model through a recording.
//!
//! In: a model and the states of the next rows. Out: the error motions there, which depend on what the terms remember of the rows
//! before. Frames of these rows need no memory any more, and are worked out in any order.

use std::ops::Range;

use crate::course::{Course, STRETCH, Terms, pieces};
use crate::model::Model;
use crate::study::Study;

/// A model on its way through a recording: its terms, with what they remember of the rows before.
pub(crate) struct Passage<'m> {
    terms: Terms<'m>,
    /// Once more, with memories on the drives' own clock, where a channel is a drive's own feedback.
    drive_terms: Option<Terms<'m>>,
}

/// The error motions of a model in some rows: all, and those on the drives' side; of these none where no channel shows them.
pub(crate) struct Moved {
    pub(super) rows: Range<usize>,
    pub(super) motions: Vec<Option<Vec<f64>>>,
    pub(super) drive_motions: Vec<Option<Vec<f64>>>,
}

impl<'m> Passage<'m> {
    /// A model at the beginning of a recording.
    pub(crate) fn new(study: &Study<'_>, scene: usize, model: &'m Model) -> Self {
        let drive_terms = study.scenes[scene].has_drives().then(|| Terms::new(model));
        Self { terms: Terms::new(model), drive_terms }
    }

    /// The error motions in the next rows.
    pub(crate) fn moved(&mut self, study: &Study<'_>, course: &Course, rows: Range<usize>) -> Moved {
        let count = study.equations.motions.len();
        let motions = self.terms.motions(&course.shown.rows(rows.clone()), count, false);
        let drive_rows = course.drives.as_ref().unwrap_or(&course.shown).rows(rows.clone());
        let drive_terms = self.drive_terms.as_mut();
        let drive_motions =
            drive_terms.map_or_else(|| vec![None; count], |terms| terms.motions(&drive_rows, count, true));
        Moved { rows, motions, drive_motions }
    }
}

impl Moved {
    /// The stretches of its rows.
    pub(crate) fn stretches(&self) -> Vec<Range<usize>> {
        pieces(self.rows.clone(), STRETCH).collect()
    }

    /// How much work a frame of all its rows is, in numbers.
    pub(crate) fn work(&self) -> usize {
        self.rows.len() * self.motions.len()
    }
}
