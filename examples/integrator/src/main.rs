//! A controller in small: a lathe that stands at a few positions for some servo cycles each, compensated and supervised.
//!
//! In: the equations and numbers that `build.rs` compiled from `lathe.yaml` and `lathe-7.yaml`. Out: a line for each
//! position. But for printing, everything here would run on a controller: no allocation, no file, no panic.

use std::error::Error;

use abbe_runtime::{AxisMemory, Compensator, DirectionTracker, Memory, Sample, Supervisor, TermState, Work};
use lathe::{Axes, Calibration, Motions};

/// The machine of `lathe.yaml` with the calibration of `lathe-7.yaml`.
#[expect(dead_code, reason = "the compiled machine offers more than this program asks for")]
mod lathe {
    include!(concat!(env!("OUT_DIR"), "/lathe.rs"));
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut states = [TermState::default(); Calibration::TERMS];
    let (mut directions, mut values) = ([[0.0; 3]; Axes::NAMES.len()], [0.0; Motions::NAMES.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let mut compensator =
        Compensator::with_calibration(&Calibration::MACHINE, &Calibration, &mut states, work)?;
    compensator.limits = Calibration::LIMITS;
    let mut axes = [AxisMemory::default(); Axes::NAMES.len()];
    let memory = Memory { axes: &mut axes, temperature: &mut [], silence: &mut [] };
    let mut supervisor = Supervisor::new(compensator, memory)?;
    supervisor.transition = Calibration::TRANSITION;

    let mut trackers = [DirectionTracker::new(0.001); 2];
    for target in [[10.0, 0.0], [40.0, 150.0], [40.0, 300.0], [25.0, 300.0]] {
        let [x, z] = target;
        let [track_x, track_z] = &mut trackers;
        let sample = Sample {
            position: &target,
            travel: &[],
            direction: &[track_x.update(x), track_z.update(z)],
            velocity: &[],
            temperature: &[],
            time_step: 0.001,
        };
        let mut command = [0.0; 2];
        let mut done = supervisor.cycle(&sample, &mut command);
        while done.settling {
            done = supervisor.cycle(&sample, &mut command);
        }
        let [error_x, _, error_z] = done.outcome?.error.map(|error| error * 1000.0);
        let [command_x, command_z] = command;
        println!(
            "wanted X{x:7.3} Z{z:7.3}  error {error_x:6.2} {error_z:6.2} um  commanded X{command_x:8.4} Z{command_z:8.4}"
        );
    }
    Ok(())
}
