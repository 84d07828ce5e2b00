//! The published table, all the way: the calibration file through the command line to commands, and the exact machine,
//! with the same error motions and nothing linearised, as judge of where the tool comes out.

use std::collections::BTreeMap;

use abbe_runtime::{Direction, ErrorMotion, Sample, Term, TermState};
use model_dsl::calibration::{self, Calibration};
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::yaml;

use crate::agreement::compiled;
use crate::cli::{abbe, column};
use crate::oracle::{Machine, Sizes, State, exact};
use crate::shipped::{SHIPPED, root};

fn read(equations: &Equations) -> Calibration {
    let text = std::fs::read_to_string(root().join("calibrations/postech-mill.yaml")).unwrap();
    let mut diagnostics = Diagnostics::new();
    let tree = yaml::read(&SourceFile::new("postech-mill.yaml", text), &mut diagnostics).unwrap();
    calibration::read(&tree, &equations.names(), &mut diagnostics).unwrap()
}

/// The real machine at a command: every error motion as the table has it there, all axes moving forwards.
fn real(equations: &Equations, calibration: &Calibration, command: [f64; 3]) -> State {
    let sample = Sample {
        position: &command,
        travel: &[],
        direction: &[Direction::Positive; 3],
        velocity: &[0.0; 3],
        temperature: &[],
        time_step: 0.0,
    };
    let mut state = State { positions: positions(command), ..State::default() };
    for (constant, value) in equations.constants.iter().zip(&calibration.constants) {
        state.constants.insert(constant.name.to_string(), *value);
    }
    for (number, motion) in equations.motions.iter().enumerate() {
        let terms: Vec<Term<'_>> =
            calibration.terms(number).iter().flat_map(|term| term.value.runtime().unwrap()).collect();
        let memory = vec![TermState::default(); terms.len()];
        state.errors.insert(motion.name.clone(), ErrorMotion { terms: &terms }.value(&sample, &memory));
    }
    state
}

fn positions(command: [f64; 3]) -> BTreeMap<String, f64> {
    ["x", "y", "z"].map(str::to_owned).into_iter().zip(command).collect()
}

fn distance(machine: &Machine, real: &State, target: [f64; 3]) -> f64 {
    let wanted = State { positions: positions(target), errors: BTreeMap::new(), ..real.clone() };
    let (real, wanted) = (exact::tip(machine, real), exact::tip(machine, &wanted));
    (0..3).map(|axis| (real[axis] - wanted[axis]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn the_seven_points_come_out_where_they_were_wanted() {
    let shipped = SHIPPED.iter().find(|shipped| shipped.name == "postech-mill").unwrap();
    let (machine, equations) = ((shipped.described)(), compiled(&shipped.text()));
    let calibration = read(&equations);
    let points = std::fs::read_to_string(root().join("calibrations/postech-points.csv")).unwrap();
    let out = abbe(&["compensate", "calibrations/postech-mill.yaml"], &points).out;
    let columns = ["x", "y", "z", "x_comp", "y_comp", "z_comp"].map(|name| column(&out, name));
    assert_eq!(columns[0].len(), 7);
    for (row, _) in columns[0].iter().enumerate() {
        let [x, y, z, x_comp, y_comp, z_comp] = columns.each_ref().map(|column| column[row]);
        let (target, command) = ([x, y, z], [x_comp, y_comp, z_comp]);
        let off = distance(&machine, &real(&equations, &calibration, target), target);
        let state = real(&equations, &calibration, command);
        let on = distance(&machine, &state, target);
        let sizes = Sizes::of(&machine, &state);
        // Half the second derivative along the errors, and the last of nine printed decimals in three axes.
        let second_order = sizes.second() / 2.0 + sizes.rounding() + 1e-9;
        assert!(on <= second_order, "{target:?}: {on} mm left, second order allows {second_order}");
        assert!(on < off / 200.0, "{target:?}: {off} mm without compensation, {on} mm with it");
        assert!((0.005..0.05).contains(&off), "{target:?}: {off} mm is not of the paper's size");
    }
}
