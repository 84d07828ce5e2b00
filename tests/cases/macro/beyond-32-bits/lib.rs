//! A crate whose calibration has a number that cannot be written in 32 bits.

/// The machine.
pub mod machine {
    abbe_macros::machine!("machine.yaml", "numbers.yaml", f32);
}
