//! A calibrated machine. In: a calibration file. Out: its machine and its numbers, ready to
//! become terms of the runtime; or every mistake, located.

use std::path::Path;

use abbe_runtime::Term;
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::machine::Machine;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::failure::Failure;
use crate::load;
use crate::told::{Listener, Words};

/// A machine with the numbers of one specimen.
#[derive(Clone)]
pub struct Calibrated {
    /// The validated chain.
    pub machine: Machine,
    /// The machine's equations.
    pub equations: Equations,
    /// Its numbers.
    pub calibration: Calibration,
    /// Its file.
    pub source: SourceFile,
}

/// Reads a calibration file and compiles the machine that it names.
pub fn read(path: &Path, listener: &dyn Listener) -> Result<Calibrated, Failure> {
    of(load::read(path)?, path.parent(), listener)
}

/// Reads the text of a calibration file, whose names are counted from a folder.
pub fn of(source: SourceFile, folder: Option<&Path>, listener: &dyn Listener) -> Result<Calibrated, Failure> {
    let mut diagnostics = Diagnostics::new();
    let wrong = |diagnostics: &Diagnostics| Failure::marked(&source, diagnostics);
    let root = yaml::read(&source, &mut diagnostics).ok_or_else(|| wrong(&diagnostics))?;
    let name = calibration::machine_of(&root, &mut diagnostics).ok_or_else(|| wrong(&diagnostics))?;
    let machine = load::machine(&name.value, folder, listener).map_err(|failure| match failure {
        Failure::Wrong(reason) => {
            let unusable =
                Diagnostic::error("E0426", name.span, format!("machine `{}` cannot be used", name.value))
                    .label("named here; the reason is below");
            let mut diagnostics = Diagnostics::new();
            diagnostics.push(unusable);
            Failure::Wrong(Words::marked(&source, &diagnostics).then(reason))
        }
        other => other,
    })?;
    let (machine, equations) = (machine.compiled.machine, machine.compiled.equations);
    let calibration = calibration::read(&root, &equations.names(), &mut diagnostics);
    let calibration = calibration.filter(|_| !diagnostics.has_errors()).ok_or_else(|| wrong(&diagnostics))?;
    listener.hear(&Words::marked(&source, &diagnostics));
    Ok(Calibrated { machine, equations, calibration, source })
}

impl Calibrated {
    /// Refuses the terms that cannot be compensated in real time, all of them, by name.
    pub fn refuse_uncompensable(&self) -> Result<(), Failure> {
        let mut diagnostics = Diagnostics::new();
        self.calibration.refuse_uncompensable(&self.equations.names(), &mut diagnostics);
        if diagnostics.is_empty() {
            return Ok(());
        }
        let help = "help: use --leave-out-uncompensable to compensate only the other terms";
        Err(Failure::Wrong(Words::marked(&self.source, &diagnostics).then(help)))
    }

    /// The compensable terms of every error motion, in the order of the equations; `left_out` hears of the others.
    pub fn terms(&self, mut left_out: impl FnMut(String)) -> Vec<Vec<Term<'_>>> {
        let motions = self.equations.motions.iter().enumerate();
        motions
            .map(|(number, motion)| {
                let terms = self.calibration.runtime(number).flat_map(|term| match term {
                    Ok(with_factors) => with_factors,
                    Err(reason) => {
                        left_out(format!("warning: left out of {}: {reason}", motion.name));
                        Vec::new()
                    }
                });
                terms.collect()
            })
            .collect()
    }
}
