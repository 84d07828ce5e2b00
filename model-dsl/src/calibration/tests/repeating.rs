//! Tables that begin again: over a turn of a rotary axis, and after a period. In: calibration files. Out: the curves read, or findings.

use std::f64::consts::{PI, TAU};

use super::*;

/// The curve of these error motions, and the codes of what was found.
fn curve(errors: &str) -> (Curve, Reported) {
    let (calibration, findings) = read_file(&with_error_motions(errors));
    let term = calibration.unwrap_or_else(|| panic!("{findings:?}")).motions.remove(0).terms.remove(0).value;
    let CalibratedTerm::Table { curve, .. } = term else { panic!("{term:?}") };
    (curve, findings)
}

/// What the runtime reads of a curve at places.
fn read_at(curve: &Curve, places: &[f64]) -> Vec<f64> {
    let table = curve.runtime().unwrap();
    places.iter().map(|place| table.value(*place, abbe_runtime::Direction::Positive)).collect()
}

fn close(found: &[f64], expected: &[f64]) {
    assert!(
        found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12),
        "{found:?}"
    );
}

#[test]
fn a_table_over_one_turn_of_a_rotary_axis_repeats() {
    for nodes in ["start: 0 deg, step: 90 deg", "at: [0, 90, 180, 270, 360], per: deg"] {
        let (turn, findings) =
            curve(&format!("ECC: [{{table: {{{nodes}, unit: rad, values: [0, 1, 2, 3, 0]}}}}]"));
        assert!(turn.repeats && findings.is_empty());
        assert_eq!(turn.period(), Some(TAU));
        close(&read_at(&turn, &[TAU + PI / 4.0, -PI / 4.0, -9.0 * PI]), &[0.5, 1.5, 2.0]);
    }
    let (falling, _) =
        curve("ECC: [{table: {start: 180 deg, step: -120 deg, unit: rad, values: [0, 1, 2, 0]}}]");
    assert!(falling.repeats);
    close(&read_at(&falling, &[PI / 3.0, PI / 3.0 + TAU]), &[1.0, 1.0]);
    // Another span of it, and the same span of a slide, are held.
    assert!(!curve("ECC: [{table: {start: 0 deg, step: 90 deg, unit: rad, values: [0, 1, 0]}}]").0.repeats);
    assert!(!curve("EXX: [{table: {at: [0, 360], per: mm, unit: mm, values: [0, 0]}}]").0.repeats);
}

#[test]
fn a_table_shorter_than_its_period_goes_on_to_its_first_value() {
    let even =
        curve("EXX: [{table: {start: 0 mm, step: 2.5 mm, period: 10 mm, unit: mm, values: [0, 4, 1, -3]}}]")
            .0;
    assert_eq!(even.nodes, CurveNodes::Uniform { start: 0.0, step: 2.5 });
    let listed = curve(
        "EXX: [{table: {at: [0, 2.5, 5, 7.5], per: mm, period: 10 mm, unit: mm, values: [0, 4, 1, -3]}}]",
    )
    .0;
    let uneven =
        curve("EXX: [{table: {start: 0 mm, step: 2.5 mm, period: 20 mm, unit: mm, values: [0, 4, 1, -3]}}]")
            .0;
    assert_eq!(uneven.nodes, CurveNodes::At(vec![0.0, 2.5, 5.0, 7.5, 20.0]));
    let falling =
        curve("EXX: [{table: {start: 0 mm, step: -2.5 mm, period: 20 mm, unit: mm, values: [0, -3, 1, 4]}}]")
            .0;
    for (curve, places, values) in [
        (&even, [8.75, 18.75, -1.25], [-1.5; 3]),
        (&listed, [8.75, 18.75, -1.25], [-1.5; 3]),
        (&uneven, [7.5, 13.75, -6.25], [-3.0, -1.5, -1.5]),
        (&falling, [-7.5, 6.25, 12.5], [4.0, 2.0, 4.0]),
    ] {
        assert!(curve.repeats);
        close(&read_at(curve, &places), &values);
    }
    let (both, _) = curve(
        "ECC: [{table: {start: 0 deg, step: 90 deg, period: 360 deg, unit: rad, forward: [0, 1, 2, 3], reverse: [4, 5, 6, 7]}}]",
    );
    let CurveValues::Directed { forward, reverse } = &both.values else { panic!("{both:?}") };
    assert_eq!(
        (&forward[..], &reverse[..]),
        (&[0.0, 1.0, 2.0, 3.0, 0.0][..], &[4.0, 5.0, 6.0, 7.0, 4.0][..])
    );
}

#[test]
fn ends_of_two_values_are_told_and_a_period_is_no_shorter_than_its_table() {
    let (turn, findings) =
        curve("ECC: [{table: {start: 0 deg, step: 180 deg, unit: rad, values: [0, 1, 2]}}]");
    assert!(turn.repeats);
    assert_eq!(findings, [("W0403", "table".to_owned())]);
    let (_, findings) =
        curve("EXX: [{table: {start: 0 mm, step: 5 mm, period: 5 mm, unit: mm, values: [0, 1]}}]");
    assert_eq!(findings, [("W0403", "5 mm".to_owned())]);
    for (period, code) in
        [("4 mm", "E0419"), ("0 mm", "E0419"), ("-5 mm", "E0419"), ("5 deg", "E0307"), ("5", "E0306")]
    {
        let text = format!(
            "EXX: [{{table: {{start: 0 mm, step: 5 mm, period: {period}, unit: mm, values: [0, 1]}}}}]"
        );
        let (calibration, findings) = read_file(&with_error_motions(&text));
        // A wrong unit is told at the unit.
        let place = if code == "E0307" { "deg" } else { period };
        assert_eq!((calibration.is_none(), findings), (true, vec![(code, place.to_owned())]));
    }
}
