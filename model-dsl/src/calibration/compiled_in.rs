//! The calibration of a machine that is compiled in.
//!
//! In: a calibration file and what the compiled machine says of itself. Out: the numbers, or every mistake. It exists because
//! a controller has its machine as code: the file must be for that very machine, and ask for nothing that no controller can do.

use std::path::Path;

use super::{Calibration, MachineNames, machine_of, read};
use crate::diagnostic::{Diagnostic, Diagnostics, render};
use crate::equations::Equations;
use crate::sheet::json;
use crate::source::{SourceFile, Spanned};
use crate::{compile, yaml};

/// What a compiled machine says of itself.
#[derive(Clone, Debug)]
pub struct CompiledIn {
    /// Its names, which the calibration is read against.
    pub names: MachineNames,
    /// Its equations, as [`of_equations`](Self::of_equations) writes them.
    pub equations: String,
    /// How another machine file is compiled, for messages: `abbe expand --c-abi`.
    pub command: &'static str,
    /// How the calibration would name the machine, for messages, where that is known.
    pub named: Option<String>,
}

impl CompiledIn {
    /// What a machine with these equations says of itself.
    pub fn new(equations: &Equations, command: &'static str) -> Self {
        Self { names: equations.names(), equations: Self::of_equations(equations), command, named: None }
    }

    /// The equations as text by which two machines are known to be the same.
    pub fn of_equations(equations: &Equations) -> String {
        json::object(equations)
    }

    /// Reads a calibration of this machine. `folder` is where the file lies.
    ///
    /// A calibration names its machine. Where that name is a path to a file, counted from the calibration's own folder, the
    /// file must say what was compiled in; else the name must be that of the compiled machine (E0426). Terms that cannot be
    /// compensated in real time are mistakes (E0425).
    pub fn read_calibration(
        &self,
        source: &SourceFile,
        folder: Option<&Path>,
        diagnostics: &mut Diagnostics,
    ) -> Option<Calibration> {
        let root = yaml::read(source, diagnostics)?;
        let name = machine_of(&root, diagnostics)?;
        if let Err(other) = self.check(&name, folder) {
            diagnostics.push(*other);
            return None;
        }
        let calibration = read(&root, &self.names, diagnostics)?;
        calibration.refuse_uncompensable(&self.names, diagnostics);
        Some(calibration).filter(|_| !diagnostics.has_errors())
    }

    /// Whether the machine that a calibration names is this one.
    fn check(&self, name: &Spanned<String>, folder: Option<&Path>) -> Result<(), Box<Diagnostic>> {
        let unusable = |why: &str, help: String| {
            let message = format!("machine `{}` cannot be used", name.value);
            Box::new(Diagnostic::error("E0426", name.span, message).label(why).help(help))
        };
        let path = folder.unwrap_or(Path::new("")).join(&name.value);
        if path.is_file() {
            let equations =
                equations(&path).map_err(|why| unusable("this file is not a machine file", why))?;
            if equations.names() != self.names || Self::of_equations(&equations) != self.equations {
                return Err(unusable(
                    "the names or equations of this file differ from those that were compiled in",
                    format!("compile it with `{} {}`", self.command, name.value),
                ));
            }
            return Ok(());
        }
        let compiled = &self.names.machine;
        if name.value == *compiled {
            return Ok(());
        }
        let help = match &self.named {
            Some(named) => format!("write `machine: {named}` if this is a calibration of that machine"),
            None => {
                format!("the compiled machine is `machine: {compiled}`, and no such file is beside this one")
            }
        };
        Err(unusable("this is another machine", help))
    }
}

/// The equations of a machine file, or its mistakes in words.
fn equations(path: &Path) -> Result<Equations, String> {
    let source = SourceFile::open(path)?;
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&source, &mut diagnostics);
    compiled.map(|compiled| compiled.equations).ok_or_else(|| render(&source, &diagnostics, false))
}
