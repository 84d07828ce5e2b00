//! What the judge asks of an effect, one question at a time.

use super::*;
use crate::conditions::Tries;
use crate::model::{Effect, Place};
use crate::noise::Noise;
use crate::recording::Recording;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, circle, normals, path, position, scenario};

/// The lost motion of X where it acts with its whole strength, mm.
const LOST: f64 = 0.01;

/// Four circles, the last of which is held out, with a lost motion of X that has another strength in each block of rows; and white
/// noise of X, mm.
fn recorded(bench: &Bench, strength: impl Fn(usize, bool) -> f64, noise: f64) -> Recording {
    let circles = simulation::Path { runs: 4, ..path(circle(40.0), 20.0, 10.0) };
    let scenario = simulation::Scenario { holdout: vec![4], ..scenario(circles, position("x")) };
    let play = bench.calibration(&format!("{{EXX: [{{backlash: {{lost_motion: {LOST} mm}}}}]}}"));
    let mut recording = bench.record(&bench.calibration("{}"), &scenario);
    let whole = bench.record(&play, &scenario);
    let study = Study::new(bench.equations(), None, &[&whole]);
    let random = normals(7, recording.time.len());
    let (Some(without), Some(with)) = (&mut recording.measured[0], &whole.measured[0]) else { panic!() };
    for (number, block) in study.scenes[0].blocks.iter().enumerate() {
        for row in block.rows.clone() {
            without[row] +=
                strength(number, block.held_out) * (with[row] - without[row]) + noise * random[row];
        }
    }
    recording
}

/// What the judge is asked about: the zero of X and its lost motion, fitted.
struct Case<'a> {
    study: Study<'a>,
    fit: Fit,
    design: Design,
    appraisal: Appraisal,
}

/// The number of the lost motion in the model.
const PLAY: usize = 1;

fn fitted<'a>(bench: &'a Bench, recordings: &[&'a Recording], noise: f64) -> Case<'a> {
    let study = Study::new(bench.equations(), None, recordings);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let shape = Shape::Backlash { axis: 0, wind_up: 0.0 };
    let effects = [Effect::setting(0, Setting::Offset { channel: 0 }), Effect { place, shape }];
    let model = Model::of(effects.map(|effect| Fitted { effect, coefficients: vec![0.0] })).with_settings(1);
    let weights = Weights::of_all(&study, vec![vec![Noise::white(noise)]; recordings.len()]);
    let fit = crate::fit::refine(&study, model, &weights, &[]);
    let design = design(&study, &fit.model, &weights);
    let appraisal = Appraisal::new(&study, &fit.model);
    Case { study, fit, design, appraisal }
}

/// All columns of a design, taken in.
fn swept(design: &Design) -> Swept {
    let mut swept = Swept::new(&design.fitted().0);
    for column in 0..design.width {
        swept.take(column);
    }
    swept
}

impl Case<'_> {
    fn returns(&self) -> bool {
        self.returns_beside(1.0)
    }

    /// Where the variance of the noise is `scale` times what it was taken for.
    fn returns_beside(&self, scale: f64) -> bool {
        returns(&self.design, &swept(&self.design), PLAY, scale)
    }

    /// How much there is of the lost motion in the held-out rows, in squares of the noise.
    fn held_out_energy(&self) -> f64 {
        let (design, swept) = (&self.design, swept(&self.design));
        let held_out = design.blocks.iter().filter(|block| block.held_out);
        held_out.map(|block| share(design, &swept, PLAY, block).0).sum()
    }

    fn steady(&self) -> bool {
        steady(&self.design, &swept(&self.design), PLAY)
    }

    fn pays(&self) -> bool {
        let whole = zeros::residuals(&self.study, &self.fit.model);
        let tries = Tries { candidates: 1.0, waves: 1.0 };
        let conditions = Conditions { weights: &self.appraisal.weights, travels: &[], tries };
        let left = (&self.appraisal, &*whole);
        pays(&self.study, &self.design, &swept(&self.design), &self.fit, left, PLAY, &conditions)
    }
}

/// Noise beside which the lost motion is plain, mm; beside which there is some doubt of it; and beside which it is lost.
const QUIET: f64 = 1e-4;
const DOUBTFUL: f64 = 0.025;
const LOUD: f64 = 0.06;

/// The strength of an effect that is there in the rows that are fitted, and of this strength where they are held out.
fn held(strength: f64) -> impl Fn(usize, bool) -> f64 {
    move |_, held_out| if held_out { strength } else { 1.0 }
}

#[test]
fn an_effect_comes_back_with_two_fifths_of_its_strength_at_least() {
    let bench = Bench::of("XFY");
    for (strength, comes_back) in [(1.0, true), (0.45, true), (0.35, false), (0.0, false), (-1.0, false)] {
        let recording = recorded(&bench, held(strength), QUIET);
        assert_eq!(fitted(&bench, &[&recording], QUIET).returns(), comes_back, "{strength}");
    }
    // Where the held-out rows cannot tell, nothing is held against it.
    let recording = recorded(&bench, held(-1.0), LOUD);
    assert!(fitted(&bench, &[&recording], 10.0 * LOUD).returns());
}

#[test]
fn held_out_rows_tell_what_stands_above_the_noise_that_is_there() {
    let bench = Bench::of("XFY");
    let recording = recorded(&bench, held(-1.0), QUIET);
    let case = fitted(&bench, &[&recording], QUIET);
    let telling = case.held_out_energy() / TELLING;
    assert!(telling > 2.0, "{telling}");
    assert!(!case.returns_beside(0.99 * telling));
    assert!(case.returns_beside(1.01 * telling), "nothing is held against it that is lost in noise");
}

#[test]
fn an_effect_that_rests_on_one_stretch_is_not_steady() {
    let bench = Bench::of("XFY");
    let steady = |strength: &dyn Fn(usize, bool) -> f64| {
        let recording = recorded(&bench, strength, QUIET);
        fitted(&bench, &[&recording], QUIET).steady()
    };
    assert!(steady(&|_, _| 1.0));
    assert!(steady(&|block, _| if block % 2 == 0 { 0.8 } else { 1.2 }));
    assert!(!steady(&|block, _| if block == 2 { 9.0 } else { 0.0 }));
    assert!(!steady(&|block, _| if block % 2 == 0 { -1.0 } else { 3.0 }));
}

#[test]
fn a_few_stretches_tell_nothing_of_steadiness() {
    let bench = Bench::of("XFY");
    let recording = recorded(&bench, |block, _| if block % 2 == 0 { -1.0 } else { 3.0 }, QUIET);
    let mut case = fitted(&bench, &[&recording], QUIET);
    case.design.blocks.retain(|block| !block.held_out);
    for (stretches, steady) in [(FEW_BLOCKS, false), (FEW_BLOCKS - 1, true), (2, true)] {
        case.design.blocks.truncate(stretches);
        assert_eq!(case.design.blocks.len(), stretches);
        assert_eq!(case.steady(), steady, "{stretches}");
    }
}

#[test]
fn an_effect_pays_where_held_out_rows_come_nearer() {
    let bench = Bench::of("XFY");
    for (strength, does) in [(1.0, true), (0.6, true), (0.4, false), (0.0, false), (-1.0, false)] {
        let recording = recorded(&bench, held(strength), QUIET);
        assert_eq!(fitted(&bench, &[&recording], QUIET).pays(), does, "{strength}");
    }
}

#[test]
fn an_effect_far_below_the_noise_of_a_sample_does_not_matter() {
    let bench = Bench::of("XFY");
    // The peak of the effect is half of the lost motion; 0.12 of the noise is the least that counts.
    for (share, noise, matters) in
        [(0.3, 0.0, true), (0.16, 0.0, true), (0.08, 0.0, false), (0.04, 1.0, false)]
    {
        let size = 0.5 * LOST / share;
        let recording = recorded(&bench, |_, _| 1.0, noise * size);
        let mut case = fitted(&bench, &[&recording], QUIET);
        case.appraisal.weights.noises = vec![vec![Noise::white(size)]];
        assert_eq!(case.pays(), matters, "{share}");
    }
}

#[test]
fn what_held_out_rows_cannot_tell_is_not_held_against_an_effect() {
    let bench = Bench::of("XFY");
    // It is not there in the held-out circle, where a row tells the square of this share.
    for (share, passes) in [(0.16, true), (0.3, false)] {
        let recording = recorded(&bench, held(0.0), 0.0);
        let mut case = fitted(&bench, &[&recording], QUIET);
        case.appraisal.weights.noises = vec![vec![Noise::white(0.5 * LOST / share)]];
        assert_eq!(case.pays(), passes, "{share}");
    }
}

#[test]
fn recordings_weigh_by_the_squares_of_their_noise() {
    let bench = Bench::of("XFY");
    // Where an effect of strength 1 is there with another strength s, squares fall by 2 s - 1 of its own: by 1, and by -3.
    let recordings = [1.0, -1.0].map(|strength| recorded(&bench, held(strength), QUIET));
    for (ratio, does) in [(1.5, false), (2.0, true)] {
        let mut case = fitted(&bench, &recordings.each_ref(), QUIET);
        case.appraisal.weights.noises = [QUIET, ratio * QUIET].map(|size| vec![Noise::white(size)]).to_vec();
        assert_eq!(case.pays(), does, "{ratio}");
    }
}

/// The first effect that does not pay its penalty, after `settings` that are always fitted. The number of candidates is chosen so that the
/// penalty of the lost motion is `share` of what it is worth: in squares, or in likelihood where the noise takes up a part of it.
fn falls(case: &Case<'_>, settings: usize, share: f64) -> Option<usize> {
    let design = design(&case.study, &case.fit.model, &case.appraisal.weights);
    let (swept, samples) = (swept(&design), design.fitted().1);
    let columns: Vec<usize> = design.columns(PLAY).collect();
    let squares = swept.worth(&columns) * samples / swept.remaining();
    let bare = Appraisal::new(&case.study, &without(&design, &swept, &case.fit.model, &[PLAY]));
    let worth = squares.min(bare.deviance - case.appraisal.deviance);
    let untried = crate::search::price(&case.study, &case.fit.model.effects[PLAY].effect, samples, 1.0, 1.0);
    assert!(untried < 0.5 * worth, "{untried} {worth}");
    let candidates = (0.5 * (share * worth - untried)).exp();
    let weights = &case.appraisal.weights;
    let conditions = Conditions { weights, travels: &[], tries: Tries { candidates, waves: 1.0 } };
    let fit = Fit { model: case.fit.model.clone().with_settings(settings), ..case.fit.clone() };
    weakest(&case.study, &fit, &case.appraisal, &conditions)
}

#[test]
fn an_effect_stands_where_it_is_worth_its_price() {
    let bench = Bench::of("XFY");
    let recording = recorded(&bench, |_, _| 1.0, DOUBTFUL);
    // Also where the noise was taken for smaller or larger than it is.
    for times in [1.0, 0.5, 2.0] {
        let mut case = fitted(&bench, &[&recording], DOUBTFUL);
        case.appraisal.weights.noises = vec![vec![Noise::white(times * DOUBTFUL)]];
        assert_eq!(falls(&case, PLAY, 0.999), None, "{times}");
        assert_eq!(falls(&case, PLAY, 1.001), Some(PLAY), "{times}");
    }
}

#[test]
fn what_is_worth_least_falls_first() {
    let bench = Bench::of("XFY");
    let recording = recorded(&bench, |_, _| 1.0, DOUBTFUL);
    let case = fitted(&bench, &[&recording], DOUBTFUL);
    // The zero, which nothing asks for, is judged here as well.
    let zero = 0;
    assert_eq!(falls(&case, zero, 1.001), Some(zero));
}

/// Whether each of two plays of X, taken up over 3 and over 4 mm, is made up for by the other, with these lost motions, mm.
fn made_up_for(lost_motions: [f64; 2]) -> [bool; 2] {
    let bench = Bench::of("XFY");
    let recording = recorded(&bench, held(1.0), QUIET);
    let study = Study::new(bench.equations(), None, &[&recording]);
    let place = Place::Motion { motion: bench.motion("EXX"), side: Side::After };
    let play = |(wind_up, lost_motion): (f64, f64)| Fitted {
        effect: Effect { place, shape: Shape::Backlash { axis: 0, wind_up } },
        coefficients: vec![lost_motion],
    };
    let zero = Effect::setting(0, Setting::Offset { channel: 0 });
    let mut model = Model::of([Fitted { effect: zero, coefficients: vec![0.0] }]);
    model.effects.extend([3.0, 4.0].into_iter().zip(lost_motions).map(play));
    let design = design(&study, &model, &Weights::of_all(&study, vec![vec![Noise::white(QUIET)]]));
    let beside_settings = beside_settings(&design, &design.fitted().0, 1);
    [1, 2].map(|number| is_made_up_for(&design, &beside_settings, &model, number))
}

#[test]
fn the_smaller_of_two_plays_that_leave_next_to_nothing_of_each_other_is_none() {
    // On circles of 40 mm both are alike to one part in a hundred: of 18 and -15 mm a fifth of the smaller is left.
    assert_eq!(made_up_for([18.0, -15.0]), [false, true]);
    assert_eq!(made_up_for([-15.0, 18.0]), [true, false]);
    // Of 18 and -9 mm as much is left as the smaller is; and plays of one sign add up.
    assert_eq!(made_up_for([18.0, -9.0]), [false, false]);
    assert_eq!(made_up_for([18.0, 15.0]), [false, false]);
}
