//! Generated code over numbers of 32 bits.
//!
//! In: the tokens of generated code. Out: the same tokens with `f32` in place of `f64`, the runtime's module of such numbers in place of
//! the runtime, and each number rounded once. It works on what the generator has written, so that there is one generator for both kinds of
//! numbers.

use std::fmt;

use proc_macro2::{Group, Ident, Literal, TokenStream, TokenTree};
use quote::quote;

/// The crate whose module `single` has everything again over numbers of 32 bits.
const RUNTIME: &str = "abbe_runtime";

/// A number of a machine or a calibration that has no like among those of 32 bits.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unfit {
    /// The number, in the unit of its place: mm, rad, s, degC or products of these.
    pub number: f64,
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:e} cannot be written in 32 bits: numbers there are 0, or between {:e} and {:e} in size",
            self.number,
            f32::MIN_POSITIVE,
            f32::MAX
        )
    }
}

impl std::error::Error for Unfit {}

/// The same code over numbers of 32 bits.
///
/// # Errors
/// The first number that is too large for them, or so small that they would lose digits of it.
pub fn single(tokens: TokenStream) -> Result<TokenStream, Unfit> {
    tokens.into_iter().map(of_tree).collect()
}

fn of_tree(tree: TokenTree) -> Result<TokenStream, Unfit> {
    Ok(match tree {
        TokenTree::Group(group) => TokenTree::from(of_group(&group)?).into(),
        // No name of a machine file is one of these: see `idents`.
        TokenTree::Ident(ident) if ident == "f64" => TokenTree::from(Ident::new("f32", ident.span())).into(),
        TokenTree::Ident(ident) if ident == RUNTIME => quote! { #ident::single },
        TokenTree::Literal(literal) => TokenTree::from(of_literal(literal)?).into(),
        other => other.into(),
    })
}

fn of_group(group: &Group) -> Result<Group, Unfit> {
    let mut single = Group::new(group.delimiter(), self::single(group.stream())?);
    single.set_span(group.span());
    Ok(single)
}

/// A number with a point is rounded; documentation that names the runtime names its module.
fn of_literal(literal: Literal) -> Result<Literal, Unfit> {
    let text = literal.to_string();
    if text.starts_with('"') {
        let named = text.replace(&format!("[`{RUNTIME}::"), &format!("[`{RUNTIME}::single::"));
        return Ok(named.parse().unwrap_or(literal));
    }
    match text.parse::<f64>() {
        Ok(number) if text.contains(['.', 'e']) => rounded(number).map(Literal::f32_unsuffixed),
        _ => Ok(literal),
    }
}

/// The nearest number of 32 bits.
fn rounded(number: f64) -> Result<f32, Unfit> {
    #[expect(
        clippy::cast_possible_truncation,
        reason = "digits are given up on purpose; what is beyond is refused"
    )]
    let single = number as f32;
    if number == 0.0 || single.is_normal() { Ok(single) } else { Err(Unfit { number }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(code: &str) -> Result<String, Unfit> {
        Ok(single(code.parse().unwrap())?.to_string())
    }

    #[test]
    fn types_paths_and_numbers() {
        let code = "fn error (& self , at : & [f64]) -> [f64 ; 3] { :: abbe_runtime :: math :: sin (at [0] * 0.1 + f64 :: NAN) }";
        let expected = "fn error (& self , at : & [f32]) -> [f32 ; 3] { :: abbe_runtime :: single :: math :: sin (at [0] * 0.1 + f32 :: NAN) }";
        let spelled = |code: &str| code.parse::<TokenStream>().unwrap().to_string();
        assert_eq!(text(code).unwrap(), spelled(expected));
    }

    /// A number of 64 bits is rounded once. Its shortest decimal, read as a number of 32 bits, may be another: the first one lies in the
    /// middle between 1, which is even, and the next number, and its decimal a little above.
    #[test]
    fn numbers_are_rounded_once_from_what_they_are() {
        let middle = 1.0 + 2.0_f64.powi(-24);
        assert_eq!(Literal::f64_unsuffixed(middle).to_string().parse(), Ok(1.0_f32.next_up()));
        for (number, expected) in
            [(middle, 1.0_f32), (0.1, 0.1), (55.0, 55.0), (1.0 / 3.0, 0.333_333_34), (1e-30, 1e-30)]
        {
            let found = text(&Literal::f64_unsuffixed(number).to_string()).unwrap();
            assert_eq!(found.parse(), Ok(expected), "{number}");
        }
        assert_eq!(text("- 1.5").unwrap(), "- 1.5");
        assert_eq!(text("0.0").unwrap(), "0.0");
        // Counts stay as they are.
        assert_eq!(text("16777217").unwrap(), "16777217");
    }

    #[test]
    fn what_has_no_like_is_refused() {
        for number in [1e39, 1e-39, 1e-50, f64::MAX, f64::MIN_POSITIVE] {
            let code = format!("[{}]", Literal::f64_unsuffixed(number));
            assert_eq!(text(&code), Err(Unfit { number }));
        }
        let said = Unfit { number: 1e-50 }.to_string();
        assert!(said.starts_with("1e-50 cannot be written in 32 bits"), "{said}");
    }

    #[test]
    fn documentation_names_the_module() {
        let code = "# [doc = \" For [`abbe_runtime::Exchanged`], as `f64` says.\"] struct Tool ;";
        let found = text(code).unwrap();
        assert!(found.contains("[`abbe_runtime::single::Exchanged`], as `f64` says."), "{found}");
    }
}
