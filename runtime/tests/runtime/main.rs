//! Tests of the runtime through its public surface.
//!
//! In: hand-written machines, random calibrations and positions. Out: agreement with closed forms that do not come from the code.

mod common;
mod cycle;
mod inverse;
mod tables;
mod terms;
