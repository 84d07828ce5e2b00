//! The report: an evaluation in words, in JSON and as a page with its pictures. In: an [`crate::Evaluation`]. Out: text. It
//! computes nothing.

mod head;
mod html;
mod json;
mod plots;
mod shown;
mod text;
mod words;

pub use html::html;
pub use json::json;
pub use text::text;
