//! Files of others: controllers' compensation tables, and instruments' measurements.
//!
//! In: a calibrated machine, or the text of a file. Out: the files that a controller loads with what they cannot carry, or
//! the error motions that were measured. It exists because a calibration is worth what can be brought into the machine, and
//! begins with what a laser or a level has written.

pub mod controller;
pub mod instrument;
