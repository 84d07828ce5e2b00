//! The crate holds what the compiler writes now. In: the machine files, and the modules that the build script made of them.
//! Out: nothing stale, and a module for every file.

use std::fs;
use std::path::Path;

#[test]
fn every_machine_is_compiled_as_the_compiler_compiles_it() {
    let built = include_str!(concat!(env!("OUT_DIR"), "/machines.rs"));
    let machines = fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines")).unwrap();
    let mut compiled = 0;
    for file in machines.map(|entry| entry.unwrap().path()) {
        if file.extension().is_some_and(|extension| extension == "yaml") {
            assert!(built.contains(&model_dsl::rust_for(&file).unwrap()), "{}", file.display());
            compiled += 1;
        }
    }
    assert_eq!(built.matches("\npub mod ").count(), compiled, "a module for each machine");
}
