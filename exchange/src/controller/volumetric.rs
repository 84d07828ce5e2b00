//! The machine model of volumetric compensations. In: a machine of three slides, and the error motions of a file. Out: the
//! correction that a controller makes of them.
//!
//! Such a controller multiplies the same chain that Abbe does, from its own description: which axes carry the part, and where
//! the tip is. Its model here is Abbe's of the bare topology, every error motion being that of the tool relative to the part,
//! as an instrument reads it. Where the own machine file says something else (frames apart from each other, errors of bodies),
//! signs are turned, and what is then still different shows in what is lost.

use std::collections::BTreeMap;
use std::fmt::Write;

use abbe_runtime::Term;
use model_dsl::compile;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::machine::Branch;
use model_dsl::program::Interpreter;
use model_dsl::source::SourceFile;

use super::geometry::{Geometry, Pose, correction, senses};
use super::grid::Grid;
use super::lost::Target;
use super::refused::Refused;

/// The controller's own model of a machine.
#[derive(Debug)]
pub(super) struct Volumetric {
    /// Its equations: of the bare topology, motions of the tool relative to the part.
    pub equations: Equations,
    /// The topology word.
    pub word: String,
    /// How many axes carry the part.
    pub workpiece_axes: usize,
    /// The tip of the tool at zero of all axes, in the part's frame, mm.
    pub tip: [f64; 3],
    machine: Interpreter,
    /// The error motions that are loaded, by ISO name.
    pub parameters: BTreeMap<String, Grid>,
}

impl Volumetric {
    /// The model of a machine, no errors being loaded.
    ///
    /// # Errors
    /// A machine that has not exactly the slides X, Y, Z.
    pub(super) fn new(geometry: &Geometry<'_>) -> Result<Self, Refused> {
        let word = word(geometry.equations).ok_or_else(|| {
            let help = "export tables of single axes instead: linuxcnc, sinumerik, heidenhain, pmac";
            Refused::new(
                format!("{} is not a machine with three slides X, Y, Z", geometry.equations.machine),
                help,
            )
        })?;
        let equations = model(&word)?;
        let tip = geometry.nominal(&vec![0.0; geometry.equations.axes.len()]);
        let machine = machine(&equations, tip);
        let workpiece_axes = word.find('F').unwrap_or_default();
        Ok(Self { equations, word, workpiece_axes, tip, machine, parameters: BTreeMap::new() })
    }

    /// Puts the tip where the file says that it is: 0, 1, 2 for X, Y, Z.
    pub(super) fn set_tip(&mut self, direction: usize, place: f64) {
        if let Some(slot) = self.tip.get_mut(direction) {
            *slot = place;
        }
        self.machine = machine(&self.equations, self.tip);
    }

    /// By what an error motion of the machine is multiplied to be the controller's: 1 or -1; nothing where the controller's
    /// model has no such motion, or one that does something else.
    pub(super) fn sign(&self, geometry: &Geometry<'_>, motion: usize) -> Option<f64> {
        // No axis at zero: the lever of an alignment error is a travel.
        let position = vec![1.0; geometry.equations.axes.len()];
        let own_position = vec![1.0; self.equations.axes.len()];
        let name = &geometry.equations.motions.get(motion)?.name;
        let own = self.equations.motions.iter().position(|motion| motion.name == *name)?;
        let (theirs, ours) = (geometry.senses(&position), senses(&self.machine, &own_position));
        let alike: f64 = theirs.get(motion)?.iter().zip(ours.get(own)?).map(|(one, other)| one * other).sum();
        (alike != 0.0).then_some(alike.signum())
    }

    /// The error motions at a position, in the order of the model's equations.
    fn motions(&self, position: &[f64]) -> Vec<f64> {
        let motions = self.equations.motions.iter();
        motions
            .map(|motion| self.parameters.get(&motion.name).map_or(0.0, |grid| grid.value(position)))
            .collect()
    }
}

impl Target for Volumetric {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let values = self.motions(&pose.position);
        let terms: Vec<Vec<Term<'_>>> =
            values.into_iter().map(|value| vec![Term::Constant { value }]).collect();
        // Motors follow behind what the controller corrects.
        let axes = self.equations.axes.len();
        let mut correction = correction(&self.machine, &terms, &pose.of_first(axes))?;
        correction.resize(pose.position.len(), 0.0);
        Ok(correction)
    }
}

/// The model with the tip at a place.
fn machine(equations: &Equations, tip: [f64; 3]) -> Interpreter {
    let constants = equations.constants.iter().map(|constant| match constant.name.to_string().as_str() {
        "Xt" => tip[0],
        "Yt" => tip[1],
        _ => tip[2],
    });
    Interpreter::new(equations, &constants.collect::<Vec<_>>())
}

/// The equations of a topology with all errors that such a controller knows: six motions of each slide, and the directions
/// in which each may lie askew, redundant as they are.
fn model(word: &str) -> Result<Equations, Refused> {
    let (part, tool) = word.split_once('F').unwrap_or_default();
    let mut text = String::from("abbe: 1\nname: controller\nmotions: relative\nchain:\n");
    if !part.is_empty() {
        text.push_str("  workpiece:\n");
        part.chars().rev().for_each(|letter| write_slide(&mut text, letter, '-'));
    }
    text.push_str("  tool:\n");
    tool.chars().for_each(|letter| write_slide(&mut text, letter, '+'));
    text.push_str("    - tool: tip\n      offset: [Xt, Yt, Zt]\n");
    let compiled = compile(&SourceFile::new("controller", text), &mut Diagnostics::new());
    compiled
        .map(|compiled| compiled.equations)
        .ok_or_else(|| Refused::new("the controller's model was not derived", "this is a bug in Abbe"))
}

fn write_slide(text: &mut String, letter: char, sign: char) {
    let motions = "XYZABC".chars().map(|along| format!("E{along}{letter}"));
    let askew = "ABC".chars().zip("XYZ".chars()).filter(|(_, axis)| *axis != letter);
    let errors: Vec<String> = motions.chain(askew.map(|(about, _)| format!("E{about}0{letter}"))).collect();
    let _ = writeln!(
        text,
        "    - slide: {letter}\n      along: {sign}{letter}\n      errors: [{}]",
        errors.join(", ")
    );
}

/// The topology word of a machine of three slides X, Y, Z, read from part to tool.
fn word(equations: &Equations) -> Option<String> {
    let axes = equations.axes.iter().filter(|axis| !axis.is_motor());
    let letters: Vec<&str> = axes.map(|axis| axis.letter.as_str()).collect();
    if letters != ["X", "Y", "Z"] {
        return None;
    }
    let on = |branch: Branch| {
        let links = equations.links.iter().filter(move |link| link.branch == branch);
        links.filter_map(|link| link.kind.letter()).collect::<Vec<char>>()
    };
    let part = on(Branch::Workpiece).into_iter().rev();
    Some(part.chain(['F']).chain(on(Branch::Tool)).collect())
}
