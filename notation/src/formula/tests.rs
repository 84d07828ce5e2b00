//! Formulas by hand: terms as a person would write them.

use super::*;
use model_dsl::calibration::AxisName;

fn names() -> MachineNames {
    let axis = |letter: &str, rotary| AxisName { letter: letter.to_owned(), rotary, follows: Vec::new() };
    let motion = |name: &str, angular| MotionName {
        name: name.to_owned(),
        angular,
        axis: None,
        own: false,
        counted: Vec::new(),
    };
    MachineNames {
        machine: "mill".to_owned(),
        constants: Vec::new(),
        turning: None,
        axes: vec![axis("X", false), axis("Y", false), axis("C", true)],
        motions: vec![motion("EXX", false), motion("EBX", true)],
        unseen: Vec::new(),
    }
}

fn written(term: &CalibratedTerm, motion: usize) -> Formula {
    let mut known = model_dsl::calibration::Calibration::new("mill", Vec::new());
    known.sensor("bed");
    formula(term, motion, &names(), &known.sensors)
}

#[test]
fn terms_are_written_as_people_do() {
    let within = Within { from: 0.0, to: 350.0 };
    let x = Factor::Position { axis: 0, power: 1, within: Within::EVERYWHERE };
    let play = CalibratedTerm::Backlash { axis: 0, lost_motion: 0.0076, wind_up: 0.0 };
    let one = |value: f64| CalibratedTerm::Constant { value };
    let warm =
        Factor::Temperature { sensor: 0, reference: 20.0, time_constant: 0.0, within: Within::EVERYWHERE };
    let cases = [
        (one(0.01), "0.01 mm"),
        (play.clone(), "-0.0038 mm * d_X"),
        (
            play.clone().times(vec![Factor::Fading { axis: 0, over: 18.0 }]),
            "-0.0038 mm * d_X * exp(-|v_X|/(18 mm/s))",
        ),
        (
            CalibratedTerm::Backlash { axis: 0, lost_motion: 4e-5, wind_up: 0.0 }
                .times(vec![Factor::Position { axis: 0, power: 1, within }]),
            "-2e-5 * d_X * [x]",
        ),
        (play.times(vec![warm]), "-0.0038 mm/K * d_X * (T_bed - 20 degC)"),
        (
            one(5.8e-8)
                .times(vec![x.clone(), Factor::Position { axis: 1, power: 2, within: Within::EVERYWHERE }]),
            "5.8e-8 1/mm/mm * x * y^2",
        ),
        (
            CalibratedTerm::Cyclic { axis: 0, period: 10.0, amplitude: 6.4e-6, phase: -0.5 }.times(vec![x]),
            "6.4e-6 * sin(2 pi * x/(10 mm) - 0.5 rad) * x",
        ),
        (
            CalibratedTerm::Polynomial { input: SeriesInput::Axis(0), coefficients: vec![0.0, 2e-5, -3e-8] },
            "2e-5 * x - 3e-8 1/mm * x^2",
        ),
        (CalibratedTerm::Lag { axis: 0, gain: 20.0, frequency: 0.0 }, "-0.05 s * v_X"),
        (CalibratedTerm::Delay { axis: 0, time: 0.003 }, "x(t - 0.003 s) - x(t)"),
        (CalibratedTerm::Step { time: 1200.0, size: 0.008 }, "0.008 mm * (1 from t = 1200 s on)"),
        (
            one(2.0).times(vec![Factor::Half { load: "feed".to_owned(), at: 40.0 }]),
            "2 mm * 1/(1 + |F_feed|/(40 N))",
        ),
    ];
    for (term, expected) in cases {
        assert_eq!(written(&term, 0).text, expected);
    }
    assert_eq!(written(&one(2e-5), 1).text, "2e-5 rad", "an angle");
}

#[test]
fn other_notations_say_the_same() {
    let play = CalibratedTerm::Backlash { axis: 0, lost_motion: 4e-5, wind_up: 0.0 };
    let term = play.times(vec![Factor::Speed { axis: 0, within: Within { from: 0.0, to: 9.0 } }]);
    let found = written(&term, 0);
    assert_eq!(found.text, "-2e-5 s * d_X * [|v_X|]");
    assert_eq!(
        found.latex,
        r"-2\cdot 10^{-5}\,\mathrm{s}\,d_{\mathrm{X}}\,\left[\left|v_{\mathrm{X}}\right|\right]"
    );
    assert_eq!(
        found.mathml,
        "<math><mn>\u{2212}2e\u{2212}5</mn><mspace width=\"0.2em\"/><mtext>s</mtext><mo>\u{b7}</mo>\
         <msub><mi>d</mi><mtext>X</mtext></msub><mo>\u{b7}</mo><mo>[</mo><mo>|</mo>\
         <msub><mi>v</mi><mtext>X</mtext></msub><mo>|</mo><mo>]</mo></math>"
    );
    // A name of a channel is text and no markup.
    let load = CalibratedTerm::Compliance { load: "a<b & c_d".to_owned(), coefficient: 1e-5 };
    let found = written(&load, 0);
    assert!(found.mathml.contains("a&lt;b &amp; c_d"), "{}", found.mathml);
    assert!(found.latex.contains(r"a<b \& c\_d"), "{}", found.latex);
}
