//! Tests of the notation: what a reader must find on the page, and that text reads back.

use proptest::prelude::*;

use super::{Format, infix, print};
use crate::algebra::{Monomial, Polynomial, Rational, Symbol};
use crate::diagnostic::Diagnostics;
use crate::equations::{Equations, Names};
use crate::source::SourceFile;

/// All shipped machines.
pub(super) const MACHINES: [&str; 15] = [
    "excello-921",
    "nist-turning-center",
    "postech-mill",
    "fxyz-mill",
    "xfyz-mill",
    "xyfz-mill",
    "xyzf-mill",
    "msl-moving-bridge",
    "msl-moving-table",
    "printer-skew",
    "cai-wafer-grinder",
    "linuxcnc-xyzac-trt",
    "linuxcnc-xyzbc-trt",
    "trunnion-5axis",
    "head-table-5axis",
];

/// The equations of a shipped machine.
pub(super) fn equations(name: &str) -> Equations {
    let path = format!("{}/../machines/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    let source = SourceFile::new(name, std::fs::read_to_string(path).expect("a shipped machine"));
    let mut diagnostics = Diagnostics::new();
    crate::compile(&source, &mut diagnostics).expect("a valid machine").equations
}

fn named(name: &str) -> Option<Symbol> {
    Some(match name {
        "x" | "z" | "c" => Symbol::Position(name.into()),
        "dz" => Symbol::Travel(name.into()),
        "X1" | "Zt" | "a_b" => Symbol::Constant(name.into()),
        _ => return None,
    })
}

/// The turned squareness of the turning centre: +X travel goes towards -Z by EB0X, and towards +Z by ao.
#[test]
fn a_symbol_counted_against_iso_has_the_opposite_arm_of_its_name() {
    let of = |format, names| print(&equations("nist-turning-center"), format, names);
    let lines = |names| super::error_lines(&equations("nist-turning-center"), names).join("\n");
    let [symbols, iso] = [Names::Symbols, Names::Iso].map(lines);
    assert!(symbols.contains("+ dx*ao"), "{symbols}");
    assert!(iso.contains("- dx*EB0X"), "{iso}");
    let told = "Counted against the sense of ISO 230-1: ao.";
    assert!(of(Format::Text, Names::Symbols).contains(told));
    assert!(!of(Format::Text, Names::Iso).contains("ounted against"));
    assert!(!of(Format::Latex, Names::Iso).contains("ounted against"));
    // JSON says the arm of the name under either.
    for names in [Names::Symbols, Names::Iso] {
        assert!(
            of(Format::Json, names)
                .contains(r#"{"motion": "EB0X", "symbol": "ao", "arm": "-dx", "symbol_sign": -1}"#)
        );
    }
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
    let text = print(&equations("excello-921"), Format::Text, Names::Symbols);
    for line in [
        "Px = x - X1 + X2 + Xt + dPx",
        "dPx = dxx - dxz + Zt*eyx + (z + Z1 - Zt)*eyz - z*beta",
        "Pz = -z - Z1 + Zt + dPz",
        "dPz = dzx - dzz - Xt*eyx + (x - X1 + X2 + Xt)*eyz - x*alpha",
    ] {
        assert!(text.lines().any(|one| one == line), "{line}\nis not in\n{text}");
    }
    let iso = print(&equations("excello-921"), Format::Text, Names::Iso);
    assert!(iso.contains("dPx = EXX - EXZ + Zt*EBX + (z + Z1 - Zt)*EBZ - z*EB0Z"), "{iso}");
}

#[test]
fn text_stays_within_its_width() {
    for name in MACHINES {
        let text = print(&equations(name), Format::Text, Names::Symbols);
        for line in text.lines().skip(1) {
            assert!(line.chars().count() <= 110, "{name}: {line}");
        }
    }
}

#[test]
fn json_tells_the_sense_and_both_names() {
    let text = print(&equations("nist-turning-center"), Format::Json, Names::Symbols);
    assert!(
        text.contains(r#"{"motion": "EB0X", "symbol": "ao", "arm": "-dx", "symbol_sign": -1}"#),
        "{text}"
    );
    assert_eq!(text.matches("\"symbol_sign\"").count(), 1);
    let lathe = print(&equations("excello-921"), Format::Json, Names::Symbols);
    assert!(lathe.contains(r#""nominal": "x - X1 + X2 + Xt""#));
    assert!(lathe.contains(r#"{"motion": "EBX", "symbol": "eyx", "arm": "Zt"}"#));
    assert!(lathe.contains(r#"{"motion": "EBX", "symbol": "eyx", "arm": "-Xt"}"#));
}

#[test]
fn every_format_prints_every_machine() {
    for name in MACHINES {
        let equations = equations(name);
        for format in
            [Format::Text, Format::Latex, Format::Html, Format::Json, Format::Maxima, Format::Python]
        {
            let text = print(&equations, format, Names::Iso);
            assert!(text.contains(name), "{name} as {format:?}");
            assert_eq!(text, print(&equations, format, Names::Iso), "{name} as {format:?} is the same twice");
        }
    }
}

#[test]
fn the_page_stands_alone_and_its_elements_close() {
    for name in MACHINES {
        let page = print(&equations(name), Format::Html, Names::Symbols);
        for forbidden in ["<script", "http", "src=", "href=", "@import", "url("] {
            assert!(!page.contains(forbidden), "{name} holds {forbidden}");
        }
        assert_closed(&page);
    }
}

/// Every element closes, in the order in which it was opened; those of HTML without content need not.
fn assert_closed(page: &str) {
    let mut open: Vec<&str> = Vec::new();
    for tag in page.split('<').skip(1).map(|piece| piece.split('>').next().expect("a first piece")) {
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().expect("a first piece");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "after {open:?}");
        } else if !tag.ends_with('/') && !["!DOCTYPE", "meta", "br"].contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?} do not close");
}

#[test]
fn latex_has_letters_with_subscripts() {
    let page = print(&equations("excello-921"), Format::Latex, Names::Symbols);
    let error = "\\Delta P_{\\mathrm{x}} &= \\delta_{\\mathrm{xx}} - \\delta_{\\mathrm{xz}} + \
                 Z_{\\mathrm{t}}\\,\\varepsilon_{\\mathrm{yx}} + (z + Z_{\\mathrm{1}} - Z_{\\mathrm{t}})\\,\
                 \\varepsilon_{\\mathrm{yz}} - z\\,\\beta";
    assert!(page.contains(error), "{page}");
}

#[test]
fn hostile_words_stay_words() {
    let mut equations = equations("excello-921");
    equations.title = Some("</title><script>x</script> 100% & \"so\" */ $x_1$ \\".to_owned());
    equations.machine = "a\"b\\c\u{1}".to_owned();
    assert!(!print(&equations, Format::Html, Names::Iso).contains("<script"));
    assert!(print(&equations, Format::Json, Names::Iso).contains(r#""machine": "a\"b\\c\u0001""#));
    assert!(
        print(&equations, Format::Latex, Names::Iso)
            .contains("100\\% \\& \"so\" */ \\$x\\_1\\$ \\textbackslash{}")
    );
    assert!(print(&equations, Format::Maxima, Names::Iso).contains("* / $x_1$"));
}
