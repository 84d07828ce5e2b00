//! What becomes of the direction of the tool. In: the word `orientation` of a machine file. Out: whether that direction is derived beside
//! the tip, and whether rotary axes correct it. It exists apart since a table that is clamped while the machine cuts is told of, and
//! left where it is.

/// What becomes of the direction of the tool.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Orientation {
    /// It is not derived.
    #[default]
    Left,
    /// It is derived and told, and no axis corrects it (`orientation: uncorrected`).
    Told,
    /// It is derived, and the rotary axes that correct anything correct it (`orientation: true`).
    Corrected,
}

impl Orientation {
    /// Whether the direction of the tool is derived beside its tip.
    pub const fn is_derived(self) -> bool {
        !matches!(self, Self::Left)
    }
}
