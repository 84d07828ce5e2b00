//! Harmonics over two cycles of their wave, where each alone would lean to the others.

use super::*;
use crate::certainty::certainties;
use crate::conditions::Tries;
use crate::course::courses;
use crate::diagnosis::{Parameter, ParameterValue};
use crate::judge;
use crate::model::Place;
use crate::noise::Noise;
use crate::parameters::Described;
use crate::recording::Recording;
use crate::returns;
use crate::side::Side;
use crate::terms::Setting;
use crate::testing::{Bench, line, noisy, path, position};
use crate::travel;
use crate::weights::Weights;
use crate::words;

/// White noise, mm.
const NOISE: f64 = 1e-4;
/// The amplitudes of the fundamental and of its harmonics, mm.
const AMPLITUDES: [f64; 4] = [20e-3, 1.5e-3, 1e-3, 0.5e-3];
/// How long the fundamental is, mm. X goes 44 mm.
const PERIOD: f64 = 20.0;

/// A stage X that makes a wave which is no sine, read with white noise.
fn bent(bench: &Bench, seed: u64) -> Recording {
    let wave = |(amplitude, order): (&f64, f64)| {
        let period = PERIOD / order;
        format!("{{cyclic: {{period: {period} mm, amplitude: {amplitude} mm, phase: {} deg}}}}", 50.0 * order)
    };
    let waves: Vec<String> = AMPLITUDES.iter().zip([1.0, 2.0, 3.0, 4.0]).map(wave).collect();
    record(bench, &waves.join(", "), seed)
}

/// A stage X with these terms, which goes there and back.
fn record(bench: &Bench, terms: &str, seed: u64) -> Recording {
    record_often(bench, terms, 1, seed)
}

fn record_often(bench: &Bench, terms: &str, runs: u32, seed: u64) -> Recording {
    let truth = bench.calibration(&format!("{{EXX: [{terms}]}}"));
    let mut way = path(line(0, 0.0, 44.0), 10.0, 40.0);
    way.runs = runs;
    bench.record(&truth, &noisy(way, position("x"), NOISE, seed))
}

/// What a test asks of one recording.
struct Trial<'t> {
    study: Study<'t>,
    weights: Weights,
    travels: Vec<Travel>,
    motion: usize,
}

impl<'t> Trial<'t> {
    fn new(bench: &'t Bench, recording: &'t Recording) -> Self {
        let study = Study::new(bench.equations(), None, &[recording]);
        let travels = travel::travels(&study, &courses(&study, &Model::default()));
        let weights = Weights::of_all(&study, vec![vec![Noise::white(NOISE)]]);
        Self { study, weights, travels, motion: bench.motion("EXX") }
    }

    fn conditions(&self) -> Conditions<'_> {
        let tries = Tries { candidates: 50.0, waves: 100.0 };
        Conditions { weights: &self.weights, travels: &self.travels, tries }
    }

    /// The zero of the stage, and waves of these lengths and orders.
    fn model(&self, waves: &[(f64, u32)]) -> Model {
        let place = Place::Motion { motion: self.motion, side: Side::After };
        let wave = |(period, order): &(f64, u32)| Effect {
            place,
            shape: Shape::Cyclic { axis: 0, period: *period, order: *order, center: 22.0 },
        };
        let waves = waves.iter().map(wave).map(Fitted::unfitted);
        let zero = Effect::setting(0, Setting::Offset { channel: 0 });
        waves.fold(Model::of_settings([zero]), |model, wave| model.with(wave))
    }

    fn refined(&self, waves: &[(f64, u32)]) -> Fit {
        // Without an amplitude a period has no slope: the first fit gives the amplitudes.
        self.conditions().refine(&self.study, self.model(waves))
    }
}

/// The lengths of the fundamentals and the orders of the waves of a model, in the order of the waves' lengths.
fn waves(model: &Model) -> Vec<(f64, u32)> {
    let of = |fitted: &Fitted| match fitted.effect.shape {
        Shape::Cyclic { period, order, .. } => Some((period, order)),
        _ => None,
    };
    let mut waves: Vec<(f64, u32)> = model.chosen().iter().filter_map(of).collect();
    waves.sort_by(|a, b| (b.0 / f64::from(b.1)).total_cmp(&(a.0 / f64::from(a.1))));
    waves
}

#[test]
fn harmonics_keep_the_length_of_their_wave_and_come_to_the_truth() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 3);
    let fit = Trial::new(&bench, &recording).refined(&[(20.3, 1), (20.3, 2), (20.3, 3), (20.3, 4)]);
    let found = waves(&fit.model);
    assert!(found.iter().all(|(period, _)| *period == found[0].0), "{found:?}");
    // The length of 20 um over 2.2 cycles is known to 20 mm / 2.2 * sqrt(6) / pi / sqrt(350) * 0.1 um / 20 um: 2 um.
    assert!((found[0].0 - PERIOD).abs() < 8e-3, "{found:?}");
    for (fitted, truth) in fit.model.chosen().iter().zip(AMPLITUDES) {
        let size = fitted.coefficients[0].hypot(fitted.coefficients[1]);
        assert!((size - truth).abs() < 5e-5, "{size} for {truth}");
    }
}

#[test]
fn what_harmonics_share_is_known_better_than_what_each_would_have_alone() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 5);
    let trial = Trial::new(&bench, &recording);
    let half = |fit: &Fit, number: usize, name: &str| {
        let certainties = certainties(&trial.study, fit, &trial.conditions());
        let described = Described::new(&trial.study, &fit.model.effects[number], &certainties[number]);
        let parameters = described.parameters();
        let parameter: &Parameter = parameters.iter().find(|known| known.name == name).unwrap();
        let ParameterValue::Fitted(estimate) = &parameter.value else { panic!("{name} is fitted") };
        assert!(estimate.ci95.0 < estimate.value && estimate.value < estimate.ci95.1, "{name}: {estimate:?}");
        0.5 * (estimate.ci95.1 - estimate.ci95.0)
    };
    let together = trial.refined(&[(20.0, 1), (20.0, 2), (20.0, 3), (20.0, 4)]);
    let alone = trial.refined(&[(20.0, 1), (10.0, 1), (20.0 / 3.0, 1), (5.0, 1)]);
    let last = together.model.effects.len() - 1;
    for name in ["period", "phase"] {
        let (together, alone) = (half(&together, last, name), half(&alone, last, name));
        assert!(together < 0.5 * alone, "{name}: {together} and {alone}");
    }
    // A fourth of the length is known four times as well as the length.
    let [whole, fourth] = [1, last].map(|number| half(&together, number, "period"));
    assert!((whole / fourth / 4.0 - 1.0).abs() < 1e-9, "{whole} and {fourth}");
}

#[test]
fn a_wave_that_cannot_be_told_from_a_harmonic_becomes_one_and_others_come_with_it() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 7);
    let trial = Trial::new(&bench, &recording);
    // A wave of 9.6 mm differs from one of 10 mm by 0.18 cycles over 44 mm.
    let model = try_harmonics(&trial.study, trial.refined(&[(20.2, 1), (9.6, 1)]), &trial.conditions()).model;
    let found = waves(&model);
    assert_eq!(found.iter().map(|(_, order)| *order).collect::<Vec<u32>>(), [1, 2, 3, 4]);
    assert!(found.iter().all(|(period, _)| *period == found[0].0), "{found:?}");
}

#[test]
fn a_sine_has_no_harmonics_and_a_wave_that_is_told_from_one_stays() {
    let bench = Bench::of("FX");
    let fundamental = "{cyclic: {period: 20 mm, amplitude: 20 um, phase: 50 deg}}";
    let sine = record(&bench, fundamental, 9);
    let trial = Trial::new(&bench, &sine);
    let model = try_harmonics(&trial.study, trial.refined(&[(20.0, 1)]), &trial.conditions()).model;
    assert_eq!(waves(&model).len(), 1);
    // 9 mm are 0.49 cycles from 10 mm over 44 mm: of 5 um that is far above the noise.
    let beside = record(
        &bench,
        &format!("{fundamental}, {{cyclic: {{period: 9 mm, amplitude: 5 um, phase: 0 deg}}}}"),
        9,
    );
    let trial = Trial::new(&bench, &beside);
    let model = try_harmonics(&trial.study, trial.refined(&[(20.0, 1), (9.0, 1)]), &trial.conditions()).model;
    let found = waves(&model);
    assert_eq!(found.iter().map(|(_, order)| *order).collect::<Vec<u32>>(), [1, 1]);
    assert!((found[1].0 - 9.0).abs() < 0.01, "{found:?}");
}

/// A fundamental as small as the noise of a sample: its length is known to some tenths of a mm, so that its fourth harmonic may lie anywhere
/// around the other wave.
#[test]
fn a_wave_whose_length_is_hardly_known_has_no_harmonics() {
    let bench = Bench::of("FX");
    let faint = "{cyclic: {period: 20 mm, amplitude: 0.1 um, phase: 50 deg}}";
    let recording = record(
        &bench,
        &format!("{faint}, {{cyclic: {{period: 5.05 mm, amplitude: 5 um, phase: 0 deg}}}}"),
        13,
    );
    let trial = Trial::new(&bench, &recording);
    let fit = trial.refined(&[(20.0, 1), (5.05, 1)]);
    let tied = trial.refined(&[(20.0, 1), (20.0, 4)]);
    let conditions = trial.conditions();
    assert!(conditions.cost(&trial.study, &tied) < conditions.cost(&trial.study, &fit), "it would cost less");
    let model = try_harmonics(&trial.study, fit, &conditions).model;
    assert_eq!(waves(&model).iter().map(|(_, order)| *order).collect::<Vec<u32>>(), [1, 1]);
}

/// Of 5 um, a wave of 9.6 mm is told from the second harmonic of 20 mm: tied to it, both would lose.
#[test]
fn harmonics_that_cost_more_than_waves_by_themselves_are_set_apart() {
    let bench = Bench::of("FX");
    let wave = |period: f64, amplitude: f64| {
        format!("{{cyclic: {{period: {period} mm, amplitude: {amplitude} um, phase: 50 deg}}}}")
    };
    let recording = record(&bench, &format!("{}, {}", wave(20.0, 20.0), wave(9.6, 5.0)), 17);
    let trial = Trial::new(&bench, &recording);
    let tied = trial.refined(&[(20.0, 1), (20.0, 2)]);
    let found = waves(&try_harmonics(&trial.study, tied, &trial.conditions()).model);
    assert_eq!(found.iter().map(|(_, order)| *order).collect::<Vec<u32>>(), [1, 1]);
    assert!((found[1].0 - 9.6).abs() < 0.01, "{found:?}");
}

/// A wave of 9 mm cannot be told from a second harmonic of 20 mm by its length alone, and of 5 um it is none. The third and the fourth are
/// harmonics all the same.
#[test]
fn a_wave_of_another_cause_keeps_no_harmonics_from_their_wave() {
    let bench = Bench::of("FX");
    let wave = |(period, amplitude): (f64, f64)| {
        format!("{{cyclic: {{period: {period} mm, amplitude: {amplitude} um, phase: 50 deg}}}}")
    };
    let waves_there = [(20.0, 20.0), (9.0, 5.0), (20.0 / 3.0, 1.0), (5.0, 0.5)];
    let recording = record(&bench, &waves_there.map(wave).join(", "), 19);
    let trial = Trial::new(&bench, &recording);
    let fit = trial.refined(&waves_there.map(|(period, _)| (period, 1)));
    let found = waves(&try_harmonics(&trial.study, fit, &trial.conditions()).model);
    assert_eq!(found.iter().map(|(_, order)| *order).collect::<Vec<u32>>(), [1, 1, 3, 4], "{found:?}");
    assert!((found[1].0 - 9.0).abs() < 0.01, "{found:?}");
}

#[test]
fn a_wave_stands_for_those_that_cannot_be_told_from_it_where_it_has_harmonics() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 1);
    let trial = Trial::new(&bench, &recording);
    let resolution = Resolution::new(&trial.study, &trial.travels);
    let stands = |model: &Model, period: f64| {
        let wave = trial.model(&[(period, 1)]).effects[1].effect.clone();
        stands_for(model, &resolution, &wave)
    };
    // Over 44 mm, 9 mm are 0.5 cycles from 10 mm, and 8 mm are 1.1.
    let tied = trial.model(&[(PERIOD, 1), (PERIOD, 2)]);
    assert_eq!([20.5, 9.0, 8.0].map(|period| stands(&tied, period)), [true, true, false]);
    // A wave by itself goes where it gains most.
    let alone = trial.model(&[(PERIOD, 1), (10.0, 1)]);
    assert_eq!([20.5, 9.0].map(|period| stands(&alone, period)), [false, false]);
}

#[test]
fn parts_of_a_turn_are_no_harmonics_that_are_looked_for() {
    let bench = Bench::of("FC");
    let truth = bench.calibration("{ECC: [{cyclic: {period: 120 deg, amplitude: 50 urad, phase: 0 deg}}]}");
    let way = path(line(0, 0.0, std::f64::consts::TAU), 0.5, 20.0);
    let recording = bench.record(&truth, &noisy(way, position("c"), 1e-6, 1));
    let study = Study::new(bench.equations(), None, &[&recording]);
    let travels = travel::travels(&study, &courses(&study, &Model::default()));
    let place = Place::Motion { motion: bench.motion("ECC"), side: Side::After };
    let wave = |order: u32| {
        let shape = Shape::Cyclic { axis: 0, period: 2.0, order, center: 0.0 };
        Fitted::unfitted(Effect { place, shape })
    };
    let model = Model::of([wave(1), wave(2)]);
    assert!(open(&study, &model, &travels).is_empty());
    // Of an axis that did not go round they would be.
    let half = [Travel { high: travels[0].low + 0.5 * travels[0].range(), ..travels[0] }];
    assert!(!open(&study, &model, &half).is_empty());
}

#[test]
fn the_harmonics_of_a_wave_are_one_thing_and_its_fundamental_is_another() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 1);
    let trial = Trial::new(&bench, &recording);
    let model = trial.model(&[(20.0, 1), (20.0, 2), (7.3, 1), (20.0, 5), (7.3, 2)]);
    let of = |number: usize| together(&model, number);
    assert_eq!([of(1), of(2), of(3), of(4), of(5)], [vec![1], vec![2, 4], vec![3], vec![2, 4], vec![5]]);
    assert_eq!(sharing(&model.effects), [vec![1, 2, 4], vec![3, 5]]);
    // None is open that stands there, or that the rows do not resolve.
    let open = open(&trial.study, &model, &trial.travels);
    let of_first = open.iter().filter(|effect| matches!(effect.shape, Shape::Cyclic { period: 20.0, .. }));
    assert_eq!(of_first.count(), usize::try_from(HIGHEST).unwrap() - 3);
}

#[test]
fn a_harmonic_without_its_fundamental_is_a_wave_by_itself() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 1);
    let model = Trial::new(&bench, &recording).model(&[(20.0, 1), (20.0, 2), (20.0, 4), (7.0, 1), (7.0, 2)]);
    assert_eq!(waves(&model.without(1)), [(10.0, 1), (7.0, 1), (5.0, 1), (7.0, 2)]);
    assert_eq!(waves(&model.without(2)), [(20.0, 1), (7.0, 1), (20.0, 4), (7.0, 2)]);
    let short = model.keeping(|fitted| !matches!(fitted.effect.shape, Shape::Cyclic { order: 1, .. }));
    assert_eq!(waves(&short), [(10.0, 1), (5.0, 1), (3.5, 1)]);
}

#[test]
fn a_harmonic_is_told_with_the_length_of_its_wave() {
    let bench = Bench::of("FX");
    let recording = bent(&bench, 1);
    let trial = Trial::new(&bench, &recording);
    let model = trial.model(&[(PERIOD, 1), (PERIOD, 3)]);
    let detail =
        |number: usize| words::location(&trial.study, &model, &model.effects[number], &[]).detail.clone();
    assert_eq!(detail(1), "repeats every 20.0000 mm of x");
    assert_eq!(detail(2), "repeats every 6.6667 mm of x, harmonic 3 of 20.0000 mm");
}

/// Seven harmonics of equal size, of which the model has four. What comes back beside them is the three others: more than each of the four
/// takes, and less than all of them do.
#[test]
fn harmonics_of_one_wave_are_judged_together() {
    let bench = Bench::of("FX");
    let wave = |order: u32, amplitude: f64| {
        let (period, phase) = (PERIOD / f64::from(order), 70 * order * order);
        format!("{{cyclic: {{period: {period} mm, amplitude: {amplitude} mm, phase: {phase} deg}}}}")
    };
    let rest = (2..=8).map(|order| wave(order, 1.5e-3));
    let terms: Vec<String> = std::iter::once(wave(1, 20e-3)).chain(rest).collect();
    let recording = record_often(&bench, &terms.join(", "), 6, 11);
    let mut trial = Trial::new(&bench, &recording);
    let zero = trial.refined(&[]).model;
    trial.study = returns::told(trial.study, &zero, &trial.weights.outliers);
    let upheld = |waves: &[(f64, u32)]| {
        judge::uphold(&trial.study, trial.refined(waves), &trial.conditions()).0.model.chosen().len()
    };
    let orders = [1, 2, 3, 4, 5];
    assert_eq!(upheld(&orders.map(|order| (PERIOD, order))), 5);
    assert!(upheld(&orders.map(|order| (PERIOD / f64::from(order), 1))) < 5);
}
