//! What reads a circle. In: a course and a trace. Out: the actual path, relative to the nominal centre; or why there is none.

use recording::Instrument;

use crate::circles::PathTrace;
use crate::course::{Course, cell};
use crate::figure::Sensor;
use crate::fit::Place;

/// How far the nominal path may lie from a ballbar's nominal length, as a share of it.
const BAR: f64 = 0.01;

/// What gives the actual path.
pub(super) enum Reader<'r> {
    /// Radial deviations of a ballbar.
    Radial { deviation: &'r [f64], radius: f64 },
    /// The tool tip in the plane.
    Tip { columns: [Vec<f64>; 2], sensor: Sensor },
}

impl<'r> Reader<'r> {
    pub(super) fn of(course: &'r Course<'_>, trace: &PathTrace) -> Result<Self, String> {
        match &course.recording.instrument {
            Instrument::Ballbar { radius, .. } => {
                let off = (trace.circle.radius - radius).abs();
                if off > BAR * radius {
                    let own = trace.circle.radius;
                    return Err(format!(
                        "the path has a radius of {own:.3} mm but the bar a length of {radius:.3} mm, so the bar is not in the plane"
                    ));
                }
                let deviation = course.recording.deviation.as_deref();
                let deviation = deviation.ok_or_else(|| "the channel `deviation` is missing".to_owned())?;
                Ok(Self::Radial { deviation, radius: *radius })
            }
            Instrument::Position => {
                let (columns, sensor) = course.seen(trace.directions)?;
                Ok(Self::Tip { columns, sensor })
            }
            _ => Err("only the instruments `ballbar` and `position` read a circle".to_owned()),
        }
    }

    pub(super) fn sensor(&self) -> Sensor {
        match self {
            Self::Radial { .. } => Sensor::Instrument,
            Self::Tip { sensor, .. } => *sensor,
        }
    }

    pub(super) fn radius(&self, trace: &PathTrace) -> f64 {
        match self {
            Self::Radial { radius, .. } => *radius,
            Self::Tip { .. } => trace.circle.radius,
        }
    }

    /// Whether the centre about which the readings stand is the nominal one.
    pub(super) fn centered(&self, course: &Course<'_>) -> bool {
        match self {
            Self::Radial { .. } => true,
            Self::Tip { sensor, .. } => *sensor == Sensor::Feedback || course.absolute,
        }
    }

    /// The actual path relative to the nominal centre; NaN where nothing was read.
    pub(super) fn place(&self, trace: &PathTrace, row: usize, angle: f64) -> Place {
        match self {
            Self::Radial { deviation, radius } => {
                let distance = radius + cell(deviation, row);
                [distance * angle.cos(), distance * angle.sin()]
            }
            Self::Tip { columns: [one, other], .. } => {
                let [x, y] = trace.circle.center;
                [cell(one, row) - x, cell(other, row) - y]
            }
        }
    }
}
