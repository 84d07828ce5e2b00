//! Gathering: all pictures of a diagnosis. In: what the model left before, the fitted model. Out: the pictures.

use super::channel::{self, Sight};
use super::{Picture, Pictures, circle, contribution, distribution};
use crate::channel::ChannelAt;
use crate::course::Course;
use crate::engine::Found;
use crate::model::Model;
use crate::study::Study;
use crate::weights::Outliers;
use crate::zeros;

/// The residuals of the known calibration, and the samples that were left out then: outliers are judged anew with the findings.
pub(crate) struct Before {
    pub(crate) residuals: Vec<Vec<Vec<f64>>>,
    pub(super) outliers: Outliers,
}

/// How many recordings are drawn.
const RECORDINGS: usize = 6;
/// How many channels are drawn of all of them.
const CHANNELS: usize = 12;
/// How many samples are drawn of all channels, and of one at most and at least.
const SAMPLES: usize = 2600;
const OF_A_CHANNEL: (usize, usize) = (120, 1200);

impl Before {
    /// What a model leaves, and which samples are left out beside it.
    pub(crate) fn new(study: &Study<'_>, bare: &Model, outliers: &Outliers) -> Self {
        Self { residuals: zeros::residuals(study, bare), outliers: outliers.clone() }
    }

    /// The pictures. `counts` tells which channels count for the rms, and the factor to its unit; `findings` are the numbers of
    /// the model's effects in the order of the findings.
    pub(crate) fn draw(
        self,
        study: &Study<'_>,
        found: &Found,
        counts: (&dyn Fn(crate::channel::Kind) -> bool, f64),
        findings: &[usize],
    ) -> Pictures {
        let (model, outliers) = (&found.fit.model, &found.appraisal.weights.outliers);
        let after = zeros::residuals(study, model);
        let drawn = study.scenes.len().min(RECORDINGS);
        let channels: usize = study.scenes[..drawn].iter().map(|scene| scene.channels.len()).sum();
        let samples = (SAMPLES / channels.clamp(1, CHANNELS)).clamp(OF_A_CHANNEL.0, OF_A_CHANNEL.1);
        let mut free = CHANNELS;
        let recordings = (0..drawn).map(|scene| {
            let course = Course::new(study, scene, model);
            let sight = Sight { study, scene, course: &course, model, outliers, samples };
            let known = &study.scenes[scene].channels;
            let chosen = known.len().min(free);
            free -= chosen;
            let of_channel = |number: usize| {
                let residuals = (self.residuals[scene][number].as_slice(), after[scene][number].as_slice());
                let outliers = self.outliers.of(ChannelAt { scene, channel: number });
                channel::draw(&sight, number, residuals, outliers, counts.0)
            };
            Picture {
                recording: scene,
                channels: (0..chosen).map(of_channel).collect(),
                of: known.len(),
                circle: circle::draw(&sight, &self.residuals[scene], &after[scene]),
            }
        });
        let recordings = recordings.collect();
        Pictures {
            recordings,
            contributions: contribution::draw(study, found, &after, counts, findings),
            distributions: distribution::draw(study, &self, (&after, outliers), counts),
        }
    }
}
