//! Tests of the comparison: the sources' equations agree, and every change to them is named.

use std::collections::BTreeSet;

mod sets;

use super::vocabulary::Vocabulary;
use super::{Report, Verdict, check, differences};
use crate::Compiled;
use crate::algebra::{Polynomial, Symbol};
use crate::diagnostic::Diagnostics;
use crate::expression::parse;
use crate::sheet::infix;
use crate::source::SourceFile;

fn file(path: &str) -> SourceFile {
    let text =
        std::fs::read_to_string(format!("{}/../{path}", env!("CARGO_MANIFEST_DIR"))).expect("a shipped file");
    SourceFile::new(path, text)
}

fn machine(name: &str) -> Compiled {
    let mut diagnostics = Diagnostics::new();
    crate::compile(&file(&format!("machines/{name}.yaml")), &mut diagnostics).expect("a valid machine")
}

fn run(compiled: &Compiled, text: &str) -> Result<Report, Diagnostics> {
    let mut diagnostics = Diagnostics::new();
    let source = SourceFile::new("test.eqs", text);
    check(&compiled.machine, &compiled.equations, &source, &mut diagnostics).ok_or(diagnostics)
}

fn report(compiled: &Compiled, text: &str) -> Report {
    run(compiled, text).unwrap_or_else(|diagnostics| panic!("{diagnostics:?}\n{text}"))
}

/// Every contradiction as (left side, motion or `nominal`, verdict).
fn contradictions(report: &Report) -> Vec<(String, String, Verdict)> {
    let mut all = Vec::new();
    for equation in &report.equations {
        if !equation.nominal.agrees() {
            all.push((equation.left.clone(), "nominal".to_owned(), Verdict::OtherLever));
        }
        for finding in equation.findings.iter().filter(|finding| finding.verdict.disagrees()) {
            all.push((equation.left.clone(), finding.name.clone(), finding.verdict));
        }
    }
    all
}

#[test]
fn the_lathe_agrees_in_full() {
    let report = report(&machine("excello-921"), file("published/excello-921.eqs").text());
    assert!(report.agrees(), "{}", report.text());
    assert_eq!(report.equations.len(), 4);
    assert_eq!(report.count(Verdict::Agrees), 20);
    assert!(report.text().ends_with("4 equations: 20 terms agree.\n"), "{}", report.text());
}

#[test]
fn the_turning_centre_agrees_in_full() {
    let report = report(&machine("nist-turning-center"), file("published/nist-turning-center.eqs").text());
    assert!(report.agrees(), "{}", report.text());
    assert_eq!(report.equations.len(), 5);
    let general = report.equations.iter().take(3).flat_map(|equation| &equation.findings);
    assert!(general.clone().all(|finding| finding.verdict == Verdict::Agrees));
    assert_eq!(general.count(), 11 + 13 + 11);
    let left_out: BTreeSet<&str> = report.equations[3..]
        .iter()
        .flat_map(|equation| &equation.findings)
        .filter(|finding| finding.verdict == Verdict::LeftOut)
        .map(|finding| finding.symbol.as_str())
        .collect();
    let expected = ["dxc", "dxs", "dxt", "dxw", "dzc", "dzt", "dzw", "eys", "eyt"];
    assert_eq!(left_out, BTreeSet::from(expected));
}

#[test]
fn the_misprinted_carriage_is_named() {
    let report = report(&machine("postech-mill"), file("published/postech-carriage.eqs").text());
    let expected = [("T(2,3)".to_owned(), "EAX".to_owned(), Verdict::OppositeSign)];
    assert_eq!(contradictions(&report), expected, "{}", report.text());
    let mended = file("published/postech-carriage.eqs").text().replace("T(2,3) = gamma", "T(2,3) = -gamma");
    assert!(self::report(&machine("postech-mill"), &mended).agrees());
}

#[test]
fn a_carriage_along_its_axis_needs_no_signs() {
    let mut diagnostics = Diagnostics::new();
    let stage = crate::compile_word("FX", &mut diagnostics).expect("a stage");
    let text = "[carriage X]\nlet gamma = EAX\nT(2,3) = gamma\nT(3,2) = gamma\nT(1,4) = x + EXX\n";
    let expected = [("T(2,3)".to_owned(), "EAX".to_owned(), Verdict::OppositeSign)];
    assert_eq!(contradictions(&report(&stage, text)), expected);
}

/// Each shipped file with its machine and the sections that list everything.
fn published() -> [(Compiled, String); 2] {
    let nist = file("published/nist-turning-center.eqs").text().to_owned();
    let general = nist.split("[significant]").next().unwrap_or_default().to_owned();
    [
        (machine("excello-921"), file("published/excello-921.eqs").text().to_owned()),
        (machine("nist-turning-center"), general),
    ]
}

fn polynomial(compiled: &Compiled, text: &str) -> Polynomial {
    let vocabulary = Vocabulary::new(&compiled.machine);
    let read = parse(text, &mut |name| vocabulary.resolve(name)).expect("a published expression");
    vocabulary.settle(&read, &mut usize::MAX.clone()).expect("few terms")
}

/// The published equations as left side and value.
fn equations(compiled: &Compiled, text: &str) -> Vec<(String, Polynomial)> {
    let bare = text.lines().filter(|line| !line.starts_with(['#', '['])).collect::<Vec<_>>().join("\n");
    let joined = bare.replace("\n     ", " ");
    let lines = joined.lines().filter_map(|line| line.split_once('='));
    lines.map(|(left, right)| (left.trim().to_owned(), polynomial(compiled, right))).collect()
}

fn motion(symbols: &BTreeSet<Symbol>) -> String {
    let found = symbols.iter().find(|symbol| matches!(symbol, Symbol::Motion(_)));
    found.map_or("nominal".to_owned(), |symbol| symbol.name().to_string())
}

/// What a change of one monomial must be called: alone in its lever arm it is the whole term.
fn expected(value: &Polynomial, change: &Polynomial, whole: Verdict) -> (String, Verdict) {
    let motion = motion(&change.symbols());
    let others = value.terms().filter(|(monomial, _)| {
        monomial
            .factors()
            .iter()
            .any(|(symbol, _)| matches!(symbol, Symbol::Motion(name) if **name == *motion))
    });
    let alone = motion != "nominal" && others.count() == 1;
    (motion, if alone { whole } else { Verdict::OtherLever })
}

#[test]
fn every_term_that_is_dropped_or_turned_is_named() {
    for (compiled, text) in published() {
        let equations = equations(&compiled, &text);
        for (changed, (left, value)) in equations.iter().enumerate() {
            for (monomial, coefficient) in value.terms() {
                let part = Polynomial::monomial(monomial.clone(), coefficient.clone());
                let cases =
                    [(value - &part, Verdict::Missing), (&(value - &part) - &part, Verdict::OppositeSign)];
                for (other, whole) in cases {
                    let (motion, verdict) = expected(value, &part, whole);
                    let lines = equations.iter().enumerate().map(|(number, (left, value))| {
                        format!("{left} = {}\n", infix(if number == changed { &other } else { value }))
                    });
                    let found = contradictions(&report(&compiled, &lines.collect::<String>()));
                    assert_eq!(found, [(left.clone(), motion, verdict)], "{}", infix(&other));
                }
            }
        }
    }
}

#[test]
fn every_printed_sign_that_is_turned_is_named() {
    for (compiled, text) in published() {
        let sound = equations(&compiled, &text);
        let mut turned = 0;
        for (at, sign) in text.match_indices(['+', '-']) {
            let line = text[..at].rfind('\n').map_or(0, |end| end + 1);
            if text[line..].starts_with('#') {
                continue;
            }
            let mut changed = text.clone();
            changed.replace_range(at..at + 1, if sign == "+" { "-" } else { "+" });
            let expected: BTreeSet<(String, String)> = sound
                .iter()
                .zip(equations(&compiled, &changed))
                .flat_map(|((left, old), (_, new))| motions_of(left, &(&new - old)))
                .collect();
            let found = contradictions(&report(&compiled, &changed));
            let found: BTreeSet<_> = found.into_iter().map(|(left, motion, _)| (left, motion)).collect();
            assert_eq!(found, expected, "{changed}");
            assert!(!expected.is_empty());
            turned += 1;
        }
        assert!(turned > 30, "{turned} signs");
    }
}

fn motions_of(left: &str, change: &Polynomial) -> Vec<(String, String)> {
    let name = |monomial: &crate::algebra::Monomial| {
        let symbols = monomial.factors().iter().map(|(symbol, _)| symbol.clone()).collect();
        (left.to_owned(), motion(&symbols))
    };
    change.terms().map(|(monomial, _)| name(monomial)).collect()
}

/// The name of ISO 230-1 and a symbol that is counted against it are two names with opposite arms; a letter may stand for either.
#[test]
fn a_symbol_counted_against_iso_is_compared_with_its_own_sign() {
    let nist = machine("nist-turning-center");
    let text = file("published/nist-turning-center.eqs").text().to_owned();
    for (letter, right) in [
        ("", "(-EB0X)*dx"),
        ("let g = ao\n", "g*dx"),
        ("let g = -ao\n", "(-g)*dx"),
        ("let g = -EB0X\n", "g*dx"),
    ] {
        let changed = text.replace("ao*dx", right).replace("[general]\n", &format!("[general]\n{letter}"));
        let changed = changed.replace("[significant]\n", &format!("[significant]\n{letter}"));
        assert!(report(&nist, &changed).agrees(), "{letter}{right}");
    }
    let turned = report(&nist, &text.replace("ao*dx", "EB0X*dx"));
    assert_eq!(contradictions(&turned).len(), 2);
    assert!(
        contradictions(&turned)
            .iter()
            .all(|(_, motion, verdict)| motion == "EB0X" && *verdict == Verdict::OppositeSign)
    );
    assert!(
        turned.text().contains("opposite sign: ao (EB0X): derived with lever dx, printed with -dx"),
        "{}",
        turned.text()
    );
}

#[test]
fn a_selection_may_leave_out_but_not_forget() {
    let nist = machine("nist-turning-center");
    let text = "[significant]\nEx = (eyz + eyx)*Z4 + eyz*Z2 + dxz\nEz = -eyx*X4 + dzz\n";
    let expected = [("Ez".to_owned(), "EBZ".to_owned(), Verdict::Missing)];
    assert_eq!(contradictions(&report(&nist, text)), expected);
    let full = text.replace("[significant]", "[general]");
    assert!(contradictions(&report(&nist, &full)).len() > 10);
}

#[test]
fn extra_terms_products_and_constants_are_told_apart() {
    let text = "dPx = dxx - dxz + Zt*eyx + (z + Z1 - Zt)*EBZ - B0Z*z + dzx + X1 + eyx*eyz*z # yaw twice\n";
    let report = report(&machine("excello-921"), text);
    let expected = [
        ("dPx".to_owned(), "nominal".to_owned(), Verdict::OtherLever),
        ("dPx".to_owned(), "EZX".to_owned(), Verdict::Extra),
    ];
    assert_eq!(contradictions(&report), expected);
    assert_eq!(infix(&report.equations[0].second_order), "z*EBX*EBZ");
    let text = report.text();
    for line in [
        "test.eqs disagrees with machine excello-921",
        "  dPx, line 1: nominal part differs: derived 0, printed X1 (X1 is extra)",
        "  dPx, line 1: extra: dzx (EZX): printed with lever 1, not derived",
        "  second order   z*EBX*EBZ: first order drops it",
        "  agrees         eyz (EBZ): z + Z1 - Zt",
        "1 equation: 5 terms agree, 1 extra, 1 nominal part differs. The file has no equation in Z.",
    ] {
        assert!(text.lines().any(|one| one == line), "{line}\nis not in\n{text}");
    }
}

#[test]
fn differences_name_each_monomial() {
    let lathe = machine("excello-921");
    let value = |text: &str| polynomial(&lathe, text);
    let found = differences(&value("x - X1 + 2*Zt"), &value("x + X1 + Zt - Xt"));
    let expected = [
        (Verdict::OppositeSign, value("-X1")),
        (Verdict::Extra, value("-Xt")),
        (Verdict::OtherLever, value("2*Zt")),
    ];
    assert_eq!(found, expected);
}

/// The codes of a file's mistakes with the text under each.
fn mistakes(compiled: &Compiled, text: &str) -> Vec<(&'static str, String)> {
    let source = SourceFile::new("test.eqs", text);
    let diagnostics = run(compiled, text).expect_err("a file with mistakes");
    diagnostics.iter().map(|one| (one.code, source.slice(one.span).to_owned())).collect()
}

#[test]
fn mistakes_are_located() {
    let lathe = machine("excello-921");
    let cases: [(&str, &[(&str, &str)]); 16] = [
        ("", &[("E0507", "")]),
        ("# nothing\n[general]\n", &[("E0507", "")]),
        ("Px + 1\n", &[("E0501", "Px + 1")]),
        ("  + x\n", &[("E0501", "+ x")]),
        ("Qx = x\n", &[("E0502", "Qx")]),
        ("dPx = dxx +\n", &[("E0503", "")]),
        ("dPx = dxx # a = b\n  + # c\n  ) # µ\n", &[("E0503", ")")]),
        ("dPx = dxx\n  + eyy + Zq*X # µ\n", &[("E0504", "eyy"), ("E0504", "Zq"), ("E0504", "X")]),
        ("Ey = dxx\n", &[("E0505", "Ey")]),
        ("dPx = dxx\nEx = dxx\n", &[("E0506", "Ex")]),
        ("[a]\ndPx = dxx\n[b]\ndPx = dxx\n[a]\ndPX = dxx\n", &[("E0506", "dPX")]),
        ("[carriage Q]\nT(1,1) = 1\n", &[("E0508", "[carriage Q]")]),
        ("[general\nPx = x\n", &[("E0508", "[general")]),
        (
            "let 1a = x\nlet b = exx\nlet c = x\nlet c = z\n",
            &[("E0509", "1a"), ("E0504", "exx"), ("E0509", "c")],
        ),
        ("[carriage X]\nT(5,1) = 1\nPx = x\n", &[("E0510", "T(5,1)"), ("E0510", "Px")]),
        ("T(1,1) = 1\n", &[("E0502", "T(1,1)")]),
    ];
    for (text, expected) in cases {
        let found = mistakes(&lathe, text);
        let found: Vec<(&str, &str)> = found.iter().map(|(code, at)| (*code, at.as_str())).collect();
        assert_eq!(found, expected, "{text:?}");
    }
}

#[test]
fn a_slip_of_the_pen_is_guessed() {
    let diagnostics = run(&machine("excello-921"), "dPx = dxx + bta*z\n").expect_err("an unknown name");
    let helps: Vec<_> = diagnostics.iter().filter_map(|one| one.help.as_deref()).collect();
    assert_eq!(helps, ["did you mean `beta`?"]);
}

/// A letter may stand for any expression, letters before it included.
#[test]
fn letters_stand_for_expressions() {
    let lathe = machine("excello-921");
    let text = "let L = Z1 - Zt\nlet arm = z + L\nlet yaw = arm*eyz + Zt*eyx\nlet half = yaw/2\n\
                dPx = dxx - dxz + 2*half - beta*z\n";
    let said = report(&lathe, text);
    assert!(said.agrees(), "{}", said.text());
    let turned = report(&lathe, &text.replace("z + L", "z - L"));
    assert_eq!(contradictions(&turned), [("dPx".to_owned(), "EBZ".to_owned(), Verdict::OtherLever)]);
    // A letter is known from its line on, and stands in no expression of its own.
    assert_eq!(mistakes(&lathe, "let a = b + x\nlet b = z\ndPx = a\n"), [("E0504", "b".to_owned())]);
    let nested = "let a = x + z + X1 + X2 + Z1 + Xt + Zt\nlet b = a^9\nlet c = b^9\nlet d = c^9\ndPx = d^9\n";
    assert!(mistakes(&lathe, nested).iter().all(|(code, _)| *code == "E0503"), "{nested}");
    assert!(!mistakes(&lathe, nested).is_empty());
}

#[test]
fn letters_hold_for_their_section_only() {
    let lathe = machine("excello-921");
    let text = "[a]\nlet b = -EB0Z\nlet q = -x\ndPz = dzx - dzz - Xt*eyx + (-q - X1 + X2 + Xt)*eyz + q*alpha\n\
                dPx = dxx - dxz + Zt*eyx + (z + Z1 - Zt)*eyz + b*z\n";
    assert!(report(&lathe, text).agrees());
    assert_eq!(mistakes(&lathe, &format!("{text}[c]\ndPx = b\n")), [("E0504", "b".to_owned())]);
}

/// What is printed of a machine with rotary axes agrees with it exactly, its brackets taken as letters.
#[test]
fn factored_equations_agree_with_what_was_derived() {
    for name in ["trunnion-5axis", "head-table-5axis"] {
        let compiled = machine(name);
        let lines = crate::sheet::error_lines(&compiled.equations, crate::equations::Names::Iso);
        let statement =
            |line: &String| if line.starts_with('L') { format!("let {line}\n") } else { format!("{line}\n") };
        let report = report(&compiled, &lines.iter().map(statement).collect::<String>());
        assert!(report.agrees() && report.equations.len() == 3, "{name}: {}", report.text());
    }
}

/// C stands on the bed; Z is out of line about X, and Y is not.
#[test]
fn an_error_may_be_counted_from_another_axis_where_that_is_the_same() {
    let compiled = crate::compile_word("CFXYZ", &mut Diagnostics::new()).expect("a word");
    let full = crate::sheet::error_lines(&compiled.equations, crate::equations::Names::Iso);
    let with = |name: &str| {
        let lines = full.iter().map(|line| line.replace("EA0C", name));
        lines
            .map(|line| if line.starts_with('L') { format!("let {line}\n") } else { format!("{line}\n") })
            .collect::<String>()
    };
    for name in ["EA(0Y)C", "EA(OY)C", "A(0Y)C", "AOC", "EAOC"] {
        assert!(report(&compiled, &with(name)).agrees(), "{name}");
    }
    let Err(refused) = run(&compiled, &with("EA(0Z)C")) else { panic!("EA(0Z)C is another error") };
    let first = refused.iter().next().expect("a mistake");
    assert_eq!((first.code, first.label.as_str()), ("E0504", "counted from Z, EA(0Z)C is EA0C - EA0Z"));
    assert!(report(&compiled, &with("(EA(0Y)C)")).agrees());
}
