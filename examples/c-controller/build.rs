//! Compiles a machine file to a library for C. In: the file that `ABBE_MACHINE` names, else `mill.yaml`. Out: `$OUT_DIR/mill.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let machine = env::var("ABBE_MACHINE").unwrap_or_else(|_| "mill.yaml".into());
    println!("cargo::rerun-if-env-changed=ABBE_MACHINE");
    println!("cargo::rerun-if-changed={machine}");
    let code = abbe_model_dsl::c_library_for(machine)?;
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("mill.rs"), code)?)
}
