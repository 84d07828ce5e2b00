//! Compiles `lathe.yaml`, with the numbers of `lathe-7.yaml`, to Rust. In: both files. Out: `$OUT_DIR/lathe.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=lathe.yaml");
    println!("cargo::rerun-if-changed=lathe-7.yaml");
    let code = abbe_model_dsl::calibrated_rust_for("lathe.yaml", "lathe-7.yaml")?;
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("lathe.rs"), code)?)
}
