//! Tests of names that count from another axis: by hand, and against the lines and axes of the homogeneous transformations.

use std::collections::BTreeMap;

use proptest::prelude::*;

use crate::algebra::{Axis, FirstOrder, Htm, Polynomial, Symbol};
use crate::derivation::link_matrix;
use crate::diagnostic::Diagnostics;
use crate::machine::{LinkKind, Machine, MotionKind, from_word, read};
use crate::source::{SourceFile, Span};

fn file(text: &str) -> (Option<Machine>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let machine = read(&SourceFile::new("machine.yaml", text.to_owned()), &mut diagnostics);
    (machine, diagnostics)
}

fn trunnion() -> Machine {
    let path = format!("{}/../machines/trunnion-5axis.yaml", env!("CARGO_MANIFEST_DIR"));
    file(&std::fs::read_to_string(path).expect("a shipped machine")).0.expect("a valid machine")
}

/// What a motion is, counted from an axis; nothing where that does not show it.
fn counted(machine: &Machine, name: &str, from: &str) -> Option<String> {
    let number = machine.motions.iter().position(|motion| motion.name == name).expect("a motion");
    machine.counted(number).into_iter().find(|one| one.from == from).map(|one| one.is)
}

/// C stands on A, and A on the bed beside the slides; X is the direction of the frame, Z is out of line about X and Y.
#[test]
fn the_trunnion_by_hand() {
    let machine = trunnion();
    for (name, from, is) in [
        ("EB0C", "A", Some("EB0C")),
        ("EB0C", "X", Some("EB0C + EB0A")),
        ("EB0C", "Z", Some("EB0C + EB0A - EB0Z")),
        ("EB0A", "X", Some("EB0A")),
        ("EC0A", "Y", Some("EC0A - EC0Y")),
        ("EA0C", "X", None),
        ("EA0C", "A", None),
        // The zero of A counts along -A.
        ("EA0C", "Y", Some("EA0C - EA0A")),
        ("EC0Y", "X", Some("EC0Y")),
        ("EA0Z", "Y", Some("EA0Z")),
        ("EY0C", "A", Some("EY0C")),
        ("EX0C", "A", None),
        ("EY0C", "Z", None),
        ("EY0A", "C", None),
    ] {
        assert_eq!(counted(&machine, name, from).as_deref(), is, "{name} from {from}");
    }
}

#[test]
fn a_file_may_count_from_another_axis_where_that_is_the_same() {
    let with = |errors: &str| {
        file(&format!(
            "abbe: 1\nname: table\nchain:\n  workpiece:\n    - {{rotary: C, along: -C, errors: [{errors}]}}\n  tool:\n    \
             - {{slide: Y, along: +Y}}\n    - {{slide: Z, along: +Z, errors: [EZZ, EA0Z]}}\n    \
             - {{tool: tip, offset: [Xt, Yt, 0]}}\n"
        ))
    };
    for name in ["EA(0Y)C", "EA(OY)C", "A(0Y)C", "EA0C", "EAOC", "AOC", "A0C"] {
        let machine = with(name).0.unwrap_or_else(|| panic!("{name} is read"));
        assert!(machine.motions.iter().any(|motion| motion.name == "EA0C"), "{name}");
    }
    for (name, reason) in [
        ("EA(0Z)C", "counted from Z, EA(0Z)C is EA0C - EA0Z"),
        ("EA(0X)C", "EA0C cannot be counted from X"),
        ("EA(0C)C", "EA0C cannot be counted from C"),
        ("EX(0Y)C", "EX0C cannot be counted from Y"),
    ] {
        let (machine, diagnostics) = with(name);
        assert!(machine.is_none(), "{name}");
        let found: Vec<_> = diagnostics.iter().collect();
        assert_eq!(found.len(), 1, "{name}");
        assert_eq!((found[0].code, found[0].label.as_str()), ("E0146", reason));
    }
    // A motion of the axis counts from nothing but its command.
    let (_, diagnostics) = with("EA(0Y)");
    assert!(diagnostics.iter().any(|one| one.code == "E0140"));
}

/// The small turn of a link's line or axis about a direction: for each error motion its factor, with rotary axes at zero.
fn turned(machine: &Machine, number: usize, about: Axis) -> BTreeMap<String, f64> {
    let link = &machine.links[number];
    let chain = machine.branch(link.branch).filter(|(other, _)| *other <= number);
    let before = chain.fold(Htm::identity(), |htm, (other, _)| htm.then(&link_matrix(machine, other)));
    let along = link.along.axis;
    let position = Symbol::Position(link.variable());
    // The way of a slide's origin for each mm, or the column of a rotary axis's matrix: a direction with its errors.
    let part = |row: Axis| -> FirstOrder {
        match link.kind {
            LinkKind::Slide(_) => before.origin()[row.index()].clone(),
            _ => before.entry(row.index(), along.index()).expect("an entry of the rotation"),
        }
    };
    let at_zero = |polynomial: &Polynomial| match link.kind {
        LinkKind::Slide(_) => {
            polynomial.derivative(&position).evaluate(|symbol| f64::from(matches!(symbol, Symbol::Cos(_))))
                * link.along.sign as f64
        }
        _ => polynomial.evaluate(|symbol| f64::from(matches!(symbol, Symbol::Cos(_)))),
    };
    // `about` is across `along`: a turn moves the direction towards the third one.
    let third =
        Axis::ALL.into_iter().find(|axis| *axis != about && *axis != along).expect("a third direction");
    let side = if about.next() == along { 1.0 } else { -1.0 };
    let sides = part(third);
    let factors = sides.error_part().map(|(motion, factor)| {
        let known = &machine.motions[motion];
        (known.name.clone(), known.kind, side * at_zero(factor))
    });
    let placed =
        factors.filter(|(_, kind, factor)| matches!(kind, MotionKind::Alignment(_)) && *factor != 0.0);
    placed.map(|(name, _, factor)| (name, factor)).collect()
}

/// `EA0C - EA0Z` as factors.
fn read_sum(text: &str) -> BTreeMap<String, f64> {
    let mut words = text.split(' ');
    let mut sum = BTreeMap::from([(words.next().expect("a first name").to_owned(), 1.0)]);
    while let (Some(sign), Some(name)) = (words.next(), words.next()) {
        sum.insert(name.to_owned(), if sign == "+" { 1.0 } else { -1.0 });
    }
    sum
}

fn words() -> impl Strategy<Value = String> {
    let letters = Just(vec!['X', 'Y', 'Z', 'A', 'B', 'C']).prop_shuffle();
    (letters, 2..7_usize, any::<prop::sample::Index>()).prop_map(|(letters, count, place)| {
        let mut word: Vec<char> = letters.into_iter().take(count).collect();
        word.insert(place.index(count + 1), 'F');
        word.into_iter().collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// What a name says is the angle between the two lines, as the matrices of the links have them.
    #[test]
    fn names_say_what_is_between_two_lines(word in words(), relative in any::<bool>()) {
        let mut machine = from_word(&word, Span::default(), &mut Diagnostics::new()).expect("a word");
        machine.relative = relative;
        for (number, motion) in machine.motions.iter().enumerate() {
            let MotionKind::Alignment(about) = motion.kind else { continue };
            if machine.links[motion.link].along.axis == about {
                continue;
            }
            for one in machine.counted(number) {
                let other = machine.links.iter().position(|link| link.id == one.from).expect("a link");
                let mut between = turned(&machine, motion.link, about);
                for (name, factor) in turned(&machine, other, about) {
                    *between.entry(name).or_insert(0.0) -= factor;
                }
                between.retain(|_, factor| *factor != 0.0);
                let own = between[&motion.name];
                let expected: BTreeMap<_, _> = between.into_iter().map(|(name, factor)| (name, factor * own)).collect();
                prop_assert_eq!(read_sum(&one.is), expected, "{} {} from {}", word, motion.name, one.from);
            }
        }
    }
}

/// Across a lean no name of ISO 230-1 counts; between axes that stand on the same turned body it does.
#[test]
fn no_name_counts_across_a_lean() {
    let from_y = |before: &str, direction: &str| {
        let text = format!(
            "abbe: 1\nname: head\nchain:\n  tool:\n{before}    - {{slide: Y, along: +Y}}\n    \
             - {{rotary: B, along: {direction}, errors: [EA0B]}}\n    - {{tool: tip, offset: [Xt, Yt, Zt]}}\n"
        );
        counted(&file(&text).0.expect("a valid machine"), "EA0B", "Y")
    };
    let on_a_turned_body = "    - {fixed: lean, turned: {A: 20 deg}}\n";
    assert_eq!(from_y("", "+B").as_deref(), Some("EA0B"));
    assert_eq!(from_y("", "[0, 1, 1]"), None);
    assert_eq!(from_y(on_a_turned_body, "+B").as_deref(), Some("EA0B"));
}
