//! Corrections that a set-up names, and squares that it measures by their lengths. In: the set-up. Out: the error motions of both among
//! what it knows.

use std::path::Path;

use exchange::controller::{saved_terms, skew_terms};
use exchange::instrument::Setup;
use exchange::instrument::setup::Correction;
use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;

use super::counted;
use crate::failure::Failure;
use crate::load;
use crate::recorded::unusable;
use crate::told::{Listener, Words};

/// Takes all of them over; what is wrong in one stands at its place there, below the place of its name (E0914).
pub(super) fn take(
    setup: &mut Setup,
    source: &SourceFile,
    path: &Path,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
    listener: &dyn Listener,
) -> Result<(), Failure> {
    for one in setup.corrections.clone() {
        take_one(setup, &one, source, path, equations, diagnostics, listener)?;
    }
    take_squares(setup, equations, diagnostics, listener);
    Ok(())
}

/// Takes the leans of squares over; a machine that has no such slides is told (E0906).
fn take_squares(
    setup: &mut Setup,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
    listener: &dyn Listener,
) {
    let Some(leans) = setup.diagonals else { return };
    match skew_terms(equations, &setup.known, leans.value) {
        Ok(terms) => {
            listener.hear(&format!("{} from the lengths of squares", counted(terms.len())).into());
            setup.take(&terms, leans.span, equations, diagnostics);
        }
        Err(refused) => {
            let mistake = Diagnostic::error("E0906", leans.span, refused.what);
            diagnostics.push(mistake.help(refused.help.unwrap_or_default()));
        }
    }
}

fn take_one(
    setup: &mut Setup,
    one: &Correction,
    source: &SourceFile,
    path: &Path,
    equations: &Equations,
    diagnostics: &mut Diagnostics,
    listener: &dyn Listener,
) -> Result<(), Failure> {
    let not = |failure: Failure| unusable(source, "E0914", "file", &one.data, failure);
    let file = load::read(&path.with_file_name(&one.data.value)).map_err(not)?;
    let mut findings = Diagnostics::new();
    let terms = saved_terms(equations, &setup.known, &file, &one.wanted, &mut findings);
    let terms = terms.map_err(|refused| not(Failure::wrong(refused.to_string())))?;
    if findings.has_errors() {
        return Err(not(Failure::marked(&file, &findings)));
    }
    listener.hear(&Words::marked(&file, &findings));
    setup.take(&terms, one.data.span, equations, diagnostics);
    listener.hear(&format!("{} from {}", counted(terms.len()), file.name()).into());
    Ok(())
}
