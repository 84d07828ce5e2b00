//! The functions of a machine: position, error, lever arms, directions, and the interface that
//! the runtime's compensator calls.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::{Body, body};
use super::docs;
use crate::equations::Equations;
use crate::program::Programs;

/// All functions of a machine.
pub(super) fn all(equations: &Equations, programs: &Programs) -> TokenStream {
    let nominal = nominal(equations, programs);
    let error = error(equations, programs);
    let levers = levers(equations, programs);
    let directions = directions(equations, programs);
    let kinematics = kinematics(equations);
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
    let body = body(equations, &programs.nominal);
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

fn error(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.error);
    let about = docs::attributes(&format!(
        "The error of the tool tip relative to the part to first order, actual minus commanded: X, Y, Z of the part's frame \\[mm\\], 0 where not sensitive.\n\n{}\n\n{}.",
        docs::error_equations(equations),
        programs.error.operations()
    ));
    let parameters = parameters(equations, &body);
    let motions = unused("motions", body.reads.motions);
    let Body { prelude, bindings, results, .. } = body;
    quote! {
        #about
        #[must_use]
        pub fn error(&self, #parameters, #motions: &Motions) -> [f64; 3] {
            #prelude #bindings
            [#(#results),*]
        }
    }
}

fn levers(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.levers);
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
    let body = body(equations, &programs.directions);
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

fn kinematics(equations: &Equations) -> TokenStream {
    let axes = Literal::usize_unsuffixed(equations.axes.len());
    let motions = Literal::usize_unsuffixed(equations.motions.len());
    let travels: Vec<_> =
        equations.travels.iter().map(|travel| Literal::usize_unsuffixed(travel.axis)).collect();
    let (check, argument) = if travels.is_empty() {
        (quote! { let [] = *travel else { return [f64::NAN; 3] }; }, TokenStream::new())
    } else {
        let convert = quote! { let Ok(travel) = travel.try_into() else { return [f64::NAN; 3] }; };
        (convert, quote! { , &Travels::from_array(travel) })
    };
    quote! {
        impl ::abbe_runtime::Kinematics for Machine {
            fn axes(&self) -> usize { #axes }
            fn travels(&self) -> &[usize] { &[#(#travels),*] }
            fn motions(&self) -> usize { #motions }
            fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
                let Ok(position) = position.try_into() else { return [f64::NAN; 3] };
                let Ok(motions) = motions.try_into() else { return [f64::NAN; 3] };
                #check
                Machine::error(self, &Axes::from_array(position) #argument, &Motions::from_array(motions))
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
        }
    }
}
