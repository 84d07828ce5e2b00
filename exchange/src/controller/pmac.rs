//! Delta Tau PMAC: leadscrew and backlash compensation tables (`DEFINE COMP`, `DEFINE BLCOMP`). In: a correction taken apart. Out:
//! commands for the controller; and what such commands do.
//!
//! Facts: PMAC and Turbo PMAC software reference and user manual, "Position compensation". Entries are whole sixteenths of a
//! count of the target motor; the first is one spacing from the motor's zero, where the correction is zero; positions roll over
//! at the count length, so that what lies below zero stands at the end. A COMP value is added to the desired position; a
//! BLCOMP value, and `Ixx86` with it, is subtracted while the motor moves in its negative direction.

mod commands;
mod tables;
mod write;

use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use super::job::Controller;
use super::lost::Target;

pub(super) use tables::{Pmac, controller};
pub(super) use write::written;

impl Controller for Pmac {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        commands::load(self, source, diagnostics);
    }

    fn target(&self) -> &dyn Target {
        self
    }
}
