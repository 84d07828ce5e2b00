//! Tests of the sheet: what a reader must find in the text and in JSON, and that text reads back.

use proptest::prelude::*;

use super::{Sheet, infix, json, text};
use crate::algebra::{Monomial, Polynomial, Rational, Symbol};
use crate::diagnostic::Diagnostics;
use crate::equations::{Equations, Names};
use crate::source::SourceFile;

/// The names of all shipped machines.
pub(super) fn machines() -> Vec<String> {
    let folder = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../machines")).expect("a folder");
    let files = folder.map(|entry| entry.expect("a file").path());
    let machines = files.filter(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    let name = |path: std::path::PathBuf| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let names: Vec<String> = machines.map(name).collect();
    assert!(names.len() > 10, "{names:?}");
    names
}

/// The equations of a shipped machine.
pub(super) fn equations(name: &str) -> Equations {
    let path = format!("{}/../machines/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    let source = SourceFile::new(name, std::fs::read_to_string(path).expect("a shipped machine"));
    let mut diagnostics = Diagnostics::new();
    crate::compile(&source, &mut diagnostics).expect("a valid machine").equations
}

/// The page in plain text.
pub(super) fn page(equations: &Equations, names: Names) -> String {
    text::page(&Sheet::new(equations, names))
}

fn named(name: &str) -> Option<Symbol> {
    Some(match name {
        "x" | "z" | "c" => Symbol::Position(name.into()),
        "dz" => Symbol::Travel(name.into()),
        "X1" | "Zt" | "a_b" => Symbol::Constant(name.into()),
        _ => return None,
    })
}

fn symbols() -> impl Strategy<Value = Symbol> {
    prop_oneof![
        prop::sample::select(vec!["x", "z", "dz", "X1", "Zt", "a_b"])
            .prop_map(|name| named(name).expect("one of the known names")),
        Just(Symbol::Cos("c".into())),
        Just(Symbol::Sin("c".into())),
        prop::sample::select(vec!["cos(17.5 deg)", "sin(17.5 deg)", "cos(45 deg)", "cos(30 deg)"])
            .prop_map(|text| crate::expression::parse(text, &mut named).expect("a number in itself"))
            .prop_map(|value| value.symbols().into_iter().next().expect("one symbol")),
    ]
}

fn polynomials() -> impl Strategy<Value = Polynomial> {
    let monomial = prop::collection::vec((symbols(), 1..4_u32), 0..4);
    let part = (monomial, -40..40_i64, 1..30_i64).prop_map(|(factors, numerator, denominator)| {
        let value = Polynomial::number(Rational::new(numerator.into(), denominator.into()));
        factors.into_iter().fold(value, |product, (symbol, power)| {
            &product * &Polynomial::monomial(Monomial::power(symbol, power), Rational::from_integer(1.into()))
        })
    });
    prop::collection::vec(part, 0..7).prop_map(|parts| parts.into_iter().collect())
}

proptest! {
    #[test]
    fn infix_reads_back(polynomial in polynomials()) {
        let text = infix(&polynomial);
        prop_assert_eq!(crate::expression::parse(&text, &mut named), Ok(polynomial), "{}", text);
    }
}

#[test]
fn the_lathe_reads_as_in_the_report() {
    let text = page(&equations("excello-921"), Names::Symbols);
    for line in [
        "Px = x - X1 + X2 + Xt + dPx",
        "dPx = dxx - dxz + Zt*eyx + (z + Z1 - Zt)*eyz - z*beta",
        "Pz = -z - Z1 + Zt + dPz",
        "dPz = dzx - dzz - Xt*eyx + (x - X1 + X2 + Xt)*eyz - x*alpha",
    ] {
        assert!(text.lines().any(|one| one == line), "{line}\nis not in\n{text}");
    }
    let iso = page(&equations("excello-921"), Names::Iso);
    assert!(iso.contains("dPx = EXX - EXZ + Zt*EBX + (z + Z1 - Zt)*EBZ - z*EB0Z"), "{iso}");
}

#[test]
fn text_stays_within_its_width() {
    for name in machines() {
        let text = page(&equations(&name), Names::Symbols);
        for line in text.lines().skip(1) {
            assert!(line.chars().count() <= 110, "{name}: {line}");
        }
    }
}

#[test]
fn json_tells_the_sense_and_both_names() {
    let text = json::object(&equations("nist-turning-center"));
    assert!(
        text.contains(r#"{"motion": "EB0X", "symbol": "ao", "arm": "-dx", "symbol_sign": -1}"#),
        "{text}"
    );
    assert_eq!(text.matches("\"symbol_sign\"").count(), 1);
    let lathe = json::object(&equations("excello-921"));
    assert!(lathe.contains(r#""nominal": "x - X1 + X2 + Xt""#));
    assert!(lathe.contains(r#"{"motion": "EBX", "symbol": "eyx", "arm": "Zt"}"#));
    assert!(lathe.contains(r#"{"motion": "EBX", "symbol": "eyx", "arm": "-Xt"}"#));
}
