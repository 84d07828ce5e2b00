//! Sine and cosine.
//!
//! In: angles. Out: agreement with values worked out to ninety digits, and with the standard library, whose algorithm is another.

use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};

use abbe_runtime::math::{sin_cos, sin_cos_each};
use proptest::prelude::*;

/// How many units in the last place of the expected number lie between.
fn units_between(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / (expected.abs().next_up() - expected.abs())
}

fn bits((sine, cosine): (f64, f64)) -> [u64; 2] {
    [sine, cosine].map(|number| if number.is_nan() { f64::NAN.to_bits() } else { number.to_bits() })
}

/// Angles, and their sines and cosines rounded from ninety digits. The quarters are as near to multiples of a quarter turn as
/// numbers come to them: the 263 205th differs from it by 2e-16. Those of 1.06, -4.46 and 15.2 need what three parts of a quarter
/// turn leave over.
#[test]
fn values_are_those_of_ninety_digits() {
    let quarters = 263_205.0 * FRAC_PI_2;
    for (angle, sine, cosine) in [
        (0.1, 0.099_833_416_646_828_15, 0.995_004_165_278_025_8),
        (FRAC_PI_4, FRAC_1_SQRT_2, FRAC_1_SQRT_2.next_down()),
        (1.0, 0.841_470_984_807_896_5, 0.540_302_305_868_139_8),
        (1.06, 0.872_355_482_344_986_3, 0.488_872_081_860_527_5),
        (FRAC_PI_2, 1.0, 6.123_233_995_736_766e-17),
        (PI, 1.224_646_799_147_353_2e-16, -1.0),
        (-2.5, -0.598_472_144_103_956_5, -0.801_143_615_546_933_7),
        (-6.0, 0.279_415_498_198_925_86, 0.960_170_286_650_366),
        (22.0, -0.008_851_309_290_403_876, -0.999_960_826_394_637_1),
        (355.0, -3.014_435_335_948_845e-5, -0.999_999_999_545_659),
        (100_000.0, 0.035_748_797_972_016_51, -0.999_360_807_438_212_4),
        (quarters, 1.0, -2.275_653_995_178_154_4e-16),
        (999_999.5, -0.756_251_087_561_678, 0.654_281_508_650_351),
        (1e-8, 1e-8, 1.0),
    ] {
        let (found_sine, found_cosine) = sin_cos(angle);
        assert!(units_between(found_sine, sine) <= 1.0, "the sine of {angle} is {sine}, not {found_sine}");
        assert!(
            units_between(found_cosine, cosine) <= 1.0,
            "the cosine of {angle} is {cosine}, not {found_cosine}"
        );
    }
}

#[test]
fn smallest_angles_are_their_own_sines() {
    for angle in [0.0, f64::MIN_POSITIVE, 5e-324, 1e-200, 1e-9] {
        for angle in [angle, -angle] {
            assert_eq!(bits(sin_cos(angle)), bits((angle, 1.0)), "{angle}");
        }
    }
}

#[test]
fn what_is_no_angle_has_none_and_leaves_its_neighbours_alone() {
    for none in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let ([first, second], [third, fourth]) = sin_cos_each([none, 0.5]);
        assert!(first.is_nan() && third.is_nan());
        assert_eq!(bits((second, fourth)), bits(sin_cos(0.5)));
    }
}

/// Angles of a machine, and any number, such as a file may hold.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        -10.0..10.0,
        -1e6..1e6,
        (-640_000..640_000).prop_map(|n| f64::from(n) * FRAC_PI_2),
        any::<f64>()
    ]
}

proptest! {
    #[test]
    fn both_are_those_of_the_standard_library_to_a_unit(angle in angle()) {
        let (found, expected) = (sin_cos(angle), angle.sin_cos());
        if angle.is_finite() {
            prop_assert!(units_between(found.0, expected.0) <= 1.0, "{found:?} is not {expected:?}");
            prop_assert!(units_between(found.1, expected.1) <= 1.0, "{found:?} is not {expected:?}");
        } else {
            prop_assert!(found.0.is_nan() && found.1.is_nan());
        }
    }

    #[test]
    fn an_angle_turned_back_has_the_same_cosine_and_the_other_sine(angle in angle()) {
        let (sine, cosine) = sin_cos(angle);
        prop_assert_eq!(bits(sin_cos(-angle)), bits((-sine, cosine)));
    }

    #[test]
    fn several_angles_have_the_bits_of_one(
        near in prop::array::uniform8(-1e6..1e6), any in prop::array::uniform8(angle()),
    ) {
        for angles in [near, any] {
            let (sines, cosines) = sin_cos_each(angles);
            for ((sine, cosine), angle) in sines.into_iter().zip(cosines).zip(angles) {
                prop_assert_eq!(bits((sine, cosine)), bits(sin_cos(angle)));
            }
        }
        // One by itself is often beyond what several near ones are: then all that there are are far.
        for angle in any {
            let ([sine], [cosine]) = sin_cos_each([angle]);
            prop_assert_eq!(bits((sine, cosine)), bits(sin_cos(angle)));
        }
        let three = [near[0], any[1], near[2]];
        let (sines, cosines) = sin_cos_each(three);
        for (k, angle) in three.into_iter().enumerate() {
            prop_assert_eq!(bits((sines[k], cosines[k])), bits(sin_cos(angle)));
        }
    }
}
