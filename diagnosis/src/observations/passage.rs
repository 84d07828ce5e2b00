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
    drive_terms: Terms<'m>,
}

/// The error motions of a model in some rows: all, and those on the drives' side.
pub(crate) struct Moved {
    pub(super) rows: Range<usize>,
    pub(super) motions: Vec<Option<Vec<f64>>>,
    pub(super) drive_motions: Vec<Option<Vec<f64>>>,
}

impl<'m> Passage<'m> {
    /// A model at the beginning of a recording.
    pub(crate) fn new(model: &'m Model) -> Self {
        Self { terms: Terms::new(model), drive_terms: Terms::new(model) }
    }

    /// The error motions in the next rows.
    pub(crate) fn moved(&mut self, study: &Study<'_>, course: &Course, rows: Range<usize>) -> Moved {
        let count = study.equations.motions.len();
        let motions = self.terms.motions(&course.shown.rows(rows.clone()), count, false);
        let drive_rows = course.drives.as_ref().unwrap_or(&course.shown).rows(rows.clone());
        let drive_motions = self.drive_terms.motions(&drive_rows, count, true);
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
