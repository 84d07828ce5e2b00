//! Tests of factored equations: what is printed has the value of what was derived.

use std::collections::BTreeMap;

use proptest::prelude::*;

use crate::tests::{equations, machines};
use crate::{Format, print};
use model_dsl::algebra::{Axis, Polynomial, Symbol};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::{Equations, Names};
use model_dsl::sheet::{Brackets, error_lines};
use model_dsl::source::SourceFile;

fn file(text: &str) -> Equations {
    let source = SourceFile::new("machine.yaml", text.to_owned());
    model_dsl::compile(&source, &mut Diagnostics::new()).expect("a valid machine").equations
}

/// A number for each name, of the size of a length in metres or an angle in rad: a different one for each point.
fn number(point: u64, name: &str) -> f64 {
    let mixed = name.bytes().fold(point.wrapping_mul(0x9e37_79b9_7f4a_7c15), |state, byte| {
        (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3).rotate_left(29)
    });
    (mixed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// The value of a polynomial at a point, where some names stand for values of their own.
fn value(polynomial: &Polynomial, point: u64, own: &BTreeMap<String, f64>) -> f64 {
    polynomial.evaluate(|symbol| match symbol {
        Symbol::Cos(name) => number(point, name).cos(),
        Symbol::Sin(name) => number(point, name).sin(),
        other => own.get(&**other.name()).copied().unwrap_or_else(|| number(point, other.name())),
    })
}

/// Reads statements one by one, as a reader with a pencil does: a name must be known before it is used.
fn values(statements: &[(String, String)], equations: &Equations, point: u64) -> BTreeMap<String, f64> {
    let mut known: BTreeMap<String, f64> = BTreeMap::new();
    for (left, right) in statements {
        let mut resolve = |name: &str| {
            let axis = equations.axes.iter().any(|axis| *axis.variable == *name);
            let quantity = equations.constants.iter().any(|constant| *constant.name == *name)
                || equations.travels.iter().any(|travel| *travel.name == *name)
                || equations.motions.iter().any(|motion| motion.name == name)
                || known.contains_key(name);
            if axis {
                Some(Symbol::Position(name.into()))
            } else {
                quantity.then(|| Symbol::Constant(name.into()))
            }
        };
        let read = model_dsl::expression::parse(right, &mut resolve);
        let read = read.unwrap_or_else(|error| panic!("{left} = {right}: {error:?}"));
        let found = value(&read, point, &known);
        assert!(known.insert(left.clone(), found).is_none(), "{left} is given twice");
    }
    known
}

/// The statements of a page of plain text, continued lines joined.
fn text_statements(page: &str) -> Vec<(String, String)> {
    let body = page.split("\nError motions\n").next().expect("a first part");
    let (_, body) = body.split_once("\n\n").expect("a head and the equations");
    let mut statements: Vec<(String, String)> = Vec::new();
    for line in body.lines() {
        match line.split_once(" = ") {
            Some((left, right)) if !line.starts_with(' ') => {
                let left = left.strip_prefix("let ").unwrap_or(left);
                statements.push((left.into(), right.into()));
            }
            _ if line.starts_with(' ') => statements.last_mut().expect("a statement").1.push_str(line),
            _ => {}
        }
    }
    statements
}

/// The assignments of a batch file for Maxima.
fn maxima_statements(batch: &str) -> Vec<(String, String)> {
    let code: Vec<&str> = batch.lines().filter(|line| !line.starts_with("/*")).collect();
    let joined = code.join(" ");
    let assignments = joined.split('$').map(str::trim).filter(|text| !text.is_empty());
    let assignment = |text: &str| {
        let (left, right) = text.split_once(" : ").expect("an assignment");
        (left.to_owned(), in_degrees(right))
    };
    assignments.map(assignment).collect()
}

/// An expression for Maxima with its angles in degrees: `cos(1/4*%pi)` is `cos(45 deg)`.
fn in_degrees(expression: &str) -> String {
    let (angles, last) = expression.rsplit_once("*%pi").unwrap_or(("", expression));
    let in_degrees = |part: &str| {
        let before = part.trim_end_matches(|letter: char| letter.is_ascii_digit() || letter == '/');
        let turns = part.strip_prefix(before).unwrap_or_default();
        let (numerator, denominator) = turns.split_once('/').unwrap_or((turns, "1"));
        let [numerator, denominator] =
            [numerator, denominator].map(|number| number.parse::<f64>().expect("a number of half turns"));
        format!("{before}{} deg", 180.0 * numerator / denominator)
    };
    let parts = angles.split("*%pi").filter(|part| !part.is_empty()).map(in_degrees);
    parts.chain([last.to_owned()]).collect()
}

fn assert_same(equations: &Equations, point: u64) {
    let page = text_statements(&print(equations, Format::Text, Names::Iso));
    // A position is printed before its error: the error is read first.
    let (errors, others): (Vec<_>, Vec<_>) = page.into_iter().partition(|(left, _)| left.starts_with("dP"));
    let (positions, brackets): (Vec<_>, Vec<_>) =
        others.into_iter().partition(|(left, _)| left.starts_with('P'));
    let page = [brackets, errors, positions].concat();
    let lines = error_lines(equations, Names::Iso);
    let lines: Vec<_> = lines.iter().filter_map(|line| line.split_once(" = ")).collect();
    let lines: Vec<(String, String)> =
        lines.into_iter().map(|(left, right)| (left.into(), right.into())).collect();
    let batch = maxima_statements(&print(equations, Format::Maxima, Names::Iso));
    let nothing = BTreeMap::new();
    let close = |found: f64, expected: f64, what: &str| {
        let away = (found - expected).abs();
        assert!(away <= 1e-12 * (1.0 + expected.abs()), "{} {what}: {found} {expected}", equations.machine);
    };
    for statements in [&page, &lines, &batch] {
        let found = values(statements, equations, point);
        for row in &equations.rows {
            let motion =
                |term: &model_dsl::equations::Term| number(point, &equations.motions[term.motion].name);
            let error: f64 =
                row.terms.iter().map(|term| value(&term.arm, point, &nothing) * motion(term)).sum();
            let letter = row.direction.letter().to_ascii_lowercase();
            close(found[&format!("dP{letter}")], error, "error");
            if let Some(position) = found.get(&format!("P{letter}")) {
                close(*position, value(&row.nominal, point, &nothing) + error, "position");
            }
        }
    }
}

#[test]
fn shipped_machines_print_what_was_derived() {
    for name in machines() {
        let equations = equations(&name);
        (0..20).for_each(|point| assert_same(&equations, point));
    }
}

/// Words of one to six axes, F among them.
fn words() -> impl Strategy<Value = String> {
    let letters = Just(vec!['X', 'Y', 'Z', 'A', 'B', 'C']).prop_shuffle();
    (letters, 1..7_usize, any::<prop::sample::Index>()).prop_map(|(letters, count, place)| {
        let mut word: Vec<char> = letters.into_iter().take(count).collect();
        word.insert(place.index(count + 1), 'F');
        word.into_iter().collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn words_print_what_was_derived(word in words(), point in any::<u64>()) {
        let equations = model_dsl::compile_word(&word, &mut Diagnostics::new()).expect("a word").equations;
        assert_same(&equations, point);
    }
}

#[test]
fn lengths_stand_together_and_brackets_have_names() {
    let text = print(&equations("trunnion-5axis"), Format::Text, Names::Iso);
    // Worked by hand: the part's frame is that of A turned by c, A's that of the bed turned by a.
    for line in [
        "let Lx = x - Xc + Xt",
        "let Ly = y - Ya + Yt",
        "let Lz = z - Za + Zt",
        "Pz = Ly*sin(a) + Lz*cos(a) - Zc + dPz",
    ] {
        assert!(text.lines().any(|one| one == line), "{line}\nis not in\n{text}");
    }
    let spelled = print(&equations("trunnion-5axis"), Format::Json, Names::Iso);
    for part in [
        r#""nominal": "y*sin(a) + z*cos(a) - Ya*sin(a) + Yt*sin(a) - Za*cos(a) - Zc + Zt*cos(a)""#,
        r#""nominal_factored": "Ly*sin(a) + Lz*cos(a) - Zc""#,
        r#"{"name": "Ly", "value": "y - Ya + Yt"}"#,
    ] {
        assert!(spelled.contains(part), "{part}\nis not in\n{spelled}");
    }
}

#[test]
fn a_machine_of_slides_has_no_names_for_brackets() {
    let slides = |name: &String| equations(name).axes.iter().all(|axis| !axis.rotary);
    for name in machines().into_iter().filter(slides) {
        let equations = equations(&name);
        assert!(!print(&equations, Format::Json, Names::Iso).contains("factored"), "{name}");
        assert_eq!(error_lines(&equations, Names::Iso).len(), equations.rows.len(), "{name}");
    }
}

/// The machine has its own Ly and lYA: the names of brackets go round them, in every format.
#[test]
fn names_of_brackets_are_free_ones() {
    let text = "abbe: 1\nname: own\nchain:\n  workpiece:\n    - {rotary: A, along: -A, origin: [0, Ly, lYA]}\n  tool:\n    \
                - {slide: Y, along: +Y}\n    - {slide: Z, along: +Z}\n    - {tool: tip, offset: [0, Yt, Zt]}\n";
    let equations = file(text);
    let json = print(&equations, Format::Json, Names::Iso);
    assert!(json.contains(r#"{"name": "Ly2", "value": "y - Ly + Yt"}"#), "{json}");
    assert!(!json.contains(r#"{"name": "Lya","#), "{json}");
    (0..5).for_each(|point| assert_same(&equations, point));
}

/// By hand: C turns what stands above it about Y, and its frame is turned by c against that before it.
#[test]
fn a_lever_arm_is_spelled_out_where_nothing_is_named() {
    let equations = equations("head-table-5axis");
    let motion = equations.motions.iter().position(|motion| motion.name == "EBC").expect("the motion");
    let arm = Brackets::default().expression(&equations.arm(Axis::X, motion));
    let line = model_dsl::sheet::line(&model_dsl::sheet::text::Plain, &arm);
    assert_eq!(line, "-(z - L*cos(b) + Zb - Zc)*cos(c)");
}
