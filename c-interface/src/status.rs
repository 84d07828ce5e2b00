//! What a call of C is answered. In: what the supervisor did, or why it was not asked. Out: numbers for C. It exists because a
//! `Result` does not cross that border.

use abbe_runtime::{Cycle as Supervised, Refusal, State};

/// How a call ended: 0 or more where it was carried out, less than 0 where it was wrong and nothing was done.
#[repr(i32)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Status {
    /// Done, in every function but `abbe_update`.
    Done = 0,
    /// The correction is that of the model, or on its way to it.
    Active = 1,
    /// The same, with the last reading of a sensor that is silent.
    Holding = 2,
    /// A sensor has been silent for too long: the correction fades out, or has faded out.
    Lost = 3,
    /// The sample was refused, see `refused` of the cycle: the correction fades out, or has faded out.
    Refused = 4,
    /// Switched off: the correction fades out, or has faded out.
    Off = 5,
    /// A pointer that is needed is null.
    NullPointer = -1,
    /// As many positions as axes are needed, and as many temperatures as sensors.
    WrongLength = -2,
    /// A direction is neither +1, -1 nor 0; or an axis or a threshold is out of its range.
    OutOfRange = -3,
    /// The calibration cannot be used; the message says why.
    Calibration = -4,
    /// Another thread is in a call with this handle.
    Busy = -5,
    /// A fault of Abbe. It went no further than this call; the handle answers nothing else any more.
    Fault = -6,
}

impl Status {
    /// The status in words, for people who read a log.
    #[must_use]
    pub const fn text(self) -> &'static core::ffi::CStr {
        match self {
            Self::Done => c"done",
            Self::Active => c"active: the correction is that of the model, or on its way to it",
            Self::Holding => c"holding: active with the last reading of a silent sensor",
            Self::Lost => c"lost: a sensor has been silent for too long, the correction fades out",
            Self::Refused => c"refused: the sample has no correction, the present correction fades out",
            Self::Off => c"off: switched off, the correction fades out",
            Self::NullPointer => c"null pointer: a required pointer is null",
            Self::WrongLength => {
                c"wrong length: not one position for each axis, or one temperature for each sensor"
            }
            Self::OutOfRange => {
                c"out of range: a direction is not +1, -1 or 0, or there is no such axis or threshold"
            }
            Self::Calibration => c"calibration: the file cannot be used",
            Self::Busy => c"busy: another thread is in a call with this handle",
            Self::Fault => c"fault: a bug in Abbe",
        }
    }

    /// The status with this number.
    #[must_use]
    pub fn of(number: i32) -> Option<Self> {
        const ALL: [Status; 12] = [
            Status::Done,
            Status::Active,
            Status::Holding,
            Status::Lost,
            Status::Refused,
            Status::Off,
            Status::NullPointer,
            Status::WrongLength,
            Status::OutOfRange,
            Status::Calibration,
            Status::Busy,
            Status::Fault,
        ];
        ALL.into_iter().find(|status| *status as i32 == number)
    }
}

impl From<State> for Status {
    fn from(state: State) -> Self {
        match state {
            State::Active => Self::Active,
            State::Holding { .. } => Self::Holding,
            State::Lost { .. } => Self::Lost,
            State::Refused => Self::Refused,
            State::Off => Self::Off,
        }
    }
}

/// Why a sample was refused.
#[repr(i32)]
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refused {
    /// It was not.
    No = 0,
    /// A position, a temperature before its first reading, the time step or the error itself is not finite.
    NotFinite = 1,
    /// The time step is below zero.
    TimeStep = 2,
    /// The search for the command does not settle: the error changes about as fast as the position.
    NotConverging = 3,
    /// The correction is longer than the limit of the calibration, of slides or of rotary axes.
    OverLimit = 4,
    /// A length that does not fit: a fault of Abbe.
    Length = 5,
    /// In this pose axes move the tip in nearly the same direction: they would have to move more than a hundred times as far as it.
    NearSingular = 6,
    /// A motor does not stand where its axes put it.
    Motor = 7,
}

impl From<Refusal> for Refused {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::NotFinite => Self::NotFinite,
            Refusal::NegativeTimeStep { .. } => Self::TimeStep,
            Refusal::NotConverging { .. } | Refusal::AngleNotConverging { .. } => Self::NotConverging,
            Refusal::OverLimit { .. } | Refusal::OverRotationLimit { .. } => Self::OverLimit,
            Refusal::Length { .. } => Self::Length,
            Refusal::NearSingular { .. } => Self::NearSingular,
            Refusal::Motor { .. } => Self::Motor,
        }
    }
}

/// What was done in a cycle.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Cycle {
    /// Error of the tool tip relative to the part that the model predicts at the position, before compensation: X, Y, Z of
    /// the part's frame, actual minus commanded, mm; 0 where the sample was refused.
    pub error: [f64; 3],
    /// What the correction leaves of it at its end, mm: what no axis reaches, or all of it where nothing is corrected.
    pub remaining: [f64; 3],
    /// Length over all slides of the correction made, mm.
    pub correction: f64,
    /// Why the sample was refused.
    pub refused: Refused,
    /// The sensor that has been silent longest, as an index of `abbe_sensor_name`; -1: none that matters.
    pub sensor: i32,
    /// Whether the correction is still on its way to what the status asks for.
    pub settling: bool,
}

impl Cycle {
    /// What the supervisor did, in numbers; `sensor` is the index for C of the one that is silent.
    pub(crate) fn new(done: &Supervised, sensor: Option<usize>) -> Self {
        let (error, remaining) =
            done.outcome.map_or(([0.0; 3], [0.0; 3]), |outcome| (outcome.error, outcome.remaining));
        Self {
            error,
            remaining,
            correction: done.correction,
            refused: done.outcome.err().map_or(Refused::No, Refused::from),
            sensor: sensor.and_then(|sensor| i32::try_from(sensor).ok()).unwrap_or(-1),
            settling: done.settling,
        }
    }
}
