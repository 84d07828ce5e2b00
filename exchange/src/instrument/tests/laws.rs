//! What must hold for any measurement: how a file counts, orders and scales changes nothing, and what is not asked for is not done.

use super::{assert_near, outcome, rtl, table, values};
use proptest::prelude::*;

/// Targets, and runs over all of them.
fn measured() -> impl Strategy<Value = (Vec<f64>, Vec<Vec<f64>>)> {
    (3_usize..8, 1_usize..4).prop_flat_map(|(targets, cycles)| {
        let steps = prop::collection::vec(1_u32..40, targets);
        let values = prop::collection::vec(prop::collection::vec(-9.0..9.0_f64, targets), 2 * cycles);
        (steps, values).prop_map(|(steps, values)| {
            let sums = steps.iter().scan(0, |sum, step| {
                *sum += step;
                Some(f64::from(*sum))
            });
            (sums.collect(), values)
        })
    })
}

fn in_turns(values: &[Vec<f64>]) -> Vec<(bool, Vec<f64>)> {
    values.iter().enumerate().map(|(number, run)| (number % 2 == 0, run.clone())).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / f64::from(u32::try_from(values.len()).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The tables are the plain means of the runs of each direction, in mm.
    #[test]
    fn tables_are_means((targets, runs) in measured()) {
        let file = rtl(&targets, &in_turns(&runs));
        let found = values(&outcome("FX", "  - {motion: EXX, data: d}", &[file]).0.unwrap());
        let side = |first: usize| -> Vec<f64> {
            let at = |target: usize| -> Vec<f64> { runs.iter().skip(first).step_by(2).map(|run| run[target]).collect() };
            (0..targets.len()).map(|target| mean(&at(target)) / 1000.0).collect()
        };
        assert_near(&found.0, &targets, 1e-9);
        assert_near(&found.1, &side(0), 1e-9);
        assert_near(&found.2.unwrap(), &side(1), 1e-9);
    }

    /// In which order the cycles come is all the same.
    #[test]
    fn the_order_of_the_runs_does_not_matter((targets, mut runs) in measured()) {
        let one = outcome("FX", "  - {motion: EXX, data: d}", &[rtl(&targets, &in_turns(&runs))]).0.unwrap();
        runs.rotate_left(2);
        let other = outcome("FX", "  - {motion: EXX, data: d}", &[rtl(&targets, &in_turns(&runs))]).0.unwrap();
        let (one, other) = (values(&one), values(&other));
        assert_near(&one.1, &other.1, 1.1e-9);
        assert_near(&one.2.unwrap(), &other.2.unwrap(), 1.1e-9);
    }

    /// A file that counts from the other end of the axis gives the same positioning: targets and deviations turn, runs too.
    #[test]
    fn counting_against_the_axis_changes_nothing((targets, runs) in measured()) {
        let plain = table(&targets, &in_turns(&runs));
        let last = *targets.last().unwrap();
        let turned_targets: Vec<f64> = targets.iter().map(|target| last - target).collect();
        let turned: Vec<(bool, Vec<f64>)> = in_turns(&runs)
            .into_iter()
            .map(|(ascends, run)| (!ascends, run.iter().map(|value| -value).collect()))
            .collect();
        let turned = table(&turned_targets, &turned);
        let one = values(&outcome("FX", "  - {motion: EXX, data: d}", &[plain]).0.unwrap());
        let set = format!("  - {{motion: EXX, data: d, targets: {{origin: {last} mm, sign: -1}}}}");
        let other = values(&outcome("FX", &set, std::slice::from_ref(&turned)).0.unwrap());
        let first = targets[0];
        let least = format!("  - {{motion: EXX, data: d, targets: {{most_negative: {first} mm, sign: -1}}}}");
        let third = values(&outcome("FX", &least, &[turned]).0.unwrap());
        for other in [other, third] {
            assert_near(&one.0, &other.0, 1e-9);
            assert_near(&one.1, &other.1, 1e-9);
            assert_near(one.2.as_ref().unwrap(), &other.2.unwrap(), 1e-9);
        }
    }

    /// A straightness sensor that counts the other way, and says so, gives the same; targets against the axis do not turn it.
    #[test]
    fn a_sensor_against_the_iso_sense_changes_nothing((targets, runs) in measured()) {
        let one = outcome("FX", "  - {motion: EYX, data: d}", &[rtl(&targets, &in_turns(&runs))]).0.unwrap();
        let negated: Vec<Vec<f64>> = runs.iter().map(|run| run.iter().map(|value| -value).collect()).collect();
        let set = "  - {motion: EYX, data: d, deviations: {sign: -1}}";
        let other = outcome("FX", set, &[rtl(&targets, &in_turns(&negated))]).0.unwrap();
        let (one, other) = (values(&one), values(&other));
        assert_near(&one.1, &other.1, 1.1e-9);
        assert_near(&one.2.unwrap(), &other.2.unwrap(), 1.1e-9);
    }

    /// Whatever line is added to a straightness, the curve is the same and the line's slope is told.
    #[test]
    fn a_line_is_separated_from_straightness((targets, runs) in measured(), slope in -0.05..0.05_f64) {
        let set = "  - {motion: EYX, data: d}";
        let one = outcome("FX", set, &[rtl(&targets, &in_turns(&runs))]).0.unwrap();
        let tilted: Vec<Vec<f64>> = runs
            .iter()
            .map(|run| run.iter().zip(&targets).map(|(value, at)| value + 3.0 + slope * at).collect())
            .collect();
        let other = outcome("FX", set, &[rtl(&targets, &in_turns(&tilted))]).0.unwrap();
        let slopes = [&one, &other].map(|outcome| outcome.motions[0].parts[0].line.unwrap().slope);
        prop_assert!((slopes[1] - slopes[0] - slope / 1000.0).abs() < 1e-9);
        assert_near(&values(&one).1, &values(&other).1, 2e-9);
    }

    /// What is left of a straightness has no mean and no slope of its own.
    #[test]
    fn nothing_of_a_line_is_left((targets, runs) in measured()) {
        let one = outcome("FX", "  - {motion: EYX, data: d}", &[rtl(&targets, &in_turns(&runs))]).0.unwrap();
        let centre = one.motions[0].curve.centre();
        let middle = mean(&targets);
        let slope: f64 = centre.iter().zip(&targets).map(|(value, at)| value * (at - middle)).sum();
        prop_assert!(mean(&centre).abs() < 1e-12);
        prop_assert!(slope.abs() < 1e-9);
    }

    /// Turning the edge over separates machine and edge, whatever they are.
    #[test]
    fn a_reversal_separates_machine_and_edge((targets, forms) in measured()) {
        let (machine, edge) = (&forms[0], &forms[1]);
        let sum: Vec<f64> = machine.iter().zip(edge).map(|(one, other)| one + other).collect();
        let difference: Vec<f64> = machine.iter().zip(edge).map(|(one, other)| one - other).collect();
        let set = "  - {motion: EYX, data: a, remove: none}\n  - {motion: EYX, data: b, remove: none, turned: true}";
        let files = [sum, difference].map(|run| table(&targets, &[(true, run)]));
        let one = outcome("FX", set, &files).0.unwrap();
        let scaled = |values: &[f64]| -> Vec<f64> { values.iter().map(|value| value / 1000.0).collect() };
        assert_near(&values(&one).1, &scaled(machine), 1e-9);
        assert_near(one.motions[0].edge.as_ref().unwrap(), &scaled(edge), 1e-9);
    }
}
