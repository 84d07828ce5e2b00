//! Model update: the coefficients of a calibration, changed to what measured parts show.
//!
//! In: the equations of a machine, a calibration with all its terms, and parts that were measured point by point
//! ([`recording`], instruments `probe` and `position`). Out: an [`Update`]: every coefficient `A` as
//! `A (1 + dA)`, what that leaves at the points, what the points cannot tell apart, and the calibration that results.
//!
//! The method is that of NISTIR 6722 (Gilsinn, Bandy, Ling 2001), equations (15) to (29) and appendix E. An error motion
//! is linear in its coefficients, so that the deviation along a normal n is
//! `n . E = sum over k of (n . L_k) phi_k(s) A_k (1 + dA_k)`: lever arms from [`model_dsl::program::Interpreter`], the
//! functions phi_k from the terms of [`abbe_runtime`] with one coefficient 1 and all others 0. It exists because a
//! characterised machine drifts away from its calibration, and a part on a measuring machine is cheaper than a week of
//! interferometry; what a part cannot show is said beside what it does.
//!
//! ```text
//! calibration -> coefficient: numbers in which the error is linear; recordings -> setup, datum -> points: what each displaces a reading by
//!      -> solution: the linear system -> singular, ridge or select -> nullspace: what cannot be told apart -> residuals -> Update -> report
//! ```
//!
//! Everything is in mm, rad, s and degC.

mod coefficient;
mod datum;
mod error;
mod matrix;
mod nullspace;
mod points;
pub mod report;
mod residuals;
mod ridge;
mod select;
mod setup;
mod singular;
mod solution;
mod update;

use model_dsl::calibration::Calibration;
use model_dsl::equations::Equations;
use recording::Recording;

pub use error::UpdateError;
pub use residuals::{Figures, Residual};
pub use setup::Rotation;
pub use update::{Change, Fixed, Part, Relation, Update};

/// What an update starts from.
#[derive(Clone, Debug)]
pub struct Inputs<'a> {
    /// The error equations of the machine.
    pub equations: &'a Equations,
    /// The calibration whose coefficients are to be changed.
    pub calibration: &'a Calibration,
    /// The measured parts. Every run of a recording is one set-up with a zero of its own.
    pub recordings: Vec<&'a Recording>,
}

/// How the coefficients are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// The pseudo-inverse of the scaled system, as the report has it: the least change in scaled coefficients.
    #[default]
    Svd,
    /// Least squares held towards the present calibration, every relative change alike; the strength by generalised
    /// cross-validation.
    Ridge,
    /// As few coefficients as pay, one after the other; all others stand.
    Select,
}

impl Method {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Svd => "svd",
            Self::Ridge => "ridge",
            Self::Select => "select",
        }
    }
}

/// What is asked of an update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// How the coefficients are found.
    pub method: Method,
    /// Singular values up to this share of the norm of the scaled matrix count as zero. Without it the share is that of
    /// the report, rows times 2.2e-16 (equation E20).
    pub tolerance: Option<f64>,
    /// The directions X, Y, Z in which the zero of each part is free: what a set-up puts there says nothing of the
    /// machine. The zero of a part whose recording says that its datum is free is free in all of them, and its rotation too.
    pub datum: [bool; 3],
    /// Whether the parts were made with the calibration's own compensation switched on: then the deviations are what it
    /// left, and the prediction is not taken off once more.
    pub compensated: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { method: Method::Svd, tolerance: None, datum: [true; 3], compensated: false }
    }
}

/// Changes the coefficients of a calibration to what the parts show.
///
/// # Errors
///
/// [`UpdateError`] where the recordings hold no point, lack a temperature that a term reads, or are of an instrument that
/// measures no points; and where the calibration has no coefficient that could move.
pub fn update(inputs: &Inputs<'_>, options: &Options) -> Result<Update, UpdateError> {
    update::update(inputs, options)
}

/// A count as a number.
#[expect(clippy::cast_precision_loss, reason = "counts of points and coefficients are far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}
