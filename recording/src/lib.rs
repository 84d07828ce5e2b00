//! Recordings: what was measured on a real machine.
//!
//! In: a recording file and its table of data. Out: columns in mm, rad, s and degC, each with its meaning for the machine.
//! A missing sample is NaN; no row is dropped.
//!
//! Reading goes in three steps, because the file itself names the machine and the data: [`machine_of`] reads the
//! machine's name alone, the caller finds the machine; [`read_header`] reads the rest of the file against its equations;
//! and [`Header::read_data`] reads the data.
//!
//! ```text
//! file -> header: machine, calibration, instrument (setup, suited), channels (channel, place) -> data: text, Parquet or a worksheet (form)
//!      -> columns -> position, runs: the same for whoever asks; lie: how a part lay where it was measured
//! ```
//!
//! Whoever takes a recording asks it where an axis is ([`AxisChannels::position`]) and which rows belong together
//! ([`Recording::runs`]), so that all of Abbe has one answer.
//!
//! | code | finding |
//! | --- | --- |
//! | E0601 | a required key or channel is missing |
//! | E0602 | a format version that is not read, or another kind of file |
//! | E0603 | an unknown key |
//! | E0604 | a mapping, list or word is needed in place of what stands there |
//! | E0605 | an unknown instrument |
//! | E0606 | an unknown channel |
//! | E0607 | an axis that the machine lacks |
//! | E0608 | a direction in which the machine is not sensitive |
//! | E0609, E0610, E0611 | a unit of the wrong kind; no unit; a unit where none belongs |
//! | E0612 | a channel that the instrument does not take |
//! | E0613 | no channel that measures anything, no `deviation`, or no programmed position |
//! | E0614 | a probe without normals, or without all of them |
//! | E0615, E0616 | a key of the set-up is missing; one that the instrument does not take |
//! | E0617 | not a direction |
//! | E0618 | a set-up that contradicts itself |
//! | E0619, E0620 | held-out runs without a channel `run`; a run that is no whole number or not in the data, or no run at all |
//! | E0621 | a radius that is not greater than zero |
//! | E0628 | a constant that the machine lacks |
//! | E0629 | places of channels that do not go together |
//! | E0630 | a way to write tables that is not known, or not that of the table |
//! | E0631 | a date that is none |
//! | W0601 | a column that stands for two things |
//!
//! Units have the codes of [`model_dsl::quantity`] besides. E0622 to E0625 are those of who finds the machine, the
//! calibration and several recordings. What is wrong in the data is a [`DataError`].

pub mod cells;
mod channel;
mod data;
mod date;
mod direction;
mod form;
mod header;
mod place;
mod pose;
mod position;
mod runs;
mod setup;
mod suited;
mod words;

use model_dsl::calibration::Calibration;

pub use channel::{Channel, ChannelKind, ChannelPlace};
pub use data::{ColumnNames, DataError, Place, column_names, foreign, is_date};
pub use date::{Moment, date_of};
pub use direction::own_direction;
pub use form::{Form, Names, Separator};
pub use header::{Extra, Header, calibration_of, machine_of, read_header};
pub use pose::{PartDatum, PartPose, PartReading, Turned, clamped_anew, taken_as_free, turned};

/// One recording, in mm, rad, s, degC and the units of its loads. All columns have one entry a row.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// The recording file's name for people.
    pub file: String,
    /// Its title.
    pub title: Option<String>,
    /// When it was made.
    pub date: Option<Moment>,
    /// What measured, and how it was set up.
    pub instrument: Instrument,
    /// What is said of how the part lies where it was measured.
    pub datum: PartDatum,
    /// Time since the first row, s; strictly increasing.
    pub time: Vec<f64>,
    /// The repeat that each row belongs to; 1 everywhere where the recording does not tell.
    pub run: Vec<i64>,
    /// What is known of each axis, in the order of the machine's axes.
    pub axes: Vec<AxisChannels>,
    /// The tool tip relative to the part, part frame, tool offset included, X, Y, Z: mm.
    pub measured: [Option<Vec<f64>>; 3],
    /// `deviation`: radius minus nominal of a ballbar, reading of the other instruments: mm, or rad of an angular one.
    pub deviation: Option<Vec<f64>>,
    /// The direction of each reading of a probe, part frame: unit vectors.
    pub normal: Option<[Vec<f64>; 3]>,
    /// Temperatures, degC.
    pub temperatures: Vec<Named>,
    /// Loads.
    pub loads: Vec<Named>,
    /// Constants of the machine that had other values than the calibration says, mm, each with its number: a tool of another length.
    pub constants: Vec<(usize, f64)>,
    /// The runs that are held out; whole blocks of time where the recording names none.
    pub holdout: Option<Vec<i64>>,
    /// The unit in which the recording gives angles, for people.
    pub angle_unit: AngleUnit,
    /// What a reader of the results should know of the data, a sentence each.
    pub notes: Vec<String>,
}

impl Recording {
    /// The constants of the machine while it was recorded, from those that are known of it.
    #[must_use]
    pub fn constants(&self, known: &[f64]) -> Vec<f64> {
        let mut constants = known.to_vec();
        for (number, value) in &self.constants {
            if let Some(constant) = constants.get_mut(*number) {
                *constant = *value;
            }
        }
        constants
    }

    /// Whether another one has the same rows, to the last bit: a copy of it. Two measurements differ in their noise, unless all readings are
    /// one number.
    #[must_use]
    pub fn is_copy_of(&self, other: &Self) -> bool {
        let alike = |(own, other): (Option<&Vec<f64>>, Option<&Vec<f64>>)| same_bits(own, other);
        let varies = |column: &Vec<f64>| column.windows(2).any(|pair| (pair[1] - pair[0]).abs() > 0.0);
        self.time.len() == other.time.len()
            && self.run == other.run
            && same_bits(Some(&self.time), Some(&other.time))
            && self.columns().count() == other.columns().count()
            && self.columns().zip(other.columns()).all(alike)
            && self.readings().flatten().any(varies)
    }

    /// What was read, by the instrument.
    fn readings(&self) -> impl Iterator<Item = Option<&Vec<f64>>> {
        let of_axes = self.axes.iter().map(|axis| axis.measured.as_ref());
        self.measured.iter().map(Option::as_ref).chain([self.deviation.as_ref()]).chain(of_axes)
    }

    /// What was read, and where the axes were.
    fn columns(&self) -> impl Iterator<Item = Option<&Vec<f64>>> {
        let of_axes = self.axes.iter().flat_map(|axis| [axis.command.as_ref(), axis.actual.as_ref()]);
        self.readings().chain(of_axes)
    }

    /// A calibration with the constants of the machine while it was recorded.
    #[must_use]
    pub fn calibrated(&self, known: &Calibration) -> Calibration {
        Calibration { constants: self.constants(&known.constants), ..known.clone() }
    }
}

/// Whether columns hold the same numbers, gaps too.
fn same_bits(one: Option<&Vec<f64>>, other: Option<&Vec<f64>>) -> bool {
    let same = |(one, other): (&f64, &f64)| one.to_bits() == other.to_bits();
    match (one, other) {
        (None, None) => true,
        (Some(one), Some(other)) => one.len() == other.len() && one.iter().zip(other).all(same),
        _ => false,
    }
}

/// What a recording knows of one axis of the machine: mm, or rad for a rotary axis. [`AxisChannels::position`] says where it is.
#[derive(Clone, Debug, Default)]
pub struct AxisChannels {
    /// The programmed position.
    pub command: Option<Vec<f64>>,
    /// The drive's own feedback.
    pub actual: Option<Vec<f64>>,
    /// `measured.<axis>` of a rotary axis: its angle as the instrument has it, in the sense of the command.
    pub measured: Option<Vec<f64>>,
}

/// A temperature or a load.
#[derive(Clone, Debug, Default)]
pub struct Named {
    /// `spindle` of `temperature.spindle`.
    pub name: String,
    /// The unit of a load as calibrations write it, `N`; `degC` for a temperature.
    pub unit: String,
    /// One value a row.
    pub values: Vec<f64>,
}

/// What measured, and how it was set up: mm, part frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Instrument {
    /// The tool tip relative to the part in up to three directions, or the angle of a rotary stage.
    #[default]
    Position,
    /// The distance of the tool tip from a centre, minus the nominal radius.
    Ballbar {
        /// The declared centre.
        center: [f64; 3],
        /// The nominal radius.
        radius: f64,
    },
    /// A displacement along the axis that moves.
    Linear(Line),
    /// A displacement across the axis that moves.
    Straightness(Line),
    /// A rotation of the tool relative to the part while an axis moves.
    Angular {
        /// The axis that moves, by number, where the set-up names one.
        axis: Option<usize>,
        /// The direction it turns about: a unit vector; the reading is right-handed about it.
        about: [f64; 3],
    },
    /// A displacement along the normal of a surface, from the channels `normal.x|y|z`.
    Probe,
}

/// The set-up of an instrument that reads one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The axis that moves, by number, where the set-up names one.
    pub axis: Option<usize>,
    /// The direction that is read: a unit vector.
    pub direction: [f64; 3],
}

/// A unit of angles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleUnit {
    /// Radians.
    #[default]
    Radian,
    /// Degrees.
    Degree,
}
