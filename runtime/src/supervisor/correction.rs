//! The correction on its way to the one that is wanted.
//!
//! In: the correction wanted in each cycle, and whether it may be made. Out: the correction made, which follows it without
//! a jump. It exists because every switch is the same problem: what is made and what is wanted differ from one cycle to
//! the next, and the difference has to go away slowly.

use super::super::math::sqrt;
use super::super::real::{Lost, NOTHING, Real, add, onward};
use super::super::{Limits, Share};
use super::Transition;

/// The correction of one axis, remembered from cycle to cycle. The default is that of a machine just started.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct AxisMemory {
    /// Correction made in the last cycle: command less position, in mm or rad.
    made: Real,
    /// What it has lost on its way by rounding.
    lost: Lost,
    /// Correction wanted in this cycle.
    wanted: Real,
    /// Made less wanted at the last switch.
    offset: Real,
    /// Whether it is a rotary axis that corrects its own angle, or the direction of the tool.
    turns: bool,
}

impl AxisMemory {
    /// The correction made in the last cycle: command less position, in mm or rad.
    #[must_use]
    pub const fn made(&self) -> Real {
        self.made
    }
}

/// The correction of all axes.
#[derive(Debug)]
pub(super) struct Correction<'a> {
    axes: &'a mut [AxisMemory],
    /// The motors, by the axes that they follow.
    following: &'a [Share],
    /// Whether the correction of the last cycle was that of the compensator.
    active: bool,
    /// Whether the next cycle begins a transition.
    switched: bool,
    /// The part of the offset that is left, from 1 at a switch to 0.
    left: Real,
}

impl<'a> Correction<'a> {
    /// The correction that the memory holds, on its way to whatever is wanted first.
    pub(super) fn new(
        axes: &'a mut [AxisMemory],
        following: &'a [Share],
        turns: impl Fn(usize) -> bool,
    ) -> Self {
        for (number, axis) in axes.iter_mut().enumerate() {
            axis.turns = turns(number);
            if !axis.made.is_finite() {
                axis.made = 0.0;
            }
        }
        Self { axes, following, active: false, switched: true, left: 0.0 }
    }

    /// What is remembered of each axis.
    pub(super) const fn axes(&self) -> &[AxisMemory] {
        self.axes
    }

    /// Lets the next cycle begin a transition.
    pub(super) const fn switch(&mut self) {
        self.switched = true;
    }

    /// Length over all slides of the correction made, mm.
    pub(super) fn length(&self) -> Real {
        self.size(|axis| axis.made).slides
    }

    /// The size of a number over all axes. Of a motor counts what it has beside the axes that it follows, which count themselves.
    fn size(&self, of: impl Fn(&AxisMemory) -> Real) -> Size {
        let root = |turns: bool| {
            let mut sum = 0.0;
            for (number, axis) in self.axes.iter().enumerate().filter(|(_, axis)| axis.turns == turns) {
                let part = of(axis) - self.followed(number, &of);
                sum += part * part;
            }
            sqrt(sum)
        };
        Size { slides: root(false), turns: root(true) }
    }

    /// The part of a number of a motor that it has from the axes that it follows; 0 of an axis.
    fn followed(&self, axis: usize, of: &impl Fn(&AxisMemory) -> Real) -> Real {
        let own = self.following.iter().filter(|share| share.motor == axis);
        own.fold(0.0, |sum, share| sum + share.weight * self.axes.get(share.of).map_or(0.0, of))
    }

    /// Takes what is wanted now: the compensator's commands less the positions where its correction is active, and else
    /// nothing.
    pub(super) fn set_wanted(&mut self, positions: &[Real], commands: &[Real], active: bool) {
        for ((axis, &position), &command) in self.axes.iter_mut().zip(positions).zip(commands) {
            axis.wanted = if active { command - position } else { 0.0 };
        }
        self.switched |= active != self.active;
        self.active = active;
    }

    /// Takes the correction made one step further, and tells whether it is still on its way.
    pub(super) fn follow(&mut self, transition: &Transition, limits: &Limits, time_step: Real) -> bool {
        if self.switched {
            self.switched = false;
            self.left = 1.0;
            for axis in &mut *self.axes {
                axis.offset = axis.made - axis.wanted;
            }
        }
        let left = if transition.fade > 0.0 { onward(self.left, -time_step / transition.fade) } else { 0.0 };
        let fading = left > NOTHING;
        self.left = if fading { left } else { 0.0 };
        let within = if fading { self.within(limits) } else { 1.0 };
        let left = self.left;
        let next = |axis: &AxisMemory| within * (axis.wanted + left * axis.offset);
        let change = self.size(|axis| next(axis) - axis.made);
        let part = part_of_change(change.slides, transition.rate, time_step);
        let part = part.min(part_of_change(change.turns, transition.rotation_rate, time_step));
        for axis in &mut *self.axes {
            let next = next(axis);
            axis.made = if part < 1.0 {
                add(axis.made, &mut axis.lost, part * (next - axis.made))
            } else {
                axis.lost = Lost::default();
                next
            };
        }
        fading || part < 1.0
    }

    /// The factor that keeps a fading correction within its limits, or within what is made already where that is more.
    fn within(&self, limits: &Limits) -> Real {
        let left = self.left;
        let next = self.size(|axis| axis.wanted + left * axis.offset);
        let made = self.size(|axis| axis.made);
        let slides = within(next.slides, limits.compensation, made.slides);
        slides.min(within(next.turns, limits.rotation, made.turns))
    }

    /// Writes the commands, where they are not those of the compensator already.
    pub(super) fn write(&self, positions: &[Real], commands: &mut [Real], differs: bool) {
        if differs {
            for ((axis, &position), command) in self.axes.iter().zip(positions).zip(commands) {
                *command = position + axis.made;
            }
        }
    }
}

/// The part of a change that the rate lets pass in this cycle.
fn part_of_change(change: Real, rate: Option<Real>, time_step: Real) -> Real {
    let Some(rate) = rate else { return 1.0 };
    let most = rate * time_step;
    if change <= most * (1.0 + NOTHING) {
        return 1.0;
    }
    // A rate that is no number lets nothing pass.
    let part = most / change;
    if part > 0.0 { part } else { 0.0 }
}

/// How large something is over all slides, in mm, and over all rotary axes that correct themselves, in rad.
#[derive(Clone, Copy)]
struct Size {
    slides: Real,
    turns: Real,
}

/// The factor that keeps what comes next within a limit, or within what is made already.
fn within(next: Real, limit: Option<Real>, made: Real) -> Real {
    let most = limit.map_or(Real::INFINITY, |limit| made.max(limit));
    if next > most { most / next } else { 1.0 }
}
