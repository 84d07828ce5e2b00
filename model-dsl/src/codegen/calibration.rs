//! A calibration as code.
//!
//! In: the equations of a machine and the numbers of a specimen. Out: tokens of its terms as constants, and of a reader that
//! reads exactly these. It exists because a controller has no files, and because what is known when code is compiled need not be
//! asked for in every servo cycle.

use abbe_runtime::Term;
use proc_macro2::{Ident, Literal, TokenStream};
use quote::{ToTokens, format_ident, quote};

use super::body::number;
use super::bundles::{Bundles, EvenNodes};
use super::sensors::{self, Numbered};
use super::{docs, factors, lint_allowances};
use crate::calibration::vocabulary::{RAMP, Role};
use crate::calibration::{
    CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues, Limits, NotCompensable, Part, SeriesInput,
    Tool,
};
use crate::equations::{Equations, Motion};

/// The calibration, its terms and its sensors.
///
/// # Errors
/// The first term that no controller can compensate.
pub(super) fn all(equations: &Equations, calibration: &Calibration) -> Result<TokenStream, NotCompensable> {
    let numbered = Numbered::new(&calibration.sensors);
    let motions: Vec<WrittenMotion> = equations
        .motions
        .iter()
        .enumerate()
        .map(|(number, motion)| WrittenMotion::new(equations, motion, number, calibration, &numbered))
        .collect::<Result<_, _>>()?;
    let bundles = Bundles::new(equations, &motions);
    let (items, reader) = (items(calibration, &motions, &bundles), reader(equations, &motions, &bundles));
    let sensors = sensors::all(&calibration.sensors, &numbered);
    Ok(quote! { #items #reader #sensors })
}

/// The terms of an error motion as tokens.
pub(super) struct WrittenMotion {
    /// The name of the constant that holds them.
    pub(super) name: Ident,
    /// What the motion is.
    about: String,
    terms: Vec<WrittenTerm>,
    /// Whether one of them reads an axis that corrects, which a search for a command moves.
    moved: bool,
    /// Whether it is more than numbers that are known, which cost nothing to read.
    costs: bool,
}

/// A term or a factor as tokens, and its nodes where it is a table with even ones.
struct WrittenTerm {
    tokens: TokenStream,
    even: Option<EvenNodes>,
    is_factor: bool,
}

impl WrittenMotion {
    fn new(
        equations: &Equations,
        motion: &Motion,
        number: usize,
        calibration: &Calibration,
        sensors: &Numbered,
    ) -> Result<Self, NotCompensable> {
        let listed = calibration.motions.iter().find(|listed| listed.motion == number);
        let terms = listed.map_or(&[][..], |listed| &listed.terms);
        let ramp = |place| listed.map_or(0.0, |listed| listed.ramp(place));
        let corrects = |axis: usize| {
            equations.axes.get(axis).is_some_and(|axis| axis.effect.is_some() || axis.is_motor())
        };
        let read: Vec<Vec<Term<'_>>> =
            terms.iter().map(|term| term.value.runtime()).collect::<Result<_, _>>()?;
        let read = read.concat();
        let written: Vec<Vec<WrittenTerm>> = terms
            .iter()
            .enumerate()
            .map(|(place, written)| with_factors(&written.value, ramp(place), sensors))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            name: format_ident!("{}", motion.name.replace('-', "_").to_ascii_uppercase()),
            about: docs::motion(motion),
            terms: written.into_iter().flatten().collect(),
            moved: read.iter().filter_map(Term::axis).any(corrects),
            costs: !read.iter().all(|term| matches!(term, Term::Constant { .. })),
        })
    }

    /// Whether it costs something to read what a search for a command does not change.
    fn stays(&self) -> bool {
        self.costs && !self.moved
    }

    /// The places of its tables with even nodes, and these.
    pub(super) fn even_tables(&self) -> impl Iterator<Item = (usize, EvenNodes)> {
        self.terms.iter().enumerate().filter_map(|(place, term)| Some((place, term.even?)))
    }

    /// The name by which the reader knows a term, or its value where that is read before its turn.
    pub(super) fn term_name(&self, place: usize) -> Ident {
        format_ident!("{}_{place}", self.name.to_string().to_ascii_lowercase())
    }

    /// The name by which the reader knows the value of the motion.
    fn value_name(&self) -> Ident {
        format_ident!("{}_value", self.name.to_string().to_ascii_lowercase())
    }

    /// Names the terms whose value is not read before their turn; nothing where there is none.
    fn unpacked(&self) -> Option<TokenStream> {
        let name = &self.name;
        let terms = self.terms.iter().enumerate().map(|(place, term)| match term.even {
            Some(_) => format_ident!("_"),
            None => self.term_name(place),
        });
        self.terms
            .iter()
            .any(|term| term.even.is_none())
            .then(|| quote! { let [#(#terms),*] = &Self::#name; })
    }

    /// The sum of the terms, each times the factors before it, read in their turn.
    fn sum(&self) -> TokenStream {
        let read = |place: usize, term: &WrittenTerm| {
            let name = self.term_name(place);
            match term.even {
                Some(_) => quote! { from.known(#name) },
                None => quote! { from.term(#name) },
            }
        };
        let numbered: Vec<_> = self.terms.iter().enumerate().collect();
        let products = numbered.split_inclusive(|(_, term)| !term.is_factor);
        let terms: Vec<_> = products
            .map(|product| {
                let mut read = product.iter().map(|(place, term)| read(*place, term));
                let first = read.next().unwrap_or_default();
                quote! { #first #(* #read)* }
            })
            .collect();
        match &terms[..] {
            [alone] if self.terms.len() == 1 => alone.clone(),
            // From zero on, as any sum of several terms or of none.
            terms => quote! { 0.0 #(+ #terms)* },
        }
    }
}

/// The calibration itself: machine, limits, terms.
fn items(calibration: &Calibration, motions: &[WrittenMotion], bundles: &Bundles<'_>) -> TokenStream {
    let about = docs::attributes(&match &calibration.source {
        Some(source) => format!("The numbers of one machine, compiled in. Source: {source}."),
        None => "The numbers of one machine, compiled in.".to_owned(),
    });
    let constants = with_constants(&calibration.constants);
    let tools = tools(&calibration.tools);
    let (limits, transition) = limits(&calibration.limits);
    let allowances = lint_allowances();
    let count = Literal::usize_unsuffixed(motions.iter().map(|motion| motion.terms.len()).sum());
    let lists = motions.iter().map(|WrittenMotion { name, about, terms, .. }| {
        let (about, count) = (docs::attributes(about), Literal::usize_unsuffixed(terms.len()));
        let terms = terms.iter().map(|term| &term.tokens);
        quote! {
            #about
            const #name: [::abbe_runtime::Term<'static>; #count] = [#(#terms),*];
        }
    });
    let bundles = bundles.items();
    quote! {
        #about
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Calibration;
        #allowances
        impl Calibration {
            /// The machine with the constants of the calibration.
            pub const MACHINE: Machine = #constants;
            #tools
            /// What a correction must not exceed.
            pub const LIMITS: ::abbe_runtime::Limits = #limits;
            /// How a supervisor goes from one correction to another.
            pub const TRANSITION: ::abbe_runtime::Transition = #transition;
            /// The number of terms: a compensator needs a memory for each.
            pub const TERMS: usize = #count;
            #(#lists)*
            #bundles
        }
    }
}

/// The machine with these constants.
fn with_constants(constants: &[f64]) -> TokenStream {
    let constants = constants.iter().map(|constant| number(*constant));
    quote! { Machine { constants: Constants::from_array([#(#constants),*]) } }
}

/// The machine with each tool, where there are any.
fn tools(tools: &[Tool]) -> Option<TokenStream> {
    let count = Literal::usize_unsuffixed(tools.len());
    let entries = tools.iter().map(|tool| {
        let (name, machine) = (&tool.name.value, with_constants(&tool.constants));
        quote! { (#name, #machine) }
    });
    (!tools.is_empty()).then(|| {
        quote! {
            /// The tools by their names: the machine with the constants of each, for [`abbe_runtime::Exchanged`].
            pub const TOOLS: [(&'static str, Machine); #count] = [#(#entries),*];
        }
    })
}

/// What the calibration limits: for the compensator, and for the supervisor.
fn limits(limits: &Limits) -> (TokenStream, TokenStream) {
    let optional = |given: Option<f64>| match given {
        Some(given) => {
            let given = number(given);
            quote! { Some(#given) }
        }
        None => quote! { None },
    };
    let [compensation, rotation] =
        [limits.of_compensator().compensation, limits.of_compensator().rotation].map(optional);
    let transition = limits.transition();
    let [rate, rotation_rate] = [transition.rate, transition.rotation_rate].map(optional);
    let (hold, fade) = (number(transition.hold), number(transition.fade));
    (
        quote! { ::abbe_runtime::Limits { compensation: #compensation, rotation: #rotation } },
        quote! {
            ::abbe_runtime::Transition { rate: #rate, rotation_rate: #rotation_rate, hold: #hold, fade: #fade }
        },
    )
}

/// The implementation of `ErrorMotions`: term by term, so that each is known where it is read.
fn reader(equations: &Equations, motions: &[WrittenMotion], bundles: &Bundles<'_>) -> TokenStream {
    let names = motions.iter().map(|motion| &motion.name);
    let count = Literal::usize_unsuffixed(motions.len());
    let kept = kept(motions);
    let read = read(equations, motions, bundles, &kept);
    let read_moved = (!kept.is_empty()).then(|| read_moved(equations, motions, bundles, &kept));
    quote! {
        impl ::abbe_runtime::ErrorMotions for Calibration {
            type Values<'k> = [f64; #count];
            fn motions(&self) -> &[::abbe_runtime::ErrorMotion<'_>] {
                &[#(::abbe_runtime::ErrorMotion { terms: &Self::#names }),*]
            }
            #read
            #read_moved
        }
    }
}

/// The motions whose values are kept for the next step of a search for a command; none where all of them may be changed by it,
/// but for those that cost nothing.
// Those that it changes as well: what goes to memory side by side is what the compiler of Rust reads side by side.
fn kept(motions: &[WrittenMotion]) -> Vec<&WrittenMotion> {
    match motions.iter().any(WrittenMotion::stays) {
        true => motions.iter().filter(|motion| motion.costs).collect(),
        false => Vec::new(),
    }
}

/// What reads all motions, and keeps some of them.
fn read(
    equations: &Equations,
    motions: &[WrittenMotion],
    bundles: &Bundles<'_>,
    kept: &[&WrittenMotion],
) -> TokenStream {
    let bundles = bundles.unpacked(|_| true);
    let unpacked = motions.iter().map(WrittenMotion::unpacked);
    let (names, sums): (Vec<_>, Vec<_>) =
        motions.iter().map(|motion| (motion.value_name(), motion.sum())).unzip();
    // Nothing is read where there are no terms.
    let from = if motions.iter().all(|motion| motion.terms.is_empty()) {
        quote! { _ }
    } else {
        quote! { mut from }
    };
    let (keeping, keep) = if kept.is_empty() {
        (quote! { _kept }, None)
    } else {
        let values = kept.iter().map(|motion| motion.value_name());
        (quote! { kept }, Some(quote! { *kept.first_chunk_mut()? = [#(#values),*]; }))
    };
    let body = quote! {
        #bundles
        #(#unpacked)*
        #(let #names = #sums;)*
        #keep
        Some([#(#names),*])
    };
    method(equations, motions, &quote! { read }, &[from, keeping], &body)
}

/// What reads the motions again that a search for a command changes, and takes the others as they were kept.
fn read_moved(
    equations: &Equations,
    motions: &[WrittenMotion],
    bundles: &Bundles<'_>,
    kept: &[&WrittenMotion],
) -> TokenStream {
    let names =
        kept.iter().map(|motion| if motion.stays() { motion.value_name() } else { format_ident!("_") });
    let bundles = bundles.unpacked(|motion| !motion.stays());
    let unpacked = motions.iter().filter(|motion| !motion.stays()).map(WrittenMotion::unpacked);
    let values = motions.iter().map(|motion| {
        let (value, terms) = (motion.value_name(), Literal::usize_unsuffixed(motion.terms.len()));
        if motion.stays() {
            quote! { { from.pass_over(#terms); #value } }
        } else {
            motion.sum()
        }
    });
    let body = quote! {
        #bundles
        #(#unpacked)*
        let [#(#names),*] = *kept.first_chunk()?;
        Some([#(#values),*])
    };
    method(equations, motions, &quote! { read_moved }, &[quote! { mut from }, quote! { kept }], &body)
}

/// A method of `ErrorMotions` that reads motions, the reader and what was kept under these names.
// Always inlined, as all on the way from positions to an error: between two functions, numbers would go through memory.
fn method(
    equations: &Equations,
    motions: &[WrittenMotion],
    name: &TokenStream,
    [from, kept]: &[TokenStream; 2],
    body: &TokenStream,
) -> TokenStream {
    let [axes, count] = [equations.axes.len(), motions.len()].map(Literal::usize_unsuffixed);
    quote! {
        #[inline(always)]
        fn #name(&self, from: ::abbe_runtime::MotionReader<'_>, #kept: &mut [f64]) -> Option<[f64; #count]> {
            let #from = from.sized::<#axes, { Self::TERMS }>()?;
            #body
        }
    }
}

/// A term behind its factors.
fn with_factors(
    term: &CalibratedTerm,
    ramp: f64,
    sensors: &Numbered,
) -> Result<Vec<WrittenTerm>, NotCompensable> {
    // What the runtime refuses, it would refuse where it is compiled too.
    term.runtime()?;
    let factors = term.factors().iter().map(|factor| {
        let tokens = factors::factor(factor, sensors);
        WrittenTerm { tokens, even: None, is_factor: true }
    });
    let (core, even) = (term.core(), EvenNodes::of(term.core()));
    let core = WrittenTerm { tokens: core_term(core, ramp, sensors), even, is_factor: false };
    Ok(factors.chain([core]).collect())
}

/// A term with its numbers: the runtime calls its terms and their fields as the vocabulary does.
fn core_term(term: &CalibratedTerm, ramp: f64, sensors: &Numbered) -> TokenStream {
    let fields = match term {
        // What a time behind is, a controller knows to first order.
        &CalibratedTerm::Delay { axis, time } => {
            return core_term(&CalibratedTerm::Lag { axis, gain: 1.0 / time, frequency: 0.0 }, ramp, sensors);
        }
        CalibratedTerm::Polynomial { input, coefficients } => {
            let coefficients = numbers(coefficients);
            let input = match *input {
                SeriesInput::Axis(axis) => {
                    let axis = Literal::usize_unsuffixed(axis);
                    quote! { Axis(#axis) }
                }
                SeriesInput::Sensor(sensor) => {
                    let sensor = Literal::usize_unsuffixed(sensors.number(sensor));
                    quote! { Sensor(#sensor) }
                }
            };
            quote! { input: ::abbe_runtime::Input::#input, coefficients: #coefficients }
        }
        CalibratedTerm::Table { axis, curve } => {
            let (axis, table) = (Literal::usize_unsuffixed(*axis), table(curve));
            quote! { axis: #axis, table: #table }
        }
        plain => fields(plain, ramp, sensors),
    };
    let name = type_name(term.name());
    quote! { ::abbe_runtime::Term::#name { #fields } }
}

/// The name of a term as types are called: `ReversalSpike` for `reversal-spike`.
pub(super) fn type_name(name: &str) -> Ident {
    let words = name.split('-').map(|word| {
        let (first, rest) = word.split_at_checked(1).unwrap_or((word, ""));
        first.to_ascii_uppercase() + rest
    });
    format_ident!("{}", words.collect::<String>())
}

/// The fields of a term that the runtime has as the calibration does, transients apart, and its ramp.
fn fields(term: &CalibratedTerm, ramp: f64, sensors: &Numbered) -> TokenStream {
    let entry = term.kind().entry();
    let is_transient = |key: &str| entry.key(key).is_some_and(|key| key.role == Role::Transient);
    let parts = term.parts().into_iter().filter(|(key, _)| !is_transient(key));
    let ramp = entry.key(RAMP).map(|key| (key.name, Part::Number(ramp)));
    let fields = parts.chain(ramp).filter_map(|(key, part)| {
        let value = match part {
            Part::Number(value) => number(value),
            Part::Numbers(values) => numbers(values),
            Part::Axis(axis) => Literal::usize_unsuffixed(axis).into_token_stream(),
            Part::Sensor(sensor) => Literal::usize_unsuffixed(sensors.number(sensor)).into_token_stream(),
            Part::Load(_) | Part::Unit | Part::Factors(_) => return None,
        };
        let key = format_ident!("{key}");
        Some(quote! { #key: #value })
    });
    quote! { #(#fields),* }
}

/// A table that was checked here, and is checked once more where it is compiled.
fn table(curve: &Curve) -> TokenStream {
    let values = match &curve.values {
        CurveValues::Both(values) => {
            let values = numbers(values);
            quote! { Both(#values) }
        }
        CurveValues::Directed { forward, reverse } => {
            let (forward, reverse) = (numbers(forward), numbers(reverse));
            quote! { Directed { forward: #forward, reverse: #reverse } }
        }
    };
    let values = quote! { ::abbe_runtime::Values::#values };
    let read = match &curve.nodes {
        CurveNodes::Uniform { start, step } => {
            let (start, step) = (number(*start), number(*step));
            quote! { uniform(#start, #step, #values) }
        }
        CurveNodes::At(at) => {
            let at = numbers(at);
            quote! { at(#at, #values) }
        }
    };
    let table = table_of(&read);
    if curve.repeats { repeating(&table) } else { table }
}

/// A table that begins again after its last node.
pub(super) fn repeating(table: &TokenStream) -> TokenStream {
    quote! {
        match #table.repeating() {
            Ok(table) => table,
            Err(_) => panic!("a table that cannot repeat"),
        }
    }
}

/// The table that a function of it makes.
pub(super) fn table_of(read: &TokenStream) -> TokenStream {
    quote! {
        match ::abbe_runtime::Table::#read {
            Ok(table) => table,
            Err(_) => panic!("a table that cannot be read"),
        }
    }
}

pub(super) fn numbers(numbers: &[f64]) -> TokenStream {
    let numbers = numbers.iter().map(|given| number(*given));
    quote! { &[#(#numbers),*] }
}
