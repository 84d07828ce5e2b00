//! Function bodies. In: a program. Out: `let` bindings for what is used twice, and one
//! expression for each result. Brackets are written wherever the order of operations needs
//! them, so that what is printed is what was meant.

use std::collections::BTreeSet;

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::idents::field;
use crate::equations::{AxisInfo, Equations};
use crate::program::{Input, Program, Step, Value};

/// A body: the inputs it reads, its bindings, and its results.
pub(super) struct Body {
    /// Which records it reads.
    pub(super) reads: Reads,
    /// Brings the constants that it reads into scope.
    pub(super) constants: TokenStream,
    /// The sines and cosines that it reads, in the order of the axes.
    pub(super) turned: Vec<Turned>,
    /// Values that are used more than once.
    pub(super) bindings: TokenStream,
    /// One expression for each result.
    pub(super) results: Vec<TokenStream>,
}

/// The sine and the cosine of an axis.
pub(super) struct Turned {
    /// The number of the axis.
    pub(super) axis: usize,
    /// The pattern that names the sine if it is read.
    pub(super) sine: TokenStream,
    /// The pattern that names the cosine if it is read.
    pub(super) cosine: TokenStream,
    /// The angle that they are of.
    pub(super) angle: TokenStream,
}

impl Body {
    /// Brings the constants and the sines and cosines that it reads into scope.
    pub(super) fn prelude(&self) -> TokenStream {
        let constants = &self.constants;
        let read: Vec<_> = self.turned.iter().map(Some).collect();
        let (names, values) = (names(&read), self.sines());
        let turned = (!read.is_empty()).then(|| quote! { let #names = #values; });
        quote! { #constants #turned }
    }

    /// What works out the sines and cosines that it reads from `axes`, all at once.
    pub(super) fn sines(&self) -> TokenStream {
        let angles = self.turned.iter().map(|turned| &turned.angle);
        quote! { ::abbe_runtime::math::sin_cos_each([#(#angles),*]) }
    }
}

/// The pattern that names the sines and cosines of axes, as far as they are read.
pub(super) fn names(read: &[Option<&Turned>]) -> TokenStream {
    let of = |name: fn(&Turned) -> &TokenStream| {
        let names = read.iter().map(move |turned| turned.map_or(quote! { _ }, |turned| name(turned).clone()));
        quote! { [#(#names),*] }
    };
    let (sines, cosines) = (of(|turned| &turned.sine), of(|turned| &turned.cosine));
    quote! { (#sines, #cosines) }
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
    let inputs = inputs(program);
    let reads = reads(&inputs);
    Body {
        reads,
        constants: constants(reads),
        turned: turned(equations, &inputs),
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
            Value::Zero => number_literal(0.0),
            Value::Number(number) => {
                number_literal(self.program.numbers.get(number).copied().unwrap_or(f64::NAN))
            }
            Value::Input(read) => (input(self.equations, read), Binding::Atom),
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
    /// The record of the axes: their positions, or what of them sines and cosines are of.
    pub(super) axes: bool,
    /// The positions of the axes as they are.
    pub(super) positions: bool,
    /// The free travels.
    pub(super) travels: bool,
    /// The error motions.
    pub(super) motions: bool,
    /// The constants.
    pub(super) constants: bool,
}

impl Reads {
    /// Every record.
    pub(super) const EVERYTHING: Self =
        Self { axes: true, positions: true, travels: true, motions: true, constants: true };
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
            Input::Position(_) => (reads.axes, reads.positions) = (true, true),
            Input::Cos(_) | Input::Sin(_) => reads.axes = true,
            Input::Travel(_) => reads.travels = true,
            Input::Constant(_) => reads.constants = true,
            Input::Motion(_) => reads.motions = true,
        }
    }
    reads
}

fn constants(reads: Reads) -> TokenStream {
    if reads.constants {
        quote! { let constants = &self.constants; }
    } else {
        TokenStream::new()
    }
}

fn turned(equations: &Equations, inputs: &BTreeSet<Input>) -> Vec<Turned> {
    let name = |wanted: Input| match inputs.contains(&wanted) {
        true => input(equations, wanted),
        false => quote! { _ },
    };
    let read = |(number, _): &(usize, &_)| {
        [Input::Sin(*number), Input::Cos(*number)].iter().any(|wanted| inputs.contains(wanted))
    };
    let turned = |(number, axis): (usize, &AxisInfo)| {
        let position = field(&axis.variable);
        Turned {
            axis: number,
            sine: name(Input::Sin(number)),
            cosine: name(Input::Cos(number)),
            angle: quote! { axes.#position },
        }
    };
    equations.axes.iter().enumerate().filter(read).map(turned).collect()
}
