//! Series: one number of a machine over time. In: rows of results. Out: points with intervals, in the order of time.

use recording::Moment;
use serde::Serialize;

/// One number of a machine, recording by recording.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// What is followed: `EXX backlash axis=X`, or `noise`.
    pub effect: String,
    /// The error motion; empty for the noise.
    pub motion: String,
    /// The term; empty for the noise.
    pub term: String,
    /// The number of it: `lost_motion`.
    pub parameter: String,
    /// The unit of the values.
    pub unit: String,
    /// Where it was told.
    pub points: Vec<Point>,
    /// Where it was not.
    pub untold: Vec<Untold>,
}

/// A recording that says nothing of a number.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Untold {
    /// When it was recorded.
    #[serde(serialize_with = "as_text")]
    pub time: Moment,
    /// The recording.
    pub recording: String,
    /// Why, a clause.
    pub why: String,
}

/// What a recording says of a number.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// When it was recorded.
    #[serde(serialize_with = "as_text")]
    pub time: Moment,
    /// The recording.
    pub recording: String,
    /// The value.
    pub value: f64,
    /// The ends of its 95 % interval; of a noise the value itself.
    pub low: f64,
    /// The other end.
    pub high: f64,
    /// Whether it was found in this recording: else it is what the recording shows of what was found in others.
    pub claimed: bool,
}

/// The name of the series of noise.
pub(crate) const NOISE: &str = "noise";

/// Half of a 95 % interval in standard errors.
const WIDTH_95: f64 = 1.959_964;

impl Point {
    /// The standard error.
    pub(crate) fn error(&self) -> f64 {
        (self.high - self.low) / 2.0 / WIDTH_95
    }

    /// Days since 1970.
    pub(crate) fn days(&self) -> f64 {
        days(self.time)
    }
}

/// Days since 1970.
#[expect(clippy::cast_precision_loss, reason = "seconds of years up to 9999 are below 2^53")]
pub(crate) fn days(time: Moment) -> f64 {
    time.seconds() as f64 / 86_400.0
}

/// A moment as JSON has it.
pub(crate) fn as_text<S: serde::Serializer>(time: &Moment, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(time)
}

impl Series {
    /// What it is called: `lost_motion of EXX backlash axis=X`, or `noise`.
    pub(crate) fn name(&self) -> String {
        if self.is_noise() { NOISE.to_owned() } else { format!("{} of {}", self.parameter, self.effect) }
    }

    /// Whether it is the noise: a level, of which the logarithm is compared.
    pub(crate) fn is_noise(&self) -> bool {
        self.term.is_empty()
    }

    /// The value that is compared, and its standard error.
    pub(crate) fn compared(&self, point: &Point) -> (f64, f64) {
        if self.is_noise() { (point.value.ln(), 0.0) } else { (point.value, point.error()) }
    }
}
