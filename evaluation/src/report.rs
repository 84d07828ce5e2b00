//! The report: an evaluation in words and in JSON. In: an [`crate::Evaluation`]. Out: text. It computes nothing.

mod json;
mod text;

pub use json::json;
pub use text::text;
