//! `abbe.h` is what the crate `abbe-c` and generated code offer. In: their sources. Out: the header, compared with the one
//! that is kept; with `UPDATE_HEADER=1` it is written.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

#[test]
fn the_header_is_that_of_the_sources() -> Result<(), Box<dyn Error>> {
    let interface = Path::new("../../c-interface");
    let opening = Path::new(env!("CARGO_TARGET_TMPDIR")).join("opening.rs");
    fs::write(&opening, abbe_model_dsl::c_library_for("mill.yaml")?)?;
    let config = cbindgen::Config::from_file(interface.join("cbindgen.toml"))?;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in ["src/status.rs", "src/abi.rs"] {
        builder = builder.with_src(interface.join(source));
    }
    let mut header = Vec::new();
    builder.with_src(opening).generate()?.write(&mut header);
    let header = String::from_utf8(header)?;
    let kept = interface.join("include/abbe.h");
    if env::var_os("UPDATE_HEADER").is_some() {
        fs::write(&kept, &header)?;
    }
    assert!(
        fs::read_to_string(&kept)? == header,
        "{} is not current: `UPDATE_HEADER=1 cargo test` in examples/c-controller writes it",
        kept.display()
    );
    Ok(())
}
