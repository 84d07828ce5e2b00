//! The reader: what an instrument and the drives' own feedback say of the recorded rows.
//!
//! In: poses of the plant, and the instrument with its faults. Out: a column for each channel, with noise and without.

use nalgebra::Vector3;

use super::{Measurement, Reading};
use crate::commands::Column;
use crate::instrument::{Channel, Instrument, Seen};
use crate::noise::Source;
use crate::plant::{Plant, Pose};

/// Reads the recorded rows.
pub(super) struct Reader<'r> {
    pub(super) plant: &'r Plant,
    pub(super) measurement: &'r Measurement,
    pub(super) time: &'r [f64],
    pub(super) run: &'r [i64],
    pub(super) positions: &'r [Vec<f64>],
}

impl Reader<'_> {
    pub(super) fn readings(&self, poses: &[Pose]) -> Vec<Reading> {
        let instrument = &self.measurement.instrument;
        let lying = self.lying(poses);
        let poses = lying.as_deref().unwrap_or(poses);
        let clean = self.read(poses);
        let mut values = match self.displaced(poses) {
            Some(displaced) => self.read(&displaced),
            None => clean.clone(),
        };
        let channels = instrument.channels();
        let lost = self.measurement.missing.lost(self.time, &mut self.source("missing"));
        for (channel, values) in channels.iter().zip(&mut values) {
            let mut source = self.source(&self.name(*channel));
            self.measurement.noise.apply(self.time, values, &mut source);
            values.iter_mut().zip(&lost).filter(|(_, lost)| **lost).for_each(|(value, _)| *value = f64::NAN);
        }
        let columns = channels.into_iter().zip(values).zip(clean);
        columns.map(|((channel, values), clean)| Reading { channel, values, clean }).collect()
    }

    /// One column for each channel.
    fn read(&self, poses: &[Pose]) -> Vec<Vec<f64>> {
        let instrument = &self.measurement.instrument;
        let channels = instrument.channels();
        let mut columns = vec![Vec::with_capacity(poses.len()); channels.len()];
        let mut start = None;
        for (row, pose) in poses.iter().enumerate() {
            let positions = self.command(row);
            let nominal = self.plant.nominal(&positions);
            let start = *start.get_or_insert(nominal.tip);
            let seen = Seen { pose: *pose, nominal, positions: &positions, start };
            for (channel, column) in channels.iter().zip(&mut columns) {
                column.push(instrument.read(*channel, self.plant, &seen) + self.measurement.offset);
            }
        }
        columns
    }

    fn command(&self, row: usize) -> Vec<f64> {
        self.positions.iter().map(|column| column.get(row).copied().unwrap_or(f64::NAN)).collect()
    }

    /// The poses as the part lies where it was clamped anew.
    fn lying(&self, poses: &[Pose]) -> Option<Vec<Pose>> {
        let datum = self.measurement.datum?;
        Some(poses.iter().map(|pose| Pose { tip: datum.found(pose.tip), ..*pose }).collect())
    }

    /// The poses with the part displaced in its fixture, another way in every run.
    fn displaced(&self, poses: &[Pose]) -> Option<Vec<Pose>> {
        let sigma = self.measurement.fixture;
        if sigma <= 0.0 {
            return None;
        }
        let displacement = |run: &i64| {
            let mut source = self.source(&format!("fixture.{run}"));
            Vector3::from_fn(|_, _| sigma * source.normal())
        };
        let mut known: Vec<(i64, Vector3<f64>)> = Vec::new();
        let displaced = poses.iter().zip(self.run).map(|(pose, run)| {
            let by = match known.iter().find(|(other, _)| other == run) {
                Some((_, by)) => *by,
                None => {
                    let by = displacement(run);
                    known.push((*run, by));
                    by
                }
            };
            Pose { tip: pose.tip + by, ..*pose }
        });
        Some(displaced.collect())
    }

    pub(super) fn normals(&self) -> Option<[Vec<f64>; 3]> {
        let Instrument::Probe { normal } = &self.measurement.instrument else { return None };
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for row in 0..self.time.len() {
            let direction = normal.at(self.plant.nominal(&self.command(row)).tip);
            columns.iter_mut().zip(direction.iter()).for_each(|(column, entry)| column.push(*entry));
        }
        Some(columns)
    }

    pub(super) fn drive(&self, axis: usize, mut column: Vec<f64>) -> Option<Vec<f64>> {
        if !self.measurement.drives.contains(&axis) {
            return None;
        }
        let letter = self.plant.names().axes.get(axis).map(|axis| axis.letter.to_ascii_lowercase())?;
        let mut source = self.source(&format!("actual.{letter}"));
        self.measurement.drive_noise.apply(self.time, &mut column, &mut source);
        Some(column)
    }

    pub(super) fn sensor(&self, mut column: Column, kind: &str) -> Column {
        let mut noises = self.measurement.sensor_noise.iter();
        if let Some((_, noise)) = noises.find(|(name, _)| *name == column.name) {
            let mut source = self.source(&format!("{kind}.{}", column.name));
            noise.apply(self.time, &mut column.values, &mut source);
        }
        column
    }

    fn source(&self, name: &str) -> Source {
        Source::new(self.measurement.seed, name)
    }

    fn name(&self, channel: Channel) -> String {
        channel_name(channel, &self.plant.names().axes)
    }
}

/// The name of a channel in recordings.
pub(crate) fn channel_name(channel: Channel, axes: &[model_dsl::calibration::AxisName]) -> String {
    match channel {
        Channel::Measured(direction) => {
            format!("measured.{}", ["x", "y", "z"].get(direction).unwrap_or(&"?"))
        }
        Channel::Angle(axis) => {
            let letter = axes.get(axis).map_or("?", |axis| axis.letter.as_str());
            format!("measured.{}", letter.to_ascii_lowercase())
        }
        Channel::Deviation => "deviation".to_owned(),
    }
}
