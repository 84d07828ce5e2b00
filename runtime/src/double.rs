//! The runtime over numbers of 64 bits, which everything on a desk and most controllers calculate with.
//!
//! In: the modules of the runtime, which are written once for both kinds of numbers. Out: the same over `f64`. It exists beside
//! `single` so that both may stand in one program: a cargo feature that changed what one type is would change it for everyone who
//! uses the crate in the same build.

mod eighth;
mod real;
// A module that is named by its path looks for its own modules beside it.
#[path = "runtime.rs"]
mod runtime;

pub use self::runtime::*;
