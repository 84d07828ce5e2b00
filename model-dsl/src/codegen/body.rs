//! Function bodies. In: a program. Out: `let` bindings for what is used twice, and one
//! expression for each result. Brackets are written wherever the order of operations needs
//! them, so that what is printed is what was meant.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::idents::field;
use crate::equations::Equations;
use crate::program::{Input, Program, Step, Value};

/// A body: the inputs it reads, its bindings, and its results.
pub(super) struct Body {
    /// Which records it reads.
    pub(super) reads: Reads,
    /// The constants and the sines and cosines that it reads.
    pub(super) prelude: TokenStream,
    /// Values that are used more than once.
    pub(super) bindings: TokenStream,
    /// One expression for each result.
    pub(super) results: Vec<TokenStream>,
}

/// How tightly an expression binds, to know where it needs brackets.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Binding {
    Sum,
    Product,
    Sign,
    Atom,
}

/// What a function computes with.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Numbers {
    /// Plain `f64`.
    Plain,
    /// Any `T` that is an `abbe_runtime::Real`: one row, or several side by side.
    Any,
}

struct Printer<'p> {
    equations: &'p Equations,
    program: &'p Program,
    numbers: Numbers,
    uses: Vec<usize>,
}

/// Writes a program as a function body.
pub(super) fn body(equations: &Equations, program: &Program, numbers: Numbers) -> Body {
    let printer = Printer { equations, program, numbers, uses: program.uses() };
    let shared = (0..program.steps.len()).filter(|step| printer.is_shared(*step));
    let bindings = shared.map(|step| {
        let name = step_name(step);
        let (value, _) = printer.step(step);
        quote! { let #name = #value; }
    });
    let inputs = inputs(program);
    let reads = reads(&inputs);
    Body {
        reads,
        prelude: prelude(equations, &inputs, reads, numbers),
        bindings: bindings.collect(),
        results: program.results.iter().map(|result| printer.value(*result).0).collect(),
    }
}

impl Printer<'_> {
    fn is_shared(&self, step: usize) -> bool {
        self.uses.get(step).is_some_and(|uses| *uses > 1)
    }

    fn value(&self, value: Value) -> (TokenStream, Binding) {
        match value {
            Value::Zero => self.number(0.0),
            Value::Number(number) => {
                self.number(self.program.numbers.get(number).copied().unwrap_or(f64::NAN))
            }
            Value::Input(read) => (input(self.equations, read), Binding::Atom),
            Value::Step(step) if self.is_shared(step) => {
                let name = step_name(step);
                (quote! { #name }, Binding::Atom)
            }
            Value::Step(step) => self.step(step),
        }
    }

    fn number(&self, number: f64) -> (TokenStream, Binding) {
        let (literal, binding) = number_literal(number);
        match self.numbers {
            Numbers::Plain => (literal, binding),
            Numbers::Any => (quote! { T::from(#literal) }, Binding::Atom),
        }
    }

    fn step(&self, step: usize) -> (TokenStream, Binding) {
        match self.program.steps[step] {
            Step::Add(a, b) => {
                let (a, b) = (self.at_least(a, Binding::Sum), self.at_least(b, Binding::Product));
                (quote! { #a + #b }, Binding::Sum)
            }
            Step::Sub(a, b) => {
                let (a, b) = (self.at_least(a, Binding::Sum), self.at_least(b, Binding::Product));
                (quote! { #a - #b }, Binding::Sum)
            }
            Step::Mul(a, b) => {
                let (a, b) = (self.at_least(a, Binding::Product), self.at_least(b, Binding::Sign));
                (quote! { #a * #b }, Binding::Product)
            }
            Step::Neg(a) => {
                let a = self.at_least(a, Binding::Atom);
                (quote! { -#a }, Binding::Sign)
            }
        }
    }

    /// The value, in brackets where it binds less tightly than its place asks.
    fn at_least(&self, value: Value, least: Binding) -> TokenStream {
        let (tokens, binding) = self.value(value);
        if binding < least {
            quote! { (#tokens) }
        } else {
            tokens
        }
    }
}

/// A number by itself.
pub(super) fn number(number: f64) -> TokenStream {
    number_literal(number).0
}

/// A number; the sign of a negative one is an operator, as in any expression.
fn number_literal(number: f64) -> (TokenStream, Binding) {
    if number.is_nan() {
        return (quote! { f64::NAN }, Binding::Atom);
    }
    let size = Literal::f64_unsuffixed(number.abs());
    if number < 0.0 { (quote! { -#size }, Binding::Sign) } else { (quote! { #size }, Binding::Atom) }
}

fn step_name(step: usize) -> Ident {
    format_ident!("s{step}")
}

/// An input as the function sees it. Fields are read from their records, so that no name of a
/// machine file can hide another.
fn input(equations: &Equations, input: Input) -> TokenStream {
    let of = |record: &str, name: &str| {
        let (record, name) = (format_ident!("{record}"), field(name));
        quote! { #record.#name }
    };
    let turned = |function: &str, axis: usize| {
        let name = format_ident!("{function}_{}", &*equations.axes[axis].variable);
        quote! { #name }
    };
    match input {
        Input::Position(axis) => of("axes", &equations.axes[axis].variable),
        Input::Travel(number) => of("travels", &equations.travels[number].name),
        Input::Constant(number) => of("constants", &equations.constants[number].name),
        Input::Motion(motion) => of("motions", &equations.motions[motion].name),
        Input::Cos(axis) => turned("cos", axis),
        Input::Sin(axis) => turned("sin", axis),
    }
}

/// Which records a program reads.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Reads {
    /// The positions of the axes.
    pub(super) axes: bool,
    /// The free travels.
    pub(super) travels: bool,
    /// The error motions.
    pub(super) motions: bool,
    constants: bool,
}

fn inputs(program: &Program) -> BTreeSet<Input> {
    let steps = program.steps.iter().flat_map(|step| step.reads());
    let values = steps.chain(program.results.iter().copied());
    values.filter_map(|value| if let Value::Input(input) = value { Some(input) } else { None }).collect()
}

fn reads(inputs: &BTreeSet<Input>) -> Reads {
    let mut reads = Reads::default();
    for input in inputs {
        match input {
            Input::Position(_) | Input::Cos(_) | Input::Sin(_) => reads.axes = true,
            Input::Travel(_) => reads.travels = true,
            Input::Constant(_) => reads.constants = true,
            Input::Motion(_) => reads.motions = true,
        }
    }
    reads
}

/// Brings the constants and the sines and cosines that a program reads into scope.
fn prelude(equations: &Equations, inputs: &BTreeSet<Input>, reads: Reads, numbers: Numbers) -> TokenStream {
    let mut tokens = TokenStream::new();
    match numbers {
        _ if !reads.constants => {}
        Numbers::Plain => tokens.extend(quote! { let constants = &self.constants; }),
        Numbers::Any => tokens.extend(quote! {
            let constants = Constants::from_array(self.constants.to_array().map(T::from));
        }),
    }
    for (number, axis) in equations.axes.iter().enumerate() {
        let (sine, cosine) = (Input::Sin(number), Input::Cos(number));
        if !inputs.contains(&sine) && !inputs.contains(&cosine) {
            continue;
        }
        let name = |wanted: Input| {
            if inputs.contains(&wanted) {
                input(equations, wanted)
            } else {
                quote! { _ }
            }
        };
        let (sine, cosine, position) = (name(sine), name(cosine), field(&axis.variable));
        tokens.extend(match numbers {
            Numbers::Plain => {
                quote! { let (#sine, #cosine) = ::abbe_runtime::math::sin_cos(axes.#position); }
            }
            Numbers::Any => quote! { let (#sine, #cosine) = axes.#position.sin_cos(); },
        });
    }
    tokens
}
