//! The names that an equation file may use. In: a machine and the letters of a section. Out: symbols, in
//! which every error motion goes by its ISO name, however the file calls it.

use crate::algebra::{Monomial, Polynomial, Symbol};
use crate::machine::reference::difference;
use crate::machine::{Machine, parse_name};
use crate::suggest::nearest;

/// A name of the machine, perhaps counted in the other sense.
#[derive(Clone, Debug)]
struct Name {
    name: String,
    symbol: Symbol,
    negative: bool,
}

/// A letter of the section, and what it stands for.
#[derive(Clone, Debug)]
struct Letter {
    name: String,
    value: Polynomial,
}

/// What names mean in one section.
#[derive(Clone, Debug)]
pub(super) struct Vocabulary<'m> {
    machine: &'m Machine,
    names: Vec<Name>,
    letters: Vec<Letter>,
}

impl<'m> Vocabulary<'m> {
    /// The names of a machine: positions, constants, travels, symbols and ISO names.
    pub(super) fn new(machine: &'m Machine) -> Self {
        let named = |name: &str, symbol: Symbol| Name { name: name.to_owned(), symbol, negative: false };
        let mut names: Vec<Name> = Vec::new();
        for (_, link) in machine.axes() {
            names.push(named(&link.variable(), Symbol::Position(link.variable())));
        }
        for constant in &machine.constants {
            names.push(named(&constant.name, Symbol::Constant(constant.name.clone())));
        }
        for travel in machine.motions.iter().filter_map(|motion| motion.travel.as_ref()) {
            names.push(named(&travel.value, Symbol::Travel(travel.value.clone())));
        }
        for motion in &machine.motions {
            let known = named(&motion.symbol, Symbol::Motion(motion.name.as_str().into()));
            names.push(Name { negative: motion.sign < 0, ..known });
        }
        let of_motion = |name: &str| named(name, Symbol::Motion(name.into()));
        names.extend(machine.motions.iter().map(|motion| of_motion(&motion.name)));
        Self { machine, names, letters: Vec::new() }
    }

    /// Whether a letter of that name is given already.
    pub(super) fn has_letter(&self, name: &str) -> bool {
        self.letters.iter().any(|letter| letter.name == name)
    }

    /// Gives a letter to an expression that was settled.
    pub(super) fn give(&mut self, letter: &str, value: Polynomial) {
        self.letters.push(Letter { name: letter.to_owned(), value });
    }

    /// The symbol of a name. A letter, and a name counted in the other sense, come as placeholders, which [`Self::settle`] replaces.
    pub(super) fn resolve(&self, name: &str) -> Option<Symbol> {
        if self.has_letter(name) {
            return Some(placeholder(name));
        }
        let known = self.machine_name(name)?;
        Some(if known.negative { placeholder(&known.name) } else { known.symbol })
    }

    /// Replaces placeholders by what they stand for. `None` where that is too much to expand.
    pub(super) fn settle(&self, polynomial: &Polynomial, work: &mut usize) -> Option<Polynomial> {
        let counted = self.names.iter().filter(|name| name.negative && !self.has_letter(&name.name));
        let counted = counted.map(|name| (&name.name, -&Polynomial::symbol(name.symbol.clone())));
        let letters = self.letters.iter().map(|letter| (&letter.name, letter.value.clone()));
        counted.chain(letters).try_fold(polynomial.clone(), |settled, (name, value)| {
            substitute(&settled, &placeholder(name), &value, work)
        })
    }

    /// The known name that a mistyped one probably means.
    pub(super) fn nearest(&self, name: &str) -> Option<&str> {
        let letters = self.letters.iter().map(|letter| letter.name.as_str());
        nearest(name, letters.chain(self.names.iter().map(|known| known.name.as_str())))
    }

    fn machine_name(&self, name: &str) -> Option<Name> {
        let known = self.names.iter().find(|known| known.name == name);
        known.cloned().or_else(|| self.alias(name))
    }

    /// A motion by another spelling of its ISO name: `C0Y` and `COY` for `EC0Y`, and `EC(0X)Y` where it is the same counted from X.
    fn alias(&self, name: &str) -> Option<Name> {
        let (found, reason) = self.spelled(name)?;
        let symbol = Symbol::Motion(self.machine.motions.get(found)?.name.as_str().into());
        reason.is_none().then(|| Name { name: name.to_owned(), symbol, negative: false })
    }

    /// Why a name such as `EC(0X)Y` is not that of an alignment error of this machine, though `EC0Y` is.
    pub(super) fn miscounted(&self, name: &str) -> Option<String> {
        self.spelled(name)?.1
    }

    /// The motion that another spelling names, and why it is another one where that is counted from an axis.
    fn spelled(&self, name: &str) -> Option<(usize, Option<String>)> {
        let motions = self.machine.motions.iter().enumerate();
        let mut named = motions.filter_map(|(number, motion)| {
            let id = self.machine.links.get(motion.link).map_or("", |link| link.id.as_str());
            let parsed = parse_name(name, id)?;
            let same = parsed.letter == motion.kind.letter() && parsed.alignment == motion.kind.alignment();
            same.then_some((number, motion, parsed.counted_from))
        });
        let (number, motion, from) = named.next()?;
        let reason =
            from.and_then(|from| difference(name, &motion.name, &from, &self.machine.counted(number)));
        Some((number, reason))
    }
}

/// No name of a machine can begin with a minus sign.
fn placeholder(name: &str) -> Symbol {
    Symbol::Constant(format!("-{name}").into())
}

/// Replaces a symbol by a value; each product of two terms is work, of which there may be so much. `None` where it is not enough.
fn substitute(
    polynomial: &Polynomial,
    symbol: &Symbol,
    value: &Polynomial,
    work: &mut usize,
) -> Option<Polynomial> {
    let mut sum = Polynomial::zero();
    for (monomial, coefficient) in polynomial.terms() {
        let mut product = Polynomial::number(coefficient.clone());
        for (factor, power) in monomial.factors() {
            if factor != symbol {
                let one = crate::algebra::Rational::from_integer(1.into());
                product = &product * &Polynomial::monomial(Monomial::power(factor.clone(), *power), one);
                continue;
            }
            for _ in 0..*power {
                *work = work.checked_sub(product.size().max(1) * value.size().max(1))?;
                product = &product * value;
            }
        }
        *work = work.checked_sub(product.size())?;
        sum = &sum + &product;
    }
    Some(sum)
}
