//! Which elements a wave is named after: harmonics in its interval, and only where that is hardly chance.

use std::f64::consts::TAU;

use model_dsl::machine::{Element, ElementKind};

use super::{Wave, between_neighbours};

const SCREW: Element = Element { kind: ElementKind::Screw, period: 10.0 };
const MOTOR: Element = Element { kind: ElementKind::Motor, period: 5.0 };
const TABLE: Element = Element { kind: ElementKind::Axis, period: TAU };

/// A worm wheel with this number of teeth.
fn worm(teeth: u32) -> Element {
    Element { kind: ElementKind::Worm { teeth }, period: TAU / f64::from(teeth) }
}

/// A wave along 320 mm in steps of 0.5 mm, whose period is known to a share of it.
fn along(period: f64, share: f64) -> Wave {
    Wave { around: (period * (1.0 - share), period * (1.0 + share)), among: (1.0, 200.0), round: false }
}

/// A wave that comes so often in a turn of a table that has gone round in steps of a degree.
fn round(turns: u32) -> Wave {
    let around = between_neighbours(TAU / f64::from(turns)).unwrap();
    Wave { around, among: (TAU / 180.0, TAU), round: true }
}

#[test]
fn harmonics_up_to_the_fourth_are_named_and_no_others() {
    for (period, expected) in
        [(10.0, Some(1)), (5.0, Some(2)), (10.0 / 3.0, Some(3)), (2.5, Some(4)), (2.0, None), (20.0, None)]
    {
        let named = along(period, 0.001).named(&[SCREW]);
        assert_eq!(named.first().map(|(_, harmonic)| *harmonic), expected, "{period}");
    }
    assert!(along(10.3, 0.001).named(&[SCREW]).is_empty(), "3 % off");
}

#[test]
fn all_that_fit_are_named_the_lower_harmonic_first() {
    assert_eq!(along(5.0, 0.001).named(&[SCREW, MOTOR]), [(MOTOR, 1), (SCREW, 2)]);
}

/// Looked for from 1 to 200 mm, as likely in each octave as in another: an interval 1 % wide at 10 mm is half a per cent wide at
/// 5 mm, and so on. One a fifth wide covers more than a twentieth of the range with the four of them.
#[test]
fn an_interval_that_many_periods_would_share_names_nothing() {
    let chance = along(10.0, 0.005).chance(&SCREW);
    let expected = 0.01 * (1.0 + 1.0 / 2.0 + 1.0 / 3.0 + 1.0 / 4.0) / 200f64.ln();
    assert!((chance / expected - 1.0).abs() < 1e-3, "{chance}, {expected}");
    assert_eq!(along(10.0, 0.005).named(&[SCREW]).len(), 1);
    assert!(along(10.0, 0.1).named(&[SCREW]).is_empty());
    // With a second element each of them has half the chance to be named by accident.
    let (one, two) =
        (along(10.0, 0.05).named(&[SCREW]).len(), along(10.0, 0.05).named(&[SCREW, worm(1)]).len());
    assert_eq!((one, two), (1, 0));
}

/// A table that has gone round repeats in whole parts of a turn: how often is told in any case, and of a worm wheel only what
/// no neighbour is.
#[test]
fn a_table_that_has_gone_round() {
    assert_eq!(round(1).named(&[TABLE]), [(TABLE, 1)]);
    assert_eq!(round(3).named(&[TABLE, worm(90)]), [(TABLE, 3)]);
    assert_eq!(round(5).named(&[TABLE]), []);
    assert_eq!(round(90).named(&[TABLE, worm(90)]), [(worm(90), 1)]);
    assert_eq!(round(180).named(&[TABLE, worm(90)]), [(worm(90), 2)]);
    assert_eq!(round(91).named(&[TABLE, worm(90)]), []);
    // Three teeth would be met by chance by whatever comes three times a turn.
    assert_eq!(round(3).named(&[worm(3)]), []);
}
