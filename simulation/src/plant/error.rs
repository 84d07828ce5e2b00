//! Why a plant cannot be built or run. In: what is wrong. Out: a sentence.

use std::fmt;

/// Why a machine and its numbers make no plant, or a plant cannot run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlantError {
    /// The names are those of another machine: this link, constant or motion is not among them.
    OtherMachine(String),
    /// The nodes and values of a table do not fit together.
    Table,
    /// A term reads the temperature of this sensor, and nothing gives it.
    NoTemperature(String),
    /// A term reads this load, and nothing gives it.
    NoLoad(String),
    /// A column is not as long as the time.
    Length(String),
    /// A drive sees only terms of its axis's own motion that the calibration has.
    NoDriveTerm(String),
}

impl fmt::Display for PlantError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherMachine(what) => write!(formatter, "the calibration is for another machine: {what}"),
            Self::Table => formatter.write_str("the positions and values of a table do not match"),
            Self::NoTemperature(name) => {
                write!(formatter, "the calibration needs the temperature of `{name}`")
            }
            Self::NoLoad(name) => write!(formatter, "the calibration needs the load `{name}`"),
            Self::Length(what) => write!(formatter, "{what} does not have the length of the time"),
            Self::NoDriveTerm(what) => write!(formatter, "no drive sees {what}"),
        }
    }
}

impl std::error::Error for PlantError {}
