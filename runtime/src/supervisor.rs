//! Supervision: what stands between the compensator and the drives of a running machine.
//!
//! In: a [`Sample`] each servo cycle, sensors that fall silent and refusals among them. Out: a command whose correction
//! never jumps because something was switched, lost or found again. It exists because a [`Compensator`] answers each
//! sample by itself: right for a table of points, and a blow to a spindle where one bad reading takes 50 um away at once.

mod correction;
mod sensors;

use self::correction::Correction;
use self::sensors::{Heard, Sensors};
use super::real::Real;
use super::{Compensator, ErrorMotion, ErrorMotions, Kinematics, Outcome, Refusal, Sample, SetupError};

pub use self::correction::AxisMemory;

/// How the correction goes from one value to another where the machine's motion is not the cause.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Transition {
    /// Greatest change of the correction per second, as a length over all slides in mm/s, whatever causes it: a reversal,
    /// a step of a table, a switch; none: no limit. With 0 or NaN the correction stays as it is.
    pub rate: Option<Real>,
    /// The same for rotary axes that correct their own angle or the direction of the tool, over all of them, in rad/s.
    pub rotation_rate: Option<Real>,
    /// How long the last reading of a sensor that fell silent is held, in s. With NaN it is not held.
    pub hold: Real,
    /// The time over which a correction fades in or out after a switch, a refusal, the loss or the return of a sensor,
    /// in s. With 0, a negative one or NaN it jumps.
    pub fade: Real,
}

impl Default for Transition {
    /// No limit of the rate, 1 s held, 1 s to fade.
    fn default() -> Self {
        Self { rate: None, rotation_rate: None, hold: 1.0, fade: 1.0 }
    }
}

/// The storage of a supervisor, borrowed from the caller.
#[derive(Debug)]
pub struct Memory<'a> {
    /// One for each axis: default at the first start; what an earlier supervisor left lets a new one, with a new
    /// calibration say, take over without a jump.
    pub axes: &'a mut [AxisMemory],
    /// One number for each sensor, [`Compensator::sensors`]; what it holds before does not matter.
    pub temperature: &'a mut [Real],
    /// One number for each sensor; what it holds before does not matter.
    pub silence: &'a mut [Real],
}

/// What a supervisor does with the correction.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum State {
    /// The compensator is switched on and sure of its correction.
    Active,
    /// The same, with the last reading of a sensor that is silent.
    Holding {
        /// Index of the sensor that has been silent longest.
        sensor: usize,
    },
    /// A sensor has been silent for longer than it may be: the correction fades out, or has faded out.
    Lost {
        /// Index of the sensor that has been silent longest.
        sensor: usize,
    },
    /// The compensator refused the sample: the correction fades out, or has faded out.
    Refused,
    /// The compensator is switched off: the correction fades out, or has faded out.
    Off,
}

impl State {
    /// Whether the correction of the compensator is wanted.
    const fn is_active(self) -> bool {
        matches!(self, Self::Active | Self::Holding { .. })
    }
}

/// What was done in one cycle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Cycle {
    /// What the compensator found for the sample, with the last reading in place of a silent sensor's.
    pub outcome: Result<Outcome, Refusal>,
    /// What is done with it.
    pub state: State,
    /// Whether the correction is still on its way to what the state asks for. [`Outcome::remaining`] is that of its end.
    pub settling: bool,
    /// Length of the correction made in this cycle over all slides, in mm.
    pub correction: Real,
}

/// Runs a [`Compensator`] cycle by cycle so that its correction never jumps.
///
/// The correction follows the compensator's exactly while nothing is switched. Where compensation is switched on or off,
/// where a sample is refused or taken again, where a sensor is lost or returns, the difference between the correction made
/// and the one now wanted fades over [`Transition::fade`]. A reading that is not finite is a silent sensor: its last value
/// is held for [`Transition::hold`], then compensation fades out until it speaks again. On top of that the correction
/// changes by no more than [`Transition::rate`] and [`Transition::rotation_rate`], and stays within its [`Limits`](super::Limits).
///
/// ```
/// # use abbe_runtime::*;
/// # struct Slide;
/// # impl Kinematics for Slide {
/// #     fn axes(&self) -> usize { 1 }
/// #     fn travels(&self) -> &[usize] { &[] }
/// #     fn motions(&self) -> usize { 1 }
/// #     fn error(&self, _: &[f64], _: &[f64], motions: &[f64]) -> [f64; 3] { [motions.first().copied().unwrap_or(f64::NAN), 0.0, 0.0] }
/// #     fn directions(&self, _: &[f64], directions: &mut [[f64; 3]]) { directions.fill([1.0, 0.0, 0.0]); }
/// # }
/// // A slide that stands 20 um too far.
/// let terms = [Term::Constant { value: 0.020 }];
/// let motions = [ErrorMotion { terms: &terms }];
/// let (mut states, mut directions, mut values) = ([TermState::default()], [[0.0; 3]], [0.0]);
/// let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
/// let compensator = Compensator::new(&Slide, &motions, &mut states, work)?;
/// let mut axes = [AxisMemory::default()];
/// let memory = Memory { axes: &mut axes, temperature: &mut [], silence: &mut [] };
/// let mut supervisor = Supervisor::new(compensator, memory)?;
/// supervisor.transition = Transition { fade: 0.010, ..Transition::default() };
///
/// let (position, direction) = ([100.0], [Direction::Positive]);
/// let sample = Sample { position: &position, travel: &[], direction: &direction, velocity: &[], temperature: &[], time_step: 0.001 };
/// let mut command = [0.0];
/// // Ten cycles of 1 ms take the correction in, 2 um each.
/// for cycle in 1..=10 {
///     let done = supervisor.cycle(&sample, &mut command);
///     assert!((command[0] - (100.0 - 0.002 * f64::from(cycle))).abs() < 1e-9);
///     assert_eq!(done.settling, cycle < 10);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Supervisor<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized = [ErrorMotion<'a>]> {
    /// The compensator, with its switch and its limits.
    pub compensator: Compensator<'a, K, M>,
    /// How the correction changes.
    pub transition: Transition,
    sensors: Sensors<'a>,
    correction: Correction<'a>,
}

impl<'a, K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Supervisor<'a, K, M> {
    /// A supervisor of a compensator, whose correction begins with what the memory of the axes holds.
    ///
    /// # Errors
    /// Tells the first slice of a wrong length.
    pub fn new(compensator: Compensator<'a, K, M>, memory: Memory<'a>) -> Result<Self, SetupError> {
        let sensors = compensator.sensors();
        for (slice, expected, found) in [
            ("memory.axes", compensator.axes(), memory.axes.len()),
            ("memory.temperature", sensors, memory.temperature.len()),
            ("memory.silence", sensors, memory.silence.len()),
        ] {
            if expected != found {
                return Err(SetupError::Length { slice, expected, found });
            }
        }
        let correction =
            Correction::new(memory.axes, compensator.following(), |axis| compensator.turns(axis));
        Ok(Self {
            compensator,
            transition: Transition::default(),
            sensors: Sensors::new(memory.temperature, memory.silence),
            correction,
        })
    }

    /// What is remembered of each axis, with the correction made in the last cycle.
    #[must_use]
    pub const fn axes(&self) -> &[AxisMemory] {
        self.correction.axes()
    }

    /// Forgets what the terms and the sensors remember, as if the machine had just started; the correction made stays, and
    /// goes from there to what is wanted next.
    pub fn restart(&mut self) {
        self.compensator.restart();
        self.sensors.restart();
        self.correction.switch();
    }

    /// Lets the correction fade from the one made last to what is wanted from the next cycle on: after another tool has come, say.
    pub const fn switch(&mut self) {
        self.correction.switch();
    }

    /// One cycle: writes to `out` the command for this sample.
    ///
    /// A position that is not finite is refused as a whole and passes unchanged, while the correction of the other axes
    /// fades out. Where the time step is negative or not finite no time goes on, and the correction stays as it is.
    /// Nothing is written, and no time goes on, where `out` or the position has not one entry for each axis.
    pub fn cycle(&mut self, sample: &Sample<'_>, out: &mut [Real]) -> Cycle {
        if self.compensator.check_lengths(sample, out).is_err() {
            // It refuses before it writes anything, and forgets what it found in the cycle before.
            let outcome = self.compensator.compensate(sample, out);
            let correction = self.correction.length();
            return Cycle { outcome, state: State::Refused, settling: false, correction };
        }
        let time_step = if sample.time_step.is_finite() { sample.time_step.max(0.0) } else { 0.0 };
        let heard = self.sensors.hear(sample.temperature, time_step);
        let held = Sample { temperature: self.sensors.readings(sample.temperature), ..*sample };
        let outcome = self.compensator.compensate(&held, out);
        let state = self.state(&outcome, heard);
        if heard.returned {
            self.correction.switch();
        }
        let limits = self.compensator.limits;
        self.correction.set_wanted(sample.position, out, state.is_active());
        let settling = self.correction.follow(&self.transition, &limits, time_step);
        self.correction.write(sample.position, out, settling || !state.is_active());
        Cycle { outcome, state, settling, correction: self.correction.length() }
    }

    /// What is to be done with the correction.
    fn state(&self, outcome: &Result<Outcome, Refusal>, heard: Heard) -> State {
        if !self.compensator.enabled {
            return State::Off;
        }
        match heard.silent {
            _ if outcome.is_err() => State::Refused,
            None => State::Active,
            // Also at NaN, which no comparison lets through.
            Some((sensor, silence)) if silence <= self.transition.hold => State::Holding { sensor },
            Some((sensor, _)) => State::Lost { sensor },
        }
    }
}
