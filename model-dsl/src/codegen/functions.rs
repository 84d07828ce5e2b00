//! The functions of a machine: position, error, lever arms, directions, that of its tool where the machine file asks for it,
//! and the interface that the runtime's compensator calls.

use abbe_runtime::Share;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::body::{Body, Reads, body, number};
use super::held::Held;
use super::{aiming, docs, lint_allowances};
use crate::equations::Equations;
use crate::program::{OrientationPrograms, Programs};

/// All functions of a machine.
pub(super) fn all(equations: &Equations, programs: &Programs) -> TokenStream {
    let nominal = nominal(equations, programs);
    let error = error(equations, programs);
    let levers = levers(equations, programs);
    let directions = directions(equations, programs);
    let orientation = programs.orientation.as_ref().map(|programs| orientation(equations, programs));
    let kinematics = kinematics(equations, programs);
    let (allowances, name) = (lint_allowances(), &equations.machine);
    quote! {
        #allowances
        impl Machine {
            /// The machine's name, by which calibrations refer to it.
            pub const NAME: &'static str = #name;
            #nominal
            #error
            #levers
            #directions
            #orientation
        }
        #kinematics
    }
}

pub(super) fn unused(name: &str, used: bool) -> TokenStream {
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
    let (axes, prelude) = (unused("axes", body.reads.axes), body.prelude());
    let Body { bindings, results, .. } = body;
    quote! {
        #about
        #[must_use]
        pub fn nominal(&self, #axes: &Axes) -> [f64; 3] {
            #prelude #bindings
            [#(#results),*]
        }
    }
}

/// The error; where sines and cosines stay the same while a command is searched for, from these as well.
fn error(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.error);
    let about = docs::attributes(&format!(
        "The error of the tool tip relative to the part to first order, actual minus commanded: X, Y, Z of the part's frame \\[mm\\], 0 where not sensitive.\n\n{}\n\n{}.",
        docs::error_equations(equations),
        programs.error.operations()
    ));
    let prelude = body.prelude();
    let Body { reads, constants, bindings, results, .. } = &body;
    match Held::new(equations, &body) {
        None => {
            let records = records(equations, *reads);
            quote! {
                #about
                #[inline]
                #[must_use]
                pub fn error(&self, #records) -> [f64; 3] {
                    #prelude #bindings
                    [#(#results),*]
                }
            }
        }
        Some(held) => {
            let (every, sines) = (records(equations, Reads::EVERYTHING), held.sines());
            let records = records(equations, Reads { axes: reads.positions, ..*reads });
            let turned = held.parameter(&body);
            let travels = (!equations.travels.is_empty()).then(|| quote! { travels, });
            quote! {
                #about
                #[inline]
                #[must_use]
                pub fn error(&self, #every) -> [f64; 3] {
                    self.error_turned(Self::sines_in(axes), axes, #travels motions)
                }
                #sines
                /// [`Machine::error`] where its rotary axes have these sines and cosines.
                #[inline(always)]
                fn error_turned(&self, #turned, #records) -> [f64; 3] {
                    #constants #bindings
                    [#(#results),*]
                }
            }
        }
    }
}

/// The parameters `axes`, `travels` and `motions`, with an underscore where the body does not read them.
fn records(equations: &Equations, reads: Reads) -> TokenStream {
    let (axes, motions) = (unused("axes", reads.axes), unused("motions", reads.motions));
    let travels = (!equations.travels.is_empty()).then(|| {
        let name = unused("travels", reads.travels);
        quote! { #name: &Travels, }
    });
    quote! { #axes: &Axes, #travels #motions: &Motions }
}

fn levers(equations: &Equations, programs: &Programs) -> TokenStream {
    let body = body(equations, &programs.levers);
    let about = docs::attributes(&format!(
        "The lever arm of every error motion, in the order of [`Motions::NAMES`]: X, Y, Z of the part's frame, a pure number for a displacement, mm for an angle.\n\n{}.",
        programs.levers.operations()
    ));
    let parameters = parameters(equations, &body);
    let (count, prelude) = (Literal::usize_unsuffixed(equations.motions.len()), body.prelude());
    let Body { bindings, results, .. } = body;
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
    let (axes, prelude) = (unused("axes", body.reads.axes), body.prelude());
    let count = Literal::usize_unsuffixed(equations.axes.len());
    let Body { constants, bindings, results, .. } = &body;
    let effects = results.chunks(3).map(|effect| quote! { [#(#effect),*] });
    let about = quote! {
        /// The displacement of the tool tip relative to the part for each mm of an axis, in the order of
        /// [`Axes::NAMES`]: X, Y, Z of the part's frame; zero for an axis that does not correct.
        #[must_use]
    };
    match held(equations, programs).filter(|held| held.suffice(&body)) {
        None => quote! {
            #about
            pub fn directions(&self, #axes: &Axes) -> [[f64; 3]; #count] {
                #prelude #bindings
                [#(#effects),*]
            }
        },
        Some(held) => {
            let turned = held.parameter(&body);
            quote! {
                #about
                pub fn directions(&self, axes: &Axes) -> [[f64; 3]; #count] {
                    self.directions_turned(Self::sines_in(axes))
                }
                /// [`Machine::directions`] where its rotary axes have these sines and cosines.
                fn directions_turned(&self, #turned) -> [[f64; 3]; #count] {
                    #constants #bindings
                    [#(#effects),*]
                }
            }
        }
    }
}

/// The direction of the tool, and its error.
fn orientation(equations: &Equations, programs: &OrientationPrograms) -> TokenStream {
    let nominal = body(equations, &programs.nominal);
    let error = body(equations, &programs.error);
    let about_nominal = docs::attributes(&format!(
        "The direction of the tool without errors, from its tip towards the spindle: I, J, K in the part's frame, pure numbers, a vector of length 1.\n\n{}\n\n{}.",
        docs::direction_equations(equations),
        programs.nominal.operations()
    ));
    let about_error = docs::attributes(&format!(
        "The error of the tool's direction to first order, actual minus nominal: I, J, K in the part's frame \\[rad\\], square to [`Machine::direction`].\n\n{}\n\n{}.",
        docs::direction_error_equations(equations),
        programs.error.operations()
    ));
    let (axes, prelude) = (unused("axes", nominal.reads.axes), nominal.prelude());
    let Body { bindings, results, .. } = nominal;
    let (parameters, motions) = (parameters(equations, &error), unused("motions", error.reads.motions));
    let aims = aiming::aims(equations, programs);
    let (prelude_of_error, bindings_of_error, errors) = (error.prelude(), &error.bindings, &error.results);
    quote! {
        #about_nominal
        #[must_use]
        pub fn direction(&self, #axes: &Axes) -> [f64; 3] {
            #prelude #bindings
            [#(#results),*]
        }
        #about_error
        #[must_use]
        pub fn direction_error(&self, #parameters, #motions: &Motions) -> [f64; 3] {
            #prelude_of_error #bindings_of_error
            [#(#errors),*]
        }
        #aims
    }
}

/// The sines and cosines that stay the same while a command is searched for.
fn held(equations: &Equations, programs: &Programs) -> Option<Held> {
    Held::new(equations, &body(equations, &programs.error))
}

fn kinematics(equations: &Equations, programs: &Programs) -> TokenStream {
    let directions = body(equations, &programs.directions);
    let vary = directions.reads.axes;
    let known = fixed_directions(&directions).or_else(|| resting(equations));
    let squares = equations.squares().map(squares);
    let (turning, aiming) = (turning(equations), aiming::kinematics(equations));
    let motors = motors(equations);
    let held = held(equations, programs);
    let axes = Literal::usize_unsuffixed(equations.axes.len());
    let motions = Literal::usize_unsuffixed(equations.motions.len());
    let travels = equations.travels.iter().map(|travel| Literal::usize_unsuffixed(travel.axis));
    let error_from = error_from(equations, held.as_ref());
    let (sines, with_sines) = match &held {
        None => Default::default(),
        Some(held) => (quote! { Self::sines_of(position), }, held.kinematics(&directions)),
    };
    quote! {
        impl Machine {
            #error_from
        }
        impl ::abbe_runtime::Kinematics for Machine {
            fn axes(&self) -> usize { #axes }
            fn travels(&self) -> &[usize] { &[#(#travels),*] }
            fn motions(&self) -> usize { #motions }
            #[inline(always)]
            fn error(&self, position: &[f64], travel: &[f64], motions: &[f64]) -> [f64; 3] {
                self.error_from(#sines position, travel, motions)
            }
            #with_sines
            fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
                let found = match position.try_into() {
                    Ok(position) => Machine::directions(self, &Axes::from_array(position)),
                    Err(_) => [[f64::NAN; 3]; #axes],
                };
                match directions.as_mut_array() {
                    Some(directions) => *directions = found,
                    None => directions.fill([f64::NAN; 3]),
                }
            }
            #turning
            #motors
            #aiming
            fn directions_vary(&self) -> bool { #vary }
            #squares
            #known
        }
    }
}

/// The directions where they are numbers, which neither positions nor constants change.
fn fixed_directions(directions: &Body) -> Option<TokenStream> {
    let effects = directions.results.chunks(3).map(|effect| quote! { [#(#effect),*] });
    let fixed = !directions.reads.axes && !directions.reads.constants && directions.bindings.is_empty();
    fixed.then(|| {
        quote! {
            fn fixed_directions(&self) -> Option<&'static [[f64; 3]]> { Some(&[#(#effects),*]) }
        }
    })
}

/// What slides at right angles reach.
fn squares(squares: [f64; 3]) -> TokenStream {
    let squares = squares.map(number);
    quote! { fn squares(&self) -> Option<[f64; 3]> { Some([#(#squares),*]) } }
}

/// The error motions that rotary axes correct themselves, where there are any.
fn turning(equations: &Equations) -> Option<TokenStream> {
    let turning: Vec<_> = equations
        .turning()
        .iter()
        .map(|own| {
            let [axis, motion] = [own.axis, own.motion].map(Literal::usize_unsuffixed);
            quote! { ::abbe_runtime::Turning { axis: #axis, motion: #motion } }
        })
        .collect();
    // Always: see `abbe_runtime::Compensator`, which asks first whether there are any.
    (!turning.is_empty()).then(|| {
        quote! {
            #[inline(always)]
            fn turning(&self) -> &[::abbe_runtime::Turning] { &[#(#turning),*] }
        }
    })
}

/// Where motors stand, and what they correct by themselves, where there are any.
fn motors(equations: &Equations) -> TokenStream {
    let shares = |shares: Vec<Share>| {
        let shares = shares.into_iter().map(|share| {
            let ([motor, of], weight) =
                ([share.motor, share.of].map(Literal::usize_unsuffixed), number(share.weight));
            quote! { ::abbe_runtime::Share { motor: #motor, of: #of, weight: #weight } }
        });
        quote! { &[#(#shares),*] }
    };
    let method = |name: &str, of: Vec<Share>| {
        let (name, any, shares) = (quote::format_ident!("{name}"), !of.is_empty(), shares(of));
        any.then(|| {
            quote! {
                #[inline(always)]
                fn #name(&self) -> &[::abbe_runtime::Share] { #shares }
            }
        })
    };
    let (following, squaring) =
        (method("following", equations.following()), method("squaring", equations.squaring()));
    quote! { #following #squaring }
}

/// Which axes no error of the tip moves, where there are such.
fn resting(equations: &Equations) -> Option<TokenStream> {
    let rest = equations.resting();
    (!rest.is_empty()).then(|| quote! { fn resting(&self) -> &[bool] { &[#(#rest),*] } })
}

/// The error from slices.
fn error_from(equations: &Equations, held: Option<&Held>) -> TokenStream {
    let (position, of_axes) = record("position", "Axes", equations.axes.len());
    let (travel, of_travels) = record("travel", "Travels", equations.travels.len());
    let (values, of_motions) = record("motions", "Motions", equations.motions.len());
    let of_travels = (!equations.travels.is_empty()).then(|| quote! { &#of_travels, });
    let slices = quote! { position: &[f64], travel: &[f64], motions: &[f64] };
    let (sines, error) = match held {
        None => (None, quote! { self.error(&#of_axes, #of_travels &#of_motions) }),
        Some(held) => {
            let sines = held.of();
            let error = quote! { self.error_turned(sines, &#of_axes, #of_travels &#of_motions) };
            (Some(quote! { sines: #sines, }), error)
        }
    };
    quote! {
        /// [`Machine::error`] from slices, NaN where one has the wrong length.
        #[inline(always)]
        fn error_from(&self, #sines #slices) -> [f64; 3] {
            #position
            #values
            #travel
            #error
        }
    }
}

/// Code that checks that a slice has `fields` elements, and code that makes a record with these fields from it.
pub(super) fn record(slice: &str, record: &str, fields: usize) -> (TokenStream, TokenStream) {
    let (slice, record) = (quote::format_ident!("{slice}"), quote::format_ident!("{record}"));
    let otherwise = quote! { else { return [f64::NAN; 3] }; };
    if fields == 0 {
        (quote! { let [] = *#slice #otherwise }, quote! { #record {} })
    } else {
        (quote! { let Ok(#slice) = #slice.try_into() #otherwise }, quote! { #record::from_array(#slice) })
    }
}
