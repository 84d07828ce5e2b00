//! What runs in a controller, as a library that holds nothing else: no standard library, no allocator.
//!
//! In: the machine that `build.rs` compiled, terms of every kind, read at run time and compiled in, a servo cycle. Out:
//! two exported functions, so that a linker keeps what a cycle needs and drops the rest. It exists to be looked into:
//! were there a way to panic in a cycle, the functions that panic would stand among the symbols of this library
//! (`./no-panic.sh`). With the feature `f32` all numbers have 32 bits, and it holds no operation on longer ones (`./no-double.sh`).
#![no_std]

use core::hint::black_box;
use core::panic::PanicInfo;

// All that a program has to say of its numbers.
#[cfg(not(feature = "f32"))]
use abbe_runtime as runtime;
#[cfg(feature = "f32")]
use abbe_runtime::single as runtime;

use runtime::{
    AxisMemory, Compensator, DirectionTracker, ErrorMotion, ErrorMotions, Input, Memory, Real, Sample,
    Supervisor, Table, Term, TermState, Transition, Values, Work, states_needed,
};

/// The five-axis machine with a swivelling head.
#[expect(dead_code, reason = "the compiled machine offers more than one cycle asks for")]
mod machine {
    include!(concat!(env!("OUT_DIR"), "/machine.rs"));
}

use machine::{Axes, Calibration, Constants, Machine, Motions, Sensors};

/// Room for the memories of all terms below.
const STATES: usize = 64;

/// Nothing calls this, which is what the library shows: it is here since the language asks for it.
#[panic_handler]
fn never(_: &PanicInfo<'_>) -> ! {
    loop {}
}

/// One servo cycle of a machine that has every kind of term; the optimiser knows nothing of any number or slice.
///
/// Returns the length of the correction in mm, -1 where the set-up is refused.
#[unsafe(no_mangle)]
pub extern "C" fn cycle(time_step: Real, temperature: Real) -> Real {
    let nodes = black_box([0.0, 10.0, 30.0]);
    let curve = black_box([0.0, 1e-3, 2e-3]);
    let directed = Values::Directed { forward: black_box(&curve), reverse: black_box(&curve) };
    let (Ok(even), Ok(uneven)) = (
        Table::uniform(0.0, black_box(10.0), Values::Both(black_box(&curve))),
        Table::at(black_box(&nodes), directed),
    ) else {
        return -1.0;
    };
    let axis = black_box(0);
    let sensor = black_box(0);
    let terms = black_box([
        Term::Constant { value: 1e-3 },
        Term::Polynomial { input: Input::Axis(axis), coefficients: &curve },
        Term::Polynomial { input: Input::Sensor(sensor), coefficients: &curve },
        Term::Coupling { axis, coefficients: &curve },
        Term::Table { axis, table: even },
        Term::Table { axis, table: uneven },
        Term::Backlash { axis, lost_motion: 8e-3, wind_up: 1.0, ramp: 0.1 },
        Term::Cyclic { axis, period: 10.0, amplitude: 1e-3, phase: 0.1 },
        Term::Expansion { axis, sensor, coefficient: 1e-5, reference: 20.0 },
        Term::Growth { sensor, coefficient: 1e-3, reference: 20.0, time_constant: 600.0 },
        Term::Lag { axis, gain: 30.0 },
    ]);
    let mut motions = [ErrorMotion::default(); Motions::NAMES.len()];
    if let Some(first) = motions.first_mut() {
        *first = ErrorMotion { terms: black_box(&terms) };
    }
    let mut states = [TermState::default(); STATES];
    let Some(states) = states.get_mut(..states_needed(&motions)) else { return -1.0 };
    let machine = Machine { constants: Constants::from_array(black_box([100.0; Constants::NAMES.len()])) };
    supervised(&machine, black_box(&motions[..]), states, time_step, &[temperature])
}

/// The same cycle with the calibration that was compiled in.
#[unsafe(no_mangle)]
pub extern "C" fn cycle_compiled(time_step: Real, bed: Real, column: Real) -> Real {
    let mut states = [TermState::default(); Calibration::TERMS];
    let temperature = Sensors::new().update([bed, column]);
    supervised(&Calibration::MACHINE, &Calibration, &mut states, time_step, &temperature)
}

/// One cycle of a supervisor; the length of its correction.
fn supervised<M: ErrorMotions + ?Sized>(
    machine: &Machine,
    motions: &M,
    states: &mut [TermState],
    time_step: Real,
    temperature: &[Real],
) -> Real {
    let (mut directions, mut values) = ([[0.0; 3]; Axes::NAMES.len()], [0.0; Motions::NAMES.len()]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
    let Ok(compensator) = Compensator::with_calibration(machine, motions, states, work) else { return -1.0 };

    let mut axes = [AxisMemory::default(); Axes::NAMES.len()];
    let (mut readings, mut silence) = ([0.0; Sensors::NAMES.len()], [0.0; Sensors::NAMES.len()]);
    let sensors = compensator.sensors();
    let (Some(readings), Some(silence)) = (readings.get_mut(..sensors), silence.get_mut(..sensors)) else {
        return -1.0;
    };
    let memory = Memory { axes: black_box(&mut axes), temperature: readings, silence };
    let Ok(mut supervisor) = Supervisor::new(compensator, memory) else { return -1.0 };
    supervisor.transition = black_box(Transition { rate: Some(2.0), ..Transition::default() });
    let position = black_box([1.0; Axes::NAMES.len()]);
    let mut tracker = DirectionTracker::new(black_box(1e-3));
    let directions = [tracker.update(black_box(1.0)); Axes::NAMES.len()];
    let velocity = [0.0; Axes::NAMES.len()];
    let sample = Sample {
        position: black_box(&position),
        travel: black_box(&[]),
        direction: black_box(&directions),
        velocity: black_box(&velocity),
        temperature: black_box(temperature),
        time_step,
    };
    let mut command = [0.0; Axes::NAMES.len()];
    let done = supervisor.cycle(&sample, black_box(&mut command));
    black_box(command);
    done.correction
}
