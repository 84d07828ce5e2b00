//! Sine and cosine of 32 bits, against those of 64 bits of the standard library.

use abbe_runtime::single::math::{sin_cos, sin_cos_each};

/// How many units in the last place of the expected number lie between.
fn units_between(found: f32, expected: f64) -> f64 {
    let near = (expected as f32).abs();
    (f64::from(found) - expected).abs() / f64::from(near.next_up() - near)
}

/// Every 641st angle from a millionth of a radian to 3000 rad; with a step of 1 all of them were compared, with the same outcome.
#[test]
fn both_are_those_of_64_bits_to_four_fifths_of_a_unit() {
    let ends = [1e-6_f32, 3000.0].map(f32::to_bits);
    for bits in (ends[0]..=ends[1]).step_by(641) {
        let angle = f32::from_bits(bits);
        let ((sine, cosine), expected) = (sin_cos(angle), f64::from(angle).sin_cos());
        let units = [units_between(sine, expected.0), units_between(cosine, expected.1)];
        assert!(units.iter().all(|units| *units <= 0.8), "{angle}: {units:?}");
        let turned_back = sin_cos(-angle);
        assert_eq!([turned_back.0.to_bits(), turned_back.1.to_bits()], [(-sine).to_bits(), cosine.to_bits()]);
    }
}

/// The angles that come nearest to multiples of a quarter turn: what is left of them needs all three parts of it.
#[test]
fn multiples_of_a_quarter_turn() {
    for quarters in -1900_i16..=1900 {
        let angle = (f64::from(quarters) * core::f64::consts::FRAC_PI_2) as f32;
        let ((sine, cosine), expected) = (sin_cos(angle), f64::from(angle).sin_cos());
        assert!(units_between(sine, expected.0) <= 0.8, "{quarters}: {sine} is not {}", expected.0);
        assert!(units_between(cosine, expected.1) <= 0.8, "{quarters}: {cosine} is not {}", expected.1);
    }
}

#[test]
fn what_is_too_far_has_none_and_leaves_its_neighbours_alone() {
    for none in [3000.1, -1e6, f32::INFINITY, f32::NAN] {
        let ([first, second], [third, fourth]) = sin_cos_each([none, 0.5]);
        assert!(first.is_nan() && third.is_nan(), "{none}");
        assert_eq!((second, fourth), sin_cos(0.5));
    }
}

#[test]
fn smallest_angles_are_their_own_sines() {
    for angle in [0.0, f32::MIN_POSITIVE, 1e-45, 1e-10] {
        assert_eq!([sin_cos(angle).0, sin_cos(-angle).0], [angle, -angle]);
        assert_eq!(sin_cos(angle).1, 1.0);
    }
}
