//! Changes of series whose truth is known, and how often chance makes one.

use super::{change, mean};
use crate::series::{Point, Series};
use recording::Moment;

/// A series with a point a week, each with the half of its interval.
fn series(term: &str, values: &[f64], half: f64) -> Series {
    let points = values.iter().zip(0..).map(|(value, week)| Point {
        time: Moment::new(week * 7 * 86_400).unwrap(),
        recording: format!("{week}.yaml"),
        value: *value,
        low: value - half,
        high: value + half,
        claimed: true,
    });
    Series {
        effect: "EXX backlash".to_owned(),
        motion: "EXX".to_owned(),
        term: term.to_owned(),
        parameter: "lost_motion".to_owned(),
        unit: "mm".to_owned(),
        points: points.collect(),
    }
}

/// Numbers of a normal distribution: twelve of a linear congruential generator together are near enough to one.
fn normals(seed: u64, count: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(state >> 33).unwrap()) / f64::from(1_u32 << 31)
    };
    (0..count).map(|_| (0..12).map(|_| next()).sum::<f64>() - 6.0).collect()
}

#[test]
fn a_trend_is_told_with_its_size_and_a_step_with_its_place() {
    let noise = normals(3, 26);
    let wear: Vec<f64> =
        noise.iter().zip(0..).map(|(noise, week)| 3.0 + 0.15 * f64::from(week) + 0.05 * noise).collect();
    let found = change(&series("backlash", &wear, 0.1)).unwrap();
    assert_eq!(found.kind, "trend");
    assert!((found.per_week - 0.15).abs() < 0.01 && found.probability < 1e-15, "{found:?}");
    assert!((found.size - 25.0 * 0.15).abs() < found.half.max(0.2));
    let crash: Vec<f64> =
        noise.iter().zip(0..).map(|(noise, week)| if week < 14 { 0.0 } else { 8.0 } + 0.5 * noise).collect();
    let found = change(&series("constant", &crash, 1.0)).unwrap();
    assert_eq!((found.kind, found.from), ("step", 14));
    assert!((found.size - 8.0).abs() < 2.0 * found.half && found.probability < 1e-10, "{found:?}");
    assert!(found.before.0.abs() < 1.0 && (found.after.0 - 8.0).abs() < 1.0);
}

#[test]
fn quiet_series_change_as_often_as_chance_has_it() {
    // Intervals that are right; intervals three times too narrow; neighbours in time that are alike.
    for (width, alike) in [(1.96, 0.0), (0.65, 0.0), (1.96, 0.4)] {
        let mut chance = 0;
        for seed in 1..=400 {
            let mut last = 0.0;
            let values: Vec<f64> = normals(seed, 26)
                .into_iter()
                .map(|noise| {
                    last = alike * last + noise;
                    last
                })
                .collect();
            chance += usize::from(change(&series("backlash", &values, width)).unwrap().probability < 0.01);
        }
        // 1 % of 400 are 4; more than 14 come once in 1e4. Alike neighbours are known from 26 points only roughly.
        let most = if alike > 0.0 { 24 } else { 14 };
        assert!(chance <= most, "{chance} of 400 at a width of {width}, alike {alike}");
    }
}

#[test]
fn few_points_and_points_of_one_moment_tell_no_change() {
    assert!(change(&series("backlash", &[1.0, 2.0, 3.0, 9.0], 0.1)).is_none());
    let mut same = series("backlash", &[1.0, 2.0, 3.0, 9.0, 9.0], 0.1);
    same.points.iter_mut().for_each(|point| point.time = Moment::new(0).unwrap());
    assert!(change(&same).is_none());
    assert!(change(&series("backlash", &[], 0.1)).is_none());
}

#[test]
fn numbers_that_are_all_the_same_do_not_change() {
    let found = change(&series("", &[2.0; 9], 0.0));
    assert!(found.is_none_or(|change| change.probability > 0.01), "a noise that stays");
    let found = change(&series("backlash", &[0.0; 9], 0.1));
    assert!(found.is_none_or(|change| change.probability > 0.01));
}

#[test]
fn one_odd_recording_is_no_step() {
    let mut values = normals(5, 20);
    values.push(40.0);
    assert!(change(&series("backlash", &values, 1.96)).unwrap().probability > 0.01);
}

#[test]
fn a_mean_scatters_as_its_values_do() {
    let (level, variance) = mean(&series("backlash", &[1.0, 3.0, 1.0, 3.0], 0.01)).unwrap();
    // The variance of the values is 4/3, that of their mean a fourth of it.
    assert!((level - 2.0).abs() < 1e-9 && (variance - 1.0 / 3.0).abs() < 1e-3, "{level} {variance}");
}
