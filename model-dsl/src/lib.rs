//! Abbe's compiler: a machine file becomes its error equations and Rust code.
//!
//! ```text
//! text -> yaml -> machine -> derivation -> equations -> sheet: what is printed, as text and JSON; others by the crate `notation`
//!                                             |-> check: against published equations
//!                                             |-> program -> codegen: tokens, or the interpreter
//!                                             |-> exact: the product of finite matrices, in numbers
//! text -> yaml -> calibration: the numbers of one machine, as terms of its error motions -> codegen: the same as constants
//! ```
//!
//! The whole way is [`compile`]: text in, equations and located mistakes out. What it does not
//! do: read or write files (but for [`rust_for`] and its like, which read the files that they are given, and for the machine
//! that a calibration names), and
//! know anything of recordings or of the command line.

pub mod algebra;
pub mod calibration;
pub mod check;
pub mod codegen;
pub mod derivation;
pub mod diagnostic;
pub mod equations;
pub mod exact;
pub mod expression;
pub mod fields;
pub mod kind;
pub mod machine;
pub mod program;
pub mod quantity;
mod quoted;
pub mod sheet;
pub mod single;
pub mod source;
pub mod suggest;
pub mod yaml;

use std::fmt;
use std::path::Path;

use proc_macro2::TokenStream;

use calibration::CompiledIn;
use diagnostic::{Diagnostics, render};
use equations::Equations;
use machine::Machine;
use source::{SourceFile, Span};

pub use quoted::quoted;

/// A compiled machine.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The validated chain.
    pub machine: Machine,
    /// Its error equations.
    pub equations: Equations,
}

/// Compiles a machine file. Mistakes and warnings go to `diagnostics`; `None` after an error.
///
/// ```
/// use abbe_model_dsl::{compile, diagnostic::Diagnostics, sheet::infix, source::SourceFile};
/// let file = SourceFile::new("stage.yaml", "abbe: 1\nname: stage\ntopology: FX\n");
/// let mut diagnostics = Diagnostics::new();
/// let stage = compile(&file, &mut diagnostics).expect("a valid machine");
/// assert_eq!(infix(&stage.equations.rows[0].nominal), "x + Xt");
/// ```
pub fn compile(source: &SourceFile, diagnostics: &mut Diagnostics) -> Option<Compiled> {
    let machine = machine::read(source, diagnostics)?;
    Some(derived(machine, diagnostics))
}

/// Compiles a bare topology word, such as `XYFZ` or `FX`.
pub fn compile_word(word: &str, diagnostics: &mut Diagnostics) -> Option<Compiled> {
    let machine = machine::from_word(word, Span::new(0, word.len()), diagnostics)?;
    Some(derived(machine, diagnostics))
}

fn derived(machine: Machine, diagnostics: &mut Diagnostics) -> Compiled {
    let equations = derivation::derive(&machine, diagnostics);
    Compiled { machine, equations }
}

/// The Rust code of a machine file as tokens, and its warnings; or every mistake, rendered.
pub fn rust_tokens(source: &SourceFile) -> Result<(TokenStream, Equations, String), String> {
    let (equations, warnings) = equations_of(source)?;
    Ok((codegen::tokens(&equations), equations, warnings))
}

/// The equations of a machine file, and its warnings; or every mistake, rendered.
fn equations_of(source: &SourceFile) -> Result<(Equations, String), String> {
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(source, &mut diagnostics);
    let rendered = render(source, &diagnostics, false);
    compiled.map(|compiled| (compiled.equations, rendered.clone())).ok_or(rendered)
}

/// The Rust code of a machine with a calibration of it compiled in, as tokens, and the calibration's warnings; or every
/// mistake in it, rendered. `folder` is where the calibration lies: the machine that it names is looked for there.
pub fn calibrated_rust_tokens(
    equations: &Equations,
    calibration: &SourceFile,
    folder: Option<&Path>,
) -> Result<(TokenStream, String), String> {
    let mut diagnostics = Diagnostics::new();
    let machine = CompiledIn::new(equations, "abbe expand");
    let read = machine.read_calibration(calibration, folder, &mut diagnostics);
    let rendered = render(calibration, &diagnostics, false);
    let Some(read) = read else { return Err(rendered) };
    let tokens = codegen::calibrated_tokens(equations, &read);
    let tokens = tokens.map_err(|error| format!("error: {}: {error}", calibration.name()))?;
    Ok((tokens, rendered))
}

/// The Rust code of a machine file, formatted: what a build script writes into `OUT_DIR`.
///
/// Warnings become `cargo::warning` lines. The error tells the file, or every mistake in it.
pub fn rust_for(path: impl AsRef<Path>) -> Result<String, CompileError> {
    code_for(path.as_ref(), |equations| Ok((codegen::tokens(equations), String::new())))
}

/// The same with a calibration of the machine compiled in: its terms as constants, in the struct `Calibration`.
pub fn calibrated_rust_for(
    machine: impl AsRef<Path>,
    calibration: impl AsRef<Path>,
) -> Result<String, CompileError> {
    calibrated_code_for(machine.as_ref(), calibration.as_ref(), Ok)
}

/// The code of [`rust_for`] with what a library for controllers in C needs: the crates `abbe-runtime` and `abbe-c`.
pub fn c_library_for(path: impl AsRef<Path>) -> Result<String, CompileError> {
    code_for(path.as_ref(), |equations| Ok((codegen::c_tokens(equations), String::new())))
}

/// The formatted code of a machine and a calibration of it, after something more was done with its tokens.
fn calibrated_code_for(
    machine: &Path,
    calibration: &Path,
    then: impl Fn(TokenStream) -> Result<TokenStream, String>,
) -> Result<String, CompileError> {
    code_for(machine, |equations| {
        let source = SourceFile::open(calibration)?;
        let (tokens, warnings) = calibrated_rust_tokens(equations, &source, calibration.parent())?;
        Ok((then(tokens)?, warnings))
    })
}

/// The formatted code that a writer of tokens, and of more warnings, makes of a machine file.
#[expect(clippy::print_stdout, reason = "a build script passes its warnings to cargo on standard output")]
fn code_for(
    path: &Path,
    tokens: impl Fn(&Equations) -> Result<(TokenStream, String), String>,
) -> Result<String, CompileError> {
    let source = SourceFile::open(path).map_err(CompileError)?;
    let (equations, warnings) = equations_of(&source).map_err(CompileError)?;
    let (tokens, more) = tokens(&equations).map_err(CompileError)?;
    for line in warnings.lines().chain(more.lines()) {
        println!("cargo::warning={line}");
    }
    let origin = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    codegen::file(&tokens, &origin)
        .map_err(|error| CompileError(format!("the generated code does not parse: {error}")))
}

/// Why a machine file gives no code: every mistake in it, as text to be read.
///
/// Its `Debug` is that text too, since a build script whose `main` returns it is shown by `Debug`.
pub struct CompileError(String);

impl fmt::Display for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Debug for CompileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0.trim_end())
    }
}

impl std::error::Error for CompileError {}
