//! The study: a machine, what is known of it, and its recordings, brought to one set of numbers.
//!
//! In: equations, a calibration where there is one, recordings. Out: for each recording a scene with its channels, its sensors under the
//! numbers of the study, its blocks of rows, and which of them are held out. A study that was made never changes: what is held to be true
//! of it is a model, and how its samples weigh stands beside it.

use std::sync::Arc;

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;

use crate::channel::{Channel, ChannelAt, Kind};
use crate::clamping;
use crate::course::{Course, LastCourse};
use crate::model::{Effect, Fitted, Model, Place};
use crate::recording::{Recording, Turned};
use crate::rest;
use crate::returns::{Return, Returns};
use crate::scene::{Built, Scene};
use crate::side::Side;
use crate::terms::{self, Shape};

/// A machine, what is known of it, and what was recorded.
pub(crate) struct Study<'a> {
    pub(crate) equations: &'a Equations,
    /// The names of all sensors: those of the calibration under its own numbers, then others that were recorded.
    pub(crate) sensors: Vec<String>,
    /// The names and units of all loads that were recorded.
    pub(crate) loads: Vec<(String, String)>,
    pub(crate) scenes: Vec<Scene<'a>>,
    /// What the calibration says, as far as the recordings hold the states it reads.
    pub(crate) known: Vec<Fitted>,
    /// The number of the motion that is each axis's own: EXX of X.
    pub(crate) own: Vec<Option<usize>>,
}

impl<'a> Study<'a> {
    /// The channels of all recordings, in their order.
    pub(crate) fn channels(&self) -> impl Iterator<Item = ChannelAt> {
        let of_scene = |(scene, known): (usize, &Scene<'a>)| {
            (0..known.channels.len()).map(move |channel| ChannelAt { scene, channel })
        };
        self.scenes.iter().enumerate().flat_map(of_scene)
    }

    /// One of them.
    pub(crate) fn channel(&self, at: ChannelAt) -> &Channel<'a> {
        &self.scenes[at.scene].channels[at.channel]
    }

    /// The own motion of an axis, behind its drive where an instrument outside reads anything.
    pub(crate) fn own_place(&self, axis: usize) -> Option<Place> {
        let mut kinds = self.channels().map(|at| self.channel(at).kind);
        let side = if kinds.any(Kind::outside) { Side::After } else { Side::Drive };
        Some(Place::Motion { motion: self.own[axis]?, side })
    }

    /// Brings recordings of one machine together.
    pub(crate) fn new(
        equations: &'a Equations,
        calibration: Option<&'a Calibration>,
        recordings: &[&'a Recording],
    ) -> Self {
        Self::with_turned(equations, calibration, recordings, &[])
    }

    /// The same, in which these recordings, by number, are of parts that are known to be turned.
    pub(crate) fn with_turned(
        equations: &'a Equations,
        calibration: Option<&'a Calibration>,
        recordings: &[&'a Recording],
        turned: &[(usize, Turned)],
    ) -> Self {
        let constants = constants(equations, calibration);
        let sensors = sensor_names(calibration, recordings);
        let loads = load_names(recordings);
        let own = own_motions(equations);
        let known = known(calibration, &loads, &own);
        let usual = Built::new(equations, &constants);
        let built = |recording: &Recording| match recording.constants.as_slice() {
            [] => Arc::clone(&usual),
            _ => Built::new(equations, &recording.constants(&constants)),
        };
        let scenes = recordings
            .iter()
            .map(|recording| {
                Scene::new(recording, equations, calibration, (&sensors, &loads), built(recording))
            })
            .collect();
        let mut study = Self { equations, sensors, loads, scenes, known, own };
        // What is told of a scene follows from its course, which needs the study: so it is made in steps.
        for scene in 0..study.scenes.len() {
            let course = Course::new(&study, scene, &Model::default());
            let known = turned.iter().find(|(number, _)| *number == scene).map(|(_, turned)| *turned);
            study.scenes[scene].turned = known.or_else(|| clamping::turned_as_read(&study, scene, &course));
            study.scenes[scene].pose = clamping::pose(&study, scene, &course);
            study.scenes[scene].returns = Returns::new(&study, scene, &course.shown);
            study.scenes[scene].last_course = LastCourse::default();
        }
        rest::told(study)
    }

    /// The same with the last recording held out as a whole.
    pub(crate) fn with_last_held_out(mut self) -> Self {
        for block in self.scenes.last_mut().into_iter().flat_map(|scene| &mut scene.blocks) {
            block.held_out = true;
        }
        self
    }

    /// The same with nothing held out.
    pub(crate) fn with_nothing_held_out(mut self) -> Self {
        for block in self.scenes.iter_mut().flat_map(|scene| &mut scene.blocks) {
            block.held_out = false;
        }
        self
    }

    /// The same in which these states predict what is left of the channels, scene by scene.
    pub(crate) fn with_returning(mut self, returning: Vec<Vec<Vec<Return>>>) -> Self {
        for (scene, returning) in self.scenes.iter_mut().zip(returning) {
            for (channel, returning) in scene.channels.iter_mut().zip(returning) {
                channel.returning = returning;
            }
        }
        self
    }

    /// How many rows all recordings have together.
    pub(crate) fn rows(&self) -> usize {
        self.scenes.iter().map(Scene::rows).sum()
    }

    /// Whether the drive's own feedback of an axis was recorded anywhere.
    pub(crate) fn has_drive(&self, axis: usize) -> bool {
        let mut channels = self.scenes.iter().flat_map(|scene| &scene.channels);
        channels.any(|channel| channel.kind == Kind::Drive(axis))
    }

    /// Whether the command of an axis moves where a leg of a recording begins.
    pub(crate) fn may_begin_underway(&self, axis: usize) -> bool {
        self.scenes.iter().any(|scene| !scene.at_rest && scene.given.may_begin_underway(axis))
    }
}

fn constants(equations: &Equations, calibration: Option<&Calibration>) -> Vec<f64> {
    match calibration {
        Some(calibration) => calibration.constants.clone(),
        // A single stage's offsets have a default; others without a calibration are taken as zero.
        None => equations.constants.iter().map(|constant| constant.default.unwrap_or_default()).collect(),
    }
}

fn sensor_names(calibration: Option<&Calibration>, recordings: &[&Recording]) -> Vec<String> {
    let known = calibration.into_iter().flat_map(|calibration| calibration.sensors.iter());
    let mut names: Vec<String> = known.map(|sensor| sensor.name.value.clone()).collect();
    for channel in recordings.iter().flat_map(|recording| &recording.temperatures) {
        if !names.contains(&channel.name) {
            names.push(channel.name.clone());
        }
    }
    names
}

fn load_names(recordings: &[&Recording]) -> Vec<(String, String)> {
    let mut names: Vec<(String, String)> = Vec::new();
    for channel in recordings.iter().flat_map(|recording| &recording.loads) {
        if !names.iter().any(|(name, _)| *name == channel.name) {
            names.push((channel.name.clone(), channel.unit.clone()));
        }
    }
    names
}

/// The motion of each axis in its own direction: a displacement along a slide, a rotation about a rotary axis.
fn own_motions(equations: &Equations) -> Vec<Option<usize>> {
    (0..equations.axes.len()).map(|axis| equations.own_motion(axis)).collect()
}

/// The terms of a calibration, as far as the recordings hold the states they read.
pub(crate) fn known(
    calibration: Option<&Calibration>,
    loads: &[(String, String)],
    own: &[Option<usize>],
) -> Vec<Fitted> {
    let load = |name: &str| loads.iter().position(|(known, _)| known == name);
    let listed = calibration.into_iter().flat_map(|calibration| &calibration.motions);
    listed
        .flat_map(|listed| {
            listed.terms.iter().enumerate().map(move |(place, term)| (listed, place, &term.value))
        })
        .filter_map(|(listed, place, term)| {
            let (shape, coefficients) = terms::known(term, &load)?;
            let motion = listed.motion;
            let axis = own.iter().position(|own| *own == Some(motion));
            let side = match axis.filter(|_| listed.is_inside_loop(place)) {
                Some(axis) => Side::Loop { axis },
                None if matches!(shape, Shape::Lag { .. }) => Side::Drive,
                None => Side::After,
            };
            Some(Fitted { effect: Effect { place: Place::Motion { motion, side }, shape }, coefficients })
        })
        .collect()
}
