//! Tests of the runtime through its public surface.
//!
//! In: hand-written machines, random calibrations and positions. Out: agreement with closed forms that do not come from the code.

#![expect(clippy::unwrap_used, reason = "in a test a panic is the report, in its helpers too")]

mod bundles;
mod common;
mod cycle;
mod exchanged;
mod hostile;
mod inverse;
mod motors;
mod ramp;
mod sines;
mod skew;
mod supervisor;
mod tables;
mod terms;
mod turning;
