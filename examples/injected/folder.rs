//! Recordings of a folder. In: a folder with `recording.yaml` and its table. Out: the recording with its machine, ready for effects to be
//! injected; or why that cannot be.

use std::fs;
use std::path::{Path, PathBuf};

use limits::injection::base::Base;
use model_dsl::calibration::{self, Calibration, MachineNames};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;
use model_dsl::{Compiled, compile, compile_word, yaml};
use recording::{calibration_of, machine_of, read_header};

/// Reads the folder's `recording.yaml` and all that it names; or why that cannot be.
pub(crate) fn read(name: &str, folder: &Path) -> Result<Base, String> {
    let source = source(&folder.join("recording.yaml"))?;
    let mut findings = Diagnostics::new();
    let told = |findings: &Diagnostics| match findings.iter().next() {
        Some(finding) => format!("{}: {}", finding.code, finding.message),
        None => "it cannot be read".to_owned(),
    };
    let root = yaml::read(&source, &mut findings).ok_or_else(|| told(&findings))?;
    let machine = machine_of(&root, &mut findings).ok_or_else(|| told(&findings))?;
    let compiled = machine_named(&machine.value, folder)?;
    let header = read_header(&root, &compiled.equations, &mut findings).ok_or_else(|| told(&findings))?;
    let recording = header.read_data(&folder.join(&header.data.value)).map_err(|error| error.to_string())?;
    let names = compiled.equations.names();
    let calibration =
        calibration_of(&root).map(|file| calibration_named(&folder.join(&file.value), &names)).transpose()?;
    Base::new(name, compiled, calibration, recording)
}

fn source(path: &Path) -> Result<SourceFile, String> {
    let text = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(SourceFile::new(path.display().to_string(), text))
}

/// A machine file beside the recording, a shipped machine, or a topology word.
fn machine_named(name: &str, folder: &Path) -> Result<Compiled, String> {
    let shipped = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("machines/{name}.yaml"));
    let file = [folder.join(name), shipped].into_iter().find(|path| path.is_file());
    let compiled = match file {
        Some(path) => compile(&source(&path)?, &mut Diagnostics::new()),
        None => compile_word(name, &mut Diagnostics::new()),
    };
    compiled.ok_or_else(|| format!("no machine `{name}`"))
}

fn calibration_named(path: &Path, names: &MachineNames) -> Result<Calibration, String> {
    let mut findings = Diagnostics::new();
    let root = yaml::read(&source(path)?, &mut findings);
    let read = root.and_then(|root| calibration::read(&root, names, &mut findings));
    read.ok_or_else(|| format!("{} cannot be used", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_that_are_none_are_told() {
        assert!(read("none", Path::new("no-such-folder")).is_err());
    }
}
