//! One machine with numbers: its chain, constants, tables, and the states in which it is asked.
//!
//! In: the name of a machine. Out: a [`Case`], the same in every run. Every error motion of an axis has a table of 21
//! nodes over the range of the axis; those along the axis and every other one have a curve for each direction of
//! motion. Alignment errors are numbers. It exists so that all contestants read the same numbers.

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Motion;
use model_dsl::source::SourceFile;

use crate::chain::Chain;
use crate::random::Random;

/// Nodes of a table.
pub const NODES: usize = 21;
/// States in which a machine is asked, one after the other.
pub const STATES: usize = 512;

/// A machine with numbers.
#[derive(Debug)]
pub struct Case {
    /// Its name, also that of its machine file.
    pub name: &'static str,
    /// Its chain.
    pub chain: Chain,
    /// The values of its named offsets, mm.
    pub constants: Vec<f64>,
    /// What each error motion is, in the order of the equations.
    pub motions: Vec<Values>,
    /// The states.
    pub states: Vec<State>,
}

/// The values of one error motion.
#[derive(Debug)]
pub enum Values {
    /// One number, mm or rad.
    Number(f64),
    /// A table.
    Table(Table),
}

/// A table over the position of an axis.
#[derive(Debug)]
pub struct Table {
    /// The number of the axis.
    pub axis: usize,
    /// The first node, mm or rad.
    pub start: f64,
    /// From node to node.
    pub step: f64,
    /// The curve in the positive direction of motion.
    pub forward: Vec<f64>,
    /// The curve in the negative direction, where it is another.
    pub reverse: Option<Vec<f64>>,
}

/// A state of the machine.
#[derive(Debug)]
pub struct State {
    /// Positions of the axes, mm or rad.
    pub position: Vec<f64>,
    /// Whether each axis moves in its negative direction.
    pub reversed: Vec<bool>,
    /// Values of the error motions, for the equations alone.
    pub motions: Vec<f64>,
}

/// The range of an axis: its lower end and its length, mm or rad.
fn range(variable: &str) -> (f64, f64) {
    match variable {
        "x" => (0.0, 500.0),
        "y" => (-200.0, 400.0),
        "z" => (-300.0, 320.0),
        "a" => (-PI / 2.0, PI),
        _ => (-PI, 2.0 * PI),
    }
}

/// The name of the five-axis machine whose rotary axes correct their own angles, with this behind it.
const TURNING: &str = "-turning";

/// The text of a machine's file. Where nothing else is said, rotary axes leave their angles to the slides.
///
/// # Errors
/// Tells a file that cannot be read.
pub fn machine_file(name: &str) -> std::io::Result<String> {
    let (file, turning) = name.strip_suffix(TURNING).map_or((name, false), |file| (file, true));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../machines").join(file).with_extension("yaml");
    let text = std::fs::read_to_string(path)?;
    let leave = |text: String, axis: &str| {
        text.replace(&format!("along: {axis}\n"), &format!("along: {axis}\n      corrects: false\n"))
    };
    Ok(if turning { text } else { ["-A", "-C"].into_iter().fold(text, leave) })
}

impl Case {
    /// The case of a shipped machine.
    ///
    /// # Errors
    /// Tells a machine file that cannot be read or compiled.
    pub fn new(name: &'static str) -> Result<Self, Box<dyn Error>> {
        let source = SourceFile::new(name, machine_file(name)?);
        let compiled = model_dsl::compile(&source, &mut Diagnostics::new())
            .ok_or("the machine file does not compile")?;
        let names: Vec<String> =
            compiled.equations.motions.iter().map(|motion| motion.name.clone()).collect();
        let chain = Chain::new(&compiled.machine, &names)?;
        let mut random = Random(2026);
        let constants = chain.constants.iter().map(|_| random.around(150.0)).collect();
        let motions: Vec<Values> = compiled
            .equations
            .motions
            .iter()
            .enumerate()
            .map(|(number, motion)| values(motion, number, &chain, &mut random))
            .collect();
        let angular: Vec<bool> = compiled.equations.motions.iter().map(|motion| motion.angular).collect();
        let states = (0..STATES).map(|_| state(&chain, &angular, &mut random)).collect();
        Ok(Self { name, chain, constants, motions, states })
    }

    /// The value of every error motion at a position, from the tables: mm or rad.
    pub fn read(&self, position: &[f64], reversed: &[bool], out: &mut [f64]) {
        for (out, motion) in out.iter_mut().zip(&self.motions) {
            *out = match motion {
                Values::Number(value) => *value,
                Values::Table(table) => table.value(position[table.axis], reversed[table.axis]),
            };
        }
    }
}

impl Table {
    fn value(&self, position: f64, reversed: bool) -> f64 {
        let curve = self.curve(reversed);
        let place = ((position - self.start) / self.step).clamp(0.0, (NODES - 1) as f64);
        let node = (place as usize).min(NODES - 2);
        curve[node] + (curve[node + 1] - curve[node]) * (place - node as f64)
    }

    /// The curve of a direction.
    pub fn curve(&self, reversed: bool) -> &[f64] {
        self.reverse.as_deref().filter(|_| reversed).unwrap_or(&self.forward)
    }
}

/// Twenty micrometres, or fifty microradians, at the most.
fn size(angular: bool) -> f64 {
    if angular { 50e-6 } else { 0.02 }
}

fn values(motion: &Motion, number: usize, chain: &Chain, random: &mut Random) -> Values {
    let size = size(motion.angular);
    let Some(axis) = motion.axis.filter(|_| !motion.alignment) else {
        return Values::Number(random.around(size));
    };
    let (start, length) = range(&chain.variables[axis]);
    let mut curve = || (0..NODES).map(|_| random.around(size)).collect::<Vec<f64>>();
    let own = motion.name.chars().nth(1) == motion.link.chars().next();
    Values::Table(Table {
        axis,
        start,
        step: length / (NODES - 1) as f64,
        forward: curve(),
        reverse: (own || number % 2 == 1).then(curve),
    })
}

/// Positions over the range of each axis and two hundredths of it beyond.
fn state(chain: &Chain, angular: &[bool], random: &mut Random) -> State {
    State {
        position: chain
            .variables
            .iter()
            .map(|variable| {
                let (start, length) = range(variable);
                start + (1.04 * random.unit() - 0.02) * length
            })
            .collect(),
        reversed: chain.variables.iter().map(|_| random.unit() < 0.5).collect(),
        motions: angular.iter().map(|angular| random.around(size(*angular))).collect(),
    }
}
