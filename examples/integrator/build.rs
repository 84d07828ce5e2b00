//! Compiles `lathe.yaml` to Rust. In: the machine file. Out: `$OUT_DIR/lathe.rs`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=lathe.yaml");
    let code = model_dsl::rust_for("lathe.yaml")?;
    Ok(fs::write(Path::new(&env::var("OUT_DIR")?).join("lathe.rs"), code)?)
}
