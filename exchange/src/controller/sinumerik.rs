//! Siemens SINUMERIK: leadscrew error compensation (`$AA_ENC_COMP`) and cross error compensation (`$AN_CEC`). In: a correction
//! taken apart. Out: an archive of each; and what such archives do.
//!
//! Facts: SINUMERIK Function Manual K3 "Compensations". A value of `ENC_COMP` changes the actual value, so that a positive one
//! moves the axis in its negative direction: it is the error, actual minus commanded. `CEC` acts from the setpoint of an input
//! axis on an output axis, in one direction of the input or in both; a table multiplied by another (its number is its index
//! plus 1) adds the product, as in the manual's example of a sagging foundation. The sign of a CEC value is said in no
//! document that could be read: the user says it.

mod archive;
mod control;
mod pieces;
mod write;

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use super::job::Controller;
use super::lost::Target;

pub(super) use control::{Sinumerik, controller};
pub(super) use write::written;

impl Controller for Sinumerik {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        archive::load(self, source, diagnostics);
    }

    fn findings(&self) -> Vec<String> {
        self.idle()
    }

    fn target(&self) -> &dyn Target {
        self
    }
}
