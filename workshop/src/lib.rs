//! What all front ends of Abbe do alike: the command line, and whoever calls Abbe as a library.
//!
//! In: names of files that name each other. Out: machines, calibrations and recordings ready for the crates that work with them, and
//! files that are written whole or not at all. Nothing is printed here: warnings go to a [`told::Listener`], and what stops the work
//! is a [`failure::Failure`].

pub mod begin;
pub mod calibrated;
pub mod diagnosed;
pub mod explain;
pub mod exported;
pub mod failure;
pub mod improved;
pub mod load;
pub mod named;
pub mod origin;
pub mod recorded;
pub mod rows;
pub mod set_up;
pub mod shipped;
pub mod simulated;
pub mod told;
pub mod tools;
pub mod topology;
pub mod updated;
pub mod written;
