//! Whether an error motion is small, as the equations of first order need it.
//!
//! In: a term as it was read. Out: a diagnostic where a number of it says that it is not.

use super::parameters::Context;
use super::term::CalibratedTerm;
use crate::diagnostic::Diagnostic;
use crate::source::Spanned;

/// The largest angle of an error motion, rad, except that of a rotary axis about itself. First order neglects half of its square: at a
/// distance of one metre, 50 um of the 10 mm by which such an angle displaces the tool.
pub const LARGEST_ANGLE: f64 = 0.010;

/// The largest displacement of an error motion, mm. An axis that is off by more than this has not been set up.
pub const LARGEST_DISPLACEMENT: f64 = 10.0;

/// Refuses a term whose own number says that it is no small error. The angle of a rotary axis itself may be large: an encoder may count
/// from another zero.
pub(super) fn refuse_large(term: &Spanned<CalibratedTerm>, context: &mut Context<'_>) {
    if context.motion.angular && context.motion.own {
        return;
    }
    let (largest, unit, per_unit) =
        if context.motion.angular { (LARGEST_ANGLE, "mrad", 1e3) } else { (LARGEST_DISPLACEMENT, "mm", 1.0) };
    let size = term.value.told_size();
    if size <= largest {
        return;
    }
    let name = &context.motion.name;
    let message = format!("{} {unit} is not a small error", short(size * per_unit));
    let reason = if context.motion.angular {
        "the equations are of first order and neglect half the square of an angle"
    } else {
        "no axis of a working machine is displaced this far"
    };
    let mistake = Diagnostic::error("E0430", term.span, message)
        .label(format!("{name} may be {} {unit} at most", short(largest * per_unit)))
        .help(format!("check the unit: {reason}"));
    context.diagnostics.push(mistake);
}

/// A number with three significant digits at least.
fn short(value: f64) -> String {
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
    }
}
