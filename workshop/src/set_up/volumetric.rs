//! The file of a volumetric compensation that a set-up names. In: its name. Out: its error motions among what the set-up knows.

use std::path::Path;

use exchange::controller::{VolumetricForm, volumetric_form, volumetric_terms};
use exchange::instrument::Setup;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;

use super::counted;
use crate::failure::Failure;
use crate::load;
use crate::recorded::unusable;
use crate::told::{Listener, Words};

/// Takes the file over, where the set-up names one; what is wrong in it stands at its place there, below the place of its name
/// (E0914).
pub(super) fn take(
    setup: &mut Setup,
    source: &SourceFile,
    path: &Path,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
    listener: &dyn Listener,
) -> Result<(), Failure> {
    let Some(name) = setup.volumetric.clone() else { return Ok(()) };
    let not = |failure: Failure| unusable(source, "E0914", "file", &name, failure);
    let file = load::read(&path.with_file_name(&name.value)).map_err(not)?;
    // What is of neither form is told by the reader of the first.
    let form = volumetric_form(file.text()).unwrap_or(VolumetricForm::Isg);
    let mut findings = Diagnostics::new();
    let terms = volumetric_terms(equations, &setup.known, &file, form, &mut findings);
    let terms = terms.map_err(|refused| not(Failure::wrong(refused.to_string())))?;
    if findings.has_errors() {
        return Err(not(Failure::marked(&file, &findings)));
    }
    listener.hear(&Words::marked(&file, &findings));
    setup.take(&terms, name.span, equations, diagnostics);
    listener.hear(&format!("{} from {}", counted(terms.len()), file.name()).into());
    Ok(())
}
