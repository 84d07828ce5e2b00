//! Known errors that are so large that their products with one another and their own squares stand above the noise: they are
//! no physics that was left out.

use abbe_diagnosis::diagnosis::Verdict;
use simulation::Path;

use crate::common::*;
use crate::testing::*;

/// One large error of each kind, and several together.
const KNOWN: [(&str, &str); 4] = [
    ("squareness", "{EC0Y: 5 mrad}"),
    ("yaw", "{ECX: 1 mrad, EBX: 1 mrad}"),
    ("scale", "{EYY: [{polynomial: {axis: Y, per: mm, unit: um, coefficients: [0, 2]}}], ECX: 1 mrad}"),
    (
        "all",
        "{EC0Y: 5 mrad, EB0Z: -3 mrad, ECX: 1 mrad, EAY: -2 mrad, \
         EYY: [{polynomial: {axis: Y, per: mm, unit: um, coefficients: [0, 1]}}]}",
    ),
];

/// There and back along Y, away from the origins of all carriages.
fn along_y() -> Path {
    Path { at: vec![vec![275.0], vec![140.0], vec![-60.0]], runs: 4, ..path(line(1, 0.0, 280.0), 40.0, 10.0) }
}

#[test]
fn large_errors_that_are_known_leave_nothing() {
    for machine in ["FXYZ", "XYFZ"] {
        let bench = Bench::of(machine);
        for (what, errors) in KNOWN {
            let known = bench.calibration(errors);
            for seed in 0..2 {
                let scenario = noisy(along_y(), position("xyz"), 0.0003, seed);
                let diagnosis = diagnosed(&bench, &known, &[&bench.record(&known, &scenario)]);
                let said = (found(&diagnosis), &diagnosis.unexplained);
                assert_eq!(diagnosis.verdict, Verdict::Adequate, "{what} on {machine}, {seed}: {said:?}");
                assert!(diagnosis.findings.is_empty(), "{what} on {machine}, {seed}: {said:?}");
                // The noise alone, of 564 readings in each direction: within a tenth of its size.
                let left = diagnosis.after.rms;
                assert!((left / 0.0003 - 1.0).abs() < 0.1, "{what} on {machine}, {seed}: {left}");
            }
        }
    }
}
