//! Distributions. In: residuals before and after. Out: how many samples fell into each of equal classes.

use super::channel::reach;
use super::{Before, Distribution};
use crate::channel::{ChannelAt, Kind};
use crate::study::Study;
use crate::weights::Outliers;

/// How many classes there are, at least and at most.
const CLASSES: (usize, usize) = (15, 81);

/// Before, after, and after where held out (left out where nothing was), over the channels that count.
pub(super) fn draw(
    study: &Study<'_>,
    before: &Before,
    (after, outliers): (&[Vec<Vec<f64>>], &Outliers),
    (counts, factor): (&dyn Fn(Kind) -> bool, f64),
) -> Vec<Distribution> {
    let mut samples: [Vec<f64>; 3] = Default::default();
    for (scene, known) in study.scenes.iter().enumerate() {
        let fitted = known.fitted_rows();
        for (number, _) in known.channels.iter().enumerate().filter(|(_, channel)| counts(channel.kind)) {
            let at = ChannelAt { scene, channel: number };
            let [left_out_before, left_out] = [&before.outliers, outliers].map(|outliers| outliers.of(at));
            for (row, fits) in fitted.iter().enumerate() {
                let (old, new) = (before.residuals[scene][number][row], after[scene][number][row]);
                if old.is_finite() && !left_out_before[row] {
                    samples[0].push(old * factor);
                }
                if new.is_finite() && !left_out[row] {
                    samples[1].push(new * factor);
                    if !fits {
                        samples[2].push(new * factor);
                    }
                }
            }
        }
    }
    let ends = samples.iter().map(|samples| reach(samples)).fold(0.0, f64::max);
    let ends = if ends > 0.0 { ends } else { 1.0 };
    // The square root of the number of samples; an odd number, so that zero is inside of one.
    let classes = samples[1].len().isqrt().clamp(CLASSES.0, CLASSES.1) | 1;
    let width = 2.0 * ends / crate::number(classes);
    let edges: Vec<f64> = (0..=classes).map(|class| crate::number(class) * width - ends).collect();
    let kinds = [(false, false), (true, false), (true, true)];
    let of = |((after, held_out), samples): ((bool, bool), &Vec<f64>)| {
        let (mut counts, mut beyond) = (vec![0; classes], 0);
        for sample in samples {
            match crate::index((sample + ends) / width) {
                // The greatest sample stands on the last edge.
                Some(class) if sample.abs() <= ends => counts[class.min(classes - 1)] += 1,
                _ => beyond += 1,
            }
        }
        (!samples.is_empty()).then(|| Distribution { after, held_out, edges: edges.clone(), counts, beyond })
    };
    kinds.into_iter().zip(&samples).filter_map(of).collect()
}
