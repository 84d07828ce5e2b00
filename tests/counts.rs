//! How many error motions a topology has. In: topology words and shipped machines. Out: their usual sets, counted and named.

use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;

use crate::agreement::{compiled, every_word};
use crate::shipped::SHIPPED;

fn of_word(word: &str) -> Equations {
    let mut diagnostics = Diagnostics::new();
    let compiled = model_dsl::compile_word(word, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{word}: {diagnostics:?}");
    compiled.unwrap_or_else(|| panic!("{word} does not compile")).equations
}

fn alignments(equations: &Equations) -> Vec<&str> {
    equations.motions.iter().filter(|motion| motion.alignment).map(|motion| motion.name.as_str()).collect()
}

#[test]
fn every_order_of_three_slides_has_twenty_one() {
    for word in every_word(3) {
        if word.len() == 4 && !word.contains(['A', 'B', 'C']) {
            let equations = of_word(&word);
            assert_eq!(equations.motions.len(), 21, "{word}");
            assert_eq!(alignments(&equations), ["EC0Y", "EA0Z", "EB0Z"], "{word}");
        }
    }
}

#[test]
fn alignments_by_topology() {
    let cases: [(&str, &[&str]); 12] = [
        ("FX", &[]),
        ("ZF", &[]),
        ("XFZ", &["EB0Z"]),
        ("ZFX", &["EB0Z"]),
        ("FXZ", &["EB0Z"]),
        ("XYF", &["EC0Y"]),
        ("YFX", &["EC0Y"]),
        ("FYZ", &["EA0Z"]),
        ("ZFY", &["EA0Z"]),
        ("FC", &[]),
        ("CF", &[]),
        ("CFXYZ", &["EC0Y", "EA0Z", "EB0Z", "EX0C", "EY0C", "EA0C", "EB0C", "EC0C"]),
    ];
    for (word, expected) in cases {
        assert_eq!(alignments(&of_word(word)), expected, "{word}");
    }
}

/// A lone rotary stage has its six motions; without a slide nothing gives its place a meaning.
#[test]
fn a_lone_rotary_stage_has_six() {
    let names: Vec<String> = of_word("FC").motions.iter().map(|motion| motion.name.clone()).collect();
    assert_eq!(names, ["EXC", "EYC", "EZC", "EAC", "EBC", "ECC"]);
}

#[test]
fn shipped_machines() {
    let counts = [27, 8, 21, 43, 5, 5, 21, 21, 31, 43, 21, 3, 43, 21, 21, 21];
    assert_eq!(SHIPPED.len(), counts.len());
    for (shipped, count) in SHIPPED.iter().zip(counts) {
        let equations = compiled(&shipped.text());
        assert_eq!(equations.motions.len(), count, "{}", shipped.name);
        assert_eq!(equations.machine, shipped.name);
    }
}

/// Three squarenesses whatever the topology: the set of POSTECH is turned otherwise and counts the same.
#[test]
fn five_axes_have_six_each_three_squarenesses_and_five_for_each_rotary_axis() {
    for name in ["trunnion-5axis", "head-table-5axis", "nutating-head-5axis"] {
        let shipped = SHIPPED.iter().find(|shipped| shipped.name == name).unwrap();
        let equations = compiled(&shipped.text());
        assert_eq!(alignments(&equations).len(), 3 + 2 * 5, "{name}");
        assert_eq!(equations.motions.len(), 5 * 6 + 3 + 2 * 5, "{name}");
    }
}

/// All 11 742 orders of one to six axes with one F are topology words, and nothing near them is.
#[test]
fn every_order_is_a_word() {
    use model_dsl::machine::TopologyWord;
    use model_dsl::source::Span;
    let legal = |word: &str| TopologyWord::parse(word, Span::new(0, word.len()), &mut Diagnostics::new());
    let words = every_word(6);
    assert_eq!(words.len(), 11_742);
    for word in &words {
        let parsed = legal(word).unwrap_or_else(|| panic!("{word} is refused"));
        let again: String = parsed.workpiece.iter().chain(&['F']).chain(&parsed.tool).collect();
        assert_eq!(again, *word);
        assert!(legal(&word.replace('F', "")).is_none());
        assert!(legal(&format!("{word}F")).is_none());
        assert!(legal(&format!("{word}{}", &word.replace('F', "")[..1])).is_none());
        assert!(legal(&word.to_ascii_lowercase()).is_none());
    }
}
