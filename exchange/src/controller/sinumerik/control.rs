//! A SINUMERIK with its tables. In: a pose. Out: what both compensations add to the commands.

use std::collections::BTreeMap;

use super::super::even::Even;
use super::super::geometry::Pose;
use super::super::job::Job;
use super::super::lost::Target;
use super::super::options::Sense;
use super::super::refused::Refused;
use abbe_runtime::Direction;
use model_dsl::equations::AxisInfo;

/// A table of the cross error compensation.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Cross {
    /// The axis whose setpoint is read.
    pub(super) input: usize,
    /// The axis that is moved.
    pub(super) output: usize,
    /// Its values; places in mm or deg.
    pub(super) curve: Even,
    /// 1 or -1: in one direction of the input alone; 0: in both.
    pub(super) direction: i8,
    /// The index of the table that it is multiplied by.
    pub(super) by: Option<usize>,
}

/// A control with its archives.
#[derive(Debug)]
pub(in super::super) struct Sinumerik {
    /// The machine axis names, by axis.
    pub(super) names: Vec<String>,
    /// The degrees of a radian where the axis turns, else 1.
    pub(super) units: Vec<f64>,
    /// Which axes a compensation moves.
    pub(super) moved: Vec<bool>,
    /// The leadscrew tables, by axis.
    pub(super) screws: BTreeMap<usize, Even>,
    /// The cross tables, by index.
    pub(super) crosses: BTreeMap<usize, Cross>,
    pub(super) sense: Option<Sense>,
}

/// The control without compensation.
///
/// # Errors
/// Two axes of one name.
pub(in super::super) fn controller(job: &Job<'_, '_>) -> Result<Sinumerik, Refused> {
    let axes = &job.geometry.equations.axes;
    Ok(Sinumerik {
        names: job.names(|_, letter| format!("{letter}1"))?,
        units: axes.iter().map(|axis| if axis.rotary { 1_f64.to_degrees() } else { 1.0 }).collect(),
        moved: axes.iter().map(AxisInfo::corrects).collect(),
        screws: BTreeMap::new(),
        crosses: BTreeMap::new(),
        sense: job.options.sense,
    })
}

impl Target for Sinumerik {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let mut correction = vec![0.0; pose.position.len()];
        let mut add = |axis: usize, value: f64| {
            if let Some(slot) = correction.get_mut(axis).filter(|_| self.moved.get(axis) == Some(&true)) {
                *slot += value / self.unit(axis);
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
        pose.position.get(axis).map_or(f64::NAN, |place| place * self.unit(axis))
    }

    /// What the archive writes for a mm or a rad of an axis: 1, or the degrees of a radian.
    pub(super) fn unit(&self, axis: usize) -> f64 {
        self.units.get(axis).copied().unwrap_or(1.0)
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

impl Sinumerik {
    /// Cross tables that add nothing, and why.
    pub(super) fn idle(&self) -> Vec<String> {
        if self.sense.is_none() && !self.crosses.is_empty() {
            return vec!["its cross tables (CEC): say with --value what a positive number means".to_owned()];
        }
        let missing = |(index, cross): (&usize, &Cross)| {
            let by = cross.by.filter(|by| !self.crosses.contains_key(by))?;
            Some(format!("table {index}: it is multiplied by table number {}, which does not exist", by + 1))
        };
        self.crosses.iter().filter_map(missing).collect()
    }
}
