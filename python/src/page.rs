//! Pages in a notebook. In: a whole page. Out: the markup that a notebook shows.

use pages::text::escape;

/// How high a page stands in a notebook at first, pixels; its lower edge can be drawn.
const HEIGHT: u16 = 640;

/// A page in a frame of its own: its style reaches nothing beside it, and nothing beside it reaches its style.
pub(crate) fn framed(page: &str) -> String {
    format!(
        "<iframe srcdoc=\"{}\" sandbox=\"\" style=\"width:100%;height:{HEIGHT}px;border:0;resize:vertical;overflow:auto\"></iframe>",
        escape(page)
    )
}
