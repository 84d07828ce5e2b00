//! Evaluation: the field's standard figures, from a recording.
//!
//! In: the equations of a machine and a recording of it ([`recording`]). Out: an [`Evaluation`]: positioning of
//! linear and rotary axes and of diagonals from stations approached from both sides (ISO 230-2), and circular, bidirectional
//! circular and radial deviations (ISO 230-4); each figure with what it rests on, or why the recording cannot give it.
//!
//! It exists because these figures are what machines are bought, accepted and compared by. It models nothing: no error motion
//! and no term is fitted, and a calibration serves for the machine's constants only.
//!
//! ```text
//! recording -> course: commands, nominal tip -> stations: straight lines, approaches -> positioning -> iso230_2: figures
//!                                            -> circles: traces -> circular: figures (fit: centre and zone)
//! ```
//!
//! Everything is in mm, rad and s.

mod circles;
mod circular;
mod course;
mod diagonals;
mod figure;
pub mod fit;
pub mod iso230_2;
mod positioning;
pub mod report;
mod stations;

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;
use recording::{Instrument, Recording};

pub use circular::{Circle, Pair, Point, Sense, Trace, TraceFigures};
pub use diagonals::Diagonals;
pub use figure::{Figure, Given, Rests, Sensor, Unit};
pub use positioning::{Cycle, Kind, Positioning, Zero};

use course::Course;

/// What an evaluation starts from.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The error equations of the machine.
    pub equations: &'a Equations,
    /// The calibration, for the machine's constants. Without it the zero of measured positions is not known.
    pub calibration: Option<&'a Calibration>,
    /// The recording.
    pub recording: &'a Recording,
}

/// The figures of one recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// The recording file, for people.
    pub file: String,
    /// The recording's title.
    pub title: Option<String>,
    /// The machine's name.
    pub machine: String,
    /// The instrument, as recording files call it.
    pub instrument: &'static str,
    /// When it was recorded, where its file says so.
    pub date: Option<String>,
    /// The temperatures while it was recorded: each sensor with its least and its greatest value, degC.
    pub temperatures: Vec<(String, [f64; 2])>,
    /// Positioning along each straight line with stations, in order of the recording.
    pub positioning: Vec<Positioning>,
    /// What the diagonals give together, where there are any.
    pub diagonals: Option<Diagonals>,
    /// The circles, one for each centre, radius and feed.
    pub circles: Vec<Circle>,
    /// What the recording cannot give at all.
    pub not_given: Vec<NotGiven>,
}

/// A group of figures that a recording cannot give.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NotGiven {
    /// What: `positioning of X`.
    pub what: String,
    /// Why.
    pub because: String,
}

impl NotGiven {
    fn new(what: impl Into<String>, because: impl Into<String>) -> Self {
        Self { what: what.into(), because: because.into() }
    }
}

impl Evaluation {
    /// All figures, of lines, diagonals and circles.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        let lines = self.positioning.iter().flat_map(|line| &line.figures);
        let diagonals = self.diagonals.iter().flat_map(|diagonals| &diagonals.figures);
        lines.chain(diagonals).chain(self.circles.iter().flat_map(|circle| &circle.figures))
    }

    /// Takes off what needs times, where the recording has none and its rows were taken in their order: circles, whose feed and whose
    /// runs are not known.
    #[must_use]
    pub fn in_order(mut self) -> Self {
        if !self.circles.is_empty() {
            self.circles.clear();
            let because = "it has no channel `time`, so its rows are readings at rest";
            self.not_given.push(NotGiven::new("circular deviations", because));
        }
        let note = "The recording has no times. Its rows were taken in order, each as a reading at rest.";
        self.positioning.iter_mut().for_each(|line| line.notes.push(note.to_owned()));
        self
    }

    /// Whether any figure could be given.
    pub fn gives_any(&self) -> bool {
        self.figures().any(|figure| figure.value.number().is_some())
    }
}

/// Evaluates a recording. Runs that the recording holds out for a diagnosis are evaluated with the others: nothing is fitted
/// to any of them.
pub fn evaluate(inputs: &Inputs<'_>) -> Evaluation {
    let mut evaluation = Evaluation {
        file: inputs.recording.file.clone(),
        title: inputs.recording.title.clone(),
        date: inputs.recording.date.map(|date| date.day()),
        machine: inputs.equations.machine.clone(),
        instrument: instrument(&inputs.recording.instrument),
        temperatures: temperatures(inputs.recording),
        ..Evaluation::default()
    };
    let course = match Course::of(inputs) {
        Ok(course) => course,
        Err(because) => {
            evaluation.not_given.push(NotGiven::new("all figures", because));
            return evaluation;
        }
    };
    let traces = circles::traces(&course);
    let travelled = stations::travelled(&course, &traces);
    (evaluation.circles, evaluation.not_given) = circular::evaluate(&course, traces);
    let (lines, mut without) = positioning::evaluate(&course, travelled);
    evaluation.diagonals = diagonals::evaluate(&lines);
    evaluation.positioning = lines;
    evaluation.not_given.append(&mut without);
    if evaluation.circles.is_empty() && evaluation.positioning.is_empty() && evaluation.not_given.is_empty() {
        evaluation.not_given.push(NotGiven::new(
            "all figures",
            "the path has neither stations on a straight line nor circles of two slides",
        ));
    }
    evaluation
}

/// Evaluates the readings of a positioning test that are there already, by targets.
pub fn of_cycle(cycle: Cycle) -> Evaluation {
    let (file, machine, date) = (cycle.file.clone(), cycle.machine.clone(), cycle.date.clone());
    let mut evaluation = Evaluation { file, machine, date, instrument: "laser", ..Evaluation::default() };
    match positioning::of_cycle(cycle) {
        Ok(line) => evaluation.positioning.push(line),
        Err((what, because)) => evaluation.not_given.push(NotGiven::new(what, because)),
    }
    evaluation
}

/// The range of each temperature that was read.
fn temperatures(recording: &Recording) -> Vec<(String, [f64; 2])> {
    let range = |sensor: &recording::Named| {
        let there = || sensor.values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (there().fold(f64::INFINITY, f64::min), there().fold(f64::NEG_INFINITY, f64::max));
        (low <= high).then(|| (sensor.name.clone(), [low, high]))
    };
    recording.temperatures.iter().filter_map(range).collect()
}

/// The name of an instrument in recording files.
fn instrument(instrument: &Instrument) -> &'static str {
    match instrument {
        Instrument::Position => "position",
        Instrument::Ballbar { .. } => "ballbar",
        Instrument::Linear(_) => "linear",
        Instrument::Straightness(_) => "straightness",
        Instrument::Angular { .. } => "angular",
        Instrument::Probe => "probe",
    }
}

/// A count as a number.
#[expect(clippy::cast_precision_loss, reason = "counts of readings are far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
