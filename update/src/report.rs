//! The report: an update in words and in JSON. In: an [`crate::Update`]. Out: text. It computes nothing.

mod json;
mod text;

pub use json::json;
pub use text::text;
