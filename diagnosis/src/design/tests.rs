//! The design against brute force, and its columns against finite differences of what a model leaves.

use model_dsl::calibration::Factor;
use simulation::path::Shape as PathShape;
use simulation::{Instrument as Reads, Normal};

use super::*;
use crate::fit;
use crate::model::{Fitted, Place};
use crate::noise::{Whitening, whiten};
use crate::recording::Recording;
use crate::scene::Block;
use crate::side::Side;
use crate::terms::{Setting, Shape};
use crate::testing::{Bench, ballbar, circle, distance, line, noisy, normals, path, peak, position, warming};
use crate::weights::Outliers;

const ERRORS: &str = "{EXX: [{polynomial: {axis: X, per: mm, unit: um, coefficients: [3, 0.05]}}], \
    EYY: [{lag: {gain: 25 1/s}}], EBX: [{table: {axis: X, start: -100 mm, step: 40 mm, unit: urad, values: [0, 20, -10, 30, 5, 0]}}], \
    EC0Y: 40 urad}";

/// What a model leaves of every channel of the one recording, instrument settings taken out.
fn left(study: &Study<'_>, model: &Model) -> Vec<Vec<f64>> {
    crate::observations::residuals(study, 0, model, &Course::new(study, 0, model))
}

/// The columns of regressors for one channel over all rows, the residual last.
fn columns(study: &Study<'_>, channel: usize, model: &Model, regressors: &[Regressor]) -> DMatrix<f64> {
    let width = regressors.iter().map(Regressor::columns).sum();
    let noise = Noise { white: 1.0, wander: 0.0, time_constant: 1.0, alike: 1.0 };
    let course = Course::new(study, 0, model);
    let mut run = ChannelRun::new(study, ChannelAt { scene: 0, channel }, model, noise, regressors, width);
    let rows = study.scenes[0].rows();
    let moved = Passage::new(study, 0, model).moved(study, &course, 0..rows);
    let frame = Frame::new(study, &course, &moved, 0..rows);
    let view = course.states(study.scenes[0].channels[channel].kind).rows(0..rows);
    run.raw_columns(&[frame], &view)
}

fn machine(study: &Study<'_>, name: &str, side: Side, shape: Shape) -> Effect {
    let motion = study.equations.motions.iter().position(|motion| motion.name == name).unwrap();
    Effect { place: Place::Motion { motion, side }, shape }
}

/// A model of some size: terms of the machine with memory, a loop, a clock.
fn model(study: &Study<'_>, settings: &[(Setting, f64)]) -> Model {
    let mut model = Model::of([
        Fitted {
            effect: machine(study, "EXX", Side::After, Shape::Backlash { axis: 0, wind_up: 5.0 }),
            coefficients: vec![0.01],
        },
        Fitted {
            effect: machine(study, "EXX", Side::Drive, Shape::Lag { axis: 0, inertia: 0.0 }),
            coefficients: vec![0.03],
        },
        Fitted {
            effect: machine(
                study,
                "EBX",
                Side::After,
                Shape::Cyclic { axis: 0, period: 30.0, order: 1, center: 0.0 },
            ),
            coefficients: vec![2e-5, 1e-5],
        },
        Fitted {
            effect: machine(study, "EYY", Side::Drive, Shape::Backlash { axis: 1, wind_up: 0.0 }),
            coefficients: vec![0.004],
        },
    ]);
    model.effects.extend(
        settings.iter().map(|(setting, value)| Fitted {
            effect: Effect::setting(0, *setting),
            coefficients: vec![*value],
        }),
    );
    model
}

/// The largest distance of a column from a slope, where something was observed.
fn apart(column: &[f64], slope: &[f64]) -> f64 {
    let pairs = column.iter().zip(slope).filter(|(_, slope)| !slope.is_nan());
    let (seen, of): (Vec<f64>, Vec<f64>) = pairs.map(|(column, slope)| (*column, *slope)).unzip();
    assert!(2 * seen.len() > column.len());
    distance(&seen, &of)
}

/// Every column is how what is left falls with its coefficient.
fn columns_are_slopes(study: &Study<'_>, model: &Model, effects: &[Effect], what: &str) {
    let regressors: Vec<Regressor> = effects.iter().cloned().map(Regressor::of).collect();
    for channel in 0..study.scenes[0].channels.len() {
        let found = columns(study, channel, model, &regressors);
        let mut next = 0;
        for effect in effects {
            for k in 0..effect.shape.columns() {
                let column: Vec<f64> = found.column(next).iter().copied().collect();
                next += 1;
                let size = peak(&column);
                // A change of a micrometre or so.
                let step = if size > 0.0 { 1e-3 / size } else { 1e-6 };
                let step = if effect.shape.nonlinear_in_coefficient() { step * 1e-2 } else { step };
                let moved = |step: f64| {
                    let mut changed = model.clone();
                    let mut coefficients = vec![0.0; effect.shape.columns()];
                    coefficients[k] = step;
                    match changed.effects.iter_mut().find(|fitted| fitted.effect == *effect) {
                        Some(fitted) => fitted.coefficients[k] += step,
                        None => changed.effects.push(Fitted { effect: effect.clone(), coefficients }),
                    }
                    left(study, &changed).swap_remove(channel)
                };
                let (up, down) = (moved(step), moved(-step));
                let slope: Vec<f64> =
                    up.iter().zip(&down).map(|(up, down)| -(up - down) / (2.0 * step)).collect();
                let name = &study.scenes[0].channels[channel].name;
                // Products of an effect with the others' errors are of second order: angles of 1e-4.
                let share = match effect.shape {
                    // Between rows 0.1 s apart the command is straight: the velocity of a piece is not that of its end.
                    Shape::Instrument(Setting::Clock) => 0.06,
                    // How a loop changes is taken by a step of the time constant, and acts on all that reads the position.
                    Shape::Lag { .. } => 0.01,
                    _ => 3e-3,
                };
                let allowed = share * size.max(peak(&slope)) + 1e-9 / step;
                assert!(
                    apart(&column, &slope) <= allowed,
                    "{what}, {name}: {effect:?} {k}: {} of {size}",
                    apart(&column, &slope)
                );
            }
        }
    }
}

fn effects(study: &Study<'_>) -> Vec<Effect> {
    let machine = |name: &str, side: Side, shape: Shape| machine(study, name, side, shape);
    vec![
        machine("EXX", Side::After, Shape::Polynomial { axis: 0, degree: 2, center: 0.0, scale: 60.0 }),
        machine("EYX", Side::After, Shape::Backlash { axis: 0, wind_up: 8.0 }),
        machine(
            "EBX",
            Side::After,
            Shape::Table { axis: 0, nodes: vec![-60.0, 0.0, 60.0], directed: true, repeats: false },
        ),
        machine("EAY", Side::After, Shape::Coupling { axis: 0, degree: 2, scale: 60.0 }),
        machine("ECX", Side::After, Shape::Growth { sensor: 0, reference: 20.0, time_constant: 9.0 }),
        machine("EXX", Side::After, Shape::Expansion { axis: 0, sensor: 0, reference: 20.0 }),
        machine("EC0Y", Side::After, Shape::Constant),
        machine("EZZ", Side::After, Shape::Vibration { frequency: 0.4 }),
        machine("EXX", Side::Drive, Shape::Backlash { axis: 0, wind_up: 0.0 }),
        machine("EXX", Side::Drive, Shape::Lag { axis: 0, inertia: 0.0 }),
        Effect::setting(0, Setting::Offset { channel: 0 }),
        Effect::setting(0, Setting::RunOffset { channel: 0, run: 1 }),
    ]
}

fn recorded(bench: &Bench, instrument: Reads, shape: PathShape, drives: bool) -> Recording {
    let mut scenario = noisy(path(shape, 30.0, 10.0), instrument, 0.0, 1);
    scenario.path.at = vec![vec![], vec![30.0], vec![-40.0]];
    scenario.temperatures = vec![warming("spindle", 10.0, 30.0)];
    if drives {
        scenario.measurement.drives = vec![0, 1];
    }
    bench.record(&bench.calibration(ERRORS), &scenario)
}

/// A name, an instrument, a path and settings of the instrument.
type Case = (&'static str, Reads, PathShape, Vec<(Setting, f64)>);

#[test]
fn columns_are_how_the_residual_falls_for_every_instrument() {
    let bench = Bench::of("XYFZ");
    let known = bench.calibration(ERRORS);
    let slanted = [0.6, 0.0, 0.8];
    let cases: [Case; 6] = [
        ("position", position("xyz"), circle(60.0), vec![(Setting::Clock, 0.02)]),
        (
            "ballbar",
            ballbar([0.01, -0.02, 0.0]),
            circle(60.0),
            vec![
                (Setting::Eccentricity { direction: 0 }, 0.012),
                (Setting::Eccentricity { direction: 1 }, 0.0),
                (Setting::Radius, -0.004),
            ],
        ),
        (
            "linear",
            Reads::Linear { axis: 0, direction: [1.0, 0.0, 0.0], cosine: 0.0 },
            line(0, -60.0, 60.0),
            vec![(Setting::Cosine, 1e-5)],
        ),
        (
            "straightness",
            Reads::Straightness { axis: 0, direction: [0.0, 0.0, 1.0] },
            line(0, -60.0, 60.0),
            vec![],
        ),
        ("angular", Reads::Angular { axis: Some(0), about: [0.0, 1.0, 0.0] }, line(0, -60.0, 60.0), vec![]),
        (
            "probe",
            Reads::Probe { normal: Normal::Fixed(slanted) },
            circle(60.0),
            vec![(Setting::Clock, -0.01)],
        ),
    ];
    for (what, instrument, shape, settings) in cases {
        let recording = recorded(&bench, instrument, shape, what == "position");
        let study = Study::new(bench.equations(), Some(&known), &[&recording]);
        let model = model(&study, &settings);
        let mut all = effects(&study);
        let others = settings.iter().filter(|(setting, _)| *setting != Setting::Clock);
        all.extend(others.map(|(setting, _)| Effect::setting(0, *setting)));
        columns_are_slopes(&study, &model, &all, what);
    }
}

#[test]
fn the_clock_s_column_is_how_the_residual_falls_behind_a_loop_too() {
    let bench = Bench::of("XYFZ");
    for errors in ["{EC0Y: 40 urad}", ERRORS] {
        let known = bench.calibration(errors);
        let recording = recorded(&bench, position("xy"), circle(60.0), true);
        let study = Study::new(bench.equations(), Some(&known), &[&recording]);
        let clock = Effect::setting(0, Setting::Clock);
        let model = Model::of([Fitted { effect: clock.clone(), coefficients: vec![0.02] }]);
        columns_are_slopes(&study, &model, &[clock], errors);
    }
}

#[test]
fn slopes_are_how_the_residual_falls_with_the_nonlinear_parameter() {
    let bench = Bench::of("XYFZ");
    let known = bench.calibration(ERRORS);
    let recording = recorded(&bench, position("xyz"), circle(60.0), false);
    let study = Study::new(bench.equations(), Some(&known), &[&recording]);
    let cases = [
        (
            machine(
                &study,
                "EXX",
                Side::After,
                Shape::Cyclic { axis: 0, period: 13.0, order: 1, center: 0.0 },
            ),
            vec![0.01, -0.02],
        ),
        (machine(&study, "EYX", Side::After, Shape::ReversalSpike { axis: 0, decay: 0.5 }), vec![0.03]),
        (machine(&study, "EZZ", Side::After, Shape::Drift { time_constant: 8.0 }), vec![0.02]),
        (machine(&study, "EZX", Side::After, Shape::Vibration { frequency: 0.3 }), vec![0.02, 0.01]),
        (
            machine(
                &study,
                "ECX",
                Side::After,
                Shape::Growth { sensor: 0, reference: 20.0, time_constant: 9.0 },
            ),
            vec![1e-4],
        ),
    ];
    let gained = Shape::Times {
        core: Box::new(Shape::Cyclic { axis: 1, period: 17.0, order: 1, center: 3.0 }),
        factors: vec![Factor::Direction { axis: 0 }],
    };
    let gained = (machine(&study, "EYY", Side::After, gained), vec![1e-4, -2e-4]);
    let alone =
        cases.into_iter().chain([gained]).map(|(effect, coefficients)| vec![Fitted { effect, coefficients }]);
    let wave = |order: u32, coefficients: [f64; 2]| {
        let shape = Shape::Cyclic { axis: 0, period: 13.0, order, center: 0.0 };
        Fitted { effect: machine(&study, "EXX", Side::After, shape), coefficients: coefficients.to_vec() }
    };
    let harmonics = vec![wave(1, [0.01, -0.02]), wave(2, [0.004, 0.003]), wave(5, [-0.002, 0.001])];
    for sharing in alone.into_iter().chain([harmonics]) {
        let numbers: Vec<usize> = (0..sharing.len()).collect();
        let regressors = [Regressor::slope(&sharing, &numbers)];
        for channel in 0..3 {
            let found = columns(&study, channel, &Model::of(sharing.clone()), &regressors);
            let found: Vec<f64> = found.column(0).iter().copied().collect();
            let value = sharing[0].effect.shape.nonlinear().unwrap().value;
            let step = 1e-3 * value;
            let moved = |value: f64| {
                let at = |Fitted { effect, coefficients }: &Fitted| Fitted {
                    effect: Effect { place: effect.place, shape: effect.shape.with_nonlinear(value) },
                    coefficients: coefficients.clone(),
                };
                left(&study, &Model::of(sharing.iter().map(at))).swap_remove(channel)
            };
            let (up, down) = (moved(value + step), moved(value - step));
            let slope: Vec<f64> =
                up.iter().zip(&down).map(|(up, down)| -(up - down) / (2.0 * step)).collect();
            assert!(apart(&found, &slope) <= 2e-3 * peak(&slope) + 1e-9, "{sharing:?} {channel}");
        }
    }
}

/// A recording with gaps and uneven blocks, of which some are held out.
fn prepared<'r>(
    bench: &'r Bench,
    known: &'r model_dsl::calibration::Calibration,
    recording: &'r Recording,
) -> Study<'r> {
    let mut study = Study::new(bench.equations(), Some(known), &[recording]);
    let scene = &mut study.scenes[0];
    let rows = scene.rows();
    let bounds = [0, 31, 40, 200, rows];
    scene.blocks = bounds
        .windows(2)
        .map(|pair| Block { rows: pair[0]..pair[1], run: 1, held_out: pair[0] == 31 })
        .collect();
    study
}

fn gappy(bench: &Bench) -> Recording {
    let mut recording = recorded(bench, position("xy"), circle(60.0), true);
    let noise = normals(3, recording.time.len());
    for column in recording.measured.iter_mut().flatten() {
        column.iter_mut().zip(&noise).for_each(|(value, noise)| *value += 1e-3 * noise);
        column[55..63].fill(f64::NAN);
    }
    recording
}

const COLORED: Noise = Noise { white: 1e-3, wander: 2e-3, time_constant: 1.5, alike: 1.0 };

/// Weights beside that noise; a sample of the first channel is an outlier.
fn colored(study: &Study<'_>) -> Weights {
    let scene = &study.scenes[0];
    let mut marks = vec![vec![false; scene.rows()]; scene.channels.len()];
    marks[0][77] = true;
    Weights { noises: vec![vec![COLORED; scene.channels.len()]], outliers: Outliers::new(vec![marks]) }
}

#[test]
fn products_are_those_of_whitened_columns() {
    let bench = Bench::of("XYFZ");
    let known = bench.calibration(ERRORS);
    let recording = gappy(&bench);
    let study = prepared(&bench, &known, &recording);
    let model = model(&study, &[]);
    let regressors: Vec<Regressor> = effects(&study).into_iter().map(Regressor::of).collect();
    let weights = colored(&study);
    let design = Design::new(&study, &model, &weights, regressors.clone());
    let mut expected = vec![DMatrix::zeros(design.width + 1, design.width + 1); 4];
    let mut samples = [0.0; 4];
    for channel in 0..study.scenes[0].channels.len() {
        let mut columns = columns(&study, channel, &model, &regressors);
        let known = |row: usize| columns.row(row).iter().all(|value| value.is_finite());
        let valid: Vec<bool> = (0..columns.nrows())
            .map(|row| known(row) && !weights.outliers.of(ChannelAt { scene: 0, channel })[row])
            .collect();
        let steps = Whitening::new(COLORED).steps(&recording.time, &valid);
        for mut column in columns.column_iter_mut() {
            let mut values: Vec<f64> = column.iter().copied().collect();
            whiten(&steps, &mut [0.0], &mut values);
            column.copy_from_slice(&values);
        }
        for (number, block) in study.scenes[0].blocks.iter().enumerate() {
            let rows = columns.rows(block.rows.start, block.rows.len());
            expected[number] += rows.transpose() * rows;
            samples[number] +=
                crate::number(valid[block.rows.clone()].iter().filter(|valid| **valid).count());
        }
    }
    for (number, block) in design.blocks.iter().enumerate() {
        let size = expected[number].diagonal().map(f64::sqrt);
        for row in 0..=design.width {
            for column in 0..=design.width {
                let apart = (block.matrix[(row, column)] - expected[number][(row, column)]).abs();
                assert!(apart <= 1e-9 * size[row] * size[column] + 1e-12, "block {number}: {row} {column}");
            }
        }
        assert_eq!(block.samples, samples[number]);
    }
    let (fitted, count) = design.fitted();
    assert_eq!(count, samples[0] + samples[2] + samples[3]);
    let sum = &design.blocks[0].matrix + &design.blocks[2].matrix + &design.blocks[3].matrix;
    assert!((fitted - &sum).amax() <= 1e-12 * sum.amax());
}

#[test]
fn a_rebased_design_gives_whole_coefficients() {
    let bench = Bench::of("XYFZ");
    let known = bench.calibration(ERRORS);
    let recording = gappy(&bench);
    let study = prepared(&bench, &known, &recording);
    // Effects that are linear, from wherever they stand: least squares leads to the same place.
    let effects = [
        machine(&study, "EXX", Side::After, Shape::Backlash { axis: 0, wind_up: 0.0 }),
        machine(
            &study,
            "EYY",
            Side::After,
            Shape::Polynomial { axis: 1, degree: 1, center: 30.0, scale: 60.0 },
        ),
        Effect::setting(0, Setting::Offset { channel: 0 }),
    ];
    let weights = colored(&study);
    let solved = |coefficients: [f64; 4]| {
        let [a, b, c, d] = coefficients;
        let parts = [vec![a], vec![b, c], vec![d]];
        let effects = effects.iter().cloned().zip(parts);
        let model = Model::of(effects.map(|(effect, coefficients)| Fitted { effect, coefficients }));
        let mut design = Design::new(&study, &model, &weights, Regressor::all(&model.effects));
        design.rebase(&model.effects);
        let (products, _) = design.fitted();
        let fitted = fit::linear(&design, &products, 0, &[0, 1, 2]);
        fitted.into_iter().flat_map(|fitted| fitted.coefficients).collect::<Vec<f64>>()
    };
    let (here, there) = (solved([0.0; 4]), solved([0.02, -0.1, 0.03, 0.05]));
    assert!(distance(&here, &there) < 1e-9, "{here:?} {there:?}");
    assert!(peak(&here) > 1e-6);
}
