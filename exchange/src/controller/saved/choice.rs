//! Which of several things of a kind is meant. In: their names, and the one that the user names. Out: it; or what to write.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};

use crate::controller::lines::Line;

/// The only one, or that of the name; nothing, and no finding, where there is none and none is asked for.
///
/// Findings: E0804 several without a name, or a name that none of them has.
pub(super) fn one_of<'a, T>(
    all: &'a [(Line<'_>, T)],
    wanted: Option<&str>,
    (key, what): (&str, &str),
    diagnostics: &mut Diagnostics,
) -> Option<&'a T> {
    let names: Vec<&str> = all.iter().map(|(name, _)| name.text).collect();
    match (wanted, all) {
        (Some(wanted), _) => {
            let found = all.iter().find(|(name, _)| name.text == wanted);
            if found.is_none() {
                let message = format!("the file has no {what} `{wanted}`");
                let help = match names.as_slice() {
                    [] => format!("leave `{key}` out: the file has no {what} at all"),
                    names => format!("it has {}", names.join(", ")),
                };
                diagnostics.push(Diagnostic::error("E0804", Default::default(), message).help(help));
            }
            found.map(|(_, found)| found)
        }
        (None, []) => None,
        (None, [(_, only)]) => Some(only),
        (None, [_, (second, _), ..]) => {
            let message = format!("the file has {} of the kind {what}: {}", all.len(), names.join(", "));
            let help = format!("choose one: `{key}: {}`", names.first().unwrap_or(&"default"));
            diagnostics.push(Diagnostic::error("E0804", second.span, message).help(help));
            None
        }
    }
}
