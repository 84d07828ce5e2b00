//! What terms remember from cycle to cycle.
//!
//! In: the sample of a cycle and the memory of the cycle before. Out: the memory of this one, and what is read from it. It
//! exists because a play, a filter and a ramp depend on where the machine has been; the value of a term may then be asked
//! at as many positions as the inverse needs, while its memory goes on once a cycle.

use super::super::Sample;
use super::super::math::exp_m1;
use super::super::real::{Lost, Real, add, onward};
use super::super::sample::{OneSample, number};

/// What a term remembers from cycle to cycle: the take-up of a play, the filtered temperature of a growth, the warmth that a
/// factor has gathered, how far the correction of a reversal has come.
///
/// Every term has one, in the order of the terms; most never touch it. The default is that of a machine just started.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct TermState {
    /// Take-up u within [-1, 1], filtered temperature in degC or warmth in K; none before the first cycle.
    memory: Option<Real>,
    /// Position of the axis in the cycle before, in mm or rad.
    last: Real,
    /// The take-up that is corrected, within [-1, 1], where a ramp spreads the correction; none before the first cycle.
    followed: Option<Real>,
    /// What the memory has lost by rounding.
    lost: Lost,
}

impl TermState {
    /// Take-up u within [-1, 1], filtered temperature in degC or warmth in K; none before the first cycle.
    #[inline]
    pub(crate) const fn remembered(&self) -> Option<&Real> {
        self.memory.as_ref()
    }
}

/// The take-up of a play: the direction itself, or where there is a wind-up the u of the play operator.
pub(super) fn take_up(from: &OneSample<'_>, axis: usize, wind_up: Real, memory: Option<&Real>) -> Real {
    let direction = from.sign(axis);
    if wind_up > 0.0 { memory.copied().unwrap_or(direction) } else { direction }
}

/// The play operator: u follows the position by 2 dq / w and stops at -1 and +1. It starts taken up in the direction
/// of the first sample.
pub(super) fn advance_play(sample: &Sample<'_>, axis: usize, wind_up: Real, state: &mut TermState) {
    let position = sample.position(axis);
    let Some(direction) = sample.direction(axis) else { return };
    if !position.is_finite() {
        return;
    }
    let moved = state.memory.map(|u| add(u, &mut state.lost, 2.0 * (position - state.last) / wind_up));
    state.memory = Some(moved.unwrap_or(direction.sign()).clamp(-1.0, 1.0));
    state.last = position;
}

/// The take-up that is corrected; before the first cycle the present one.
pub(super) fn followed(state: &TermState, take_up: Real) -> Real {
    state.followed.unwrap_or(take_up)
}

/// Lets the corrected take-up follow the present one, by no more than 2 dt / ramp.
pub(super) fn follow(take_up: Real, time_step: Real, ramp: Real, state: &mut TermState) {
    if !take_up.is_finite() || !time_step.is_finite() {
        return;
    }
    let before = followed(state, take_up);
    let (way, most) = (take_up - before, 2.0 * time_step.max(0.0) / ramp);
    // The end is taken as it is: a sum would miss it by rounding.
    let after = if way.abs() <= most { take_up } else { onward(before, most.copysign(way)) };
    state.followed = Some(after);
}

/// The filter T* += (T - T*) (1 - exp(-dt / tau)): exact for a temperature that holds through the step.
pub(crate) fn advance_filter(sample: &Sample<'_>, sensor: usize, time_constant: Real, state: &mut TermState) {
    let now = sample.temperature(sensor);
    if !now.is_finite() || !sample.time_step.is_finite() {
        return;
    }
    let before = state.memory.unwrap_or(now);
    let share = -exp_m1(-sample.time_step.max(0.0) / time_constant);
    state.memory = Some(add(before, &mut state.lost, (now - before) * share));
}

/// The play of a sensor: the memory follows its temperature, but stays up to half a width behind it. It starts at the first
/// temperature.
pub(crate) fn advance_width(sample: &Sample<'_>, sensor: usize, width: Real, state: &mut TermState) {
    let now = sample.temperature(sensor);
    if !now.is_finite() {
        return;
    }
    let before = state.memory.unwrap_or(now);
    state.memory = Some(before.max(now - 0.5 * width).min(now + 0.5 * width));
}

/// The warmth that a speed makes: `W += (rise |v| - W) (1 - exp(-dt / tau))` from zero, exact for a speed that holds through
/// the step.
pub(crate) fn advance_warmth(
    sample: &Sample<'_>,
    axis: usize,
    time_constant: Real,
    rise: Real,
    state: &mut TermState,
) {
    let lasting = rise * number(sample.velocity, axis).abs();
    if !lasting.is_finite() || !sample.time_step.is_finite() {
        return;
    }
    let before = state.memory.unwrap_or(0.0);
    let share = -exp_m1(-sample.time_step.max(0.0) / time_constant);
    state.memory = Some(add(before, &mut state.lost, (lasting - before) * share));
}
