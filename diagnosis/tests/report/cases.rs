//! Diagnoses by hand: one for each verdict, and the kinds of parameters.

use abbe_diagnosis::diagnosis::{
    Alternative, Change, Diagnosis, Estimate, Evidence, Finding, Interval, IntervalOf, Location,
    NoiseSummary, Parameter, ParameterValue, Repeatability, Repeats, Residual, Returning, SettingFinding,
    Summary, Unexplained, Verdict, WrongFile,
};
use model_dsl::calibration::CalibratedTerm;
use model_dsl::machine::ElementKind;

pub(crate) fn estimate(value: f64, half: f64, unit: &str) -> Estimate {
    Estimate { value, ci95: (value - half, value + half), unit: unit.to_owned() }
}

pub(crate) fn fitted(name: &'static str, value: f64, half: f64, unit: &str) -> Parameter {
    Parameter { name, value: ParameterValue::Fitted(estimate(value, half, unit)) }
}

pub(crate) fn word(name: &'static str, value: &str) -> Parameter {
    Parameter { name, value: ParameterValue::Name(value.to_owned()) }
}

pub(crate) fn residual(rms: f64, holdout_rms: f64) -> Residual {
    Residual { rms, holdout_rms: Some(holdout_rms), unit: "mm" }
}

fn summary(file: &str) -> Summary {
    Summary {
        file: file.to_owned(),
        title: Some("circle r 75 mm".to_owned()),
        instrument: "position",
        rows: 7299,
        samples: 14595,
        missing: 3,
        outliers: 1,
        runs: 3,
        held_out: "run 3".to_owned(),
    }
}

/// Nothing left out: what the other cases begin with.
pub(crate) fn adequate() -> Diagnosis {
    Diagnosis {
        machine: "xfyz-mill".to_owned(),
        recordings: vec![summary("circle.yaml")],
        verdict: Verdict::Adequate,
        noise: NoiseSummary { value: 0.0005, unit: "mm", white: 0.0004, wander: 0.0003, time_constant: 12.0 },
        before: residual(0.000_51, 0.000_5),
        after: residual(0.000_51, 0.000_5),
        ..Diagnosis::default()
    }
}

/// What comes back of Y.
pub(crate) fn returning(state: &str, share: f64, left: f64) -> Returning {
    let (channel, state) = ("measured.y".to_owned(), state.to_owned());
    Returning { recording: 0, channel, state, share, left, unit: "mm" }
}

/// The backlash of the contract's example.
pub(crate) fn backlash(side: &'static str) -> Finding {
    Finding {
        motion: "EYY".to_owned(),
        motion_number: 6,
        motion_meaning: "positioning of Y".to_owned(),
        term: "backlash",
        parameters: vec![fitted("lost_motion", 0.0098, 0.0003, "mm")],
        share: 0.83,
        location: Location {
            link: "Y".to_owned(),
            side,
            state: "direction",
            detail: "jumps at every reversal of y, both repeats".to_owned(),
            interval: None,
            at_drive: false,
            inside_loop: false,
        },
        evidence: Evidence { with: 0.0006, without: 0.0051, unit: "mm", drive: None },
        alternatives: Vec::new(),
        explanation:
            "The axis stops short of each position by half of the lost motion, on the side it comes from."
                .to_owned(),
        over_travel: None,
        repeats_with: Vec::new(),
        compensable: true,
        calibrated: CalibratedTerm::Backlash { axis: 1, lost_motion: 0.0098, wind_up: 0.0 },
        form: None,
        sensors: Vec::new(),
    }
}

/// An expansion that another one resembles.
pub(crate) fn expansion() -> Finding {
    let names = ["EXX", "EZZ", "EXZ", "EYX", "EZX"];
    let other = |motion: &str| Alternative {
        motion: motion.to_owned(),
        term: "expansion",
        separate_by: format!("move {motion}'s axis while the others stand"),
    };
    Finding {
        motion: "EXX".to_owned(),
        motion_number: 0,
        motion_meaning: "positioning of X".to_owned(),
        term: "expansion",
        parameters: vec![
            word("sensor", "scale"),
            fitted("coefficient", 7.18e-6, 0.052e-6, "1/K"),
            Parameter { name: "reference", value: ParameterValue::Given(20.0, "degC".to_owned()) },
        ],
        share: 0.13,
        location: Location {
            link: "X".to_owned(),
            side: "unknown",
            state: "temperature",
            ..Location::default()
        },
        evidence: Evidence { with: 0.0006, without: 0.0012, unit: "mm", drive: None },
        alternatives: names.map(other).to_vec(),
        explanation: "The scale of X grows with its temperature.".to_owned(),
        over_travel: None,
        repeats_with: Vec::new(),
        compensable: true,
        calibrated: CalibratedTerm::Expansion { axis: 0, sensor: 0, coefficient: 7.18e-6, reference: 20.0 },
        form: None,
        sensors: vec![(0, "scale".to_owned())],
    }
}

/// A wave along an axis that repeats with these elements.
pub(crate) fn wave(repeats_with: Vec<Repeats>) -> Diagnosis {
    let cyclic = Finding {
        motion: "ECC".to_owned(),
        motion_number: 11,
        motion_meaning: "positioning error of C".to_owned(),
        term: "cyclic",
        parameters: vec![
            fitted("period", 2.0001, 0.0004, "deg"),
            fitted("amplitude", 0.0021, 0.0002, "deg"),
            fitted("phase", 1.02, 0.09, "rad"),
        ],
        location: Location {
            link: "C".to_owned(),
            side: "transmission",
            state: "position",
            detail: "repeats every 2.0001 deg of c".to_owned(),
            ..Location::default()
        },
        explanation: abbe_diagnosis::meaning("cyclic").unwrap().to_owned(),
        calibrated: CalibratedTerm::Cyclic { axis: 3, period: 0.0349, amplitude: 36.7e-6, phase: 1.02 },
        repeats_with,
        ..backlash("transmission")
    };
    Diagnosis {
        machine: "table".to_owned(),
        verdict: Verdict::LeftOutPhysics,
        before: residual(0.0051, 0.0051),
        after: residual(0.0006, 0.0006),
        findings: vec![cyclic],
        ..adequate()
    }
}

/// The element of a table that repeats after so many degrees, of which the wave is this harmonic.
pub(crate) fn repeats(element: ElementKind, period: f64, harmonic: u32) -> Repeats {
    Repeats { element, period, unit: "deg", harmonic }
}

/// The wave of a worm.
pub(crate) fn worm() -> Diagnosis {
    wave(vec![repeats(ElementKind::Worm { teeth: 180 }, 2.0, 1)])
}

pub(crate) fn two_findings() -> Diagnosis {
    Diagnosis {
        verdict: Verdict::LeftOutPhysics,
        before: residual(0.0123, 0.0125),
        after: residual(0.0005, 0.0006),
        returns: vec![
            returning("direction of Y", 0.83, 0.0051),
            returning("direction of Y, temperature spindle", 0.981, 0.0017),
        ],
        findings: vec![backlash("transmission"), expansion()],
        settings: vec![SettingFinding {
            recording: 0,
            term: "eccentricity",
            parameters: vec![fitted("x", -0.00657, 0.00011, "mm"), fitted("y", 0.00336, 0.0001, "mm")],
            alternatives: Vec::new(),
        }],
        undecided: vec![
            "The drive's feedback was not recorded, so the side of the backlash is not known.".to_owned(),
        ],
        ..adequate()
    }
}

pub(crate) fn unexplained() -> Diagnosis {
    Diagnosis {
        verdict: Verdict::Unexplained,
        before: residual(0.00097, 0.001),
        after: residual(0.00097, 0.001),
        unexplained: Some(Unexplained {
            link: Some("X".to_owned()),
            direction: "measured.z".to_owned(),
            state: "position",
            interval: Some(Interval {
                of: IntervalOf::Axis("X".to_owned()),
                from: 174.67,
                to: 200.98,
                unit: "mm",
            }),
            rms: 0.0052,
            unit: "mm",
            detail: "a dip of 8.8 um in both directions and all runs".to_owned(),
            table_of: Some("EZX".to_owned()),
        }),
        ..adequate()
    }
}

pub(crate) fn not_repeatable() -> Diagnosis {
    Diagnosis {
        verdict: Verdict::NotRepeatable,
        before: residual(0.0078, 0.0079),
        after: residual(0.0078, 0.0079),
        repeatability: Some(Repeatability {
            between_runs: 0.0071,
            expected: 0.0001,
            unit: "mm",
            detail: "neither the order of the runs nor a temperature explains it".to_owned(),
        }),
        ..adequate()
    }
}

pub(crate) fn clock_only() -> Diagnosis {
    Diagnosis {
        verdict: Verdict::LeftOutPhysics,
        before: residual(0.0041, 0.004),
        after: residual(0.0005, 0.0005),
        settings: vec![SettingFinding {
            recording: 0,
            term: "clock",
            parameters: vec![fitted("offset", 0.0123, 0.0002, "s")],
            alternatives: vec![Alternative {
                motion: "EXX".to_owned(),
                term: "lag",
                separate_by: "record at two feeds".to_owned(),
            }],
        }],
        ..adequate()
    }
}

/// A sign and an order that are wrong, and the contract's backlash beside them.
pub(crate) fn wrong_files() -> Diagnosis {
    Diagnosis { model: vec![sign(), order()], ..two_findings() }
}

/// A table of the calibration with the wrong sign.
pub(crate) fn sign() -> Change {
    Change {
        file: WrongFile::Calibration,
        name: "calibration.yaml".to_owned(),
        line: Some(14),
        path: "errors.EBX".to_owned(),
        change: "sign",
        with: None,
        fault: "EBX has the wrong sign".to_owned(),
        remedy: "change the sign of its values".to_owned(),
        amount: Some(fitted("factor", -0.998, 0.012, "")),
        share: 0.97,
        evidence: Evidence { with: 0.0006, without: 0.0031, unit: "mm", drive: None },
        alternatives: vec!["the reading of circle.yaml has the wrong sign".to_owned()],
    }
}

fn order() -> Change {
    Change {
        file: WrongFile::Machine,
        name: "FXYZ".to_owned(),
        line: None,
        path: "topology".to_owned(),
        change: "order",
        with: Some("XFYZ".to_owned()),
        fault: "the topology is XFYZ, not FXYZ".to_owned(),
        remedy: "write the topology XFYZ".to_owned(),
        amount: None,
        share: f64::NAN,
        alternatives: Vec::new(),
        ..sign()
    }
}

pub(crate) fn all() -> Vec<(&'static str, Diagnosis)> {
    vec![
        ("adequate", adequate()),
        ("two-findings", two_findings()),
        ("unexplained", unexplained()),
        ("not-repeatable", not_repeatable()),
        ("clock-only", clock_only()),
        ("wave-of-a-worm", worm()),
        ("wrong-files", wrong_files()),
    ]
}
