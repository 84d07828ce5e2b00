//! The search for the commands that put the tip of the tool where it was wanted, and turn the tool the way that was wanted.
//!
//! In: a machine whose rotary axes correct the direction of the tool, its error motions, and the state in one cycle. Out: the commands of
//! all axes, and what stays of both errors. It exists apart from the search for the slides alone, which all other machines go through: here
//! a rotary axis stands elsewhere than it was asked to, and takes the tip along.

use super::super::math::{add_scaled, all_finite, dot, sqrt};
use super::super::real::Real;
use super::super::{ErrorMotions, Kinematics, Sample};
use super::inverse::{Columns, Reach};
use super::known::Known;
use super::prediction::Prediction;
use super::report::{self, DirectionOutcome};
use super::seen::{Part, Posed};
use super::tilts::{AXES, Tilts};
use super::{Compensator, Convergence, Limits, Outcome, Refusal, copy};

/// So many times as many steps as the slides alone may take. Their search leaves less than a thousandth of the way with each step. In front
/// of the pose in which an axis turns the direction nowhere, axes turn up to a hundred times as far as the errors, and slides follow: a
/// step leaves more of the way. With 20 steps one of some hundred random machines was refused with 2e-5 mm to go, with 60 none of 6000.
const SLOWER: u32 = 3;

/// Tip and direction of the tool without errors at the position of the sample, and what turns the direction there.
struct Target {
    tip: [Real; 3],
    direction: [Real; 3],
    tilts: Tilts,
}

/// A pose of the rotary axes.
struct Pose {
    /// What it moves the tip by without errors, the slides at their targets: mm.
    tip: [Real; 3],
    /// What it turns the direction by without errors, rad.
    direction: [Real; 3],
    /// What the slides reach in it.
    reach: Reach,
}

/// What the rotary axes are to do, and what is left to the slides.
#[derive(Clone, Copy)]
struct Step {
    /// What the aiming axes turn by, rad.
    angles: [Real; AXES],
    /// Where they stand then, and at which commands.
    posed: Posed,
    /// How far they turn to correct their own angles, over all of them: rad.
    own: Real,
    /// Error of the tip in the pose before, with all slides at their targets: mm.
    tip: [Real; 3],
    /// `A^+` of it, of which each slide has its share.
    pull: [Real; 3],
    /// Error of the direction that stays, rad.
    lean: [Real; 3],
}

/// The squares of how far a step went: over the rotary axes, and over the slides.
#[derive(Clone, Copy)]
struct Gone {
    turned: Real,
    moved: Real,
}

impl<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized> Compensator<'_, K, M> {
    /// The rest of a cycle that has begun with this error of the tip, on a machine whose rotary axes correct the direction of the tool.
    #[inline(never)]
    pub(super) fn cycle_aimed(
        &mut self,
        sample: &Sample<'_>,
        error: [Real; 3],
        out: &mut [Real],
    ) -> Result<Outcome, Refusal> {
        let lean = self.prediction.lean(sample)?;
        if !self.enabled {
            copy(sample.position, out);
            self.direction = Some(DirectionOutcome { error: lean, remaining: lean });
            return Ok(Outcome { error, remaining: error, iterations: 0 });
        }
        let (step, remaining, iterations) = self.search_aimed(sample, out)?;
        self.direction = Some(DirectionOutcome { error: lean, remaining: step.lean });
        Ok(Outcome { error, remaining, iterations })
    }

    /// The search, and the limits; gives also the error of the tip that stays, and the number of steps.
    fn search_aimed(
        &mut self,
        sample: &Sample<'_>,
        out: &mut [Real],
    ) -> Result<(Step, [Real; 3], u32), Refusal> {
        let target = Target::at(self.prediction.kinematics, sample.position);
        let mut step = Step::first(self.prediction.kinematics.aiming(), sample);
        let mut gone = Gone { turned: Real::INFINITY, moved: Real::INFINITY };
        let most = self.convergence.iterations.saturating_mul(SLOWER);
        let mut iterations = 0_u32;
        while iterations < most {
            iterations = iterations.saturating_add(1);
            let pose = self.pose(sample, &target, &step, out)?;
            let columns = self.prediction.kinematics.columns(self.directions);
            let from = (sample, &target, &self.convergence, &self.limits);
            let next = pose.next(&mut self.prediction, from, columns, &step, out)?;
            gone = step.until(&next, &pose.reach, self.prediction.motors_moved(), out);
            gone.check(iterations)?;
            columns.correct(sample.position, next.pull, out);
            next.posed.commands.write(out);
            self.prediction.let_motors_follow(sample.position, out);
            step = next;
            if gone.is_settled(&self.convergence) {
                // What they turn for the direction is cut to what is left of the limit.
                self.limits.check_rotation(step.own)?;
                let by_motors = self.prediction.by_motors_squared();
                self.limits.check(|| sqrt(pose.reach.distance_squared(step.tip) + by_motors))?;
                let step = step.behind_ramp(&mut self.prediction, sample, out)?;
                let remaining = add_scaled(step.tip, -1.0, pose.reach.tip(columns, step.pull));
                return Ok((step, remaining, iterations));
            }
        }
        Err(gone.not_settled(iterations, &self.convergence))
    }

    /// What the slides reach where the rotary axes are turned to.
    fn reach_turned(&mut self, position: &[Real]) -> Result<Reach, Refusal> {
        let Prediction { kinematics, sines, .. } = &self.prediction;
        kinematics.directions_with(sines, position, self.directions);
        if !all_finite(self.directions.as_flattened()) {
            return Err(Refusal::NotFinite);
        }
        Ok(kinematics.squares().map_or_else(|| Reach::new(self.directions), Reach::straight))
    }

    /// The pose of the rotary axes after a step; leaves in `out` the commands of that step, with the shares of the
    /// slides as this pose has them.
    fn pose(
        &mut self,
        sample: &Sample<'_>,
        target: &Target,
        step: &Step,
        out: &mut [Real],
    ) -> Result<Pose, Refusal> {
        copy(sample.position, out);
        step.posed.stands.write(out);
        let kinematics = self.prediction.kinematics;
        kinematics.turn(out, &mut self.prediction.sines);
        let reach = self.reach_turned(out)?;
        let tip = add_scaled(kinematics.nominal(out), -1.0, target.tip);
        let direction = add_scaled(kinematics.direction(out), -1.0, target.direction);
        kinematics.columns(self.directions).correct(sample.position, step.pull, out);
        step.posed.commands.write(out);
        self.prediction.let_motors_follow(sample.position, out);
        Ok(Pose { tip, direction, reach })
    }
}

impl Target {
    fn at<K: Kinematics + ?Sized>(kinematics: &K, position: &[Real]) -> Self {
        Self {
            tip: kinematics.nominal(position),
            direction: kinematics.direction(position),
            tilts: Tilts::at(kinematics, position),
        }
    }
}

impl Pose {
    /// The step that undoes the errors at the commands of the one before, which `out` holds.
    fn next<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized>(
        &self,
        prediction: &mut Prediction<'_, K, M>,
        (sample, target, convergence, limits): (&Sample<'_>, &Target, &Convergence, &Limits),
        columns: Columns<'_>,
        step: &Step,
        out: &mut [Real],
    ) -> Result<Step, Refusal> {
        let seen = prediction.seen(sample, &step.posed, Part::Corrected, out)?;
        let tip = add_scaled(seen.tip, 1.0, self.tip);
        if self.reach.may_amplify() {
            report::check_amplification(self.reach.moved_and_corrected(columns, tip))?;
        }
        // Without what the axes were turned by on purpose: the angles are found from the targets on, so that in front of a singular pose
        // step after step does not add up to more than the axes may turn.
        let made = target.tilts.turned(step.angles);
        let whole = add_scaled(add_scaled(seen.lean, 1.0, self.direction), -1.0, made);
        // What the own angles take is no room for others.
        let own = seen.own.length();
        let most = limits.rotation.map_or(Real::INFINITY, |limit| (limit - own).max(0.0));
        let found = target.tilts.angles(whole, most).map(|angle| -angle);
        let angles = convergence.kept(step.angles, found);
        let posed = Posed::turned(prediction.kinematics.aiming(), angles, sample);
        Ok(Step {
            angles,
            posed: posed.with_own(&seen.own, sample),
            own,
            tip,
            pull: self.reach.apply(tip),
            lean: add_scaled(whole, 1.0, target.tilts.turned(angles)),
        })
    }
}

impl Step {
    /// All axes at their targets.
    fn first(aiming: &[usize], sample: &Sample<'_>) -> Self {
        let (angles, zero) = ([0.0; AXES], [0.0; 3]);
        let posed = Posed::turned(aiming, angles, sample);
        Self { angles, posed, own: 0.0, tip: zero, pull: zero, lean: zero }
    }

    /// How far it is to the next one, `by_motors` of it by what motors correct themselves, mm^2, `out` holding the commands of this one.
    fn until(&self, next: &Self, reach: &Reach, by_motors: Real, out: &[Real]) -> Gone {
        // Not from the commands of the slides, which far from the origin are too coarse to tell when it ends.
        let moved = reach.distance_squared(add_scaled(next.tip, -1.0, self.tip)) + by_motors;
        Gone { turned: next.posed.commands.step_squared(out), moved }
    }

    /// The same with the errors that stay where a part of them is corrected in later cycles.
    fn behind_ramp<K: Kinematics + ?Sized, M: ErrorMotions + ?Sized>(
        self,
        prediction: &mut Prediction<'_, K, M>,
        sample: &Sample<'_>,
        out: &mut [Real],
    ) -> Result<Self, Refusal> {
        if !prediction.needs.ramp {
            return Ok(self);
        }
        let made = prediction.seen(sample, &self.posed, Part::Corrected, out)?;
        let left = prediction.seen(sample, &self.posed, Part::Left, out)?;
        let beyond = |error, left, made| add_scaled(error, 1.0, add_scaled(left, -1.0, made));
        let step = Self {
            tip: beyond(self.tip, left.tip, made.tip),
            lean: beyond(self.lean, left.lean, made.lean),
            ..self
        };
        if all_finite(&step.tip) && all_finite(&step.lean) { Ok(step) } else { Err(Refusal::NotFinite) }
    }
}

impl Convergence {
    /// The angles found, or those of the step before where they are the same but for less than counts: what rounding changes of an angle
    /// moves the tip, far from the axis, by more than the slides are to settle to.
    fn kept(&self, before: [Real; AXES], found: [Real; AXES]) -> [Real; AXES] {
        let change = add_scaled(found, -1.0, before);
        if dot(change, change) <= self.tolerance_squared() { before } else { found }
    }
}

impl Gone {
    /// Refuses a search that has gone out of all bounds.
    fn check(self, iterations: u32) -> Result<(), Refusal> {
        if !self.turned.is_finite() {
            return Err(Refusal::NotFinite);
        }
        let finite = self.moved < Real::INFINITY;
        if finite { Ok(()) } else { Err(Refusal::NotConverging { iterations, distance: Real::INFINITY }) }
    }

    fn is_settled(self, convergence: &Convergence) -> bool {
        let bound = convergence.tolerance_squared();
        self.turned <= bound && self.moved <= bound
    }

    /// Why a search is given up.
    fn not_settled(self, iterations: u32, convergence: &Convergence) -> Refusal {
        if self.turned <= convergence.tolerance_squared() {
            Refusal::NotConverging { iterations, distance: sqrt(self.moved) }
        } else {
            Refusal::AngleNotConverging { iterations, angle: sqrt(self.turned) }
        }
    }
}
