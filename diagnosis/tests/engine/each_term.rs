//! One term alone.

use crate::testing::*;
use diagnosis::{Inputs, diagnose};

#[test]
fn trial() {
    for (machine, shape) in [("FX", line(0, 0.0, 200.0)), ("xyfz-mill", circle(100.0))] {
        let bench = Bench::of(machine);
        let known = bench.calibration("{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0.02]}}]}");
        let concealed = bench.calibration("{EXX: [{backlash: {lost_motion: 6 um}}]}");
        let truth = together(&known, &concealed);
        let mut p = path(shape, 20.0, 10.0);
        p.runs = 3;
        let instrument = if machine == "FX" { position("x") } else { position("xy") };
        let recording = bench.record(&truth, &noisy(p, instrument, 0.001, 1));
        let start = std::time::Instant::now();
        let inputs = Inputs { equations: bench.equations(), calibration: Some(&known), recordings: vec![&recording], holdout: None };
        let diagnosis = diagnose(&inputs, &mut |_| {});
        eprintln!("{machine} {} rows {:?} {:?}", recording.time.len(), start.elapsed(), diagnosis.findings);
    }
}
