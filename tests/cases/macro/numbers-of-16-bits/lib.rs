//! A crate that asks for numbers of 16 bits, which Abbe does not generate.

/// The machine.
pub mod machine {
    abbe_macros::machine!("machine.yaml", f16);
}
