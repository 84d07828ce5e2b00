//! What is written can be read again. In: equations and topology words. Out: the same equations, after a way through text.

use model_dsl::algebra::{Polynomial, Symbol};
use model_dsl::equations::Equations;
use model_dsl::machine::template;
use model_dsl::sheet::infix;
use model_dsl::{diagnostic::Diagnostics, expression};
use proptest::prelude::*;

use crate::agreement::{compiled, every_word};
use crate::random::{machines, words};
use crate::shipped::SHIPPED;
use crate::yaml;

/// Reads an expression in the letters of a machine.
fn read(text: &str, equations: &Equations) -> Polynomial {
    let symbol = |name: &str| {
        if equations.axes.iter().any(|axis| *axis.variable == *name) {
            Some(Symbol::Position(name.into()))
        } else if equations.travels.iter().any(|travel| *travel.name == *name) {
            Some(Symbol::Travel(name.into()))
        } else {
            let constant = equations.constants.iter().find(|constant| *constant.name == *name);
            constant.map(|constant| Symbol::Constant(constant.name.clone()))
        }
    };
    expression::parse(text, &mut |name| symbol(name)).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

fn polynomials(equations: &Equations) -> impl Iterator<Item = &Polynomial> {
    let rows = equations.rows.iter();
    rows.flat_map(|row| std::iter::once(&row.nominal).chain(row.terms.iter().map(|term| &term.arm)))
}

/// The reader bounds its work, and a monomial takes up to some ten products: what has more terms than this may be refused.
/// Axes that lean one behind the other come to thousands; no machine that is shipped comes to a tenth of this.
const SURELY_READ: usize = 1000;

fn survives(equations: &Equations) {
    for polynomial in polynomials(equations).filter(|polynomial| polynomial.size() <= SURELY_READ) {
        let text = infix(polynomial);
        assert_eq!(&read(&text, equations), polynomial, "{text}");
    }
}

#[test]
fn shipped_equations_survive_their_print() {
    for shipped in SHIPPED {
        let equations = compiled(&shipped.text());
        assert!(polynomials(&equations).all(|polynomial| polynomial.size() <= SURELY_READ / 10));
        survives(&equations);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_equations_survive_their_print(machine in machines()) {
        survives(&compiled(&yaml::text(&machine, false)));
    }

    #[test]
    fn long_words_and_their_chains_are_one_machine(word in words()) {
        word_is_its_chain(&word);
    }
}

/// The file that `abbe new` writes spells the chain out; it means what the word means.
fn word_is_its_chain(word: &str) {
    let mut diagnostics = Diagnostics::new();
    let text = template(word, &mut diagnostics).unwrap_or_else(|| panic!("{word}: {diagnostics:?}"));
    let chain = compiled(&text);
    let word = compiled(&format!("abbe: 1\nname: word\ntopology: {word}\n"));
    assert_eq!(chain.motions.len(), word.motions.len());
    for (ours, theirs) in chain.motions.iter().zip(&word.motions) {
        assert_eq!(
            (&ours.name, &ours.symbol, &ours.meaning),
            (&theirs.name, &theirs.symbol, &theirs.meaning)
        );
    }
    assert!(polynomials(&chain).eq(polynomials(&word)), "{text}");
}

#[test]
fn words_and_their_chains_are_one_machine() {
    every_word(2).iter().for_each(|word| word_is_its_chain(word));
}
