//! Measurements as instruments write them. In: the files of lasers, levels and straightedges, and a set-up that says what they
//! measured. Out: the error motions that they show, with their uncertainties, as a calibration.
//!
//! ```text
//! set-up (YAML) -> which motion, axis, sense, origin -.
//! file -> readings in its own counting ---------------+-> on the machine -> means over runs -> line, reversal -> table
//!                                                                                  '-> two lines -> squareness
//! ```
//!
//! An instrument's file does not say on which machine, at which place of the axis and in which sense it was written; the set-up
//! does, and what neither says is asked for, never guessed. Nothing is smoothed or resampled unless it is asked for, and lever arms
//! are taken off only where the set-up says where a reading was taken.
//!
//! | code | finding |
//! | --- | --- |
//! | E0901 | a required key is missing |
//! | E0902 | a format version that is not read, or another kind of file |
//! | E0903 | an unknown key |
//! | E0904 | a mapping, list or word is needed in place of what stands there |
//! | E0905 | an error motion that the machine lacks, or that no file shows |
//! | E0906 | an axis or constant that the machine lacks, or an axis that must be named |
//! | E0907 | a value that is not among those possible here |
//! | E0908, E0909 | a unit of the wrong kind; one that nothing tells, or that is told twice |
//! | E0910 | keys that exclude one another |
//! | E0911 | a motion that is given twice |
//! | E0912 | a reference or an edge that was not used as one |
//! | E0915 | a motion that no instrument shows by itself |
//! | E0916 | runs whose direction cannot be told |
//! | E0917 | too few readings for what is asked of them |
//! | E0918 | two set-ups of a reversal that do not belong together |
//! | E0921, E0922 | no file of an instrument; a dynamic measurement |
//! | E0923 | a section or an entry is missing |
//! | E0924 | counts that do not agree, or a row of units out of place |
//! | E0925, E0926 | not a finite number; a number out of its range |
//! | E0927, E0928 | a reading twice; two targets at one place |
//! | E0929 | a column is missing, stands twice, or is one of two that may be meant |
//! | W0901 | a run that was broken off |
//! | W0902 | a file that ends before its end |
//! | W0903 | runs of zeros that are left out |
//! | W0904 | a squareness with the zero of a rotation in it |
//! | W0905 | an edge of two targets, whose slope alone counts |
//!
//! E0430 is that of the calibration's reader: an error that is not small. E0913 and E0914 are those of who finds the machine and the files.

mod bound;
mod calibrate;
mod curve;
pub mod file;
mod lever;
mod line;
mod measured;
mod placed;
mod reduce;
pub mod report;
mod sense;
pub mod setup;
mod size;
mod squareness;
mod stations;
mod uncertainty;
mod view;

pub use bound::Bound;
pub(crate) use calibrate::even;
pub use calibrate::{Findings, MeasuredMotion, Outcome, calibrate};
pub use curve::{Curve, Mean};
pub use lever::Levers;
pub use line::Line;
pub use measured::{Flagged, Measured, Reading, Run, Sense};
pub use reduce::{Reduced, Reversal, Tabulated};
pub use setup::Setup;
pub use squareness::Squareness;
pub use stations::{Stations, stations};
pub use uncertainty::Uncertainty;

#[cfg(test)]
mod tests;
