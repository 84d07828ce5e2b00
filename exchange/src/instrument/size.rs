//! The size of what was measured. In: the calibration with all error motions, and the set-up. Out: a finding at the place of the set-up
//! that gives the unit of an error which no working machine has: mostly that unit is wrong.

use model_dsl::calibration::{Calibration, not_small};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::{Span, Spanned};

use super::setup::Setup;
use super::squareness::Squareness;

/// Refuses error motions that are not small (E0430), one finding for each.
pub(super) fn check(
    calibration: &Calibration,
    setup: &Setup,
    squarenesses: &[Squareness],
    equations: &Equations,
    diagnostics: &mut Diagnostics,
) {
    let names = equations.names();
    for motion in &calibration.motions {
        let (Some(name), Some(place)) =
            (names.motions.get(motion.motion), place(motion.motion, setup, squarenesses))
        else {
            continue;
        };
        let placed = motion.terms.iter().map(|term| Spanned::new(term.value.clone(), place));
        let found = placed.filter_map(|term| not_small(&term, name, &names)).next();
        diagnostics.extend(found);
    }
}

/// Where the set-up says what an error motion was measured in; nothing for one that was not measured.
fn place(motion: usize, setup: &Setup, squarenesses: &[Squareness]) -> Option<Span> {
    let measured = setup.measurements.iter().find(|one| one.motion.value == motion);
    let unit = |one: &super::setup::Measurement| one.deviations.unit.map_or(one.data.span, |unit| unit.span);
    measured.map(unit).or_else(|| {
        let square = squarenesses.iter().find(|one| one.motion == motion)?;
        let mut references = setup.measurements.iter().filter_map(|one| one.reference.as_ref());
        references.find(|name| name.value == square.reference).map(|name| name.span)
    })
}
