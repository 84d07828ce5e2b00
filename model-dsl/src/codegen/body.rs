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
    /// Destructuring of the records and the sines and cosines that the program reads.
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

struct Printer<'p> {
    equations: &'p Equations,
    program: &'p Program,
    uses: Vec<usize>,
}

/// Writes a program as a function body.
pub(super) fn body(equations: &Equations, program: &Program) -> Body {
    let printer = Printer { equations, program, uses: program.uses() };
    let shared = (0..program.steps.len()).filter(|step| printer.is_shared(*step));
    let bindings = shared.map(|step| {
        let name = step_name(step);
        let (value, _) = printer.step(step);
        quote! { let #name = #value; }
    });
    Body {
        prelude: prelude(equations, program),
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
            Value::Zero => (quote! { 0.0 }, Binding::Atom),
            Value::Number(number) => {
                number_literal(self.program.numbers.get(number).copied().unwrap_or(f64::NAN))
            }
            Value::Input(input) => {
                let name = input_name(self.equations, input);
                (quote! { #name }, Binding::Atom)
            }
            Value::Step(step) if self.is_shared(step) => {
                let name = step_name(step);
                (quote! { #name }, Binding::Atom)
            }
            Value::Step(step) => self.step(step),
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

fn input_name(equations: &Equations, input: Input) -> Ident {
    match input {
        Input::Position(axis) => field(&equations.axes[axis].variable),
        Input::Travel(number) => field(&equations.travels[number].name),
        Input::Constant(number) => field(&equations.constants[number].name),
        Input::Cos(axis) => format_ident!("cos_{}", &*equations.axes[axis].variable),
        Input::Sin(axis) => format_ident!("sin_{}", &*equations.axes[axis].variable),
        Input::Motion(motion) => field(&equations.motions[motion].name),
    }
}

/// Brings the inputs that a program reads into scope, and no others.
fn prelude(equations: &Equations, program: &Program) -> TokenStream {
    let mut read: BTreeSet<Input> = BTreeSet::new();
    let steps = program.steps.iter().flat_map(|step| step.reads());
    for value in steps.chain(program.results.iter().copied()) {
        if let Value::Input(input) = value {
            read.insert(input);
        }
    }
    let record = |from: TokenStream, record: &str, wanted: &dyn Fn(&Input) -> bool| {
        let fields: Vec<_> =
            read.iter().filter(|input| wanted(input)).map(|input| input_name(equations, *input)).collect();
        let record = format_ident!("{record}");
        (!fields.is_empty()).then(|| quote! { let #record { #(#fields,)* .. } = #from; })
    };
    let constants = record(quote!(self.constants), "Constants", &|input| matches!(input, Input::Constant(_)));
    let axes = record(quote!(*axes), "Axes", &|input| matches!(input, Input::Position(_)));
    let travels = record(quote!(*travels), "Travels", &|input| matches!(input, Input::Travel(_)));
    let motions = record(quote!(*motions), "Motions", &|input| matches!(input, Input::Motion(_)));
    let turns = turns(equations, &read);
    quote! { #constants #axes #travels #motions #turns }
}

fn turns(equations: &Equations, read: &BTreeSet<Input>) -> TokenStream {
    let mut tokens = TokenStream::new();
    for (number, axis) in equations.axes.iter().enumerate() {
        let (sine, cosine) = (Input::Sin(number), Input::Cos(number));
        let name = |input: Input| {
            let ident = input_name(equations, input);
            if read.contains(&input) {
                quote! { #ident }
            } else {
                quote! { _ }
            }
        };
        if read.contains(&sine) || read.contains(&cosine) {
            let (sine, cosine, position) = (name(sine), name(cosine), field(&axis.variable));
            tokens.extend(quote! { let (#sine, #cosine) = ::abbe_runtime::math::sin_cos(axes.#position); });
        }
    }
    tokens
}
