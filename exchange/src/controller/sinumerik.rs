//! Siemens SINUMERIK: leadscrew error compensation (`$AA_ENC_COMP`) and cross error compensation (`$AN_CEC`). In: a correction
//! taken apart. Out: an archive of each; and what such archives do.
//!
//! Facts: SINUMERIK Function Manual K3 "Compensations". A value of `ENC_COMP` changes the actual value, so that a positive one
//! moves the axis in its negative direction: it is the error, actual minus commanded. `CEC` acts from the setpoint of an input
//! axis on an output axis, in one direction of the input or in both; a table multiplied by another (its number is its index
//! plus 1) adds the product, as in the manual's example of a sagging foundation. The sign of a CEC value is said in no
//! document that could be read: the user says it.

mod archive;
mod write;

use std::collections::BTreeMap;

use abbe_runtime::Direction;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use super::even::Even;
use super::export::{Controller, Job, Sense};
use super::geometry::Pose;
use super::lost::Target;
use super::refused::Refused;

pub(super) use write::written;

/// A table of the cross error compensation.
#[derive(Clone, Debug, Default, PartialEq)]
struct Cross {
    /// The axis whose setpoint is read.
    input: usize,
    /// The axis that is moved.
    output: usize,
    /// Its values; places in mm or deg.
    curve: Even,
    /// 1 or -1: in one direction of the input alone; 0: in both.
    direction: i8,
    /// The index of the table that it is multiplied by.
    by: Option<usize>,
}

/// A control with its archives.
#[derive(Debug)]
pub(super) struct Sinumerik {
    /// The machine axis names, by axis.
    names: Vec<String>,
    /// The degrees of a radian where the axis turns, else 1.
    units: Vec<f64>,
    /// Which axes a compensation moves.
    moved: Vec<bool>,
    /// The leadscrew tables, by axis.
    screws: BTreeMap<usize, Even>,
    /// The cross tables, by index.
    crosses: BTreeMap<usize, Cross>,
    sense: Option<Sense>,
}

/// The control without compensation.
pub(super) fn controller(job: &Job<'_, '_>) -> Sinumerik {
    let axes = &job.geometry.equations.axes;
    let name =
        |letter: &str| job.options.name(letter).map_or_else(|| format!("{letter}1"), ToOwned::to_owned);
    Sinumerik {
        names: axes.iter().map(|axis| name(&axis.letter)).collect(),
        units: axes.iter().map(|axis| if axis.rotary { 1_f64.to_degrees() } else { 1.0 }).collect(),
        moved: axes.iter().map(|axis| axis.effect.is_some()).collect(),
        screws: BTreeMap::new(),
        crosses: BTreeMap::new(),
        sense: job.options.sense,
    }
}

impl Controller for Sinumerik {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        archive::load(self, source, diagnostics);
    }

    fn target(&self) -> &dyn Target {
        self
    }
}

impl Target for Sinumerik {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let mut correction = vec![0.0; pose.position.len()];
        let mut add = |axis: usize, value: f64| {
            if let Some(slot) = correction.get_mut(axis).filter(|_| self.moved.get(axis) == Some(&true)) {
                *slot += value;
            }
        };
        for (axis, screw) in &self.screws {
            add(*axis, -screw.value(self.place(pose, *axis)));
        }
        let sign = self.sense.map_or(0.0, Sense::sign);
        for (index, cross) in &self.crosses {
            add(cross.output, sign * self.added(*index, cross, pose));
        }
        Ok(correction)
    }
}

impl Sinumerik {
    /// Where an axis stands, in the unit of the archive.
    fn place(&self, pose: &Pose, axis: usize) -> f64 {
        let unit = self.units.get(axis).copied().unwrap_or(1.0);
        pose.position.get(axis).map_or(f64::NAN, |place| place * unit)
    }

    /// What a cross table adds: its value; its product with the table that it is multiplied by; nothing where it is only a
    /// factor of another.
    fn added(&self, index: usize, cross: &Cross, pose: &Pose) -> f64 {
        match cross.by {
            Some(by) => self.crosses.get(&by).map_or(0.0, |by| self.read(cross, pose) * self.read(by, pose)),
            None if self.crosses.values().any(|other| other.by == Some(index)) => 0.0,
            None => self.read(cross, pose),
        }
    }

    fn read(&self, cross: &Cross, pose: &Pose) -> f64 {
        let way = match pose.direction.get(cross.input) {
            Some(Direction::Negative) => -1,
            _ => 1,
        };
        if cross.direction == 0 || cross.direction == way {
            cross.curve.value(self.place(pose, cross.input))
        } else {
            0.0
        }
    }
}
