//! Compiles the five-axis machine to Rust. In: its machine file. Out: `$OUT_DIR/machine.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let file = "../../machines/head-table-5axis.yaml";
    println!("cargo::rerun-if-changed={file}");
    let code = model_dsl::rust_for(file)?;
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("machine.rs"), code)?)
}
