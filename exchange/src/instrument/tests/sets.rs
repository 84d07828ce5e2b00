//! Sets of readings with a known answer: uncertainties against printed tables, reversal, smoothing, resampling, squareness.

use super::{assert_near, outcome, rtl, table, values};
use crate::instrument::Uncertainty;
use model_dsl::calibration::CalibratedTerm;

/// Student's t for 95 %, as tables print it.
#[test]
fn intervals_are_those_of_student() {
    for (freedom, t) in
        [(1.0, 12.706), (2.0, 4.303), (4.0, 2.776), (10.0, 2.228), (30.0, 2.042), (f64::INFINITY, 1.960)]
    {
        let half = Uncertainty { standard: 1.0, freedom }.expanded();
        assert!((half - t).abs() < 6e-4, "{freedom}: {half}");
    }
    assert_eq!(Uncertainty { standard: 0.0, freedom: 4.0 }.expanded(), 0.0);
}

/// Readings 1, 2, 3 um at a target: mean 2, scatter 1, standard uncertainty of the mean 1/sqrt 3.
#[test]
fn a_mean_has_the_uncertainty_of_its_scatter() {
    let run = |value: f64| (true, vec![value, 5.0, value]);
    let file = table(&[0.0, 10.0, 20.0], &[run(1.0), run(2.0), run(3.0)]);
    let one = outcome("FX", "  - {motion: EXX, data: d}", &[file]).0.unwrap();
    let means = one.motions[0].curve.forward.as_ref().unwrap();
    let known = means[0].uncertainty.unwrap();
    assert!((known.standard - 1e-3 / 3.0_f64.sqrt()).abs() < 1e-15 && known.freedom == 2.0);
    assert_eq!(means[1].uncertainty.unwrap().standard, 0.0);
    assert!(one.motions[0].curve.reverse.is_none());
}

#[test]
fn of_one_run_the_uncertainty_is_unknown_and_not_zero() {
    let file = rtl(&[0.0, 10.0, 20.0], &[(true, vec![1.0, 2.0, 3.0]), (false, vec![1.0, 2.0, 4.0])]);
    let one = outcome("FX", "  - {motion: EXX, data: d}", &[file]).0.unwrap();
    assert!(one.motions[0].curve.forward.as_ref().unwrap().iter().all(|mean| mean.uncertainty.is_none()));
    assert_eq!(one.motions[0].reversal.unwrap().uncertainty, None);
    let text = super::super::report::text(&one, &super::machine("FX"));
    assert!(text.contains("unknown"), "{text}");
}

/// Lost motion of 4 um: forward 2 um short, reverse 2 um long; runs differ by a zero of their own.
#[test]
fn a_reversal_is_a_backlash_only_where_it_is_asked_for() {
    let targets = [0.0, 100.0, 200.0];
    let run = |forward: bool, zero: f64| (forward, vec![zero + if forward { -2.0 } else { 2.0 }; 3]);
    let file = rtl(&targets, &[run(true, 0.0), run(false, 0.0), run(true, 1.0), run(false, 1.0)]);
    let tables = outcome("FX", "  - {motion: EXX, data: d}", std::slice::from_ref(&file)).0.unwrap();
    assert!(values(&tables).2.is_some());
    let reversal = tables.motions[0].reversal.unwrap();
    assert!((reversal.mean + 4e-3).abs() < 1e-12 && (reversal.greatest + 4e-3).abs() < 1e-12);
    // Two runs of each direction, 1 um apart: 0.5 um for each mean, sqrt(0.5) um for their difference.
    assert!((reversal.uncertainty.unwrap().standard - 0.5e-3 * 2.0_f64.sqrt()).abs() < 1e-12);
    let asked = outcome("FX", "  - {motion: EXX, data: d, reversal: backlash}", &[file]).0.unwrap();
    let terms = &asked.calibration.motions[0].terms;
    let CalibratedTerm::Backlash { lost_motion, .. } = terms[1].value else { panic!("{terms:?}") };
    assert!((lost_motion - 4e-3).abs() < 1e-12);
    assert_near(&values(&asked).1, &[0.5e-3; 3], 1e-12);
}

#[test]
fn runs_that_were_broken_off_count_where_they_were_read() {
    let mut runs = vec![(true, vec![1.0, 2.0, 3.0]), (false, vec![1.0, 2.0, 3.0])];
    runs.extend([(true, vec![3.0, 4.0, 5.0]), (false, vec![3.0, 4.0, 5.0])]);
    let file = rtl(&[0.0, 10.0, 20.0], &runs).replace("4   1      3\r\n", "");
    let one = outcome("FX", "  - {motion: EXX, data: d}", &[file]).0.unwrap();
    let reverse = one.motions[0].curve.reverse.as_ref().unwrap();
    assert_eq!(reverse.iter().map(|mean| mean.readings).collect::<Vec<_>>(), [1, 2, 2]);
    assert_near(&values(&one).2.unwrap(), &[1e-3, 3e-3, 4e-3], 1e-12);
    assert_eq!(one.motions[0].reversal.unwrap().uncertainty, None);
}

#[test]
fn a_target_that_one_direction_lacks_is_left_out_and_named() {
    let text =
        "run,direction,target,deviation\n#unit,,,mm,um\n1,1,0,1\n1,1,10,1\n1,1,20,1\n1,-1,20,2\n1,-1,10,2\n";
    let one = outcome("FX", "  - {motion: EXX, data: d}", &[text.to_owned()]).0.unwrap();
    assert_eq!(one.motions[0].parts[0].left_out, [0.0]);
    assert_near(&values(&one).0, &[10.0, 20.0], 0.0);
}

#[test]
fn smoothing_resampling_and_the_zero_are_only_done_where_asked_for() {
    let file = table(&[0.0, 10.0, 20.0, 30.0, 40.0], &[(true, vec![0.0, 3.0, 0.0, 3.0, 6.0])]);
    let of = |extra: &str| {
        let set = format!("  - {{motion: EXX, data: d{extra}}}");
        values(&outcome("FX", &set, std::slice::from_ref(&file)).0.unwrap())
    };
    assert_near(&of("").1, &[0.0, 3e-3, 0.0, 3e-3, 6e-3], 1e-12);
    assert_near(&of(", smooth: 3").1, &[0.0, 1e-3, 2e-3, 3e-3, 6e-3], 1e-12);
    let (nodes, resampled, _) = of(", resample: 15 mm");
    assert_near(&nodes, &[0.0, 15.0, 30.0, 40.0], 1e-12);
    assert_near(&resampled, &[0.0, 1.5e-3, 3e-3, 6e-3], 1e-12);
    assert_near(&of(", deviations: {zero_at: 15 mm}").1, &[-1.5e-3, 1.5e-3, -1.5e-3, 1.5e-3, 4.5e-3], 1e-12);
    assert_near(&of(", remove: ends").1, &[0.0, 1.5e-3, -3e-3, -1.5e-3, 0.0], 1e-12);
}

#[test]
fn nodes_that_are_not_even_are_kept_as_they_are() {
    let file = table(&[0.0, 10.0, 25.0], &[(true, vec![0.0, 1.0, 2.0])]);
    let one = outcome("FX", "  - {motion: EXX, data: d}", &[file]).0.unwrap();
    let names = super::machine("FX").names();
    let text = model_dsl::calibration::write(&one.calibration, &names);
    assert!(text.contains("at: [0, 10, 25]"), "{text}");
}

/// A rotary axis, in degrees and arc seconds.
#[test]
fn a_rotary_axis_is_calibrated_in_angles() {
    let text = "target,deviation\n#unit,deg,arcsec\n0,0\n90,36\n180,-36\n";
    let one = outcome("XYZFC", "  - {motion: ECC, data: d}", &[text.to_owned()]).0.unwrap();
    let (nodes, values, _) = values(&one);
    assert_near(&nodes, &[0.0, std::f64::consts::FRAC_PI_2, std::f64::consts::PI], 1e-9);
    assert_near(&values, &[0.0, 1.745_33e-4, -1.745_33e-4], 1e-9);
}

/// Millimetres for each metre are milliradians, as a level and a Renishaw file have them.
#[test]
fn lengths_for_each_length_are_an_angle() {
    let text = "target,deviation\n#unit,deg,mm/m\n0,0\n90,0.02\n";
    let one = outcome("XYZFC", "  - {motion: ECC, data: d}", &[text.to_owned()]).0.unwrap();
    assert_near(&values(&one).1, &[0.0, 2e-5], 1e-12);
    let text = "target,deviation\n0,0\n90,20\n";
    let set = "  - {motion: ECC, data: d, targets: {unit: deg}, deviations: {unit: um/m}}";
    let one = outcome("XYZFC", set, &[text.to_owned()]).0.unwrap();
    assert_near(&values(&one).1, &[0.0, 2e-5], 1e-12);
}

/// 0 and 360 deg are one place, measured twice.
#[test]
fn the_ends_of_a_turn_have_the_mean_of_both() {
    let text = "target,deviation\n#unit,deg,urad\n0,10\n120,40\n240,-20\n360,16\n";
    let curve = |text: String| {
        let one = outcome("XYZFC", "  - {motion: ECC, data: d}", &[text]).0.unwrap();
        match one.calibration.motions[0].terms[0].value.clone() {
            CalibratedTerm::Table { curve, .. } => curve,
            other => panic!("{other:?}"),
        }
    };
    let turn = curve(text.to_owned());
    assert!(turn.repeats);
    assert_near(turn.values.forward(), &[13e-6, 40e-6, -20e-6, 13e-6], 1e-12);
    // Without a whole turn between them the ends are two places.
    let part = curve(text.replace("360", "350"));
    assert!(!part.repeats);
    assert_near(part.values.forward(), &[10e-6, 40e-6, -20e-6, 16e-6], 1e-12);
}

const SQUARE: &str = "setup: 1\nmachine: m\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nreferences: {square: {angle: 4 urad, uncertainty: 1 urad}}\nmeasurements:\n";

fn straight(slope: f64) -> String {
    let targets = [0.0, 100.0, 200.0, 300.0];
    let run = |_: usize| targets.iter().map(|at| slope * at / 1000.0).collect::<Vec<f64>>();
    table(&targets, &[(true, run(0)), (true, run(1)), (false, run(2)), (false, run(3))])
}

/// The tool moves on all axes: EC0Y turns +Y travel towards -X, so that slopes of EYX and EXY both lower it.
#[test]
fn a_square_gives_the_squareness_less_its_own_error() {
    let set = format!(
        "{SQUARE}  - {{motion: EYX, data: a, reference: square}}\n  - {{motion: EXY, data: b, reference: square}}"
    );
    let (one, found, _) = outcome("FXYZ", &set, &[straight(30.0), straight(10.0)]);
    let one = one.unwrap_or_else(|| panic!("{found:?}"));
    let angle = &one.squarenesses[0];
    assert!((angle.angle - (-40e-6 + 4e-6)).abs() < 1e-12, "{angle:?}");
    assert!((angle.uncertainty.unwrap().standard - 1e-6).abs() < 1e-12, "{angle:?}");
    assert_eq!(super::machine("FXYZ").motions[angle.motion].name, "EC0Y");
}

#[test]
fn turning_the_square_over_takes_its_error_out() {
    let one = |motion: &str, turned: bool| {
        format!("  - {{motion: {motion}, data: d, reference: square, turned: {turned}}}\n")
    };
    let both =
        SQUARE.to_owned() + &one("EYX", false) + &one("EXY", false) + &one("EYX", true) + &one("EXY", true);
    let set = both.replace("references: {square: {angle: 4 urad, uncertainty: 1 urad}}\n", "");
    // The square lies askew by 7 urad the first time and by -3 the second, and is off by 5: slopes by hand.
    let files =
        [straight(30.0 - 7.0), straight(10.0 + 7.0 + 5.0), straight(30.0 + 3.0), straight(10.0 - 3.0 - 5.0)];
    let (one, found, _) = outcome("FXYZ", &set, &files);
    let one = one.unwrap_or_else(|| panic!("{found:?}"));
    assert!((one.squarenesses[0].angle + 40e-6).abs() < 1e-12, "{:?}", one.squarenesses);
    assert!((one.squarenesses[0].square.unwrap() - 5e-6).abs() < 1e-12, "{:?}", one.squarenesses);
    // What its certificate says has no place beside that.
    let (one, found, _) = outcome("FXYZ", &both, &files);
    assert!(one.is_none());
    assert_eq!(found, [("E0912", "square".to_owned())]);
}

/// Laid on three times, askew by 0, 7 and -3 urad, with 40, 43 and 46 urad of squareness read: the mean is 43, its standard
/// uncertainty 3/sqrt 3, and that of the square 1 urad beside it.
#[test]
fn a_square_that_is_laid_on_again_gives_the_mean_and_its_scatter() {
    let set_up = |placement: u8| {
        let one = |motion: &str| {
            format!("  - {{motion: {motion}, data: d, reference: square, placement: {placement}}}\n")
        };
        one("EYX") + &one("EXY")
    };
    let set = SQUARE.to_owned() + &set_up(1) + &set_up(2) + &set_up(3);
    let files = [(0.0, 40.0), (7.0, 43.0), (-3.0, 46.0)]
        .map(|(askew, read)| [straight(30.0 - askew), straight(read - 30.0 + askew)])
        .concat();
    let (one, found, _) = outcome("FXYZ", &set, &files);
    let one = one.unwrap_or_else(|| panic!("{found:?}"));
    let angle = &one.squarenesses[0];
    assert!((angle.angle - (-43e-6 + 4e-6)).abs() < 1e-12, "{angle:?}");
    assert_near(&angle.set_ups, &[-36e-6, -39e-6, -42e-6], 1e-12);
    let known = angle.uncertainty.unwrap();
    assert!((known.standard - (3.0_f64 + 1.0).sqrt() * 1e-6).abs() < 1e-12, "{known:?}");
    // One table of each motion, of all readings.
    let motions: Vec<usize> = one.motions.iter().map(|motion| motion.parts.len()).collect();
    assert_eq!(motions, [3, 3]);
    assert_eq!(one.motions[0].curve.forward.as_ref().unwrap()[0].readings, 6);
    let text = super::super::report::text(&one, &super::machine("FXYZ"));
    assert!(text.contains("the mean of 3 set-ups, and their scatter: -36.00, -39.00, -42.00 urad"), "{text}");
    // The same set-up twice, and a number that is none.
    let twice = super::setup_of(&(SQUARE.to_owned() + &set_up(2) + &set_up(2)), &super::machine("FXYZ")).1;
    assert_eq!(twice.iter().map(|found| found.0).collect::<Vec<_>>(), ["E0911", "E0911"]);
    let none = super::setup_of(&set.replace("placement: 3", "placement: 0"), &super::machine("FXYZ")).1;
    assert_eq!(none, [("E0907", "0".to_owned()), ("E0907", "0".to_owned())]);
}

/// A line goes through any two targets: the slopes give the squareness, and no motion gets a table.
#[test]
fn two_targets_on_a_square_give_its_squareness_alone() {
    let two =
        |slope: f64| table(&[0.0, 200.0], &[(true, vec![0.0, slope / 5.0]), (false, vec![0.0, slope / 5.0])]);
    let edges =
        "  - {motion: EYX, data: a, reference: square}\n  - {motion: EXY, data: b, reference: square}";
    let (one, found, _) = outcome("FXYZ", &format!("{SQUARE}{edges}"), &[two(30.0), two(10.0)]);
    assert_eq!(found, [("W0905", "a".to_owned()), ("W0905", "b".to_owned())]);
    let one = one.unwrap();
    assert!((one.squarenesses[0].angle + 36e-6).abs() < 1e-12, "{:?}", one.squarenesses);
    let written: Vec<usize> = one.calibration.motions.iter().map(|motion| motion.motion).collect();
    assert_eq!(written, [one.squarenesses[0].motion]);
    // Without a square the slope counts nowhere.
    let (alone, found, _) = outcome("FXYZ", "  - {motion: EYX, data: a}", &[two(30.0)]);
    assert!(alone.is_none());
    assert_eq!(found, [("E0917", "a".to_owned())]);
}

/// 21 um forward is the largest of a single axis: twice that is 42 um. What the set-up says of itself stays.
#[test]
fn a_limit_comes_from_the_largest_correction() {
    let file = table(&[0.0, 100.0, 200.0], &[(true, vec![0.0, -21.0, 8.0])]);
    let measured = "  - {motion: EXX, data: d}";
    let one = outcome("FX", measured, std::slice::from_ref(&file)).0.unwrap();
    let bound = one.bound.unwrap();
    // The largest place that is looked at lies within a thousandth of the range of the node.
    assert!((bound.largest - 0.021).abs() < 0.021 * 2e-3, "{bound:?}");
    assert_eq!((bound.limit, one.calibration.limits.compensation.unwrap().value), (0.042, 0.042));
    let text = super::super::report::text(&one, &super::machine("FX"));
    assert!(text.contains("limits: {compensation: 0.042 mm} is twice the largest correction"), "{text}");
    let known = "setup: 1\nmachine: m\nconstants: {Xt: 0 mm, Yt: 0 mm, Zt: 0 mm}\nlimits: {compensation: 1 mm}\nmeasurements:\n";
    let kept = outcome("FX", &format!("{known}{measured}"), &[file]).0.unwrap();
    assert_eq!((kept.bound, kept.calibration.limits.compensation.unwrap().value), (None, 1.0));
}

/// Off the carriage's frame by 30 mm in Z and 10 mm in Y, all axes carrying the tool: EBX moves the reading of EXX by 30 mm times
/// its angle, ECX by -10 mm times its own, which was not measured.
#[test]
fn lever_arms_are_taken_off_where_the_place_is_known() {
    let targets = [0.0, 100.0, 200.0];
    let (truth, angle) = ([0.0, 5.0, -2.0], [20.0, -40.0, 60.0]);
    let read: Vec<f64> =
        truth.iter().zip(angle).map(|(truth, angle)| truth + 30.0 * angle / 1000.0).collect();
    let run = |values: &[f64]| -> Vec<(bool, Vec<f64>)> {
        [(true, 0.1), (false, -0.1), (true, -0.1), (false, 0.1)]
            .map(|(forward, more)| (forward, values.iter().map(|value| value + more).collect()))
            .to_vec()
    };
    let files = [table(&targets, &run(&read)), table(&targets, &run(&angle)).replace("mm,um", "mm,urad")];
    let set = |at: &str| format!("  - {{motion: EXX, data: a{at}}}\n  - {{motion: EBX, data: b}}");
    let plain = outcome("FXYZ", &set(""), &files).0.unwrap();
    assert_near(&values(&plain).1, &read.iter().map(|value| value / 1e3).collect::<Vec<_>>(), 1e-9);
    assert_eq!(plain.motions[0].parts[0].levers, None);
    let placed = outcome("FXYZ", &set(", at: {Y: 10 mm, Z: -50 mm, Zt: 80 mm}"), &files).0.unwrap();
    assert_near(&values(&placed).1, &truth.map(|value| value / 1e3), 1e-9);
    let machine = super::machine("FXYZ");
    let named = |number: usize| machine.motions[number].name.as_str();
    let levers = placed.motions[0].parts[0].levers.as_ref().unwrap();
    assert_eq!(levers.taken.iter().map(|(motion, _)| named(*motion)).collect::<Vec<_>>(), ["EBX"]);
    assert!((levers.taken[0].1 - 30.0 * 60.0e-6).abs() < 1e-12);
    assert_eq!(levers.remaining.iter().map(|motion| named(*motion)).collect::<Vec<_>>(), ["ECX"]);
    // Two readings 0.2 apart: 0.1 um of the reading, and 30 mm times 0.1 urad.
    let mean = placed.motions[0].curve.forward.as_ref().unwrap()[0].uncertainty.unwrap();
    assert!((mean.standard - 0.1e-3 * 1.0_f64.hypot(0.03)).abs() < 1e-9, "{mean:?}");
}
