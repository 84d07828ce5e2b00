//! Circles through points: laws, and a search that shares nothing with the method.

use std::f64::consts::TAU;

use abbe_evaluation::fit::{Place, least_squares, minimum_zone};
use simulation::noise::Source;

use crate::bench::near;

fn points(count: u32, radial: impl Fn(f64) -> f64) -> Vec<Place> {
    let angle = |number: u32| TAU * f64::from(number) / f64::from(count);
    let place = |angle: f64| [radial(angle) * angle.cos() + 0.07, radial(angle) * angle.sin() - 0.04];
    (0..count).map(angle).map(place).collect()
}

fn width(points: &[Place], center: Place) -> f64 {
    let distance = |point: &Place| (point[0] - center[0]).hypot(point[1] - center[1]);
    let far = points.iter().map(distance).fold(0.0, f64::max);
    far - points.iter().map(distance).fold(f64::INFINITY, f64::min)
}

/// The narrowest zone on a grid that closes in.
fn searched(points: &[Place], start: Place, mut reach: f64) -> f64 {
    let mut best = (width(points, start), start);
    while reach > 1e-10 {
        let center = best.1;
        for across in -8..=8 {
            for up in -8..=8 {
                let [dx, dy] = [across, up].map(|part| reach * f64::from(part) / 8.0);
                let other = [center[0] + dx, center[1] + dy];
                let wide = width(points, other);
                if wide < best.0 {
                    best = (wide, other);
                }
            }
        }
        reach *= 0.7;
    }
    best.0
}

#[test]
fn a_circle_is_found_exactly_and_has_no_zone() {
    let points = points(200, |_| 100.0);
    let round = least_squares(&points).unwrap();
    near(round.radius, 100.0, 1e-11);
    near(round.center[0], 0.07, 1e-11);
    near(round.center[1], -0.04, 1e-11);
    near(minimum_zone(&points, round.center).width, 0.0, 1e-10);
    // From a centre that is off it comes back.
    near(minimum_zone(&points, [0.0, 0.0]).width, 0.0, 1e-7);
}

#[test]
fn lobes_have_twice_their_amplitude() {
    for lobes in 2..9 {
        let points = points(720, |angle| 100.0 + 0.01 * (f64::from(lobes) * angle + 0.3).cos());
        let round = least_squares(&points).unwrap();
        // The rows miss the crests by at most half a step.
        let missed = 0.02 * (f64::from(lobes) * TAU / 1440.0).powi(2);
        near(minimum_zone(&points, round.center).width, 0.02, missed + 1e-6);
    }
}

#[test]
fn the_zone_is_the_narrowest_that_a_search_finds() {
    let mut source = Source::new(3, "zone");
    for case in 0..40 {
        let mut draw = || source.normal();
        let [a, b, c] = [draw(), draw(), draw()].map(|part| 0.01 * part);
        let spread: Vec<f64> = (0..60).map(|_| 0.004 * draw()).collect();
        let mut all = points(60, |_| 100.0);
        for ((point, spread), number) in all.iter_mut().zip(spread).zip(0_u32..) {
            let angle = TAU * f64::from(number) / 60.0;
            let lobes = a * (2.0 * angle).cos() + b * (3.0 * angle).sin() + c * angle.sin().signum();
            let radial = lobes + spread;
            *point = [point[0] + radial * angle.cos(), point[1] + radial * angle.sin()];
        }
        let round = least_squares(&all).unwrap();
        let zone = minimum_zone(&all, round.center);
        let wide = width(&all, round.center);
        near(zone.width, width(&all, zone.center), 1e-12);
        assert!(zone.width <= wide && zone.at_least <= zone.width, "{case}: {zone:?} {wide}");
        near(zone.at_least, zone.width, 1e-6 * zone.width + 1e-7);
        near(zone.width, searched(&all, round.center, wide), 1e-6);
    }
}

#[test]
fn the_least_squares_circle_has_the_least_squares() {
    let all = points(90, |angle| 80.0 + 0.02 * (2.0 * angle).cos() + 0.01 * angle.sin().signum());
    let round = least_squares(&all).unwrap();
    let sum = |center: Place, radius: f64| -> f64 {
        all.iter().map(|point| ((point[0] - center[0]).hypot(point[1] - center[1]) - radius).powi(2)).sum()
    };
    let least = sum(round.center, round.radius);
    for [x, y, radius] in [
        [1e-4, 0.0, 0.0],
        [-1e-4, 0.0, 0.0],
        [0.0, 1e-4, 0.0],
        [0.0, -1e-4, 0.0],
        [0.0, 0.0, 1e-4],
        [0.0, 0.0, -1e-4],
    ] {
        assert!(sum([round.center[0] + x, round.center[1] + y], round.radius + radius) > least);
    }
}

#[test]
fn what_makes_no_circle_gives_none() {
    assert_eq!(least_squares(&[]), None);
    assert_eq!(least_squares(&[[1.0, 2.0]; 50]), None);
    let line: Vec<Place> = (0..50).map(|number| [f64::from(number), 2.0 * f64::from(number)]).collect();
    assert!(least_squares(&line).is_none_or(|round| round.radius > 1e3));
    assert_eq!(minimum_zone(&[], [0.0, 0.0]).width, 0.0);
    assert!(least_squares(&[[f64::NAN, 0.0], [1.0, 0.0], [0.0, 1.0]]).is_none());
}
