//! How an instrument sees the error motions of a machine. In: the machine's equations. Out: the sense in which a reading shows a
//! motion, and the slopes that a squareness makes of two straightnesses.
//!
//! An instrument reads the tool relative to the part, in ISO 841 coordinates; an error motion moves its own body, on whichever
//! branch it is, unless the machine file says otherwise. The lever arms of the equations know both, so that no rule of signs is
//! written here a second time. All axes stand at zero.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::equations::Equations;
use model_dsl::program::Interpreter;
use model_dsl::quantity::Dimension;
use recording::own_direction;

use super::setup::{Measurement, Place};

/// A machine as instruments see it.
pub(super) struct View<'e> {
    pub(super) equations: &'e Equations,
    constants: Vec<f64>,
    interpreter: Interpreter,
}

/// How far a factor may be from +1 or -1.
const CLEAR: f64 = 1e-9;

impl<'e> View<'e> {
    /// The view with the machine's constants, mm.
    pub(super) fn new(equations: &'e Equations, constants: &[f64]) -> Self {
        Self { equations, constants: constants.to_vec(), interpreter: Interpreter::new(equations, constants) }
    }

    pub(super) fn axis_dimension(&self, axis: usize) -> Dimension {
        let rotary = self.equations.axes.get(axis).is_some_and(|axis| axis.rotary);
        if rotary { Dimension::ANGLE } else { Dimension::LENGTH }
    }

    pub(super) fn motion_dimension(&self, motion: usize) -> Dimension {
        if self.is_angular(motion) { Dimension::ANGLE } else { Dimension::LENGTH }
    }

    /// Whether a motion is a rotation.
    pub(super) fn is_angular(&self, motion: usize) -> bool {
        self.equations.motions.get(motion).is_some_and(|motion| motion.angular)
    }

    /// The direction in which a motion is read, or about which: a unit vector of the part's frame. For an axis's own motion
    /// it is that of its positive travel.
    pub(super) fn direction(&self, motion: usize) -> Option<[f64; 3]> {
        let known = self.equations.motions.get(motion)?;
        match self.equations.own_axis(known) {
            Some(axis) => own_direction(self.equations, axis),
            None => unit(known.direction.index()),
        }
    }

    /// What turns a deviation of the file into the motion: +1 or -1, from the sensor, the counting of the file and the branch of
    /// the machine. Reports E0915 where the reading does not show the motion alone.
    pub(super) fn sense(&self, one: &Measurement, diagnostics: &mut Diagnostics) -> Option<f64> {
        let motion = one.motion.value;
        let shown = self.shown(motion).filter(|shown| (shown.abs() - 1.0).abs() < CLEAR);
        let Some(shown) = shown else {
            let name = self.equations.motions.get(motion).map_or("", |motion| &motion.name);
            let message =
                format!("no instrument shows {name} by itself on this machine, with all axes at zero");
            let mistake = Diagnostic::error("E0915", one.motion.span, message);
            diagnostics
                .push(mistake.help("write it under `errors`, with the sign convention of the machine file"));
            return None;
        };
        let against = |turned: bool| if turned { -1.0 } else { 1.0 };
        // A positioning deviation counts along its targets, and turns with them.
        let along = self.is_own(motion) && one.targets.against;
        Some(against(one.deviations.against) * against(along) / shown)
    }

    /// Whether a motion is that of its axis: actual minus commanded.
    pub(super) fn is_own(&self, motion: usize) -> bool {
        let known = self.equations.motions.get(motion);
        known.is_some_and(|known| self.equations.own_axis(known).is_some())
    }

    /// What an instrument reads for each mm or rad of a motion.
    pub(super) fn shown(&self, motion: usize) -> Option<f64> {
        let (positions, travels) = self.at(None);
        let angular = self.equations.motions.get(motion)?.angular;
        let seen = match angular {
            true => self.interpreter.turns(&positions, &travels),
            false => self.interpreter.levers(&positions, &travels),
        };
        Some(dot(*seen.get(motion)?, self.direction(motion)?))
    }

    /// What a motion displaces the tool by for each mm of an axis's travel: the slope that it makes in each direction.
    pub(super) fn slopes(&self, motion: usize, axis: usize) -> [f64; 3] {
        let levers = |moved: Option<usize>| {
            let (positions, travels) = self.at(moved);
            self.interpreter.levers(&positions, &travels).get(motion).copied().unwrap_or([0.0; 3])
        };
        let (there, here) = (levers(Some(axis)), levers(None));
        [0, 1, 2].map(|d| at(&there, d) - at(&here, d))
    }

    /// The same machine with an instrument in place of its tool: other constants.
    pub(super) fn at_place(&self, place: &Place) -> Self {
        let mut constants = self.constants.clone();
        for (number, value) in &place.constants {
            if let Some(slot) = constants.get_mut(*number) {
                *slot = *value;
            }
        }
        Self::new(self.equations, &constants)
    }

    /// The lever arm of every motion while an axis is at a position and the others stand where the measurement was taken.
    pub(super) fn levers(&self, axis: usize, position: f64, place: &Place) -> Vec<[f64; 3]> {
        let at = |number: usize| if number == axis { position } else { place.position(number) };
        let positions: Vec<f64> = (0..self.equations.axes.len()).map(at).collect();
        let travels: Vec<f64> = self.equations.travels.iter().map(|travel| at(travel.axis)).collect();
        self.interpreter.levers(&positions, &travels)
    }

    /// All axes at zero but one, which is at 1 mm, and the travels that go with them.
    fn at(&self, moved: Option<usize>) -> (Vec<f64>, Vec<f64>) {
        let position = |axis: usize| if moved == Some(axis) { 1.0 } else { 0.0 };
        let travels = self.equations.travels.iter().map(|travel| position(travel.axis)).collect();
        ((0..self.equations.axes.len()).map(position).collect(), travels)
    }
}

fn at(vector: &[f64; 3], index: usize) -> f64 {
    vector.get(index).copied().unwrap_or(0.0)
}

/// The unit vector of a direction by number.
pub(super) fn unit(index: usize) -> Option<[f64; 3]> {
    let mut vector = [0.0; 3];
    *vector.get_mut(index)? = 1.0;
    Some(vector)
}

/// The inner product.
pub(super) fn dot(left: [f64; 3], right: [f64; 3]) -> f64 {
    left.iter().zip(right).map(|(left, right)| left * right).sum()
}

/// The vector product.
pub(super) fn cross(left: [f64; 3], right: [f64; 3]) -> [f64; 3] {
    let ([a, b, c], [d, e, f]) = (left, right);
    [b * f - c * e, c * d - a * f, a * e - b * d]
}
