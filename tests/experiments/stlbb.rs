//! The simultaneous laser ball bars of Schmitz and Ziegert: unequal gains of position loops.
//!
//! In: the printed following error and lags. Out: three gains, the faces of a diamond, the ellipse of a circle, and what a
//! diagnosis makes of a circle; against the steady state and the frequency response of first-order loops.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::bench::{Bench, commands, diagnosed, driven, found, off, parameter, recorded};

const CASE: &str = "stlbb-gains";

/// The feed of the oblique rectangle and of the circles, mm/s.
const FAST: f64 = 1778.0 / 60.0;

/// Equation (2): 520 um behind at 508 mm/min.
fn gain_x() -> f64 {
    508.0 / 60.0 / 0.520
}

/// Equation (1): on a leg of equal speeds of X and Y, Y is 410 um further behind.
fn gain_y() -> f64 {
    let speed = FAST * FRAC_1_SQRT_2;
    speed / (speed / gain_x() + 0.410)
}

/// Equation (3): X is 138 um further behind than Z; beta lies between the leg and the X-Z plane.
fn gain_z(beta: f64) -> f64 {
    let speed = FAST * FRAC_1_SQRT_2 * beta.cos();
    speed / (speed / gain_x() - 0.138)
}

/// Rounded to two decimals, as the paper prints gains.
#[track_caller]
fn prints(value: f64, printed: f64) {
    assert!((value - printed).abs() < 0.005 + 1e-9, "{value} is not printed as {printed}");
}

#[test]
fn the_printed_lags_give_the_printed_gains() {
    prints(gain_x(), 16.28);
    prints(gain_x() - gain_y(), 3.93);
    prints(gain_y(), 12.35);
    // Beta is not printed; with tan(beta) = 2 the printed difference comes out, and with no other simple leg.
    let printed = 2.0_f64.atan();
    assert!((gain_x() - gain_z(printed) + 5.13).abs() < 0.03, "{}", gain_z(printed));
    prints(gain_x() - gain_z(0.0), -1.96);
    prints(gain_x() - gain_z((1.0_f64 / 3.0).sqrt().asin()), -2.46);
}

/// Equation (4) is a difference of the two before it; what it prints is another number.
#[test]
fn the_fourth_equation_contradicts_itself() {
    let by_its_terms = (gain_x() - 3.93) - (gain_x() + 5.13);
    prints(by_its_terms, -9.06);
    assert!((by_its_terms + 8.84).abs() > 0.2);
    // What Y is behind Z on a leg of equal speeds, for either difference: both are "approximately 700 um".
    let speed = FAST * FRAC_1_SQRT_2;
    let behind = |difference: f64| 1e3 * speed * (1.0 / gain_y() - 1.0 / (gain_y() - difference));
    assert!((behind(-8.84) - 708.0).abs() < 1.0, "{}", behind(-8.84));
    assert!((behind(-9.06) - 718.0).abs() < 1.0, "{}", behind(-9.06));
}

/// Two faces of a diamond move apart and two together, each by the offset v/2 (1/Ky - 1/Kx): in mm, v in mm/s.
fn faces(speed: f64, gains: [f64; 2]) -> f64 {
    4.0 * speed / 2.0 * (1.0 / gains[1] - 1.0 / gains[0])
}

/// Distances across both pairs of faces of the simulated diamond, counterclockwise from its right corner, in mm.
fn diamond(side: f64, speed: f64) -> [f64; 2] {
    let bench = Bench::of(&format!("docs/cases/{CASE}/machine.yaml"));
    let plant = bench.plant(&bench.calibration_of(&format!("docs/cases/{CASE}/true.yaml")));
    let corner = side * FRAC_1_SQRT_2;
    let corners = [[corner, 0.0], [0.0, corner], [-corner, 0.0], [0.0, -corner], [corner, 0.0]];
    let lasts = side / speed;
    let at = |time: f64| {
        let gone = (time / lasts).min(4.0 - 1e-12);
        let (from, to) = match gone {
            ..1.0 => (corners[0], corners[1]),
            ..2.0 => (corners[1], corners[2]),
            ..3.0 => (corners[2], corners[3]),
            _ => (corners[3], corners[4]),
        };
        let place = |axis: usize| from[axis] + (to[axis] - from[axis]) * gone.fract();
        vec![place(0), place(1), 0.0]
    };
    let commands = commands(3, 0.01, 4.0 * lasts, at);
    let path = driven(&plant, &commands);
    // Each face by the mean of its middle, along its outward normal.
    let normals = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    let mut sums = [(0.0, 0.0); 4];
    for (time, place) in commands.time.iter().zip(&path) {
        let gone = time / lasts;
        let face = sums.iter_mut().zip(&normals).zip([0.0, 1.0, 2.0, 3.0]);
        for (((sum, count), normal), number) in face {
            if (0.4..0.9).contains(&(gone - number)) {
                *sum += (normal[0] * place[0] + normal[1] * place[1]) * FRAC_1_SQRT_2;
                *count += 1.0;
            }
        }
    }
    let [upper_right, upper_left, lower_left, lower_right] = sums.map(|(sum, count)| sum / count);
    // The faces along (1, 1) and those along (-1, 1).
    [lower_right + upper_left, upper_right + lower_left]
}

/// What is off between a prediction and a print, in percent.
fn percent(predicted: f64, printed: f64) -> f64 {
    100.0 * (predicted / printed - 1.0)
}

#[test]
fn the_faces_of_the_diamond_come_out_as_predicted() {
    // Feed, path measured, part machined, and what the prediction is off, as the page says.
    let rows = [(508.0, 0.3438, 0.3344, -3.6, -0.9, 0.3313), (889.0, 0.5837, 0.5839, -0.7, -0.7, 0.5798)];
    for (feed, measured, machined, off_path, off_part, page) in rows {
        let theory = faces(feed / 60.0, [gain_x(), gain_y()]);
        assert!((theory - page).abs() < 0.00006, "{theory}");
        let [first, second] = diamond(30.7162, feed / 60.0);
        // The calibration has the gains to two decimals.
        assert!((first - second - theory).abs() < 0.001, "{feed}: {first} - {second}, theory {theory}");
        // Both faces by the same, to either side.
        assert!((first + second - 2.0 * 30.7162).abs() < 0.0002, "{first} {second}");
        assert!((percent(theory, measured) - off_path).abs() < 0.06, "{}", percent(theory, measured));
        assert!((percent(theory, machined) - off_part).abs() < 0.06, "{}", percent(theory, machined));
    }
}

/// The diamonds by themselves: the gain of Y that each asks for.
#[test]
fn the_diamonds_ask_for_the_gain_of_equation_one() {
    let gain = |feed: f64, faces: f64| 1.0 / (1.0 / gain_x() + faces / (2.0 * feed / 60.0));
    prints(gain(508.0, 0.3438), 12.24);
    prints(gain(889.0, 0.5837), 12.33);
    // On a leg (1, 1, 1), which the figure's three planes would suggest, Y's gain would be another.
    let speed = FAST / 3.0_f64.sqrt();
    let other = speed / (speed / gain_x() + 0.410);
    assert!((percent(faces(508.0 / 60.0, [gain_x(), other]), 0.3438) - 18.0).abs() < 0.5);
}

/// Half axes in mm and the direction of the longer one from +X in degrees, of a circle behind first-order loops.
fn ellipse(radius: f64, speed: f64, gains: [f64; 2], clockwise: bool) -> (f64, f64, f64) {
    let angular = speed / radius;
    let [x, y] = gains.map(|gain| radius / (1.0 + (angular / gain).powi(2)).sqrt());
    let behind = (angular / gains[1]).atan() - (angular / gains[0]).atan();
    let cross = x * y * behind.sin() * if clockwise { 1.0 } else { -1.0 };
    let (sum, difference) = (x * x + y * y, x * x - y * y);
    let root = difference.hypot(2.0 * cross);
    let angle = 0.5 * (2.0 * cross).atan2(difference).to_degrees();
    (((sum + root) / 2.0).sqrt(), ((sum - root) / 2.0).sqrt(), angle.rem_euclid(180.0))
}

/// The same of the simulated path: the largest and the smallest radius of the second time round, and where.
fn traced(radius: f64, speed: f64, clockwise: bool) -> (f64, f64, f64) {
    let bench = Bench::of(&format!("docs/cases/{CASE}/machine.yaml"));
    let plant = bench.plant(&bench.calibration_of(&format!("docs/cases/{CASE}/true.yaml")));
    let (turn, sense) = (TAU * radius / speed, if clockwise { -1.0 } else { 1.0 });
    let at = |time: f64| {
        let angle = sense * time * speed / radius;
        vec![radius * angle.cos(), radius * angle.sin(), 0.0]
    };
    let commands = commands(3, turn / 4000.0, 2.0 * turn, at);
    let path = driven(&plant, &commands);
    let places = path
        .iter()
        .skip(4000)
        .map(|place| (place[0].hypot(place[1]), place[1].atan2(place[0]).to_degrees().rem_euclid(180.0)));
    let largest = places.clone().fold((0.0, 0.0), |best, place| if place.0 > best.0 { place } else { best });
    let smallest = places.fold(f64::INFINITY, |least, (radius, _)| least.min(radius));
    (largest.0, smallest, largest.1)
}

#[test]
fn a_circle_becomes_an_ellipse_that_turns_with_the_direction() {
    for (radius, clockwise, page) in [(25.0, false, 137.4), (25.0, true, 42.6), (60.0, false, 136.0)] {
        let theory = ellipse(radius, FAST, [16.28, 12.35], clockwise);
        let path = traced(radius, FAST, clockwise);
        assert!((path.0 - theory.0).abs() < 1e-4 && (path.1 - theory.1).abs() < 1e-4, "{path:?} {theory:?}");
        assert!((path.2 - theory.2).abs() < 0.3, "{path:?} {theory:?}");
        assert!((theory.2 - page).abs() < 0.05, "{theory:?}");
        // To first order the half axes differ by v (1/Ky - 1/Kx), whatever the radius: half of the diamond's faces.
        let apart = FAST * (1.0 / 12.35 - 1.0 / 16.28);
        assert!((theory.0 - theory.1 - apart).abs() < 0.01 * apart, "{theory:?} {apart}");
    }
    assert!((FAST * (1.0 / 12.35 - 1.0 / 16.28) - 0.579).abs() < 0.001);
}

#[test]
fn a_diagnosis_names_unequal_lags_and_no_squareness() {
    for (path, exact) in [("circle", 0.03), ("ballbar", 0.4)] {
        let (file, name) = (format!("{path}.yaml"), format!("stlbb-{path}"));
        let recording = recorded(CASE, "true.yaml", &file, "known.yaml", &name);
        let diagnosis = diagnosed(&[&recording]);
        assert_eq!(diagnosis["verdict"], "left-out-physics");
        let mut names = found(&diagnosis);
        names.sort();
        assert_eq!(names, ["EXX lag", "EYY lag"], "{path}");
        for (finding, truth) in [("EXX lag", 16.28), ("EYY lag", 12.35)] {
            let gain = parameter(&diagnosis, finding, "gain");
            assert!(off(gain, truth) < 1.7 && (gain.0 - truth).abs() < exact, "{path}: {finding} {gain:?}");
        }
    }
}

/// Round and round one way, the ellipse of unequal lags is that of a squareness. It is the starts that tell them apart: a slide
/// that lags starts late, and nothing else does.
#[test]
fn one_way_it_is_the_starts_that_tell_lags_from_a_squareness() {
    let recording = recorded(CASE, "true.yaml", "one-way.yaml", "known.yaml", "stlbb-one-way");
    let diagnosis = diagnosed(&[&recording]);
    let mut names = found(&diagnosis);
    names.sort();
    assert_eq!(names, ["EXX lag", "EYY lag"]);
    for (finding, truth) in [("EXX lag", 16.28), ("EYY lag", 12.35)] {
        let gain = parameter(&diagnosis, finding, "gain");
        assert!(off(gain, truth) < 1.7, "{finding} {gain:?}");
    }
}
