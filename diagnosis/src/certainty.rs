//! Certainty: how far the parameters of a fitted model may lie from where they were found.
//!
//! In: a fit. Out: for each effect a covariance of its coefficients; the interval of its nonlinear parameter, taken from the
//! sum of squares itself, which is no parabola where a wave may slip by a cycle or a time constant outlasts the recording;
//! and the same effect in a richer form where the data lean to one that was not worth its price.

use nalgebra::DMatrix;

use crate::candidates;
use crate::conditions::Conditions;
use crate::design::{Design, Regressor};
use crate::fit::{self, Fit};
use crate::harmonics;
use crate::model::{Effect, Fitted};
use crate::parallel;
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::Shape;
use crate::travel::Travel;
use crate::weights::Weights;

/// The half width of a 95 % interval in standard deviations.
pub(crate) const WIDTH_95: f64 = 1.959_964;

/// How certain an effect is.
#[derive(Clone, Debug)]
pub(crate) struct Certainty {
    /// Of the linear coefficients, the nonlinear parameter last where there is one.
    pub(crate) covariance: DMatrix<f64>,
    /// Where the nonlinear parameter lies with 95 %.
    pub(crate) nonlinear: Option<(f64, f64)>,
    /// A richer form that the data lean to.
    pub(crate) richer: Option<Box<Richer>>,
}

/// An effect with more coefficients.
#[derive(Clone, Debug)]
pub(crate) struct Richer {
    pub(crate) fitted: Fitted,
    pub(crate) certainty: Certainty,
}

impl Certainty {
    /// What a linear fit says.
    pub(crate) fn linear(covariance: DMatrix<f64>) -> Self {
        Self { covariance, nonlinear: None, richer: None }
    }
}

/// The certainty of every effect of a fit. That of a wave comes from the noise around its own frequency.
pub(crate) fn certainties(study: &Study<'_>, fit: &Fit, conditions: &Conditions<'_>) -> Vec<Certainty> {
    let Conditions { weights, travels, .. } = *conditions;
    let count = fit.model.effects.len();
    let noises = parallel::counted(count, study.rows() * count, |number| {
        conditions.own_noise(study, &fit.model, number)
    });
    let covariances = covariances(study, fit, weights, &noises);
    let groups = harmonics::sharing(&fit.model.effects);
    let intervals = parallel::counted(groups.len(), study.rows() * count, |number| {
        let group = &groups[number];
        let deviation = covariances[*group.first()?].diagonal().iter().next_back()?.sqrt();
        let noise = group.iter().map(|number| noises[*number]).fold(0.0, f64::max);
        interval(study, (fit, weights), group, (deviation, noise))
    });
    let of = |number: usize| groups.iter().zip(&intervals).find(|(group, _)| group.contains(&number));
    parallel::counted(count, study.rows() * count, |number| {
        let mut certainty = Certainty::linear(covariances[number].clone());
        if let Some(interval) = of(number).and_then(|(_, interval)| *interval) {
            widen(&mut certainty.covariance, &fit.model.effects[number].effect.shape, interval);
            certainty.nonlinear = Some(interval);
        }
        certainty.richer = richer(study, fit, weights, travels, number).map(Box::new);
        certainty
    })
}

/// The covariance of each effect, beside such noises, squared, in units of that which the weights assume.
fn covariances(study: &Study<'_>, fit: &Fit, weights: &Weights, noises: &[f64]) -> Vec<DMatrix<f64>> {
    let mut covariances = fit.covariances.clone();
    if noises.iter().any(|noise| *noise < 1.0) {
        let least: Vec<f64> = noises.iter().map(|noise| noise.sqrt()).collect();
        let narrower = fit::covariances(study, &fit.model, weights, &least);
        let known = covariances.iter_mut().zip(narrower).zip(noises).filter(|(_, noise)| **noise < 1.0);
        known.for_each(|((covariance, narrower), _)| *covariance = narrower);
    }
    covariances
}

/// Multiples of the linear standard deviation at which the sum of squares is looked at.
const PLACES: [f64; 8] = [0.5, 1.0, 1.5, 2.0, 2.5, 3.5, 5.0, 8.0];
/// How often the search goes on further out, and by which factor.
const REACHES: usize = 3;
const REACH: f64 = 6.0;
/// Where twice the log-likelihood falls by this much, a 95 % interval ends.
const FALL_95: f64 = WIDTH_95 * WIDTH_95;

/// The interval of the nonlinear parameter that the effects of a group share, from its standard deviation as a linear fit has it and the
/// noise, squared, in units of that which the weights assume.
fn interval(
    study: &Study<'_>,
    (fit, weights): (&Fit, &Weights),
    group: &[usize],
    (deviation, noise): (f64, f64),
) -> Option<(f64, f64)> {
    let number = *group.first()?;
    let shape = &fit.model.effects[number].effect.shape;
    // The inertia of a loop acts on the states, not on columns of its own.
    if shape.nonlinear_in_coefficient() {
        return None;
    }
    let value = shape.nonlinear()?.value;
    if !(deviation > 0.0 && deviation.is_finite()) {
        return None;
    }
    let mut scale = deviation;
    let mut known = vec![(value, 0.0)];
    for _ in 0..REACHES {
        let open = |side: f64| end(&known, value, side, lowest(shape)).is_none();
        let sides = [-1.0, 1.0].into_iter().filter(|side| open(*side));
        let mut places: Vec<f64> = sides
            .flat_map(|side| PLACES.map(|place| value + side * place * scale))
            .map(|place| place.max(lowest(shape)))
            .filter(|place| *place > 0.0 || matches!(shape, Shape::Backlash { .. }))
            .collect();
        if scale <= deviation {
            places.extend(teeth(study, shape));
        }
        places.dedup();
        if places.is_empty() {
            break;
        }
        let falls = falls(study, fit, weights, group, &places).into_iter().map(|fall| fall / noise);
        known.extend(places.into_iter().zip(falls));
        scale *= REACH;
    }
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let far = |side: f64| {
        known.iter().map(|(place, _)| *place).fold(value, |far, place| match side {
            side if side < 0.0 => far.min(place),
            _ => far.max(place),
        })
    };
    let reached = |side: f64| end(&known, value, side, lowest(shape)).unwrap_or_else(|| far(side));
    Some((reached(-1.0), reached(1.0)))
}

/// The least value that a parameter may have: a play may be taken up at once, all others are above 0.
fn lowest(shape: &Shape) -> f64 {
    let value = shape.nonlinear().map_or(0.0, |parameter| parameter.value);
    if matches!(shape, Shape::Backlash { .. }) { 0.0 } else { 0.02 * value }
}

/// Where the fall passes the bound for the last time on one side of the value; `None` where it has not, or not yet.
fn end(known: &[(f64, f64)], value: f64, side: f64, lowest: f64) -> Option<f64> {
    let mut outward: Vec<(f64, f64)> =
        known.iter().copied().filter(|(place, _)| (place - value) * side >= 0.0).collect();
    outward.sort_by(|a, b| (side * a.0).total_cmp(&(side * b.0)));
    let last = outward.iter().rposition(|(_, fall)| *fall < FALL_95)?;
    let Some(outside) = outward.get(last + 1) else {
        return (outward[last].0 <= lowest).then_some(outward[last].0);
    };
    // The root of a parabola is a straight line.
    let (near, far) = (outward[last].1.max(0.0).sqrt(), outside.1.sqrt());
    let share = (WIDTH_95 - near) / (far - near).max(f64::MIN_POSITIVE);
    Some(outward[last].0 + share.clamp(0.0, 1.0) * (outside.0 - outward[last].0))
}

/// The most frequencies at which neighbours of a vibration are looked for.
const MOST_TEETH: f64 = 200.0;
/// The step between them, times the span of the recording.
const TOOTH: f64 = 0.15;

/// Frequencies around that of a vibration at which runs with pauses between them see nearly the same wave.
fn teeth(study: &Study<'_>, shape: &Shape) -> Vec<f64> {
    let Shape::Vibration { frequency } = *shape else { return Vec::new() };
    let (mut span, mut stretch) = (0.0_f64, 0.0_f64);
    for scene in &study.scenes {
        let time = &scene.recording.time;
        span = span.max(time.last().copied().unwrap_or_default());
        let runs = scene.blocks.iter().map(|block| block.run).collect::<std::collections::BTreeSet<_>>();
        for run in runs {
            let rows = || scene.blocks.iter().filter(|block| block.run == run).map(|block| &block.rows);
            let (from, to) = (rows().map(|rows| rows.start).min(), rows().map(|rows| rows.end).max());
            if let (Some(from), Some(to)) = (from, to) {
                stretch = stretch.max(time[to - 1] - time[from]);
            }
        }
    }
    if !(stretch > 0.0 && span > 1.5 * stretch) {
        return Vec::new();
    }
    let step = TOOTH / span;
    let count = (1.2 / stretch / step).min(MOST_TEETH / 2.0);
    let steps = (1..).map(crate::number).take_while(|step| *step <= count);
    steps
        .flat_map(|number| [frequency - number * step, frequency + number * step])
        .filter(|frequency| *frequency > 0.0)
        .collect()
}

/// How far twice the log-likelihood falls when the nonlinear parameter of a group of effects stands at each of these places, everything
/// else fitted again.
fn falls(study: &Study<'_>, fit: &Fit, weights: &Weights, group: &[usize], places: &[f64]) -> Vec<f64> {
    let at = |place: &f64| {
        let own = group.iter().map(|number| &fit.model.effects[*number].effect);
        own.map(|own| Effect { place: own.place, shape: own.shape.with_nonlinear(*place) }).collect()
    };
    let beside = Beside::new(study, fit, weights, group, places.iter().map(at).collect());
    let found = beside.as_fitted().0;
    (0..places.len()).map(|form| (beside.with_form(form).0 - found) / beside.scale()).collect()
}

/// The richer form of an effect that lowers the sum of squares by more than twice its further parameters: what Akaike's
/// criterion prefers, and what the price of a name did not let in.
fn richer(
    study: &Study<'_>,
    fit: &Fit,
    weights: &Weights,
    travels: &[Travel],
    number: usize,
) -> Option<Richer> {
    let own = &fit.model.effects[number].effect;
    let forms = candidates::richer(&own.shape, travels);
    if own.motion().is_none() || forms.is_empty() {
        return None;
    }
    let effects: Vec<Effect> = forms.into_iter().map(|shape| Effect { place: own.place, shape }).collect();
    let further = |effect: &Effect| {
        let parameters =
            |shape: &Shape| crate::number(shape.columns() + usize::from(shape.nonlinear().is_some()));
        parameters(&effect.shape) - parameters(&own.shape)
    };
    let forms = effects.iter().map(|effect| vec![effect.clone()]).collect();
    let beside = Beside::new(study, fit, weights, &[number], forms);
    let (scale, found) = (beside.scale(), beside.as_fitted().0);
    let gain = |form: usize| (found - beside.with_form(form).0) / scale - 2.0 * further(&effects[form]);
    let best = (0..effects.len()).max_by(|a, b| gain(*a).total_cmp(&gain(*b)))?;
    if gain(best) <= 0.0 {
        return None;
    }
    let (_, swept) = beside.with_form(best);
    let columns: Vec<usize> = beside.columns(&beside.forms[best]);
    let coefficients = columns.iter().map(|column| swept.coefficient(*column)).collect();
    let covariance = DMatrix::from_fn(columns.len(), columns.len(), |row, column| {
        scale * swept.covariance(columns[row], columns[column])
    });
    let fitted = Fitted { effect: effects[best].clone(), coefficients };
    Some(Richer { fitted, certainty: Certainty::linear(covariance) })
}

/// One design that holds a fit and other forms of some of its effects.
struct Beside {
    design: Design,
    /// All other effects, their slopes included, swept in.
    others: Swept,
    samples: f64,
    /// The regressors of the effects as they were fitted, and of each of their other forms.
    own: Vec<usize>,
    forms: Vec<Vec<usize>>,
}

impl Beside {
    fn new(study: &Study<'_>, fit: &Fit, weights: &Weights, own: &[usize], other: Vec<Vec<Effect>>) -> Self {
        let mut regressors = Regressor::all(&fit.model.effects);
        let groups = harmonics::sharing(&fit.model.effects).into_iter();
        let bent = groups.filter(|group| !group.iter().any(|number| own.contains(number)));
        regressors.extend(bent.map(|group| Regressor::slope(&fit.model.effects, &group)));
        let first_form = regressors.len();
        let mut forms = Vec::new();
        for form in other {
            forms.push((regressors.len()..regressors.len() + form.len()).collect());
            regressors.extend(form.into_iter().map(Regressor::of));
        }
        let mut design = Design::new(study, &fit.model, weights, regressors);
        design.rebase(&fit.model.effects);
        let (products, samples) = design.fitted();
        let mut others = Swept::new(&products);
        for other in (0..first_form).filter(|other| !own.contains(other)) {
            design.columns(other).for_each(|column| {
                others.take(column);
            });
        }
        Self { design, others, samples, own: own.to_vec(), forms }
    }

    /// The columns of some regressors.
    fn columns(&self, regressors: &[usize]) -> Vec<usize> {
        regressors.iter().flat_map(|regressor| self.design.columns(*regressor)).collect()
    }

    /// The sum of squares that is left with some regressors beside the others.
    fn with(&self, regressors: &[usize]) -> (f64, Swept) {
        let mut swept = self.others.clone();
        for column in self.columns(regressors) {
            swept.take(column);
        }
        (swept.remaining(), swept)
    }

    fn as_fitted(&self) -> (f64, Swept) {
        self.with(&self.own)
    }

    fn with_form(&self, form: usize) -> (f64, Swept) {
        self.with(&self.forms[form])
    }

    /// What one unit of twice the log-likelihood is in sums of squares.
    fn scale(&self) -> f64 {
        (self.as_fitted().0 / self.samples.max(1.0)).max(f64::MIN_POSITIVE)
    }
}

/// Brings a covariance up to an interval of its nonlinear parameter that is wider than its own, with everything that goes
/// along with that parameter. A wave slips by cycles on the far side, where nothing goes along in a straight line.
fn widen(covariance: &mut DMatrix<f64>, shape: &Shape, interval: (f64, f64)) {
    let Some(value) = shape.nonlinear().map(|parameter| parameter.value) else { return };
    let last = covariance.nrows() - 1;
    let own = covariance[(last, last)];
    let half = (value - interval.0).max(interval.1 - value);
    let stretch = half * half / (FALL_95 * own);
    if !(stretch > 1.0 && stretch.is_finite()) {
        return;
    }
    let along: Vec<f64> = (0..last).map(|row| covariance[(row, last)]).collect();
    for row in 0..last {
        for column in 0..last {
            covariance[(row, column)] += along[row] * along[column] / own * (stretch - 1.0);
        }
        covariance[(row, last)] *= stretch;
        covariance[(last, row)] *= stretch;
    }
    covariance[(last, last)] *= stretch;
}

#[cfg(test)]
mod tests;
