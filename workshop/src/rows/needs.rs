//! What a calibration needs to know of rows besides positions. In: a calibration. Out: why it needs the time, where it does.

use model_dsl::calibration::factor::FactorPart;
use model_dsl::calibration::vocabulary::{self, Key, Kind};
use model_dsl::calibration::{CalibratedMotion, CalibratedTerm, Calibration, Factor, Part};

/// What of a calibration depends on the time between rows, in words; nothing where nothing does.
pub fn timed(calibration: &Calibration) -> Option<String> {
    calibration.motions.iter().find_map(timed_motion)
}

fn timed_motion(motion: &CalibratedMotion) -> Option<String> {
    let terms = motion.terms.iter().enumerate();
    let mut needing = terms.filter_map(|(place, term)| match needs_time(&term.value) {
        true => Some(format!("the term `{}` of the calibration", term.value.name())),
        false => (motion.ramp(place) > 0.0).then(|| "a `ramp` of the calibration".to_owned()),
    });
    needing.next()
}

/// Whether a term that is compensated reads a velocity, or follows something behind a time constant.
fn needs_time(term: &CalibratedTerm) -> bool {
    let entry = term.kind().entry();
    let filtered =
        term.factors().iter().flat_map(Factor::parts).any(|(key, part)| {
            key == "time_constant" && matches!(part, FactorPart::Amount(time) if time > 0.0)
        });
    let is_time = |key: &str| entry.key(key).and_then(Key::kind) == Some(Kind::TIME);
    let follows =
        |(key, part): (&str, Part<'_>)| is_time(key) && matches!(part, Part::Number(time) if time > 0.0);
    let needs = term.states().any(|(state, _)| state == vocabulary::State::Velocity)
        || term.parts().into_iter().any(follows)
        || filtered;
    needs && term.compensable()
}
