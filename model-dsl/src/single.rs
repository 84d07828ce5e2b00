//! Code over numbers of 32 bits, for controllers whose processor knows no others.
//!
//! In: the files of a machine and a calibration. Out: what [`crate::rust_for`] and its like give, over the module `single` of
//! `abbe-runtime`, which is there with its feature `single`. It exists as a module of its own so that a build script says once which
//! numbers it wants. Everything before the code, as equations and their check, is exact or has 64 bits in any case.

use std::path::Path;

use proc_macro2::TokenStream;

use crate::{CompileError, calibrated_code_for, code_for, codegen};

/// [`rust_for`](crate::rust_for) over numbers of 32 bits.
///
/// # Errors
/// As there, and tells the first number that cannot be written in 32 bits.
pub fn rust_for(path: impl AsRef<Path>) -> Result<String, CompileError> {
    let path = path.as_ref();
    code_for(path, |equations| Ok((of_file(path, codegen::tokens(equations))?, String::new())))
}

/// [`calibrated_rust_for`](crate::calibrated_rust_for) over numbers of 32 bits.
///
/// # Errors
/// As there, and tells the first number that cannot be written in 32 bits.
pub fn calibrated_rust_for(
    machine: impl AsRef<Path>,
    calibration: impl AsRef<Path>,
) -> Result<String, CompileError> {
    let calibration = calibration.as_ref();
    calibrated_code_for(machine.as_ref(), calibration, |tokens| of_file(calibration, tokens))
}

/// The code of a file over numbers of 32 bits; a number that cannot be written so is told with the file.
fn of_file(path: &Path, tokens: TokenStream) -> Result<TokenStream, String> {
    codegen::single(tokens).map_err(|unfit| format!("error: {}: {unfit}", path.display()))
}
