//! The report: a diagnosis in words.
//!
//! In: a [`Diagnosis`]. Out: the object `abbe-diagnosis/1` for programs ([`json`]), text for a terminal ([`text()`]), and a
//! page for a browser ([`html`]). Text and page say the same: both write the sections that `sheet` puts together; the page
//! has plots besides. Nothing is decided here; what was found stands in the diagnosis.
//!
//! ```text
//! diagnosis -> json
//!          |-> sheet (verdict, findings, instruments, what remains, data) -> text (with a table of the findings), html
//!          '-> plots -> html
//! ```

mod brief;
mod data;
mod element;
pub(crate) mod figure;
mod files;
mod finding;
mod html;
mod instrument;
mod item;
mod json;
mod lines;
mod parameter;
mod physics;
mod plots;
mod remains;
mod sheet;
mod style;
mod text;
mod verdict;

pub use figure::size;
pub use html::{Origin, html};
pub use json::json;
pub use lines::{WIDTH, paragraph, plain};
pub use text::{Terminal, text, text_on};

use crate::diagnosis::{Alternative, Diagnosis};

/// The most other names that are told. A list of everything names nothing.
const ALTERNATIVES: usize = 4;

/// The verdict in one line of plain words, without the end of the sentence.
pub fn verdict(diagnosis: &Diagnosis) -> String {
    verdict::sentence(diagnosis)
}

/// The other names that are told.
fn told(alternatives: &[Alternative]) -> impl Iterator<Item = &Alternative> {
    alternatives.iter().take(ALTERNATIVES)
}
