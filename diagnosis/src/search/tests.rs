//! What a set of effects costs, however it came about.

use super::*;
use crate::judge;
use crate::model::{Fitted, Model, Place};
use crate::noise::Noise;
use crate::recording::Recording;
use crate::side::Side;
use crate::testing::{Bench, circle, path, position, scenario};
use crate::weights::Weights;

#[test]
fn each_parameter_costs_the_logarithm_of_the_samples() {
    for columns in [0, 1, 3] {
        let doubled = untold_price(columns, 2000.0) - untold_price(columns, 1000.0);
        assert!((doubled - crate::number(columns) * 2.0_f64.ln()).abs() < 1e-12, "{columns}: {doubled}");
    }
    assert_eq!(untold_price(2, 0.0), untold_price(2, 2.0));
}

/// What an instrument of these axes reads of a machine with these errors on a circle of 40 mm.
fn on_a_circle(bench: &Bench, errors: &str, axes: &str) -> Recording {
    bench.record(&bench.calibration(errors), &scenario(path(circle(40.0), 20.0, 10.0), position(axes)))
}

/// Effects of X, after its zero: one that the zero holds already, one that it holds a third of, and two of their own.
fn effects(bench: &Bench) -> Vec<Effect> {
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let shapes = [
        Shape::Constant,
        Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 40.0 },
        Shape::Backlash { axis: 0, wind_up: 0.0 },
        Shape::Cyclic { axis: 0, period: 7.0, order: 1, center: 0.0 },
    ];
    let others = shapes.map(|shape| Effect { place, shape });
    std::iter::once(Effect::setting(0, Setting::Offset { channel: 0 })).chain(others).collect()
}

#[test]
fn a_set_costs_the_same_by_whatever_way_it_is_reached() {
    let bench = Bench::of("XFY");
    let errors =
        "{EXX: [{backlash: {lost_motion: 8 um}}, {cyclic: {period: 7 mm, amplitude: 3 um, phase: 0.4 rad}}]}";
    let recording = on_a_circle(&bench, errors, "x");
    let study = Study::new(bench.equations(), None, &[&recording]);
    let model = Model::of(effects(&bench).into_iter().map(Fitted::unfitted));
    let design = judge::design(&study, &model, &Weights::of_all(&study, vec![vec![Noise::white(1e-3)]]));
    let (products, samples) = design.fitted();
    let choice = Choice::new(&study, &design, products, samples, 1, 1.0, Resolution::new(&study, &[]));

    let alike = |a: f64, b: f64| (a - b).abs() < 1e-6 * (a.abs() + samples);
    let empty = choice.empty();
    for &first in &choice.open {
        let one = choice.with(&empty, first);
        assert!(alike(choice.cost_with(&empty, first), one.cost), "promised: {first}");
        assert!(alike(choice.without(&one, first).cost, empty.cost), "there and back: {first}");
        for &second in choice.open.iter().filter(|second| **second != first) {
            let both = choice.with(&one, second);
            let other_way = choice.with(&choice.with(&empty, second), first);
            assert!(alike(both.cost, other_way.cost), "{first} and {second}");
            assert!(alike(choice.cost_with(&one, second), both.cost), "promised: {second} beside {first}");
            assert!(alike(choice.without(&both, second).cost, one.cost), "{second} beside {first}, and back");
        }
    }
    // Each costs its price, less what is counted for columns that the zero holds already.
    for (first, held) in [(1, 1), (2, 1), (3, 0), (4, 0)] {
        let spared = untold_price(held, samples);
        let price = choice.price(&choice.with(&empty, first)) - choice.price(&empty);
        assert!((price + spared - choice.prices[first]).abs() < 1e-6, "{first}: {price}");
    }
    // What the zero holds already is worth nothing, and costs what its name does.
    let held = choice.with(&empty, 1).cost - empty.cost;
    assert!((0.0..choice.prices[1]).contains(&held), "{held}");
}

#[test]
fn what_is_one_piece_of_physics_stands_once() {
    let bench = Bench::of("XFY");
    let on = |motion: &str, shape: Shape| Effect {
        place: Place::Motion { motion: bench.motion(motion), side: Side::After },
        shape,
    };
    let wave = |period| on("EXX", Shape::Cyclic { axis: 0, period, order: 1, center: 0.0 });
    let vibration = |frequency| on("EXX", Shape::Vibration { frequency });
    let coupling = |axis, degree| on("EXX", Shape::Coupling { axis, degree, scale: 1.0 });
    let play = |wind_up| on("EXX", Shape::Backlash { axis: 0, wind_up });
    let expansion = |sensor| on("EXX", Shape::Expansion { axis: 0, sensor, reference: 20.0 });
    let growth = |sensor, time_constant| on("EXX", Shape::Growth { sensor, reference: 20.0, time_constant });
    let load = |load| on("EXX", Shape::Compliance { load });
    let setting = |setting| Effect::setting(0, setting);
    for (a, b, one) in [
        (wave(7.0), wave(7.1), true),
        (wave(7.0), wave(7.3), false),
        (wave(7.0), wave(3.5), false),
        (vibration(50.0), vibration(50.02), true),
        (vibration(50.0), vibration(51.0), false),
        (coupling(1, 1), coupling(1, 2), true),
        (coupling(1, 1), coupling(0, 1), false),
        (play(0.0), play(3.0), true),
        (play(0.0), on("EYX", Shape::Backlash { axis: 0, wind_up: 0.0 }), false),
        (play(0.0), on("EXX", Shape::Constant), false),
        (expansion(0), expansion(0), true),
        (expansion(0), expansion(1), false),
        (growth(0, 0.0), growth(0, 60.0), true),
        (growth(0, 0.0), growth(1, 0.0), false),
        (load(0), load(0), true),
        (load(0), load(1), false),
        (setting(Setting::Radius), setting(Setting::Radius), true),
        (setting(Setting::Radius), setting(Setting::Cosine), false),
        (setting(Setting::Offset { channel: 0 }), setting(Setting::Offset { channel: 1 }), false),
    ] {
        assert_eq!((rivals(&a, &b), rivals(&b, &a)), (one, one), "{a:?} and {b:?}");
    }
}

#[test]
fn only_what_turns_a_body_is_held_to_small_turns() {
    let bench = Bench::of("XFY");
    let recording = on_a_circle(&bench, "{}", "x");
    let study = Study::new(bench.equations(), None, &[&recording]);
    let turns = |motion: &str, shape: Shape| {
        let place = Place::Motion { motion: bench.motion(motion), side: Side::After };
        rotates(&study, &Effect { place, shape })
    };
    assert!(turns("ECX", Shape::Constant));
    assert!(turns("ECX", Shape::Backlash { axis: 0, wind_up: 0.0 }));
    // So many rad for each degree, or newton, are no angle.
    assert!(!turns("ECX", Shape::Growth { sensor: 0, reference: 20.0, time_constant: 0.0 }));
    assert!(!turns("ECX", Shape::Compliance { load: 0 }));
    assert!(!turns("EXX", Shape::Constant));
    assert!(!turns("EYX", Shape::Constant), "a displacement that is not the axis's own");
    assert!(!rotates(&study, &Effect::setting(0, Setting::Radius)));
}

#[test]
fn a_drive_leads_only_where_no_clock_does_the_same() {
    let bench = Bench::of("XFY");
    let [late, ahead] = late_and_ahead(&bench, "lag: {gain: 40 1/s}");
    let lag = || Shape::Lag { axis: 0, inertia: 0.0 };
    for (recording, beside_clock, possible) in
        [(&late, true, true), (&late, false, true), (&ahead, true, false), (&ahead, false, true)]
    {
        assert_eq!(is_chosen(&bench, recording, lag(), beside_clock), possible);
    }
}

/// A feed-forward of the acceleration that is too large takes an axis ahead, where a missing one leaves it behind. No clock does either.
#[test]
fn an_acceleration_takes_an_axis_ahead_or_leaves_it_behind() {
    let bench = Bench::of("XFY");
    for recording in late_and_ahead(&bench, "acceleration: {gain: 40 1/s^2}") {
        assert!(is_chosen(&bench, &recording, Shape::Acceleration { axis: 0 }, true));
    }
}

/// A circle of a stage whose X has this term, and of one that has as much of it below zero.
fn late_and_ahead(bench: &Bench, term: &str) -> [Recording; 2] {
    let true_machine = on_a_circle(bench, "{}", "x");
    let late = on_a_circle(bench, &format!("{{EXX: [{{{term}}}]}}"), "x");
    let mut ahead = late.clone();
    let (Some(read), Some(exact)) = (&mut ahead.measured[0], &true_machine.measured[0]) else { panic!() };
    for (read, exact) in read.iter_mut().zip(exact) {
        *read = 2.0 * exact - *read;
    }
    [late, ahead]
}

/// Whether this shape of EXX, which explains what is seen, may be chosen and is.
fn is_chosen(bench: &Bench, recording: &Recording, shape: Shape, beside_clock: bool) -> bool {
    let study = Study::new(bench.equations(), None, &[recording]);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::Drive };
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let clock = beside_clock.then(|| Effect::setting(0, Setting::Clock));
    let effects = [zero, Effect { place, shape }].into_iter().chain(clock);
    let model = Model::of(effects.map(Fitted::unfitted));
    let design = judge::design(&study, &model, &Weights::of_all(&study, vec![vec![Noise::white(1e-3)]]));
    let (products, samples) = design.fitted();
    let choice = Choice::new(&study, &design, products, samples, 1, 1.0, Resolution::new(&study, &[]));
    let empty = choice.empty();
    assert!(choice.with(&empty, 1).cost < empty.cost, "it would explain what is seen");
    let fits = choice.fits(&empty, 1);
    assert_eq!(choice.best().contains(&1), fits);
    fits
}

#[test]
fn of_two_that_bend_alike_in_one_place_one_is_enough() {
    let bench = Bench::of("XFY");
    let recording = on_a_circle(&bench, "{}", "xy");
    let study = Study::new(bench.equations(), None, &[&recording]);
    let on = |motion: &str, shape: Shape| Effect {
        place: Place::Motion { motion: bench.motion(motion), side: Side::After },
        shape,
    };
    let nodes = vec![-40.0, -20.0, 0.0, 20.0, 40.0];
    let table = Shape::Table { axis: 0, nodes, directed: false, repeats: false };
    let bow = Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 40.0 };
    let wave = |period| Shape::Cyclic { axis: 0, period, order: 1, center: 0.0 };
    let effects = [
        on("EXX", table),
        on("EXX", bow.clone()),
        on("EYX", bow),
        on("EXX", wave(7.0)),
        on("EXX", wave(7.3)),
        on("EXX", wave(5.0)),
        on("EYX", wave(7.3)),
    ];
    let model = Model::of(effects.into_iter().map(Fitted::unfitted));
    let design = judge::design(&study, &model, &Weights::of_all(&study, vec![vec![Noise::white(1e-3); 2]]));
    let (products, samples) = design.fitted();
    let travels = crate::travel::travels(&study, &crate::course::courses(&study, &Model::default()));
    let resolution = Resolution::new(&study, &travels);
    let choice = Choice::new(&study, &design, products, samples, 0, 1.0, resolution);
    for (a, b, both) in [
        (0, 1, false),
        (0, 2, true),
        // A table from 20 mm to 20 mm leaves such a wave as it is.
        (0, 3, true),
        // In 80 mm these two cannot be told apart.
        (3, 4, false),
        (3, 5, true),
        (3, 6, true),
    ] {
        for (chosen, next) in [(a, b), (b, a)] {
            let set = choice.with(&choice.empty(), chosen);
            assert_eq!(choice.fits(&set, next), both, "{next} beside {chosen}");
        }
    }
}

/// What one turn of a screw does, the next does too. A table that bends as such a wave does stands for neither it nor its harmonics; a wave
/// without harmonics may be part of a curve.
#[test]
fn a_wave_that_comes_again_stands_beside_a_table() {
    let bench = Bench::of("XFY");
    let recording = on_a_circle(&bench, "{}", "xy");
    let study = Study::new(bench.equations(), None, &[&recording]);
    let on = |shape: Shape| Effect {
        place: Place::Motion { motion: bench.motion("EXX"), side: Side::After },
        shape,
    };
    let nodes = (0..11).map(|node| -40.0 + 8.0 * f64::from(node)).collect();
    let wave = |period, order| Shape::Cyclic { axis: 0, period, order, center: 0.0 };
    // X goes 80 mm: 40 mm come again, 60 mm do not.
    let effects = [
        on(Shape::Table { axis: 0, nodes, directed: false, repeats: false }),
        on(wave(40.0, 1)),
        on(wave(40.0, 3)),
        on(wave(60.0, 1)),
        on(wave(60.0, 4)),
        on(wave(25.0, 1)),
    ];
    let model = Model::of(effects.into_iter().map(Fitted::unfitted));
    let design = judge::design(&study, &model, &Weights::of_all(&study, vec![vec![Noise::white(1e-3); 2]]));
    let (products, samples) = design.fitted();
    let travels = crate::travel::travels(&study, &crate::course::courses(&study, &Model::default()));
    let resolution = Resolution::new(&study, &travels);
    let choice = Choice::new(&study, &design, products, samples, 0, 1.0, resolution);
    let table = choice.with(&choice.empty(), 0);
    let beside: Vec<bool> = (1..6).map(|wave| choice.fits(&table, wave)).collect();
    assert_eq!(beside, [true, true, false, false, false]);
}

/// Whether each of some effects of X outgrows what there is to explain, all of them being fitted to a recording of X and Y.
fn outgrown(calibration: &str, effects: &[(&str, Shape)]) -> Vec<bool> {
    let bench = Bench::of("XFY");
    let recording = on_a_circle(&bench, calibration, "xy");
    let study = Study::new(bench.equations(), None, &[&recording]);
    let zeros = (0..2).map(|channel| Effect::setting(0, Setting::Offset { channel }));
    let effects = effects.iter().map(|(motion, shape)| Effect {
        place: Place::Motion { motion: bench.motion(motion), side: Side::After },
        shape: shape.clone(),
    });
    let model = Model::of(zeros.chain(effects).map(Fitted::unfitted));
    let design = judge::design(&study, &model, &Weights::of_all(&study, vec![vec![Noise::white(1e-3); 2]]));
    let (products, samples) = design.fitted();
    let choice = Choice::new(&study, &design, products, samples, 2, 1.0, Resolution::new(&study, &[]));
    let all = choice.open.iter().fold(choice.empty(), |set, regressor| choice.with(&set, *regressor));
    choice.open.iter().map(|regressor| choice.outgrows(&all, *regressor)).collect()
}

#[test]
fn two_effects_that_nearly_cancel_have_outgrown_what_they_explain() {
    // A bow of 40 um over 40 mm, and a long wave that leaves a half, a quarter or a tenth of it: some 4, 13 and 60 times the squares
    // of what there is to explain, of which 25 is the most.
    let (period, bow) = (400.0, 0.04 / 1600.0);
    let bent = [
        ("EXX", Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 40.0 }),
        ("EXX", Shape::Cyclic { axis: 0, period, order: 1, center: 0.0 }),
    ];
    for (left, outgrow) in [(0.5, false), (0.25, false), (0.1, true)] {
        // The wave is turned up at 0, and bends downwards there by half its amplitude times the square of its angle.
        let amplitude = 2.0 * bow * (1.0 - left) / (std::f64::consts::TAU / period).powi(2);
        let calibration = format!(
            "{{EXX: [{{polynomial: {{axis: X, per: mm, unit: um, coefficients: [0, 0, {}]}}}}, \
             {{cyclic: {{period: {period} mm, amplitude: {} um, phase: 1.5707963267948966 rad}}}}]}}",
            bow * 1e3,
            amplitude * 1e3,
        );
        assert_eq!(outgrown(&calibration, &bent), [outgrow; 2], "{left} of the bow is left");
    }
}

#[test]
fn a_body_turns_by_hundredths_at_most() {
    let turned = [("ECX", Shape::Constant)];
    // In two terms, since a calibration has none that is larger.
    for (half, far) in [(4.0, false), (-4.0, false), (8.0, true), (-8.0, true)] {
        let calibration =
            format!("{{ECX: [{{constant: {{value: {half} mrad}}}}, {{constant: {{value: {half} mrad}}}}]}}");
        assert_eq!(outgrown(&calibration, &turned), [far], "twice {half} mrad");
    }
    // A number that is no angle may be greater: 40 um, written as mm.
    let bent = [("EXX", Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 40.0 })];
    let calibration = "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [0, 0, 0.025]}}]}";
    assert_eq!(outgrown(calibration, &bent), [false]);
}
