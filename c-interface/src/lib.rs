//! Abbe's C interface: the compensation of one machine, for a controller that is written in C.
//!
//! In: a machine that was compiled to Rust (`abbe expand --c-abi`, [`CompiledMachine`]), the calibration file of one specimen,
//! and each servo cycle the state of its axes and sensors. Out: the correction of each axis, and what was done ([`Cycle`]). It
//! exists because controllers are written in C: `abbe.h` is their whole view of Abbe.
//!
//! ```text
//! machine file -> abbe expand --c-abi -> Rust of one machine --+
//!                                        this crate -----------+-> libmill.a, libmill.so    abbe.h
//! calibration file -> abbe_open -> handle -> abbe_update, every cycle -> correction, status
//! ```
//!
//! # What may be slow, and what may not
//!
//! [`abbe_open`](open()) reads files and allocates: it belongs before the servo cycle. [`abbe_update`](abi::abbe_update) and the small functions
//! beside it do neither, do a bounded amount of work and do not wait.
//!
//! # What C may do wrong
//!
//! A null pointer, a wrong length, a direction that is none, a second thread in the same handle: each has its
//! negative [`Status`], and nothing is written. A number that is not finite is the machine's trouble and not the program's: a temperature
//! is then a silent sensor, a position is refused, and the correction fades ([`abbe_runtime::Supervisor`]). What no library
//! can check is a pointer to memory that is not what it is said to be, or a handle after [`abbe_close`](abi::abbe_close).
//!
//! # Units, frames, signs
//!
//! Those of the runtime: mm, rad for rotary axes, s, degC; machine coordinates, which are those of the calibration.
//! A correction is added to the command; it is the negative of the error where an axis moves the tool along its letter.

pub mod abi;
mod controller;
mod load;
mod machine;
mod status;

pub use abi::{Abbe, Sample, open};
pub use controller::{Controller, Inputs, SetupFailure};
pub use load::{Loaded, load};
pub use machine::{
    AxisOfMachine, CompiledMachine, ConstantOfMachine, CountedOfMachine, ForC, MotionOfMachine,
    TurningToolOfMachine,
};
pub use status::{Cycle, Refused, Status};
