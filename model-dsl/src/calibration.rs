//! Calibration files: the numbers of one machine.
//!
//! In: the tree of a calibration file and the names of the machine it is for. Out: a [`Calibration`] in internal units
//! (mm, rad, s, degC), or findings at the places that are wrong, all of them in one run.
//!
//! Reading goes in two steps, because the file itself names the machine: [`machine_of`] reads that name alone, the
//! caller finds the machine, and [`read`] reads the rest against its names. [`write()`] goes the other way, for calibrations
//! that were extended in memory ([`Calibration::with`]).
//!
//! | code | finding |
//! | --- | --- |
//! | E0401 | a required key is missing |
//! | E0402 | a format version that is not read, or another kind of file |
//! | E0403 | an unknown key |
//! | E0404 | a mapping, list or word is needed in place of what stands there |
//! | E0405, E0406 | an unknown constant; a constant of the machine without a value |
//! | E0407, E0408 | an error motion that the machine lacks; one given under two spellings |
//! | E0409, E0410 | an unknown term; an item that is not exactly one term |
//! | E0411, E0412 | a parameter of a term is missing; a term has no such parameter |
//! | E0413 | a `unit` or `per` of the wrong kind |
//! | E0414, E0415 | an unknown axis; an axis that must be named |
//! | E0416 | keys that exclude one another |
//! | E0417, E0418 | a table or list without entries, or curves of different lengths; `at` out of order |
//! | E0419 | a value that must be greater than zero, or not zero |
//! | E0420 | `coupling` to the link's own axis |
//! | E0421 | degF as the scale of a polynomial |
//! | E0422, E0423 | a derived sensor that is not one; one that is derived from itself |
//! | E0424 | a compliance that is not per load |
//! | E0425 | a term that cannot be compensated, from [`Calibration::refuse_uncompensable`] |
//! | E0428, E0429 | an item of `times` that is not exactly one factor; a unit that the factors do not make the motion's |
//! | E0431 | a position loop of a motor |
//! | E0432 | a direction of a tool that it cannot have |
//! | W0401 | a derived sensor that no term uses |
//! | W0403 | a table that repeats and whose ends have two values |
//!
//! Quantities have their own codes, E0301 to E0309: see [`crate::quantity`].

mod build;
mod compiled_in;
mod curve;
mod document;
pub mod factor;
mod fields;
mod names;
mod parameters;
mod read_factor;
mod read_term;
mod sensors;
mod series;
mod small;
mod spelling;
mod term;
mod tool_direction;
mod tools;
pub mod vocabulary;
mod write;
mod write_term;

pub use compiled_in::CompiledIn;
pub use document::{machine_of, read};
pub use factor::{Factor, FactorKind, Within};
pub use names::{AxisName, MachineNames, MotionName, TurningTool};
pub use sensors::{Sensor, SensorKind, SensorReadings, Sensors};
pub use small::{LARGEST_ANGLE, LARGEST_DISPLACEMENT, not_small};
pub use term::{CalibratedTerm, Curve, CurveNodes, CurveValues, NotCompensable, Part, SeriesInput};
pub use vocabulary::{TERM_NAMES, TermKind};
pub use write::write;

use abbe_runtime::Term;

use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::source::{Span, Spanned};

/// The numbers of one machine.
#[derive(Clone, PartialEq, Debug)]
pub struct Calibration {
    /// The machine as the file names it: a shipped machine's name, a path, or a topology word.
    pub machine: Spanned<String>,
    /// Where the numbers come from, in the file's words.
    pub source: Option<String>,
    /// The values of the machine's constants in mm, in the order of [`MachineNames::constants`].
    pub constants: Vec<f64>,
    /// The tools, in the order of the file.
    pub tools: Vec<Tool>,
    /// What a correction may not exceed.
    pub limits: Limits,
    /// The temperature sensors that the terms read, and those that are derived from others.
    pub sensors: Sensors,
    /// The error motions that the file lists, in its order; all others are zero.
    pub motions: Vec<CalibratedMotion>,
    /// Those of [`MachineNames::unseen`] that the file lists. They have no effect, and are written back.
    pub unseen: Vec<CalibratedMotion>,
}

/// A tool: the machine's constants with what is different with it.
#[derive(Clone, PartialEq, Debug)]
pub struct Tool {
    /// Its name, such as `T12`.
    pub name: Spanned<String>,
    /// The values of the machine's constants in mm, in the order of [`MachineNames::constants`].
    pub constants: Vec<f64>,
}

impl Calibration {
    /// The number in [`Calibration::tools`] of a tool, by its name; `12` is `T12` where no tool is called `12`.
    #[must_use]
    pub fn tool(&self, name: &str) -> Option<usize> {
        let named = |name: &str| self.tools.iter().position(|tool| tool.name.value == name);
        let is_number = !name.is_empty() && name.bytes().all(|digit| digit.is_ascii_digit());
        named(name).or_else(|| is_number.then(|| named(&format!("T{name}")))?)
    }
}

/// What a correction may not exceed, and how a controller goes from one correction to another.
///
/// Points of a table know only the first; the others are for servo cycles, which follow each other in time.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Limits {
    /// The largest correction over all slides in mm; a larger one is refused, not applied. No limit where there is none.
    pub compensation: Option<Spanned<f64>>,
    /// The largest correction over all rotary axes in rad; a larger one is refused. No limit where there is none.
    pub rotation: Option<Spanned<f64>>,
    /// The greatest change of a correction, over all slides, in mm/s. No limit where there is none.
    pub rate: Option<Spanned<f64>>,
    /// The greatest change of a correction, over all rotary axes, in rad/s. No limit where there is none.
    pub rotation_rate: Option<Spanned<f64>>,
    /// How long the last reading of a silent sensor is held, in s. The runtime's default where there is none.
    pub hold: Option<Spanned<f64>>,
    /// The time over which a correction fades in or out, in s. The runtime's default where there is none.
    pub fade: Option<Spanned<f64>>,
}

impl Limits {
    /// What the runtime's compensator is told.
    #[must_use]
    pub fn of_compensator(&self) -> abbe_runtime::Limits {
        abbe_runtime::Limits {
            compensation: self.compensation.map(|limit| limit.value),
            rotation: self.rotation.map(|limit| limit.value),
        }
    }

    /// What the runtime's supervisor is told.
    #[must_use]
    pub fn transition(&self) -> abbe_runtime::Transition {
        let default = abbe_runtime::Transition::default();
        abbe_runtime::Transition {
            rate: self.rate.map(|rate| rate.value),
            rotation_rate: self.rotation_rate.map(|rate| rate.value),
            hold: self.hold.map_or(default.hold, |hold| hold.value),
            fade: self.fade.map_or(default.fade, |fade| fade.value),
        }
    }
}

/// One error motion and the terms that add up to it.
///
/// Two of them are equal wherever they stand, as [`Spanned`] values are.
#[derive(Clone, Debug)]
pub struct CalibratedMotion {
    /// Which motion: an index into [`MachineNames::motions`], or into [`MachineNames::unseen`] where it has no effect.
    pub motion: usize,
    /// Where the file names it.
    pub span: Span,
    /// Its terms, each at the place of its name, or of its value where that stands alone.
    pub terms: Vec<Spanned<CalibratedTerm>>,
    /// The ramps over which the correction of reversals is spread, for those of its terms that have one.
    pub ramps: Vec<Ramp>,
    /// The places of those of its terms that act inside the position loop of the motion's axis, in rising order.
    pub inside_loop: Vec<usize>,
}

/// How a correction follows a reversal: gradually, since no drive makes its move at once.
///
/// It stands beside the term and not in it, since it is a setting of the compensation: what the machine does, and so what
/// a simulation or a diagnosis makes of the term, is the same with any ramp.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ramp {
    /// The `backlash` that it belongs to: its place among the terms of the motion.
    pub term: usize,
    /// The time over which the correction of a whole reversal is spread, s, greater than zero.
    pub time: f64,
}

impl PartialEq for CalibratedMotion {
    fn eq(&self, other: &Self) -> bool {
        (self.motion, &self.terms, &self.ramps, &self.inside_loop)
            == (other.motion, &other.terms, &other.ramps, &other.inside_loop)
    }
}

impl CalibratedMotion {
    /// The ramp of the term at this place, s; 0 where its correction is made at once.
    pub fn ramp(&self, place: usize) -> f64 {
        self.ramps.iter().find(|ramp| ramp.term == place).map_or(0.0, |ramp| ramp.time)
    }

    /// Whether the term at this place acts inside the position loop of the motion's axis: friction and loads on the drive,
    /// which its own feedback sees and the loop answers as it answers its command. What then remains at the axis is the
    /// term's value behind the loop that the motion's `lag` makes. A compensation adds its correction to the command, which
    /// goes the same way, so that the runtime takes the term as it stands.
    pub fn is_inside_loop(&self, place: usize) -> bool {
        self.inside_loop.contains(&place)
    }
}

impl Calibration {
    /// The terms of an error motion; none where the file does not list it.
    pub fn terms(&self, motion: usize) -> &[Spanned<CalibratedTerm>] {
        let listed = self.motions.iter().find(|listed| listed.motion == motion);
        listed.map_or(&[], |listed| &listed.terms)
    }

    /// The terms of an error motion as the runtime compensates them, each with its factors before it and its ramp; for each that it
    /// cannot, why.
    pub fn runtime(&self, motion: usize) -> impl Iterator<Item = Result<Vec<Term<'_>>, NotCompensable>> {
        let listed = self.motions.iter().filter(move |listed| listed.motion == motion);
        listed.flat_map(|listed| {
            listed.terms.iter().enumerate().map(|(place, term)| {
                let mut terms = term.value.runtime()?;
                if let Some(Term::Backlash { ramp, .. }) = terms.last_mut() {
                    *ramp = listed.ramp(place);
                }
                Ok(terms)
            })
        })
    }

    /// Reports every term that no controller can compensate in real time, at its name (E0425).
    pub fn refuse_uncompensable(&self, names: &MachineNames, diagnostics: &mut Diagnostics) {
        for listed in &self.motions {
            let motion = names.motions.get(listed.motion).map_or("", |motion| &motion.name);
            for term in &listed.terms {
                let Some((what, reason)) = term.value.not_compensable() else { continue };
                let name = term.value.name();
                let message = match what {
                    NotCompensable::Factor(factor) => format!(
                        "`{name}` of {motion} cannot be compensated in real time: the controller does not know its factor `{}` in time",
                        factor.name()
                    ),
                    _ => format!("`{name}` of {motion} cannot be compensated in real time"),
                };
                let help = format!("{reason}; remove it from the file that is compensated");
                diagnostics.push(Diagnostic::error("E0425", term.span, message).help(help));
            }
        }
    }
}

#[cfg(test)]
mod tests;
