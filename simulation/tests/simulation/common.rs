//! What the tests share: machines and calibrations from text, and paths.

use abbe_simulation::path::{Shape, Stroke};
use abbe_simulation::{Instrument, Measurement, Path, Plant, Scenario, names_of};
use model_dsl::calibration::{self, Calibration, MachineNames};
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::machine::{self, Machine};
use model_dsl::source::{SourceFile, Span};
use model_dsl::yaml;

/// A machine with its numbers.
pub(crate) struct Built {
    pub(crate) machine: Machine,
    pub(crate) names: MachineNames,
    pub(crate) calibration: Calibration,
}

impl Built {
    /// The machine of a topology word; `errors` is the block of that name, in one line.
    pub(crate) fn of(word: &str, errors: &str) -> Self {
        let mut findings = Diagnostics::new();
        let machine = machine::from_word(word, Span::default(), &mut findings).unwrap();
        let constants = match machine.axes().len() {
            1 => "",
            _ => "constants: {Xt: 0 mm, Yt: 0 mm, Zt: 120 mm}\n",
        };
        Self::with(machine, &format!("{constants}errors: {errors}\n"))
    }

    /// A machine with the rest of its calibration.
    pub(crate) fn with(machine: Machine, rest: &str) -> Self {
        let names = names_of(&machine);
        let text = format!("calibration: 1\nmachine: {}\n{rest}", machine.name);
        let source = SourceFile::new("calibration.yaml", text);
        let mut findings = Diagnostics::new();
        let tree = yaml::read(&source, &mut findings).unwrap();
        let calibration = calibration::read(&tree, &names, &mut findings);
        let Some(calibration) = calibration else { panic!("{}", render(&source, &findings, false)) };
        Self { machine, names, calibration }
    }

    pub(crate) fn plant(&self) -> Plant {
        Plant::new(&self.machine, &self.names, &self.calibration).unwrap()
    }
}

/// A plant of a topology word.
pub(crate) fn plant(word: &str, errors: &str) -> Plant {
    Built::of(word, errors).plant()
}

/// A path of one run.
pub(crate) fn path(shape: Shape, feed: f64, rate: f64) -> Path {
    Path { at: Vec::new(), shape, feed, acceleration: None, rate, runs: 1, pause: 1.0 }
}

/// There and back along one axis.
pub(crate) fn line(axis: usize, from: f64, to: f64) -> Shape {
    Shape::Line { strokes: vec![Stroke { axis, from, to }], back: true, overrun: 0.0, stations: None }
}

/// A circle in XY, counter-clockwise and back.
pub(crate) fn circle(radius: f64) -> Shape {
    Shape::Circle { plane: [0, 1], radius, start: 0.3, overshoot: 0.1, counterclockwise: vec![true, false] }
}

/// A recording without faults.
pub(crate) fn scenario(path: Path, instrument: Instrument) -> Scenario {
    Scenario {
        title: None,
        path,
        temperatures: Vec::new(),
        loads: Vec::new(),
        measurement: Measurement::perfect(instrument),
        holdout: Vec::new(),
    }
}
