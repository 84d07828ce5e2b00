//! Dynamic measurements (`.rtx`): samples over time. In: the head of a file. Out: why it is no calibration, and what it is.
//!
//! Such a file holds one number for each instant and neither targets nor programmed positions. What the machine was told to
//! do at an instant, it does not say: no error can be taken from it without the commands, which a recording has.

use model_dsl::diagnostic::Diagnostic;

use super::cell::shown;
use super::section::sections;

/// The head of such a file ends within so many bytes.
pub(super) const HEAD: usize = 8 << 10;

/// Whether a text begins a file of samples.
pub(super) fn is_dynamic(text: &str) -> bool {
    let head = text.get(..text.floor_char_boundary(HEAD)).unwrap_or(text);
    let header = head.trim_start_matches('\u{feff}').trim_start().starts_with("HEADER::");
    header && (head.contains("-Dynamic") || head.contains("Sample rate"))
}

/// Why a file of samples is refused (E0922); nothing for another file.
pub(super) fn refusal(text: &str) -> Option<Diagnostic> {
    if !is_dynamic(text) {
        return None;
    }
    let head = text.get(..text.floor_char_boundary(HEAD)).unwrap_or(text);
    let sections = sections(head);
    let header = sections.first()?;
    let said = |key: &str| header.entry(key).map_or_else(|| "?".to_owned(), |value| shown(value.text));
    let message = format!(
        "this is a dynamic measurement: {} samples at {} Hz, without targets or programmed positions",
        said("Sample no"),
        said("Actual sample rate")
    );
    let help = "use a measurement at targets; for a moving axis, write time, command and sample as CSV, and run `abbe diagnose`";
    Some(Diagnostic::error("E0922", header.span, message).help(help))
}
