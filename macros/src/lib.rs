//! `machine!("path")`: the macro's door to the compiler.
//!
//! In: the path of a machine file, from the root of the crate that uses the macro. Out: the
//! items of that machine (`Machine`, `Constants`, `Axes`, `Motions`), the same tokens that a
//! build script gets. The file is tracked: a change in it compiles the crate again. Mistakes
//! in it are reported at the literal, with their places in the file.

use std::path::{Path, PathBuf};

use proc_macro::TokenStream;
use quote::quote;
use syn::{LitStr, parse_macro_input};

/// Compiles a machine file into the module where the macro stands.
///
/// The crate needs `abbe-runtime` as a dependency, for sines and cosines and for the interface
/// of its compensator.
///
/// ```
/// /// A single stage.
/// mod stage {
///     abbe_macros::machine!("../tests/fixtures/stage.yaml");
/// }
/// # fn main() {
/// let stage = stage::Machine { constants: stage::Constants { xt: 1.0, yt: 0.0, zt: 50.0 } };
/// let axes = stage::Axes { x: 20.0 };
/// let motions = stage::Motions { exx: 0.004, ebx: 10e-6, ..Default::default() };
/// // The pitch of 10 urad acts over 50 mm: 4 um + 0.5 um.
/// assert!((stage.error(&axes, &motions)[0] - 0.0045).abs() < 1e-12);
/// # }
/// ```
#[proc_macro]
pub fn machine(input: TokenStream) -> TokenStream {
    let literal = parse_macro_input!(input as LitStr);
    expand(&literal).unwrap_or_else(|error| error.to_compile_error()).into()
}

fn expand(literal: &LitStr) -> Result<proc_macro2::TokenStream, syn::Error> {
    let at_literal = |message: String| syn::Error::new(literal.span(), message);
    let path = resolve(&literal.value());
    let text = std::fs::read_to_string(&path)
        .map_err(|error| at_literal(format!("cannot read {}: {error}", path.display())))?;
    let source = model_dsl::source::SourceFile::new(literal.value(), text);
    let (tokens, _, warnings) = model_dsl::rust_tokens(&source).map_err(at_literal)?;
    show(&warnings);
    let Some(tracked) = path.to_str() else {
        return Err(at_literal("the path of the machine file is not UTF-8".to_owned()));
    };
    Ok(quote! {
        const _: &str = include_str!(#tracked);
        #tokens
    })
}

/// Shows warnings where the compiler shows its own; a macro has no other way on stable Rust.
#[expect(clippy::print_stderr, reason = "a macro cannot emit a warning of its own on stable Rust")]
fn show(warnings: &str) {
    eprint!("{warnings}");
}

/// A path is counted from the root of the crate that is being compiled.
fn resolve(path: &str) -> PathBuf {
    let root = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    root.join(Path::new(path))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use model_dsl::codegen;
    use proc_macro2::Span;
    use syn::LitStr;

    use super::expand;

    /// The macro's tokens, printed as a file, are what a build script writes, after the item that tracks the file.
    #[test]
    fn the_macro_and_a_build_script_give_the_same_tokens() {
        let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
        let mut seen = 0;
        for entry in std::fs::read_dir(machines).expect("the shipped machines") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a file").to_string_lossy().into_owned();
            let literal = LitStr::new(&format!("../machines/{name}"), Span::call_site());
            let expanded = codegen::file(&expand(&literal).expect("a valid machine"), &name).expect("a file");
            let built = model_dsl::rust_for(&path).expect("a valid machine");
            let (banner, built) = built.split_once("\n\n").expect("a banner");
            let rest = expanded.strip_prefix(banner).expect("the same banner").trim_start();
            // How the first item is wrapped depends on the length of the path.
            let (tracked, items) = rest.split_once(";\n").expect("an item that tracks the file");
            assert!(
                tracked.starts_with("const _: &str = include_str!(") && tracked.contains(&name),
                "{tracked}"
            );
            assert_eq!(items, built, "{name}");
            seen += 1;
        }
        assert!(seen > 0);
    }
}
