//! The report: an evaluation in words, in JSON and as a page with its pictures. In: an [`crate::Evaluation`]. Out: text. It
//! computes nothing.

mod html;
mod json;
mod plots;
mod text;
mod words;

pub use html::html;
pub use json::json;
pub use text::text;
