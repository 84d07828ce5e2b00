//! `machine!("path")`: the macro's door to the compiler.
//!
//! In: the path of a machine file, from the root of the crate that uses the macro, that of a calibration where one is to
//! be compiled in, and `f32` where numbers are to have 32 bits. Out: the items of that machine (`Machine`, `Constants`, `Axes`, `Motions`) and of the calibration
//! (`Calibration`, `Sensors`), the same tokens that a build script gets. The files are tracked: a change in one compiles the
//! crate again. Mistakes in them are reported at the literals, with their places in the files.

use std::path::{Path, PathBuf};

use model_dsl::source::SourceFile;
use proc_macro::TokenStream;
use quote::quote;
use syn::parse::{Parse, ParseStream};
use syn::{Ident, LitStr, Token, parse_macro_input};

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
///
/// A second path compiles a calibration of the machine in: its numbers become the constants of a struct `Calibration`,
/// which [`Compensator::with_calibration`](../abbe_runtime/struct.Compensator.html#method.with_calibration) takes.
///
/// ```
/// mod stage {
///     abbe_macros::machine!("../tests/fixtures/stage.yaml", "../tests/fixtures/calibrations/stage.yaml");
/// }
/// use abbe_runtime::ErrorMotions;
/// # fn main() {
/// assert_eq!(stage::Calibration.motions().len(), stage::Motions::NAMES.len());
/// # }
/// ```
/// With `f32` behind the paths, all numbers have 32 bits, for controllers whose processor knows no others. The code is then one of the
/// module `abbe_runtime::single`, which is there with the feature `single` of `abbe-runtime`.
///
/// ```
/// mod stage {
///     abbe_macros::machine!("../tests/fixtures/stage.yaml", f32);
/// }
/// # fn main() {
/// let stage = stage::Machine { constants: stage::Constants { xt: 1.0, yt: 0.0, zt: 50.0 } };
/// let motions = stage::Motions { exx: 0.004, ebx: 10e-6, ..Default::default() };
/// let error: [f32; 3] = stage.error(&stage::Axes { x: 20.0 }, &motions);
/// assert!((error[0] - 0.0045).abs() < 1e-8);
/// # }
/// ```
#[proc_macro]
pub fn machine(input: TokenStream) -> TokenStream {
    let files = parse_macro_input!(input as Files);
    expand(&files).unwrap_or_else(|error| error.to_compile_error()).into()
}

/// What the macro is given.
struct Files {
    machine: LitStr,
    calibration: Option<LitStr>,
    /// Whether numbers have 32 bits, and where it says so.
    single: Option<Ident>,
}

impl Parse for Files {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        let machine = input.parse()?;
        let calibration = behind_a_comma(input, |input| input.peek(LitStr))?;
        let single: Option<Ident> = behind_a_comma(input, |input| input.peek(Ident))?;
        if let Some(other) = single.as_ref().filter(|single| **single != "f32") {
            return Err(syn::Error::new(
                other.span(),
                "expected `f32`, or nothing where numbers have 64 bits",
            ));
        }
        input.parse::<Option<Token![,]>>()?;
        Ok(Self { machine, calibration, single })
    }
}

/// The next argument, if it is one that is expected; a comma in front of what is not stays where it is.
fn behind_a_comma<T: Parse>(
    input: ParseStream<'_>,
    expected: impl Fn(ParseStream<'_>) -> bool,
) -> syn::Result<Option<T>> {
    let ahead = input.fork();
    let comma = ahead.parse::<Option<Token![,]>>()?;
    if comma.is_none() || !expected(&ahead) {
        return Ok(None);
    }
    input.parse::<Token![,]>()?;
    input.parse().map(Some)
}

/// A file that the macro is given: its text, its place, and the item by which a change in it compiles the crate again.
struct Opened {
    source: SourceFile,
    folder: PathBuf,
    tracked: proc_macro2::TokenStream,
}

fn expand(files: &Files) -> syn::Result<proc_macro2::TokenStream> {
    let Opened { source, tracked, .. } = open(&files.machine)?;
    let at_machine = |message: String| syn::Error::new(files.machine.span(), message);
    let (tokens, equations, warnings) = model_dsl::rust_tokens(&source).map_err(at_machine)?;
    show(&warnings);
    let Some(calibration) = &files.calibration else {
        let tokens = files.numbers(tokens)?;
        return Ok(quote! { #tracked #tokens });
    };
    let Opened { source, folder, tracked: tracked_too } = open(calibration)?;
    let (tokens, warnings) = model_dsl::calibrated_rust_tokens(&equations, &source, Some(&folder))
        .map_err(|message| syn::Error::new(calibration.span(), message))?;
    show(&warnings);
    let tokens = files.numbers(tokens)?;
    Ok(quote! { #tracked #tracked_too #tokens })
}

impl Files {
    /// The code over the numbers that are asked for.
    fn numbers(&self, tokens: proc_macro2::TokenStream) -> syn::Result<proc_macro2::TokenStream> {
        match &self.single {
            None => Ok(tokens),
            Some(single) => {
                model_dsl::codegen::single(tokens).map_err(|unfit| syn::Error::new(single.span(), unfit))
            }
        }
    }
}

/// Opens a file; what is wrong with it is told at the literal.
fn open(literal: &LitStr) -> syn::Result<Opened> {
    let at_literal = |message: String| syn::Error::new(literal.span(), message);
    let path = resolve(&literal.value());
    let text = std::fs::read_to_string(&path)
        .map_err(|error| at_literal(format!("cannot read {}: {error}", path.display())))?;
    let Some(name) = path.to_str() else {
        return Err(at_literal("the path of the file is not UTF-8".to_owned()));
    };
    let tracked = quote! { const _: &str = include_str!(#name); };
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    Ok(Opened { source: SourceFile::new(literal.value(), text), folder, tracked })
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

    use super::{Files, expand};

    /// The macro's tokens, printed as a file, are what a build script writes, after the item that tracks the file.
    #[test]
    fn the_macro_and_a_build_script_give_the_same_tokens() {
        let machines = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
        let mut seen = 0;
        for entry in std::fs::read_dir(machines).expect("the shipped machines") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a file").to_string_lossy().into_owned();
            let machine = LitStr::new(&format!("../machines/{name}"), Span::call_site());
            let files = Files { machine, calibration: None, single: None };
            let expanded = codegen::file(&expand(&files).expect("a valid machine"), &name).expect("a file");
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
