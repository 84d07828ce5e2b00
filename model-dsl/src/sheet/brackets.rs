//! Brackets that occur more than once, by name. In: all expressions of a page. Out: `Ly = y - Ya + Yt` for each such bracket, to be printed
//! before the equations, and expressions in which the name stands for it.
//!
//! A name is `L`, the first position in the bracket, and the rotary axes whose sines and cosines stand in it: `Lya` is what `Ly` becomes
//! in the frame that A turns. A machine without rotary axes has no such brackets: its equations stay as they are.

use std::collections::BTreeSet;

use super::factored::{Sum, Term, any_turns};
use super::letter::Letter;
use super::tree::{self, Expression, Signed};
use crate::algebra::{Polynomial, Symbol};
use crate::equations::Equations;

/// From how many symbols on a bracket is named; a shorter one is read at a glance.
const LEAST_SYMBOLS: usize = 3;

/// How the expressions of a page are written: factored, with names for the brackets that occur more than once.
#[derive(Default)]
pub struct Brackets(Vec<(Sum, Letter)>);

impl Brackets {
    /// Finds the brackets of all equations of a machine; `taken` are names that stand for something else.
    pub fn new(equations: &Equations, taken: BTreeSet<String>) -> Self {
        let rows = || equations.rows.iter().chain(&equations.orientation);
        let arms = || rows().flat_map(|row| row.terms.iter().map(|term| &term.arm));
        let nominals = || rows().map(|row| &row.nominal);
        let mut counted = Counted::default();
        if any_turns(arms().chain(nominals())) {
            nominals().for_each(|nominal| counted.inside(&Sum::new(nominal)));
            arms().for_each(|arm| counted.arm(&Sum::new(arm)));
        }
        Self(named(counted, taken))
    }

    /// Each name with what it stands for; a name stands only in definitions after its own.
    pub fn definitions(&self) -> impl Iterator<Item = (&Letter, Expression)> {
        self.0.iter().map(|(sum, letter)| (letter, tree::sum(self.written(sum))))
    }

    /// The terms of an expression with their signs.
    pub fn parts(&self, polynomial: &Polynomial) -> Vec<Signed> {
        self.written(&Sum::new(polynomial))
    }

    /// An expression whose outermost sum is written out, whether it has a name or not.
    pub fn sum(&self, polynomial: &Polynomial) -> Expression {
        tree::sum(self.parts(polynomial))
    }

    /// An expression.
    pub fn expression(&self, polynomial: &Polynomial) -> Expression {
        let sum = Sum::new(polynomial);
        let parts = self.written(&sum);
        let (sum, negative) = sum.positive();
        match self.name_of(&sum) {
            Some(letter) => tree::sum(vec![Signed { negative, value: Expression::Letter(letter.clone()) }]),
            None => tree::sum(parts),
        }
    }

    /// An error motion times its lever arm: `Zt*eyx`, `-(x - X1)*eyz` with the leading minus drawn out.
    pub fn term(&self, arm: &Polynomial, motion: Letter) -> Signed {
        let sum = Sum::new(arm);
        let Signed { negative, value } = match sum.0.as_slice() {
            [only] => self.factor(only),
            _ => self.bracket(sum),
        };
        Signed { negative, value: tree::times(value, motion) }
    }

    /// A sum as a factor: its name, or the sum in brackets.
    fn bracket(&self, sum: Sum) -> Signed {
        let (sum, negative) = sum.positive();
        let value = match self.name_of(&sum) {
            Some(letter) => Expression::Letter(letter.clone()),
            None => Expression::Group(Box::new(tree::sum(self.written(&sum)))),
        };
        Signed { negative, value }
    }

    fn written(&self, sum: &Sum) -> Vec<Signed> {
        sum.0.iter().map(|term| self.factor(term)).collect()
    }

    /// A term: its number, its bracket, its symbols.
    fn factor(&self, term: &Term) -> Signed {
        let bracket = term.bracket.as_ref().map(|bracket| self.bracket((**bracket).clone()).value);
        tree::signed_product(&term.value, bracket, &term.symbols)
    }

    fn name_of(&self, sum: &Sum) -> Option<&Letter> {
        self.0.iter().find(|(known, _)| known == sum).map(|(_, letter)| letter)
    }
}

/// The brackets that are worth a name, in their order.
fn named(counted: Counted, mut taken: BTreeSet<String>) -> Vec<(Sum, Letter)> {
    let worth =
        |(sum, count): &(Sum, usize)| *count > 1 && (sum.symbols().len() >= LEAST_SYMBOLS || sum.turns());
    let give = |(sum, _): (Sum, usize)| {
        let letter = letter(&sum, &taken);
        taken.insert(letter.plain.clone());
        (sum, letter)
    };
    counted.0.into_iter().filter(worth).map(give).collect()
}

/// How often each bracket is written, inner ones before those that hold them.
#[derive(Default)]
struct Counted(Vec<(Sum, usize)>);

impl Counted {
    /// Counts a lever arm, which stands in brackets where it is a sum.
    fn arm(&mut self, sum: &Sum) {
        match sum.0.as_slice() {
            [] | [_] => self.inside(sum),
            _ => self.bracket(sum.clone().positive().0),
        }
    }

    /// Counts the brackets in a sum. Those inside of one that is known were counted with it: they are written where it is defined.
    fn inside(&mut self, sum: &Sum) {
        for bracket in sum.0.iter().filter_map(|term| term.bracket.as_deref()) {
            self.bracket(bracket.clone());
        }
    }

    fn bracket(&mut self, sum: Sum) {
        match self.0.iter_mut().find(|(known, _)| *known == sum) {
            Some((_, count)) => *count += 1,
            None => {
                self.inside(&sum);
                self.0.push((sum, 1));
            }
        }
    }
}

/// `Ly`, `Lya`, and `Lya2` where that is taken.
fn letter(sum: &Sum, taken: &BTreeSet<String>) -> Letter {
    let (mut position, mut axes) = (String::new(), BTreeSet::new());
    for symbol in sum.symbols() {
        match symbol {
            Symbol::Position(name) if position.is_empty() => position.push_str(&name),
            Symbol::Cos(name) | Symbol::Sin(name) => drop(axes.insert(name)),
            _ => {}
        }
    }
    let axes: String = axes.iter().map(|name| &**name).collect();
    let subscript = format!("{position}{axes}");
    let first = if subscript.is_empty() { 1 } else { 2 };
    let numbered = (first..).map(|number: usize| format!("{subscript}{number}"));
    let mut subscripts = (!subscript.is_empty()).then(|| subscript.clone()).into_iter().chain(numbered);
    let free =
        |subscript: &String| !taken.iter().any(|name| name.eq_ignore_ascii_case(&format!("L{subscript}")));
    Letter::bracket(subscripts.find(free).unwrap_or(subscript))
}
