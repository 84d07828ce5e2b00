//! The style of plots. In: nothing. Out: rules for their classes; and those with the colours, for files of their own.

use crate::shell::COLOURS;

/// The rules of the classes in plots, for the style of a page.
pub const RULES: &str = "\
svg { overflow: visible; }
svg text { fill: var(--ink); }
svg .t { font-weight: 600; }
svg .q { fill: var(--quiet); }
svg .o { paint-order: stroke; stroke: var(--paper); stroke-width: 4px; stroke-linejoin: round; }
svg .e { text-anchor: end; } svg .mid { text-anchor: middle; }
svg .c1 { --c: var(--one); } svg .c2 { --c: var(--two); } svg .c3 { --c: var(--three); } svg .c4 { --c: var(--four); }
svg .ci { --c: var(--ink); } svg .cq { --c: var(--quiet); }
svg .l { fill: none; stroke: var(--c); stroke-width: 1.5; stroke-linejoin: round; stroke-linecap: round; }
svg .m { fill: var(--c); }
svg .h { fill: none; stroke: var(--c); stroke-width: 1; }
svg .g { fill: none; stroke: var(--line); stroke-width: .6; }
svg .f { fill: none; stroke: var(--quiet); stroke-width: 1; }
svg .v { fill: none; stroke: var(--ink); stroke-width: 1; stroke-dasharray: 2 3; }
svg .b { fill: var(--band); stroke: var(--line); stroke-width: .6; }
";

/// The style of a drawing that is a file of its own: colours that follow light, dark and print, and the rules.
pub fn style() -> String {
    format!("{COLOURS}svg {{ background: var(--paper); font: 12px system-ui, sans-serif; }}\n{RULES}")
}
