//! A PMAC with its tables. In: a pose. Out: what they add to the commands.

use abbe_runtime::Direction;
use model_dsl::equations::AxisInfo;

use super::super::geometry::Pose;
use super::super::job::Job;
use super::super::lost::Target;
use super::super::refused::Refused;

/// Entries are so many to a count.
pub(super) const PARTS: f64 = 16.0;

/// The leadscrew tables that a controller has: one belongs to each motor.
pub(super) const TABLES: usize = 8;

/// A table that rolls over.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Rolling {
    /// The span, in counts of the source.
    pub(super) length: f64,
    /// The entries, from one spacing on, in sixteenths of a count of the target.
    pub(super) entries: Vec<i64>,
}

/// A leadscrew table.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Screw {
    pub(super) source: usize,
    pub(super) target: usize,
    pub(super) table: Rolling,
}

/// A motor, by axis.
#[derive(Clone, Debug)]
pub(super) struct Motor {
    /// Its number.
    pub(super) number: String,
    /// Its counts for a mm, or for a rad of a rotary axis; none for a rotary axis whose counts are not said, which has no table.
    pub(super) counts: Option<f64>,
    /// Whether it turns a rotary axis.
    pub(super) turns: bool,
    /// Its backlash table.
    pub(super) backlash: Option<Rolling>,
    /// `Ixx86`, in sixteenths of a count.
    pub(super) constant: f64,
}

/// A controller with its tables.
#[derive(Debug)]
pub(in super::super) struct Pmac {
    pub(super) motors: Vec<Motor>,
    pub(super) screws: Vec<Screw>,
}

/// The controller without compensation.
///
/// # Errors
/// Where the counts of a motor are not said.
pub(in super::super) fn controller(job: &Job<'_, '_>) -> Result<Pmac, Refused> {
    let numbers = job.names(|place, _| (place + 1).to_string())?;
    let axes = job.geometry.equations.axes.iter().zip(numbers);
    let motor = |(axis, number): (&AxisInfo, String)| {
        let counts =
            job.options.counts.iter().find(|(letter, _)| *letter == axis.letter).map(|(_, counts)| *counts);
        if !axis.rotary && counts.is_none() {
            let help = format!("give the counts per mm: --counts {}=10000", axis.letter);
            return Err(Refused::new(format!("the number of counts of {} is unknown", axis.letter), help));
        }
        if !number.parse::<u8>().is_ok_and(|number| number > 0) {
            let help = format!("give the number of the motor: --name {}=1", axis.letter);
            return Err(Refused::new(format!("`{number}` is not a motor"), help));
        }
        let unit = if axis.rotary { 1_f64.to_degrees() } else { 1.0 };
        let (counts, turns) = (counts.map(|counts| counts * unit), axis.rotary);
        Ok(Motor { number, counts, turns, backlash: None, constant: 0.0 })
    };
    Ok(Pmac { motors: axes.map(motor).collect::<Result<_, _>>()?, screws: Vec::new() })
}

impl Rolling {
    /// The value at a position in counts, in sixteenths of a count.
    fn value(&self, position: f64) -> f64 {
        let count = self.entries.len();
        let Some(spacing) =
            u32::try_from(count).ok().filter(|count| *count > 0).map(|count| self.length / f64::from(count))
        else {
            return 0.0;
        };
        let place = position.rem_euclid(self.length) / spacing;
        let whole = place.floor();
        // Entry k is k + 1 spacings from zero; the last is zero itself.
        let entry =
            |spacings: usize| self.entries.get((spacings + count - 1) % count).copied().map_or(0.0, number);
        let at = index(whole);
        entry(at) + (entry(at + 1) - entry(at)) * (place - whole)
    }
}

impl Target for Pmac {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let mut correction = vec![0.0; pose.position.len()];
        let counts = |axis: usize| self.motors.get(axis).and_then(|motor| motor.counts);
        let place =
            |axis: usize| pose.position.get(axis).zip(counts(axis)).map(|(place, counts)| place * counts);
        let mut add = |axis: usize, parts: f64| {
            if let Some((slot, counts)) = correction.get_mut(axis).zip(counts(axis)) {
                *slot += parts / PARTS / counts;
            }
        };
        for screw in &self.screws {
            add(screw.target, place(screw.source).map_or(0.0, |place| screw.table.value(place)));
        }
        for (axis, motor) in self.motors.iter().enumerate() {
            if pose.direction.get(axis) == Some(&Direction::Negative) {
                let table =
                    motor.backlash.as_ref().zip(place(axis)).map_or(0.0, |(table, place)| table.value(place));
                add(axis, -(table + motor.constant));
            }
        }
        Ok(correction)
    }
}

/// A whole number as one with a fraction: exact below 2^53, and entries are far below.
#[expect(clippy::cast_precision_loss, reason = "entries are far below 2^53")]
pub(super) fn number(whole: i64) -> f64 {
    whole as f64
}

/// A number without a fraction as a whole one.
#[expect(
    clippy::cast_possible_truncation,
    reason = "rounded, and far below 2^63; beyond, Rust takes the nearest end"
)]
pub(super) fn index_signed(whole: f64) -> i64 {
    whole as i64
}

/// A number without a fraction as an index; 0 below zero.
pub(super) fn index(whole: f64) -> usize {
    usize::try_from(index_signed(whole)).unwrap_or_default()
}
