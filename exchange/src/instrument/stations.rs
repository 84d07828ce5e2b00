//! The readings of a positioning test. In: a measurement of an axis's own motion, and its file. Out: for each target what was read
//! there from either side, for the figures of the standards, which take single readings and no means.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;

use super::measured::Measured;
use super::placed::Placed;
use super::setup::Setup;
use super::view::View;

/// What was read at the targets of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Stations {
    /// The axis that moved: an index into [`Equations::axes`].
    pub axis: usize,
    /// The targets on the axis, ascending: mm or rad.
    pub positions: Vec<f64>,
    /// For each target the deviations of the tool relative to the part, actual minus target, that were read after a motion in the
    /// positive direction: mm or rad.
    pub up: Vec<Vec<f64>>,
    /// The same after a motion in the negative direction.
    pub down: Vec<Vec<f64>>,
}

/// The readings of the first measurement of a set-up. Findings stand at places of the set-up, warnings of runs at those of the file;
/// E0905 where it is not of an axis's own motion.
pub fn stations(
    setup: &Setup,
    file: &Measured,
    equations: &Equations,
    findings: (&mut Diagnostics, &mut Diagnostics),
) -> Option<Stations> {
    let (in_setup, in_data) = findings;
    let one = setup.measurements.first()?;
    let letter = equations.axes.get(one.axis).map_or("", |axis| axis.letter.as_str());
    let name = equations.motions.get(one.motion.value).map_or("", |motion| motion.name.as_str());
    if name != own_motion(letter) {
        let message = format!("{name} does not show the positioning of {letter}");
        let help = format!("use a file of {} for the figures of positioning", own_motion(letter));
        in_setup.push(Diagnostic::error("E0905", one.motion.span, message).help(help));
        return None;
    }
    let view = View::new(equations, &setup.known.constants);
    let shown = view.shown(one.motion.value)?;
    let placed = Placed::new(file, one, &view, (in_setup, in_data))?;
    let side = |forward: bool| {
        let mut read: Vec<Vec<f64>> = vec![Vec::new(); placed.positions.len()];
        for (target, deviation) in
            placed.runs.iter().filter(|run| run.forward == forward).flat_map(|run| &run.readings)
        {
            if let Some(readings) = read.get_mut(*target) {
                readings.push(shown * deviation);
            }
        }
        read
    };
    Some(Stations { axis: one.axis, up: side(true), down: side(false), positions: placed.positions })
}

/// The motion in which an axis fails to keep its positions: `EXX`, `EXU`, `ECC`.
fn own_motion(letter: &str) -> String {
    let direction = match letter {
        "U" => "X",
        "V" => "Y",
        "W" => "Z",
        own => own,
    };
    format!("E{direction}{letter}")
}
