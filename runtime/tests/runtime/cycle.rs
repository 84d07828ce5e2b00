//! The cycle around the inverse: refusals, limits, the switch, memories, the checks of the set-up.
//!
//! In: samples good and bad. Out: what the compensator says, and what it leaves in `out`.

use abbe_runtime::{
    Compensator, Convergence, Direction, ErrorMotion, Factor, Input, Kinematics, Limits, Refusal, Sample,
    SetupError, Term, TermState, Within, Work,
};

use crate::common::{Lathe, Slide, Swivel, at, with};

/// Compensates one sample on the slide with these terms of EXX, after `set` has set the compensator up.
fn run(
    terms: &[Term<'_>],
    sample: &Sample<'_>,
    set: impl FnOnce(&mut Compensator<'_, Slide>),
) -> (Result<abbe_runtime::Outcome, Refusal>, f64) {
    let mut command = [f64::NAN];
    let motions = [ErrorMotion { terms }];
    let (result, _) = with(&Slide, &motions, |compensator| {
        set(compensator);
        compensator.compensate(sample, &mut command)
    });
    (result, command[0])
}

fn scale(coefficients: &[f64]) -> [Term<'_>; 1] {
    [Term::Polynomial { input: Input::Axis(0), coefficients }]
}

#[test]
fn an_error_as_steep_as_the_position_does_not_converge() {
    for slope in [1.5, -1.0, -1.5] {
        let (result, command) = run(&scale(&[0.0, slope]), &at(&[8.0]), |_| {});
        let Err(Refusal::NotConverging { iterations: 20, distance }) = result else {
            panic!("{slope}: {result:?}")
        };
        // The step k is 8 |slope|^k.
        assert!((distance / (8.0 * slope.abs().powi(20)) - 1.0).abs() < 1e-9);
        assert_eq!(command, 8.0);
    }
}

#[test]
fn an_error_that_runs_away_does_not_converge() {
    let steep = [0.0, 0.0, 0.0, 0.0, 0.0, 1e30];
    let (result, command) = run(&scale(&steep), &at(&[1e10]), |_| {});
    assert!(matches!(result, Err(Refusal::NotConverging { distance: f64::INFINITY, .. })), "{result:?}");
    assert_eq!(command, 1e10);
}

#[test]
fn too_few_iterations_are_told() {
    let few =
        |c: &mut Compensator<'_, Slide>| c.convergence = Convergence { iterations: 3, tolerance: 1e-10 };
    let (result, command) = run(&scale(&[0.0, 0.1]), &at(&[10.0]), few);
    let Err(Refusal::NotConverging { iterations: 3, distance }) = result else { panic!("{result:?}") };
    assert!((distance - 0.01).abs() < 1e-12);
    assert_eq!(command, 10.0);
    let none = |c: &mut Compensator<'_, Slide>| c.convergence.iterations = 0;
    let (result, _) = run(&scale(&[0.0]), &at(&[10.0]), none);
    assert_eq!(result, Err(Refusal::NotConverging { iterations: 0, distance: f64::INFINITY }));
}

#[test]
fn a_correction_over_the_limit_is_refused_and_says_so() {
    let term = [Term::Constant { value: -0.25 }];
    let limited = |limit| {
        move |c: &mut Compensator<'_, Slide>| {
            c.limits = Limits { compensation: Some(limit), ..Limits::default() }
        }
    };
    let (result, command) = run(&term, &at(&[5.0]), limited(0.2));
    assert_eq!(result, Err(Refusal::OverLimit { correction: 0.25, limit: 0.2 }));
    assert_eq!(command, 5.0);
    let (result, command) = run(&term, &at(&[5.0]), limited(0.25));
    assert!(result.is_ok());
    assert_eq!(command, 5.25);
    let (result, command) = run(&term, &at(&[5.0]), limited(f64::NAN));
    assert!(matches!(result, Err(Refusal::OverLimit { .. })));
    assert_eq!(command, 5.0);
}

#[test]
fn the_limit_holds_over_all_axes_together() {
    let (ex, ez) = ([Term::Constant { value: 0.3 }], [Term::Constant { value: 0.4 }]);
    let motions = [&ex[..], &ez, &[], &[]].map(|terms| ErrorMotion { terms });
    let mut out = [0.0; 2];
    let (result, _) = with(&Lathe { tool: [0.0; 2] }, &motions, |c| {
        c.limits.compensation = Some(0.45);
        c.compensate(&at(&[1.0, 2.0]), &mut out)
    });
    let Err(Refusal::OverLimit { correction, .. }) = result else { panic!("{result:?}") };
    assert!((correction - 0.5).abs() < 1e-12);
    assert_eq!(out, [1.0, 2.0]);
}

/// At an angle a from the pose in which both slides move along X, W moves 1/sin a times as far as the tip along Z, and X takes back
/// cos a of that: both together move sqrt(1 + cos^2 a)/sin a times as far.
#[test]
fn near_a_singular_pose_a_correction_is_refused_and_says_so() {
    let term = [Term::Constant { value: 0.01 }];
    let motions = [ErrorMotion { terms: &term }];
    let at_angle = |angle: f64| {
        let position = [100.0, std::f64::consts::FRAC_PI_2 - angle, 10.0];
        let mut out = [f64::NAN; 3];
        let (result, _) =
            with(&Swivel, &motions, |compensator| compensator.compensate(&at(&position), &mut out));
        (result, position, out)
    };
    for angle in [1.0, 0.1, 0.0142] {
        let (result, position, out) = at_angle(angle);
        assert!(result.is_ok(), "{angle}: {result:?}");
        let moved = (out[0] - position[0]).hypot(out[2] - position[2]);
        assert!((moved - 0.01 * (1.0 + angle.cos().powi(2)).sqrt() / angle.sin()).abs() < 1e-9);
    }
    for angle in [0.0141, 1e-3, 1e-6] {
        let (result, position, out) = at_angle(angle);
        let Err(Refusal::NearSingular { amplification }) = result else { panic!("{angle}: {result:?}") };
        let expected = (1.0 + angle.cos().powi(2)).sqrt() / angle.sin();
        assert!((amplification / expected - 1.0).abs() < 1e-6, "{amplification} {expected}");
        assert_eq!(out, position);
    }
    // In the pose itself Z is out of reach, and stays.
    let (result, position, out) = at_angle(0.0);
    assert_eq!(result.map(|outcome| outcome.remaining), Ok([0.0, 0.0, 0.01]));
    assert_eq!(out, position);
}

#[test]
fn an_error_that_the_axes_reach_is_corrected_beside_a_singular_pose() {
    // Without an error along Z no slide moves far.
    let motions = [ErrorMotion { terms: &[] }];
    let mut out = [f64::NAN; 3];
    let position = [100.0, std::f64::consts::FRAC_PI_2 - 1e-5, 10.0];
    let (result, _) = with(&Swivel, &motions, |compensator| compensator.compensate(&at(&position), &mut out));
    assert!(result.is_ok(), "{result:?}");
    assert_eq!(out, position);
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let terms = [
        Term::Lag { axis: 0, gain: 10.0 },
        Term::Polynomial { input: Input::Sensor(0), coefficients: &[0.0] },
    ];
    let good = Sample { velocity: &[1.0], temperature: &[20.0, 20.0], ..at(&[5.0]) };
    assert!(run(&terms, &good, |_| {}).0.is_ok());
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for sample in [
            Sample { velocity: &[bad], ..good },
            Sample { temperature: &[bad, 20.0], ..good },
            Sample { temperature: &[20.0, bad], ..good }, // no term reads it, yet a sensor that fails is told
            Sample { time_step: bad, ..good },
        ] {
            assert_eq!(run(&terms, &sample, |_| {}), (Err(Refusal::NotFinite), 5.0));
        }
        let (result, command) = run(&terms, &Sample { position: &[bad], ..good }, |_| {});
        assert_eq!(result, Err(Refusal::NotFinite));
        assert_eq!(command.to_bits(), bad.to_bits());
    }
}

#[test]
fn an_error_that_overflows_is_refused() {
    let (result, command) = run(&scale(&[0.0, 1e300]), &at(&[1e10]), |_| {});
    assert_eq!((result, command), (Err(Refusal::NotFinite), 1e10));
}

#[test]
fn a_negative_time_step_is_refused() {
    let sample = Sample { time_step: -0.5, ..at(&[5.0]) };
    assert_eq!(run(&[], &sample, |_| {}), (Err(Refusal::NegativeTimeStep { time_step: -0.5 }), 5.0));
}

#[test]
fn slices_of_the_wrong_length_are_refused() {
    let lag = [Term::Lag { axis: 0, gain: 10.0 }];
    let sensor = [Term::Polynomial { input: Input::Sensor(2), coefficients: &[0.0] }];
    let good = at(&[5.0]);
    let told = |terms: &[Term<'_>], sample: Sample<'_>| match run(terms, &sample, |_| {}).0 {
        Err(Refusal::Length { slice, expected, found }) => (slice, expected, found),
        other => panic!("{other:?}"),
    };
    assert_eq!(told(&[], Sample { position: &[], ..good }), ("position", 1, 0));
    assert_eq!(told(&[], Sample { direction: &[], ..good }), ("direction", 1, 0));
    assert_eq!(told(&[], Sample { velocity: &[0.0, 0.0], ..good }), ("velocity", 1, 2));
    assert_eq!(told(&lag, good), ("velocity", 1, 0));
    assert_eq!(told(&[], Sample { travel: &[0.0], ..good }), ("travel", 0, 1));
    assert_eq!(told(&sensor, Sample { temperature: &[20.0, 20.0], ..good }), ("temperature", 3, 2));
    let (result, _) = with(&Slide, &[ErrorMotion::default()], |c| c.compensate(&good, &mut [0.0, 0.0]));
    assert_eq!(result, Err(Refusal::Length { slice: "out", expected: 1, found: 2 }));
}

#[test]
fn switched_off_it_passes_positions_and_still_reports() {
    let off = |c: &mut Compensator<'_, Slide>| {
        c.enabled = false;
        c.limits.compensation = Some(1e-6);
    };
    let (result, command) = run(&[Term::Constant { value: 0.25 }], &at(&[5.0]), off);
    let outcome = result.unwrap();
    assert_eq!((outcome.error, outcome.remaining), ([0.25, 0.0, 0.0], [0.25, 0.0, 0.0]));
    assert_eq!((outcome.iterations, command), (0, 5.0));
}

#[test]
fn switched_off_it_still_follows_the_memories() {
    let play = [Term::Backlash { axis: 0, lost_motion: 0.02, wind_up: 4.0, ramp: 0.0 }];
    let motions = [ErrorMotion { terms: &play }];
    let (error, _) = with(&Slide, &motions, |c| {
        c.enabled = false;
        c.compensate(&at(&[10.0]), &mut [0.0]).unwrap();
        c.compensate(&at(&[7.0]), &mut [0.0]).unwrap();
        c.enabled = true;
        c.compensate(&at(&[6.0]), &mut [0.0]).unwrap().error[0]
    });
    // 4 mm back from the furthest point: taken up the other way.
    assert_eq!(error, 0.01);
}

#[test]
fn memories_advance_once_a_cycle_however_long_the_search() {
    let terms = [
        Term::Growth { sensor: 0, coefficient: 0.01, reference: 20.0, time_constant: 10.0 },
        Term::Polynomial { input: Input::Axis(0), coefficients: &[0.0, 0.05] },
    ];
    let motions = [ErrorMotion { terms: &terms }];
    let (outcome, _) = with(&Slide, &motions, |c| {
        c.compensate(&Sample { temperature: &[20.0], ..at(&[1.0]) }, &mut [0.0]).unwrap();
        let warm = Sample { temperature: &[30.0], time_step: 5.0, ..at(&[0.0]) };
        c.compensate(&warm, &mut [0.0]).unwrap();
        c.compensate(&warm, &mut [0.0]).unwrap()
    });
    assert!(outcome.iterations > 3);
    assert!((outcome.error[0] - 0.1 * (1.0 - (-1.0_f64).exp())).abs() < 1e-15);
}

#[test]
fn a_refused_sample_leaves_the_memories_as_they_were() {
    let growth = [Term::Growth { sensor: 0, coefficient: 1.0, reference: 0.0, time_constant: 10.0 }];
    let motions = [ErrorMotion { terms: &growth }];
    let (error, _) = with(&Slide, &motions, |c| {
        c.error(&Sample { temperature: &[20.0], ..at(&[0.0]) }).unwrap();
        let bad = Sample { temperature: &[900.0], time_step: 5.0, ..at(&[f64::NAN]) };
        assert_eq!(c.error(&bad), Err(Refusal::NotFinite));
        c.error(&Sample { temperature: &[20.0], ..at(&[0.0]) }).unwrap()
    });
    assert_eq!(error, [20.0, 0.0, 0.0]);
}

#[test]
fn a_restart_forgets() {
    let play = [Term::Backlash { axis: 0, lost_motion: 2.0, wind_up: 4.0, ramp: 0.0 }];
    let motions = [ErrorMotion { terms: &play }];
    let (errors, _) = with(&Slide, &motions, |c| {
        c.error(&at(&[0.0])).unwrap();
        let before = c.error(&at(&[-9.0])).unwrap()[0];
        c.restart();
        (before, c.error(&at(&[-9.0])).unwrap()[0])
    });
    assert_eq!(errors, (1.0, -1.0));
}

#[test]
fn error_and_compensate_report_the_same_error() {
    let term = scale(&[0.001, 2e-4]);
    let motions = [ErrorMotion { terms: &term }];
    let (error, _) = with(&Slide, &motions, |c| c.error(&at(&[80.0])).unwrap());
    assert_eq!(error, run(&term, &at(&[80.0]), |_| {}).0.unwrap().error);
    assert!((error[0] - 0.017).abs() < 1e-15);
}

#[test]
fn the_direction_of_the_sample_holds_at_every_step() {
    let play = [Term::Backlash { axis: 0, lost_motion: 0.01, wind_up: 0.0, ramp: 0.0 }];
    let (_, forward) = run(&play, &at(&[5.0]), |_| {});
    let (_, back) = run(&play, &Sample { direction: &[Direction::Negative], ..at(&[5.0]) }, |_| {});
    assert_eq!((forward, back), (5.005, 4.995));
}

/// What the constructor says of a slide set up with these motions, states and work lengths.
fn setup(motions: &[ErrorMotion<'_>], states: usize, work: [usize; 3]) -> Result<usize, SetupError> {
    let mut states = vec![TermState::default(); states];
    let mut directions = vec![[0.0; 3]; work[0]];
    let (mut values, mut travel) = (vec![0.0; work[1]], vec![0.0; work[2]]);
    let work = Work { directions: &mut directions, motions: &mut values, travel: &mut travel };
    Compensator::new(&Slide, motions, &mut states, work).map(|compensator| compensator.sensors())
}

#[test]
fn lengths_are_checked_once() {
    let terms = [Term::Constant { value: 0.0 }];
    let motions = [ErrorMotion { terms: &terms }];
    assert_eq!(setup(&motions, 1, [1, 1, 0]), Ok(0));
    let wrong = |slice, expected, found| Err(SetupError::Length { slice, expected, found });
    assert_eq!(setup(&[], 0, [1, 1, 0]), wrong("motions", 1, 0));
    assert_eq!(setup(&motions, 2, [1, 1, 0]), wrong("states", 1, 2));
    assert_eq!(setup(&motions, 1, [2, 1, 0]), wrong("work.directions", 1, 2));
    assert_eq!(setup(&motions, 1, [1, 0, 0]), wrong("work.motions", 1, 0));
    assert_eq!(setup(&motions, 1, [1, 1, 1]), wrong("work.travel", 0, 1));
}

/// A machine with one axis whose travel is said to be that of a second.
struct Astray;

impl Kinematics for Astray {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[0, 1]
    }
    fn motions(&self) -> usize {
        0
    }
    fn error(&self, _position: &[f64], _travel: &[f64], _motions: &[f64]) -> [f64; 3] {
        [0.0; 3]
    }
    fn directions(&self, _position: &[f64], directions: &mut [[f64; 3]]) {
        directions.fill([0.0; 3]);
    }
}

#[test]
fn a_travel_of_no_axis_is_told() {
    let work = Work { directions: &mut [[0.0; 3]], motions: &mut [], travel: &mut [0.0, 0.0] };
    let told = Compensator::new(&Astray, &[], &mut [], work).map(|compensator| compensator.sensors());
    assert_eq!(told, Err(SetupError::TravelAxis { travel: 1, axis: 1 }));
}

#[test]
fn every_message_says_what_it_is_about() {
    let said = [
        (Refusal::OverLimit { correction: 0.25, limit: 0.125 }.to_string(), ["0.250000 mm", "0.125 mm"]),
        (Refusal::NearSingular { amplification: 5729.6 }.to_string(), ["5730 times", "the same direction"]),
        (Refusal::NotConverging { iterations: 20, distance: 0.5 }.to_string(), ["step 20", "0.500000 mm"]),
        (Refusal::Length { slice: "velocity", expected: 3, found: 2 }.to_string(), ["velocity", "2 given"]),
        (
            SetupError::Parameter { motion: 4, term: 7, parameter: "gain" }.to_string(),
            ["term 7", "motion 4: gain"],
        ),
    ];
    for (message, words) in said {
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}

#[test]
fn bad_terms_are_named_by_motion_and_place() {
    let told = |term: Term<'_>| {
        let terms = [Term::Constant { value: 0.0 }, term];
        setup(&[ErrorMotion { terms: &terms }], 2, [1, 1, 0])
    };
    let parameter = |parameter| Err(SetupError::Parameter { motion: 0, term: 1, parameter });
    let cyclic = |period, amplitude, phase| told(Term::Cyclic { axis: 0, period, amplitude, phase });
    let play = |lost_motion, wind_up| told(Term::Backlash { axis: 0, lost_motion, wind_up, ramp: 0.0 });
    let growth = |coefficient, reference, time_constant| {
        told(Term::Growth { sensor: 4, coefficient, reference, time_constant })
    };
    let nan = f64::NAN;
    assert_eq!(
        told(Term::Lag { axis: 1, gain: 1.0 }),
        Err(SetupError::TermAxis { motion: 0, term: 1, axis: 1 })
    );
    assert_eq!(told(Term::Lag { axis: 0, gain: 0.0 }), parameter("gain"));
    assert_eq!(told(Term::Constant { value: nan }), parameter("value"));
    assert_eq!(told(Term::Coupling { axis: 0, coefficients: &[0.0, nan] }), parameter("coefficients"));
    assert_eq!(cyclic(0.0, 1.0, 0.0), parameter("period"));
    assert_eq!(cyclic(1.0, nan, 0.0), parameter("amplitude"));
    assert_eq!(cyclic(1.0, 1.0, nan), parameter("phase"));
    assert_eq!(play(nan, 0.0), parameter("lost_motion"));
    assert_eq!(play(1.0, -1.0), parameter("wind_up"));
    assert_eq!(play(1.0, nan), parameter("wind_up"));
    assert_eq!(growth(nan, 20.0, 0.0), parameter("coefficient"));
    assert_eq!(growth(1.0, nan, 0.0), parameter("reference"));
    assert_eq!(growth(1.0, 20.0, -1.0), parameter("time_constant"));
    assert_eq!(growth(1.0, 20.0, 0.0), Ok(5)); // sensor 4 needs five temperatures
}

#[test]
fn bad_factors_are_named_too() {
    let told = |factor: Factor<'_>| {
        let terms = [Term::Factor(factor), Term::Constant { value: 0.0 }];
        setup(&[ErrorMotion { terms: &terms }], 2, [1, 1, 0])
    };
    let parameter = |parameter| Err(SetupError::Parameter { motion: 0, term: 0, parameter });
    let within = Within::EVERYWHERE;
    let turned = Within { from: 1.0, to: 0.0 };
    assert_eq!(
        told(Factor::Direction { axis: 1 }),
        Err(SetupError::TermAxis { motion: 0, term: 0, axis: 1 })
    );
    assert_eq!(told(Factor::Position { axis: 0, power: 0, within }), parameter("power"));
    assert_eq!(told(Factor::Position { axis: 0, power: 4, within }), parameter("power"));
    assert_eq!(told(Factor::Speed { axis: 0, within: turned }), parameter("within"));
    assert_eq!(
        told(Factor::Speed { axis: 0, within: Within { from: f64::NAN, to: 1.0 } }),
        parameter("within")
    );
    assert_eq!(told(Factor::Fading { axis: 0, over: 0.0 }), parameter("over"));
    assert_eq!(told(Factor::Warmth { axis: 0, time_constant: 0.0, rise: 1.0 }), parameter("time_constant"));
    assert_eq!(told(Factor::Turn { axis: 0, period: -1.0, phase: 0.0 }), parameter("period"));
    assert_eq!(told(Factor::Play { sensor: 2, reference: 20.0, width: -1.0 }), parameter("width"));
    assert_eq!(told(Factor::Play { sensor: 2, reference: 20.0, width: 1.0 }), Ok(3));
    let alone = [Term::Constant { value: 0.0 }, Term::Factor(Factor::Direction { axis: 0 })];
    assert_eq!(
        setup(&[ErrorMotion { terms: &alone }], 2, [1, 1, 0]),
        Err(SetupError::LoneFactor { motion: 0, term: 1 })
    );
}

/// A slide along X beside which, wherever it is not at 5, the tip is said to be infinitely far in Y.
struct Lost;

impl Kinematics for Lost {
    fn axes(&self) -> usize {
        1
    }
    fn travels(&self) -> &[usize] {
        &[]
    }
    fn motions(&self) -> usize {
        1
    }
    fn error(&self, position: &[f64], _travel: &[f64], motions: &[f64]) -> [f64; 3] {
        [motions[0], if position == [5.0] { 0.0 } else { f64::INFINITY }, 0.0]
    }
    fn directions(&self, position: &[f64], directions: &mut [[f64; 3]]) {
        Slide.directions(position, directions);
    }
}

#[test]
fn an_error_without_bounds_is_refused_where_no_axis_reaches_it() {
    let exx = [Term::Constant { value: 0.25 }];
    let motions = [ErrorMotion { terms: &exx }];
    let mut command = [0.0];
    let (result, _) = with(&Lost, &motions, |slide| slide.compensate(&at(&[5.0]), &mut command));
    assert!(matches!(result, Err(Refusal::NotConverging { .. })), "{result:?}");
    assert_eq!(command, [5.0]);
}
