//! Files of instruments. In: the bytes of a file. Out: its readings, or what is wrong with it, at its place.

mod cell;
mod dynamic;
mod renishaw;
mod section;
mod table;

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{SourceFile, Span};

use super::Measured;
pub use table::Columns;

/// The bytes of an instrument's file as text. What is not UTF-8 stands in free text alone, such as an operator's name in an
/// older encoding, and becomes U+FFFD: numbers and keys are ASCII in all of them.
pub fn text(name: &str, bytes: &[u8]) -> SourceFile {
    SourceFile::new(name, String::from_utf8_lossy(bytes))
}

/// Reads the file of an instrument: Renishaw's text with sections (`.rtl`, `.rta` and its relatives), or a plain table. The
/// content decides which it is, not the name.
///
/// Findings: E0921 to E0929, W0901, W0902. Nothing is returned where one is an error.
pub fn read(source: SourceFile, columns: &Columns<'_>, diagnostics: &mut Diagnostics) -> Option<Measured> {
    let mut own = Diagnostics::new();
    let measured = read_any(source, columns, &mut own);
    let failed = own.has_errors();
    diagnostics.extend(own);
    measured.filter(|_| !failed)
}

fn read_any(source: SourceFile, columns: &Columns<'_>, diagnostics: &mut Diagnostics) -> Option<Measured> {
    if let Some(mistake) = unreadable(&source) {
        diagnostics.push(mistake);
        return None;
    }
    match section::is_sectioned(source.text()) {
        true => renishaw::read(source, diagnostics),
        false => table::read(source, columns, diagnostics),
    }
}

/// Whether the bytes begin a text in sections, as Renishaw writes it.
pub fn is_sectioned(bytes: &[u8]) -> bool {
    section::is_sectioned(&String::from_utf8_lossy(bytes.get(..dynamic::HEAD).unwrap_or(bytes)))
}

/// Whether the bytes begin a file that is refused whatever follows: samples of a dynamic measurement.
pub fn is_dynamic(bytes: &[u8]) -> bool {
    dynamic::is_dynamic(&String::from_utf8_lossy(bytes.get(..dynamic::HEAD).unwrap_or(bytes)))
}

fn unreadable(source: &SourceFile) -> Option<Diagnostic> {
    let text = source.text();
    let start = Span::new(0, text.find('\n').unwrap_or(text.len()).min(200));
    let start = Span::new(0, text.floor_char_boundary(start.end));
    if text.trim().is_empty() {
        let empty = Diagnostic::error("E0921", Span::default(), "the file is empty");
        return Some(empty.help("give the file that the instrument wrote"));
    }
    if let Some(dynamic) = dynamic::refusal(text) {
        return Some(dynamic);
    }
    if text.contains('\0') || text.starts_with('\u{fffd}') {
        let message = "this is not a text with targets and deviations";
        let help = "give a Renishaw `.rtl` or `.rta` file, or a table as CSV in UTF-8";
        return Some(Diagnostic::error("E0921", start, message).help(help));
    }
    None
}
