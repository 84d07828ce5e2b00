//! Pages: what engineers look at. In: headings, text and figures of any part of Abbe. Out: one HTML file that opens anywhere:
//! its style inside, no script, nothing fetched; drawings as SVG in the same colours as the page, on screen and in print.
//!
//! It exists so that all pages look alike and follow the reader's light or dark setting. It depends on nothing, since the
//! compiler depends on it, and computes nothing of a machine.

pub mod plot;
pub mod shell;
pub mod svg;
pub mod text;
