//! The study: a machine, what is known of it, and its recordings, brought to one set of numbers.
//!
//! In: equations, a calibration where there is one, recordings. Out: for each recording its channels (what was observed,
//! and in which direction), its sensors under the numbers of the study, its blocks of rows, and which of them are held out.

use std::ops::Range;
use std::sync::Arc;

use model_dsl::calibration::{Calibration, SensorReadings};
use model_dsl::equations::Equations;
use model_dsl::exact::ExactProduct;
use model_dsl::program::Interpreter;

use crate::course::{Course, LastCourse};
use crate::legs::GAP;
use crate::model::{Effect, Fitted, Model, Place};
use crate::noise;
use crate::observations;
use crate::recording::{Instrument, Lie, Recording};
use crate::returns::{Return, Returns};
use crate::rounded;
use crate::side::Side;
use crate::states::{Given, Shared, behind_corners, beside_reversals, unseen_turns};
use crate::targets::Targets;
use crate::terms::{self, Shape};

/// A machine with the values of its constants while one recording was made.
pub(crate) struct Built {
    pub(crate) interpreter: Interpreter,
    /// The same machine without linearisation, for what the calibration says.
    pub(crate) exact: ExactProduct,
}

impl Built {
    fn new(equations: &Equations, constants: &[f64]) -> Arc<Self> {
        let interpreter = Interpreter::new(equations, constants);
        Arc::new(Self { interpreter, exact: ExactProduct::new(equations, constants) })
    }
}

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

/// A channel of a recording, by the numbers of both.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ChannelAt {
    pub(crate) scene: usize,
    pub(crate) channel: usize,
}

/// One recording in the study.
pub(crate) struct Scene<'a> {
    pub(crate) recording: &'a Recording,
    /// The machine that was recorded: recordings with tools of different lengths differ in a constant.
    pub(crate) built: Arc<Built>,
    pub(crate) given: Given,
    pub(crate) channels: Vec<Channel<'a>>,
    pub(crate) blocks: Vec<Block>,
    /// How long it was observed, s: gaps and pauses left out.
    pub(crate) observed: f64,
    /// Rows that are left out because an axis turned a corner just before, between two rows.
    pub(crate) corners: Vec<bool>,
    /// Axes whose command is an end point; the rows in which they are on their way are left out too.
    pub(crate) targets: Targets,
    /// Whether the axes are at rest in every row, as far as position loops go: rows far apart, which a calibration with
    /// loops explains better so.
    pub(crate) at_rest: bool,
    /// The directions in which the path leaves the plane of a ballbar's centre; the others a ballbar does not show.
    pub(crate) leans: [bool; 3],
    /// How the part lies where it was measured, where that is free.
    pub(crate) lie: Option<Lie>,
    /// The course that was worked out last.
    pub(crate) last_course: LastCourse,
    /// What may come back in it.
    pub(crate) returns: Returns,
}

/// One observed quantity: a number with a direction in each row.
#[derive(Clone, Debug)]
pub(crate) struct Channel<'a> {
    /// The channel's name in the recording.
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// mm or rad; NaN where it is missing.
    pub(crate) values: &'a [f64],
    /// The standard deviation of the rounding of its values, and of the commands that it is held against.
    pub(crate) rounding: f64,
    /// The states of which functions predict what the calibration leaves of it.
    pub(crate) returning: Vec<Return>,
}

impl Channel<'_> {
    /// The step of its display.
    pub(crate) fn step(&self) -> f64 {
        rounded::step(self.rounding)
    }
}

/// What a channel observes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// The tool tip in one direction of the part's frame.
    Tip(usize),
    /// The distance of the tool tip from a centre, minus a radius.
    Radius { center: [f64; 3], radius: f64 },
    /// The error of the tool tip along a direction.
    Along([f64; 3]),
    /// The error of the tool tip along the normal in each row.
    Normal,
    /// The rotation of the tool relative to the part about a direction.
    Turn([f64; 3]),
    /// The angle of a rotary axis.
    Stage(usize),
    /// The drive's own feedback of an axis.
    Drive(usize),
}

impl Kind {
    /// Whether an instrument outside the drive reads it.
    pub(crate) fn outside(self) -> bool {
        !matches!(self, Self::Drive(_))
    }

    /// Whether two channels, of different recordings, read the same: one axis, or one direction of the part's frame, or in any
    /// direction what one instrument is made for.
    pub(crate) fn reads_as(self, other: Self) -> bool {
        match (self, other) {
            (Self::Tip(one), Self::Tip(two))
            | (Self::Stage(one), Self::Stage(two))
            | (Self::Drive(one), Self::Drive(two)) => one == two,
            (Self::Radius { .. }, Self::Radius { .. })
            | (Self::Along(_), Self::Along(_))
            | (Self::Normal, Self::Normal)
            | (Self::Turn(_), Self::Turn(_)) => true,
            _ => false,
        }
    }

    /// Whether it is an angle.
    pub(crate) fn angular(self, equations: &Equations) -> bool {
        match self {
            Self::Turn(_) | Self::Stage(_) => true,
            Self::Drive(axis) => equations.axes.get(axis).is_some_and(|axis| axis.rotary),
            _ => false,
        }
    }
}

/// A stretch of rows of one run that is fitted, or held out, as a whole.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) rows: Range<usize>,
    pub(crate) run: i64,
    pub(crate) held_out: bool,
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
        for scene in 0..study.scenes.len() {
            let course = Course::new(&study, scene, &Model::default());
            if study.scenes[scene].recording.free_datum {
                let readings = observations::part_readings(&study, scene, &course);
                study.scenes[scene].lie = Some(Lie::of(&readings, study.scenes[scene].is_probed()));
            }
            study.scenes[scene].returns = Returns::new(&study, scene, &course.shown);
            study.scenes[scene].last_course = LastCourse::default();
        }
        study
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

impl<'a> Scene<'a> {
    fn new(
        recording: &'a Recording,
        equations: &Equations,
        calibration: Option<&Calibration>,
        (sensors, loads): (&[String], &[(String, String)]),
        built: Arc<Built>,
    ) -> Self {
        let rows = recording.time.len();
        let loads = loads.iter().map(|(name, _)| column(&recording.loads, name, rows)).collect();
        let given = Given::new(recording, temperatures(recording, calibration, sensors), loads);
        let letters: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
        let targets = Targets::new(recording, &given, &letters);
        let rounded = Arc::clone(&given.rounded);
        Self {
            // Only the rows in which they have arrived are left.
            at_rest: !targets.axes.is_empty(),
            targets,
            last_course: LastCourse::default(),
            returns: Returns::default(),
            observed: observed(&given),
            corners: corners(recording, &given),
            leans: leans(recording, &given.programmed, &built.interpreter),
            lie: None,
            built,
            recording,
            given,
            channels: channels(recording, equations, &rounded),
            blocks: blocks(recording),
        }
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> usize {
        self.recording.time.len()
    }

    /// Whether it is read along normals, from one zero.
    pub(crate) fn is_probed(&self) -> bool {
        self.channels.iter().any(|channel| channel.kind == Kind::Normal)
    }

    /// Whether a channel is a drive's own feedback.
    pub(crate) fn has_drives(&self) -> bool {
        self.channels.iter().any(|channel| !channel.kind.outside())
    }

    /// Whether nothing is read off a row, whatever stands in it.
    pub(crate) fn left_out(&self, row: usize) -> bool {
        self.corners[row] || self.targets.on_the_way.get(row) == Some(&true)
    }

    /// Whether rows are so far apart that what a position loop does is over before the next.
    pub(crate) fn sparse(&self) -> bool {
        self.given.step > SPARSE
    }

    /// For each row whether it is fitted, and not held out.
    pub(crate) fn fitted_rows(&self) -> Vec<bool> {
        let mut fitted = vec![true; self.rows()];
        for block in self.blocks.iter().filter(|block| block.held_out) {
            fitted[block.rows.clone()].fill(false);
        }
        fitted
    }

    /// The runs in order of their first rows.
    pub(crate) fn run_numbers(&self) -> Vec<i64> {
        self.recording.run_numbers()
    }
}

fn corners(recording: &Recording, given: &Given) -> Vec<bool> {
    let rows = recording.time.len();
    let any = |each: &dyn Fn(usize, &[f64]) -> Vec<bool>, most: usize| {
        let mut marked = vec![false; rows];
        for (axis, position) in given.programmed.iter().enumerate() {
            marked.iter_mut().zip(each(axis, position)).for_each(|(mark, here)| *mark |= here);
        }
        // A path of such rows only is one that was recorded so; nothing would be left.
        if marked.iter().filter(|mark| **mark).count() > rows / most { vec![false; rows] } else { marked }
    };
    let at_corners = |axis: usize, position: &[f64]| {
        let of = if given.rounded[axis] > 0.0 { beside_reversals } else { behind_corners };
        of(&recording.time, &given.legs, position)
    };
    let mut corners = any(&at_corners, MOST_CORNERS);
    if given.step > SPARSE {
        let turns = any(&|_, position| unseen_turns(&given.legs, position), MOST_TURNS);
        corners.iter_mut().zip(turns).for_each(|(corner, turn)| *corner |= turn);
    }
    corners
}

/// The time of all steps that are no gaps.
fn observed(given: &Given) -> f64 {
    let longest = GAP * given.step;
    given.time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step <= longest).sum()
}

/// One row in so many may lie behind a corner, and one in so many where an axis may have turned unseen.
const MOST_CORNERS: usize = 20;
const MOST_TURNS: usize = 3;

/// A ballbar that leans less than this share of its length into a direction shows nothing of it.
const LEANS: f64 = 0.02;

fn leans(recording: &Recording, programmed: &[Shared], interpreter: &Interpreter) -> [bool; 3] {
    let Instrument::Ballbar { center, radius } = recording.instrument else { return [true; 3] };
    let positions: Vec<&[f64]> = programmed.iter().map(|position| &**position).collect();
    let nominal = interpreter.nominal_columns(&positions);
    [0, 1, 2].map(|d| nominal[d].iter().any(|place| (place - center[d]).abs() > LEANS * radius))
}

/// A channel by name with its gaps bridged; NaN everywhere where it was not recorded.
fn column(channels: &[crate::recording::Named], name: &str, rows: usize) -> Vec<f64> {
    let channel = channels.iter().find(|channel| channel.name == name);
    channel.map_or_else(|| vec![f64::NAN; rows], |channel| bridged(&channel.values))
}

/// Gaps bridged by straight lines over rows, and held at the ends: temperatures and loads change slowly between samples.
fn bridged(values: &[f64]) -> Vec<f64> {
    let mut bridged = values.to_vec();
    let mut last: Option<usize> = None;
    for row in 0..bridged.len() {
        if !values[row].is_finite() {
            continue;
        }
        let from = last.map_or(0, |last| last + 1);
        let start = last.map_or(values[row], |last| values[last]);
        let span = crate::number(row - from + 1);
        for (step, gap) in (from..row).enumerate() {
            bridged[gap] = start + (values[row] - start) * crate::number(step + 1) / span;
        }
        last = Some(row);
    }
    if let Some(last) = last {
        let held = values[last];
        bridged[last..].fill(held);
    }
    bridged
}

/// The temperatures of all sensors of the study, the calibration's derived ones worked out row by row.
fn temperatures(
    recording: &Recording,
    calibration: Option<&Calibration>,
    sensors: &[String],
) -> Vec<Vec<f64>> {
    let rows = recording.time.len();
    let mut columns: Vec<Vec<f64>> =
        sensors.iter().map(|name| column(&recording.temperatures, name, rows)).collect();
    if let Some(calibration) = calibration {
        let inputs = columns.clone();
        let mut readings = SensorReadings::new(&calibration.sensors);
        for row in 0..rows {
            let now = readings.update(|sensor| inputs[sensor][row]);
            for (column, value) in columns.iter_mut().zip(now) {
                column[row] = *value;
            }
        }
    }
    columns
}

/// What was observed. `rounded` are the steps of the commands: their rounding is noise of what is predicted.
fn channels<'a>(recording: &'a Recording, equations: &Equations, rounded: &[f64]) -> Vec<Channel<'a>> {
    let mut channels = Vec::new();
    let mut add = |name: String, kind: Kind, values: &'a [f64]| {
        let predicted = rounded.iter().enumerate().filter(|(axis, _)| match kind {
            Kind::Drive(own) | Kind::Stage(own) => *axis == own,
            // How far an axis moves the tip depends on the machine; a slide does it one to one.
            _ => equations.axes.get(*axis).is_some_and(|axis| !axis.rotary) && !kind.angular(equations),
        });
        let predicted = predicted.map(|(_, step)| rounded::deviation(*step));
        let rounding = predicted.fold(noise::rounding(values), f64::hypot);
        channels.push(Channel { name, kind, values, rounding, returning: Vec::new() });
    };
    for (direction, values) in recording.measured.iter().enumerate() {
        if let Some(values) = values {
            let letter = ["x", "y", "z"][direction];
            add(format!("measured.{letter}"), Kind::Tip(direction), values);
        }
    }
    if let Some(values) = &recording.deviation {
        let kind = match &recording.instrument {
            Instrument::Position | Instrument::Probe => Kind::Normal,
            Instrument::Ballbar { center, radius } => Kind::Radius { center: *center, radius: *radius },
            Instrument::Linear(line) | Instrument::Straightness(line) => Kind::Along(line.direction),
            Instrument::Angular { about, .. } => Kind::Turn(*about),
        };
        add("deviation".to_owned(), kind, values);
    }
    for (axis, known) in recording.axes.iter().enumerate() {
        let letter = equations.axes.get(axis).map(|axis| axis.letter.to_lowercase()).unwrap_or_default();
        // What an axis was measured by cannot be its position as well.
        if let Some(values) = &known.measured
            && (known.command.is_some() || known.actual.is_some())
        {
            add(format!("measured.{letter}"), Kind::Stage(axis), values);
        }
        if let (Some(values), Some(_)) = (&known.actual, &known.command) {
            add(format!("actual.{letter}"), Kind::Drive(axis), values);
        }
    }
    channels
}

/// The step between rows, s, from which on a recording is sparse: the slowest loops settle within it.
const SPARSE: f64 = 0.2;

/// How many blocks the rows that are fitted are cut into, at least.
const BLOCKS: usize = 12;
/// The fewest rows of a block.
const BLOCK_ROWS: usize = 8;
/// One block in so many is held out where the recording names no runs for it.
const HELD_OUT_EVERY: usize = 4;

/// Runs cut into blocks; those of held-out runs, or else one of every four blocks, are held out.
fn blocks(recording: &Recording) -> Vec<Block> {
    let runs = recording.runs();
    let several = runs.len() > 1;
    let pieces = BLOCKS.div_ceil(runs.len().max(1)).max(2);
    let mut blocks = Vec::new();
    for (rows, run) in runs {
        let pieces = pieces.min(rows.len() / BLOCK_ROWS).max(1);
        let bounds = |piece: usize| rows.start + rows.len() * piece / pieces;
        blocks.extend((0..pieces).map(|piece| Block {
            rows: bounds(piece)..bounds(piece + 1),
            run,
            held_out: recording.holdout.as_ref().is_some_and(|held| held.contains(&run)),
        }));
    }
    if recording.holdout.is_none() && blocks.len() >= HELD_OUT_EVERY {
        // Where runs have whole groups of blocks, another one each time: what comes round with every run would hold out the
        // same quadrant for ever.
        let turn = usize::from(pieces.is_multiple_of(HELD_OUT_EVERY) && several);
        for (group, blocks) in blocks.chunks_mut(HELD_OUT_EVERY).enumerate() {
            if let Some(block) = blocks.get_mut((HELD_OUT_EVERY / 2 + turn * group) % HELD_OUT_EVERY) {
                block.held_out = true;
            }
        }
    }
    blocks
}
