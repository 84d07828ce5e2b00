//! The functions of a machine: position, error, lever arms, directions, and the interface that
//! the runtime's compensator calls.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::{Body, Numbers, body};
use super::docs;
use super::structs::of_any;
use crate::equations::Equations;
use crate::program::Programs;

/// All functions of a machine.
pub(super) fn all(equations: &Equations, programs: &Programs) -> TokenStream {
    let nominal = nominal(equations, programs);
    let error = error(equations, programs);
    let levers = levers(equations, programs);
    let directions = directions(equations, programs);
    let kinematics = kinematics(equations, programs);
    let name = &equations.machine;
    quote! {
        impl Machine {
            /// The machine's name, by which calibrations refer to it.
            pub const NAME: &'static str = #name;
            #nominal
            #error
            #levers
            #directions
        }
        #kinematics
    }
}

fn unused(name: &str, used: bool) -> TokenStream {
    let ident = quote::format_ident!("{}{name}", if used { "" } else { "_" });
    quote! { #ident }
}

/// The parameters `axes` and `travels`, with an underscore where the body does not read them.
fn parameters(equations: &Equations, body: &Body) -> TokenStream {
    let axes = unused("axes", body.reads.axes);
    let travels = unused("travels", body.reads.travels);
    let travels = (!equations.travels.is_empty()).then(|| quote! { , #travels: &Travels });
    quote! { #axes: &Axes #travels }
}

fn nominal(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.nominal, Numbers::Plain);
    let about = docs::attributes(&format!(
        "The nominal position of the tool tip relative to the part: X, Y, Z of the part's frame \\[mm\\], 0 where not sensitive.\n\n{}\n\n{}.",
        docs::nominal_equations(equations),
        programs.nominal.operations()
    ));
    let axes = unused("axes", body.reads.axes);
    let Body { prelude, bindings, results, .. } = body;
    quote! {
        #about
        #[must_use]
        pub fn nominal(&self, #axes: &Axes) -> [f64; 3] {
            #prelude #bindings
            [#(#results),*]
        }
    }
}

/// The error for the records of doubles that a controller has, and in any numbers for the interface.
fn error(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.error, Numbers::Any);
    let about = docs::attributes(&format!(
        "The error of the tool tip relative to the part to first order, actual minus commanded: X, Y, Z of the part's frame \\[mm\\], 0 where not sensitive.\n\n{}\n\n{}.",
        docs::error_equations(equations),
        programs.error.operations()
    ));
    let (axes, motions) = (unused("axes", body.reads.axes), unused("motions", body.reads.motions));
    let of_axes = of_any(equations.axes.len());
    let of_motions = of_any(equations.motions.len());
    let (travels, plain, given) = match equations.travels.len() {
        0 => Default::default(),
        count => {
            let (name, of_travels) = (unused("travels", body.reads.travels), of_any(count));
            (quote! { , #name: &Travels #of_travels }, quote! { , travels: &Travels }, quote! { , travels })
        }
    };
    let Body { prelude, bindings, results, .. } = body;
    quote! {
        #about
        #[must_use]
        pub fn error(&self, axes: &Axes #plain, motions: &Motions) -> [f64; 3] {
            self.error_in(axes #given, motions)
        }
        /// [`Machine::error`] in one row or in several side by side, as [`abbe_runtime::Lanes`].
        #[inline]
        #[must_use]
        pub fn error_in<T: ::abbe_runtime::Real>(&self, #axes: &Axes #of_axes #travels, #motions: &Motions #of_motions) -> [T; 3] {
            #prelude #bindings
            [#(#results),*]
        }
    }
}

fn levers(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.levers, Numbers::Plain);
    let about = docs::attributes(&format!(
        "The lever arm of every error motion, in the order of [`Motions::NAMES`]: X, Y, Z of the part's frame, a pure number for a displacement, mm for an angle.\n\n{}.",
        programs.levers.operations()
    ));
    let parameters = parameters(equations, &body);
    let count = Literal::usize_unsuffixed(equations.motions.len());
    let Body { prelude, bindings, results, .. } = body;
    let arms = results.chunks(3).map(|arm| quote! { [#(#arm),*] });
    quote! {
        #about
        #[must_use]
        pub fn levers(&self, #parameters) -> [[f64; 3]; #count] {
            #prelude #bindings
            [#(#arms),*]
        }
    }
}

fn directions(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.directions, Numbers::Plain);
    let axes = unused("axes", body.reads.axes);
    let count = Literal::usize_unsuffixed(equations.axes.len());
    let Body { prelude, bindings, results, .. } = body;
    let effects = results.chunks(3).map(|effect| quote! { [#(#effect),*] });
    quote! {
        /// The displacement of the tool tip relative to the part for each mm of an axis, in the order of
        /// [`Axes::NAMES`]: X, Y, Z of the part's frame; zero for an axis that does not correct.
        #[must_use]
        pub fn directions(&self, #axes: &Axes) -> [[f64; 3]; #count] {
            #prelude #bindings
            [#(#effects),*]
        }
    }
}

fn kinematics(equations: &Equations, programs: &Programs) -> TokenStream {
    let vary = body(equations, &programs.directions, Numbers::Plain).reads.axes;
    let axes = Literal::usize_unsuffixed(equations.axes.len());
    let motions = Literal::usize_unsuffixed(equations.motions.len());
    let travels: Vec<_> =
        equations.travels.iter().map(|travel| Literal::usize_unsuffixed(travel.axis)).collect();
    let (position, of_axes) = record("position", "Axes", equations.axes.len());
    let (travel, of_travels) = record("travel", "Travels", travels.len());
    let (values, of_motions) = record("motions", "Motions", equations.motions.len());
    let of_travels = (!travels.is_empty()).then(|| quote! { &#of_travels, });
    quote! {
        impl Machine {
            /// [`Machine::error_in`] from slices, NaN where one has the wrong length.
            fn error_from<T: ::abbe_runtime::Real>(&self, position: &[T], travel: &[T], motions: &[T]) -> [T; 3] {
                #position
                #values
                #travel
                self.error_in(&#of_axes, #of_travels &#of_motions)
            }
        }
        impl ::abbe_runtime::Kinematics for Machine {
            fn axes(&self) -> usize { #axes }
            fn travels(&self) -> &[usize] { &[#(#travels),*] }
            fn motions(&self) -> usize { #motions }
            fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
                self.error_from(position, travel, motions)
            }
            fn error_lanes(
                &self,
                position: &[::abbe_runtime::Lanes],
                travel: &[::abbe_runtime::Lanes],
                motions: &[::abbe_runtime::Lanes],
            ) -> Option<[::abbe_runtime::Lanes; 3]> {
                Some(self.error_from(position, travel, motions))
            }
            fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
                let filled = match position.try_into() {
                    Ok(position) => Machine::directions(self, &Axes::from_array(position)),
                    Err(_) => [[f64::NAN; 3]; #axes],
                };
                if directions.len() == filled.len() {
                    directions.copy_from_slice(&filled);
                } else {
                    directions.fill([f64::NAN; 3]);
                }
            }
            fn directions_vary(&self) -> bool { #vary }
        }
    }
}

/// The check of a slice that becomes a record of so many fields, and the record.
fn record(slice: &str, record: &str, fields: usize) -> (TokenStream, TokenStream) {
    let (slice, record) = (quote::format_ident!("{slice}"), quote::format_ident!("{record}"));
    let otherwise = quote! { else { return [T::from(f64::NAN); 3] }; };
    if fields == 0 {
        (quote! { let [] = *#slice #otherwise }, quote! { #record {} })
    } else {
        (quote! { let Ok(#slice) = #slice.try_into() #otherwise }, quote! { #record::from_array(#slice) })
    }
}
