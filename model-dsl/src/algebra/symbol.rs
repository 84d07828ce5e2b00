//! The letters of the algebra. In: names of axes and constants. Out: ordered symbols.
//!
//! The order of the variants is the order in which sums are printed: the position comes
//! first, then offsets, as in `x - X1 + X2 + Xt`.

use std::fmt;
use std::sync::Arc;

use super::FixedAngle;

/// A shared name; cloning it is cheap.
pub type Name = Arc<str>;

/// One letter of a polynomial.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symbol {
    /// The programmed position of an axis, by its lower-case name (`x`): mm, or rad for a rotary axis.
    Position(Name),
    /// A free travel that stands for a position in the lever of an alignment error (`dz`): mm.
    Travel(Name),
    /// An offset of the machine by name (`X1`): mm.
    Constant(Name),
    /// An error motion by symbol. It stands in published equations while they are read;
    /// derived equations hold error motions apart, in [`super::FirstOrder`].
    Motion(Name),
    /// The cosine of an angle that never changes.
    FixedCos(FixedAngle),
    /// The sine of an angle that never changes.
    FixedSin(FixedAngle),
    /// The cosine of a rotary axis's position.
    Cos(Name),
    /// The sine of a rotary axis's position.
    Sin(Name),
}

impl Symbol {
    /// The name that the symbol carries: `c` for `cos(c)`, `45 deg` for `cos(45 deg)`.
    pub fn name(&self) -> &Name {
        match self {
            Self::Position(name)
            | Self::Travel(name)
            | Self::Constant(name)
            | Self::Motion(name)
            | Self::Cos(name)
            | Self::Sin(name) => name,
            Self::FixedCos(angle) | Self::FixedSin(angle) => angle.name(),
        }
    }

    /// The value of a symbol that has one in itself: a pure number.
    pub fn fixed_value(&self) -> Option<f64> {
        match self {
            Self::FixedCos(angle) => Some(angle.cosine()),
            Self::FixedSin(angle) => Some(angle.sine()),
            _ => None,
        }
    }
}

impl fmt::Display for Symbol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cos(name) => write!(f, "cos({name})"),
            Self::Sin(name) => write!(f, "sin({name})"),
            Self::FixedCos(angle) => write!(f, "cos({angle})"),
            Self::FixedSin(angle) => write!(f, "sin({angle})"),
            other => f.write_str(other.name()),
        }
    }
}
