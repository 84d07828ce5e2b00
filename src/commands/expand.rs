//! `abbe expand`: the Rust code that a machine file compiles to, for controllers in Rust or in C.

use std::path::Path;

use model_dsl::codegen;

use crate::arguments::Expand;
use crate::failure::Failure;
use crate::{load, output};

/// Runs the command.
pub(crate) fn run(command: &Expand) -> Result<(), Failure> {
    let loaded = load::machine(&command.machine, None)?;
    let equations = &loaded.compiled.equations;
    let tokens = if command.c_abi { codegen::c_tokens(equations) } else { codegen::tokens(equations) };
    let name = Path::new(&loaded.origin).file_name().map(|name| name.to_string_lossy().into_owned());
    let code = codegen::file(&tokens, &name.unwrap_or(loaded.origin)).map_err(|error| {
        Failure::Wrong(format!("error: the generated code does not parse ({error}); this is a fault of Abbe"))
    })?;
    output::print(&code)
}
