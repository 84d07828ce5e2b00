//! What a machine says of its rotary axes that correct the direction of the tool. In: equations and their programs. Out: the function
//! that tells what each of these axes turns the direction by, and the methods with which the runtime's compensator asks for it; nothing
//! for any other machine.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::body;
use super::functions::{record, unused};
use crate::equations::Equations;
use crate::program::OrientationPrograms;

/// What each aiming axis turns the direction of the tool by.
pub(super) fn aims(equations: &Equations, programs: &OrientationPrograms) -> Option<TokenStream> {
    let aiming = equations.aiming();
    let letters: Vec<&str> = aiming.iter().map(|axis| equations.axes[*axis].letter.as_str()).collect();
    let about = super::docs::attributes(&format!(
        "The change of the tool's direction for each rad of the axes that correct it, in the order {}: I, J, K in the part's frame, pure numbers.\n\n{}.",
        letters.join(", "),
        programs.aims.operations()
    ));
    let body = body(equations, &programs.aims);
    let (axes, prelude) = (unused("axes", body.reads.axes), body.prelude());
    let (count, bindings) = (Literal::usize_unsuffixed(aiming.len()), &body.bindings);
    let aims = body.results.chunks(3).map(|aim| quote! { [#(#aim),*] });
    (!aiming.is_empty()).then(|| {
        quote! {
            #about
            #[must_use]
            pub fn aims(&self, #axes: &Axes) -> [[f64; 3]; #count] {
                #prelude #bindings
                [#(#aims),*]
            }
        }
    })
}

/// What the interface of the runtime asks for.
pub(super) fn kinematics(equations: &Equations) -> Option<TokenStream> {
    let aiming = equations.aiming().into_iter().map(Literal::usize_unsuffixed);
    let (position, of_axes) = record("position", "Axes", equations.axes.len());
    let (travel, of_travels) = record("travel", "Travels", equations.travels.len());
    let (values, of_motions) = record("motions", "Motions", equations.motions.len());
    let of_travels = (!equations.travels.is_empty()).then(|| quote! { &#of_travels, });
    (!equations.aiming().is_empty()).then(|| {
        quote! {
            // Always: see `abbe_runtime::Compensator`, which asks first whether there are any.
            #[inline(always)]
            fn aiming(&self) -> &[usize] { &[#(#aiming),*] }
            fn nominal(&self, position: &[f64]) -> [f64; 3] {
                #position
                Machine::nominal(self, &#of_axes)
            }
            fn direction(&self, position: &[f64]) -> [f64; 3] {
                #position
                Machine::direction(self, &#of_axes)
            }
            fn direction_error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
                #position
                #travel
                #values
                Machine::direction_error(self, &#of_axes, #of_travels &#of_motions)
            }
            fn aims(&self, position: &[f64], aims: &mut [[f64; 3]; 3]) {
                let found = position.try_into().map(|position| Machine::aims(self, &Axes::from_array(position)));
                *aims = [[0.0; 3]; 3];
                match found {
                    Ok(found) => aims.iter_mut().zip(found).for_each(|(aim, found)| *aim = found),
                    Err(_) => *aims = [[f64::NAN; 3]; 3],
                }
            }
        }
    })
}
