//! Models: which effects act, where, and how strongly; how the plays of axes act after a reversal, how commands go between rows, and
//! whether axes move where a run begins.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::harmonics;
use crate::side::Side;
use crate::states::Crossing;
use crate::terms::{Setting, Shape};

/// One effect: a term at a place.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Effect {
    pub(crate) place: Place,
    pub(crate) shape: Shape,
}

/// Where an effect acts.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Place {
    /// In an error motion of the machine, by its number in the equations.
    Motion { motion: usize, side: Side },
    /// In the instrument of a recording, by its number in the study.
    Instrument { recording: usize },
}

/// An effect with its coefficients, in mm, rad, s and degC.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Fitted {
    pub(crate) effect: Effect,
    pub(crate) coefficients: Vec<f64>,
}

impl Fitted {
    /// An effect that is not fitted yet.
    pub(crate) fn unfitted(effect: Effect) -> Self {
        Self { coefficients: vec![0.0; effect.shape.columns()], effect }
    }
}

/// All that is held to act beside the calibration: effects, and how axes move: the plays that they cross, commands that bend between rows,
/// and runs that begin underway.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Model {
    /// The settings of instruments that are fitted whatever else is, then the effects that were chosen.
    pub(crate) effects: Vec<Fitted>,
    /// How many of the effects are such settings.
    settings: usize,
    /// How the plays of an axis act after a reversal; those of all other axes act at once. Whatever of the axis jumps, a reversal of
    /// its yaw too, goes with it.
    crossings: BTreeMap<usize, Crossing>,
    /// Whether commands bend between rows: a controller has more cycles than the recording has rows. Otherwise they go straight.
    bends: bool,
    /// Whether axes move where a leg begins: it was cut out of a motion. Otherwise they rest there.
    underway: bool,
}

impl Model {
    /// Effects that were chosen, with plays that act at once.
    pub(crate) fn of(effects: impl IntoIterator<Item = Fitted>) -> Self {
        Self { effects: effects.into_iter().collect(), ..Self::default() }
    }

    /// Settings that are always fitted, not fitted yet.
    pub(crate) fn of_settings(settings: impl IntoIterator<Item = Effect>) -> Self {
        let model = Self::of(settings.into_iter().map(Fitted::unfitted));
        let count = model.effects.len();
        model.with_settings(count)
    }

    /// The same model, whose first `settings` effects are always fitted.
    pub(crate) fn with_settings(self, settings: usize) -> Self {
        Self { settings: settings.min(self.effects.len()), ..self }
    }

    /// Other effects, of which as many are settings, and axes that move as in this model.
    pub(crate) fn with_effects(&self, effects: impl IntoIterator<Item = Fitted>) -> Self {
        Self::of(effects).with_settings(self.settings).moving_as(self).without_bare_harmonics()
    }

    /// The same with one effect more.
    pub(crate) fn with(&self, fitted: Fitted) -> Self {
        let mut more = self.clone();
        more.effects.push(fitted);
        more
    }

    /// The same without one of its effects.
    pub(crate) fn without(&self, number: usize) -> Self {
        let mut rest = self.clone();
        rest.effects.remove(number);
        rest.settings -= usize::from(number < self.settings);
        rest.without_bare_harmonics()
    }

    /// The same, in which a harmonic without its fundamental is a wave by itself.
    fn without_bare_harmonics(mut self) -> Self {
        harmonics::set_free(&mut self.effects);
        self
    }

    /// The same without some of its effects.
    pub(crate) fn without_all(&self, numbers: &[usize]) -> Self {
        let mut rest = self.clone();
        let mut descending = numbers.to_vec();
        descending.sort_unstable_by(|a, b| b.cmp(a));
        descending.into_iter().for_each(|number| rest = rest.without(number));
        rest
    }

    /// The same with its settings, and those of the chosen effects that `stays` picks.
    pub(crate) fn keeping(&self, stays: impl Fn(&Fitted) -> bool) -> Self {
        let chosen = self.chosen().iter().filter(|fitted| stays(fitted));
        self.with_effects(self.settings().iter().chain(chosen).cloned())
    }

    /// The same with nothing but its settings.
    pub(crate) fn settings_alone(&self) -> Self {
        self.with_effects(self.settings().iter().cloned())
    }

    /// The settings that are always fitted.
    pub(crate) fn settings(&self) -> &[Fitted] {
        &self.effects[..self.settings]
    }

    /// The effects that were chosen.
    pub(crate) fn chosen(&self) -> &[Fitted] {
        &self.effects[self.settings..]
    }

    /// The same, to change them.
    pub(crate) fn chosen_mut(&mut self) -> &mut [Fitted] {
        &mut self.effects[self.settings..]
    }

    /// The numbers of the chosen effects.
    pub(crate) fn chosen_numbers(&self) -> Range<usize> {
        self.settings..self.effects.len()
    }

    /// The same with axes that move as in another model.
    pub(crate) fn moving_as(self, other: &Self) -> Self {
        Self { crossings: other.crossings.clone(), bends: other.bends, underway: other.underway, ..self }
    }

    /// Whether axes move as in another model, but for the plays that they cross.
    pub(crate) fn is_driven_as(&self, other: &Self) -> bool {
        (self.bends, self.underway) == (other.bends, other.underway)
    }

    /// Whether axes move otherwise than in a model of effects alone.
    pub(crate) fn moves_otherwise(&self) -> bool {
        self.crosses() || self.bends || self.underway
    }

    /// The same with commands that bend between rows.
    pub(crate) fn bending(self) -> Self {
        Self { bends: true, ..self }
    }

    /// Whether commands bend between rows.
    pub(crate) fn bends(&self) -> bool {
        self.bends
    }

    /// The same with axes that move where a leg begins.
    pub(crate) fn begun_underway(self) -> Self {
        Self { underway: true, ..self }
    }

    /// Whether axes move where a leg begins.
    pub(crate) fn underway(&self) -> bool {
        self.underway
    }

    /// The same with plays that act at once.
    pub(crate) fn uncrossed(self) -> Self {
        Self { crossings: BTreeMap::new(), ..self }
    }

    /// How the plays of an axis act after a reversal.
    pub(crate) fn crossing(&self, axis: usize) -> Crossing {
        self.crossings.get(&axis).copied().unwrap_or_default()
    }

    /// Whether the plays of any axis do not act at once.
    pub(crate) fn crosses(&self) -> bool {
        !self.crossings.is_empty()
    }

    /// The axes whose plays do not act at once.
    pub(crate) fn crossing_axes(&self) -> Vec<usize> {
        self.crossings.keys().copied().collect()
    }

    /// Lets the plays of an axis act so after a reversal.
    pub(crate) fn cross(&mut self, axis: usize, crossing: Crossing) {
        if crossing == Crossing::AtOnce {
            self.crossings.remove(&axis);
        } else {
            self.crossings.insert(axis, crossing);
        }
    }
}

impl Model {
    /// The fitted value of a setting of the instrument of one recording, in its own unit; 0 where it is not fitted.
    pub(crate) fn setting(&self, recording: usize, setting: Setting) -> f64 {
        let wanted = |fitted: &&Fitted| fitted.effect.setting_of(recording) == Some(setting);
        self.effects.iter().filter(wanted).flat_map(|fitted| &fitted.coefficients).sum()
    }
}

impl Effect {
    /// A setting of the instrument of a recording.
    pub(crate) fn setting(recording: usize, setting: Setting) -> Self {
        Self { place: Place::Instrument { recording }, shape: Shape::Instrument(setting) }
    }

    /// The setting, where it is one of the instrument of this recording.
    pub(crate) fn setting_of(&self, recording: usize) -> Option<Setting> {
        match (&self.shape, self.place) {
            (Shape::Instrument(setting), Place::Instrument { recording: of }) if of == recording => {
                Some(*setting)
            }
            _ => None,
        }
    }

    /// The error motion, where it acts in one.
    pub(crate) fn motion(&self) -> Option<usize> {
        match self.place {
            Place::Motion { motion, .. } => Some(motion),
            Place::Instrument { .. } => None,
        }
    }

    /// Whether two act in the same motion and show, or do not show, in the drive's own feedback.
    pub(crate) fn same_place(&self, other: &Self) -> bool {
        match (self.place, other.place) {
            (Place::Motion { motion: a, side: one }, Place::Motion { motion: b, side: two }) => {
                a == b && one.at_drive() == two.at_drive()
            }
            (a, b) => a == b,
        }
    }

    /// The side, where it acts in the machine.
    pub(crate) fn side(&self) -> Option<Side> {
        match self.place {
            Place::Motion { side, .. } => Some(side),
            Place::Instrument { .. } => None,
        }
    }
}

#[cfg(test)]
mod tests;
