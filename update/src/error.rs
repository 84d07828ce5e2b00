//! Why nothing could be updated. In: what is missing. Out: a sentence, and the recording that it speaks of.

use std::fmt;

/// Why nothing could be updated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UpdateError {
    /// A term reads a sensor that a recording lacks.
    NoTemperature {
        /// The recording, by its place among those given.
        recording: usize,
        /// The sensor: `T10` of the channel `temperature.T10`.
        sensor: String,
    },
    /// The instrument of a recording measures no points of a part, nor lengths between them.
    Instrument {
        /// The recording, by its place among those given.
        recording: usize,
    },
    /// No row of any recording has a reading and a position.
    NoPoints,
    /// The calibration has no coefficient that a relative change could move.
    NothingToMove,
    /// The singular values could not be computed.
    NoDecomposition,
}

impl fmt::Display for UpdateError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTemperature { sensor, .. } => write!(
                formatter,
                "the calibration reads the sensor {sensor}, but the recording has no channel `temperature.{sensor}`"
            ),
            Self::Instrument { .. } => {
                formatter.write_str("only the instruments `probe`, `position` and `ballbar` measure points of a part")
            }
            Self::NoPoints => {
                formatter.write_str("the recordings have no point with a reading and a position")
            }
            Self::NothingToMove => formatter.write_str(
                "the calibration has no coefficient that could change: all are zero, or in terms that points do not show",
            ),
            Self::NoDecomposition => formatter.write_str(
                "the singular values could not be computed: the numbers of the calibration are too far apart",
            ),
        }
    }
}

impl std::error::Error for UpdateError {}
