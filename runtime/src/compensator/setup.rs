//! The checks that a compensator makes once.
//!
//! In: the equations, the error motions and the storage of a caller. Out: the sensors needed and whether velocities are, or
//! the first mistake. It exists so that the cycle itself has nothing left that can fail for a wrong set-up.

use super::super::{ErrorMotion, Kinematics, Term, TermState};
use super::turns::Turns;
use super::{SetupError, Work};
use super::{motors, tilts};

/// What the terms need of every sample.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Needs {
    /// The least number of temperatures.
    pub(super) sensors: usize,
    /// The least number of velocities: one for each axis where a term reads them, or else none.
    pub(super) velocities: usize,
    /// Whether the correction of a term is spread over time.
    pub(super) ramp: bool,
    /// Whether a term remembers anything from cycle to cycle.
    pub(super) memory: bool,
    /// The angles that rotary axes correct themselves.
    pub(super) turns: Turns,
}

/// The number of term states that a set of error motions needs: one for each term.
#[must_use]
pub const fn states_needed(motions: &[ErrorMotion<'_>]) -> usize {
    let mut rest = motions;
    let mut count = 0_usize;
    while let [first, others @ ..] = rest {
        count = count.saturating_add(first.terms.len());
        rest = others;
    }
    count
}

/// Checks every length, every axis and every parameter.
pub(super) fn check<K: Kinematics + ?Sized>(
    kinematics: &K,
    motions: &[ErrorMotion<'_>],
    states: &[TermState],
    work: &Work<'_>,
) -> Result<Needs, SetupError> {
    let axes = kinematics.axes();
    let travels = kinematics.travels();
    for (slice, expected, found) in [
        ("motions", kinematics.motions(), motions.len()),
        ("states", states_needed(motions), states.len()),
        ("work.directions", axes, work.directions.len()),
        ("work.motions", kinematics.motions(), work.motions.len()),
        ("work.travel", travels.len(), work.travel.len()),
    ] {
        if expected != found {
            return Err(SetupError::Length { slice, expected, found });
        }
    }
    if let Some((travel, &axis)) = travels.iter().enumerate().find(|(_, axis)| **axis >= axes) {
        return Err(SetupError::TravelAxis { travel, axis });
    }
    motors::check_shares(kinematics)?;
    let needs = check_terms(motions, axes)?;
    let turns = Turns::new(kinematics, motions)?;
    check_aiming(kinematics)?;
    Ok(Needs { turns, ..needs })
}

/// Checks that each axis that corrects the direction of the tool is one of the machine, and that they are with those that correct their own
/// angles no more than there are rotary axes.
fn check_aiming<K: Kinematics + ?Sized>(kinematics: &K) -> Result<(), SetupError> {
    let own = kinematics.turning();
    // Those of one axis stand together. `chunk_by` would say it in a word, and keeps a way to panic.
    let before = [None].into_iter().chain(own.iter().map(|turning| Some(turning.axis)));
    let mut turned = own.iter().zip(before).filter(|(turning, before)| Some(turning.axis) != *before).count();
    if turned > tilts::AXES {
        return Err(SetupError::Turning { turning: own.len().saturating_sub(1) });
    }
    for (number, &axis) in kinematics.aiming().iter().enumerate() {
        let before = kinematics.aiming().iter().take(number);
        let known = kinematics.turning().iter().any(|turning| turning.axis == axis);
        turned = turned.saturating_add(usize::from(!known));
        if axis >= kinematics.axes() || before.clone().any(|other| *other >= axis) || turned > tilts::AXES {
            return Err(SetupError::Aiming { aiming: number });
        }
    }
    Ok(())
}

/// Checks the terms of all error motions and gathers what they need.
fn check_terms(motions: &[ErrorMotion<'_>], axes: usize) -> Result<Needs, SetupError> {
    let mut needs = Needs::default();
    for (motion, terms) in motions.iter().map(|motion| motion.terms).enumerate() {
        for (term, given) in terms.iter().enumerate() {
            if let Some(axis) = given.axis().filter(|axis| *axis >= axes) {
                return Err(SetupError::TermAxis { motion, term, axis });
            }
            if let Some(parameter) = given.bad_parameter() {
                return Err(SetupError::Parameter { motion, term, parameter });
            }
            let sensors = given.sensor().map_or(0, |sensor| sensor.saturating_add(1));
            needs.sensors = needs.sensors.max(sensors);
            if given.reads_velocity() {
                needs.velocities = axes;
            }
            needs.ramp |= given.is_ramped();
            needs.memory |= given.remembers();
        }
        // A factor has nothing of its own to add.
        if terms.last().is_some_and(Term::is_factor) {
            return Err(SetupError::LoneFactor { motion, term: terms.len().saturating_sub(1) });
        }
    }
    Ok(needs)
}
