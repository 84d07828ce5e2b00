//! Compiles every machine of `machines/` into one module each, in `OUT_DIR/machines.rs`.
//!
//! In: `../machines/*.yaml`. Out: Rust modules in order of their names. It runs again only
//! when that folder or a file in it changes.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
    println!("cargo::rerun-if-changed={}", machines.display());
    let mut files: Vec<PathBuf> =
        fs::read_dir(&machines)?.map(|entry| entry.map(|entry| entry.path())).collect::<Result<_, _>>()?;
    files.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    files.sort();
    let mut modules = String::new();
    for file in &files {
        println!("cargo::rerun-if-changed={}", file.display());
        modules.push_str(&module(file)?);
    }
    fs::write(Path::new(&std::env::var("OUT_DIR")?).join("machines.rs"), modules)?;
    Ok(())
}

/// One module: a line of documentation and the code of the machine.
fn module(path: &Path) -> Result<String, Box<dyn Error>> {
    let code = model_dsl::rust_for(path)?;
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let name = stem.replace('-', "_");
    Ok(format!(
        "/// The machine `{stem}`, compiled from `machines/{stem}.yaml`.\npub mod {name} {{\n{code}}}\n"
    ))
}
