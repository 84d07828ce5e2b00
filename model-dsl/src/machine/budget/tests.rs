//! Tests of the error budget by a word: that eight are as many as set-up leaves, by the rank of the lever arms.

use proptest::prelude::*;

use crate::Compiled;
use crate::algebra::Axis;
use crate::diagnostic::Diagnostics;
use crate::equations::Equations;
use crate::program::Interpreter;
use crate::source::SourceFile;

/// How many positions the lever arms are taken at: three numbers each, far more than there are unknowns.
const POSITIONS: u64 = 24;

fn compiled(text: &str) -> (Option<Compiled>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let found = crate::compile(&SourceFile::new("machine.yaml", text.to_owned()), &mut diagnostics);
    (found, diagnostics)
}

fn shipped(name: &str) -> String {
    std::fs::read_to_string(format!("{}/../machines/{name}.yaml", env!("CARGO_MANIFEST_DIR")))
        .expect("a machine")
}

fn with_budget(text: &str, budget: &str) -> String {
    text.replacen("abbe: 1\n", &format!("abbe: 1\nbudget: {budget}\n"), 1)
}

fn names(equations: &Equations) -> Vec<&str> {
    equations.motions.iter().map(|motion| motion.name.as_str()).collect()
}

/// A number between -1 and 1, a different one for each name and point.
fn number(point: u64, name: &str) -> f64 {
    let mixed = name.bytes().fold(point.wrapping_mul(0x9e37_79b9_7f4a_7c15), |state, byte| {
        (state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3).rotate_left(29)
    });
    (mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// What the tip does at all positions together, as one column.
type Column = Vec<f64>;

/// The columns of the location errors with their names, and those of setting up the part (its place, its turn) and the tool tip.
fn columns(equations: &Equations) -> (Vec<(String, Column)>, Vec<Column>) {
    let constants: Vec<f64> = equations.constants.iter().map(|constant| number(0, &constant.name)).collect();
    let machine = Interpreter::new(equations, &constants);
    let tips: Vec<usize> = ["Xt", "Yt", "Zt", "L"]
        .iter()
        .filter_map(|name| equations.constants.iter().position(|constant| *constant.name == **name))
        .collect();
    let placed: Vec<usize> =
        (0..equations.motions.len()).filter(|motion| equations.motions[*motion].alignment).collect();
    let mut errors: Vec<(String, Column)> =
        placed.iter().map(|motion| (equations.motions[*motion].name.clone(), Column::new())).collect();
    let mut set_up = vec![Column::new(); 6 + tips.len()];
    for point in 1..=POSITIONS {
        let positions: Vec<f64> =
            equations.axes.iter().map(|axis| 2.0 * number(point, &axis.variable)).collect();
        let tip = machine.nominal(&positions);
        let levers = machine.levers(&positions, &[]);
        for ((_, column), motion) in errors.iter_mut().zip(&placed) {
            column.extend(levers[*motion]);
        }
        let (places, turns) = set_up.split_at_mut(3);
        let (turns, tools) = turns.split_at_mut(3);
        for axis in Axis::ALL {
            let mut unit = [0.0; 3];
            unit[axis.index()] = 1.0;
            places[axis.index()].extend(unit);
            let (u, v) = (axis.next().index(), axis.next().next().index());
            let mut turned = [0.0; 3];
            (turned[u], turned[v]) = (-tip[v], tip[u]);
            turns[axis.index()].extend(turned);
        }
        for (column, tool) in tools.iter_mut().zip(&tips) {
            let mut longer = constants.clone();
            longer[*tool] += 1.0;
            let moved = Interpreter::new(equations, &longer).nominal(&positions);
            column.extend(Axis::ALL.map(|axis| moved[axis.index()] - tip[axis.index()]));
        }
    }
    (errors, set_up)
}

/// How many of the columns are independent, by Gram and Schmidt, twice over for the sake of rounding.
fn rank(columns: &[&Column]) -> usize {
    let dot = |a: &Column, b: &Column| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Column> = Vec::new();
    for column in columns {
        let size = dot(column, column).sqrt();
        let mut rest = (*column).clone();
        for _ in 0..2 {
            for known in &basis {
                let along = dot(&rest, known);
                rest.iter_mut().zip(known).for_each(|(value, known)| *value -= along * known);
            }
        }
        let length = dot(&rest, &rest).sqrt();
        // What is dependent is left with the rounding of doubles, some 1e-15; random columns keep a hundredth and more.
        if length > 1e-9 * size {
            basis.push(rest.into_iter().map(|value| value / length).collect());
        }
    }
    basis.len()
}

/// The eight are independent of set-up and each other, and with set-up they make up every location error.
fn assert_minimal(full: &Equations, eight: &Equations) {
    let (errors, set_up) = columns(full);
    let chosen = names(eight);
    assert_eq!(chosen.len(), 8, "{} {chosen:?}", full.machine);
    let kept = errors.iter().filter(|(name, _)| chosen.contains(&name.as_str())).map(|(_, column)| column);
    let set_up_rank = rank(&set_up.iter().collect::<Vec<_>>());
    let chosen_rank = rank(&set_up.iter().chain(kept).collect::<Vec<_>>());
    let all_rank = rank(&set_up.iter().chain(errors.iter().map(|(_, column)| column)).collect::<Vec<_>>());
    assert_eq!(chosen_rank, set_up_rank + 8, "{}: {chosen:?} are independent", full.machine);
    assert_eq!(all_rank, chosen_rank, "{}: {chosen:?} make up all", full.machine);
}

#[test]
fn eight_are_as_many_as_set_up_leaves() {
    for (name, expected) in [
        ("trunnion-5axis", ["EC0Y", "EA0Z", "EB0Z", "EB0A", "EC0A", "EY0C", "EA0C", "EB0C"]),
        ("head-table-5axis", ["EC0Y", "EA0Z", "EB0Z", "EA0B", "EC0B", "EX0C", "EA0C", "EB0C"]),
    ] {
        // The place of the tip has three lengths, whichever of them the file speaks of.
        let text = shipped(name).replace("offset: [0, 0, -L]", "offset: [Xt, Yt, -L]").replace(
            "constants:\n  Xc: from the frame of X",
            "constants:\n  Xt:\n  Yt:\n  Xc: from the frame of X",
        );
        let full = compiled(&text).0.expect("a valid machine").equations;
        let eight = compiled(&with_budget(&text, "eight")).0.expect("a machine that fits").equations;
        assert_eq!(names(&eight), expected, "{name}");
        assert_minimal(&full, &eight);
        let same = compiled(&with_budget(&text, "full")).0.expect("a valid machine").equations;
        assert_eq!((names(&same), names(&full).len()), (names(&full), 43), "{name}");
    }
}

/// By hand, for a part that turns on C on B: the axes are square to each other and to the slides, and C passes B in X.
#[test]
fn five_belong_to_the_rotary_axes() {
    let eight =
        compiled("abbe: 1\nname: mill\nbudget: eight\ntopology: CBXFZY\n").0.expect("a machine that fits");
    let names = names(&eight.equations).into_iter().map(str::to_owned).collect::<Vec<_>>();
    for name in ["EA0B", "EC0B", "EX0C", "EA0C", "EB0C"] {
        assert!(names.contains(&name.to_owned()), "{name} is not in {names:?}");
    }
}

#[test]
fn a_machine_that_does_not_fit_is_told() {
    for (word, reason) in [
        ("XYFZ", "it is for two rotary axes, but the chain has 0"),
        ("CXYFZ", "it is for two rotary axes, but the chain has 1"),
        ("ABXFYZC", "it is for two rotary axes, but the chain has 3"),
        ("XYZBCF", "it is for rotary axes on the slides, but slide Z is carried by B"),
        ("CAFXZ", "it is for three slides X, Y, Z, but the chain has 2"),
    ] {
        let (machine, diagnostics) =
            compiled(&format!("abbe: 1\nname: mill\nbudget: eight\ntopology: {word}\n"));
        let found: Vec<_> = diagnostics.iter().map(|one| (one.code, one.label.as_str())).collect();
        assert!(machine.is_none());
        assert_eq!(found, [("E0147", reason)], "{word}");
    }
    let (machine, diagnostics) = compiled(&with_budget(
        &shipped("trunnion-5axis").replace("along: +Z", "along: +Z\n      errors: [EZZ]"),
        "eight",
    ));
    assert!(machine.is_none() && diagnostics.iter().any(|one| one.code == "E0147"));
    let (machine, diagnostics) = compiled(&with_budget(&shipped("trunnion-5axis"), "seven"));
    assert!(machine.is_none() && diagnostics.iter().any(|one| one.code == "E0104"));
}

/// Words of three slides and two rotary axes, which stand on them: on the part's side, on the tool's, or one on each.
fn words() -> impl Strategy<Value = String> {
    let rotary = prop::sample::select(vec!["AB", "BA", "BC", "CB", "AC", "CA"]);
    let slides = Just(vec!['X', 'Y', 'Z', 'F']).prop_shuffle();
    (rotary, slides, 0..3_usize).prop_map(|(rotary, slides, with_part)| {
        let (part, tool) = rotary.split_at(with_part);
        format!("{part}{}{tool}", slides.into_iter().collect::<String>())
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn eight_are_as_many_in_every_five_axis_chain(word in words()) {
        let full = crate::compile_word(&word, &mut Diagnostics::new()).expect("a word").equations;
        let text = format!("abbe: 1\nname: mill\nbudget: eight\ntopology: {word}\n");
        let eight = compiled(&text).0.expect("a machine that fits").equations;
        assert_minimal(&full, &eight);
    }
}
