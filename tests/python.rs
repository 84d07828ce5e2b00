//! Equations for Python, run by Python. In: the shipped machines, which derive the direction of their tools too, and numbers drawn at random. Out: the numbers of the interpreter.
//!
//! Where no Python is installed the test says so.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use abbe_runtime::Kinematics;
use model_dsl::equations::{Equations, Names};
use model_dsl::program::Interpreter;
use notation::{Format, print};
use serde_json::{Map, Value};

use crate::agreement::{asking, compiled};
use crate::oracle::draw;
use crate::shipped::SHIPPED;

/// Reads numbers, asks the module for its answers, and writes them as JSON. Lever arms are taken together with the motions, as what the
/// error has to be.
const ASKED: &str = "\
import importlib, json, sys
sys.path.insert(0, sys.argv[1])
answers = {}
for name, given in json.load(open(sys.argv[1] + '/given.json')).items():
    module = importlib.import_module(name)
    values, motions = given['values'], given['motions']
    assert set(values) == set(module.VALUES) and set(motions) == set(module.MOTIONS), name
    summed = dict.fromkeys(module.nominal(values), 0.0)
    for motion, arms in module.levers(values).items():
        for direction, arm in arms.items():
            summed[direction] += arm * motions[motion]
    answers[name] = [module.nominal(values), module.error(values, motions), summed, module.error(values, {}),
                     module.direction(values), module.direction_error(values, motions)]
json.dump(answers, sys.stdout)
";

/// Positions, travels and constants of a machine by their names, and error motions by these.
fn given(equations: &Equations, names: Names) -> (Map<String, Value>, Map<String, Value>) {
    let number = |name: &str| draw(5, name) * 100.0;
    let quantities = equations
        .axes
        .iter()
        .map(|axis| axis.variable.to_string())
        .chain(equations.travels.iter().map(|travel| travel.name.to_string()))
        .chain(equations.constants.iter().map(|constant| constant.name.to_string()));
    let values = quantities.map(|name| (name.clone(), number(&name).into())).collect();
    let motions = equations.motions.iter();
    let motions =
        motions.map(|motion| (motion.printed(names).to_owned(), draw(6, &motion.name).into())).collect();
    (values, motions)
}

#[test]
fn python_says_what_the_interpreter_says() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("python");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    if Command::new("python3").arg("--version").output().is_err() {
        eprintln!("no python3 is installed: the modules for Python are not run");
        return;
    }
    let mut all = Map::new();
    let mut machines = Vec::new();
    for (number, shipped) in SHIPPED.iter().enumerate() {
        let equations = compiled(&asking(&shipped.text()));
        for names in [Names::Iso, Names::Symbols] {
            let module = format!("machine_{number}_{}", if names == Names::Iso { "iso" } else { "symbols" });
            fs::write(folder.join(format!("{module}.py")), print(&equations, Format::Python, names)).unwrap();
            let (values, motions) = given(&equations, names);
            let said = [("values".to_owned(), values.into()), ("motions".to_owned(), motions.into())];
            all.insert(module.clone(), Value::Object(said.into_iter().collect()));
            machines.push((module, shipped.name, names, equations.clone()));
        }
    }
    fs::write(folder.join("given.json"), Value::Object(all.clone()).to_string()).unwrap();
    let run = Command::new("python3").args(["-c", ASKED]).arg(&folder).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let answers: Value = serde_json::from_slice(&run.stdout).unwrap();
    for (module, name, names, equations) in machines {
        let number = |name: &str| all[&module]["values"][name].as_f64().unwrap();
        let numbers =
            |all: &mut dyn Iterator<Item = String>| all.map(|name| number(&name)).collect::<Vec<f64>>();
        let constants = numbers(&mut equations.constants.iter().map(|one| one.name.to_string()));
        let positions = numbers(&mut equations.axes.iter().map(|one| one.variable.to_string()));
        let travels = numbers(&mut equations.travels.iter().map(|one| one.name.to_string()));
        // What a symbol counts against the sense of its name has the other sign.
        let motion = |motion: &model_dsl::equations::Motion| {
            let value = all[&module]["motions"][motion.printed(names)].as_f64().unwrap();
            if motion.is_printed_against_iso(names) { -value } else { value }
        };
        let motions: Vec<f64> = equations.motions.iter().map(motion).collect();
        let interpreter = Interpreter::new(&equations, &constants);
        let nominal = interpreter.nominal(&positions);
        let error = interpreter.error(&positions, &travels, &motions);
        let points = interpreter.direction(&positions).unwrap();
        let leans = interpreter.direction_error(&positions, &travels, &motions).unwrap();
        for (part, letter) in ["I", "J", "K"].into_iter().enumerate() {
            for (which, expected) in [(4, points[part]), (5, leans[part])] {
                let said = answers[&module][which][letter].as_f64().unwrap();
                assert!((said - expected).abs() < 1e-12, "{name} {letter} {which}: {said} {expected}");
            }
        }
        for row in &equations.rows {
            let (place, direction) = (row.direction.index(), row.direction.to_string());
            let said = |which: usize| answers[&module][which][&direction].as_f64().unwrap();
            for (which, expected) in [(0, nominal[place]), (1, error[place]), (2, error[place]), (3, 0.0)] {
                let away = (said(which) - expected).abs();
                assert!(
                    away < 1e-9 * (1.0 + expected.abs()),
                    "{name} {direction} {which}: {} {expected}",
                    said(which)
                );
            }
        }
    }
}
