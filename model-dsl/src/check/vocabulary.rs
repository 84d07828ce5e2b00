//! The names that an equation file may use. In: a machine and the letters of a section. Out: symbols, in
//! which every error motion goes by its ISO name, however the file calls it.

use crate::algebra::{Monomial, Polynomial, Symbol};
use crate::machine::{Machine, parse_name};
use crate::suggest::nearest;

/// A name that stands for a motion, a position or a constant, perhaps counted in the other sense: a letter of the section, or a name of
/// the machine.
#[derive(Clone, Debug)]
struct Letter {
    name: String,
    symbol: Symbol,
    negative: bool,
}

/// What names mean in one section.
#[derive(Clone, Debug)]
pub(super) struct Vocabulary<'m> {
    machine: &'m Machine,
    names: Vec<Letter>,
    letters: Vec<Letter>,
}

impl<'m> Vocabulary<'m> {
    /// The names of a machine: positions, constants, travels, symbols and ISO names.
    pub(super) fn new(machine: &'m Machine) -> Self {
        let named = |name: &str, symbol: Symbol| Letter { name: name.to_owned(), symbol, negative: false };
        let mut names: Vec<Letter> = Vec::new();
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
            names.push(Letter { negative: motion.sign < 0, ..known });
        }
        let of_motion = |name: &str| named(name, Symbol::Motion(name.into()));
        names.extend(machine.motions.iter().map(|motion| of_motion(&motion.name)));
        Self { machine, names, letters: Vec::new() }
    }

    /// Whether a letter of that name is given already.
    pub(super) fn has_letter(&self, name: &str) -> bool {
        self.letters.iter().any(|letter| letter.name == name)
    }

    /// Gives a letter to what `value` names; a minus sign before it counts it in the other sense.
    /// `Err` holds the name that is not known.
    pub(super) fn give(&mut self, letter: &str, value: &str) -> Result<(), String> {
        let (negative, name) = match value.strip_prefix('-') {
            Some(rest) => (true, rest.trim()),
            None => (false, value),
        };
        let known = self.machine_name(name).ok_or_else(|| name.to_owned())?;
        let negative = negative != known.negative;
        self.letters.push(Letter { name: letter.to_owned(), negative, ..known });
        Ok(())
    }

    /// The symbol of a name. A letter counted in the other sense comes as a placeholder, which [`Self::settle`] replaces.
    pub(super) fn resolve(&self, name: &str) -> Option<Symbol> {
        let letter = self.letters.iter().find(|letter| letter.name == name).cloned();
        let known = letter.or_else(|| self.machine_name(name))?;
        Some(if known.negative { placeholder(&known) } else { known.symbol })
    }

    /// Replaces letters counted in the other sense by what they stand for, with a minus sign.
    pub(super) fn settle(&self, polynomial: &Polynomial) -> Polynomial {
        let counted = self.names.iter().chain(&self.letters).filter(|letter| letter.negative);
        counted.fold(polynomial.clone(), |settled, letter| {
            let value = -&Polynomial::symbol(letter.symbol.clone());
            substitute(&settled, &placeholder(letter), &value)
        })
    }

    /// The known name that a mistyped one probably means.
    pub(super) fn nearest(&self, name: &str) -> Option<&str> {
        let letters = self.letters.iter().map(|letter| letter.name.as_str());
        nearest(name, letters.chain(self.names.iter().map(|known| known.name.as_str())))
    }

    fn machine_name(&self, name: &str) -> Option<Letter> {
        let known = self.names.iter().find(|known| known.name == name);
        known.cloned().or_else(|| self.alias(name))
    }

    /// A motion by another spelling of its ISO name: `C0Y` and `COY` for `EC0Y`.
    fn alias(&self, name: &str) -> Option<Letter> {
        let found = self.machine.motions.iter().find(|motion| {
            let id = self.machine.links.get(motion.link).map_or("", |link| link.id.as_str());
            parse_name(name, id).is_some_and(|parsed| {
                parsed.letter == motion.kind.letter() && parsed.alignment == motion.kind.alignment()
            })
        });
        let symbol = Symbol::Motion(found?.name.as_str().into());
        Some(Letter { name: name.to_owned(), symbol, negative: false })
    }
}

/// No name of a machine can begin with a minus sign.
fn placeholder(letter: &Letter) -> Symbol {
    Symbol::Constant(format!("-{}", letter.name).into())
}

fn substitute(polynomial: &Polynomial, symbol: &Symbol, value: &Polynomial) -> Polynomial {
    let replaced = polynomial.terms().map(|(monomial, coefficient)| {
        let start = Polynomial::number(coefficient.clone());
        monomial.factors().iter().fold(start, |product, (factor, power)| {
            if factor == symbol {
                (0..*power).fold(product, |product, _| &product * value)
            } else {
                let kept = Polynomial::monomial(
                    Monomial::power(factor.clone(), *power),
                    crate::algebra::Rational::from_integer(1.into()),
                );
                &product * &kept
            }
        })
    });
    replaced.collect()
}
