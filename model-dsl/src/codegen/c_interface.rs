//! What a library for controllers in C has beside the machine: its names, its equations as text, and the function that opens
//! it. In: the equations. Out: tokens that need the crate `abbe_c`; everything that C calls but for `abbe_open` is there.

use abbe_runtime::Share;
use proc_macro2::TokenStream;
use quote::quote;

use crate::calibration::{CompiledIn, MachineNames, MotionName, TurningTool};
use crate::equations::Equations;
use crate::machine::Counted;

/// The implementation of `abbe_c::CompiledMachine`, and `abbe_open`.
pub(super) fn all(equations: &Equations) -> TokenStream {
    let compiled_machine = compiled_machine(equations);
    quote! {
        #compiled_machine
        /// Opens the compensation of this machine with the numbers of one specimen.
        ///
        /// It reads the calibration file, and the machine file where that names one: this belongs before the servo cycle. The
        /// compensation begins switched off. `message` takes warnings, or why there is no handle; it may be null.
        ///
        /// # Safety
        /// `calibration` is null or a string that ends in a zero byte, `handle` null or a place for a pointer, and `message` null
        /// or room for `size` bytes.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn abbe_open(
            calibration: *const ::core::ffi::c_char,
            handle: *mut *mut ::abbe_c::Abbe,
            message: *mut ::core::ffi::c_char,
            size: usize,
        ) -> ::abbe_c::Status {
            // SAFETY: what is asked of the pointers is the same.
            unsafe { ::abbe_c::open::<Machine>(calibration, handle, message, size) }
        }
    }
}

fn compiled_machine(equations: &Equations) -> TokenStream {
    let MachineNames { machine, constants, turning, axes, motions, unseen } = equations.names();
    let turning = turning.map(turning_tool);
    let constants = constants.iter().map(|(name, default)| {
        let default = optional(default.as_ref());
        quote! { (#name, #default) }
    });
    let axes = axes.iter().map(|axis| {
        let (letter, rotary) = (&axis.letter, axis.rotary);
        quote! { (#letter, #rotary) }
    });
    let follows: Vec<_> = equations
        .following()
        .into_iter()
        .map(|Share { motor, of, weight }| quote! { (#motor, #of, #weight) })
        .collect();
    let follows = (!follows.is_empty())
        .then(|| quote! { const FOLLOWS: &'static [(usize, usize, f64)] = &[#(#follows),*]; });
    let counted = motions.iter().chain(&unseen).flat_map(|motion| {
        let name = &motion.name;
        motion.counted.iter().map(move |Counted { from, is }| quote! { (#name, #from, #is) })
    });
    let counted: Vec<_> = counted.collect();
    let [motions, unseen] = [motions, unseen].map(|motions| motions.iter().map(named).collect::<Vec<_>>());
    let json = CompiledIn::of_equations(equations);
    let allowances = super::lint_allowances();
    quote! {
        #allowances
        impl ::abbe_c::CompiledMachine for Machine {
            const NAME: &'static str = #machine;
            const CONSTANTS: &'static [::abbe_c::ConstantOfMachine] = &[#(#constants),*];
            const AXES: &'static [::abbe_c::AxisOfMachine] = &[#(#axes),*];
            #follows
            #turning
            const MOTIONS: &'static [::abbe_c::MotionOfMachine] = &[#(#motions),*];
            const UNSEEN: &'static [::abbe_c::MotionOfMachine] = &[#(#unseen),*];
            const COUNTED: &'static [::abbe_c::CountedOfMachine] = &[#(#counted),*];
            const EQUATIONS: &'static str = #json;
            fn with_constants(constants: &[f64]) -> Option<Self> {
                let constants = constants.try_into().ok()?;
                Some(Self { constants: Constants::from_array(constants) })
            }
        }
    }
}

/// Which constants each tool of a calibration gives as its direction, and which as its tip.
fn turning_tool(TurningTool { direction: [x, y, z], offset }: TurningTool) -> TokenStream {
    let offset = offset.map(|offset| {
        let offset = offset.map(|number| optional(number.as_ref()));
        quote! { [#(#offset),*] }
    });
    let offset = optional(offset.as_ref());
    quote! { const TURNING: Option<::abbe_c::TurningToolOfMachine> = Some(([#x, #y, #z], #offset)); }
}

/// An error motion by its name.
fn named(motion: &MotionName) -> TokenStream {
    let (name, angular, own) = (&motion.name, motion.angular, motion.own);
    let axis = optional(motion.axis.as_ref());
    quote! { (#name, #angular, #axis, #own) }
}

fn optional<T: quote::ToTokens>(value: Option<&T>) -> TokenStream {
    value.map_or_else(|| quote! { None }, |value| quote! { Some(#value) })
}
