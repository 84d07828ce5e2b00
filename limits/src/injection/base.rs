//! Recordings that effects are injected into. In: a recording, its machine, what is known of it. Out: what the calibration shows
//! there, and what an error motion adds to each reading.
//!
//! Readings come from the simulation, which turns bodies by finite angles and shares no code with the diagnosis.

use std::sync::Arc;

use model_dsl::Compiled;
use model_dsl::calibration::{CalibratedTerm, Calibration, MachineNames, SeriesInput};
use recording::Recording;
use simulation::{Commands, Instrument, Measurement, Plant, replay};

use crate::injection::columns::difference;
use crate::injection::effect::Path;
use crate::injection::taken::{Outlet, column_of, commands, instrument, path, reading};

/// The part of a motion that a reading must show: a tenth.
const SEEN: f64 = 0.1;

/// A recording with its machine.
pub struct Base {
    /// What it is called in messages.
    pub name: String,
    /// The machine and its equations.
    pub compiled: Compiled,
    /// The names of its axes, motions and constants.
    pub names: MachineNames,
    /// What is known of the machine.
    pub calibration: Option<Calibration>,
    /// The recording as it is.
    pub recording: Recording,
    /// What effects follow.
    pub path: Path,
    /// The readings that show the machine.
    pub outlets: Vec<Outlet>,
    /// What the recording should say of the machine as it is known, reading by reading.
    still: Signal,
    known: Calibration,
    commands: Commands,
    measurement: Measurement,
}

/// One number a row for each outlet.
pub type Signal = Vec<Vec<f64>>;

impl Base {
    /// A recording in memory.
    pub fn new(
        name: &str,
        compiled: Compiled,
        calibration: Option<Calibration>,
        recording: Recording,
    ) -> Result<Self, String> {
        let names = compiled.equations.names();
        let constants = names.constants.iter().map(|(_, value)| value.unwrap_or(0.0)).collect();
        let known =
            calibration.clone().unwrap_or_else(|| Calibration::new(names.machine.as_str(), constants));
        let known = recording.calibrated(&known);
        let (instrument, outlets) = instrument(&recording, &names)?;
        let path = path(&recording, &names);
        let mut base = Self {
            name: name.to_owned(),
            measurement: Measurement::perfect(instrument),
            commands: commands(&recording),
            path,
            outlets,
            still: Vec::new(),
            known,
            compiled,
            names,
            calibration,
            recording,
        };
        base.still = base.readings(&base.plant(&base.known)?)?;
        Ok(base)
    }

    /// The instrument, without faults.
    pub fn instrument(&self) -> &Instrument {
        &self.measurement.instrument
    }

    /// What is known of the machine as it moves; without any error where there is no calibration.
    pub fn known(&self) -> &Calibration {
        &self.known
    }

    fn plant(&self, calibration: &Calibration) -> Result<Plant, String> {
        Plant::new(&self.compiled.machine, &self.names, calibration).map_err(|error| error.to_string())
    }

    fn readings(&self, plant: &Plant) -> Result<Signal, String> {
        let simulated =
            replay(plant, &self.commands, &self.measurement).map_err(|error| error.to_string())?;
        Ok(simulated.readings.into_iter().map(|reading| reading.clean).collect())
    }

    fn beside(&self, plant: &Plant) -> Option<Signal> {
        let readings = self.readings(plant).ok()?;
        Some(readings.iter().zip(&self.still).map(|(with, without)| difference(with, without)).collect())
    }

    /// What the readings gain where an error motion has these values, row by row.
    pub fn shown(&self, motion: usize, values: &[f64]) -> Option<Signal> {
        let values = Arc::new(values.to_vec());
        let effect = move |state: &simulation::State<'_>| values.get(state.row).copied().unwrap_or(0.0);
        self.beside(&self.plant(&self.known).ok()?.with_effect(motion, Arc::new(effect)))
    }

    /// What the readings gain where an error motion has a term more; its sensor is that of a name.
    pub fn claimed(&self, motion: usize, term: &CalibratedTerm, sensor: Option<&str>) -> Option<Signal> {
        let (mut known, mut term) = (self.known.clone(), term.clone());
        if let (
            CalibratedTerm::Expansion { sensor: number, .. }
            | CalibratedTerm::Growth { sensor: number, .. }
            | CalibratedTerm::Polynomial { input: SeriesInput::Sensor(number), .. },
            Some(name),
        ) = (&mut term, sensor)
        {
            *number = known.sensor(name);
        }
        self.beside(&self.plant(&known.with(&[(motion, term)])).ok()?)
    }

    /// The recording with a signal added to its readings; `drive` goes to the feedback of an axis besides.
    pub fn with(&self, signal: &Signal, drive: Option<(usize, &[f64])>) -> Recording {
        let mut recording = self.recording.clone();
        for (outlet, gain) in self.outlets.iter().zip(signal) {
            column_of(&mut recording, *outlet).into_iter().for_each(|column| add(column, gain));
        }
        if let Some((axis, gain)) = drive.filter(|(axis, _)| !self.outlets.contains(&Outlet::Actual(*axis))) {
            recording.axes[axis].actual.iter_mut().for_each(|column| add(column, gain));
        }
        recording
    }

    /// What the recording says beside what is known, reading by reading; NaN where nothing was read.
    pub fn residual(&self) -> Signal {
        let read = self.outlets.iter().map(|outlet| reading(&self.recording, *outlet));
        read.zip(&self.still).map(|(read, still)| difference(&read, still)).collect()
    }

    /// The motion through which an axis shows: its own (EXX of X) where a reading sees it, else another one of its link.
    pub fn motion_of(&self, axis: usize) -> Option<usize> {
        let of_axis = |motion: &usize| {
            let named = &self.names.motions[*motion];
            named.axis.as_deref() == Some(self.names.axes[axis].letter.as_str())
        };
        let own = |motion: &usize| self.names.own_axis(&self.names.motions[*motion]) == Some(axis);
        let moves = |motion: &usize| !self.compiled.equations.motions[*motion].alignment;
        let candidates: Vec<usize> = (0..self.names.motions.len()).filter(of_axis).filter(moves).collect();
        let seen = |motion: &usize| self.sees(*motion);
        candidates.iter().copied().filter(own).find(seen).or_else(|| candidates.iter().copied().find(seen))
    }

    /// Whether an instrument stands outside the drives: no encoder of an axis sees what another axis does to it.
    pub fn outside(&self) -> bool {
        !self.outlets.iter().any(|outlet| matches!(outlet, Outlet::Actual(_)))
    }

    /// Whether any reading shows a good part of an error motion: of what it hardly shows no machine has enough.
    fn sees(&self, motion: usize) -> bool {
        let step = vec![1e-3; self.recording.time.len()];
        let shown = self.shown(motion, &step);
        shown.iter().flatten().flatten().any(|gain| gain.abs() > SEEN * 1e-3)
    }
}

fn add(column: &mut [f64], gain: &[f64]) {
    column.iter_mut().zip(gain).for_each(|(value, gain)| *value += gain);
}

#[cfg(test)]
mod tests {
    use model_dsl::compile_word;
    use model_dsl::diagnostic::Diagnostics;
    use recording::AxisChannels;

    use super::*;

    /// A machine that goes along X and across Y within 10 s, and is read without error.
    fn base(word: &str, axes: usize) -> Base {
        let time: Vec<f64> = (0..101).map(|row| 0.1 * f64::from(row)).collect();
        let positions = [
            time.iter().map(|t| 10.0 * t).collect::<Vec<f64>>(),
            time.iter().map(|t| 20.0 - t * t).collect(),
            vec![0.0; 101],
        ];
        let command =
            |position: &Vec<f64>| AxisChannels { command: Some(position.clone()), ..AxisChannels::default() };
        let recording = Recording {
            run: vec![1; time.len()],
            axes: positions.iter().take(axes).map(command).collect(),
            measured: positions.clone().map(Some),
            time,
            ..Recording::default()
        };
        let compiled = compile_word(word, &mut Diagnostics::new()).unwrap();
        Base::new(word, compiled, None, recording).unwrap()
    }

    #[test]
    fn an_own_motion_shows_as_it_is() {
        let base = base("FX", 1);
        let motion = base.motion_of(0).unwrap();
        assert_eq!(base.names.motions[motion].name, "EXX");
        let values: Vec<f64> = (0..101).map(|row| 1e-4 * f64::from(row)).collect();
        let shown = base.shown(motion, &values).unwrap();
        assert!(difference(&shown[0], &values).iter().all(|away| away.abs() < 1e-12));
        assert!(shown[1].iter().chain(&shown[2]).all(|gain| gain.abs() < 1e-12));
    }

    /// A squareness turns the line of Y about Z, right-handed: what goes along +Y comes out towards -X.
    #[test]
    fn a_squareness_shows_across() {
        let base = base("FXYZ", 3);
        let motion = base.names.motion("EC0Y").unwrap();
        let shown = base.shown(motion, &[1e-6; 101]).unwrap();
        let y = &base.path.axes[1].as_ref().unwrap().position;
        assert!(shown[0].iter().zip(y).all(|(gain, y)| (gain + 1e-6 * y).abs() < 1e-9));
    }

    #[test]
    fn what_is_injected_stands_in_the_readings_and_nowhere_else() {
        let base = base("FX", 1);
        let signal = vec![vec![0.5; 101], vec![0.0; 101], vec![0.0; 101]];
        let recording = base.with(&signal, None);
        let [x, y, _] = recording.measured;
        assert_eq!(
            (x.unwrap()[10], y, recording.axes[0].command.as_ref().unwrap()[10]),
            (10.5, base.recording.measured[1].clone(), 10.0)
        );
    }

    #[test]
    fn recordings_of_nothing_are_told() {
        let compiled = compile_word("FX", &mut Diagnostics::new()).unwrap();
        let axes = vec![AxisChannels::default()];
        let empty = Recording { time: vec![0.0, 1.0], run: vec![1, 1], axes, ..Recording::default() };
        assert_eq!(Base::new("empty", compiled, None, empty).err().as_deref(), Some("nothing was measured"));
    }
}
