//! The temperature sensors of a calibration as code.
//!
//! In: the sensors. Out: tokens of a record that makes the temperatures of a sample from those of the inputs. It exists because
//! a calibration may read the mean of sensors, or what one of them read first, and a controller has only the sensors themselves.

use proc_macro2::{Literal, TokenStream};
use quote::{format_ident, quote};

use crate::calibration::{SensorKind, Sensors};

/// The sensors that terms need, themselves or through others, with new numbers: compiled code knows no others.
pub(super) struct Numbered {
    /// For each sensor its new number.
    numbers: Vec<Option<usize>>,
}

impl Numbered {
    pub(super) fn new(sensors: &Sensors) -> Self {
        let mut next = 0..;
        Self { numbers: sensors.iter().map(|sensor| if sensor.used { next.next() } else { None }).collect() }
    }

    /// The new number of a sensor that a term reads.
    pub(super) fn number(&self, sensor: usize) -> usize {
        self.numbers.get(sensor).copied().flatten().unwrap_or_default()
    }

    fn len(&self) -> usize {
        self.numbers.iter().flatten().count()
    }
}

/// The record `Sensors`; nothing where no term reads a sensor.
pub(super) fn all(sensors: &Sensors, numbered: &Numbered) -> TokenStream {
    if numbered.len() == 0 {
        return TokenStream::new();
    }
    let count = Literal::usize_unsuffixed(numbered.len());
    let used: Vec<_> = sensors.iter().enumerate().filter(|(_, sensor)| sensor.used).collect();
    let names = used.iter().map(|(_, sensor)| &sensor.name.value);
    let inputs: Vec<_> = sensors.inputs().collect();
    let (input_names, input_count) =
        (inputs.iter().map(|(_, sensor)| &sensor.name.value), Literal::usize_unsuffixed(inputs.len()));
    let of_inputs = inputs.iter().map(|(index, _)| name("t", numbered.number(*index)));
    let temperatures: Vec<_> = used.iter().map(|(index, _)| name("t", numbered.number(*index))).collect();
    let first: Vec<_> = used.iter().map(|(index, _)| name("first", numbered.number(*index))).collect();
    let derived = used.iter().filter_map(|(index, sensor)| {
        let it = name("t", numbered.number(*index));
        let value = match &sensor.kind {
            SensorKind::Input => return None,
            SensorKind::Mean(sources) => mean(sources, numbered),
            SensorKind::Initial(source) => {
                let (first, now) =
                    (name("first", numbered.number(*source)), name("t", numbered.number(*source)));
                quote! { if #first.is_nan() { #now } else { *#first } }
            }
        };
        Some(quote! { let #it = #value; })
    });
    quote! {
        /// The temperature sensors that the calibration reads: those of the machine, and those that are derived from them.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct Sensors {
            /// What each of them read first, NaN before.
            first: [f64; #count],
        }
        impl Sensors {
            /// The sensors of the machine, in the order in which [`Sensors::update`] takes them.
            pub const INPUTS: [&'static str; #input_count] = [#(#input_names),*];
            /// All sensors, in the order of the temperatures of a sample.
            pub const NAMES: [&'static str; #count] = [#(#names),*];
            /// Sensors of which none has read anything yet.
            #[must_use]
            pub const fn new() -> Self {
                Self { first: [f64::NAN; #count] }
            }
            /// The temperatures of a sample from those of the machine's sensors, degC; NaN is one that is silent, and so is what
            /// is derived from it.
            pub fn update(&mut self, [#(#of_inputs),*]: [f64; #input_count]) -> [f64; #count] {
                let [#(#first),*] = &mut self.first;
                #(#derived)*
                #(
                    if #first.is_nan() {
                        *#first = #temperatures;
                    }
                )*
                [#(#temperatures),*]
            }
        }
        impl Default for Sensors {
            fn default() -> Self {
                Self::new()
            }
        }
    }
}

fn mean(sources: &[usize], numbered: &Numbered) -> TokenStream {
    let count = Literal::f64_unsuffixed(sources.len() as f64);
    let sources = sources.iter().map(|source| name("t", numbered.number(*source)));
    quote! { (#(#sources)+*) / #count }
}

fn name(what: &str, number: usize) -> proc_macro2::Ident {
    format_ident!("{what}{number}")
}
