//! The direction of the tool, by hand. In: small machines with `orientation: true`, whose directions can be written down at once. Out: the
//! same from the compiler. That random machines agree with exact rotations is tested beside the other laws.

#![expect(
    clippy::unwrap_used,
    reason = "a panic is the report of a test, also from a function that tests share"
)]

use abbe_model_dsl::algebra::{Axis, Polynomial};
use abbe_model_dsl::check;
use abbe_model_dsl::diagnostic::{Diagnostics, render};
use abbe_model_dsl::equations::{Equations, Names};
use abbe_model_dsl::program::Interpreter;
use abbe_model_dsl::sheet::{Sheet, direction_error_lines, error_lines, infix, json, text};
use abbe_model_dsl::source::SourceFile;
use abbe_model_dsl::{Compiled, compile, compile_word};

fn source(rest: &str) -> SourceFile {
    SourceFile::new("machine.yaml", format!("abbe: 1\nname: machine\norientation: true\n{rest}"))
}

fn file(rest: &str) -> Compiled {
    let source = source(rest);
    let mut diagnostics = Diagnostics::new();
    let compiled = compile(&source, &mut diagnostics);
    assert!(!diagnostics.has_errors(), "{}", render(&source, &diagnostics, false));
    compiled.unwrap()
}

fn derived(rest: &str) -> Equations {
    file(rest).equations
}

fn nominal(equations: &Equations) -> Vec<String> {
    equations.orientation.iter().map(|row| infix(&row.nominal)).collect()
}

fn errors(equations: &Equations) -> Vec<String> {
    direction_error_lines(equations, Names::Iso)
}

/// What a motion changes of I, J and K, as it is printed.
fn tilts(equations: &Equations, name: &str) -> [String; 3] {
    let motion = equations.motions.iter().position(|motion| motion.name == name).unwrap();
    Axis::ALL.map(|direction| infix(&equations.tilt(direction, motion)))
}

fn names(motions: &[abbe_model_dsl::equations::Motion]) -> Vec<&str> {
    motions.iter().map(|motion| motion.name.as_str()).collect()
}

/// Turned about X by a, a tool along Z leans by a towards -Y; about Y by b, by b towards +X; about Z it does not lean.
#[test]
fn slides_lean_the_tool_and_lean_it_back_under_the_part() {
    let mill = derived("topology: XFYZ\n");
    assert_eq!(nominal(&mill), ["0", "0", "1"]);
    assert_eq!(errors(&mill), ["dI = -EBX + EBY + EBZ", "dJ = EAX - EAY - EAZ", "dK = 0"]);
}

/// A head that turns by b about Y points the tool to (sin b, 0, cos b). Its own error is the derivative of that; a table that turns by c
/// with the part, as a topology word has it, sees the head turn by +c.
#[test]
fn rotary_axes_point_the_tool() {
    let head = derived("topology: FB\n");
    assert_eq!(nominal(&head), ["sin(b)", "0", "cos(b)"]);
    assert_eq!(tilts(&head, "EBB"), ["cos(b)", "0", "-sin(b)"]);
    assert_eq!(tilts(&head, "ECB"), ["0", "sin(b)", "0"]);
    let table = derived("topology: CFB\n");
    assert_eq!(nominal(&table), ["cos(c)*sin(b)", "sin(b)*sin(c)", "cos(b)"]);
    assert_eq!(tilts(&table, "ECC"), ["-sin(b)*sin(c)", "cos(c)*sin(b)", "0"]);
}

const CHAIN_OF_SPINDLE: &str = "\
chain:
  tool:
    - {slide: X, along: +X}
    - {rotary: A, along: +A, errors: []}
    - {spindle: S, along: SPINDLE, errors: [EAS, EBS, ECS]}
    - {tool: tip, offset: [0, 0, Zt]}
";

/// The tool points along its spindle: what turns about that axis is not seen.
#[test]
fn the_spindle_says_where_the_tool_points() {
    let along = |direction: &str| derived(&CHAIN_OF_SPINDLE.replace("SPINDLE", direction));
    assert_eq!(nominal(&along("+Z")), ["0", "-sin(a)", "cos(a)"]);
    let across = along("-X");
    assert_eq!(nominal(&across), ["-1", "0", "0"]);
    assert_eq!(tilts(&across, "ECS"), ["0", "-cos(a)", "-sin(a)"]);
    assert_eq!(tilts(&across, "EAS"), ["0", "0", "0"]);
}

/// A rotary axis that hangs on a spindle carries the tool itself.
#[test]
fn a_spindle_before_a_rotary_axis_says_nothing() {
    let chain = "chain: {tool: [{spindle: S, along: +X, errors: [EBS]}, {rotary: B, along: +B, errors: []}, {tool: tip, offset: [0, 0, Zt]}]}";
    assert_eq!(nominal(&derived(chain)), ["sin(b)", "0", "cos(b)"]);
}

/// Three rotary axes make factors that are sums. A bracket of them that occurs more than once has a name, and those of the tip are not told
/// with the direction.
#[test]
fn brackets_of_the_direction_stand_before_it() {
    let arm = derived("topology: FXYZCAB\n");
    let lines = errors(&arm);
    let named: Vec<&str> = lines.iter().filter(|line| line.starts_with('L')).map(|line| &line[..2]).collect();
    assert!(!named.is_empty() && lines.len() == named.len() + 3, "{lines:#?}");
    assert!(!lines.iter().any(|line| line.contains("Xt") || line.contains("x")), "{lines:#?}");
    let plain = compile_word("FXYZCAB", &mut Diagnostics::new()).unwrap().equations;
    assert_eq!(error_lines(&arm, Names::Iso), error_lines(&plain, Names::Iso));
}

/// On a lathe the spindle turns the part: the tool is along +Z.
#[test]
fn a_spindle_under_the_part_is_not_that_of_the_tool() {
    let chain = "chain: {workpiece: [{spindle: C1, along: +X, errors: [EBC1]}], tool: [{slide: X, along: +X, errors: [EBX]}, {tool: tip, offset: [0, 0, Zt]}]}";
    let lathe = derived(chain);
    assert_eq!(nominal(&lathe), ["0", "0", "1"]);
    assert_eq!(tilts(&lathe, "EBC1"), ["-1", "0", "0"]);
}

const TIP_IN_THE_FRAME: &str =
    "chain: {tool: [{slide: X, along: +X, errors: [EXX, EAX, EBX, ECX]}, {tool: tip, offset: [0, 0, 0]}]}";

/// A rotation about the tip itself has no lever there. It is seen where it turns the tool, and only where the file asks.
#[test]
fn what_only_turns_the_tool_is_seen() {
    let asked = derived(TIP_IN_THE_FRAME);
    assert_eq!(names(&asked.motions), ["EXX", "EAX", "EBX"]);
    assert_eq!(names(&asked.unseen), ["ECX"]);
    assert!(asked.rows.iter().flat_map(|row| &row.terms).all(|term| term.motion == 0));
    let text = format!("abbe: 1\nname: machine\n{TIP_IN_THE_FRAME}");
    let plain = compile(&SourceFile::new("machine.yaml", text), &mut Diagnostics::new()).unwrap().equations;
    assert_eq!(names(&plain.motions), ["EXX"]);
    assert!(plain.orientation.is_empty());
}

/// A lathe derives X and Z; its tool leans in X by what turns about Y, whatever is sensitive.
#[test]
fn all_three_are_derived_whichever_directions_are_sensitive() {
    let lathe = derived("sensitive: [X]\ntopology: ZFX\n");
    assert_eq!(lathe.rows.len(), 1);
    assert_eq!(errors(&lathe), ["dI = EBX - EBZ", "dJ = -EAX + EAZ", "dK = 0"]);
}

/// A symbol that is counted against the ISO sense is printed with the opposite factor.
#[test]
fn symbols_against_the_iso_sense() {
    let chain = "chain: {tool: [{slide: X, along: +X, errors: {EBX: {symbol: p, sign: -1}}}, {tool: tip, offset: [0, 0, Zt]}]}";
    let stage = derived(chain);
    assert_eq!(direction_error_lines(&stage, Names::Symbols), ["dI = -p", "dJ = 0", "dK = 0"]);
    assert_eq!(errors(&stage), ["dI = EBX", "dJ = 0", "dK = 0"]);
}

/// Nothing of the tip changes where the direction is asked for, but for motions that come to be seen.
#[test]
fn the_tip_is_as_it_was() {
    for word in ["XYFZ", "CFXYZB", "CAFXYZ", "FXYZBA"] {
        let plain = compile_word(word, &mut Diagnostics::new()).unwrap().equations;
        let asked = derived(&format!("topology: {word}\n"));
        assert_eq!(plain.motions.len() + plain.unseen.len(), asked.motions.len() + asked.unseen.len());
        for (row, other) in plain.rows.iter().zip(&asked.rows) {
            assert_eq!(row.nominal, other.nominal);
            assert_eq!(row.terms.len(), other.terms.len());
        }
        for (number, motion) in plain.motions.iter().enumerate() {
            let same = asked.motions.iter().position(|other| other.name == motion.name).unwrap();
            for direction in Axis::ALL {
                assert_eq!(
                    plain.arm(direction, number),
                    asked.arm(direction, same),
                    "{word} {}",
                    motion.name
                );
            }
        }
    }
}

/// The error is what the turns do to the direction, `W x T`, as numbers at an angle of 0.7 rad and all the others.
#[test]
fn the_error_is_the_turn_across_the_direction() {
    let machine = derived("topology: CAFXYZB\n");
    let interpreter = Interpreter::new(&machine, &vec![10.0; machine.constants.len()]);
    let position: Vec<f64> = (0..machine.axes.len()).map(|axis| 0.7 + axis as f64).collect();
    let direction = interpreter.direction(&position).unwrap();
    let mut tilted = 0;
    for (number, turn) in interpreter.turns(&position, &[]).into_iter().enumerate() {
        let mut motions = vec![0.0; machine.motions.len()];
        motions[number] = 1.0;
        let found = interpreter.direction_error(&position, &[], &motions).unwrap();
        for part in 0..3 {
            let (next, last) = ((part + 1) % 3, (part + 2) % 3);
            let cross = turn[next] * direction[last] - turn[last] * direction[next];
            assert!((found[part] - cross).abs() < 1e-14, "{}: {found:?}", machine.motions[number].name);
        }
        tilted += usize::from(found.iter().any(|part| part.abs() > 0.01));
    }
    assert!(tilted > 15, "{tilted} motions tilt the tool");
}

#[test]
fn an_interpreter_has_none_where_none_is_asked_for() {
    let plain = compile_word("CFXYZB", &mut Diagnostics::new()).unwrap().equations;
    let interpreter = Interpreter::new(&plain, &vec![0.0; plain.constants.len()]);
    assert_eq!(interpreter.direction(&[0.0; 5]), None);
    assert_eq!(interpreter.direction_error(&[0.0; 5], &[], &vec![0.0; plain.motions.len()]), None);
    let asked = derived("topology: CFXYZB\n");
    let interpreter = Interpreter::new(&asked, &vec![0.0; asked.constants.len()]);
    let short = interpreter.direction_error(&[0.0; 4], &[], &vec![0.0; asked.motions.len()]).unwrap();
    assert!(short.iter().all(|part| part.is_nan()), "{short:?}");
}

/// What is printed is read back: every format is made from the same rows, and the text is an equation file.
#[test]
fn what_is_printed_can_be_checked() {
    let compiled = file("topology: CFXYZB\n");
    let text = text::page(&Sheet::new(&compiled.equations, Names::Symbols));
    let (_, after) = text.split_once("\n\n").unwrap();
    let (printed, _) = after.split_once("\nError motions\n").unwrap();
    let checked = |text: &str| {
        let file = SourceFile::new("printed.eqs", text);
        let mut diagnostics = Diagnostics::new();
        let report = check::check(&compiled.machine, &compiled.equations, &file, &mut diagnostics);
        report.ok_or_else(|| diagnostics.iter().map(|one| one.code).collect::<Vec<_>>())
    };
    let report = checked(printed).unwrap();
    assert!(report.agrees(), "{}", report.text());
    assert_eq!(report.equations.len(), 12);
    let turned = checked(&printed.replace("dI = ", "dI = 2*EBB + ")).unwrap();
    let told: Vec<String> = turned.equations.iter().flat_map(|one| one.contradictions()).collect();
    assert!(
        told.len() == 1 && told[0].contains("dI, line") && told[0].contains("other lever: EBB"),
        "{told:?}"
    );
    let nominal = checked("K = sin(b) + dK\n").unwrap();
    assert!(!nominal.agrees() && nominal.unchecked.is_empty(), "{}", nominal.text());
    // The error of another part is no error of this one.
    assert_eq!(checked("K = cos(b) + dI\n").unwrap_err(), ["E0504"]);
}

#[test]
fn equations_of_a_direction_need_a_machine_that_derives_it() {
    let compiled = compile_word("CFXYZB", &mut Diagnostics::new()).unwrap();
    let file = SourceFile::new("printed.eqs", "dJ = EAX\n");
    let mut diagnostics = Diagnostics::new();
    assert!(check::check(&compiled.machine, &compiled.equations, &file, &mut diagnostics).is_none());
    let found: Vec<_> = diagnostics.iter().map(|one| (one.code, one.span.start, one.span.end)).collect();
    assert_eq!(found, [("E0505", 0, 2)]);
}

#[test]
fn names_of_the_direction_are_taken() {
    let chain = |name: &str| {
        format!("chain: {{tool: [{{slide: X, along: +X}}, {{tool: tip, offset: [{name}, 0, Zt]}}]}}")
    };
    for name in ["I", "J", "K", "dI", "dJ", "dK"] {
        let source = source(&chain(name));
        let mut diagnostics = Diagnostics::new();
        assert!(compile(&source, &mut diagnostics).is_none(), "{name}");
        let found: Vec<_> = diagnostics
            .iter()
            .map(|one| (one.code, source.text()[one.span.start..one.span.end].to_owned()))
            .collect();
        assert_eq!(found, [("E0135", name.to_owned())]);
        let plain = SourceFile::new("machine.yaml", source.text().replace("orientation: true\n", ""));
        assert!(compile(&plain, &mut Diagnostics::new()).is_some(), "{name} means nothing else there");
    }
}

#[test]
fn the_key_is_true_or_false() {
    for (word, code) in [("yes", "E0104"), ("[true]", "E0103")] {
        let text = format!("abbe: 1\nname: machine\norientation: {word}\ntopology: FX\n");
        let source = SourceFile::new("machine.yaml", text.as_str());
        let mut diagnostics = Diagnostics::new();
        assert!(compile(&source, &mut diagnostics).is_none());
        let found: Vec<_> =
            diagnostics.iter().map(|one| (one.code, &text[one.span.start..one.span.end])).collect();
        assert_eq!(found, [(code, word)]);
    }
    let text = "abbe: 1\nname: machine\norientation: false\ntopology: FB\n";
    let equations =
        compile(&SourceFile::new("machine.yaml", text), &mut Diagnostics::new()).unwrap().equations;
    assert!(equations.orientation.is_empty());
}

/// The format that programs read says the same as the text.
#[test]
fn programs_read_it_too() {
    let head = derived("topology: FB\n");
    let object = json::object(&head);
    let (_, orientation) = object.split_once("\"orientation\": [").unwrap();
    assert!(orientation.contains("\"direction\": \"I\",\n    \"nominal\": \"sin(b)\""), "{object}");
    assert!(
        orientation.contains("{\"motion\": \"EBB\", \"symbol\": \"EBB\", \"arm\": \"-sin(b)\"}"),
        "{object}"
    );
    assert!(!error_lines(&head, Names::Iso).iter().any(|line| line.starts_with("dI")));
    let plain = compile_word("FB", &mut Diagnostics::new()).unwrap().equations;
    for printed in [text::page(&Sheet::new(&plain, Names::Symbols)), json::object(&plain)] {
        let told = ["dI", "orientation", "direction_error"];
        assert!(!told.iter().any(|word| printed.contains(word)), "{printed}");
    }
    assert!(plain.orientation_row(Axis::X).is_none() && plain.tilt(Axis::X, 0) == Polynomial::zero());
}
