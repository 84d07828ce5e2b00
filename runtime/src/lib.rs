//! Abbe's runtime: what a controller runs every servo cycle.
//!
//! In: the equations of a machine ([`Kinematics`], generated from its machine file), the error motions of its calibration
//! ([`ErrorMotion`], sums of [`Term`]s) and the state of the machine ([`Sample`]). Out: the predicted error of the tool tip
//! relative to the part, and the command that cancels it ([`Compensator`]).
//!
//! It exists apart from the compiler because it must run where there is no file system, no allocator and no time: it is
//! `no_std`, owns no memory but what the caller lends it, has no path that panics, and does a bounded amount of work.
//! Arrays on a controller and vectors in a program on a desk serve it alike.
//!
//! # Units, frames, signs
//!
//! Millimetres, radians, seconds, degrees Celsius. Errors are actual minus commanded, those of the tool tip relative to
//! the part, in the frame of the part. A positive error of X means that the tip is too far towards +X of the part.
//!
//! # One sum
//!
//! The error is `E = sum over j of L_j e_j`. The lever arms L_j are the [`Kinematics`]; the error motions e_j are sums of
//! terms, each times the factors before it. A term that remembers (a play with wind-up, a filtered temperature, the ramp
//! of a reversal) keeps its memory in a [`TermState`], which is advanced once a cycle and stands still while the inverse
//! searches.
//!
//! # The inverse
//!
//! To subtract the error at the target is not enough: the command lies elsewhere, and the error there is another. The
//! command c is the one for which `J (c - target) + E(c) = 0`, J being the direction in which each axis moves the tip.
//! It is found as the fixed point of `c <- target - J^+ E(c)`, which settles in a few steps as long as the error changes
//! slowly with the position (by 100 um/m, each step is ten thousand times smaller than the one before). Where it
//! does not settle, where the correction is over the limit, where a number is not finite, the position passes
//! unchanged and a [`Refusal`] says why.
//!
//! A rotary axis corrects the error of its own angle itself ([`Kinematics::turning`]): its command is the one at which it stands at
//! the angle wanted, in front of the search for the slides, which correct the rest. Where rotary axes correct the direction of the tool as
//! well ([`Kinematics::aiming`]), one search finds the commands of all axes, in the pose in which the rotary axes then stand.
//!
//! ```text
//! Sample -> motion (reader): each error motion, a sum of term, table, factor -> Kinematics: the error -> Compensator: the command
//! compensator: prediction: the error at any command; fixed_point: the search; inverse: what the slides reach; report: limits, refusals
//!   turns: rotary axes that correct their own angles; motors: motors of several axes, or of one beam
//!   aim, tilts, seen: rotary axes that correct the direction of the tool
//! Supervisor: servo cycles one after another: fades, silent sensors, the limit of the rate; Exchanged: another tool
//! ```
//!
//! # Hints for the compiler
//!
//! Code says what is worked out; attributes (`inline`, `cold`), sizes that are told once more and questions that a machine answers when it
//! is compiled say how fast. None of them changes a number. `docs/performance.md` says what each kind is for, and how to measure it.
//!
//! # A single slide
//!
//! A slide X whose scale grows by 70 um/m and whose screw has 10 um of lost motion:
//!
//! ```
//! use abbe_runtime::{
//!     Compensator, DirectionTracker, ErrorMotion, Input, Kinematics, Limits, Sample, Term, TermState, Work,
//! };
//!
//! /// What the compiler writes for the topology FX: the tip moves with X, and EXX is its error.
//! struct Slide;
//!
//! impl Kinematics for Slide {
//!     fn axes(&self) -> usize {
//!         1
//!     }
//!     fn travels(&self) -> &[usize] {
//!         &[]
//!     }
//!     fn motions(&self) -> usize {
//!         1
//!     }
//!     fn error(&self, _position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
//!         match motions {
//!             [exx] => [*exx, 0.0, 0.0],
//!             _ => [f64::NAN; 3],
//!         }
//!     }
//!     fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
//!         directions.fill([1.0, 0.0, 0.0]);
//!     }
//! }
//!
//! let exx = [
//!     Term::Polynomial { input: Input::Axis(0), coefficients: &[0.0, 70e-6] },
//!     Term::Backlash { axis: 0, lost_motion: 0.010, wind_up: 0.0, ramp: 0.0 },
//! ];
//! let motions = [ErrorMotion { terms: &exx }];
//! let mut states = [TermState::default(); 2];
//! let mut directions = [[0.0; 3]; 1];
//! let mut values = [0.0; 1];
//! let work = Work { directions: &mut directions, motions: &mut values, travel: &mut [] };
//! let mut compensator = Compensator::new(&Slide, &motions, &mut states, work)?;
//! compensator.limits = Limits { compensation: Some(0.2), ..Limits::default() };
//!
//! let mut tracker = DirectionTracker::new(0.001);
//! tracker.update(0.0);
//! let sample = Sample {
//!     position: &[100.0],
//!     travel: &[],
//!     direction: &[tracker.update(100.0)],
//!     velocity: &[],
//!     temperature: &[],
//!     time_step: 0.002,
//! };
//! let mut command = [0.0];
//! let outcome = compensator.compensate(&sample, &mut command)?;
//!
//! // Moving on, the slide lags by half the lost motion: 7 um of scale less 5 um.
//! assert!((outcome.error[0] - 0.002).abs() < 1e-12);
//! // The command c satisfies c + 70e-6 c - 0.005 = 100.
//! assert!((command[0] - 100.005 / 1.000_07).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! `std` takes the exponential, the square root, and sine and cosine of angles beyond a million rad from the standard library in
//! place of libm. Nothing else changes.
//!
//! `single` adds the module `single`: the same once more over numbers of 32 bits, for controllers whose processor knows no others.
#![no_std]

#[cfg(feature = "std")]
extern crate std;

mod double;
#[cfg(feature = "single")]
pub mod single;

pub use self::double::*;
