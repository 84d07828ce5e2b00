//! Compiles the machines to Rust with the numbers that [`case`] draws, and the same machines' C: written by hand, and by other
//! tools where they are there.
//!
//! In: `../machines/*.yaml`, `c/*.c`, `codegen.py`. Out: `$OUT_DIR/machines.rs`, the library `contestants`, and a `cfg`
//! for each tool whose code is in it. A tool that is not there gives a warning and is left out.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

#[path = "src/case.rs"]
#[expect(unreachable_pub, dead_code, reason = "a module of the library")]
mod case;
#[path = "src/chain.rs"]
#[expect(unreachable_pub, reason = "a module of the library")]
mod chain;
#[path = "src/random.rs"]
mod random;

use case::{Case, Values};
use model_dsl::calibration::{CalibratedTerm, Calibration, Curve, CurveNodes, CurveValues};
use model_dsl::equations::Equations;

/// The machines of the compensation call.
const MACHINES: [&str; 4] = ["excello-921", "xyfz-mill", "trunnion-5axis", "trunnion-5axis-turning"];
/// Those whose equations other tools write: the last has those of the one before it.
const WRITTEN: usize = 3;
/// The tools that write C for the same equations.
const TOOLS: [&str; 3] = ["sympy", "casadi", "symforce"];

fn main() -> Result<(), Box<dyn Error>> {
    let out = PathBuf::from(env::var("OUT_DIR")?);
    let mut modules = String::new();
    let mut chains = Vec::new();
    for name in MACHINES {
        println!("cargo::rerun-if-changed=../machines");
        let (equations, chain) = compiled(name)?;
        let tokens = model_dsl::codegen::calibrated_tokens(&equations, &calibration(&Case::new(name)?))?;
        let code = model_dsl::codegen::file(&tokens, name)?;
        let module = name.replace('-', "_");
        modules.push_str(&format!("/// The machine `{name}`.\npub mod {module} {{\n{code}}}\n"));
        let described = out.join(format!("{module}.json"));
        fs::write(&described, chain.json())?;
        chains.push(described);
    }
    chains.truncate(WRITTEN);
    fs::write(out.join("machines.rs"), modules)?;
    let mut build = cc::Build::new();
    build.opt_level(3).flag("-std=c11").include("c").warnings(false);
    for file in ["lathe.c", "mill.c", "trunnion.c"] {
        build.file(Path::new("c").join(file));
    }
    println!("cargo::rerun-if-changed=c");
    for tool in TOOLS {
        println!("cargo::rustc-check-cfg=cfg({tool})");
        match written(tool, &chains, &out) {
            Ok(file) => {
                build.file(file);
                println!("cargo::rustc-cfg={tool}");
            }
            Err(why) => println!("cargo::warning={tool} is left out: {why}"),
        }
    }
    build.compile("contestants");
    Ok(())
}

/// The equations of a machine file, and its chain.
fn compiled(name: &str) -> Result<(Equations, chain::Chain), Box<dyn Error>> {
    let source = model_dsl::source::SourceFile::new(name, case::machine_file(name)?);
    let mut diagnostics = model_dsl::diagnostic::Diagnostics::new();
    let compiled =
        model_dsl::compile(&source, &mut diagnostics).ok_or("the machine file does not compile")?;
    let motions: Vec<String> = compiled.equations.motions.iter().map(|motion| motion.name.clone()).collect();
    Ok((compiled.equations, chain::Chain::new(&compiled.machine, &motions)?))
}

/// The numbers of a case as a calibration.
fn calibration(case: &Case) -> Calibration {
    let term = |values: &Values| match values {
        Values::Number(value) => CalibratedTerm::Constant { value: *value },
        Values::Table(table) => {
            let nodes = CurveNodes::Uniform { start: table.start, step: table.step };
            let forward = table.forward.clone();
            let values = match table.reverse.clone() {
                Some(reverse) => CurveValues::Directed { forward, reverse },
                None => CurveValues::Both(forward),
            };
            CalibratedTerm::Table { axis: table.axis, curve: Curve::new(nodes, values) }
        }
    };
    let terms: Vec<_> = case.motions.iter().map(term).enumerate().collect();
    Calibration::new(case.name, case.constants.clone()).with(&terms)
}

/// The C file that a tool writes, with the Python of the virtual environment that `tools.sh` makes.
fn written(tool: &str, chains: &[PathBuf], out: &Path) -> Result<PathBuf, String> {
    println!("cargo::rerun-if-changed=codegen.py");
    println!("cargo::rerun-if-env-changed=ABBE_BENCH_PYTHON");
    let python = env::var("ABBE_BENCH_PYTHON").unwrap_or_else(|_| "target/venv/bin/python".to_owned());
    if !python.contains('/') || !Path::new(&python).exists() {
        return Err(format!("no {python}; run ./tools.sh, or set ABBE_BENCH_PYTHON to a path"));
    }
    println!("cargo::rerun-if-changed={python}");
    let file = out.join(format!("{tool}.c"));
    let made = Command::new(python).args(["codegen.py", tool]).arg(&file).args(chains).output();
    let made = made.map_err(|error| error.to_string())?;
    if made.status.success() {
        return Ok(file);
    }
    let said = String::from_utf8_lossy(&made.stderr);
    Err(said.lines().last().unwrap_or("it failed").to_owned())
}
