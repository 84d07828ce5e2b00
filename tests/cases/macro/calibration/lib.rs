//! A crate that names a machine file and a calibration.

/// The machine.
pub mod machine {
    abbe_macros::machine!("machine.yaml", "numbers.yaml");
}
