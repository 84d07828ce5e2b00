//! Selection: which of the candidates explain the residual.
//!
//! In: a design. Out: the set of effects with the lowest cost: n ln(sum of squares) plus, for each effect, its parameters
//! times ln n, twice the logarithm of how many candidates of its kind were tried, and a little for complicated names. Several
//! sets are carried along at once, effects chosen early are dropped when others make them needless, and at the end each
//! is tried against every other, so that a first wrong guess does not stay.

use model_dsl::calibration::LARGEST_ANGLE;
use nalgebra::DMatrix;

use crate::candidates::simplicity;
use crate::design::Design;
use crate::harmonics::{HIGHEST, comes_again_among};
use crate::model::Effect;
use crate::ranges::{Resolution, holds};
use crate::study::Study;
use crate::sweep::{Swept, misfit};
use crate::terms::{Range, Setting, Shape, oddity, plausible};

/// How many sets are carried along.
const BEAM: usize = 8;
/// How many effects each set is tried with at each step.
const BRANCHES: usize = 6;
/// The most effects in a set.
const MOST: usize = 10;
/// A set may cost so much more than the best and still be carried along: two effects may only make sense together.
const PATIENCE: f64 = 12.0;

/// What an effect must take from the cost to be chosen: for each parameter what it could gain by chance in `samples` samples,
/// what the best of `tries` would gain by chance, and a little for a complicated name.
pub(crate) fn price(study: &Study<'_>, effect: &Effect, samples: f64, tries: f64, waves: f64) -> f64 {
    // The period of a wave is no further parameter: it was looked for among all waves of all motions, which their number counts.
    let wave = effect.shape.is_wave();
    let parameters = if wave { effect.shape.columns() } else { effect.shape.parameters() };
    let tried = match effect.shape {
        // A harmonic was looked for among those of its wave.
        Shape::Cyclic { order, .. } if order > 1 => f64::from(HIGHEST).ln(),
        _ if wave => waves.max(1.0).ln(),
        _ => tries.ln(),
    };
    (crate::number(parameters) - FIRST_SAVES) * parameter_price(samples)
        + 2.0 * tried
        + simplicity(study, effect)
}

/// What a price counts for columns that others hold already.
pub(crate) fn untold_price(columns: usize, samples: f64) -> f64 {
    crate::number(columns) * parameter_price(samples)
}

/// What one more parameter must take from the cost: Schwarz's criterion.
pub(crate) fn parameter_price(samples: f64) -> f64 {
    samples.max(2.0).ln()
}

/// The share of its price that the first parameter of an effect is spared: the held-out test and the judge look after single
/// parameters, while flexible shapes are the ones that fit anything.
const FIRST_SAVES: f64 = 0.4;

/// The share of an effect that the others of a set must leave: two effects that nearly cancel are no explanation.
const APART: f64 = 1e-3;

/// What selection works on.
pub(crate) struct Choice<'d> {
    design: &'d Design,
    /// Columns of settings that are always fitted.
    always: Vec<usize>,
    /// The products beside free zeros alone.
    zeroed: Swept,
    /// Whether each regressor is a rotation of a body that should not turn, in rad for a coefficient of 1.
    rotations: Vec<bool>,
    /// The plausible sizes of each regressor.
    plausible: Vec<Option<Range>>,
    /// Whether each regressor is part of a wave that comes again, which is no part of a curve.
    again: Vec<bool>,
    /// Regressors that may be chosen.
    open: Vec<usize>,
    prices: Vec<f64>,
    samples: f64,
    products: DMatrix<f64>,
    resolution: Resolution,
}

/// A set of effects on the way.
#[derive(Clone)]
struct Set {
    chosen: Vec<usize>,
    swept: Swept,
    cost: f64,
}

impl<'d> Choice<'d> {
    /// Prepares the choice. The first regressors, `settings` in number, are fitted whatever else is; `waves` tells how many independent
    /// waves were looked at.
    pub(crate) fn new(
        study: &Study<'_>,
        design: &'d Design,
        products: DMatrix<f64>,
        samples: f64,
        settings: usize,
        waves: f64,
        resolution: Resolution,
    ) -> Self {
        let open: Vec<usize> = (settings..design.regressors.len()).collect();
        let fixed = design.first.get(settings).copied().unwrap_or(design.width);
        let tries = crate::number(open.len().max(2));
        let price = |effect: &Effect| price(study, effect, samples, tries, waves);
        let prices = design.regressors.iter().map(|regressor| price(&regressor.effect)).collect();
        let zeroed = zeroed(design, &products, settings);
        let rotations = design.regressors.iter().map(|regressor| rotates(study, &regressor.effect)).collect();
        let plausible =
            design.regressors.iter().map(|regressor| plausible(study, &regressor.effect)).collect();
        let effects = || design.regressors.iter().map(|regressor| &regressor.effect);
        let comes_again =
            |effect: &Effect| comes_again_among(effects(), effect, |axis, far| resolution.goes(axis, far));
        let again = effects().map(comes_again).collect();
        let always = (0..fixed).collect();
        Self {
            design,
            always,
            zeroed,
            rotations,
            plausible,
            again,
            open,
            prices,
            samples,
            products,
            resolution,
        }
    }

    /// The best set found, by numbers of regressors.
    pub(crate) fn best(&self) -> Vec<usize> {
        let mut beam = vec![self.empty()];
        let mut best = beam[0].clone();
        for _ in 0..MOST {
            let grown = self.grow(&beam);
            let Some(lowest) = grown.first() else { break };
            if lowest.cost < best.cost {
                best = lowest.clone();
            }
            beam = grown.into_iter().filter(|set| set.cost < best.cost + PATIENCE).collect();
            if beam.is_empty() {
                break;
            }
        }
        let mut chosen = self.exchanged(best).chosen;
        chosen.sort_unstable();
        chosen
    }

    fn empty(&self) -> Set {
        let mut swept = Swept::new(&self.products);
        for column in &self.always {
            swept.take(*column);
        }
        let cost = self.misfit(swept.remaining());
        Set { chosen: Vec::new(), swept, cost }
    }

    fn misfit(&self, remaining: f64) -> f64 {
        misfit(remaining, self.samples)
    }

    /// Sets with one more effect, cheapest first.
    fn grow(&self, beam: &[Set]) -> Vec<Set> {
        let mut next: Vec<(f64, usize, usize)> = Vec::new();
        for (number, set) in beam.iter().enumerate() {
            next.extend(self.branches(set).into_iter().map(|(cost, regressor)| (cost, number, regressor)));
        }
        next.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut grown: Vec<Set> = Vec::new();
        for (_, number, regressor) in next {
            if grown.len() == BEAM {
                break;
            }
            let set = self.pruned(self.with(&beam[number], regressor));
            let known = |other: &Set| same(&other.chosen, &set.chosen);
            if !grown.iter().any(known) && !beam.iter().any(known) {
                grown.push(set);
            }
        }
        grown.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        grown
    }

    /// The most promising effects to add to a set, no two of them alike.
    fn branches(&self, set: &Set) -> Vec<(f64, usize)> {
        let mut costs: Vec<(f64, usize)> = self
            .open
            .iter()
            .filter(|regressor| self.fits(set, **regressor))
            .map(|regressor| (self.cost_with(set, *regressor), *regressor))
            .filter(|(cost, _)| *cost < set.cost + PATIENCE)
            .collect();
        costs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut different: Vec<(f64, usize)> = Vec::new();
        for (cost, regressor) in costs {
            if different.len() == BRANCHES {
                break;
            }
            if !different.iter().any(|(_, known)| self.alike(set, *known, regressor)) {
                different.push((cost, regressor));
            }
        }
        different
    }

    /// Whether two effects of one column each would do nearly the same beside a set.
    fn alike(&self, set: &Set, a: usize, b: usize) -> bool {
        let (a, b) = (self.design.columns(a), self.design.columns(b));
        a.len() == 1 && b.len() == 1 && set.swept.likeness(a.start, b.start).abs() > 0.9995
    }

    /// Whether an effect may stand beside those of a set: it is not there yet in another form, and has the right sign.
    fn fits(&self, set: &Set, regressor: usize) -> bool {
        let effect = &self.design.regressors[regressor].effect;
        let against = |chosen: &usize| {
            let known = &self.design.regressors[*chosen].effect;
            let (a, b) = (&known.shape, &effect.shape);
            let in_curve = (holds(a, b) && !self.again[regressor]) || (holds(b, a) && !self.again[*chosen]);
            rivals(known, effect) || known.place == effect.place && (self.resolution.blurs(a, b) || in_curve)
        };
        if set.chosen.iter().any(against) {
            return false;
        }
        let mut columns = self.design.columns(regressor);
        let apart = columns.any(|column| set.swept.independence(column) > APART);
        let sign = || set.swept.sign(self.design.first[regressor]);
        apart && (!positive(&effect.shape) || sign() > 0.0 || self.may_lead(set, regressor))
    }

    /// Whether a lag or an acceleration may be below zero: its drive then leads. A clock that does the same is likelier than a
    /// feed-forward that is too large.
    fn may_lead(&self, set: &Set, regressor: usize) -> bool {
        let shape = |number: usize| &self.design.regressors[number].effect.shape;
        let clock = |other: &usize| *shape(*other) == Shape::Instrument(Setting::Clock);
        let mut clocks = (0..self.design.regressors.len()).filter(clock);
        leads(shape(regressor)) && !clocks.any(|clock| self.alike(set, regressor, clock))
    }

    fn cost_with(&self, set: &Set, regressor: usize) -> f64 {
        let columns: Vec<usize> = self.design.columns(regressor).collect();
        let (gain, rank) = set.swept.promise(&columns);
        let price = self.prices[regressor] - self.missing(regressor, rank);
        self.misfit(set.swept.remaining() - gain) + self.price(set) + price
    }

    /// What the price counts for columns that others hold already.
    fn missing(&self, regressor: usize, rank: usize) -> f64 {
        let columns = self.design.regressors[regressor].effect.shape.columns();
        untold_price(columns - rank.min(columns), self.samples)
    }

    fn price(&self, set: &Set) -> f64 {
        set.cost - self.misfit(set.swept.remaining()) - self.odd(set)
    }

    /// What the sizes of the effects of a set cost beyond what their physics allows.
    fn odd(&self, set: &Set) -> f64 {
        let size = |regressor: &usize| {
            let coefficients: Vec<f64> =
                self.design.columns(*regressor).map(|column| set.swept.coefficient(column)).collect();
            oddity(
                self.plausible[*regressor],
                &self.design.regressors[*regressor].effect.shape,
                &coefficients,
            )
        };
        set.chosen.iter().map(size).sum()
    }

    fn with(&self, set: &Set, regressor: usize) -> Set {
        let price = self.price(set);
        let mut swept = set.swept.clone();
        let rank = self.design.columns(regressor).filter(|column| swept.take(*column)).count();
        let mut chosen = set.chosen.clone();
        chosen.push(regressor);
        let cost =
            self.misfit(swept.remaining()) + price + self.prices[regressor] - self.missing(regressor, rank);
        self.weighed(Set { chosen, swept, cost })
    }

    /// A set with what its sizes cost.
    fn weighed(&self, mut set: Set) -> Set {
        set.cost += self.odd(&set);
        set
    }

    fn without(&self, set: &Set, regressor: usize) -> Set {
        let price = self.price(set);
        let mut swept = set.swept.clone();
        let mut rank = 0;
        for column in self.design.columns(regressor) {
            rank += usize::from(swept.has(column));
            swept.drop(column);
        }
        let chosen = set.chosen.iter().copied().filter(|known| *known != regressor).collect();
        let cost =
            self.misfit(swept.remaining()) + price - self.prices[regressor] + self.missing(regressor, rank);
        self.weighed(Set { chosen, swept, cost })
    }

    /// Drops what has become needless, or whose sign has become impossible.
    fn pruned(&self, mut set: Set) -> Set {
        loop {
            let wrong = set.chosen.iter().copied().find(|regressor| self.impossible(&set, *regressor));
            let cheaper = wrong.map(|regressor| self.without(&set, regressor)).or_else(|| {
                let shorter = set.chosen.iter().map(|regressor| self.without(&set, *regressor));
                shorter.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|shorter| shorter.cost < set.cost)
            });
            match cheaper {
                Some(cheaper) => set = cheaper,
                None => return set,
            }
        }
    }

    fn impossible(&self, set: &Set, regressor: usize) -> bool {
        let effect = &self.design.regressors[regressor].effect;
        positive(&effect.shape)
            && !leads(&effect.shape)
            && set.swept.coefficient(self.design.first[regressor]) <= 0.0
            || self.outgrows(set, regressor)
    }

    /// Whether an effect is far larger than all there is to explain, so that it only makes up for another one as large; or a
    /// rotation that is no small error any more.
    fn outgrows(&self, set: &Set, regressor: usize) -> bool {
        let columns: Vec<usize> = self.design.columns(regressor).collect();
        let coefficients: Vec<f64> = columns.iter().map(|column| set.swept.coefficient(*column)).collect();
        let turn: f64 = coefficients.iter().map(|coefficient| coefficient.abs()).sum();
        self.rotations[regressor] && turn > LARGEST_ANGLE
            || self.zeroed.energy(&columns, &coefficients) > LARGE * LARGE * self.zeroed.remaining()
    }

    /// Tries every other effect in the place of each, until nothing becomes cheaper.
    fn exchanged(&self, mut set: Set) -> Set {
        for _ in 0..MOST {
            let exchanges = set.chosen.clone().into_iter().filter_map(|regressor| {
                let shorter = self.without(&set, regressor);
                let other = self.branches(&shorter).into_iter().next()?;
                Some(self.pruned(self.with(&shorter, other.1)))
            });
            let best = exchanges.min_by(|a, b| a.cost.total_cmp(&b.cost));
            match best.filter(|best| best.cost < set.cost - 1e-6) {
                Some(best) => set = best,
                None => return set,
            }
        }
        set
    }
}

/// How many times as large as all there is to explain an effect may be.
const LARGE: f64 = 5.0;

/// Whether an effect turns a body, other than the angle of a rotary axis, by its coefficient.
fn rotates(study: &Study<'_>, effect: &Effect) -> bool {
    let turns = |motion: usize| study.equations.motions[motion].angular && !study.own.contains(&Some(motion));
    let by_coefficient = !matches!(
        effect.shape,
        Shape::Lag { .. }
            | Shape::Acceleration { .. }
            | Shape::Expansion { .. }
            | Shape::Growth { .. }
            | Shape::Compliance { .. }
            | Shape::Delay { .. }
            | Shape::Times { .. }
            | Shape::Instrument(_)
    );
    by_coefficient && effect.motion().is_some_and(turns)
}

/// The products with the zeros of the channels swept in, which effects may shift as they like.
fn zeroed(design: &Design, products: &DMatrix<f64>, settings: usize) -> Swept {
    let mut swept = Swept::new(products);
    let is_zero = |number: &usize| {
        matches!(
            design.regressors[*number].effect.shape,
            Shape::Instrument(
                Setting::Offset { .. }
                    | Setting::Radius
                    | Setting::RunOffset { .. }
                    | Setting::Displacement { .. }
                    | Setting::Rotation { .. }
            )
        )
    };
    for number in (0..settings).filter(is_zero) {
        design.columns(number).for_each(|column| {
            swept.take(column);
        });
    }
    swept
}

fn same(a: &[usize], b: &[usize]) -> bool {
    a.len() == b.len() && a.iter().all(|member| b.contains(member))
}

/// Whether two effects are the same piece of physics in different forms, of which only one can be right.
pub(crate) fn rivals(a: &Effect, b: &Effect) -> bool {
    if !a.same_place(b) || a.shape.name() != b.shape.name() {
        return false;
    }
    match (&a.shape, &b.shape) {
        // Several waves may run along one axis.
        (Shape::Cyclic { .. }, Shape::Cyclic { .. }) => {
            let lengths = a.shape.wave_along().zip(b.shape.wave_along());
            lengths.is_some_and(|((_, a), (_, b))| (a / b - 1.0).abs() < 0.02)
        }
        (Shape::Vibration { frequency: a }, Shape::Vibration { frequency: b }) => (a / b - 1.0).abs() < 0.001,
        (Shape::Coupling { axis: a, .. }, Shape::Coupling { axis: b, .. }) => a == b,
        (Shape::Expansion { sensor: a, .. }, Shape::Expansion { sensor: b, .. })
        | (Shape::Growth { sensor: a, .. }, Shape::Growth { sensor: b, .. }) => a == b,
        (Shape::Compliance { load: a }, Shape::Compliance { load: b }) => a == b,
        (Shape::Instrument(a), Shape::Instrument(b)) => a == b,
        // A play that grows along a travel is one that does not, and one that grows from nothing.
        (Shape::Times { factors: a, .. }, Shape::Times { factors: b, .. }) => a == b,
        (Shape::Times { .. }, _) | (_, Shape::Times { .. }) => false,
        _ => true,
    }
}

/// Whether a coefficient below zero is one of a drive that leads, as too large a feed-forward makes it.
fn leads(shape: &Shape) -> bool {
    matches!(shape, Shape::Lag { inertia: 0.0, .. } | Shape::Acceleration { .. })
}

/// Whether a coefficient below zero would mean nothing.
fn positive(shape: &Shape) -> bool {
    matches!(shape, Shape::Lag { .. } | Shape::Acceleration { .. } | Shape::Instrument(Setting::Cosine))
}

#[cfg(test)]
mod tests;
