//! The runtime over numbers of 32 bits, for controllers whose processor knows no others, such as a Cortex-M4F.
//!
//! In and out: the same as at the root of the crate, all numbers `f32`. It exists since such a processor takes some tens
//! of instructions for a sum of `f64`, and one for a sum of `f32`. Nothing in it calculates with `f64`.
//!
//! Machines and calibrations are compiled to it by `abbe expand --f32`, `abbe_model_dsl::single::rust_for` or
//! `machine!("machine.yaml", f32)`. Everything here is another type than that of the same name at the root of the crate; both may
//! stand in one program.
//!
//! # What it loses
//!
//! A position of 32 bits has steps: 61 nm between 512 and 1024 mm, half of that between 256 and 512 mm. An error and a correction are
//! small numbers, known to far less than a nanometre. Only the command is rounded, by half a step: 31 nm below a metre. Commands of rotary
//! axes are rounded by up to 0.24 urad within a turn. `docs/performance.md` has what was measured.
//!
//! # What to mind
//!
//! - **Positions**: a controller that counts its positions in whole numbers adds `command - position` to them. That difference is exact,
//!   so that only the rounding of the command is left, and not that of the position.
//! - **Angles**: give the angle of a rotary axis within a turn or two. Steps grow with the angle: 0.5 urad at one turn, 60 urad at a
//!   hundred. Angles beyond 3000 rad have no sine here and are refused as not finite.
//! - **Velocities**: take them from the interpolator. The difference of two positions near a metre, over a cycle of 1 ms, has steps of
//!   0.06 mm/s.
//! - **Time**: a sample has the time since the one before it, never the time since the start, whose steps would be 8 ms after a day.
//!   What sums time up does so without standing still: filters and ramps keep what each sum loses, and clocks run forward by at least
//!   their own smallest step.
//! - **Directions**: the threshold of a [`DirectionTracker`] should be several steps of the position.

mod eighth;
mod real;
// A module that is named by its path looks for its own modules beside it.
#[path = "runtime.rs"]
#[expect(clippy::duplicate_mod, reason = "the modules are written once for both kinds of numbers")]
mod runtime;

pub use self::runtime::*;
