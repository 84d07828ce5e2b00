//! Weights: how samples weigh, and which of them are left out.
//!
//! In: the noise of every channel, and marks of outliers. Out: one value that goes wherever samples are weighed. Both come from what a
//! model leaves ([`crate::appraisal`]), so that a fit says under which weights it was made, and nobody need know who judged last.

use std::sync::Arc;

use crate::channel::ChannelAt;
use crate::noise::Noise;
use crate::scene::Scene;
use crate::study::Study;

/// The samples that are left out as outliers: for each scene, channel and row. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outliers(Arc<Vec<Vec<Vec<bool>>>>);

impl Outliers {
    /// These marks.
    pub(crate) fn new(marks: Vec<Vec<Vec<bool>>>) -> Self {
        Self(Arc::new(marks))
    }

    /// No sample is left out.
    pub(crate) fn none(study: &Study<'_>) -> Self {
        let of_scene = |scene: &Scene<'_>| vec![vec![false; scene.rows()]; scene.channels.len()];
        Self::new(study.scenes.iter().map(of_scene).collect())
    }

    /// The marks of a channel, row by row.
    pub(crate) fn of(&self, at: ChannelAt) -> &[bool] {
        &self.0[at.scene][at.channel]
    }
}

/// How samples weigh.
#[derive(Clone, Debug)]
pub(crate) struct Weights {
    /// For each scene and channel.
    pub(crate) noises: Vec<Vec<Noise>>,
    pub(crate) outliers: Outliers,
}

impl Weights {
    /// All samples beside these noises.
    pub(crate) fn of_all(study: &Study<'_>, noises: Vec<Vec<Noise>>) -> Self {
        Self { noises, outliers: Outliers::none(study) }
    }

    /// The noise of a channel.
    pub(crate) fn noise(&self, at: ChannelAt) -> Noise {
        self.noises[at.scene][at.channel]
    }

    /// The same samples beside other noises.
    pub(crate) fn beside(&self, noises: Vec<Vec<Noise>>) -> Self {
        Self { noises, outliers: self.outliers.clone() }
    }

    /// The same samples beside white noise of the same sizes.
    pub(crate) fn as_white(&self) -> Self {
        self.each(Noise::as_white)
    }

    /// The same where every sample counts for itself, also in a stretch over which a residual keeps its direction.
    pub(crate) fn each_for_itself(&self) -> Self {
        self.each(|noise| Noise { alike: 1.0, ..*noise })
    }

    fn each(&self, of: impl Fn(&Noise) -> Noise) -> Self {
        self.beside(self.noises.iter().map(|channels| channels.iter().map(&of).collect()).collect())
    }
}
