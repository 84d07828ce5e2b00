//! Generated code of random machines and their calibrations. In: machines and numbers drawn with a fixed seed, compiled
//! together by one call of the Rust compiler. Out: what their code gives, held to the last bit against the interpreter and
//! against terms that are read at run time, and against dual numbers, which share nothing with either.

mod calibrations;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use abbe_runtime::Kinematics;
use model_dsl::equations::Equations;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

use self::calibrations::Followed;
use crate::agreement::{Case, asking, compiled, levers_are_dual_numbers};
use crate::oracle::Machine;
use crate::random::{machines, of_word, state};
use crate::shipped::{axis, root, tip, with};
use crate::yaml;

/// Enough for every feature of the file to meet every other one; each takes the compiler a third of a second.
const MACHINES: usize = 48;

/// Points for each machine.
const POINTS: u64 = 3;

/// A machine with its equations, as drawn.
struct Drawn {
    machine: Machine,
    text: String,
    equations: Equations,
    /// Numbers of a specimen, and the cycles in which they are asked for.
    followed: Followed,
}

/// The same random machines on every run, and one that is described by hand.
fn drawn() -> Vec<Drawn> {
    let mut runner = TestRunner::deterministic();
    let draw = |number: usize| {
        let machine = if number < MACHINES {
            machines().new_tree(&mut runner).unwrap().current()
        } else {
            turned_further()
        };
        // Some name the direction of their tool, which is a constant then.
        let machine = Machine { pointing: number % 6 == 3, ..machine };
        let text = yaml::text(&machine, number.is_multiple_of(2));
        // Every third derives the direction of its tool.
        let text = if number.is_multiple_of(3) { asking(&text) } else { text };
        let equations = compiled(&text);
        // Terms take the compiler longer than equations: one calibration in four has some.
        let most = if number.is_multiple_of(4) { 3 } else { 0 };
        let mut followed = Followed::draw(&machine, &equations, most, runner.rng());
        if number == MACHINES {
            followed = followed.with_long_tables(runner.rng());
        }
        Drawn { machine, text, equations, followed }
    };
    (0..=MACHINES).map(draw).collect()
}

/// Its error turns with A alone, and the direction of Y with C as well, which has no error motions as Y has none. There are no
/// offsets in it. Its tables are as long as a file can tell.
fn turned_further() -> Machine {
    let here = ["0", "0", "0"];
    Machine {
        workpiece: vec![with(axis('X', "-X", here), &[("EXX", "EXX")])],
        tool: vec![
            with(axis('A', "+A", here), &[]),
            with(axis('Z', "+Z", here), &[("EYZ", "EYZ")]),
            with(axis('C', "+C", here), &[]),
            with(axis('Y', "+Y", here), &[]),
            tip("tip", here),
        ],
        ..of_word("FX")
    }
}

/// A list of numbers that the compiler reads back to the last bit.
fn list(numbers: &[f64]) -> String {
    format!("&{numbers:?}")
}

/// One line of numbers for each machine and point: error, directions, nominal, the direction of the tool and its error where these are
/// derived, lever arms, as bits. Then one for each cycle of its calibration.
fn program(machines: &[Drawn]) -> String {
    let mut text = String::from(
        "//! Machines.\nuse abbe_runtime::Kinematics;\n\
         fn say<const N: usize>(machine: &dyn Kinematics, position: &[f64], travel: &[f64], motions: &[f64], nominal: [f64; 3], tool: &[[f64; 3]], levers: [[f64; 3]; N]) {\n\
             let mut directions = vec![[0.0; 3]; position.len()];\n\
             machine.directions(position, &mut directions);\n\
             let error = machine.error(position, travel, motions);\n\
             let (mut sines, mut turned) = (abbe_runtime::Sines::default(), directions.clone());\n\
             machine.turn(position, &mut sines);\n\
             machine.directions_with(&sines, position, &mut turned);\n\
             assert!(turned == directions && machine.error_with(&sines, position, travel, motions) == error);\n\
             let all = error.iter().chain(directions.iter().flatten()).chain(&nominal).chain(tool.iter().flatten()).chain(levers.iter().flatten());\n\
             println!(\"{}\", all.map(|number| number.to_bits().to_string()).collect::<Vec<_>>().join(\" \"));\n\
         }\n",
    );
    for number in 0..machines.len() {
        let _ = writeln!(text, "mod m{number};");
    }
    text.push_str(calibrations::FOLLOW);
    text.push_str("fn main() {\n");
    for (number, drawn) in machines.iter().enumerate() {
        for seed in 0..POINTS {
            let case = Case::new(&drawn.machine, &drawn.equations, state(&drawn.machine, seed));
            let equations = &drawn.equations;
            let constants = equations.constants.iter().map(|constant| case.state.constants[&*constant.name]);
            let constants = constants.collect::<Vec<_>>();
            let travels = if equations.travels.is_empty() {
                String::new()
            } else {
                format!("&m{number}::Travels::from_array(*{}), ", list(&case.travel))
            };
            let tool = if equations.orientation.is_empty() {
                "&[]".to_owned()
            } else {
                format!("&[machine.direction(&axes), machine.direction_error(&axes, {travels}&motions)]")
            };
            let _ = writeln!(
                text,
                "    {{ let machine = m{number}::Machine {{ constants: m{number}::Constants::from_array(*{}) }};\n\
                 let axes = m{number}::Axes::from_array(*{});\n\
                 let motions = m{number}::Motions::from_array(*{});\n\
                 say(&machine, {}, {}, {}, machine.nominal(&axes), {tool}, machine.levers(&axes, {travels})); }}",
                list(&constants),
                list(&case.position),
                list(&case.errors(seed)),
                list(&case.position),
                list(&case.travel),
                list(&case.errors(seed)),
            );
        }
        text.push_str(&drawn.followed.program(number));
    }
    text.push_str("}\n");
    text
}

/// Compiles all machines into one program and gives what it prints.
fn printed(machines: &[Drawn]) -> String {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("compiled");
    let _ = fs::remove_dir_all(folder.join("src"));
    fs::create_dir_all(folder.join("src")).unwrap();
    let runtime = root().join("runtime").canonicalize().unwrap();
    let manifest = format!(
        "[package]\nname = \"compiled\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\n\
         abbe-runtime = {{ path = {runtime:?}, features = [\"std\"] }}\n\n[profile.dev]\ndebug = false\n\n[workspace]\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    for (number, drawn) in machines.iter().enumerate() {
        let tokens = model_dsl::codegen::calibrated_tokens(&drawn.equations, &drawn.followed.calibration);
        let tokens = tokens.unwrap();
        let code = model_dsl::codegen::file(&tokens, "machine.yaml").unwrap();
        fs::write(folder.join(format!("src/m{number}.rs")), code).unwrap();
    }
    fs::write(folder.join("src/main.rs"), program(machines)).unwrap();
    run(&folder)
}

fn run(folder: &Path) -> String {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--offline", "--quiet"])
        .current_dir(folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        // Machines of which nobody reads all parts are no fault of the code.
        .env("RUSTFLAGS", "--allow=dead_code")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn random_machines_and_calibrations_compiled() {
    let machines = drawn();
    let printed = printed(&machines);
    let mut lines = printed.lines();
    let (mut cycles, mut compensated) = (0, 0);
    let (mut asked, mut leaning) = (0, 0);
    for Drawn { machine, text, equations, followed } in &machines {
        for seed in 0..POINTS {
            let case = Case::new(machine, equations, state(machine, seed));
            let numbers: Vec<f64> =
                lines.next().unwrap().split(' ').map(|bits| f64::from_bits(bits.parse().unwrap())).collect();
            let interpreter = &case.interpreter;
            let mut directions = vec![[0.0; 3]; case.position.len()];
            interpreter.directions(&case.position, &mut directions);
            let error = interpreter.error(&case.position, &case.travel, &case.errors(seed));
            let levers = interpreter.levers(&case.position, &case.travel);
            let nominal = interpreter.nominal(&case.position);
            let direction = interpreter.direction(&case.position);
            let error_of_it = interpreter.direction_error(&case.position, &case.travel, &case.errors(seed));
            let tool: Vec<[f64; 3]> = direction.into_iter().chain(error_of_it).collect();
            (asked, leaning) =
                (asked + tool.len(), leaning + tool.iter().filter(|own| own[0] != 0.0).count());
            let before = 6 + 3 * case.position.len() + 3 * tool.len();
            let all =
                [error].into_iter().chain(directions).chain([nominal]).chain(tool).chain(levers).flatten();
            assert_eq!(numbers, all.collect::<Vec<_>>(), "point {seed} of\n{text}");
            let levers: Vec<[f64; 3]> =
                numbers[before..].chunks(3).map(|arm| [arm[0], arm[1], arm[2]]).collect();
            levers_are_dual_numbers(&case, &levers).unwrap_or_else(|error| panic!("{error}\n{text}"));
        }
        for (cycle, expected) in followed.at_run_time(equations).iter().enumerate() {
            let calibration = &followed.calibration;
            assert_eq!(lines.next(), Some(&**expected), "cycle {cycle} of\n{text}\n{calibration:#?}");
            cycles += 1;
            compensated += usize::from(expected.starts_with(|first: char| first.is_ascii_digit()));
        }
    }
    assert_eq!(lines.next(), None);
    // A refusal says little: were most cycles refused, the lines above would hold almost nothing.
    assert!(compensated > cycles / 2, "{compensated} of {cycles} cycles were compensated");
    assert!(asked >= 90 && leaning > asked / 3, "{leaning} of {asked} directions and errors lie along X too");
}
