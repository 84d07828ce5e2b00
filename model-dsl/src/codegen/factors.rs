//! Factors as code. In: the factors of a term. Out: tokens of them as the runtime has them.

use proc_macro2::{Literal, TokenStream};
use quote::{ToTokens, format_ident, quote};

use super::body::number;
use super::calibration::{numbers, table_of, type_name};
use super::sensors::Numbered;
use crate::calibration::factor::FactorPart;
use crate::calibration::{Factor, Within};

/// A factor with its numbers, as a term of the list: the runtime calls factors and their fields as the vocabulary does.
pub(super) fn factor(factor: &Factor, sensors: &Numbered) -> TokenStream {
    let fields = match factor {
        Factor::Curve { axis, at, values } => {
            let (axis, at, values) = (Literal::usize_unsuffixed(*axis), numbers(at), numbers(values));
            let table = table_of(&quote! { at(#at, ::abbe_runtime::Values::Both(#values)) });
            quote! { axis: #axis, table: #table }
        }
        plain => {
            let fields = plain.parts().into_iter().filter_map(|(key, part)| field(key, &part, sensors));
            quote! { #(#fields),* }
        }
    };
    let name = type_name(factor.kind().name());
    quote! { ::abbe_runtime::Term::Factor(::abbe_runtime::Factor::#name { #fields }) }
}

/// A field of the runtime's factor; nothing for what no factor there has.
fn field(key: &str, part: &FactorPart<'_>, sensors: &Numbered) -> Option<TokenStream> {
    let (name, value) = match *part {
        FactorPart::Axis(axis) => ("axis", Literal::usize_unsuffixed(axis).into_token_stream()),
        FactorPart::Sensor(sensor) => {
            ("sensor", Literal::usize_unsuffixed(sensors.number(sensor)).into_token_stream())
        }
        FactorPart::Power(power) => (key, Literal::u8_unsuffixed(power).into_token_stream()),
        FactorPart::Amount(value) => (key, number(value)),
        FactorPart::Range(within) => (key, range(within)),
        FactorPart::List(_) | FactorPart::Load(_) => return None,
    };
    let name = format_ident!("{name}");
    Some(quote! { #name: #value })
}

fn range(within: Within) -> TokenStream {
    if within == Within::EVERYWHERE {
        return quote! { ::abbe_runtime::Within::EVERYWHERE };
    }
    let (from, to) = (number(within.from), number(within.to));
    quote! { ::abbe_runtime::Within { from: #from, to: #to } }
}
