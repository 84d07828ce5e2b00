//! A controller in small: a lathe that stands at a few positions for some servo cycles each, compensated and supervised.
//!
//! In: the equations that `build.rs` compiled from `lathe.yaml`, and a calibration written as constants.
//! Out: a line for each position. But for printing, everything here would run on a controller: no
//! allocation, no file, no panic.

use std::error::Error;

use abbe_runtime::{
    AxisMemory, Compensator, DirectionTracker, ErrorMotion, Input, Limits, Memory, Sample, Supervisor, Table,
    Term, TermState, Transition, Values, Work, states_needed,
};
use lathe::{Axes, Constants, Machine, Motions};

/// The machine of `lathe.yaml`.
#[expect(dead_code, reason = "the compiled machine offers more than this program asks for")]
mod lathe {
    include!(concat!(env!("OUT_DIR"), "/lathe.rs"));
}

/// Where `Sample` and `Term` find each axis: the order of `Axes::NAMES`.
const X: usize = 0;
const Z: usize = 1;

/// Positioning of X: 12 um/m of scale and 8 um of lost motion.
const EXX: [Term<'static>; 2] = [
    Term::Polynomial { input: Input::Axis(X), coefficients: &[0.0, 12e-6] },
    Term::Backlash { axis: X, lost_motion: 0.008, wind_up: 0.0, ramp: 0.0 },
];
/// X turned against Z by 30 urad.
const EB0X: [Term<'static>; 1] = [Term::Constant { value: 30e-6 }];
/// Yaw of the Z carriage every 100 mm, in rad.
const YAW: [f64; 4] = [0.0, 8e-6, 11e-6, 9e-6];

fn main() -> Result<(), Box<dyn Error>> {
    let machine = Machine { constants: Constants { xt: 60.0, zt: -90.0 } };
    let ebz = [Term::Table { axis: Z, table: Table::uniform(0.0, 100.0, Values::Both(&YAW))? }];
    // By name, so that another machine file may bring the motions in another order.
    let motions = Motions::NAMES.map(|name| match name {
        "EXX" => ErrorMotion { terms: &EXX },
        "EBZ" => ErrorMotion { terms: &ebz },
        "EB0X" => ErrorMotion { terms: &EB0X },
        _ => ErrorMotion::default(),
    });
    let mut states = [TermState::default(); EXX.len() + EB0X.len() + 1];
    debug_assert_eq!(states.len(), states_needed(&motions));
    let (mut directions, mut values) = ([[0.0; 3]; Axes::NAMES.len()], [0.0; Motions::NAMES.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let mut compensator = Compensator::new(&machine, &motions, &mut states, work)?;
    compensator.limits = Limits { compensation: Some(0.1) };
    // Nothing moves at once: the correction changes by 2 mm/s at most, and fades within 10 ms when it is switched.
    let mut axes = [AxisMemory::default(); Axes::NAMES.len()];
    let memory = Memory { axes: &mut axes, temperature: &mut [], silence: &mut [] };
    let mut supervisor = Supervisor::new(compensator, memory)?;
    supervisor.transition = Transition { rate: Some(2.0), fade: 0.010, ..Transition::default() };

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
