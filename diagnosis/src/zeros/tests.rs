//! Zeros that are weighed plainly.

use super::*;
use crate::model::{Effect, Fitted};
use crate::noise::Noise;
use crate::side::Side;
use crate::testing::{Bench, circle, noisy, path, position};

#[test]
fn plain_zeros_are_means_beside_effects_that_stay() {
    let bench = Bench::of("XFY");
    let truth = bench.calibration("{EXX: [{backlash: {lost_motion: 9 um}}]}");
    let mut scenario = noisy(path(circle(40.0), 20.0, 20.0), position("xy"), 2e-4, 3);
    scenario.measurement.noise.walk = Some(simulation::noise::Walk { sigma: 0.01, after: 30.0 });
    let recording = bench.record(&truth, &scenario);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let zero = |channel: usize, value: f64| Fitted {
        effect: Effect::setting(0, Setting::Offset { channel }),
        coefficients: vec![value],
    };
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let shape = Shape::Backlash { axis: 0, wind_up: 0.0 };
    let play = Fitted { effect: Effect { place, shape }, coefficients: vec![0.007] };
    // Wherever the zeros stood before, and however large the noise is taken to be.
    for (start, size) in [(0.0, 1e-4), (0.05, 3e-3)] {
        let mut model = Model::of([zero(0, start), zero(1, -start), play.clone()]).with_settings(2);
        let weights = Weights::of_all(&study, vec![vec![Noise::white(size); 2]]);
        weigh_plainly(&study, &mut model, &weights);
        assert_eq!(model.effects[2], play);
        let fitted = study.scenes[0].fitted_rows();
        for residual in &residuals(&study, &model)[0] {
            let counted = residual.iter().zip(&fitted).filter(|(value, fits)| value.is_finite() && **fits);
            let (sum, count) =
                counted.fold((0.0, 0.0), |(sum, count), (value, _)| (sum + value, count + 1.0));
            assert!(count > 100.0 && (sum / count).abs() < 1e-9, "{} of {count}", sum / count);
        }
    }
}
