//! Laws of the algebra. In: random polynomials and matrices. Out: that the ring is a ring, that
//! evaluating respects it, that a squared sine is rewritten without changing a value, and that a
//! program lowered from a polynomial computes that polynomial.

use abbe_model_dsl::algebra::{Axis, FirstOrder, Htm, Polynomial, Rational, Symbol, sine_and_cosine};
use abbe_model_dsl::program::{Builder, Input, Value};
use proptest::prelude::*;

fn letters() -> Vec<Symbol> {
    let mut letters = vec![
        Symbol::Position("x".into()),
        Symbol::Travel("dz".into()),
        Symbol::Constant("X1".into()),
        Symbol::Cos("c".into()),
        Symbol::Sin("c".into()),
        Symbol::Sin("a".into()),
        Symbol::Cos("a".into()),
    ];
    letters.extend([20, 45].into_iter().flat_map(of_constant_angle));
    letters
}

/// The symbols of an angle in degrees that never changes: two of 20 degrees, one of 45.
fn of_constant_angle(degrees: i64) -> Vec<Symbol> {
    let (sine, cosine) = sine_and_cosine(&Rational::from_integer(degrees.into()));
    (&sine + &cosine).symbols().into_iter().collect()
}

fn polynomial() -> impl Strategy<Value = Polynomial> {
    let term = (-4_i64..=4, 1_i64..=3, prop::collection::vec(0_usize..10, 0..4));
    prop::collection::vec(term, 0..5).prop_map(|terms| {
        terms
            .into_iter()
            .map(|(above, below, symbols)| {
                let number = Polynomial::number(Rational::new(above.into(), below.into()));
                let symbols = symbols.into_iter().map(|at| Polynomial::symbol(letters()[at].clone()));
                symbols.fold(number, |product, symbol| &product * &symbol)
            })
            .collect()
    })
}

/// Values at which sin^2 + cos^2 = 1 holds.
fn value_of(symbol: &Symbol) -> f64 {
    match symbol {
        Symbol::Position(_) => 1.75,
        Symbol::Travel(_) => -0.5,
        Symbol::Constant(_) => 2.25,
        // A constant angle brings its numbers along.
        Symbol::Motion(_) | Symbol::FixedCos(_) | Symbol::FixedSin(_) => f64::NAN,
        Symbol::Cos(name) => angle(name).cos(),
        Symbol::Sin(name) => angle(name).sin(),
    }
}

fn angle(name: &str) -> f64 {
    if name == "c" { 0.7 } else { -1.9 }
}

fn close(left: f64, right: f64) -> bool {
    // A few hundred roundings of numbers below 10^5.
    (left - right).abs() <= 1e-9 * (1.0 + left.abs())
}

proptest! {
    #[test]
    fn polynomials_are_a_commutative_ring(a in polynomial(), b in polynomial(), c in polynomial()) {
        prop_assert_eq!(&a + &b, &b + &a);
        prop_assert_eq!(&a * &b, &b * &a);
        prop_assert_eq!(&(&a * &b) * &c, &a * &(&b * &c));
        prop_assert_eq!(&a * &(&b + &c), &(&a * &b) + &(&a * &c));
        prop_assert!((&a - &a).is_zero());
        prop_assert_eq!(&a * &Polynomial::one(), a);
    }

    #[test]
    fn evaluating_respects_sums_and_products(a in polynomial(), b in polynomial()) {
        let (va, vb) = (a.evaluate(value_of), b.evaluate(value_of));
        prop_assert!(close((&a + &b).evaluate(value_of), va + vb));
        prop_assert!(close((&a * &b).evaluate(value_of), va * vb));
    }

    #[test]
    fn a_number_is_what_has_no_symbol(a in polynomial(), number in -3_i64..=3) {
        prop_assert_eq!(a.as_number().is_none(), !a.symbols().is_empty(), "{:?}", a);
        if let Some(value) = a.as_number() {
            prop_assert_eq!(&Polynomial::number(value), &a);
        }
        prop_assert_eq!(a.is_one(), a == Polynomial::one());
        prop_assert_eq!(Polynomial::integer(number).as_number(), Some(Rational::from_integer(number.into())));
        prop_assert_eq!(Polynomial::integer(number).is_one(), number == 1);
    }

    #[test]
    fn no_square_of_a_sine_survives(a in polynomial(), b in polynomial()) {
        let product = &a * &b;
        for (monomial, _) in product.terms() {
            for (symbol, power) in monomial.factors() {
                let reduced = match symbol {
                    Symbol::Sin(_) | Symbol::FixedSin(_) => true,
                    Symbol::FixedCos(angle) => *angle.degrees() == Rational::from_integer(45.into()),
                    _ => false,
                };
                prop_assert!(*power == 1 || !reduced, "{:?}", monomial);
            }
        }
    }

    #[test]
    fn a_program_computes_its_polynomials(polynomials in prop::collection::vec(polynomial(), 1..4)) {
        let letters = letters();
        let resolve = |symbol: &Symbol| letters.iter().position(|known| known == symbol).map(Input::Motion);
        let mut builder = Builder::new(&resolve);
        polynomials.iter().for_each(|polynomial| builder.result(polynomial));
        let program = builder.finish();
        let given = |input| match input {
            Input::Motion(at) => value_of(&letters[at]),
            other => panic!("{other:?} was never given"),
        };
        let results = program.run(given);
        prop_assert_eq!(results.len(), polynomials.len());
        for (result, polynomial) in results.into_iter().zip(&polynomials) {
            prop_assert!(close(result, polynomial.evaluate(value_of)), "{} for {:?}", result, polynomial);
        }
        for (number, step) in program.steps.iter().enumerate() {
            let earlier = step.reads().all(|value| !matches!(value, Value::Step(read) if read >= number));
            prop_assert!(earlier, "step {number} reads a later one");
        }
    }

    /// Of any symbol whose powers are not rewritten.
    #[test]
    fn a_product_is_differentiated_by_the_rule_of_leibniz(a in polynomial(), b in polynomial(), at in 0_usize..3) {
        let by = |polynomial: &Polynomial| polynomial.derivative(&letters()[at]);
        prop_assert_eq!(by(&(&a * &b)), &(&by(&a) * &b) + &(&a * &by(&b)));
        prop_assert_eq!(by(&Polynomial::symbol(letters()[at].clone())), Polynomial::one());
    }

    #[test]
    fn the_first_order_product_is_the_derivative(a in polynomial(), da in polynomial(), b in polynomial(), db in polynomial()) {
        let with = |nominal: &Polynomial, slope: &Polynomial| {
            &FirstOrder::nominal(nominal.clone()) + &FirstOrder::error(0, slope.clone())
        };
        let product = &with(&a, &da) * &with(&b, &db);
        let slope = product.error_part().next().map(|(_, slope)| slope.clone()).unwrap_or_default();
        prop_assert_eq!(product.nominal_part(), &(&a * &b));
        prop_assert_eq!(slope, &(&a * &db) + &(&da * &b));
    }
}

/// A displacement with a large rotation, an offset and all six small errors.
fn displaced(axis: Axis, name: &str, first: usize) -> Htm {
    let error = |at: usize| FirstOrder::error(first + at, Polynomial::one());
    let offset = |name: &str| FirstOrder::nominal(Polynomial::symbol(Symbol::Constant(name.into())));
    Htm::translation([offset("X1"), offset("Y1"), offset("Z1")])
        .then(&Htm::rotation(axis, &name.into(), -1))
        .then(&Htm::small([error(0), error(1), error(2)], [error(3), error(4), error(5)]))
}

#[test]
fn a_displacement_and_its_inverse_cancel_to_first_order() {
    let there = displaced(Axis::Z, "c", 0).then(&displaced(Axis::X, "a", 6));
    assert_eq!(there.then(&there.inverse()), Htm::identity());
    assert_eq!(there.inverse().then(&there), Htm::identity());
}

#[test]
fn products_of_displacements_associate() {
    let (a, b, c) = (displaced(Axis::Z, "c", 0), displaced(Axis::X, "a", 6), displaced(Axis::Y, "b", 12));
    assert_eq!(a.then(&b).then(&c), a.then(&b.then(&c)));
}

#[test]
fn a_small_rotation_about_z_turns_x_towards_y() {
    let zero = FirstOrder::default;
    let turned =
        Htm::small([zero(), zero(), FirstOrder::error(0, Polynomial::one())], [zero(), zero(), zero()]);
    let one = FirstOrder::nominal(Polynomial::one());
    let [_, y, _] = turned.place(&[one, zero(), zero()]);
    assert_eq!(y, FirstOrder::error(0, Polynomial::one()));
}

/// Equation (3-9) of the Excello report: `1 + [e]x` beside the displacement, above a row 0 0 0 1.
#[test]
fn a_small_displacement_has_the_entries_of_its_matrix() {
    let error = |at: usize| FirstOrder::error(at, Polynomial::one());
    let small = Htm::small([error(0), error(1), error(2)], [error(3), error(4), error(5)]);
    let (zero, one) = (FirstOrder::default(), FirstOrder::nominal(Polynomial::one()));
    let expected = [
        [one.clone(), -&error(2), error(1), error(3)],
        [error(2), one.clone(), -&error(0), error(4)],
        [-&error(1), error(0), one.clone(), error(5)],
        [zero.clone(), zero.clone(), zero, one],
    ];
    for (row, entries) in expected.iter().enumerate() {
        for (column, entry) in entries.iter().enumerate() {
            assert_eq!(small.entry(row, column).as_ref(), Some(entry), "row {row}, column {column}");
        }
    }
    assert_eq!((small.entry(4, 0), small.entry(0, 4)), (None, None));
}
