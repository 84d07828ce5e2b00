//! Whether an error motion is small, as the equations of first order need it.
//!
//! In: a term as it was read. Out: a diagnostic where a number of it says that it is not.

use super::parameters::Context;
use super::term::{CalibratedTerm, SeriesInput};
use super::{MachineNames, MotionName};
use crate::diagnostic::Diagnostic;
use crate::source::{Span, Spanned};

/// The largest angle of an error motion, rad, except that of a rotary axis about itself. First order neglects half of its square: at a
/// distance of one metre, 50 um of the 10 mm by which such an angle displaces the tool.
pub const LARGEST_ANGLE: f64 = 0.010;

/// The largest displacement of an error motion, mm. An axis that is off by more than this has not been set up.
pub const LARGEST_DISPLACEMENT: f64 = 10.0;

/// The travel over which a term that grows is judged: mm for a slide, deg for a rotary axis, degC for a sensor. Every machine travels
/// further and gets warmer in its life.
const TRAVEL: f64 = 20.0;

/// Refuses a term whose own numbers say that it is no small error.
pub(super) fn refuse_large(term: &Spanned<CalibratedTerm>, context: &mut Context<'_>) {
    context.diagnostics.extend(not_small(term, context.motion, context.names));
}

/// What is wrong with a term whose own numbers say that it is no small error (E0430), at its place. The angle of a rotary axis itself may
/// be large: an encoder may count from another zero.
pub fn not_small(
    term: &Spanned<CalibratedTerm>,
    motion: &MotionName,
    names: &MachineNames,
) -> Option<Diagnostic> {
    if motion.angular && motion.own {
        return None;
    }
    let size = term.value.told_size();
    if size > largest(motion.angular) {
        let message = format!("{} is not a small error", told(size, motion.angular));
        return Some(refusal(term.span, motion, message));
    }
    let (size, over) = least_over(&term.value, names)?;
    if size > largest(motion.angular) {
        let told = told(size, motion.angular);
        let message = format!("an error that reaches {told} within any {over} is not small");
        return Some(refusal(term.span, motion, message));
    }
    None
}

fn refusal(place: Span, motion: &MotionName, message: String) -> Diagnostic {
    let MotionName { name, angular, .. } = motion;
    let reason = if *angular {
        "the equations are of first order and neglect half the square of an angle"
    } else {
        "no axis of a working machine is displaced this far"
    };
    Diagnostic::error("E0430", place, message)
        .label(format!("{name} may be {} at most", told(largest(*angular), *angular)))
        .help(format!("check the unit: {reason}"))
}

/// The largest error motion, mm or rad.
fn largest(angular: bool) -> f64 {
    if angular { LARGEST_ANGLE } else { LARGEST_DISPLACEMENT }
}

/// A size with its unit.
fn told(size: f64, angular: bool) -> String {
    let (unit, per_unit) = if angular { ("mrad", 1e3) } else { ("mm", 1.0) };
    format!("{} {unit}", short(size * per_unit))
}

/// The size, mm or rad, that a term which grows reaches at least, somewhere within any [`TRAVEL`] of what it grows with; and that travel
/// in words. None where it does not grow, or where states of the machine say how far.
///
/// A polynomial whose highest coefficient is c, of power n, is nowhere smaller over a travel T than 2 c (T/4)^n at its largest (Chebyshev):
/// all others can cancel it no further. Those others are large by themselves where an axis travels far from its zero.
fn least_over(term: &CalibratedTerm, names: &MachineNames) -> Option<(f64, String)> {
    let (highest, power, input) = term.growth()?;
    let (travel, over) = match input {
        SeriesInput::Axis(axis) if names.axes.get(axis).is_some_and(|axis| axis.rotary) => {
            (TRAVEL.to_radians(), format!("{TRAVEL} deg"))
        }
        SeriesInput::Axis(_) => (TRAVEL, format!("{TRAVEL} mm")),
        SeriesInput::Sensor(_) => (TRAVEL, format!("{TRAVEL} degC")),
    };
    let times = if power == 0 { 1.0 } else { 2.0 * (travel / 4.0).powi(i32::try_from(power).ok()?) };
    Some((highest.abs() * times, over))
}

/// A number with three significant digits at least.
fn short(value: f64) -> String {
    if value >= 1e6 {
        return format!("{value:.1e}");
    }
    let digits = if value < 10.0 { 2 } else { 0 };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn numbers_are_short() {
        assert_eq!([17.453_29, 785.4, 12.0, 10.0, 9.996].map(short), ["17", "785", "12", "10", "10"]);
        assert_eq!([999_999.0, 1e6, 1e297].map(short), ["999999", "1.0e6", "1.0e297"]);
    }
}
