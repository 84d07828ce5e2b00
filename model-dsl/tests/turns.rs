//! The rotation of the tool relative to the part, by hand. In: small machines whose turns can be written down at once.
//! Out: the same from the compiler. That random machines agree with exact rotations is tested beside the other laws.

#![expect(
    clippy::unwrap_used,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_model_dsl::algebra::{Axis, Htm};
use abbe_model_dsl::derivation::{link_matrix, relative_position};
use abbe_model_dsl::diagnostic::{Diagnostics, render};
use abbe_model_dsl::equations::Equations;
use abbe_model_dsl::machine::Branch;
use abbe_model_dsl::sheet::infix;
use abbe_model_dsl::source::SourceFile;
use abbe_model_dsl::{compile, compile_word};

fn word(word: &str) -> Equations {
    compile_word(word, &mut Diagnostics::new()).unwrap().equations
}

fn file(rest: &str) -> Equations {
    let source = SourceFile::new("machine.yaml", format!("abbe: 1\nname: machine\n{rest}"));
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&source, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{}", render(&source, &diagnostics, false));
    compiled.unwrap().equations
}

/// The turns of a motion about X, Y and Z, as they are printed.
fn turns(equations: &Equations, name: &str) -> [String; 3] {
    let motion = equations.motions.iter().position(|motion| motion.name == name).unwrap();
    Axis::ALL.map(|direction| infix(&equations.turn(direction, motion)))
}

#[test]
fn a_slide_under_the_tool_turns_it_and_one_under_the_part_turns_it_back() {
    let mill = word("XFYZ");
    assert_eq!(turns(&mill, "EAY"), ["1", "0", "0"]);
    assert_eq!(turns(&mill, "EBZ"), ["0", "1", "0"]);
    assert_eq!(turns(&mill, "ECX"), ["0", "0", "-1"]);
}

#[test]
fn displacements_turn_nothing() {
    let mill = word("XFYZ");
    for name in ["EXX", "EYX", "EZX", "EXY", "EYY", "EZY", "EXZ", "EYZ", "EZZ"] {
        assert_eq!(turns(&mill, name), ["0", "0", "0"], "{name}");
    }
}

#[test]
fn every_rotation_of_a_single_stage_is_there() {
    for (stage, letter) in [("FX", 'X'), ("FC", 'C'), ("XF", 'X')] {
        let equations = word(stage);
        let own = if stage.starts_with('F') { "1" } else { "-1" };
        for (about, letter_of_rotation) in ["A", "B", "C"].into_iter().enumerate() {
            let found = turns(&equations, &format!("E{letter_of_rotation}{letter}"));
            let expected: [&str; 3] = std::array::from_fn(|axis| if axis == about { own } else { "0" });
            assert_eq!(found, expected, "{stage} E{letter_of_rotation}{letter}");
        }
    }
}

/// The angular positioning error is counted along the axis, so that on the part's side it turns the tool back only where
/// the part's rotation is counted right-handed; a topology word counts it the other way round.
#[test]
fn positive_rotation_of_a_table_of_a_word_turns_the_tool_forwards() {
    assert_eq!(turns(&word("CF"), "ECC"), ["0", "0", "1"]);
    assert_eq!(turns(&word("FC"), "ECC"), ["0", "0", "1"]);
}

#[test]
fn what_stands_behind_a_rotary_axis_turns_with_it() {
    let stage = word("FCX");
    assert_eq!(turns(&stage, "EAX"), ["cos(c)", "sin(c)", "0"]);
    assert_eq!(turns(&stage, "ECX"), ["0", "0", "1"]);
    assert_eq!(turns(&stage, "EAC"), ["1", "0", "0"]);
}

/// The part's frame turns with its table: what a fixed observer sees about X, the part sees about its own directions.
#[test]
fn a_rotary_table_sees_the_turns_of_the_other_side_in_its_own_directions() {
    let chain = "chain: {workpiece: [{rotary: C, along: +Z}], tool: [{slide: X, along: +X}, {tool: tip, offset: [Xt, Yt, Zt]}]}";
    let table = file(chain);
    assert_eq!(turns(&table, "EAX"), ["cos(c)", "-sin(c)", "0"]);
    assert_eq!(turns(&table, "EAC"), ["-cos(c)", "sin(c)", "0"]);
    assert_eq!(turns(&table, "ECC"), ["0", "0", "-1"]);
}

#[test]
fn a_line_turns_its_carriage_only_where_the_file_says_so() {
    let chain = |rotates: &str| {
        file(&format!(
            "chain: {{tool: [{{slide: X, along: +X}}, {{slide: Y, along: +Y, errors: {{EC0Y: {{symbol: a{rotates}}}}}}}, {{tool: tip, offset: [Xt, Yt, Zt]}}]}}"
        ))
    };
    assert_eq!(turns(&chain(""), "EC0Y"), ["0", "0", "0"]);
    assert_eq!(turns(&chain(", rotates: true"), "EC0Y"), ["0", "0", "1"]);
}

/// A lathe derives X and Z, and its carriages yaw about the direction that it does not derive.
#[test]
fn turns_do_not_ask_which_directions_are_sensitive() {
    let lathe = file("sensitive: [X, Z]\ntopology: ZFX\n");
    assert_eq!(turns(&lathe, "EBX"), ["0", "1", "0"]);
    assert_eq!(turns(&lathe, "EBZ"), ["0", "-1", "0"]);
}

#[test]
fn turns_speak_of_the_motions_of_the_rows_only() {
    let chain = "chain: {tool: [{slide: X, along: +X, errors: [EXX, EAX, EBX]}, {tool: tip, offset: [0, 0, Zt]}]}\nsensitive: [X]\n";
    let stage = file(chain);
    let names: Vec<&str> = stage.motions.iter().map(|motion| motion.name.as_str()).collect();
    assert_eq!(names, ["EXX", "EBX"]);
    assert_eq!(stage.turns.each_ref().map(Vec::len), [0, 1, 0]);
}

/// The whole product of all links, from which both can be taken at once: another way to the same.
#[test]
fn the_whole_product_has_the_same_tip_and_the_same_turns() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let source = SourceFile::new("machine.yaml", std::fs::read_to_string(&path).unwrap());
        let compiled = compile(&source, &mut Diagnostics::new()).unwrap();
        let machine = &compiled.machine;
        let branch = |branch| {
            let links = machine.branch(branch).map(|(number, _)| link_matrix(machine, number));
            links.fold(Htm::identity(), |product, link| product.then(&link))
        };
        let product = branch(Branch::Workpiece).inverse().then(&branch(Branch::Tool));
        assert_eq!(relative_position(machine), *product.origin(), "{}", path.display());
        for (direction, turn) in Axis::ALL.into_iter().zip(product.turn()) {
            for (number, motion) in machine.motions.iter().enumerate() {
                let kept = compiled.equations.motions.iter().position(|kept| kept.name == motion.name);
                let Some(kept) = kept else { continue };
                let factor = turn.error_part().find(|(own, _)| *own == number);
                let factor = factor.map(|(_, factor)| factor.clone()).unwrap_or_default();
                assert_eq!(
                    compiled.equations.turn(direction, kept),
                    factor,
                    "{} {}",
                    path.display(),
                    motion.name
                );
                seen += usize::from(!factor.is_zero());
            }
        }
    }
    assert!(seen > 100, "{seen} turns only");
}
