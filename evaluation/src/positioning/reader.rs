//! What reads along a line. In: a course and a line. Out: the deviation in any row; or why there is none.

use std::f64::consts::TAU;

use recording::{Instrument, own_direction};

use super::{Kind, Zero};
use crate::course::{Course, LETTERS, cell, dot};
use crate::figure::Sensor;
use crate::stations::Line;

/// The least cosine between the line and the direction that is read: 5 degrees, as a set-up may have it.
const ALONG: f64 = 0.996_194;

/// Parts of a direction that are nothing.
const NOTHING: f64 = 1e-6;

/// What gives the deviation along a line.
pub(super) struct Reader<'r> {
    columns: Vec<(f64, Source<'r>)>,
    pub(super) sensor: Sensor,
    pub(super) zero: Zero,
}

/// A part of a deviation.
enum Source<'r> {
    /// A column as it is.
    Column(&'r [f64]),
    /// A column minus another.
    Difference(&'r [f64], &'r [f64]),
}

impl<'r> Reader<'r> {
    pub(super) fn of(course: &'r Course<'_>, line: &Line, kind: Kind) -> Result<Self, String> {
        match &course.recording.instrument {
            Instrument::Linear(_) if kind == Kind::Rotary => {
                Err("the instrument reads a displacement, but the axis is rotary".to_owned())
            }
            Instrument::Linear(beam) => {
                let cosine = dot(&tip_direction(course, line)?, &beam.direction);
                if cosine.abs() < ALONG {
                    return Err("the instrument reads another direction".to_owned());
                }
                Self::deviation(course, cosine.signum())
            }
            Instrument::Angular { about, .. } if kind == Kind::Rotary => {
                let axis = line.axes.first().copied().unwrap_or_default();
                let own = own_direction(course.equations, axis).unwrap_or_default();
                let cosine = dot(&own, about);
                if cosine.abs() < ALONG {
                    return Err("the instrument reads the rotation about another direction".to_owned());
                }
                Self::deviation(course, cosine.signum())
            }
            Instrument::Position if kind == Kind::Rotary => Self::angle(course, line),
            Instrument::Position => Self::tip(course, line),
            Instrument::Angular { .. } => Err(
                "the instrument reads a rotation, but the positioning of a slide is a displacement along it"
                    .to_owned(),
            ),
            Instrument::Straightness(_) => {
                Err("the instrument reads across the axis, but positioning is a displacement along it"
                    .to_owned())
            }
            Instrument::Probe => {
                Err("a probe reads points of a surface, not positions of an axis".to_owned())
            }
            Instrument::Ballbar { .. } => Err("a ballbar reads distances from a centre".to_owned()),
        }
    }

    fn deviation(course: &'r Course<'_>, sign: f64) -> Result<Self, String> {
        let deviation = course.recording.deviation.as_deref();
        let deviation = deviation.ok_or_else(|| "the channel `deviation` is missing".to_owned())?;
        let columns = vec![(sign, Source::Column(deviation))];
        Ok(Self { columns, sensor: Sensor::Instrument, zero: Zero::Instrument })
    }

    fn angle(course: &'r Course<'_>, line: &Line) -> Result<Self, String> {
        let axis = line.axes.first().copied().unwrap_or_default();
        let channels = course.recording.axes.get(axis);
        let Some(measured) = channels.and_then(|channels| channels.measured.as_deref()) else {
            return Self::feedback(course, line);
        };
        let command = course.positions.get(axis).map_or(&[][..], Vec::as_slice);
        let columns = vec![(1.0, Source::Difference(measured, command))];
        Ok(Self { columns, sensor: Sensor::Instrument, zero: Zero::Nominal })
    }

    fn tip(course: &'r Course<'_>, line: &Line) -> Result<Self, String> {
        let measured = &course.recording.measured;
        if measured.iter().all(Option::is_none) {
            return Self::feedback(course, line);
        }
        let mut columns = Vec::new();
        let direction = tip_direction(course, line)?;
        let parts = direction.iter().zip(measured).zip(&course.tip).zip(LETTERS);
        for (((part, measured), nominal), letter) in parts.filter(|(((part, _), _), _)| part.abs() > NOTHING)
        {
            let measured =
                measured.as_deref().ok_or_else(|| format!("the channel `measured.{letter}` is missing"))?;
            columns.push((*part, Source::Difference(measured, nominal)));
        }
        let zero = if course.absolute { Zero::Nominal } else { Zero::Mean };
        Ok(Self { columns, sensor: Sensor::Instrument, zero })
    }

    /// The drives' own feedback, where nothing else was measured.
    fn feedback(course: &'r Course<'_>, line: &Line) -> Result<Self, String> {
        let mut columns = Vec::new();
        for axis in &line.axes {
            let letter = course.letter(*axis).to_lowercase();
            let actual = course.actual(*axis);
            let actual =
                actual.ok_or_else(|| format!("it has neither `measured.{letter}` nor `actual.{letter}`"))?;
            let command = course.positions.get(*axis).map_or(&[][..], Vec::as_slice);
            columns.push((cell(&line.direction, *axis), Source::Difference(actual, command)));
        }
        Ok(Self { columns, sensor: Sensor::Feedback, zero: Zero::Nominal })
    }

    /// The deviation in a row; NaN where there is none.
    pub(super) fn at(&self, row: usize, kind: Kind) -> f64 {
        let part = |(factor, source): &(f64, Source<'_>)| {
            factor
                * match source {
                    Source::Column(column) => cell(column, row),
                    Source::Difference(one, other) => cell(one, row) - cell(other, row),
                }
        };
        let sum: f64 = self.columns.iter().map(part).sum();
        // An encoder that begins again after a turn is not a turn off.
        if kind == Kind::Rotary { sum - TAU * (sum / TAU).round() } else { sum }
    }
}

/// The direction in which the nominal tool tip moves along a line, part frame.
fn tip_direction(course: &Course<'_>, line: &Line) -> Result<[f64; 3], String> {
    let ahead: Vec<f64> = line.foot.iter().zip(&line.direction).map(|(foot, step)| foot + step).collect();
    let (from, to) = (course.nominal(&line.foot), course.nominal(&ahead));
    let mut step = to;
    step.iter_mut().zip(from).for_each(|(to, from)| *to -= from);
    let length = dot(&step, &step).sqrt();
    if length > NOTHING {
        Ok(step.map(|part| part / length))
    } else {
        Err("the machine is not sensitive in its direction".to_owned())
    }
}
