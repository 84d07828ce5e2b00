//! What is asked of a recording. In: a recording with its machine. Out: the kinds of effects, each in one error motion, of which its
//! readings show something. Motions in which a kind shows alike are asked once.

use model_dsl::calibration::TermKind;

use crate::injection::allowed::{self, Allowed};
use crate::injection::base::{Base, Signal};
use crate::injection::columns::{correlation, rms, straightened};
use crate::injection::kind::Kind;

/// A kind of effect in an error motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The error motion, by number.
    pub motion: usize,
    /// The axis that the effect follows, by number; of a squareness the one whose line is turned.
    pub axis: usize,
    /// `backlash`, `wind-up`, ...
    pub kind: Kind,
    /// Other motions in which it would show alike, by number.
    pub alike: Vec<usize>,
}

impl Subject {
    /// The effect of one trial at size one.
    pub fn drawn(&self, base: &Base, seed: u64, trial: usize) -> Option<Allowed> {
        drawn(base, (self.motion, self.axis, self.kind), seed, trial)
    }
}

fn drawn(
    base: &Base,
    (motion, axis, kind): (usize, usize, Kind),
    seed: u64,
    trial: usize,
) -> Option<Allowed> {
    let name = format!("{} {} {trial}", base.names.axes[axis].letter, kind.name());
    allowed::drawn(base, motion, axis, (kind, &name), seed)
}

/// What a thousandth of an error motion must add to the readings, in parts of it, for the motion to show: a tenth. Of what it hardly
/// shows no machine has enough.
const SEEN: f64 = 0.1;

/// Two signals are one where the part of one that the other does not explain is below a hundredth of its variance: no noise that hides
/// the one shows the difference.
const ONE: f64 = 0.995;

/// How an error motion shows: what each reading gains, row by row, for each mm or rad of it.
pub struct Lever {
    motion: usize,
    gains: Signal,
}

/// The levers of all motions that show.
pub fn levers(base: &Base) -> Vec<Lever> {
    let of = |motion: usize| {
        let step = vec![STEP; base.recording.time.len()];
        let shown = base.shown(motion, &step)?;
        let gains: Signal =
            shown.iter().map(|column| column.iter().map(|gain| gain / STEP).collect()).collect();
        let seen = gains.iter().flatten().any(|gain| gain.abs() > SEEN);
        seen.then_some(Lever { motion, gains })
    };
    (0..base.names.motions.len()).filter_map(of).collect()
}

/// So small that bodies turn in proportion to it, mm or rad.
const STEP: f64 = 1e-3;

/// All that a recording could show, by axes, then kinds, then motions.
pub fn subjects(base: &Base, seed: u64) -> Vec<Subject> {
    let levers = levers(base);
    let mut all = Vec::new();
    for axis in 0..base.names.axes.len() {
        for kind in Kind::ALL {
            let motions = motions(base, &levers, axis, kind);
            all.extend(grouped(base, &motions, (axis, kind), seed));
        }
    }
    all
}

/// The levers of the motions of an axis that may have a kind, the axis's own first.
fn motions<'l>(base: &Base, levers: &'l [Lever], axis: usize, kind: Kind) -> Vec<&'l Lever> {
    let letter = &base.names.axes[axis].letter;
    let is_own = |motion: usize| base.names.own_axis(&base.names.motions[motion]) == Some(axis);
    let is_alignment = |motion: usize| base.compiled.equations.motions[motion].alignment;
    let may = |lever: &&Lever| {
        let motion = lever.motion;
        if base.names.motions[motion].axis.as_ref() != Some(letter) {
            return false;
        }
        match kind.term() {
            TermKind::Constant => is_alignment(motion) && base.outside(),
            TermKind::Coupling => is_own(motion) && base.outside(),
            _ if is_alignment(motion) => false,
            _ if kind.is_of_any_motion() => is_own(motion) || base.outside(),
            _ => is_own(motion),
        }
    };
    let mut motions: Vec<&Lever> = levers.iter().filter(may).collect();
    motions.sort_by_key(|lever| !is_own(lever.motion));
    motions
}

/// A kind in several motions: those in which it shows alike under the first of them.
fn grouped(base: &Base, motions: &[&Lever], (axis, kind): (usize, Kind), seed: u64) -> Vec<Subject> {
    let mut found: Vec<(Subject, Vec<f64>)> = Vec::new();
    for lever in motions {
        let Some(allowed) = drawn(base, (lever.motion, axis, kind), seed, 0) else { continue };
        let Some(shown) = shown(base, lever, &allowed) else { continue };
        match found.iter_mut().find(|(_, known)| correlation(known, &shown).abs() > ONE) {
            Some((subject, _)) => subject.alike.push(lever.motion),
            None => found.push((Subject { motion: lever.motion, axis, kind, alike: Vec::new() }, shown)),
        }
    }
    found.into_iter().map(|(subject, _)| subject).collect()
}

/// What an effect shows in all readings, each less its free zero; nothing where that is nothing.
fn shown(base: &Base, lever: &Lever, allowed: &Allowed) -> Option<Vec<f64>> {
    let values = allowed.effect.values(&base.path)?;
    let flat = vec![0.0; values.len()];
    let column = |gains: &Vec<f64>| {
        let column: Vec<f64> = gains.iter().zip(&values).map(|(gain, value)| gain * value).collect();
        straightened(&column, &flat)
    };
    let shown: Vec<f64> = lever.gains.iter().flat_map(column).collect();
    (rms(&shown) > SEEN * SEEN * rms(&straightened(&values, &flat)) && rms(&shown) > 0.0).then_some(shown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::passes_of_x;

    #[test]
    fn a_slide_read_along_itself_shows_its_own_motion() {
        let base = passes_of_x("FX", [true, false, false], 1e-4, 1);
        let subjects = subjects(&base, 1);
        let motions: Vec<&str> =
            subjects.iter().map(|subject| base.names.motions[subject.motion].name.as_str()).collect();
        assert!(motions.iter().all(|name| *name == "EXX"), "{motions:?}");
        let kinds: Vec<&str> = subjects.iter().map(|subject| subject.kind.name()).collect();
        assert!(kinds.contains(&"backlash") && kinds.contains(&"polynomial"), "{kinds:?}");
        // No sensor, no load, no second axis.
        for kind in ["growth", "expansion", "compliance", "coupling", "constant"] {
            assert!(!kinds.contains(&kind), "{kind}");
        }
    }

    /// The tool is 100 mm long: a pitch of X moves the tip along X too. With one height the two show alike and are one subject.
    #[test]
    fn motions_that_show_alike_are_asked_once() {
        let base = passes_of_x("FX", [true, false, false], 1e-4, 1);
        let subjects = subjects(&base, 1);
        let plays: Vec<&Subject> =
            subjects.iter().filter(|subject| subject.kind == Kind::Term(TermKind::Backlash)).collect();
        let [own] = plays.as_slice() else { panic!("{plays:?}") };
        let alike: Vec<&str> =
            own.alike.iter().map(|motion| base.names.motions[*motion].name.as_str()).collect();
        assert!(alike.contains(&"EBX"), "{alike:?}");
    }

    #[test]
    fn one_draw_is_one_effect_in_whatever_motion() {
        let base = passes_of_x("FX", [true, true, false], 1e-4, 1);
        let own = base.names.motion("EXX").unwrap();
        let across = base.names.motion("EYX").unwrap();
        let wave = |motion: usize, trial: usize| {
            let subject = Subject { motion, axis: 0, kind: Kind::Term(TermKind::Cyclic), alike: Vec::new() };
            subject.drawn(&base, 7, trial).unwrap().effect
        };
        assert_eq!(wave(own, 3), wave(across, 3));
        assert_ne!(wave(own, 3), wave(own, 4));
    }
}
