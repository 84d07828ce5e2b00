//! From a calibration file to a controller of one machine.
//!
//! In: the path of the file, and the machine that was compiled in. Out: the [`Controller`], with the warnings on the way;
//! or every mistake in words. It exists because only here can be seen whether the numbers belong to the machine.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use model_dsl::calibration::{self, Calibration, MachineNames};
use model_dsl::compile;
use model_dsl::diagnostic::{Diagnostic, Diagnostics, render};
use model_dsl::equations::Names;
use model_dsl::notation::{self, Format};
use model_dsl::source::{SourceFile, Spanned};
use model_dsl::yaml;

use crate::controller::Controller;
use crate::machine::{CompiledMachine, ForC, names};

/// No byte beyond this one is read: a larger file is refused, and a device may have no end.
const MOST_BYTES: u64 = 8 * 1024 * 1024;

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
/// A calibration names its machine. Where that name is a path to a file, counted from the calibration's own folder, the
/// file must say what was compiled in; else the name must be that of the compiled machine.
///
/// # Errors
/// What is wrong, with places and what to write instead: the file, its machine, or a term that no controller can compensate.
pub fn load<M: CompiledMachine>(path: &Path) -> Result<Loaded, String> {
    let source = read(path)?;
    let mut diagnostics = Diagnostics::new();
    let calibration = calibration::<M>(&source, path, &mut diagnostics);
    let calibration = calibration.filter(|_| !diagnostics.has_errors());
    let warnings = render(&source, &diagnostics, false);
    let Some(calibration) = calibration else { return Err(warnings) };
    let machine = M::with_constants(&calibration.constants)
        .ok_or_else(|| format!("error: {}: not the constants of {}", path.display(), M::NAME))?;
    let names = ForC::new::<M>(calibration.sensors.inputs().map(|(_, sensor)| sensor.name.value.as_str()))
        .map_err(|name| format!("error: {}: a name with a zero byte: {name:?}", path.display()))?;
    let rotary = M::AXES.iter().map(|&(_, rotary)| rotary);
    let controller = Controller::new(Box::new(machine), rotary, calibration)
        .map_err(|error| format!("error: {}: {error}", path.display()))?;
    Ok(Loaded { controller, names, warnings })
}

/// Reads a text file.
fn read(path: &Path) -> Result<SourceFile, String> {
    let cannot = |why: String| format!("error: cannot read {}: {why}", path.display());
    let mut text = String::new();
    let file = File::open(path).map_err(|error| cannot(error.to_string()))?;
    file.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(|error| cannot(error.to_string()))?;
    if u64::try_from(text.len()).is_ok_and(|length| length > MOST_BYTES) {
        return Err(cannot(format!("it is larger than {} MiB", MOST_BYTES >> 20)));
    }
    Ok(SourceFile::new(path.display().to_string(), text))
}

fn calibration<M: CompiledMachine>(
    source: &SourceFile,
    path: &Path,
    diagnostics: &mut Diagnostics,
) -> Option<Calibration> {
    let root = yaml::read(source, diagnostics)?;
    let name = calibration::machine_of(&root, diagnostics)?;
    if let Err(other) = check_machine::<M>(&name, path.parent()) {
        diagnostics.push(*other);
        return None;
    }
    let names = names::<M>();
    let calibration = calibration::read(&root, &names, diagnostics)?;
    calibration.refuse_uncompensable(&names, diagnostics);
    Some(calibration)
}

/// Whether the machine that a calibration names is the one that was compiled in.
fn check_machine<M: CompiledMachine>(
    name: &Spanned<String>,
    folder: Option<&Path>,
) -> Result<(), Box<Diagnostic>> {
    let unusable = |why: &str, help: String| {
        let message = format!("machine `{}` cannot be used", name.value);
        Box::new(Diagnostic::error("E0426", name.span, message).label(why).help(help))
    };
    let path = folder.unwrap_or(Path::new("")).join(&name.value);
    if path.is_file() {
        let (its_names, its_equations) =
            equations(&path).map_err(|why| unusable("this file is no machine", why))?;
        if its_names != names::<M>() || its_equations != M::EQUATIONS {
            let help = format!("compile it into the library with `abbe expand --c-abi {}`", name.value);
            return Err(unusable(
                "this file has other names or equations than those that were compiled in",
                help,
            ));
        }
        return Ok(());
    }
    if name.value == M::NAME {
        return Ok(());
    }
    let help = format!(
        "this library was compiled for `machine: {}`, and there is no such file beside this one",
        M::NAME
    );
    Err(unusable("this is another machine", help))
}

/// The names of a machine file and its equations, as [`CompiledMachine::EQUATIONS`] has them; or its mistakes in words.
fn equations(path: &Path) -> Result<(MachineNames, String), String> {
    let source = read(path)?;
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&source, &mut diagnostics);
    let compiled = compiled.ok_or_else(|| render(&source, &diagnostics, false))?;
    let equations = compiled.equations;
    Ok((equations.names(), notation::print(&equations, Format::Json, Names::Iso)))
}
