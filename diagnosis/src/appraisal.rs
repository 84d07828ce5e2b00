//! Appraisal: what a model leaves, what of that is noise, and how samples weigh.
//!
//! In: a model. Out: for every channel the residual, its outliers, the floor, and weights. The floor is the noise: what does not
//! come back of the residual. The weights are those of that noise, as long as noise is most of what is left. Where more comes
//! back than does not, or the residual moves as no sensor's noise does, the model lacks something: then every sample weighs the
//! same, and a stretch over which the residual keeps its direction counts for one. Weights of a walk would look at its steps, and
//! not at how far the machine is off. Recordings of the same channel that lack something share that weight: a diagonal on which
//! two errors cancel says no more of each of them than one on which they add up.
//!
//! Two models are compared by their likelihoods, each with the noise that suits it best: an effect that a wandering sensor
//! explains as well is then worth nothing.

use std::sync::OnceLock;

use crate::channel::ChannelAt;
use crate::course::Course;
use crate::model::Model;
use crate::noise::{self, Noise};
use crate::observations;
use crate::outliers;
use crate::parallel;
use crate::scene::Scene;
use crate::study::Study;
use crate::unsteady;
use crate::weights::{Outliers, Weights};

/// How often a likelihood is worked out until the noise of a channel is known, at least.
const ESTIMATES: usize = 20;

/// What a model leaves.
#[derive(Clone)]
pub(crate) struct Appraisal {
    /// For each scene and channel.
    pub(crate) residuals: Vec<Vec<Vec<f64>>>,
    /// How samples weigh, and which are left out.
    pub(crate) weights: Weights,
    /// What does not come back.
    pub(crate) floors: Vec<Vec<Noise>>,
    /// The sum of squares of what comes back, and the root mean square of what does not.
    pub(crate) returning: Vec<Vec<f64>>,
    pub(crate) leftover: Vec<Vec<f64>>,
    /// Minus twice the log-likelihood of all channels.
    pub(crate) deviance: f64,
    /// The same of each channel, and where its noise is flicker, if that was asked for.
    deviances: Vec<Vec<f64>>,
    flickers: OnceLock<Vec<Vec<Option<f64>>>>,
    /// The same where what never comes back is a noise that wanders, whatever the weights.
    pub(crate) wandering: f64,
}

/// What is known of one channel under a model.
#[derive(Clone)]
struct Estimate {
    floor: Noise,
    weights: Noise,
    returning: f64,
    leftover: f64,
    deviance: f64,
    wandering: f64,
    /// Which samples count, how many they are, and the sum of their squares about the mean.
    valid: Vec<bool>,
    count: f64,
    whole: f64,
}

impl Appraisal {
    /// Appraises a model.
    pub(crate) fn new(study: &Study<'_>, model: &Model) -> Self {
        Self::under(study, model, None, |scene| scene.fitted_rows())
    }

    /// Appraises a model by all rows, also those that are held out; beside another model where one is given.
    pub(crate) fn of_all_rows(study: &Study<'_>, model: &Model, other: Option<&Self>) -> Self {
        Self::under(study, model, other, |scene| vec![true; scene.rows()])
    }

    /// Appraises a model beside another one, so that their likelihoods can be compared: where samples weigh alike under that one
    /// they do so here.
    pub(crate) fn beside(study: &Study<'_>, model: &Model, other: &Self) -> Self {
        Self::under(study, model, Some(other), |scene| scene.fitted_rows())
    }

    /// `fitted` tells which rows of a scene it goes by.
    fn under(
        study: &Study<'_>,
        model: &Model,
        other: Option<&Self>,
        fitted: impl Fn(&Scene<'_>) -> Vec<bool>,
    ) -> Self {
        let (mut residuals, mut outliers, mut estimates) = (Vec::new(), Vec::new(), Vec::new());
        for scene in 0..study.scenes.len() {
            let course = Course::new(study, scene, model);
            let left = observations::residuals(study, scene, model, &course);
            let like = other.map(|other| &other.weights.noises[scene]);
            let known = &study.scenes[scene];
            let unsettled: Vec<bool> = (0..known.rows()).map(|row| course.shown.is_unsettled(row)).collect();
            let (marks, found) =
                estimated(known, &left, like, (&fitted(known), &unsettled)).into_iter().unzip();
            residuals.push(left);
            outliers.push(marks);
            estimates.push(found);
        }
        share_weights(study, &residuals, &mut estimates);
        Self::of(residuals, Outliers::new(outliers), &estimates)
    }

    fn of(residuals: Vec<Vec<Vec<f64>>>, outliers: Outliers, estimates: &[Vec<Estimate>]) -> Self {
        Self {
            residuals,
            weights: Weights { noises: each(estimates, |estimate| estimate.weights), outliers },
            floors: each(estimates, |estimate| estimate.floor),
            returning: each(estimates, |estimate| estimate.returning),
            leftover: each(estimates, |estimate| estimate.leftover),
            flickers: OnceLock::new(),
            deviances: each(estimates, |estimate| estimate.deviance),
            deviance: estimates.iter().flatten().map(|estimate| estimate.deviance).sum(),
            wandering: estimates.iter().flatten().map(|estimate| estimate.wandering).sum(),
        }
    }

    /// By how much the deviance of this model lies above that of a richer one, where the noise of a channel is flicker if it may be so
    /// beside the richer one; `None` where it may be so nowhere.
    pub(crate) fn above_in_flicker(&self, study: &Study<'_>, richer: &Self) -> Option<f64> {
        let flickers = richer.flickers(study);
        flickers.iter().flatten().any(Option::is_some).then(|| {
            let of_channel = |at: ChannelAt| {
                let known = |appraisal: &Self| appraisal.deviances[at.scene][at.channel];
                match flickers[at.scene][at.channel] {
                    Some(flicker) => self.flicker(study, at) - flicker,
                    None => known(self) - known(richer),
                }
            };
            study.channels().map(of_channel).sum()
        })
    }

    /// Minus twice the log-likelihood of every channel whose noise may be flicker: it wanders, and flicker is not much less likely.
    fn flickers(&self, study: &Study<'_>) -> &[Vec<Option<f64>>] {
        self.flickers.get_or_init(|| {
            let of_channel = |scene: usize, channel: usize| {
                let at = ChannelAt { scene, channel };
                let weights = self.weights.noise(at);
                let price = if weights.wander == 0.0 { noise::WORTH } else { -noise::WORTH };
                let flicker = (weights.alike == 1.0).then(|| self.flicker(study, at));
                flicker.filter(|flicker| *flicker < self.deviances[scene][channel] - price)
            };
            let of_scene = |(scene, residuals): (usize, &Vec<Vec<f64>>)| {
                (0..residuals.len()).map(|channel| of_channel(scene, channel)).collect()
            };
            self.residuals.iter().enumerate().map(of_scene).collect()
        })
    }

    /// Minus twice the log-likelihood of a channel whose noise is flicker.
    fn flicker(&self, study: &Study<'_>, at: ChannelAt) -> f64 {
        let (scene, outliers) = (&study.scenes[at.scene], self.weights.outliers.of(at));
        let (fitted, residual) = (scene.fitted_rows(), &self.residuals[at.scene][at.channel]);
        let counts = |row: usize| fitted[row] && residual[row].is_finite() && !outliers[row];
        let valid: Vec<bool> = (0..residual.len()).map(counts).collect();
        noise::flicker(&scene.recording.time, residual, &valid, scene.channels[at.channel].rounding)
    }

    /// Whether a model leaves more than noise of any channel.
    pub(crate) fn lacks(&self) -> bool {
        self.weights.noises.iter().flatten().any(|noise| noise.alike > 1.0)
    }

    /// By how much the held-out samples are off, squared, in units of what another appraisal leaves of each channel.
    pub(crate) fn held_out(&self, study: &Study<'_>, other: &Self) -> f64 {
        let mut sum = 0.0;
        for (scene, known) in study.scenes.iter().enumerate() {
            let fitted = known.fitted_rows();
            for (channel, residual) in self.residuals[scene].iter().enumerate() {
                let outliers = self.weights.outliers.of(ChannelAt { scene, channel });
                let counts = |row: &usize| !fitted[*row] && !outliers[*row] && residual[*row].is_finite();
                let squares: f64 = (0..residual.len()).filter(counts).map(|row| residual[row].powi(2)).sum();
                sum += squares / other.leftover[scene][channel].max(f64::MIN_POSITIVE).powi(2);
            }
        }
        sum
    }

    /// How samples weigh beside the floor alone.
    pub(crate) fn beside_floor(&self) -> Weights {
        self.weights.beside(self.floors.clone())
    }
}

/// Something of every channel of every scene.
fn each<T>(estimates: &[Vec<Estimate>], of: impl Fn(&Estimate) -> T) -> Vec<Vec<T>> {
    estimates.iter().map(|channels| channels.iter().map(&of).collect()).collect()
}

/// Samples that are left out, and the estimate, of every channel of a scene by the rows that are fitted; `like` are weights with which
/// these are to be compared. Outliers are left out, and rows in which it is not known where an axis is.
fn estimated(
    known: &Scene<'_>,
    residuals: &[Vec<f64>],
    like: Option<&Vec<Noise>>,
    (fitted, unsettled): (&[bool], &[bool]),
) -> Vec<(Vec<bool>, Estimate)> {
    let work = residuals.len() * known.rows() * ESTIMATES;
    parallel::counted(residuals.len(), work, |channel| {
        let residual = &residuals[channel];
        let apart = |row: usize, distance: f64| known.returns.apart(residual, row, distance);
        let mut marks = outliers::mark(residual, known.channels[channel].step(), &apart);
        marks.iter_mut().zip(unsettled).for_each(|(mark, unsettled)| *mark |= unsettled);
        let counts = |row: usize| fitted[row] && residual[row].is_finite() && !marks[row];
        let valid: Vec<bool> = (0..residual.len()).map(counts).collect();
        let estimate = estimate(known, channel, residual, valid, like.map(|like| like[channel]));
        (marks, estimate)
    })
}

/// Gives recordings of the same channel one weight where the model lacks something in one of them: what all of them leave.
fn share_weights(study: &Study<'_>, residuals: &[Vec<Vec<f64>>], estimates: &mut [Vec<Estimate>]) {
    if estimates.len() < 2 {
        return;
    }
    let known = estimates.to_vec();
    for (scene, channels) in estimates.iter_mut().enumerate() {
        for (channel, estimate) in channels.iter_mut().enumerate() {
            let same = like(study, &known, ChannelAt { scene, channel });
            if same.len() < 2 || !same.iter().any(|estimate| estimate.lacks()) {
                continue;
            }
            let whole: f64 = same.iter().map(|estimate| estimate.whole).sum();
            let count: f64 = same.iter().map(|estimate| estimate.count).sum();
            let time = &study.scenes[scene].recording.time;
            estimate.weigh(time, &residuals[scene][channel], (whole / count).sqrt());
        }
    }
}

/// The estimates of a channel in all recordings that read it.
fn like<'e>(study: &Study<'_>, estimates: &'e [Vec<Estimate>], at: ChannelAt) -> Vec<&'e Estimate> {
    let kind = |at| study.channel(at).kind;
    let same = |one: &ChannelAt| *one == at || one.scene != at.scene && kind(*one).reads_as(kind(at));
    study.channels().filter(same).map(|one| &estimates[one.scene][one.channel]).collect()
}

impl Estimate {
    /// Whether the model lacks something in the channel.
    fn lacks(&self) -> bool {
        self.weights.alike > 1.0
    }

    /// Weighs the samples as those of which a model leaves so much.
    fn weigh(&mut self, time: &[f64], residual: &[f64], white: f64) {
        let known = self.deviance;
        let alike = if self.lacks() { self.weights.alike } else { noise::alike(residual, &self.valid) };
        let white = white.max(self.floor.white);
        self.weights = Noise { alike: alike.max(MORE_THAN_ONE), ..Noise::white(white) };
        self.deviance = noise::deviance(time, residual, &self.valid, &self.weights);
        if self.wandering == known {
            self.wandering = self.deviance;
        }
    }
}

/// Every sample weighs the same where what comes back is more than this many times what does not: it is most of it then.
const MOSTLY: f64 = 1.0;

/// Floor and weights of a channel; `like` are weights with which these are to be compared.
fn estimate(
    known: &Scene<'_>,
    channel: usize,
    residual: &[f64],
    valid: Vec<bool>,
    like: Option<Noise>,
) -> Estimate {
    let (time, observed) = (&known.recording.time, &known.channels[channel]);
    let (left, factor) = known.returns.beside(&observed.returning, residual, &valid);
    let (found, deviance) = noise::estimate(time, &left, &valid, observed.rounding);
    let whole = squares(residual, &valid);
    let alone = squares(&left, &valid);
    let returning = (whole - alone).max(0.0);
    let floor = Noise {
        white: (factor * found.white).max(observed.rounding),
        wander: factor * found.wander,
        ..found
    };
    let count = crate::number(valid.iter().filter(|valid| **valid).count()).max(1.0);
    let leftover = (alone / count).sqrt();
    let plainly = match like {
        Some(like) => like.alike > 1.0,
        None => returning > MOSTLY * alone || found.only_wanders(time) || moves(known, residual, &valid),
    };
    if plainly {
        let alike = like.map_or_else(|| noise::alike(residual, &valid), |like| like.alike);
        let weights = Noise {
            alike: alike.max(MORE_THAN_ONE),
            ..Noise::white((whole / count).sqrt().max(floor.white))
        };
        // Where nothing comes back, a noise that wanders may be all there is.
        let again = !observed.returning.is_empty();
        let plain = noise::deviance(time, residual, &valid, &weights);
        let wandering = if again { plain } else { deviance };
        return Estimate {
            floor,
            weights,
            returning,
            leftover,
            deviance: plain,
            wandering,
            valid,
            count,
            whole,
        };
    }
    // Where nothing comes back, the noise with the greatest likelihood is the floor itself.
    let same = returning == 0.0 && floor.white == found.white;
    let deviance = if same { deviance } else { noise::deviance(time, residual, &valid, &floor) };
    Estimate {
        floor,
        weights: floor,
        returning,
        leftover,
        deviance,
        wandering: deviance,
        valid,
        count,
        whole,
    }
}

/// Samples of what a model leaves out never count for themselves.
const MORE_THAN_ONE: f64 = 1.0 + 1e-9;

/// Whether a residual moves as no sensor's noise does.
fn moves(known: &Scene<'_>, residual: &[f64], valid: &[bool]) -> bool {
    let counted: Vec<f64> =
        residual.iter().zip(valid).map(|(value, valid)| if *valid { *value } else { f64::NAN }).collect();
    unsteady::keeps_on(&known.recording.time, &counted, known.given.step).is_some()
}

/// The sum of squares about the mean.
fn squares(residual: &[f64], valid: &[bool]) -> f64 {
    let known = || residual.iter().zip(valid).filter(|(_, valid)| **valid).map(|(value, _)| *value);
    let mean = known().sum::<f64>() / crate::number(known().count()).max(1.0);
    known().map(|value| (value - mean).powi(2)).sum()
}

#[cfg(test)]
mod tests;
