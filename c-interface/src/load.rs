//! From a calibration file to a controller of one machine.
//!
//! In: the path of the file, and the machine that was compiled in. Out: the [`Controller`], with the warnings on the way;
//! or every mistake in words. It exists because only here can be seen whether the numbers belong to the machine.

use std::path::Path;

use abbe_runtime::Exchanged;
use model_dsl::calibration::CompiledIn;
use model_dsl::diagnostic::{Diagnostics, render};
use model_dsl::source::SourceFile;

use crate::controller::Controller;
use crate::machine::{CompiledMachine, ForC, names};

/// A controller and what the calibration file warns of.
pub struct Loaded {
    /// The controller, switched off.
    pub controller: Controller,
    /// What the machine's axes and the calibration's sensors are called.
    pub names: ForC,
    /// The warnings with their places; empty where there are none.
    pub warnings: String,
}

/// Reads a calibration of the machine `M`.
///
/// The machine that it names must be this one, see [`CompiledIn::read_calibration`].
///
/// # Errors
/// What is wrong, with places and what to write instead: the file, its machine, or a term that no controller can compensate.
pub fn load<M: CompiledMachine>(path: &Path) -> Result<Loaded, String> {
    let source = SourceFile::open(path)?;
    let mut diagnostics = Diagnostics::new();
    let machine = CompiledIn {
        names: names::<M>(),
        equations: M::EQUATIONS.to_owned(),
        command: "abbe expand --c-abi",
        named: None,
    };
    let calibration = machine.read_calibration(&source, path.parent(), &mut diagnostics);
    let warnings = render(&source, &diagnostics, false);
    let Some(calibration) = calibration else { return Err(warnings) };
    let machine = M::with_constants(&calibration.constants)
        .ok_or_else(|| format!("error: {}: not the constants of {}", path.display(), M::NAME))?;
    let names = ForC::new::<M>(&calibration)
        .map_err(|name| format!("error: {}: a name with a zero byte: {name:?}", path.display()))?;
    let rotary = M::AXES.iter().map(|&(_, rotary)| rotary);
    let controller = Controller::new(Box::new(Exchanged::new(machine)), rotary, calibration)
        .map_err(|error| format!("error: {}: {error}", path.display()))?;
    Ok(Loaded { controller, names, warnings })
}
