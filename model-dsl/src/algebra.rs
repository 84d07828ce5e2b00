//! The algebra of the compiler: exact polynomials and the first-order ring over them.
//!
//! In: symbols (positions, constants, sines and cosines of rotary axes) and small errors.
//! Out: homogeneous transformation matrices whose entries keep the nominal part exactly and
//! the error part to first order. A product of two errors cannot be written down here: the
//! type [`FirstOrder`] has no place for it, so it is dropped while multiplying, never after.

mod first_order;
mod fixed_angle;
mod htm;
mod monomial;
mod polynomial;
mod rational;
mod symbol;

pub use first_order::FirstOrder;
pub use fixed_angle::{FixedAngle, sine_and_cosine};
pub use htm::{Axis, Htm};
pub use monomial::Monomial;
pub use polynomial::Polynomial;
pub use rational::{Rational, decimal, to_f64};
pub use symbol::{Name, Symbol};
