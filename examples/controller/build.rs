//! Compiles the five-axis machine, and a calibration with every kind of term, to Rust. In: their files. Out:
//! `$OUT_DIR/machine.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let (machine, calibration) = ("../../machines/head-table-5axis.yaml", "numbers.yaml");
    println!("cargo::rerun-if-changed={machine}");
    println!("cargo::rerun-if-changed={calibration}");
    let code = abbe_model_dsl::calibrated_rust_for(machine, calibration)?;
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("machine.rs"), code)?)
}
