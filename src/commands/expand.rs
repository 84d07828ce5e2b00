//! `abbe expand`: the Rust code that a machine file compiles to, and a calibration with it, for controllers in Rust, with doubles or without, or in C.

use std::path::{Path, PathBuf};

use model_dsl::calibration::{Calibration, CompiledIn};
use model_dsl::codegen::{self, Unfit};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use workshop::failure::Failure;
use workshop::load;
use workshop::named::machine_name;
use workshop::written::folder;

use crate::arguments::Expand;
use crate::output::{self, Person};

/// Runs the command.
pub(crate) fn run(command: &Expand) -> Result<(), Failure> {
    let machine = PathBuf::from(&command.machine);
    command.target.check(&[machine].into_iter().chain(command.calibration.clone()).collect::<Vec<_>>())?;
    let loaded = load::machine(&command.machine, None, &Person::default())?;
    let equations = &loaded.compiled.equations;
    let tokens = match &command.calibration {
        Some(path) => codegen::calibrated_tokens(equations, &calibration(equations, command, path)?)
            .map_err(|error| Failure::wrong(format!("error: {}: {error}", path.display())))?,
        None if command.c_abi => codegen::c_tokens(equations),
        None => codegen::tokens(equations),
    };
    let tokens =
        if command.f32 { codegen::single(tokens).map_err(|unfit| beyond(command, unfit))? } else { tokens };
    let name = Path::new(&loaded.origin).file_name().map(|name| name.to_string_lossy().into_owned());
    let code = codegen::file(&tokens, &name.unwrap_or(loaded.origin)).map_err(|error| {
        Failure::wrong(format!("error: the generated code does not parse ({error}); this is a bug in Abbe"))
    })?;
    command.target.put(&code)
}

/// A number of the files has no like of 32 bits.
fn beyond(command: &Expand, unfit: Unfit) -> Failure {
    let file = command.calibration.as_deref().unwrap_or(Path::new(&command.machine));
    Failure::wrong(format!("error: {}: {unfit}", file.display()))
}

/// Reads a calibration of the machine; nothing in it may be beyond a controller.
fn calibration(equations: &Equations, command: &Expand, path: &Path) -> Result<Calibration, Failure> {
    let source = load::read(path)?;
    let mut diagnostics = Diagnostics::new();
    let named = machine_name(&command.machine, Path::new(""), &folder(path))?;
    let machine = CompiledIn { named: Some(named), ..CompiledIn::new(equations, "abbe expand") };
    match machine.read_calibration(&source, path.parent(), &mut diagnostics) {
        Some(calibration) => {
            output::show(&source, &diagnostics);
            Ok(calibration)
        }
        None => Err(Failure::marked(&source, &diagnostics)),
    }
}
