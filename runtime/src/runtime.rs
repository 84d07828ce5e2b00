//! The runtime, over whichever numbers the module around it has chosen.
//!
//! In: `real`, the numbers and what differs with them, and `eighth`, their sines. Out: all that the crate offers. It exists by itself so
//! that `double` and `single` have the same: each takes it in once.

mod compensator;
mod direction;
mod exchanged;
mod factor;
mod kinematics;
pub mod math;
mod motion;
mod sample;
mod supervisor;
mod table;
mod term;

use super::{eighth, real};

pub use self::compensator::{
    Compensator, Convergence, DirectionOutcome, GREATEST_AMPLIFICATION, Limits, Outcome, Refusal, SetupError,
    Work, states_needed,
};
pub use self::direction::{Direction, DirectionTracker};
pub use self::exchanged::Exchanged;
pub use self::factor::{Factor, Within};
pub use self::kinematics::{Kinematics, Share, Sines, Turning, place_motors};
pub use self::motion::{ErrorMotion, ErrorMotions, MotionReader};
pub use self::real::Real;
pub use self::sample::Sample;
pub use self::supervisor::{AxisMemory, Cycle, Memory, State, Supervisor, Transition};
pub use self::table::{Bundle, Table, TableError, Values};
pub use self::term::{Input, Term, TermState};
