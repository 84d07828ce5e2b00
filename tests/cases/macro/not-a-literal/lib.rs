//! A crate that names no machine file.

/// The machine.
pub mod machine {
    abbe_macros::machine!(FILE);
}
