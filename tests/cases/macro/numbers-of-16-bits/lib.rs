//! A crate that asks for numbers that there are not.

/// The machine.
pub mod machine {
    abbe_macros::machine!("machine.yaml", f16);
}
