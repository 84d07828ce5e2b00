//! Changes of series whose truth is known, and how often chance makes one.

use super::{change, freed, mean};
use crate::chance::{bounds, normals};
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
        untold: Vec::new(),
    }
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

/// How many quiet series are told to change with a probability below 1 %: `values` makes one from a seed.
fn changed(count: u64, values: impl Fn(u64) -> Series) -> usize {
    let told = |seed: &u64| change(&values(*seed)).is_some_and(|change| change.probability < 0.01);
    (1..=count).filter(told).count()
}

/// A first-order process: each value keeps a part of the one before it.
fn alike(seed: u64, count: usize, part: f64) -> Vec<f64> {
    // What is before the first is forgotten.
    let mut last = 0.0;
    let all = normals(seed, count + 20).into_iter().map(|noise| {
        last = part * last + noise;
        last
    });
    all.skip(20).collect()
}

#[test]
fn quiet_series_change_as_often_as_chance_has_it() {
    // Intervals that are right, and intervals three times too narrow; many recordings and few.
    for (width, count) in [(1.96, 26), (0.65, 26), (0.65, 8)] {
        let chance = changed(2000, |seed| series("backlash", &normals(seed, count), width));
        let (_, most) = bounds(2000, 0.01);
        assert!(chance <= most, "{chance} of 2000, of which {most} may be, at a width of {width}");
    }
}

#[test]
fn neighbours_that_are_alike_are_known_roughly_from_few_recordings() {
    // Nothing tells from a dozen recordings how alike neighbours are: three in a hundred in place of one.
    for count in [8, 12, 26] {
        let chance = changed(2000, |seed| series("backlash", &alike(seed, count, 0.4), 0.1));
        let (_, most) = bounds(2000, 0.03);
        assert!(chance <= most, "{chance} of 2000, of which {most} may be, of {count}");
    }
}

#[test]
fn a_fit_takes_nothing_from_how_alike_neighbours_are() {
    // The mean of 4000 series, of a standard error of 0.006; read from the residuals it is lower by (2 + 4 r) / 12, which is 0.17 and 0.27.
    for truth in [0.0, 0.3] {
        let all: f64 = (1..=4000).map(|seed| freed(of_residuals(&alike(seed, 12, truth)), 12.0, 2.0)).sum();
        assert!((all / 4000.0 - truth).abs() < 0.06, "{} for {truth}", all / 4000.0);
    }
}

/// The products of neighbours over the squares beside a line, by the textbook.
fn of_residuals(values: &[f64]) -> f64 {
    let count = f64::from(u32::try_from(values.len()).unwrap());
    let places: Vec<f64> = (0..values.len()).map(|place| f64::from(u32::try_from(place).unwrap())).collect();
    let middle = |of: &[f64]| of.iter().sum::<f64>() / count;
    let (x, y) = (middle(&places), middle(values));
    let slope = places.iter().zip(values).map(|(a, b)| (a - x) * (b - y)).sum::<f64>()
        / places.iter().map(|a| (a - x).powi(2)).sum::<f64>();
    let left: Vec<f64> = places.iter().zip(values).map(|(a, b)| b - y - slope * (a - x)).collect();
    let squares: f64 = left.iter().map(|left| left * left).sum();
    left.windows(2).map(|pair| pair.iter().product::<f64>()).sum::<f64>() / squares
}

#[test]
fn a_few_recordings_that_are_told_well_do_not_count_as_many() {
    // Two in three have intervals ten times as wide as the scatter: the others alone tell it.
    let values = |seed: u64| {
        let drawn = normals(seed, 36);
        let (scatter, noise) = drawn.split_at(18);
        let mut all = series("backlash", scatter, 0.02);
        for (place, (point, noise)) in all.points.iter_mut().zip(noise).enumerate() {
            let wide = if place.is_multiple_of(3) { 0.01 } else { 10.0 };
            point.value += wide * noise;
            (point.low, point.high) = (point.value - 1.96 * wide, point.value + 1.96 * wide);
        }
        all
    };
    let chance = changed(2000, values);
    let (_, most) = bounds(2000, 0.01);
    assert!(chance <= most, "{chance} of 2000, of which {most} may be");
}

#[test]
fn the_interval_of_a_change_holds_it() {
    let held = |count: usize, width: f64| {
        let one = |seed: &u64| {
            let noise = normals(*seed, count);
            let worn: Vec<f64> =
                noise.iter().zip(0..).map(|(noise, week)| 5.0 * f64::from(week) + noise).collect();
            let told = change(&series("backlash", &worn, width)).unwrap();
            let truth = 5.0 * f64::from(u32::try_from(count - 1).unwrap());
            assert_eq!(told.kind, "trend");
            (told.size - truth).abs() <= told.half
        };
        (1..=1000).filter(one).count()
    };
    // Neighbours that are no more alike than chance has it may only widen an interval.
    for (count, width) in [(26, 1.96), (26, 0.3), (8, 0.3)] {
        let (least, _) = bounds(1000, 0.95);
        let held = held(count, width);
        assert!((least..=995).contains(&held), "{held} of 1000, at least {least}, of {count} at {width}");
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
    let mean = mean(&series("backlash", &[1.0, 3.0, 1.0, 3.0], 0.01)).unwrap();
    // The variance of the values is 4/3, that of their mean a fourth of it, with three degrees of freedom.
    assert!((mean.value - 2.0).abs() < 1e-9 && (mean.variance - 1.0 / 3.0).abs() < 1e-3, "{mean:?}");
    assert!((mean.scatter - 4.0 / 3.0).abs() < 1e-3 && (mean.freedom - 3.0).abs() < 1e-6, "{mean:?}");
}
