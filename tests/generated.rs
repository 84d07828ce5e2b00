//! Generated code against the interpreter, and the doors through which it comes.
//!
//! In: the crate of compiled machines, the macro, and files generated afresh. Out: equal numbers, equal tokens, equal bytes,
//! and code that the strictest compiler accepts.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use abbe_runtime::Kinematics;
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;
use proc_macro2::TokenStream;

use crate::agreement::{asking, compiled};
use crate::oracle::draw;
use crate::shipped::{SHIPPED, root, shipped};

/// What is asked of a machine at a point, however it was compiled.
#[derive(Debug, PartialEq)]
struct Answers {
    nominal: [f64; 3],
    error: [f64; 3],
    levers: Vec<[f64; 3]>,
    directions: Vec<[f64; 3]>,
    squares: Option<[f64; 3]>,
}

/// Numbers for every input of a machine.
struct Point {
    constants: Vec<f64>,
    position: Vec<f64>,
    travel: Vec<f64>,
    motions: Vec<f64>,
}

/// An array of the length that the place asks for.
fn array<const N: usize>(values: &[f64]) -> [f64; N] {
    values.try_into().expect("as many numbers as the record has fields")
}

/// The answers of a compiled module; the second form is for machines with free travels.
macro_rules! answers {
    ($module:path, $point:expr) => {{
        use $module as machine;
        let point: &Point = $point;
        let compiled =
            machine::Machine { constants: machine::Constants::from_array(array(&point.constants)) };
        let axes = machine::Axes::from_array(array(&point.position));
        let motions = machine::Motions::from_array(array(&point.motions));
        let answers = Answers {
            nominal: compiled.nominal(&axes),
            error: compiled.error(&axes, &motions),
            levers: compiled.levers(&axes).to_vec(),
            directions: compiled.directions(&axes).to_vec(),
            squares: compiled.squares(),
        };
        through_the_interface(&compiled, point, &answers);
        answers
    }};
    ($module:path, travels, $point:expr) => {{
        use $module as machine;
        let point: &Point = $point;
        let compiled =
            machine::Machine { constants: machine::Constants::from_array(array(&point.constants)) };
        let axes = machine::Axes::from_array(array(&point.position));
        let travels = machine::Travels::from_array(array(&point.travel));
        let motions = machine::Motions::from_array(array(&point.motions));
        let answers = Answers {
            nominal: compiled.nominal(&axes),
            error: compiled.error(&axes, &travels, &motions),
            levers: compiled.levers(&axes, &travels).to_vec(),
            directions: compiled.directions(&axes).to_vec(),
            squares: compiled.squares(),
        };
        through_the_interface(&compiled, point, &answers);
        answers
    }};
}

/// The runtime's interface gives the same, and NaN for slices of a wrong length.
fn through_the_interface(machine: &impl Kinematics, point: &Point, answers: &Answers) {
    assert_eq!(machine.axes(), point.position.len());
    assert_eq!(machine.travels().len(), point.travel.len());
    assert_eq!(machine.motions(), point.motions.len());
    assert_eq!(machine.error(&point.position, &point.travel, &point.motions), answers.error);
    let mut directions = vec![[0.0; 3]; point.position.len()];
    machine.directions(&point.position, &mut directions);
    assert_eq!(directions, answers.directions);
    vary_as_told(machine, point, &answers.directions);
    match machine.fixed_directions() {
        Some(fixed) => assert_eq!(fixed, answers.directions),
        None => {
            let leans = "no shipped machine has a slide that leans by a number of its own";
            assert!(machine.directions_vary(), "{leans}");
            let resting: Vec<bool> =
                answers.directions.iter().map(|direction| *direction == [0.0; 3]).collect();
            assert_eq!(machine.resting(), resting);
        }
    }
    let short = &point.position[1..];
    assert!(machine.error(short, &point.travel, &point.motions).iter().all(|part| part.is_nan()));
    assert!(machine.error(&point.position, &[1.0; 9], &point.motions).iter().all(|part| part.is_nan()));
    assert!(
        machine.error(&point.position, &point.travel, &point.motions[1..]).iter().all(|part| part.is_nan())
    );
    machine.directions(short, &mut directions);
    assert!(directions.iter().flatten().all(|part| part.is_nan()));
    let mut one_more = vec![[0.0; 3]; point.position.len() + 1];
    machine.directions(&point.position, &mut one_more);
    assert!(one_more.iter().flatten().all(|part| part.is_nan()));
}

/// Directions differ between this point and another where the machine says that they vary, and nowhere else.
fn vary_as_told(machine: &impl Kinematics, point: &Point, here: &[[f64; 3]]) {
    let elsewhere: Vec<f64> = point.position.iter().map(|position| 0.3 * position + 1.0).collect();
    let mut directions = vec![[0.0; 3]; elsewhere.len()];
    machine.directions(&elsewhere, &mut directions);
    assert_eq!(directions != here, machine.directions_vary());
}

fn generated(name: &str, point: &Point) -> Answers {
    match name {
        "excello-921" => answers!(abbe_generated::excello_921, point),
        "fxyz-mill" => answers!(abbe_generated::fxyz_mill, point),
        "head-table-5axis" => answers!(abbe_generated::head_table_5axis, point),
        "nist-turning-center" => answers!(abbe_generated::nist_turning_center, travels, point),
        "nutating-head-5axis" => answers!(abbe_generated::nutating_head_5axis, point),
        "postech-mill" => answers!(abbe_generated::postech_mill, point),
        "trunnion-5axis" => answers!(abbe_generated::trunnion_5axis, point),
        "xfyz-mill" => answers!(abbe_generated::xfyz_mill, point),
        "xyfz-mill" => answers!(abbe_generated::xyfz_mill, point),
        "cai-wafer-grinder" => answers!(abbe_generated::cai_wafer_grinder, point),
        "linuxcnc-xyzac-trt" => answers!(abbe_generated::linuxcnc_xyzac_trt, point),
        "linuxcnc-xyzbc-trt" => answers!(abbe_generated::linuxcnc_xyzbc_trt, point),
        "msl-moving-bridge" => answers!(abbe_generated::msl_moving_bridge, point),
        "msl-moving-table" => answers!(abbe_generated::msl_moving_table, point),
        "printer-skew" => answers!(abbe_generated::printer_skew, point),
        "xyzf-mill" => answers!(abbe_generated::xyzf_mill, point),
        _ => panic!("{name} is shipped and not tested here"),
    }
}

fn point(equations: &model_dsl::equations::Equations, seed: u64) -> Point {
    let drawn = |range: f64, name: &str| range * draw(seed, name);
    Point {
        constants: equations.constants.iter().map(|constant| drawn(300.0, &constant.name)).collect(),
        position: equations
            .axes
            .iter()
            .map(|axis| drawn(if axis.rotary { 3.0 } else { 500.0 }, &axis.variable))
            .collect(),
        travel: equations.travels.iter().map(|travel| drawn(500.0, &travel.name)).collect(),
        motions: equations
            .motions
            .iter()
            .map(|motion| drawn(if motion.angular { 1e-4 } else { 0.05 }, &motion.name))
            .collect(),
    }
}

/// A machine that is asked with a slice of a wrong length answers NaN.
fn refuses_wrong_lengths(machine: &impl Kinematics, Point { position, travel, motions, .. }: &Point) {
    let refused = |position: &[f64], travel: &[f64], motions: &[f64]| {
        assert!(machine.error(position, travel, motions).iter().all(|part| part.is_nan()));
    };
    refused(&position[1..], travel, motions);
    refused(position, &[0.0; 9], motions);
    refused(position, travel, &motions[1..]);
}

/// The same of the code of a shipped machine.
fn generated_refuses_wrong_lengths(name: &str, point: &Point) {
    macro_rules! machine {
        ($module:ident) => {{
            let constants = abbe_generated::$module::Constants::from_array(array(&point.constants));
            refuses_wrong_lengths(&abbe_generated::$module::Machine { constants }, point)
        }};
    }
    match name {
        "excello-921" => machine!(excello_921),
        "fxyz-mill" => machine!(fxyz_mill),
        "head-table-5axis" => machine!(head_table_5axis),
        "nist-turning-center" => machine!(nist_turning_center),
        "nutating-head-5axis" => machine!(nutating_head_5axis),
        "postech-mill" => machine!(postech_mill),
        "trunnion-5axis" => machine!(trunnion_5axis),
        "xfyz-mill" => machine!(xfyz_mill),
        "xyfz-mill" => machine!(xyfz_mill),
        "cai-wafer-grinder" => machine!(cai_wafer_grinder),
        "linuxcnc-xyzac-trt" => machine!(linuxcnc_xyzac_trt),
        "linuxcnc-xyzbc-trt" => machine!(linuxcnc_xyzbc_trt),
        "msl-moving-bridge" => machine!(msl_moving_bridge),
        "msl-moving-table" => machine!(msl_moving_table),
        "printer-skew" => machine!(printer_skew),
        "xyzf-mill" => machine!(xyzf_mill),
        _ => panic!("{name} is shipped and not tested here"),
    }
}

/// Every shipped machine, and the interpreter of its equations.
#[test]
fn slices_of_a_wrong_length_give_nan() {
    for shipped in SHIPPED {
        let equations = compiled(&shipped.text());
        let point = point(&equations, 1);
        generated_refuses_wrong_lengths(shipped.name, &point);
        refuses_wrong_lengths(&Interpreter::new(&equations, &point.constants), &point);
    }
}

/// Interpreter and generated code run one program.
#[test]
fn generated_code_is_the_interpreter() {
    for shipped in SHIPPED {
        let equations = compiled(&shipped.text());
        for seed in 0..25 {
            let point = point(&equations, seed);
            let interpreter = Interpreter::new(&equations, &point.constants);
            let mut directions = vec![[0.0; 3]; equations.axes.len()];
            interpreter.directions(&point.position, &mut directions);
            vary_as_told(&interpreter, &point, &directions);
            let interpreted = Answers {
                nominal: interpreter.nominal(&point.position),
                error: interpreter.error(&point.position, &point.travel, &point.motions),
                levers: interpreter.levers(&point.position, &point.travel),
                directions,
                squares: interpreter.squares(),
            };
            assert_eq!(generated(shipped.name, &point), interpreted, "{} at point {seed}", shipped.name);
        }
    }
}

/// The names of the records are those of the equations, in their order.
#[test]
fn records_keep_the_order_of_the_equations() {
    use abbe_generated::nist_turning_center::{Axes, Constants, Machine, Motions, Travels};
    let equations = compiled(&shipped("nist-turning-center").text());
    assert_eq!(Machine::NAME, equations.machine);
    assert_eq!(
        Axes::NAMES.to_vec(),
        equations.axes.iter().map(|axis| axis.variable.to_string()).collect::<Vec<_>>()
    );
    assert_eq!(
        Constants::NAMES.to_vec(),
        equations.constants.iter().map(|constant| constant.name.to_string()).collect::<Vec<_>>()
    );
    assert_eq!(
        Travels::NAMES.to_vec(),
        equations.travels.iter().map(|travel| travel.name.to_string()).collect::<Vec<_>>()
    );
    assert_eq!(
        Motions::NAMES.to_vec(),
        equations.motions.iter().map(|motion| motion.name.clone()).collect::<Vec<_>>()
    );
    let numbers: [f64; 8] = std::array::from_fn(|number| number as f64);
    assert_eq!(Constants::from_array(numbers).to_array(), numbers);
}

fn tokens(path: &Path) -> TokenStream {
    let source = SourceFile::new(path.display().to_string(), fs::read_to_string(path).unwrap());
    let (tokens, _, warnings) = model_dsl::rust_tokens(&source).unwrap_or_else(|told| panic!("{told}"));
    assert_eq!(warnings, "", "{}", path.display());
    tokens
}

fn machine_file(name: &str) -> PathBuf {
    root().join("machines").join(format!("{name}.yaml"))
}

/// One module by the macro; the generated crate holds the same machine by way of its build script.
mod by_macro {
    pub(crate) mod lathe {
        abbe_macros::machine!("machines/excello-921.yaml");
    }
    pub(crate) mod trunnion {
        abbe_macros::machine!("machines/trunnion-5axis.yaml");
    }
}

#[test]
fn the_macro_gives_the_same_numbers() {
    for seed in 0..10 {
        let lathe = point(&compiled(&shipped("excello-921").text()), seed);
        assert_eq!(answers!(crate::generated::by_macro::lathe, &lathe), generated("excello-921", &lathe));
        let trunnion = point(&compiled(&shipped("trunnion-5axis").text()), seed);
        assert_eq!(
            answers!(crate::generated::by_macro::trunnion, &trunnion),
            generated("trunnion-5axis", &trunnion)
        );
    }
}

/// What a build script writes is, token by token, what the macro inserts.
#[test]
fn all_doors_give_the_same_tokens() {
    for shipped in SHIPPED {
        let path = machine_file(shipped.name);
        let file = model_dsl::rust_for(&path).unwrap();
        let parsed: TokenStream = file.parse().unwrap();
        // Formatting adds and drops trailing commas and writes comments for #[doc]; parsed and printed again both are alike.
        let again = |tokens: TokenStream| prettyplease_of(&tokens);
        assert_eq!(again(parsed), again(tokens(&path)), "{}", shipped.name);
    }
}

fn prettyplease_of(tokens: &TokenStream) -> String {
    model_dsl::codegen::file(tokens, "here").unwrap()
}

#[test]
fn code_is_the_same_on_every_run() {
    for shipped in SHIPPED {
        let path = machine_file(shipped.name);
        assert_eq!(tokens(&path).to_string(), tokens(&path).to_string(), "{}", shipped.name);
        assert_eq!(
            model_dsl::rust_for(&path).unwrap(),
            model_dsl::rust_for(&path).unwrap(),
            "{}",
            shipped.name
        );
    }
}

/// Machines whose names and shapes are hard on generated code.
const HARD: [(&str, &str); 10] = [
    (
        "keywords",
        "{slide: X, along: +X, origin: [self, as, fn]}, {fixed: Self, origin: [type, match, crate]}, {tool: super, offset: [0, gen, async]}",
    ),
    (
        "locals",
        "{slide: X, along: +X, origin: [S1, s0, cos_c]}, {rotary: C, along: +C, origin: [sin_c, s2, s3]}, {tool: tip, offset: [axes, motions, travels]}",
    ),
    (
        "arguments",
        "{slide: X, along: +X, origin: [position, travel, directions]}, {slide: Y, along: +Y, origin: [abbe_runtime, f32, real]}, {slide: Z, along: +Z, origin: [filled, constants, names]}, {tool: tip, offset: [f64, machine, from_array]}",
    ),
    ("no-errors", "{slide: X, along: +X, errors: []}, {tool: tip}"),
    ("no-constants", "{slide: X, along: +X}, {slide: Y, along: -Y}, {tool: tip, offset: [1.5, -2, 0.001]}"),
    (
        "travels",
        "{slide: X, along: +X, errors: {EB0X: {symbol: ao, sign: -1, travel: dx}, EC0X: {travel: dx, rotates: true}}}, {slide: Z, along: +Z, errors: {EB0Z: {travel: dz}}}, {tool: tip, offset: [Xt, 0, Zt]}",
    ),
    ("rotary-alone", "{rotary: C, along: +C}, {tool: tip, offset: [R, 0, 0]}"),
    (
        "small-letters",
        "{slide: X, id: x1, along: +X}, {rotary: C, id: c2, along: +C}, {tool: tip, offset: [0, 0, l_1]}",
    ),
    (
        "leaning",
        "{slide: X, along: +X}, {rotary: B, along: [0, 1, 1]}, {fixed: head, turned: {A: 20 deg}}, {slide: Z, along: +Z}, {tool: tip, offset: [Xt, 0, Zt]}",
    ),
    (
        "everything",
        "{slide: X, along: +X}, {slide: Y, along: +Y}, {slide: Z, along: +Z}, {slide: U, along: -U}, {rotary: A, along: -A}, {rotary: C, along: +C}, {spindle: S, along: +Z}, {tool: tip, offset: [Xt, Yt, Zt]}",
    ),
];

fn hard(name: &str, links: &str) -> String {
    format!(
        "abbe: 1\nname: {name}\ntitle: \"Brackets [a], `ticks`, */ and <b>,\\nlines, \\\"quotes\\\", \\\\ and {{x}}\"\nchain: {{tool: [{links}]}}\n"
    )
}

/// A crate of freshly generated files, compiled with warnings and missing documentation denied.
#[test]
fn fresh_code_passes_the_strictest_compiler() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("fresh");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("src")).unwrap();
    let runtime = root().join("runtime").canonicalize().unwrap();
    let manifest = format!(
        "[package]\nname = \"fresh\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\nabbe-runtime = {{ path = {runtime:?}, features = [\"single\"] }}\n\n[workspace]\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest).unwrap();
    let mut library = String::from(
        "//! Freshly generated machines.\n#![no_std]\n#![forbid(unsafe_code)]\n#![deny(warnings, missing_docs)]\n",
    );
    let mut module = |name: &str, code: &str| {
        let name = name.replace('-', "_");
        library.push_str(&format!("\n/// A machine.\npub mod {name};\n"));
        fs::write(folder.join("src").join(format!("{name}.rs")), code).unwrap();
    };
    for shipped in SHIPPED {
        module(shipped.name, &model_dsl::rust_for(machine_file(shipped.name)).unwrap());
        let single = model_dsl::single::rust_for(machine_file(shipped.name)).unwrap();
        assert!(!single.contains("f64"), "{}", shipped.name);
        module(&format!("single-{}", shipped.name), &single);
    }
    for name in ["excello-921", "nist-turning-center", "postech-mill"] {
        let numbers = root().join("calibrations").join(name).with_extension("yaml");
        let code = model_dsl::calibrated_rust_for(machine_file(name), numbers).unwrap();
        module(&format!("calibrated-{name}"), &code);
        let numbers = root().join("calibrations").join(name).with_extension("yaml");
        let code = model_dsl::single::calibrated_rust_for(machine_file(name), numbers).unwrap();
        module(&format!("single-calibrated-{name}"), &code);
    }
    // Numbers for each motion of a machine whose ids are in lower case, tables among them: they become constants.
    let numbers = "calibration: 1\nmachine: small.yaml\nconstants: {l_1: 5 mm}\nerrors:\n  EXx1: 3 um\n  EBx1: [{table: {start: 0 mm, step: 10 mm, unit: urad, values: [0, 1, 2]}}]\n  ECx1: [{table: {start: 0 mm, step: 10 mm, unit: urad, values: [0, 2, 1]}}]\n  EXc2: 2 um\n";
    let small = HARD.iter().find(|(name, _)| *name == "small-letters").unwrap().1;
    fs::write(folder.join("small.yaml"), hard("small", small)).unwrap();
    fs::write(folder.join("numbers.yaml"), numbers).unwrap();
    let code = model_dsl::calibrated_rust_for(folder.join("small.yaml"), folder.join("numbers.yaml"));
    module("calibrated-small", &code.unwrap());
    let plain = HARD.map(|(name, links)| (name.to_owned(), hard(name, links)));
    let pointing = plain.clone().map(|(name, text)| (format!("pointing-{name}"), asking(&text)));
    for (name, text) in plain.into_iter().chain(pointing) {
        let source = SourceFile::new(format!("{name}.yaml"), text);
        let (tokens, _, _) = model_dsl::rust_tokens(&source).unwrap_or_else(|told| panic!("{told}"));
        module(&name, &model_dsl::codegen::file(&tokens, &name).unwrap());
        let single = model_dsl::codegen::single(tokens).unwrap();
        module(&format!("single-{name}"), &model_dsl::codegen::file(&single, &name).unwrap());
    }
    fs::write(folder.join("src/lib.rs"), library).unwrap();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["check", "--offline", "--quiet"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env_remove("RUSTFLAGS")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// The hard machines give the interpreter's numbers as well: a name that shadows another would show here.
#[test]
fn hard_names_do_not_shadow_each_other() {
    use hard_machines as hard;
    for seed in 0..10 {
        for (number, (name, links)) in HARD.iter().enumerate().take(3) {
            let equations = compiled(&self::hard(name, links));
            let point = point(&equations, seed);
            let interpreter = Interpreter::new(&equations, &point.constants);
            let expected = (
                interpreter.nominal(&point.position),
                interpreter.error(&point.position, &[], &point.motions),
            );
            let found = match number {
                0 => answers!(hard::keywords, &point),
                1 => answers!(hard::locals, &point),
                _ => answers!(hard::arguments, &point),
            };
            assert_eq!((found.nominal, found.error), expected, "{name}");
        }
    }
}

/// The offsets by default are those of the machine file, where it has any.
#[test]
fn constants_have_the_values_of_the_machine_file() {
    mod valued {
        abbe_macros::machine!("tests/fixtures/valued.yaml");
    }
    let machine = valued::Machine::default();
    assert_eq!(machine.constants.to_array(), [0.0, 120.5]);
    assert_eq!(machine.nominal(&valued::Axes { x: 1.0 }), [1.0, 0.0, 120.5]);
}

/// The machines of [`HARD`] as the macro compiles them, from the files beside this one.
mod hard_machines {
    pub(crate) mod keywords {
        abbe_macros::machine!("tests/fixtures/keywords.yaml");
    }
    pub(crate) mod locals {
        abbe_macros::machine!("tests/fixtures/locals.yaml");
    }
    pub(crate) mod arguments {
        abbe_macros::machine!("tests/fixtures/arguments.yaml");
    }
}
