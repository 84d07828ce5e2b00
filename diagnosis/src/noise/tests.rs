//! Noise against the textbook: a dense covariance matrix and its Cholesky factor, and noise of known kind.

use nalgebra::{DMatrix, DVector};
use simulation::noise::{Correlated, Noise as Drawn, Source, Walk};

use super::*;
use crate::testing::{normals, uneven};

fn deviance(time: &[f64], values: &[f64], valid: &[bool], noise: Noise) -> (f64, f64) {
    deviances(time, values, valid, [noise])[0]
}

/// The covariance of the samples that are there.
fn covariance(noise: Noise, time: &[f64], valid: &[bool]) -> DMatrix<f64> {
    let known: Vec<f64> =
        time.iter().zip(valid).filter(|(_, valid)| **valid).map(|(time, _)| *time).collect();
    DMatrix::from_fn(known.len(), known.len(), |row, column| {
        let apart = (known[row] - known[column]).abs();
        let white = if row == column { noise.white * noise.white } else { 0.0 };
        white + noise.wander * noise.wander * (-apart / noise.time_constant).exp()
    })
}

/// Uneven times with single gaps and a long one, and noise of three kinds.
fn cases() -> Vec<(Noise, Vec<f64>, Vec<bool>)> {
    let noises = [
        Noise { white: 0.7, wander: 0.0, time_constant: 3.0, alike: 1.0 },
        Noise { white: 0.3, wander: 1.4, time_constant: 2.5, alike: 1.0 },
        Noise { white: 1.0, wander: 40.0, time_constant: 900.0, alike: 1.0 },
    ];
    let case = |(seed, noise): (u64, Noise)| {
        let time = uneven(seed, 90, 0.5);
        let valid = (0..90).map(|row| row % 7 != 3 && !(40..55).contains(&row) && row != 0).collect();
        (noise, time, valid)
    };
    (1..).zip(noises).map(case).collect()
}

fn kept(values: &[f64], valid: &[bool]) -> DVector<f64> {
    DVector::from_iterator(
        valid.iter().filter(|valid| **valid).count(),
        values.iter().zip(valid).filter(|(_, valid)| **valid).map(|(value, _)| *value),
    )
}

fn whitened(noise: Noise, time: &[f64], valid: &[bool], values: &[f64]) -> Vec<f64> {
    let steps = Whitening::new(noise).steps(time, valid);
    let mut column = values.to_vec();
    whiten(&steps, &mut [0.0], &mut column);
    column
}

#[test]
fn whitening_is_the_inverse_cholesky_factor() {
    for (noise, time, valid) in cases() {
        let values = normals(11, time.len());
        let factor = covariance(noise, &time, &valid).cholesky().unwrap();
        let expected = factor.l().solve_lower_triangular(&kept(&values, &valid)).unwrap();
        let found = whitened(noise, &time, &valid, &values);
        assert!((kept(&found, &valid) - expected).amax() < 1e-9, "{noise:?}");
        assert!(found.iter().zip(&valid).all(|(value, valid)| *valid || *value == 0.0));
    }
}

#[test]
fn missing_samples_do_not_count_whatever_stands_there() {
    let (noise, time, valid) = cases().remove(1);
    let values = normals(11, time.len());
    let spoiled: Vec<f64> =
        values.iter().zip(&valid).map(|(v, valid)| if *valid { *v } else { f64::NAN }).collect();
    assert_eq!(whitened(noise, &time, &valid, &values), whitened(noise, &time, &valid, &spoiled));
}

#[test]
fn whitening_goes_on_from_stretch_to_stretch() {
    for (noise, time, valid) in cases() {
        let values = normals(12, time.len());
        let whole = whitened(noise, &time, &valid, &values);
        let mut filter = Whitening::new(noise);
        let mut state = [0.0];
        let mut pieces = Vec::new();
        for rows in [0..13, 13..14, 14..61, 61..90] {
            let steps = filter.steps(&time[rows.clone()], &valid[rows.clone()]);
            let mut column = values[rows].to_vec();
            whiten(&steps, &mut state, &mut column);
            pieces.extend(column);
        }
        assert_eq!(pieces, whole);
    }
}

#[test]
fn columns_whitened_together_are_those_whitened_alone() {
    for (noise, time, valid) in cases() {
        let steps = Whitening::new(noise).steps(&time, &valid);
        for count in 1..11 {
            let columns: Vec<f64> = (0..count).flat_map(|column| normals(20 + column, time.len())).collect();
            let alone = columns.chunks(time.len()).flat_map(|column| whitened(noise, &time, &valid, column));
            let (alone, mut states) = (alone.collect::<Vec<f64>>(), vec![0.0; columns.len() / time.len()]);
            let mut together = columns.clone();
            whiten(&steps, &mut states, &mut together);
            assert_eq!(together, alone, "{noise:?}, {count} columns");
        }
    }
}

#[test]
fn a_filter_that_has_settled_does_what_it_would_work_out() {
    let noise = Noise { white: 0.7, wander: 1.3, time_constant: 5.0, alike: 1.0 };
    let time: Vec<f64> = (0..400).map(|row| f64::from(row) * 0.25).collect();
    let valid: Vec<bool> = (0..400).map(|row| row % 97 != 3).collect();
    let mut filter = Whitening::new(noise);
    let remembered = filter.steps(&time, &valid);
    let mut forgetful = Whitening::new(noise);
    let worked_out: Vec<Step> = time
        .iter()
        .zip(&valid)
        .map(|(time, valid)| {
            forgetful.settled = None;
            forgetful.step(*time, *valid)
        })
        .collect();
    let bits = |steps: &[Step]| -> Vec<[u64; 3]> {
        steps.iter().map(|step| [step.decay, step.gain, step.weight].map(f64::to_bits)).collect()
    };
    assert_eq!(bits(&remembered), bits(&worked_out));
    assert!(remembered.windows(2).filter(|pair| pair[0].gain == pair[1].gain).count() > 200);
}

#[test]
fn the_rounding_of_a_clock_is_no_step_of_its_own() {
    let noise = Noise { white: 0.7, wander: 1.3, time_constant: 0.002, alike: 1.0 };
    let exact: Vec<f64> = (0..400).map(|row| f64::from(row) * 6.0319e-5 / 1.7).collect();
    let clock: Vec<f64> = exact.iter().map(|time| (time * 1e9).round() / 1e9).collect();
    let steps = |time: &[f64]| Whitening::new(noise).steps(time, &[true; 400]);
    for (row, (exact, seen)) in steps(&exact).into_iter().zip(steps(&clock)).enumerate() {
        let numbers = [(seen.decay, exact.decay), (seen.gain, exact.gain), (seen.weight, exact.weight)];
        assert!(
            numbers.iter().all(|(a, b)| (a - b).abs() <= 1e-4 * b),
            "row {row}: {seen:?} is not {exact:?}"
        );
    }
    let decays: Vec<f64> = steps(&clock).iter().skip(1).map(|step| step.decay).collect();
    assert!(decays.windows(2).all(|pair| pair[0] == pair[1]));
}

#[test]
fn unwhitening_is_the_transpose_and_gives_the_weights_of_least_squares() {
    for (noise, time, valid) in cases() {
        let steps = Whitening::new(noise).steps(&time, &valid);
        let (a, b) = (normals(13, time.len()), normals(14, time.len()));
        let mut back = b.clone();
        unwhiten(&steps, &mut back);
        let forth = whitened(noise, &time, &valid, &a);
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (left, right) = (product(&forth, &b), product(&a, &back));
        assert!((left - right).abs() < 1e-9 * left.abs().max(1.0), "{left} {right}");
        // There and back is the inverse of the covariance.
        let mut weights = forth;
        unwhiten(&steps, &mut weights);
        let inverse = covariance(noise, &time, &valid).cholesky().unwrap().solve(&kept(&a, &valid));
        assert!((kept(&weights, &valid) - &inverse).amax() < 1e-8 * inverse.amax());
    }
}

#[test]
fn the_deviance_is_that_of_a_normal_distribution_with_this_covariance() {
    for (noise, time, valid) in cases() {
        let values: Vec<f64> = normals(15, time.len()).iter().map(|value| 3.0 * value).collect();
        let factor = covariance(noise, &time, &valid).cholesky().unwrap();
        let y = kept(&values, &valid);
        let count = crate::number(y.len());
        let scale = y.dot(&factor.solve(&y)) / count;
        // -2 ln of the likelihood under scale times the covariance, but for n ln(2 pi).
        let logs: f64 = factor.l().diagonal().iter().map(|entry| 2.0 * entry.ln()).sum();
        let (deviance, found) = deviance(&time, &values, &valid, noise);
        assert!((found / scale - 1.0).abs() < 1e-10);
        assert!((deviance - (count * scale.ln() + logs + count)).abs() < 1e-7, "{noise:?}");
    }
}

#[test]
fn the_deviance_holds_where_a_product_of_weights_would_leave_the_numbers() {
    // 4000 weights of 1e9: their product is far beyond 1e308.
    let rows = 4000;
    let time: Vec<f64> = (0..rows).map(crate::number).collect();
    let noise = Noise { white: 1e-9, wander: 0.0, time_constant: 1.0, alike: 1.0 };
    let values: Vec<f64> = normals(16, rows).iter().map(|value| 1e-9 * value).collect();
    let squares: f64 = values.iter().map(|value| value * value / 1e-18).sum();
    let count = crate::number(rows);
    let expected = count * (squares / count).ln() + count * (1e-18_f64).ln() + count;
    let (deviance, _) = deviance(&time, &values, &vec![true; rows], noise);
    assert!((deviance - expected).abs() < 1e-6 * expected.abs(), "{deviance} {expected}");
}

#[test]
fn likelihoods_worked_out_together_are_those_worked_out_alone() {
    let noises = [
        Noise::white(0.7),
        Noise { white: 0.3, wander: 1.4, time_constant: 2.5, alike: 1.0 },
        Noise { white: 1.0, wander: 40.0, time_constant: 900.0, alike: 1.0 },
        Noise { white: 1e-3, wander: 1e-7, time_constant: 0.1, alike: 1.0 },
    ];
    let bits = |(deviance, scale): (f64, f64)| [deviance.to_bits(), scale.to_bits()];
    let even: Vec<f64> = (0..300).map(|row| 0.25 * f64::from(row)).collect();
    for time in [even, uneven(17, 300, 0.25)] {
        let valid: Vec<bool> = (0..300).map(|row| row % 97 != 3 && !(200..220).contains(&row)).collect();
        let values = normals(18, 300);
        for (found, noise) in deviances(&time, &values, &valid, noises).into_iter().zip(noises) {
            assert_eq!(bits(found), bits(deviance(&time, &values, &valid, noise)), "{noise:?}");
            // And what the filter that whitens columns says of the same samples.
            let white = whitened(noise, &time, &valid, &values);
            let steps = Whitening::new(noise).steps(&time, &valid);
            let count = crate::number(valid.iter().filter(|valid| **valid).count());
            let scale = white.iter().map(|value| value * value).sum::<f64>() / count;
            let logs: f64 =
                steps.iter().filter(|step| step.weight > 0.0).map(|step| -2.0 * step.weight.ln()).sum();
            assert!((found.1 / scale - 1.0).abs() < 1e-12, "{noise:?}");
            assert!((found.0 - (count * scale.ln() + logs + count)).abs() < 1e-8, "{noise:?}");
        }
    }
}

fn drawn(noise: Drawn, time: &[f64], seed: u64) -> Vec<f64> {
    let mut values = vec![0.0; time.len()];
    noise.apply(time, &mut values, &mut Source::new(seed, "noise"));
    values
}

fn all(time: &[f64]) -> Vec<bool> {
    vec![true; time.len()]
}

#[test]
fn white_noise_is_told_as_white() {
    let time = uneven(1, 2000, 0.1);
    let mut wandering = 0;
    for seed in 0..12 {
        let (noise, _) = estimate(&time, &drawn(Drawn::white(0.8), &time, seed), &all(&time), 0.0);
        // The standard deviation of the estimate is 0.8 / sqrt(4000) = 0.013.
        assert!((noise.white.hypot(noise.wander) - 0.8).abs() < 0.06, "{noise:?}");
        wandering += usize::from(noise.wander > 0.0);
    }
    assert!(wandering <= 2, "white noise was called wandering {wandering} times of 12");
}

#[test]
fn a_wandering_sensor_is_told_with_its_time_constant() {
    let time = uneven(2, 3000, 0.1);
    let correlated = Correlated { sigma: 1.5, time_constant: 2.0 };
    let kind = Drawn { white: 1.0, correlated: Some(correlated), ..Drawn::default() };
    let truth = Noise { white: 1.0, wander: 1.5, time_constant: 2.0, alike: 1.0 };
    let (mut logs, seeds) = ([0.0; 3], 6);
    for seed in 0..seeds {
        let values = drawn(kind, &time, seed);
        let (noise, least) = estimate(&time, &values, &all(&time), 0.0);
        assert!(
            least <= deviance(&time, &values, &all(&time), truth).0 + 1e-2,
            "the truth is likelier: {noise:?}"
        );
        for (log, ratio) in logs.iter_mut().zip([noise.white, noise.wander / 1.5, noise.time_constant / 2.0])
        {
            assert!((0.5..2.0).contains(&ratio), "{noise:?}");
            *log += ratio.ln() / crate::number(6);
        }
    }
    // 75 times the time constant in each: some 15 % each, 6 % in the mean.
    assert!(logs[0].abs() < 0.03 && logs[1].abs() < 0.15 && logs[2].abs() < 0.3, "{logs:?}");
}

#[test]
fn a_random_walk_is_told_by_its_rate() {
    let time: Vec<f64> = (0..2000).map(|row| 0.1 * f64::from(row)).collect();
    let kind = Drawn { white: 0.5, walk: Some(Walk { sigma: 6.0, after: 200.0 }), ..Drawn::default() };
    for seed in 0..4 {
        let (noise, _) = estimate(&time, &drawn(kind, &time, seed), &all(&time), 0.0);
        // Both spread by so much variance a second while they are young.
        let rate = 2.0 * noise.wander * noise.wander / noise.time_constant;
        assert!((0.4..2.5).contains(&(rate / (36.0 / 200.0))), "{noise:?}");
        assert!((noise.white / 0.5 - 1.0).abs() < 0.12, "{noise:?}");
        assert!(noise.time_constant > 10.0, "{noise:?}");
    }
}

#[test]
fn estimates_see_through_gaps() {
    let time = uneven(3, 3000, 0.1);
    let correlated = Correlated { sigma: 2.0, time_constant: 1.0 };
    let kind = Drawn { white: 1.0, correlated: Some(correlated), ..Drawn::default() };
    let mut values = drawn(kind, &time, 5);
    let valid: Vec<bool> = (0..3000).map(|row| row % 3 != 0 && !(900..1400).contains(&row)).collect();
    values.iter_mut().zip(&valid).filter(|(_, valid)| !**valid).for_each(|(value, _)| *value = f64::NAN);
    let (noise, deviance) = estimate(&time, &values, &valid, 0.0);
    assert!(deviance.is_finite());
    assert!((noise.white - 1.0).abs() < 0.2 && (noise.wander - 2.0).abs() < 0.6, "{noise:?}");
    assert!((0.5..2.0).contains(&noise.time_constant), "{noise:?}");
}

/// Of a residual that is quieter than the rounding allows, the likelihood is that of the noise that is told; a larger one beside it is less
/// likely, and not more.
#[test]
fn what_is_quieter_than_the_rounding_is_as_likely_as_that_allows() {
    let time: Vec<f64> = (0..400).map(f64::from).collect();
    let wandering = Correlated { sigma: 1e-3, time_constant: 8.0 };
    let kinds = [Drawn::white(1e-3), Drawn { white: 1e-3, correlated: Some(wandering), ..Drawn::default() }];
    for kind in kinds {
        let quiet = drawn(kind, &time, 9);
        let mut moved = quiet.clone();
        moved.iter_mut().enumerate().filter(|(row, _)| row % 40 < 4).for_each(|(_, value)| *value += 0.08);
        let [(_, quiet), (_, moved)] = [quiet, moved].map(|values| {
            let (noise, found) = estimate(&time, &values, &all(&time), 0.029);
            let dense = deviance_of(&time, &values, noise);
            assert!((found - dense).abs() < 1e-6 * dense.abs(), "{found} {dense}");
            (noise, found)
        });
        assert!(moved > quiet, "{moved} {quiet}");
    }
}

/// By the covariance matrix.
fn deviance_of(time: &[f64], values: &[f64], noise: Noise) -> f64 {
    let valid = all(time);
    let root = covariance(noise, time, &valid).cholesky().unwrap();
    let values = kept(values, &valid);
    2.0 * root.l().diagonal().iter().map(|entry| entry.ln()).sum::<f64>() + values.dot(&root.solve(&values))
}

#[test]
fn noise_is_never_below_the_rounding() {
    let time: Vec<f64> = (0..100).map(f64::from).collect();
    let (noise, _) = estimate(&time, &[0.0; 100], &all(&time), 2.9e-5);
    assert_eq!(noise.white, 2.9e-5);
    // Nothing but missing samples, or no samples at all: still numbers.
    let (noise, _) = estimate(&time, &[f64::NAN; 100], &[false; 100], 2.9e-5);
    assert!(noise.white.is_finite() && noise.white > 0.0, "{noise:?}");
    let (noise, _) = estimate(&[], &[], &[], 2.9e-5);
    assert!(noise.white.is_finite() && noise.white > 0.0, "{noise:?}");
}

#[test]
fn differences_tell_the_fast_part_whatever_drifts_below() {
    let mut values: Vec<f64> = normals(21, 5000)
        .iter()
        .zip(0_u32..)
        .map(|(value, row)| 0.4 * value + 0.02 * f64::from(row))
        .collect();
    values[77] = f64::NAN;
    values[200] = 1e6;
    assert!((from_differences(&values) / 0.4 - 1.0).abs() < 0.06, "{}", from_differences(&values));
    assert_eq!(from_differences(&[]), 0.0);
}

#[test]
fn rounding_is_told_from_the_values_themselves() {
    let values: Vec<f64> = normals(22, 3000).iter().map(|value| 300.0 + value).collect();
    // 0.1 um, 5 um, 0.02 mm, a tenth of a thousandth of an inch, a thousandth of a degree.
    for step in [1e-4, 5e-3, 0.02, 25.4e-4, 1e-3_f64.to_radians()] {
        let mut rounded: Vec<f64> = values.iter().map(|value| (value / step).round() * step).collect();
        rounded[3] = f64::NAN;
        // The error of rounding is even over the step.
        assert!((rounding(&rounded) / (step / 12f64.sqrt()) - 1.0).abs() < 1e-6, "{step}");
    }
    assert!(rounding(&values) < 1e-6, "what was not rounded has next to none");
    assert!(
        [&[][..], &[0.0], &[f64::NAN]].iter().all(|values| rounding(values) > 0.0 && rounding(values) < 1e-6)
    );
}

#[test]
fn the_typical_step_is_the_median() {
    assert_eq!(typical_step(&[0.0, 1.0, 2.0, 3.0, 60.0]), 1.0);
    assert!(typical_step(&[]) > 0.0);
}

#[test]
fn white_noise_of_the_same_size_has_the_same_variance() {
    let noise = Noise { white: 3.0, wander: 4.0, time_constant: 7.0, alike: 1.0 };
    assert_eq!(noise.as_white(), Noise { white: 5.0, wander: 0.0, time_constant: 7.0, alike: 1.0 });
}

#[test]
fn stations_at_whole_steps_are_no_display() {
    // Targets at whole millimetres, read with errors below a micrometre: the display shows tenths of one.
    let read: Vec<f64> = (0..120).map(|row| f64::from(row % 12) + 1e-4 * f64::from(row / 12)).collect();
    assert!((display_step(&read) / 1e-4 - 1.0).abs() < 1e-6, "{}", display_step(&read));
    let further: Vec<f64> = read.iter().map(|value| value + 0.3).collect();
    assert!((display_step(&further) / display_step(&read) - 1.0).abs() < 1e-6);
}

#[test]
fn the_likelihood_of_a_given_noise_is_that_of_a_dense_covariance() {
    for (noise, time, valid) in cases() {
        let values = normals(31, time.len());
        let covariance = covariance(noise, &time, &valid);
        let known = kept(&values, &valid);
        let factor = covariance.cholesky().unwrap();
        let logs: f64 = factor.l().diagonal().iter().map(|value| 2.0 * value.ln()).sum();
        let expected = known.dot(&factor.solve(&known)) + logs;
        let found = super::deviance(&time, &values, &valid, &noise);
        assert!((found - expected).abs() < 1e-8 * expected.abs(), "{found} {expected}");
        // Ten samples that count for one say a tenth.
        let shared = super::deviance(&time, &values, &valid, &Noise { alike: 10.0, ..noise });
        assert!((shared - expected / 10.0).abs() < 1e-8 * expected.abs(), "{shared}");
    }
}

#[test]
fn samples_count_for_one_over_the_time_in_which_they_are_alike() {
    let rows = 20_000;
    let white = alike(&normals(32, rows), &vec![true; rows]);
    assert!((1.0..1.5).contains(&white), "{white}");
    // Of noise that decays by the factor e in tau rows, 2 tau rows count for one.
    for tau in [5.0, 40.0] {
        let time: Vec<f64> = (0..rows).map(crate::number).collect();
        let correlated = Correlated { sigma: 1.0, time_constant: tau };
        let kind = Drawn { white: 0.0, correlated: Some(correlated), ..Drawn::default() };
        let found = alike(&drawn(kind, &time, 33), &vec![true; rows]);
        assert!((found / (2.0 * tau) - 1.0).abs() < 0.35, "{tau}: {found}");
    }
    // However long it goes on, some stretches are told apart; and nothing at all is one sample.
    let slope: Vec<f64> = (0..600).map(f64::from).collect();
    assert!((alike(&slope, &[true; 600]) - 50.0).abs() < 1e-9);
    assert_eq!(alike(&[], &[]), 1.0);
    assert_eq!(alike(&[2.0; 9], &[true; 9]), 1.0);
}

#[test]
fn what_wanders_without_a_white_part_is_no_sensor() {
    let time: Vec<f64> = (0..2000).map(|row| 0.01 * f64::from(row)).collect();
    let kind = |white: f64| Drawn {
        white,
        correlated: Some(Correlated { sigma: 1.0, time_constant: 3.0 }),
        ..Drawn::default()
    };
    let found = |white: f64| estimate(&time, &drawn(kind(white), &time, 34), &all(&time), 0.0).0;
    assert!(found(1e-6).only_wanders(&time));
    assert!(!found(0.5).only_wanders(&time));
    assert!(!Noise::white(1.0).only_wanders(&time));
}
