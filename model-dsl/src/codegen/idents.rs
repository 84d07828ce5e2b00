//! Rust identifiers. In: names of axes, constants and motions. Out: fields in lower case.

use proc_macro2::{Ident, Span};

/// The field for a name: lower case, `-` as `_`, a trailing `_` where Rust has the word itself.
pub(super) fn field(name: &str) -> Ident {
    let lower = name.to_ascii_lowercase().replace('-', "_");
    match syn::parse_str::<Ident>(&lower) {
        Ok(ident) => ident,
        Err(_) => Ident::new(&format!("{lower}_"), Span::call_site()),
    }
}
