//! Text in markup. In: text as a terminal shows it. Out: the same as it may stand in a page, with the signs of print.

/// Text as it stands in a page; `+-` and `um` become their signs.
pub(super) fn escape(text: &str) -> String {
    let mut shown = pages::text::escape(text).replace(" +- ", " \u{b1} ");
    for end in [" ", ";", ",", ".", ")", "/"] {
        shown = shown.replace(&format!(" um{end}"), &format!(" \u{b5}m{end}"));
    }
    match shown.strip_suffix(" um") {
        Some(start) => format!("{start} \u{b5}m"),
        None => shown,
    }
}
