//! Forms: effects built from what terms and factors have.
//!
//! In: a study that was searched. Out: some thousand effects that no term of the vocabulary has, each as one column: an effect that was
//! found times a factor; a play times a factor; factors alone, and times positions; products of positions.

use std::f64::consts::TAU;

use model_dsl::calibration::{Factor, Within};

use crate::candidates::{geometric, recorded};
use crate::course::Course;
use crate::engine::Found;
use crate::kinship;
use crate::model::{Effect, Fitted, Place};
use crate::ranges::shortest_step;
use crate::side::Side;
use crate::study::Study;
use crate::terms::{REFERENCE_TEMPERATURE, Shape};
use crate::travel::Travel;

/// From one time constant of a filter or a warmth to the next: the answers of two filters whose time constants lie a factor of 3 apart
/// still have three quarters of their course in common, and the best one is refined.
const FILTERS: f64 = 3.0;

/// The speeds over which something fades, as shares of the highest speed: between them they cover what fades within a few percent of it,
/// and what is hardly gone there. The best one is refined.
const FADING: [f64; 2] = [0.08, 0.3];

/// The loads at which half is left, as shares of the largest load. The best one is refined.
const HALVES: [f64; 2] = [0.15, 0.6];

/// The widths of the play of a sensor, as shares of the range of its temperature. The best one is refined.
const WIDTHS: [f64; 2] = [0.15, 0.4];

/// How many moments of a recording are looked at for an event. The best of them is wrong in a fortieth of the rows at most, and is then
/// looked for more finely.
const EVENTS: f64 = 40.0;

/// The widths of a worn zone, as shares of the travel. Zones of one width overlap by half. The best one is moved.
const ZONES: [f64; 3] = [0.15, 0.3, 0.6];

/// The nodes of a zone, as shares of its half width. It rises and falls as a squared cosine: so does wear to both sides of where a
/// machine works most.
const ZONE: [f64; 9] = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];

/// The highest power of a product of positions, that of the polynomials of the vocabulary. What bends more is measured as a table.
const ORDER: u8 = 3;

/// An effect that may be composed, with the coefficients that make one column of it.
#[derive(Clone, Debug)]
pub(super) struct Form {
    pub(super) effect: Effect,
    pub(super) coefficients: Vec<f64>,
    /// An effect that is fitted beside it, and stays if it stands up.
    pub(super) beside: Option<Effect>,
}

impl Form {
    /// The same with this amount of it.
    pub(super) fn fitted(&self, amount: f64) -> Fitted {
        let coefficients = self.coefficients.iter().map(|coefficient| amount * coefficient).collect();
        Fitted { effect: self.effect.clone(), coefficients }
    }
}

/// What factors may be built of.
struct Atoms {
    /// For each axis that moves: its position.
    positions: Vec<Factor<usize>>,
    /// Temperatures, which are factors of plays and positions, but as terms of their own a growth.
    temperatures: Vec<Factor<usize>>,
    /// Loads, which alone are a compliance.
    loads: Vec<Factor<usize>>,
    /// What no term has.
    others: Vec<Factor<usize>>,
}

/// All forms.
pub(super) fn forms(study: &Study<'_>, found: &Found) -> Vec<Form> {
    let atoms = Atoms::new(study, &found.travels);
    let named = loops(study, found, &atoms);
    let mut forms = names(found);
    forms.extend(of_effects(found, &atoms));
    forms.extend(beats(found, &atoms));
    for place in places(study) {
        let Place::Motion { motion, .. } = place else { continue };
        let own =
            plays(study, motion, &found.travels, &atoms).into_iter().chain(drags(study, motion, &atoms));
        let shapes = own.chain(products(&atoms));
        let effects = shapes.map(|shape| Effect { place, shape });
        forms.extend(effects.filter(|effect| !named.contains(effect)).map(one));
    }
    forms
}

/// The length of the longest recording, s.
fn span(study: &Study<'_>) -> f64 {
    study.scenes.iter().map(|scene| scene.observed).fold(0.0, f64::max)
}

/// From one event of the grid to the next, s.
pub(super) fn distance(study: &Study<'_>) -> f64 {
    span(study) / EVENTS
}

/// The moments at which something may have happened. Time is that of one recording: several have none in common.
pub(super) fn moments(study: &Study<'_>) -> Vec<f64> {
    let fitted = study.scenes.iter().filter(|scene| scene.blocks.iter().any(|block| !block.held_out));
    if fitted.count() > 1 {
        return Vec::new();
    }
    let step = distance(study);
    std::iter::successors(Some(step), |time| Some(time + step))
        .take_while(|time| *time < span(study))
        .collect()
}

/// Where an effect may come in: each error motion, on each side that is recorded.
pub(super) fn places(study: &Study<'_>) -> Vec<Place> {
    let of_motion =
        |motion: usize| sides(study, motion).into_iter().map(move |side| Place::Motion { motion, side });
    // As for the names: what both motors of a beam do is told as that of its slide.
    let own = |motion: &usize| !study.equations.motions[*motion].shares_beam();
    (0..study.equations.motions.len()).filter(own).flat_map(of_motion).collect()
}

/// The names of the vocabulary that have one column. Beside a form that has taken the place of others, one of them may be right that was
/// not before: a play that grows along the travel has a size where the travel begins.
fn names(found: &Found) -> Vec<Form> {
    let pool = found.pool.iter().map(|kin| &kin.effect).filter(|effect| effect.shape.columns() == 1);
    let open = pool.filter(|effect| effect.motion().is_some() && !effect.shape.nonlinear_in_coefficient());
    open.map(|effect| Form { effect: effect.clone(), coefficients: vec![1.0], beside: None }).collect()
}

/// What follows the velocity of an axis in its own motion, and what the recordings show alike in others: it has a name, a loop or a
/// clock. What follows the speed is neither, but a loop whose gain differs from one direction to the other; of an axis that never turns
/// the two are the same.
fn loops(study: &Study<'_>, found: &Found, atoms: &Atoms) -> Vec<Effect> {
    let turns = |axis: usize| found.travels[axis].turns;
    let follows = |factor: &&Factor<usize>| match factor {
        Factor::Velocity { .. } => true,
        Factor::Speed { axis, .. } => !turns(*axis),
        _ => false,
    };
    let shapes: Vec<Shape> = atoms
        .others
        .iter()
        .filter(follows)
        .map(|factor| times(Shape::Constant, vec![factor.clone()]))
        .collect();
    let everywhere = places(study)
        .into_iter()
        .flat_map(|place| shapes.iter().map(move |shape| Effect { place, shape: shape.clone() }));
    let model = &found.fit.model;
    let courses: Vec<_> = (0..study.scenes.len()).map(|scene| Course::new(study, scene, model)).collect();
    let kin = kinship::groups(study, &courses, &found.appraisal.weights.noises, everywhere.collect());
    let own = |effect: &Effect| {
        let axis = effect.shape.factors().first().and_then(Factor::axis);
        axis.is_some_and(|axis| study.own[axis].is_some() && study.own[axis] == effect.motion())
    };
    let members = kin.into_iter().map(|kin| [vec![kin.effect], kin.equals].concat());
    members.filter(|effects| effects.iter().any(own)).flatten().collect()
}

fn one(effect: Effect) -> Form {
    Form { effect, coefficients: vec![1.0], beside: None }
}

/// Where effects of a motion may come in.
fn sides(study: &Study<'_>, motion: usize) -> Vec<Side> {
    let outside = study.scenes.iter().flat_map(|scene| &scene.channels).any(|channel| channel.kind.outside());
    let own = study.own.iter().position(|own| *own == Some(motion));
    let drive = own.filter(|axis| study.has_drive(*axis)).map(|_| Side::Drive);
    drive.into_iter().chain(outside.then_some(Side::After)).collect()
}

/// Effects that were found, times each factor. What a loop does is a matter of its states, which nothing multiplies; and what lies in
/// time, as a vibration or a drift, has no factor that a state of the machine could be. How far an axis jumps at a reversal may
/// depend on the place.
fn of_effects(found: &Found, atoms: &Atoms) -> Vec<Form> {
    let multiplied = |fitted: &&Fitted| {
        fitted.effect.motion().is_some()
            && fitted.effect.shape.factors().is_empty()
            && !fitted.effect.shape.nonlinear_in_coefficient()
            && !matches!(fitted.effect.shape, Shape::Constant | Shape::Vibration { .. } | Shape::Drift { .. })
    };
    let effects = found.fit.model.chosen().iter().filter(multiplied);
    effects
        .flat_map(|fitted| {
            // A play of the axis is multiplied anyway.
            let is_open = move |factor: &&Factor<usize>| match fitted.effect.shape {
                Shape::Backlash { axis, wind_up } => wind_up > 0.0 && !is_speed_of(axis, factor),
                // Powers of a position times a position are products of positions.
                Shape::Polynomial { .. } | Shape::Coupling { .. } => {
                    !matches!(factor, Factor::Position { .. })
                }
                _ => true,
            };
            atoms.all().filter(is_open).map(|factor| Form {
                effect: Effect {
                    place: fitted.effect.place,
                    shape: times(fitted.effect.shape.clone(), vec![factor.clone()]),
                },
                coefficients: fitted.coefficients.clone(),
                beside: None,
            })
        })
        .collect()
}

/// Two waves of nearly the same period along one axis, of opposite phases, as one wave that grows along the axis: over less than a beat
/// they are the same.
fn beats(found: &Found, atoms: &Atoms) -> Vec<Form> {
    let waves: Vec<&Fitted> = found
        .fit
        .model
        .chosen()
        .iter()
        .filter(|fitted| matches!(fitted.effect.shape, Shape::Cyclic { .. }))
        .collect();
    let pairs = waves.iter().enumerate().flat_map(|(number, one)| {
        waves.iter().skip(number + 1).filter_map(|other| beat(one, other, &found.travels, atoms))
    });
    pairs.collect()
}

/// The wave that grows along its axis of which two waves are made; `None` where they are two.
fn beat(one: &Fitted, other: &Fitted, travels: &[Travel], atoms: &Atoms) -> Option<Form> {
    let &Shape::Cyclic { center, .. } = &one.effect.shape else { return None };
    let ((axis, period), (of, second)) =
        one.effect.shape.wave_along().zip(other.effect.shape.wave_along())?;
    let (near, same) = ((1.0 / period - 1.0 / second).abs(), one.effect.place == other.effect.place);
    if axis != of || !same || near * travels[axis].range() > 1.0 {
        return None;
    }
    let phase = |fitted: &Fitted| match fitted.coefficients.as_slice() {
        [sine, cosine] => Some(cosine.atan2(*sine)),
        _ => None,
    };
    let between = 0.5 * (phase(one)? + phase(other)?);
    let shape = Shape::Cyclic { axis, period: 2.0 / (1.0 / period + 1.0 / second), order: 1, center };
    let along = |factor: &&Factor<usize>| factor.axis() == Some(axis);
    let position = atoms.positions.iter().find(along)?.clone();
    let place = one.effect.place;
    Some(Form {
        effect: Effect { place, shape: times(shape.clone(), vec![position]) },
        coefficients: vec![between.cos(), between.sin()],
        beside: Some(Effect { place, shape }),
    })
}

fn times(core: Shape, factors: Vec<Factor<usize>>) -> Shape {
    Shape::Times { core: Box::new(core), factors }
}

/// Plays of the motion's axis whose size follows a state.
fn plays(study: &Study<'_>, motion: usize, travels: &[Travel], atoms: &Atoms) -> Vec<Shape> {
    let known = &study.equations.motions[motion];
    let Some(axis) = known.axis.filter(|axis| travels[*axis].turns && !known.alignment) else {
        return Vec::new();
    };
    let play = || Shape::Backlash { axis, wind_up: 0.0 };
    let zones = zones(axis, &travels[axis]);
    let factors = atoms.all().filter(|factor| !is_speed_of(axis, factor)).cloned().chain(zones);
    factors.map(|factor| times(play(), vec![factor])).collect()
}

/// What follows the square of an axis's velocity, with its sign, in its own motion: a loop whose gain changes with speed, or the drag of
/// oil and air on the drive.
fn drags(study: &Study<'_>, motion: usize, atoms: &Atoms) -> Vec<Shape> {
    let own = |factor: &&Factor<usize>| factor.axis().is_some_and(|axis| study.own[axis] == Some(motion));
    let find = |is_wanted: fn(&Factor<usize>) -> bool| {
        atoms.others.iter().filter(own).find(|factor| is_wanted(factor)).cloned()
    };
    let velocity = find(|factor| matches!(factor, Factor::Velocity { .. }));
    let speed = find(|factor| matches!(factor, Factor::Speed { .. }));
    velocity
        .zip(speed)
        .map(|(velocity, speed)| times(Shape::Constant, vec![velocity, speed]))
        .into_iter()
        .collect()
}

/// Whether a factor is a speed of this axis. A direction times a velocity is a speed, and times a speed a velocity: a play with such a
/// factor is that factor alone.
fn is_speed_of(axis: usize, factor: &Factor<usize>) -> bool {
    matches!(*factor, Factor::Velocity { axis: of, .. } | Factor::Speed { axis: of, .. } if of == axis)
}

/// Zones of a travel in which something is there, and fades to both sides.
fn zones(axis: usize, travel: &Travel) -> Vec<Factor<usize>> {
    let zone = |middle: f64, half: f64| Factor::Curve {
        axis,
        at: ZONE.map(|share| middle + share * half).to_vec(),
        values: ZONE.map(|share| (0.25 * TAU * share).cos().powi(2)).to_vec(),
    };
    ZONES
        .iter()
        .flat_map(|share| {
            let half = 0.5 * share * travel.range();
            let middles = std::iter::successors(Some(travel.low), move |middle| Some(middle + half));
            middles.take_while(|middle| *middle <= travel.high).map(move |middle| zone(middle, half))
        })
        .collect()
}

/// Factors alone, and times positions.
fn products(atoms: &Atoms) -> Vec<Shape> {
    let product = |factors: Vec<Factor<usize>>| times(Shape::Constant, factors);
    let mut shapes: Vec<Shape> = atoms.others.iter().map(|factor| product(vec![factor.clone()])).collect();
    let multiplied = atoms.others.iter().chain(&atoms.temperatures).chain(&atoms.loads);
    for factor in multiplied {
        shapes.extend(atoms.positions.iter().map(|position| product(vec![factor.clone(), position.clone()])));
    }
    shapes.extend(positions(&atoms.positions).into_iter().map(product));
    shapes
}

/// Products of the positions of two and of three axes, up to the highest power.
fn positions(positions: &[Factor<usize>]) -> Vec<Vec<Factor<usize>>> {
    let mut products = Vec::new();
    for (number, one) in positions.iter().enumerate() {
        for (other_number, other) in positions.iter().enumerate().skip(number + 1) {
            for power in 1..ORDER {
                let powers = (1..=ORDER - power).map(|of_other| (power, of_other));
                products.extend(powers.map(|(a, b)| vec![raised(one, a), raised(other, b)]));
            }
            let thirds = positions.iter().skip(other_number + 1);
            products.extend(thirds.map(|third| vec![one.clone(), other.clone(), third.clone()]));
        }
    }
    products
}

/// A position to a power.
fn raised(factor: &Factor<usize>, to: u8) -> Factor<usize> {
    match *factor {
        Factor::Position { axis, within, .. } => Factor::Position { axis, power: to, within },
        ref other => other.clone(),
    }
}

impl Atoms {
    fn new(study: &Study<'_>, travels: &[Travel]) -> Self {
        let span = span(study);
        let filters = geometric((4.0 * shortest_step(study)).max(span / 30.0), span, FILTERS);
        let programs = |axis: &usize| study.equations.programs(*axis);
        let moving = || (0..travels.len()).filter(|axis| travels[*axis].moves).filter(programs);
        let positions = moving().map(|axis| {
            let within = Within { from: travels[axis].low, to: travels[axis].high };
            Factor::Position { axis, power: 1, within }
        });
        Self {
            positions: positions.collect(),
            temperatures: temperatures(study, &filters),
            loads: loads(study),
            others: moving().flat_map(|axis| motions(axis, &travels[axis], &filters)).collect(),
        }
    }

    /// All of them.
    fn all(&self) -> impl Iterator<Item = &Factor<usize>> {
        self.positions.iter().chain(&self.temperatures).chain(&self.loads).chain(&self.others)
    }
}

/// What the motion of an axis makes.
fn motions(axis: usize, travel: &Travel, filters: &[f64]) -> Vec<Factor<usize>> {
    let within = |from: f64, to: f64| Within { from, to };
    let (fastest, hardest) = (travel.fastest, travel.hardest);
    let mut factors = vec![
        Factor::Velocity { axis, within: within(-fastest, fastest) },
        Factor::Speed { axis, within: within(0.0, fastest) },
        Factor::Acceleration { axis, within: within(-hardest, hardest) },
    ];
    factors.extend(FADING.map(|share| Factor::Fading { axis, over: share * fastest }));
    // One kelvin for each unit of speed: the coefficient says how much it makes.
    factors.extend(filters.iter().map(|filter| Factor::Warmth { axis, time_constant: *filter, rise: 1.0 }));
    factors
}

/// Temperatures, behind filters, and behind the play of a joint.
fn temperatures(study: &Study<'_>, filters: &[f64]) -> Vec<Factor<usize>> {
    let reference = REFERENCE_TEMPERATURE;
    let mut factors = Vec::new();
    for sensor in recorded(study) {
        let readings = study.scenes.iter().flat_map(|scene| &scene.given.temperatures[sensor]);
        let within = range(readings);
        let filtered = [0.0].iter().chain(filters);
        factors.extend(filtered.map(|filter| Factor::Temperature {
            sensor,
            reference,
            time_constant: *filter,
            within,
        }));
        let widths = WIDTHS.map(|share| share * (within.to - within.from));
        factors.extend(widths.map(|width| Factor::Play { sensor, reference, width }));
    }
    factors
}

fn loads(study: &Study<'_>) -> Vec<Factor<usize>> {
    let mut factors = Vec::new();
    for load in 0..study.loads.len() {
        let within = range(study.scenes.iter().flat_map(|scene| &scene.given.loads[load]));
        let largest = within.from.abs().max(within.to.abs());
        factors.push(Factor::Load { load, within });
        factors.extend(HALVES.map(|share| Factor::Half { load, at: share * largest }));
    }
    // A load that is nothing in every row multiplies nothing.
    factors.retain(|factor| !matches!(factor, Factor::Half { at, .. } if *at <= 0.0));
    factors
}

/// From the least to the greatest of what is known.
fn range<'r>(values: impl Iterator<Item = &'r f64>) -> Within {
    let known = values.filter(|value| value.is_finite());
    let (from, to) = known
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(from, to), value| (from.min(*value), to.max(*value)));
    if from <= to { Within { from, to } } else { Within::EVERYWHERE }
}

/// The factors by which the number of a factor is changed to find its best value: in steps of a fifth over the distance to the next
/// value of the grid.
const STEPS: [f64; 10] = [0.4, 0.5, 0.6, 0.75, 0.87, 1.15, 1.35, 1.65, 2.0, 2.5];

/// How far a zone is moved, as shares of its half width: up to half of the distance to the next zone of the grid.
const MOVES: [f64; 9] = [-0.5, -0.35, -0.2, -0.1, 0.0, 0.1, 0.2, 0.35, 0.5];

/// The same shape with other values of the number that was searched for on a grid.
pub(super) fn neighbours(shape: &Shape) -> Vec<Shape> {
    match shape {
        Shape::Times { core, factors } => factors
            .iter()
            .enumerate()
            .flat_map(|(place, factor)| around(factor).into_iter().map(move |other| (place, other)))
            .map(|(place, other)| {
                let mut factors = factors.clone();
                factors[place] = other;
                times((**core).clone(), factors)
            })
            .collect(),
        _ => Vec::new(),
    }
}

/// The factor with other values of the number that is searched for.
fn around(factor: &Factor<usize>) -> Vec<Factor<usize>> {
    if let Factor::Curve { axis, at, values } = factor {
        return zones_around(*axis, at, values);
    }
    let each = |change: &dyn Fn(f64) -> Factor<usize>| STEPS.iter().map(|step| change(*step)).collect();
    match *factor {
        Factor::Fading { axis, over } => each(&|step| Factor::Fading { axis, over: over * step }),
        Factor::Warmth { axis, time_constant, rise } => {
            each(&|step| Factor::Warmth { axis, time_constant: time_constant * step, rise })
        }
        Factor::Temperature { sensor, reference, time_constant, within } if time_constant > 0.0 => {
            each(&|step| {
                let time_constant = time_constant * step;
                Factor::Temperature { sensor, reference, time_constant, within }
            })
        }
        Factor::Play { sensor, reference, width } => {
            each(&|step| Factor::Play { sensor, reference, width: width * step })
        }
        Factor::Half { load, at } => each(&|step| Factor::Half { load, at: at * step }),
        _ => Vec::new(),
    }
}

/// How much narrower or wider a zone is made: from one width of the grid nearly to the next, in steps of a quarter.
const WIDTHS_BESIDE: [f64; 5] = [0.6, 0.8, 1.0, 1.25, 1.6];

/// Zones a little to both sides of one, and a little narrower and wider.
fn zones_around(axis: usize, at: &[f64], values: &[f64]) -> Vec<Factor<usize>> {
    let (Some(from), Some(to)) = (at.first(), at.last()) else { return Vec::new() };
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let moved = |by: f64, wider: f64| Factor::Curve {
        axis,
        at: at.iter().map(|node| middle + by * half + (node - middle) * wider).collect(),
        values: values.to_vec(),
    };
    MOVES.iter().flat_map(|by| WIDTHS_BESIDE.map(|wider| moved(*by, wider))).collect()
}
