//! Changes of series whose truth is known, and how often chance makes one.

use super::{change, mean};
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

/// A first-order process of a standard deviation of 1.
fn process(seed: u64, count: usize, part: f64) -> Vec<f64> {
    alike(seed, count, part).into_iter().map(|value| value * (1.0 - part * part).sqrt()).collect()
}

/// How many of `cases` quiet series pass a bound of 1 %, and one of 0.1 %. Each has `count` recordings, whose neighbours correlate by `part`.
/// Their readings have errors of `error` standard deviations of that scatter, and intervals that are right for these errors.
fn passed(cases: u64, (count, part, error): (usize, f64, f64)) -> (usize, usize) {
    let one = |seed: u64| {
        let readings = normals(seed + 1_000_003, count);
        let values = process(seed, count, part).into_iter().zip(readings);
        let values: Vec<f64> = values.map(|(scatter, reading)| scatter + error * reading).collect();
        change(&series("backlash", &values, 1.96 * error)).map_or(1.0, |change| change.probability)
    };
    let told: Vec<f64> = (1..=cases).map(one).collect();
    let below = |bound: f64| told.iter().filter(|probability| **probability < bound).count();
    (below(0.01), below(0.001))
}

#[test]
fn the_bound_holds_whatever_neighbours_have_in_common() {
    // From the fewest recordings on, alone and under readings that scatter as much.
    for count in [5, 6, 8, 12, 20, 30] {
        for (part, error) in [(0.0, 0.01), (0.3, 0.01), (0.6, 0.01), (0.0, 1.0), (0.3, 1.0), (0.6, 1.0)] {
            let (of_hundred, of_thousand) = passed(500, (count, part, error));
            let most = (bounds(500, 0.01).1, bounds(500, 0.001).1);
            assert!(
                of_hundred <= most.0 && of_thousand <= most.1,
                "{of_hundred} and {of_thousand} of 500, of which {most:?} may be, of {count} recordings, {part} alike"
            );
        }
    }
}

#[test]
fn more_than_is_guarded_against_is_mostly_seen() {
    // A drift from neighbour to neighbour passes as chance less often than once in seven.
    for count in [8, 12, 20, 30] {
        let (told, _) = passed(500, (count, 0.9, 0.01));
        assert!(told < bounds(500, 0.14).1, "{told} of 500, of {count}");
    }
}

/// A bound for each of a hundred series: what an alarm of a fleet is held against.
const OF_FLEET: f64 = 1e-4;

/// Whether there is an alarm after each week from the fifth on, about wear of so much a week, in standard deviations of the scatter.
fn alarms(seed: u64, wear: f64, (part, error): (f64, f64)) -> Vec<bool> {
    let readings = normals(seed + 1_000_003, 26);
    let worn =
        |((scatter, reading), week): ((f64, f64), i32)| scatter + error * reading + wear * f64::from(week);
    let values: Vec<f64> = process(seed, 26, part).into_iter().zip(readings).zip(0..).map(worn).collect();
    let after = |count: usize| change(&series("backlash", &values[..count], 1.96 * error));
    (5..=26).map(|count| after(count).is_some_and(|change| change.probability < OF_FLEET)).collect()
}

#[test]
fn an_alarm_about_wear_that_goes_on_stays() {
    // Of the runs, one in ten loses its alarm in any week at a wear of one standard deviation a week, one in thirty at three times that.
    for kind in [(0.0, 0.01), (0.6, 0.01)] {
        for (wear, share) in [(1.0, 0.1), (3.0, 1.0 / 30.0)] {
            let runs: Vec<Vec<bool>> = (1..=100).map(|seed| alarms(seed, wear, kind)).collect();
            assert!(runs.iter().all(|weeks| weeks[17]), "an alarm in all runs by week 22");
            let loses = |weeks: &&Vec<bool>| weeks.windows(2).any(|pair| pair[0] && !pair[1]);
            let lost = runs.iter().filter(loses).count();
            assert!(lost <= bounds(100, share).1, "{lost} of 100 runs at {wear} a week, {kind:?}");
        }
    }
}

#[test]
fn wear_that_is_plain_to_the_eye_is_told_from_six_recordings() {
    for values in [[6.00, 7.96, 10.06, 12.00, 13.97, 15.95], [6.0, 8.0, 10.0, 12.0, 14.0, 16.0]] {
        for count in [5, 6] {
            let found = change(&series("backlash", &values[..count], 0.08)).unwrap();
            assert!(found.kind == "trend" && found.probability < 1e-4, "{found:?}");
        }
    }
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

#[test]
fn values_without_intervals_scatter_as_they_do() {
    // Levels of noise: without a scatter beside nothing, any two would differ.
    for seed in 1..=20 {
        let noise = normals(seed, 23);
        let values: Vec<f64> = noise.iter().map(|noise| (0.2 * noise).exp()).collect();
        let found = change(&series("", &values, 0.0)).unwrap();
        assert!(found.probability > 1e-3, "{found:?}");
    }
}
