//! Compiles `mill.yaml` to a library for C. In: the machine file. Out: `$OUT_DIR/mill.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=mill.yaml");
    let code = model_dsl::c_library_for("mill.yaml")?;
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("mill.rs"), code)?)
}
