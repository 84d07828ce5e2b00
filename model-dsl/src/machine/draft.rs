//! The chain while it is being read: links that are known, and their `errors` that are not yet.

use super::link::Link;
use super::pointing::Parts;
use crate::source::{Span, Spanned};
use crate::yaml::Node;

/// The links of a machine in order.
pub(super) struct Chain<'n> {
    pub(super) topology: Option<String>,
    pub(super) links: Vec<DraftedLink<'n>>,
}

/// A link, and what is still to be read of it.
pub(super) struct DraftedLink<'n> {
    pub(super) link: Link,
    pub(super) origin_spans: [Span; 3],
    pub(super) errors: Option<&'n Node>,
    /// The names of the parts of the tool's direction, where tools have one each.
    pub(super) direction: Option<Parts>,
    /// The motors of a beam.
    pub(super) drives: Option<(&'n Spanned<String>, &'n Node)>,
}
