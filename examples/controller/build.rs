//! Compiles the five-axis machine, and a calibration with every kind of term, to Rust. In: their files, and with the feature `f32` that
//! numbers are to have 32 bits. Out: `$OUT_DIR/machine.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let (machine, calibration) = ("../../machines/head-table-5axis.yaml", "numbers.yaml");
    println!("cargo::rerun-if-changed={machine}");
    println!("cargo::rerun-if-changed={calibration}");
    let code = if env::var_os("CARGO_FEATURE_F32").is_some() {
        abbe_model_dsl::single::calibrated_rust_for(machine, calibration)?
    } else {
        abbe_model_dsl::calibrated_rust_for(machine, calibration)?
    };
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("machine.rs"), code)?)
}
