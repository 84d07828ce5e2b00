//! Limits in words. In: what a recording could show. Out: text for a terminal, a page, or the object `abbe-limits/1`.

mod html;
mod json;
mod text;
mod words;

pub use html::html;
pub use json::json;
pub use text::text;
