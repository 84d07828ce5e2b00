//! Parts that were turned by known angles: the matrices stand here, written out.

use super::*;

/// A part of places, turned by a matrix about a centre, displaced, and read along the directions of the frame.
fn read(
    places: &[[f64; 3]],
    matrix: [[f64; 3]; 3],
    shift: [f64; 3],
    directions: &[usize],
) -> Vec<PartReading> {
    let center = [40.0, -20.0, 5.0];
    let each = places.iter().flat_map(|place| {
        directions.iter().map(move |axis| {
            let arm = [0, 1, 2].map(|part: usize| place[part] - center[part]);
            let found = center[*axis] + (0..3).map(|part| matrix[*axis][part] * arm[part]).sum::<f64>();
            let mut direction = [0.0; 3];
            direction[*axis] = 1.0;
            PartReading { direction, place: *place, deviation: found + shift[*axis] - place[*axis] }
        })
    });
    each.collect()
}

/// Points through a box of so many millimetres along X, Y, Z.
fn points(size: [f64; 3]) -> Vec<[f64; 3]> {
    let thirds = || [0.0, 0.3, 1.0].into_iter();
    let all = thirds().flat_map(|x| thirds().flat_map(move |y| thirds().map(move |z| [x, y, z])));
    all.map(|share| [0, 1, 2].map(|axis: usize| 10.0 + share[axis] * size[axis])).collect()
}

fn about_z(angle: f64) -> [[f64; 3]; 3] {
    [[angle.cos(), -angle.sin(), 0.0], [angle.sin(), angle.cos(), 0.0], [0.0, 0.0, 1.0]]
}

fn about_x(angle: f64) -> [[f64; 3]; 3] {
    [[1.0, 0.0, 0.0], [0.0, angle.cos(), -angle.sin()], [0.0, angle.sin(), angle.cos()]]
}

#[test]
fn a_rotation_is_found_exactly_also_a_large_one() {
    for degrees in [0.0, 1e-3, -0.029, 0.5, 5.0, -40.0] {
        let angle = f64::to_radians(degrees);
        let flat: Vec<PartReading> =
            read(&points([300.0, 200.0, 0.0]), about_z(angle), [0.2, -0.1, 0.0], &[0, 1]);
        let pose = PartPose::of(&flat, false);
        assert_eq!((pose.displacements, pose.rotations), ([true, true, false], [false, false, true]));
        assert!((pose.rotation()[2] - angle).abs() < 1e-12, "{degrees}: {:?}", pose.rotation());
        let room =
            PartPose::of(&read(&points([300.0, 200.0, 90.0]), about_x(angle), [0.3; 3], &[0, 1, 2]), false);
        assert_eq!(room.rotations, [true; 3]);
        let expected = [angle, 0.0, 0.0];
        assert!(room.rotation().iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-12));
    }
}

#[test]
fn the_part_is_moved_to_where_it_was_read() {
    let places = points([300.0, 200.0, 90.0]);
    let readings = read(&places, about_x(0.02), [0.0; 3], &[0, 1, 2]);
    let pose = PartPose::of(&readings, false);
    // What is left is one displacement, that of the middle.
    let left: Vec<f64> = readings
        .iter()
        .filter(|reading| reading.direction[1] == 1.0)
        .map(|reading| reading.deviation - (pose.moved(reading.place)[1] - reading.place[1]))
        .collect();
    assert!(left.iter().all(|one| (one - left[0]).abs() < 1e-10));
    // The direction that is read along Y lies in the part as the matrix, turned back, has it.
    let back = pose.back([0.0, 1.0, 0.0]);
    let expected = [0.0, 0.02_f64.cos(), -0.02_f64.sin()];
    assert!(back.iter().zip(expected).all(|(one, other)| (one - other).abs() < 1e-12), "{back:?}");
}

#[test]
fn levers_are_what_a_little_more_rotation_does() {
    let readings = read(&points([300.0, 200.0, 90.0]), about_z(0.3), [0.0; 3], &[0, 1, 2]);
    let pose = PartPose::of(&readings, false);
    let (place, direction) = ([250.0, 30.0, 80.0], [0.36, 0.48, -0.8]);
    let small = 1e-6;
    for axis in 0..3 {
        let mut more = [0.0; 3];
        more[axis] = small;
        let further = PartPose {
            rotation: UnitQuaternion::from_scaled_axis(Vector3::from(more)) * pose.rotation,
            ..pose
        };
        let along = |pose: &PartPose| Vector3::from(pose.moved(place)).dot(&Vector3::from(direction));
        let slope = (along(&further) - along(&pose)) / small;
        assert!((slope - pose.levers(direction, place)[axis]).abs() < 1e-4, "{axis}");
    }
}

#[test]
fn what_the_readings_cannot_show_is_not_free() {
    let unturned = about_z(0.0);
    let seen = |size: [f64; 3], directions: &[usize]| {
        PartPose::of(&read(&points(size), unturned, [0.0; 3], directions), false).rotations
    };
    // A flat part, one with holes of unlike depth, and one that is as deep as it is wide.
    assert_eq!(seen([300.0, 200.0, 0.0], &[0, 1]), [false, false, true]);
    assert_eq!(seen([300.0, 200.0, 1.0], &[0, 1]), [false, false, true]);
    assert_eq!(seen([300.0, 200.0, 200.0], &[0, 1]), [true; 3]);
    // Heights alone show a tilt; a line in X read along X shows none.
    assert_eq!(seen([300.0, 200.0, 0.0], &[2]), [true, true, false]);
    assert_eq!(seen([300.0, 0.0, 0.0], &[0]), [false; 3]);
    assert_eq!(seen([300.0, 0.0, 0.0], &[0, 1, 2]), [false, true, true]);
    assert_eq!(PartPose::of(&[], false).rotations, [false; 3]);
}

#[test]
fn a_constant_of_all_readings_takes_the_place_of_a_displacement() {
    let heights = read(&points([300.0, 200.0, 0.0]), about_x(0.001), [0.0, 0.0, 0.4], &[2]);
    assert_eq!(PartPose::of(&heights, false).displacements, [false, false, true]);
    let zeroed = PartPose::of(&heights, true);
    assert_eq!((zeroed.displacements, zeroed.rotations), ([false; 3], [true, true, false]));
    assert!((zeroed.rotation()[0] - 0.001).abs() < 1e-12);
}

#[test]
fn missing_readings_are_none() {
    let mut readings = read(&points([300.0, 200.0, 0.0]), about_z(0.001), [0.0; 3], &[0, 1]);
    readings[3].deviation = f64::NAN;
    readings[8].place[1] = f64::NAN;
    assert!((PartPose::of(&readings, false).rotation()[2] - 0.001).abs() < 1e-12);
}

#[test]
fn a_rotation_is_told_and_a_squareness_or_a_scale_is_not() {
    let places = points([300.0, 200.0, 0.0]);
    let angle = 5e-4;
    let found = turned(&read(&places, about_z(angle), [0.1, 0.2, 0.0], &[0, 1])).unwrap();
    assert_eq!(found.about, "Z");
    assert!((found.angle - angle).abs() < 1e-6 && found.share > 0.99, "{found:?}");
    let none: [[[f64; 3]; 3]; 4] = [
        // A squareness over a part that is as long as this one, and over a narrow one below; a scale; both sides towards each
        // other.
        [[1.0, -angle, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, 0.0, 0.0], [angle, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[1.0 + angle, 0.0, 0.0], [0.0, 1.0 - angle, 0.0], [0.0, 0.0, 1.0]],
        [[1.0, angle, 0.0], [angle, 1.0, 0.0], [0.0, 0.0, 1.0]],
    ];
    for matrix in none {
        assert_eq!(turned(&read(&places, matrix, [0.0; 3], &[0, 1])), None, "{matrix:?}");
        assert_eq!(turned(&read(&points([300.0, 20.0, 0.0]), matrix, [0.0; 3], &[0, 1])), None, "{matrix:?}");
    }
    // One direction shows no rotation, and five readings are too few.
    assert_eq!(turned(&read(&places, about_z(angle), [0.0; 3], &[0])), None);
    assert_eq!(turned(&read(&places[..5], about_z(angle), [0.0; 3], &[0, 1])), None);
}

/// Points in lines along X, each read in X and Y, beside what `noise` adds to the readings one after the other.
fn walk(angle: f64, mut noise: impl FnMut() -> f64) -> Vec<PartReading> {
    let lines = (0..10).flat_map(|line| (0..10).map(move |step| [f64::from(step), f64::from(line)]));
    let places: Vec<[f64; 3]> = lines.map(|[x, y]| [30.0 * x, 20.0 * y, 0.0]).collect();
    let mut readings = read(&places, about_z(angle), [0.0; 3], &[0, 1]);
    readings.iter_mut().for_each(|reading| reading.deviation += noise());
    readings
}

/// Even numbers from -1 to 1, each from the one before.
fn scatter(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * f64::from(u32::try_from(state >> 32).unwrap()) / f64::from(u32::MAX) - 1.0
    }
}

#[test]
fn a_rotation_below_the_scatter_is_told_and_what_wanders_is_none() {
    // 1 mrad, up to 0.14 mm from the middle, below 0.2 mm of scatter: the angle to 0.11 mrad.
    let mut even = scatter(1);
    let found = turned(&walk(1e-3, || 0.2 * even())).unwrap();
    assert!((found.angle - 1e-3).abs() < 3.3e-4 && found.share < 0.5, "{found:?}");
    // Sums of scatter go far from zero, one way here and the other there.
    let told = (2..402).filter(|seed| {
        let (mut even, mut sum) = (scatter(*seed), 0.0);
        let wandering = || {
            sum += even();
            sum
        };
        turned(&walk(0.0, wandering)).is_some()
    });
    let told = told.count();
    assert!(told <= 4, "{told} of 400");
}

#[test]
fn what_lags_behind_on_the_way_round_a_circle_is_no_rotation() {
    let places = (0..40).map(|step| {
        let angle = f64::from(step) * 0.2;
        [100.0 * angle.cos(), 100.0 * angle.sin(), 0.0]
    });
    let places: Vec<[f64; 3]> = places.collect();
    assert_eq!(turned(&read(&places, about_z(1e-3), [0.0; 3], &[0, 1])), None);
    // The same points in another order are no way round.
    let mixed: Vec<[f64; 3]> = (0..40).map(|step| places[step * 17 % 40]).collect();
    assert!(turned(&read(&mixed, about_z(1e-3), [0.0; 3], &[0, 1])).is_some());
}
