//! What tests of this crate share: recordings of simulated machines. In: a machine, a path, noise. Out: a recording ready for effects.

use model_dsl::calibration::Calibration;
use model_dsl::compile_word;
use model_dsl::diagnostic::Diagnostics;
use simulation::noise::Noise;
use simulation::path::{Path, Shape, Stroke};
use simulation::{Instrument, Measurement, Plant, Scenario, simulate};

use crate::injection::base::Base;
use crate::made;

/// Of a machine whose tool offsets are 100 mm: passes of X over 100 mm there and back in three runs at 50 mm/s and 60 Hz, read in these directions with white noise.
pub(crate) fn passes_of_x(word: &str, directions: [bool; 3], noise: f64, seed: u64) -> Base {
    let compiled = compile_word(word, &mut Diagnostics::new()).unwrap();
    let names = compiled.equations.names();
    let calibration = Calibration::new(word, vec![100.0; names.constants.len()]);
    let plant = Plant::new(&compiled.machine, &names, &calibration).unwrap();
    let strokes = vec![Stroke { axis: names.axis("X").unwrap(), from: 0.0, to: 100.0 }];
    let instrument = Instrument::Position { directions, angles: Vec::new() };
    let scenario = Scenario {
        title: None,
        path: Path {
            at: vec![vec![0.0]; names.axes.len()],
            shape: Shape::Line { strokes, back: true, overrun: 0.0, stations: None },
            feed: 50.0,
            acceleration: None,
            rate: 60.0,
            runs: 3,
            pause: 1.0,
        },
        temperatures: Vec::new(),
        loads: Vec::new(),
        measurement: Measurement { noise: Noise::white(noise), seed, ..Measurement::perfect(instrument) },
        holdout: vec![3],
    };
    let recording = made::recording(simulate(&plant, &scenario).unwrap(), "passes of X").unwrap();
    Base::new("passes of X", compiled, Some(calibration), recording).unwrap()
}
