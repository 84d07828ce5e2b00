//! A crate that names a machine file.

/// The machine.
pub mod machine {
    abbe_macros::machine!("machine.yaml");
}
