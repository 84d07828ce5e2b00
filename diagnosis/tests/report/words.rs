//! The text for a terminal: what must stand in it, and the whole of each case, pinned after it was read.

use abbe_diagnosis::diagnosis::{Diagnosis, Estimate, OverTravel, Parameter, ParameterValue, Repeats};
use abbe_diagnosis::report;
use model_dsl::calibration::{CalibratedTerm, SeriesInput};
use model_dsl::machine::ElementKind;

use crate::cases;

/// The text with every run of white space as one space, so that line ends do not matter.
fn flat(diagnosis: &Diagnosis) -> String {
    report::text(diagnosis).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The text of a diagnosis whose first finding has one parameter.
fn with(name: &'static str, value: f64, ci95: (f64, f64), unit: &str) -> String {
    let mut diagnosis = cases::two_findings();
    let value = ParameterValue::Fitted(Estimate { value, ci95, unit: unit.to_owned() });
    diagnosis.findings[0].parameters = vec![Parameter { name, value }];
    flat(&diagnosis)
}

#[test]
fn each_case_as_it_was_read() {
    for (name, diagnosis) in cases::all() {
        let text = report::text(&diagnosis);
        let widest = text.lines().map(|line| line.chars().count()).max().unwrap();
        assert!(widest <= 100, "{name} has {widest} columns");
        let mut settings = insta::Settings::clone_current();
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name, text));
    }
}

#[test]
fn the_verdict_stands_in_one_line_of_plain_words() {
    let said = |diagnosis: Diagnosis| report::verdict(&diagnosis);
    assert_eq!(
        said(cases::two_findings()),
        "left-out physics: 2 effects explain more than 99 % of what the model missed; held-out rms falls from 12.5 um to \
         0.60 um, noise 0.50 um"
    );
    assert!(said(cases::wrong_files()).starts_with(
        "wrong files, and left-out physics: 2 faults and 2 effects explain more than 99 % of what the model missed"
    ));
    assert!(said(cases::clock_only()).contains("of the instruments, not of the machine (clock)"));
    assert!(said(cases::unexplained()).contains("in measured.z, x from 174.7 to 201.0 mm"));
    assert!(said(cases::not_repeatable()).contains("differ by 7.1 um, but the noise gives only 0.10 um"));
}

#[test]
fn the_findings_explain_what_the_residual_came_down_by_whatever_their_shares() {
    let mut diagnosis = cases::two_findings();
    diagnosis.findings[1].share = 0.01;
    // Of 1.25^2 - 0.5^2 above the noise 0.75^2 - 0.5^2 stay: 24 %.
    (diagnosis.before, diagnosis.after) =
        (cases::residual(0.0012, 0.001_25), cases::residual(0.0007, 0.000_75));
    assert!(report::verdict(&diagnosis).contains("2 effects explain 76 % of"));
    // Down to the noise, and still not all.
    diagnosis.after.holdout_rms = Some(0.000_5);
    assert!(report::verdict(&diagnosis).contains("2 effects explain more than 99 % of"));
}

#[test]
fn one_measurement_that_separates_several_names_stands_once() {
    let mut diagnosis = cases::two_findings();
    for other in &mut diagnosis.findings[1].alternatives {
        other.separate_by = "record at two heights".to_owned();
    }
    let names = "expansion of EXX, expansion of EZZ, expansion of EXZ, expansion of EYX; to separate: record at two heights";
    assert!(flat(&diagnosis).contains(names));
}

/// A person at the machine looks for the part that turns so often, and for its size on the drawing.
#[test]
fn a_wave_is_named_after_what_it_repeats_with() {
    let worm = ElementKind::Worm { teeth: 180 };
    let encoder = ElementKind::Encoder { lines: 18_000 };
    let millimetres = |element, period, harmonic| Repeats { element, period, unit: "mm", harmonic };
    for (repeats_with, sentence) in [
        (vec![cases::repeats(worm, 2.0, 1)], "Here the period is a turn of the worm (180 teeth, 2 deg)."),
        (
            vec![cases::repeats(worm, 2.0, 3)],
            "Here the period is a third of a turn of the worm (180 teeth, 2 deg).",
        ),
        (
            vec![cases::repeats(encoder, 0.02, 4)],
            "Here the period is a quarter of a line of the encoder (18000 a turn, 0.02 deg).",
        ),
        (vec![cases::repeats(ElementKind::Axis, 360.0, 1)], "Here it occurs once per turn of the axis."),
        (
            vec![cases::repeats(ElementKind::Axis, 360.0, 4), cases::repeats(ElementKind::Motor, 90.0, 1)],
            "Here it occurs 4 times per turn of the axis, and the period is a turn of the motor (90 deg).",
        ),
        (
            vec![millimetres(ElementKind::Motor, 5.0, 1), millimetres(ElementKind::Screw, 10.0, 2)],
            "Here the period is a turn of the motor (5 mm), or half the pitch of the screw (10 mm).",
        ),
        (
            vec![millimetres(ElementKind::Scale, 0.02, 1)],
            "Here the period is the grating of the scale (20 um).",
        ),
    ] {
        let said = flat(&cases::wave(repeats_with.clone()));
        assert!(said.contains(sentence), "{said}");
        // The page sets units in its own way.
        let page = report::html(&cases::wave(repeats_with), &report::Origin::default());
        assert!(page.contains(sentence.split(" (").next().unwrap()), "{page}");
    }
    assert!(!flat(&cases::wave(Vec::new())).contains(" Here "));
}

#[test]
fn friction_is_not_called_play() {
    assert!(
        flat(&Diagnosis { findings: vec![cases::backlash("drive")], ..cases::two_findings() })
            .contains("friction in the following error and not a gap")
    );
    for side in ["transmission", "structure", "unknown"] {
        let findings = vec![cases::backlash(side)];
        assert!(!flat(&Diagnosis { findings, ..cases::two_findings() }).contains("friction"), "{side}");
    }
    let mut lag = cases::backlash("drive");
    (lag.term, lag.location.state) = ("lag", "velocity");
    lag.calibrated = CalibratedTerm::Lag { axis: 1, gain: 30.0, frequency: 0.0 };
    assert!(!flat(&Diagnosis { findings: vec![lag], ..cases::two_findings() }).contains("friction"));
}

#[test]
fn a_lost_motion_below_zero_sends_to_the_sign_of_the_sensor() {
    let ahead = |value: f64| {
        with("lost_motion", value, (value - 0.001, value + 0.001), "mm").contains("sign of the sensor")
    };
    assert!(ahead(-0.006) && !ahead(0.006) && !ahead(-0.0005));
}

#[test]
fn an_acceleration_below_zero_is_said_to_be_too_much_feed_forward() {
    let said = |gain: f64| {
        let mut found = cases::backlash("drive");
        (found.term, found.location.state) = ("acceleration", "acceleration");
        found.calibrated = CalibratedTerm::Acceleration { axis: 1, gain };
        let value = ParameterValue::Fitted(Estimate {
            value: gain,
            ci95: (gain - 9.0, gain + 9.0),
            unit: "1/s^2".to_owned(),
        });
        found.parameters = vec![Parameter { name: "gain", value }];
        report::text(&Diagnosis { findings: vec![found], ..cases::two_findings() })
    };
    let sentence = "the axis is ahead of its command by acceleration over gain";
    let flat = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(flat(said(-400.0)).contains(sentence) && !flat(said(400.0)).contains(sentence));
}

#[test]
fn sentences_of_a_finding_follow_each_other_with_one_space() {
    // Behind the explanation a sentence on friction, and none between.
    let text = report::text(&Diagnosis { findings: vec![cases::backlash("drive")], ..cases::two_findings() });
    let what = text.split("   what ").nth(1).unwrap().split("   how much").next().unwrap();
    let lines = what.lines().map(str::trim);
    assert!(
        lines.clone().any(|line| line.contains(". ")) && lines.clone().all(|line| !line.contains("  ")),
        "{what}"
    );
}

#[test]
fn numbers_are_rounded_to_their_uncertainty_and_stand_in_units_that_people_use() {
    let cases = [
        ("lost_motion", 0.009_83, 0.000_31, "mm", "lost motion 9.83 +- 0.31 um"),
        ("lost_motion", 0.009_83, 0.000_099_6, "mm", "lost motion 9.83 +- 0.10 um"),
        ("lost_motion", 0.009_83, 0.001_26, "mm", "lost motion 9.8 +- 1.3 um"),
        ("value", 3.088e-5, 3.1e-7, "rad", "value 30.88 +- 0.31 urad = 6.369 +- 0.064 arcsec"),
        ("lost_motion", 0.004_82, 0.000_05, "deg", "lost motion 17.35 +- 0.18 arcsec"),
        ("period", 5.0012, 0.0004, "mm", "period 5.00120 +- 0.00040 mm"),
        ("period", 1.2294, 0.0021, "deg", "period 1.2294 +- 0.0021 deg"),
        ("phase", -1.444_13, 0.02, "rad", "phase -82.7 +- 1.1 deg"),
        ("gain", 145.83, 0.52, "1/s", "gain 145.83 +- 0.52 1/s"),
        ("frequency", 48.7, 0.012, "Hz", "frequency 48.700 +- 0.012 Hz"),
        ("coefficient", 7.18e-6, 5.2e-8, "1/K", "coefficient 7.180 +- 0.052 ppm/K"),
        ("coefficient", 0.001_573, 0.000_02, "mm/K", "coefficient 1.573 +- 0.020 um/K"),
        ("coefficient", 6.32e-7, 4e-9, "rad/K", "coefficient 0.6320 +- 0.0040 urad/K"),
        ("time_constant", 705.5, 24.0, "s", "time constant 11.76 +- 0.40 min"),
        ("decay", 0.0153, 0.0012, "s", "decay 15.3 +- 1.2 ms"),
        ("height", 0.123_4, 0.013_4, "mm", "height 123 +- 13 um"),
        ("amplitude", 1234.0, 130.0, "mm", "amplitude 1230 +- 130 mm"),
    ];
    for (name, value, half, unit, words) in cases {
        let text = with(name, value, (value - half, value + half), unit);
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn a_lopsided_interval_shows_its_ends_and_a_missing_one_is_said() {
    assert!(with("gain", 16.3, (14.1, 21.0), "1/s").contains("gain 16.3 (14.1 to 21.0) 1/s"));
    assert!(with("gain", 16.3, (16.3, 16.3), "1/s").contains("the recordings do not determine its interval"));
    assert!(with("gain", f64::NAN, (0.0, 1.0), "1/s").contains("gain not known"));
}

#[test]
fn powers_are_numbered_as_the_term_counts_them() {
    let coefficients = |term: CalibratedTerm| {
        let list = vec![cases::estimate(2e-5, 1e-6, ""), cases::estimate(3e-8, 1e-9, "1/mm")];
        let mut diagnosis = cases::two_findings();
        diagnosis.findings[0].term = term.name();
        diagnosis.findings[0].calibrated = term;
        diagnosis.findings[0].parameters =
            vec![Parameter { name: "coefficients", value: ParameterValue::List(list) }];
        flat(&diagnosis)
    };
    let polynomial = CalibratedTerm::Polynomial { input: SeriesInput::Axis(1), coefficients: Vec::new() };
    assert!(coefficients(polynomial).contains("c_0 20.0 +- 1.0 ppm c_1 30.0 +- 1.0 ppm/m"));
    let coupling = CalibratedTerm::Coupling { axis: 0, coefficients: Vec::new() };
    assert!(coefficients(coupling).contains("c_1 20.0 +- 1.0 ppm c_2 30.0 +- 1.0 ppm/m"));
}

#[test]
fn a_table_is_told_by_its_ends() {
    let values = [-0.0088, -0.002, 0.0001].map(|value| cases::estimate(value, 0.0004, "mm")).to_vec();
    let mut diagnosis = cases::two_findings();
    diagnosis.findings[0].term = "table";
    diagnosis.findings[0].parameters =
        vec![Parameter { name: "values", value: ParameterValue::List(values) }];
    assert!(flat(&diagnosis).contains("values: 3 numbers, -8.80 to 0.10 um, each within 0.40 um"));
}

#[test]
fn what_is_to_be_measured_next_stands_once() {
    let mut diagnosis = cases::two_findings();
    for other in &mut diagnosis.findings[1].alternatives {
        other.separate_by = "record at two heights".to_owned();
    }
    let text = report::text(&diagnosis);
    let list = text.split("What to measure next").nth(1).unwrap();
    assert!(list.contains("1. Record at two heights\n"));
    assert_eq!(list.matches("ecord at two heights").count(), 1);
}

#[test]
fn nothing_in_a_name_moves_the_cursor() {
    let mut diagnosis = cases::adequate();
    diagnosis.recordings[0].title = Some("\u{1b}[2Jcleared\r\n".to_owned());
    assert!(report::text(&diagnosis).chars().all(|letter| letter == '\n' || !letter.is_control()));
}

#[test]
fn numbers_that_are_none_are_said_to_be_unknown() {
    let mut diagnosis = cases::two_findings();
    diagnosis.findings[0].share = f64::NAN;
    diagnosis.findings[0].evidence.with = f64::NAN;
    diagnosis.before.holdout_rms = None;
    diagnosis.noise.value = f64::NAN;
    let text = flat(&diagnosis);
    assert!(
        !text.contains("NaN")
            && text.contains("rms (nothing could be held out) falls from 12.3 um to 0.50 um")
    );
}

/// Coefficients of a curve far from zero show nobody its size: the table has its range alone, the finding both.
#[test]
fn a_curve_is_told_by_its_range_over_the_travel() {
    let mut diagnosis = cases::two_findings();
    let coefficients = [(-38.4, 7.8, ""), (1.94, 0.39, "1/mm")];
    let list = coefficients.map(|(value, half, unit)| cases::estimate(value, half, unit)).to_vec();
    let curve = &mut diagnosis.findings[0];
    curve.parameters = vec![Parameter { name: "coefficients", value: ParameterValue::List(list) }];
    curve.over_travel =
        Some(OverTravel { axis: "Y".to_owned(), range: cases::estimate(0.0098, 0.0011, "mm") });
    let text = flat(&diagnosis);
    assert_eq!(text.matches("9.8 +- 1.1 um over the travel of Y").count(), 2, "{text}");
    assert_eq!(text.matches("c_1 ").count(), 1, "{text}");
}
