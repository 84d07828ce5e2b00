//! Calibrations made in memory. In: a calibration, and terms that it lacks. Out: the calibration with them.

use super::{CalibratedMotion, CalibratedTerm, Calibration, Limits, Sensors};
use crate::source::{Span, Spanned};

impl Calibration {
    /// A calibration in which every error motion is zero; the constants are in mm, in the order of the machine's names.
    pub fn new(machine: impl Into<String>, constants: Vec<f64>) -> Self {
        Self {
            machine: unplaced(machine.into()),
            source: None,
            constants,
            tools: Vec::new(),
            limits: Limits::default(),
            sensors: Sensors::default(),
            motions: Vec::new(),
            unseen: Vec::new(),
        }
    }

    /// The number by which a term names the sensor of this name.
    ///
    /// A name not met before becomes an input, read from the channel `temperature.<name>` of a recording or the column
    /// `T_<name>`; a derived sensor is found by its name too. No number that was given before changes. A sensor that no
    /// term comes to use needs no channel and is not written.
    pub fn sensor(&mut self, name: &str) -> usize {
        self.sensors.intern(&unplaced(name.to_owned()))
    }

    /// The calibration with more terms, each added to the motion of its number behind those that it has.
    ///
    /// A motion not listed yet is listed last. Terms name their sensors by the numbers of this calibration:
    /// [`Calibration::sensor`] gives one to a name that has none.
    #[must_use]
    pub fn with(&self, terms: &[(usize, CalibratedTerm)]) -> Self {
        let mut extended = self.clone();
        for (motion, term) in terms {
            extended.add(*motion, term.clone());
        }
        extended
    }

    /// The calibration with one more term of an error motion, which the position loop of the motion's axis answers.
    #[must_use]
    pub fn with_inside_loop(&self, motion: usize, term: CalibratedTerm) -> Self {
        let mut extended = self.clone();
        extended.add(motion, term);
        if let Some(listed) = extended.motions.iter_mut().find(|listed| listed.motion == motion) {
            listed.inside_loop.extend(listed.terms.len().checked_sub(1));
        }
        extended
    }

    fn add(&mut self, motion: usize, term: CalibratedTerm) {
        for sensor in term.sensors() {
            self.sensors.mark_used(sensor);
        }
        let term = unplaced(term);
        match self.motions.iter_mut().find(|listed| listed.motion == motion) {
            Some(listed) => listed.terms.push(term),
            None => self.motions.push(CalibratedMotion {
                motion,
                span: Span::default(),
                terms: vec![term],
                ramps: Vec::new(),
                inside_loop: Vec::new(),
            }),
        }
    }
}

/// A value that stands in no file.
fn unplaced<T>(value: T) -> Spanned<T> {
    Spanned::new(value, Span::default())
}
