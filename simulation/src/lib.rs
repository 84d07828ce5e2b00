//! Abbe's exact machine in numbers: controller, plant, instruments.
//!
//! ```text
//! path -> timeline -> commands -> plant (position loops, terms, finite rotations) -> poses -> instrument -> recording
//! ```
//!
//! In: a machine, the numbers of a calibration, a path and an instrument. Out: what a recording of that machine would
//! hold. It exists so that everything that the compiler derives and the diagnosis claims can be held against a machine
//! that was not made from it: nothing here is linearised, and nothing of the compiler's equations is used. What is shared is
//! the reading of files: the validated chain and the terms with their numbers.
//!
//! Everything is in mm, rad, s, degC and the units of the loads. Positions are those of the nominal tool tip in the frame of
//! the part, tool offset included.
//!
//! ```
//! use model_dsl::{calibration, diagnostic::Diagnostics, machine, source::{SourceFile, Span}, yaml};
//! use abbe_simulation::{Instrument, Measurement, Plant, names_of};
//!
//! let mut findings = Diagnostics::new();
//! let stage = machine::from_word("FX", Span::default(), &mut findings).ok_or("no machine")?;
//! let text = "calibration: 1\nmachine: FX\nerrors: {EXX: [{backlash: {lost_motion: 10 um}}]}\n";
//! let tree = yaml::read(&SourceFile::new("stage.yaml", text), &mut findings).ok_or("no YAML")?;
//! let names = names_of(&stage);
//! let numbers = calibration::read(&tree, &names, &mut findings).ok_or("no calibration")?;
//! let plant = Plant::new(&stage, &names, &numbers)?;
//!
//! let commands = abbe_simulation::Commands {
//!     time: vec![0.0, 1.0, 2.0],
//!     run: vec![1; 3],
//!     positions: vec![vec![0.0, 50.0, 40.0]],
//!     ..Default::default()
//! };
//! let measurement = Measurement::perfect(Instrument::position());
//! let recording = abbe_simulation::replay(&plant, &commands, &measurement)?;
//! // Forwards it lags by half the lost motion, backwards it stays ahead by the other half.
//! assert!((recording.readings[0].values[1] - 49.995).abs() < 1e-12);
//! assert!((recording.readings[0].values[2] - 40.005).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod commands;
mod datum;
pub mod file;
mod instrument;
mod legs;
pub mod noise;
pub mod path;
pub mod picture;
mod plant;
mod simulate;
mod surroundings;
pub mod write;

pub use commands::{Column, Commands};
pub use datum::Datum;
pub use instrument::{Channel, Instrument, Normal};
pub use path::Path;
pub use plant::{DEADBAND, Effect, History, Moment, Plant, PlantError, Pose, Servo, State, names_of};
pub use simulate::{Measurement, Reading, Scenario, Simulated, SimulationError, replay, simulate};
pub use surroundings::{Load, Pulses, Swing, Temperature};
