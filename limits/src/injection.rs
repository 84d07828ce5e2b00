//! Known effects in recordings. In: a recording with its machine. Out: the same recording with an effect in it at a size, what the
//! effect alone shows in each reading, and whether a diagnosis found it.
//!
//! The noise, the nuisances and the unknown physics stay those of the real machine, and one truth is certain.

pub mod allowed;
pub mod base;
pub mod case;
pub mod columns;
pub mod effect;
pub mod kind;
pub mod score;
pub mod state;
pub mod taken;
