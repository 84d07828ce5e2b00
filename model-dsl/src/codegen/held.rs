//! Sines and cosines that stay the same while a command is searched for.
//!
//! In: the body of the error. Out: tokens that work them out once, and hand them to the directions of the axes and to the error
//! at every step of the search. It exists because no correction moves a rotary axis, and a sine costs as much as a good part of
//! an equation.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::{self, Body};
use crate::equations::Equations;

/// The sines and cosines of a machine's error.
pub(super) struct Held {
    /// The axes whose they are.
    axes: Vec<usize>,
    /// What works them out from `axes`.
    sines: TokenStream,
    count: Literal,
}

impl Held {
    /// None where there are none, more than the runtime holds, or one of an axis that corrects.
    pub(super) fn new(equations: &Equations, body: &Body) -> Option<Self> {
        let axes = || body.turned.iter().filter_map(|turned| equations.axes.get(turned.axis));
        let count = axes().count();
        let held = (1..=abbe_runtime::Sines::default().0.len()).contains(&count)
            && axes().all(|axis| axis.effect.is_none());
        held.then(|| Self {
            axes: body.turned.iter().map(|turned| turned.axis).collect(),
            sines: body.sines(),
            count: Literal::usize_unsuffixed(count),
        })
    }

    /// Whether a body reads nothing of the axes but these.
    pub(super) fn suffice(&self, body: &Body) -> bool {
        !body.reads.positions && body.turned.iter().all(|turned| self.axes.contains(&turned.axis))
    }

    /// Their type.
    pub(super) fn of(&self) -> TokenStream {
        let count = &self.count;
        quote! { ([f64; #count], [f64; #count]) }
    }

    /// The parameter that brings those into scope which a body reads.
    pub(super) fn parameter(&self, body: &Body) -> TokenStream {
        let read: Vec<_> =
            self.axes.iter().map(|axis| body.turned.iter().find(|turned| turned.axis == *axis)).collect();
        let (names, of) = (body::names(&read), self.of());
        quote! { #names: #of }
    }

    /// The functions that work them out.
    pub(super) fn sines(&self) -> TokenStream {
        let (sines, given, count) = (&self.sines, self.of(), &self.count);
        quote! {
            /// The sines and cosines of the rotary axes that the error reads.
            fn sines_in(axes: &Axes) -> #given {
                #sines
            }
            /// The same from a slice, NaN where it has the wrong length.
            fn sines_of(position: &[f64]) -> #given {
                match position.try_into() {
                    Ok(position) => Self::sines_in(&Axes::from_array(position)),
                    Err(_) => ([f64::NAN; #count], [f64::NAN; #count]),
                }
            }
        }
    }

    /// What the interface of the runtime asks for.
    pub(super) fn kinematics(&self, directions: &Body) -> TokenStream {
        let directions_with = self.suffice(directions).then(directions_with);
        quote! {
            fn turn(&self, position: &[f64], sines: &mut ::abbe_runtime::Sines) {
                if let (Some(sines), Some(cosines)) = (sines.0.first_chunk_mut(), sines.1.first_chunk_mut()) {
                    (*sines, *cosines) = Self::sines_of(position);
                }
            }
            #[inline(always)]
            fn error_with(
                &self,
                sines: &::abbe_runtime::Sines,
                position: &[f64],
                travel: &[f64],
                motions: &[f64],
            ) -> [f64; 3] {
                let (Some(sines), Some(cosines)) = (sines.0.first_chunk(), sines.1.first_chunk()) else {
                    return [f64::NAN; 3];
                };
                self.error_from((*sines, *cosines), position, travel, motions)
            }
            #directions_with
        }
    }
}

fn directions_with() -> TokenStream {
    quote! {
        fn directions_with(&self, sines: &::abbe_runtime::Sines, position: &[f64], directions: &mut [[f64; 3]]) {
            let (Some(sines), Some(cosines), Some(directions)) =
                (sines.0.first_chunk(), sines.1.first_chunk(), directions.as_mut_array())
            else {
                return ::abbe_runtime::Kinematics::directions(self, position, directions);
            };
            *directions = self.directions_turned((*sines, *cosines));
        }
    }
}
