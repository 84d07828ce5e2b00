//! Rust identifiers. In: names of axes, constants and motions. Out: fields in lower case.

use proc_macro2::{Ident, Span};

/// The field for a name: lower case, `-` as `_`, and a `_` before a word of Rust itself or of generated code, which no
/// name of a machine file can begin with.
pub(super) fn field(name: &str) -> Ident {
    let lower = name.to_ascii_lowercase().replace('-', "_");
    match syn::parse_str::<Ident>(&lower) {
        Ok(ident) if lower != RESERVED_SINCE_2024 && !OF_THE_CODE.contains(&&*lower) => ident,
        _ => Ident::new(&format!("_{lower}"), Span::call_site()),
    }
}

/// A word of Rust since its edition of 2024, which `syn` takes for a name.
const RESERVED_SINCE_2024: &str = "gen";

/// Words of generated code that are exchanged where it is to be over other numbers: none of them is a name.
const OF_THE_CODE: [&str; 3] = ["f64", "f32", "abbe_runtime"];
