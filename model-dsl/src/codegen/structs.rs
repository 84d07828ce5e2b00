//! The typed records of a machine: constants, positions, travels and error motions.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use super::body::number;
use super::docs;
use super::idents::field;
use crate::equations::Equations;
use crate::sheet::followed;

/// All records, and the machine itself.
pub(super) fn all(equations: &Equations) -> TokenStream {
    let constants = constants(equations);
    let axes = axes(equations);
    let travels = travels(equations);
    let motions = motions(equations);
    let about = docs::attributes(&docs::machine(equations));
    quote! {
        #constants
        #axes
        #travels
        #motions
        #about
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Machine {
            /// The values of the named offsets.
            pub constants: Constants,
        }
    }
}

/// A record of numbers with its names and its conversions from and to an array. `derives_default` where the default of all is 0.
fn record(name: &str, about: &str, fields: &[(String, String)], derives_default: bool) -> TokenStream {
    let ident = format_ident!("{name}");
    let count = Literal::usize_unsuffixed(fields.len());
    let idents: Vec<_> = fields.iter().map(|(name, _)| field(name)).collect();
    let docs: Vec<_> = fields.iter().map(|(_, doc)| docs::attributes(doc)).collect();
    let about = docs::attributes(about);
    let names: Vec<_> = fields.iter().map(|(name, _)| name).collect();
    let derived = if derives_default {
        quote! { Default, }
    } else {
        quote! {}
    };
    quote! {
        #about
        #[derive(Clone, Copy, Debug, #derived PartialEq)]
        pub struct #ident {
            #(#docs pub #idents: f64,)*
        }
        impl #ident {
            /// The names, in the order of the array.
            pub const NAMES: [&'static str; #count] = [#(#names),*];
            /// The record from an array.
            #[must_use]
            pub const fn from_array([#(#idents),*]: [f64; #count]) -> Self {
                Self { #(#idents),* }
            }
            /// The record as an array.
            #[must_use]
            pub const fn to_array(self) -> [f64; #count] {
                [#(self.#idents),*]
            }
        }
    }
}

fn constants(equations: &Equations) -> TokenStream {
    let fields: Vec<_> = equations
        .constants
        .iter()
        .map(|constant| {
            if constant.direction.is_some() {
                let meaning = constant.meaning.as_deref().unwrap_or("a part of the direction of the tool");
                return (constant.name.to_string(), format!("{}: {meaning} \\[1\\].", constant.name));
            }
            let meaning = constant.meaning.as_deref().unwrap_or("a named offset of the chain");
            (constant.name.to_string(), format!("{}: {meaning} \\[mm\\].", constant.name))
        })
        .collect();
    let values: Vec<Option<f64>> = equations.constants.iter().map(|constant| constant.default).collect();
    if values.iter().all(Option::is_none) {
        return record("Constants", "The named offsets of the machine.", &fields, true);
    }
    let about = "The named offsets of the machine. Each defaults to its value in the machine file, or to 0 if the file gives none.";
    let record = record("Constants", about, &fields, false);
    let values = values.into_iter().map(Option::unwrap_or_default).map(number);
    quote! {
        #record
        impl Default for Constants {
            fn default() -> Self {
                Self::from_array([#(#values),*])
            }
        }
    }
}

fn axes(equations: &Equations) -> TokenStream {
    let fields: Vec<_> = equations
        .axes
        .iter()
        .map(|axis| {
            let unit = if axis.rotary { "rad" } else { "mm" };
            (
                axis.variable.to_string(),
                match axis.is_motor() {
                    true => format!(
                        "The travel of motor {} \\[{unit}\\]: {}.",
                        axis.letter,
                        followed(equations, axis)
                    ),
                    false => format!("The programmed position of axis {} \\[{unit}\\].", axis.letter),
                },
            )
        })
        .collect();
    record("Axes", "The programmed positions of the axes.", &fields, true)
}

fn travels(equations: &Equations) -> TokenStream {
    if equations.travels.is_empty() {
        return TokenStream::new();
    }
    let fields: Vec<_> = equations
        .travels
        .iter()
        .map(|travel| {
            let axis = &equations.axes[travel.axis].letter;
            let doc = format!("The travel of axis {axis} over which an alignment error acts \\[mm\\].");
            (travel.name.to_string(), doc)
        })
        .collect();
    record("Travels", "Free travels in the lever arms of alignment errors.", &fields, true)
}

fn motions(equations: &Equations) -> TokenStream {
    let fields: Vec<_> =
        equations.motions.iter().map(|motion| (motion.name.clone(), docs::motion(motion))).collect();
    record("Motions", "The error motions: how each link deviates from its commanded motion.", &fields, true)
}
