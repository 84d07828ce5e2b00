//! How a part lay on the machine that measured it.
//!
//! In: what was read of a part, each reading beside the place at which it is expected. Out: a [`PartPose`]: the rotation of the part that
//! brings the one to the other, and about which axes the readings show a rotation at all; or, of a part whose recording says nothing,
//! whether they show one. It exists because a part that is clamped anew stands at an angle that says nothing of the
//! machine it was made on.
//!
//! The rotation is exact, and not of first order: half a degree over 300 mm makes 11 um of second order.

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

/// What a recording says of how the part lies where it is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PartDatum {
    /// Nothing.
    #[default]
    Unsaid,
    /// As its frame says (`datum: fixed`): it stayed clamped as it was made.
    Fixed,
    /// With a displacement and a rotation of its own (`datum: free`): it was clamped anew.
    Free,
}

/// One reading of a part: mm, part frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartReading {
    /// The direction of the reading, a unit vector.
    pub direction: [f64; 3],
    /// Where the point is expected of a part that lies as its frame says.
    pub place: [f64; 3],
    /// How much farther along the direction it was read.
    pub deviation: f64,
}

/// How a part lay: it is turned about its middle, right-handed, against what its frame says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPose {
    /// The middle of all places, mm.
    middle: Vector3<f64>,
    /// The rotation.
    rotation: UnitQuaternion<f64>,
    /// Along which of X, Y, Z the readings show a displacement that is no constant of them all.
    pub displacements: [bool; 3],
    /// About which of X, Y, Z the readings show a rotation that is no displacement.
    pub rotations: [bool; 3],
}

/// A rotation that explains what was read of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turned {
    /// What it is about: `X`, `Y` or `Z`.
    pub about: &'static str,
    /// The angle, right-handed, rad.
    pub angle: f64,
    /// The share of the squares that it takes from what a displacement leaves.
    pub share: f64,
}

/// A constant, three displacements, three rotations: what is free in the readings of a part.
const FREEDOMS: usize = 7;

/// The first of the displacements, and the first of the rotations.
const DISPLACEMENTS: usize = 1;
const ROTATIONS: usize = 4;

/// A rotation is seen from lever arms of this share of the part's size on, root mean square. Of a flatter part, holes of unlike depth, the
/// readings would let the angle grow so large that what it does to the sides of the part shows before its levers do. A displacement is
/// seen from directions on that lean so much.
const SEEN: f64 = 0.01;

/// The most steps to the rotation. Each step squares the angle that is left.
const STEPS: usize = 30;

/// A step by a smaller angle ends them, rad: it moves a metre by 0.1 nm, and what is left after it is its square.
const DONE: f64 = 1e-10;

impl PartDatum {
    /// Free, or nothing said.
    #[must_use]
    pub fn free_where(is_free: bool) -> Self {
        if is_free { Self::Free } else { Self::Unsaid }
    }
}

impl PartPose {
    /// How a part lay of which these are the readings. `constant` says whether a constant of all readings is free besides, as the zero
    /// of a probe is. Readings that are not finite are none.
    #[must_use]
    pub fn of(readings: &[PartReading], constant: bool) -> Self {
        let known = || readings.iter().filter(|reading| reading.is_known());
        let count = known().count().max(1);
        let sum: Vector3<f64> = known().map(|reading| Vector3::from(reading.place)).sum();
        let mut pose = Self {
            middle: sum / number(count),
            rotation: UnitQuaternion::identity(),
            displacements: [false; 3],
            rotations: [false; 3],
        };
        let free = pose.seen(readings, constant);
        pose.displacements = [0, 1, 2].map(|axis| free.contains(&(DISPLACEMENTS + axis)));
        pose.rotations = [0, 1, 2].map(|axis| free.contains(&(ROTATIONS + axis)));
        pose.turn_to(readings, &free);
        pose
    }

    /// The rotation vector, rad.
    #[must_use]
    pub fn rotation(&self) -> [f64; 3] {
        self.rotation.scaled_axis().into()
    }

    /// The rotation vector after another small rotation, rad.
    #[must_use]
    pub fn rotation_after(&self, more: [f64; 3]) -> [f64; 3] {
        (UnitQuaternion::from_scaled_axis(Vector3::from(more)) * self.rotation).scaled_axis().into()
    }

    /// Where the part's own place is found, mm.
    #[must_use]
    pub fn moved(&self, place: [f64; 3]) -> [f64; 3] {
        (self.middle + self.arm(place)).into()
    }

    /// The direction in the part that is read along this one.
    #[must_use]
    pub fn back(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.inverse_transform_vector(&Vector3::from(direction)).into()
    }

    /// By how much a reading along a direction rises with each radian more about X, Y and Z, mm.
    #[must_use]
    pub fn levers(&self, direction: [f64; 3], place: [f64; 3]) -> [f64; 3] {
        // n . (a x r) = a . (r x n)
        self.arm(place).cross(&Vector3::from(direction)).into()
    }

    /// From the middle to where the place is found, mm.
    fn arm(&self, place: [f64; 3]) -> Vector3<f64> {
        self.rotation * (Vector3::from(place) - self.middle)
    }

    /// What each freedom does to a reading.
    fn effects(&self, reading: &PartReading) -> [f64; FREEDOMS] {
        let ([x, y, z], [a, b, c]) = (reading.direction, self.levers(reading.direction, reading.place));
        [1.0, x, y, z, a, b, c]
    }

    /// The freedoms that the readings show, each beside those before it.
    fn seen(&self, readings: &[PartReading], constant: bool) -> Vec<usize> {
        let known: Vec<[f64; FREEDOMS]> = readings
            .iter()
            .filter(|reading| reading.is_known())
            .map(|reading| self.effects(reading))
            .collect();
        let places = readings.iter().filter(|reading| reading.is_known());
        let size = places.map(|reading| self.arm(reading.place).norm()).fold(0.0, f64::max);
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let mut free = Vec::new();
        for freedom in usize::from(!constant)..FREEDOMS {
            let column = known.iter().filter_map(|effects| effects.get(freedom).copied());
            let mut left = DVector::from_iterator(known.len(), column);
            for vector in &basis {
                let part = vector.dot(&left);
                left.axpy(-part, vector, 1.0);
            }
            let unit = if freedom < ROTATIONS { 1.0 } else { size };
            let length = left.norm();
            if length > SEEN * unit * number(known.len()).sqrt() && length > 0.0 {
                basis.push(left / length);
                free.push(freedom);
            }
        }
        free
    }

    /// Turns the part to where the readings have it: least squares by Gauss-Newton steps over all freedoms. Where they lead nowhere the
    /// part stays as its frame says.
    fn turn_to(&mut self, readings: &[PartReading], free: &[usize]) {
        if self.rotations == [false; 3] {
            return;
        }
        let mut turned = *self;
        for _ in 0..STEPS {
            let Some(step) = turned.step(readings, free) else { return };
            turned.rotation = UnitQuaternion::from_scaled_axis(step) * turned.rotation;
            if step.norm() < DONE {
                *self = turned;
                return;
            }
        }
    }

    /// The rotation that the least squares add, rad.
    fn step(&self, readings: &[PartReading], free: &[usize]) -> Option<Vector3<f64>> {
        let mut products = DMatrix::zeros(free.len(), free.len());
        let mut response = DVector::zeros(free.len());
        for reading in readings.iter().filter(|reading| reading.is_known()) {
            let effects = self.effects(reading);
            let column = free.iter().filter_map(|freedom| effects.get(*freedom).copied());
            let column = DVector::from_iterator(free.len(), column);
            let moved = Vector3::from(self.moved(reading.place)) - Vector3::from(reading.place);
            let left = reading.deviation - moved.dot(&Vector3::from(reading.direction));
            response.axpy(left, &column, 1.0);
            products.ger(1.0, &column, &column, 1.0);
        }
        let solution = products.cholesky()?.solve(&response);
        let of_axis = |axis: usize| {
            let place = free.iter().position(|freedom| *freedom == ROTATIONS + axis);
            place.and_then(|place| solution.get(place)).copied().unwrap_or(0.0)
        };
        let step = Vector3::new(of_axis(0), of_axis(1), of_axis(2));
        step.iter().all(|part| part.is_finite()).then_some(step)
    }
}

impl PartReading {
    fn is_known(&self) -> bool {
        self.direction.iter().chain(&self.place).chain([&self.deviation]).all(|number| number.is_finite())
    }
}

/// The fewest readings along each of two directions of which a rotation is told: of fewer, chance makes one too often.
const FEWEST: usize = 6;

/// The deviation of a turn is told from this many stretches of readings, one left out at a time. With fewer it would not be known; with
/// more, a stretch would be shorter than noise that wanders stays on one side.
const STRETCHES: usize = 8;

/// Each side of the part must show a turn of so many deviations, which are known from eight stretches. By chance one side does so in one of
/// fifty cases, and both sides in the same sense in one of 5000.
const SHOWN: f64 = 3.0;

/// The turns of the two sides may differ by this share of their mean, and by twice the deviation of their difference besides. A squareness
/// turns one side alone: its sides differ by twice their mean.
const ALIKE: f64 = 0.25;

/// The way along a direction may explain at most this share of the coordinate across. Round a circle it explains all of it, and a position
/// loop that lags behind turns the circle. Along lines it explains at most 6 %.
const ROUND: f64 = 0.5;

/// The rotation that readings along the directions of the frame show of a part, of several the one that explains most; nothing where they
/// show none. It turns the two sides of a part alike, as no squareness does.
#[must_use]
pub fn turned(readings: &[PartReading]) -> Option<Turned> {
    let planes = [("X", 1, 2), ("Y", 2, 0), ("Z", 0, 1)];
    let found = planes.into_iter().filter_map(|(about, first, second)| {
        let sides = [Side::of(readings, first, second)?, Side::of(readings, second, first)?];
        turned_about(about, &sides)
    });
    found.max_by(|one, other| one.share.total_cmp(&other.share))
}

fn turned_about(about: &'static str, sides: &[Side; 2]) -> Option<Turned> {
    let [one, other] = sides;
    let (turns, deviations) = (Turns::of(one.all, other.all), Deviations::of(sides));
    let angle = weighted(one.all.weight(), turns.turn, other.all.weight(), turns.back);
    let is_shown = turns.turn.abs() > SHOWN * deviations.turn && turns.back.abs() > SHOWN * deviations.back;
    let is_in_one_sense = turns.turn * turns.back > 0.0;
    let is_alike = turns.apart().abs() < ALIKE * angle.abs() + 2.0 * deviations.apart;
    let goes_round = one.way > ROUND && other.way > ROUND;
    let left = one.all.left(-angle) + other.all.left(angle);
    let share = 1.0 - left / (one.all.total() + other.all.total());
    (is_shown && is_in_one_sense && is_alike && !goes_round).then_some(Turned { about, angle, share })
}

/// The mean of two numbers by their weights.
fn weighted(weight: f64, one: f64, other_weight: f64, other: f64) -> f64 {
    (weight * one + other_weight * other) / (weight + other_weight)
}

/// By how much the two sides of a part are turned, rad.
#[derive(Clone, Copy, Debug)]
struct Turns {
    /// The side that is read along the first direction.
    turn: f64,
    /// The side that is read along the second.
    back: f64,
}

impl Turns {
    /// A rotation moves the first direction against the second coordinate.
    fn of(one: Sums, other: Sums) -> Self {
        Self { turn: -one.slope(), back: other.slope() }
    }

    fn apart(&self) -> f64 {
        self.turn - self.back
    }
}

/// The standard deviations of turns, rad.
#[derive(Clone, Copy, Debug)]
struct Deviations {
    turn: f64,
    back: f64,
    /// Of the difference of the two.
    apart: f64,
}

impl Deviations {
    /// By the jackknife over stretches of readings: noise that wanders moves whole stretches.
    fn of(sides: &[Side; 2]) -> Self {
        let [one, other] = sides;
        let stretches = one.stretches.len().max(other.stretches.len());
        let without = |stretch: usize| Turns::of(one.without(stretch), other.without(stretch));
        let all: Vec<Turns> = (0..stretches).map(without).collect();
        Self {
            turn: jackknifed(all.iter().map(|turns| turns.turn)),
            back: jackknifed(all.iter().map(|turns| turns.back)),
            apart: jackknifed(all.iter().map(Turns::apart)),
        }
    }
}

/// The standard deviation of an estimate, from what it is without each of the stretches.
fn jackknifed(estimates: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let count = number(estimates.len());
    let mean = estimates.clone().sum::<f64>() / count;
    let squares: f64 = estimates.map(|estimate| (estimate - mean).powi(2)).sum();
    (squares * (count - 1.0) / count).sqrt()
}

/// What is read along one direction against one coordinate.
struct Side {
    all: Sums,
    stretches: Vec<Sums>,
    /// The share of the coordinate that the way along the direction explains, from the reading before to the one after.
    way: f64,
}

impl Side {
    /// Nothing where readings are few, or where there is no slope to see.
    fn of(readings: &[PartReading], direction: usize, coordinate: usize) -> Option<Self> {
        let is_along = |reading: &&PartReading| reading.direction.get(direction) == Some(&1.0);
        let own: Vec<&PartReading> =
            readings.iter().filter(is_along).filter(|reading| reading.is_known()).collect();
        let pairs =
            own.iter().filter_map(|reading| Some((*reading.place.get(coordinate)?, reading.deviation)));
        let pairs: Vec<(f64, f64)> = pairs.collect();
        let stretches: Vec<Sums> = pairs
            .chunks(pairs.len().div_ceil(STRETCHES).max(1))
            .map(|stretch| Sums::of(stretch, pairs[0]))
            .collect();
        let all = stretches.iter().fold(Sums::default(), |all, stretch| all.plus(*stretch, 1.0));
        let way = way(&own, direction, coordinate);
        (pairs.len() >= FEWEST && all.slope().is_finite()).then_some(Self { all, stretches, way })
    }

    fn without(&self, stretch: usize) -> Sums {
        self.stretches.get(stretch).map_or(self.all, |stretch| self.all.plus(*stretch, -1.0))
    }
}

/// The share of one coordinate that is explained by how far another goes from the reading before to the one after.
fn way(readings: &[&PartReading], direction: usize, coordinate: usize) -> f64 {
    let of = |reading: &PartReading, axis: usize| reading.place.get(axis).copied().unwrap_or(f64::NAN);
    let steps = readings.windows(3).filter_map(|three| {
        let [before, here, after] = three else { return None };
        Some((of(after, direction) - of(before, direction), of(here, coordinate)))
    });
    let steps: Vec<(f64, f64)> = steps.collect();
    let Some(first) = steps.first() else { return 0.0 };
    let sums = Sums::of(&steps, *first);
    1.0 - sums.left(sums.slope()) / sums.total()
}

/// Sums over readings, each of its coordinate and of what was read, both from those of the first reading.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: f64,
    arm: f64,
    read: f64,
    arms: f64,
    reads: f64,
    both: f64,
}

impl Sums {
    fn of(readings: &[(f64, f64)], first: (f64, f64)) -> Self {
        readings.iter().fold(Self::default(), |sums, (place, deviation)| {
            let (arm, read) = (place - first.0, deviation - first.1);
            let one = Self { count: 1.0, arm, read, arms: arm * arm, reads: read * read, both: arm * read };
            sums.plus(one, 1.0)
        })
    }

    /// With those of other readings, `times` times: -1 takes them away.
    fn plus(self, other: Self, times: f64) -> Self {
        Self {
            count: self.count + times * other.count,
            arm: self.arm + times * other.arm,
            read: self.read + times * other.read,
            arms: self.arms + times * other.arms,
            reads: self.reads + times * other.reads,
            both: self.both + times * other.both,
        }
    }

    /// The squares of the coordinate, from its mean.
    fn weight(self) -> f64 {
        self.arms - self.arm * self.arm / self.count
    }

    /// The squares of what was read, from its mean.
    fn total(self) -> f64 {
        self.reads - self.read * self.read / self.count
    }

    fn slope(self) -> f64 {
        (self.both - self.arm * self.read / self.count) / self.weight()
    }

    /// The squares that a slope leaves.
    fn left(self, slope: f64) -> f64 {
        self.total() - slope * (2.0 * self.slope() - slope) * self.weight()
    }
}

/// What to say of parts that seem to have been clamped anew, each by its file; nothing where there is none.
#[must_use]
pub fn clamped_anew(parts: &[(&str, Turned)]) -> Option<String> {
    let advice = "If the part was measured on another machine than the one that made it, write `setup: {datum: free}` in its recording.";
    (!parts.is_empty()).then(|| format!("{} {advice}", rotations(parts)))
}

/// What to say of the same parts where their datum is taken as free; nothing where there is none.
#[must_use]
pub fn taken_as_free(parts: &[(&str, Turned)]) -> Option<String> {
    let advice = "In one clamping it cannot be told from an error that rotates all points alike, so the datum is free. Write `setup: \
                  {datum: free}` in its recording to confirm this, or `setup: {datum: fixed}` if the part stayed clamped as it was made.";
    (!parts.is_empty()).then(|| format!("{} {advice}", rotations(parts)))
}

fn rotations(parts: &[(&str, Turned)]) -> String {
    let one = |(file, turned): &(&str, Turned)| {
        let Turned { about, angle, share } = turned;
        format!(
            "{:.4} deg about {about} in {file}, which explains {:.0} % of them",
            angle.to_degrees(),
            (100.0 * share).floor()
        )
    };
    let all: Vec<String> = parts.iter().map(one).collect();
    format!("The measured deviations show a rotation of the part: {}.", all.join(", "))
}

/// A count as a number.
#[expect(clippy::cast_precision_loss, reason = "counts of readings are far below 2^52")]
fn number(count: usize) -> f64 {
    count as f64
}

#[cfg(test)]
mod tests;
