//! Appraisal: what a model leaves, and how likely that is as noise.
//!
//! In: a model. Out: the residual of every channel, outliers marked, and the noise with the greatest likelihood on the rows
//! that are fitted. Two models are compared by their likelihoods, each with the noise that suits it best: an effect that a
//! wandering sensor explains as well is then worth nothing.

use crate::course::Course;
use crate::model::Model;
use crate::noise::{self, Noise};
use crate::observations;
use crate::outliers;
use crate::parallel;
use crate::study::{Scene, Study};

/// How often a likelihood is worked out until the noise of a channel is known, at least.
const ESTIMATES: usize = 20;

/// What a model leaves.
pub(crate) struct Appraisal {
    /// For each scene and channel.
    pub(crate) residuals: Vec<Vec<Vec<f64>>>,
    pub(crate) outliers: Vec<Vec<Vec<bool>>>,
    pub(crate) noises: Vec<Vec<Noise>>,
    /// Minus twice the log-likelihood of all channels.
    pub(crate) deviance: f64,
}

impl Appraisal {
    /// Appraises a model.
    pub(crate) fn new(study: &Study<'_>, model: &Model) -> Self {
        let mut appraisal =
            Self { residuals: Vec::new(), outliers: Vec::new(), noises: Vec::new(), deviance: 0.0 };
        for scene in 0..study.scenes.len() {
            let course = Course::new(study, scene, model);
            appraisal.add(study, scene, observations::residuals(study, scene, model, &course));
        }
        appraisal
    }

    fn add(&mut self, study: &Study<'_>, scene: usize, residuals: Vec<Vec<f64>>) {
        let known = &study.scenes[scene];
        let fitted = known.fitted_rows();
        let work = residuals.len() * known.rows() * ESTIMATES;
        let results = parallel::counted(residuals.len(), work, |channel| {
            let residual = &residuals[channel];
            let observed = &known.channels[channel];
            let apart = |row: usize, distance: f64| known.returns.apart(residual, row, distance);
            let marks = outliers::mark(residual, observed.rounding, &apart);
            let counts = |row: usize| fitted[row] && residual[row].is_finite() && !marks[row];
            let valid: Vec<bool> = (0..residual.len()).map(counts).collect();
            (marks, estimate(known, channel, residual, &valid))
        });
        let mut marks = Vec::new();
        let mut noises = Vec::new();
        for (mark, (noise, deviance)) in results {
            marks.push(mark);
            noises.push(noise);
            self.deviance += deviance;
        }
        self.outliers.push(marks);
        self.noises.push(noises);
        self.residuals.push(residuals);
    }

    /// White noise of the same sizes.
    pub(crate) fn as_white(&self) -> Vec<Vec<Noise>> {
        self.noises.iter().map(|channels| channels.iter().map(Noise::as_white).collect()).collect()
    }

    /// Takes the marks of outliers over into the study.
    pub(crate) fn mark(&self, study: &mut Study<'_>) {
        for (scene, marks) in study.scenes.iter_mut().zip(&self.outliers) {
            for (channel, mark) in scene.channels.iter_mut().zip(marks) {
                channel.outliers.clone_from(mark);
            }
        }
    }
}

/// The noise of a channel, which is what does not come back of its residual, and minus twice the log-likelihood of all of it as
/// such noise.
fn estimate(known: &Scene<'_>, channel: usize, residual: &[f64], valid: &[bool]) -> (Noise, f64) {
    let (time, observed) = (&known.recording.time, &known.channels[channel]);
    if observed.returning.is_empty() {
        return noise::estimate(time, residual, valid, observed.rounding);
    }
    let (left, factor) = known.returns.beside(&observed.returning, residual, valid);
    let found = noise::estimate(time, &left, valid, observed.rounding).0;
    let noise = Noise {
        white: (factor * found.white).max(observed.rounding),
        wander: factor * found.wander,
        ..found
    };
    (noise, noise::deviance(time, residual, valid, &noise))
}
