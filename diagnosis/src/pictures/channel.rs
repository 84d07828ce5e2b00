//! One channel. In: what the model leaves in it before and after. Out: its picture.

use pages::plot::thin::{extremes, spread};

use super::spectrum;
use super::{AxisTrack, ChannelPicture, RunMean, Samples, Track};
use crate::channel::{ChannelAt, Kind};
use crate::course::Course;
use crate::model::Model;
use crate::scene::Scene;
use crate::states::States;
use crate::study::Study;
use crate::terms::Shape;
use crate::weights::Outliers;

/// What all channels of a recording are seen with.
pub(super) struct Sight<'s> {
    pub(super) study: &'s Study<'s>,
    pub(super) scene: usize,
    pub(super) course: &'s Course,
    pub(super) model: &'s Model,
    /// Samples that are left out beside the model.
    pub(super) outliers: &'s Outliers,
    /// How many samples are drawn of a channel.
    pub(super) samples: usize,
}

/// How many temperatures and loads are drawn, and the least change of a temperature, K.
const TEMPERATURES: usize = 4;
const LOADS: usize = 2;
const WARMER: f64 = 0.1;
/// How many outliers are drawn.
const OUTLIERS: usize = 60;

pub(super) fn draw(
    sight: &Sight<'_>,
    number: usize,
    (before, after): (&[f64], &[f64]),
    outliers_before: &[bool],
    counts: &dyn Fn(Kind) -> bool,
) -> ChannelPicture {
    let scene = &sight.study.scenes[sight.scene];
    let channel = &scene.channels[number];
    let outliers = sight.outliers.of(ChannelAt { scene: sight.scene, channel: number });
    let clean = |values: &[f64], outliers: &[bool]| -> Vec<f64> {
        let marked = values.iter().zip(outliers);
        marked.map(|(value, outlier)| if *outlier { f64::NAN } else { *value }).collect()
    };
    let cleaned = (clean(before, outliers_before), clean(after, outliers));
    let states = sight.course.states(channel.kind);
    ChannelPicture {
        name: channel.name.clone(),
        title: title(sight.study, channel.kind, &channel.name),
        unit: if channel.kind.angular(sight.study.equations) { "rad" } else { "mm" },
        counts: counts(channel.kind),
        samples: count(&cleaned.1),
        outliers: outliers.iter().filter(|outlier| **outlier).count(),
        rms: (rms(&cleaned.0), rms(&cleaned.1)),
        unchanged: unchanged(&cleaned),
        reach: (reach(&cleaned.0), reach(&cleaned.1)),
        shown: shown(sight, states, (before, after), &cleaned, outliers),
        runs: run_means(scene, &cleaned),
        over_time: spectrum::over_time(sight, &cleaned),
        over_position: spectrum::over_position(sight, states, &cleaned),
    }
}

fn title(study: &Study<'_>, kind: Kind, name: &str) -> String {
    let letter = |axis: usize| study.equations.axes[axis].letter.as_str();
    match kind {
        Kind::Tip(direction) => format!("tool tip in {}", ["X", "Y", "Z"][direction]),
        Kind::Radius { .. } => "length of the ballbar".to_owned(),
        Kind::Along(_) => "reading along its direction".to_owned(),
        Kind::Normal => "reading along the normal".to_owned(),
        Kind::Turn(_) => "rotation of the tool relative to the part".to_owned(),
        Kind::Stage(axis) => format!("angle of {}", letter(axis)),
        Kind::Drive(axis) => format!("the drive's own feedback of {}", letter(axis)),
    }
    .replace("reading", if name == "deviation" { "instrument's reading" } else { "reading" })
}

fn finite(values: &[f64]) -> impl Iterator<Item = f64> {
    values.iter().copied().filter(|value| value.is_finite())
}

fn count(values: &[f64]) -> usize {
    finite(values).count()
}

fn rms(values: &[f64]) -> f64 {
    let squares: f64 = finite(values).map(|value| value * value).sum();
    (squares / crate::number(count(values)).max(1.0)).sqrt()
}

/// Whether what changes is small against what is left.
fn unchanged((before, after): &(Vec<f64>, Vec<f64>)) -> bool {
    let changes: Vec<f64> = before.iter().zip(after).map(|(before, after)| before - after).collect();
    rms(&changes) < UNSEEN * rms(after)
}

/// A change of this share of the rms is not seen in a plot.
const UNSEEN: f64 = 0.02;

/// How far nearly all values lie from zero at most, with some room; the greatest where none lies much farther.
pub(super) fn reach(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = finite(values).map(f64::abs).collect();
    sizes.sort_by(f64::total_cmp);
    let greatest = sizes.last().copied().unwrap_or_default();
    let most = sizes.get(sizes.len() * 995 / 1000).copied().unwrap_or(greatest);
    if greatest > 2.5 * most && most > 0.0 { 1.25 * most } else { greatest }
}

fn mean(values: &[f64]) -> f64 {
    finite(values).sum::<f64>() / crate::number(count(values)).max(1.0)
}

/// The rows to draw: spread evenly, with the extremes before and after and some of the outliers.
fn rows(sight: &Sight<'_>, cleaned: &(Vec<f64>, Vec<f64>), outliers: &[bool]) -> Vec<usize> {
    let mut rows = if cleaned.0.len() <= sight.samples {
        (0..cleaned.0.len()).collect()
    } else {
        let mut rows = spread(&cleaned.0, sight.samples * 9 / 10);
        rows.extend(extremes(&cleaned.1, sight.samples / 10));
        rows
    };
    let known = |row: &usize| cleaned.0[*row].is_finite() && cleaned.1[*row].is_finite();
    rows.retain(known);
    rows.extend((0..outliers.len()).filter(|row| outliers[*row]).take(OUTLIERS));
    rows.sort_unstable();
    rows.dedup();
    rows
}

fn shown(
    sight: &Sight<'_>,
    states: &States,
    (before, after): (&[f64], &[f64]),
    cleaned: &(Vec<f64>, Vec<f64>),
    outliers: &[bool],
) -> Samples {
    let scene = &sight.study.scenes[sight.scene];
    let rows = rows(sight, cleaned, outliers);
    let of = |values: &[f64]| -> Vec<f64> { rows.iter().map(|row| values[*row]).collect() };
    let fitted = scene.fitted_rows();
    let moving = states.axes.iter().enumerate().filter(|(_, axis)| axis.moves);
    let axes = moving.map(|(number, axis)| {
        let known = &sight.study.equations.axes[number];
        let velocity: Vec<f64> = if scene.sparse() {
            Vec::new()
        } else {
            of(&axis.clock_slope).iter().map(|slope| -slope).collect()
        };
        AxisTrack {
            letter: known.letter.clone(),
            unit: if known.rotary { "rad" } else { "mm" },
            position: of(&axis.position),
            direction: of(&axis.direction),
            velocity,
        }
    });
    Samples {
        time: of(&scene.recording.time),
        run: rows.iter().map(|row| scene.recording.run[*row]).collect(),
        before: of(before),
        after: of(after),
        held_out: rows.iter().map(|row| !fitted[*row]).collect(),
        outlier: rows.iter().map(|row| outliers[*row]).collect(),
        axes: axes.collect(),
        temperatures: temperatures(sight, &rows),
        loads: loads(sight, &rows),
    }
}

fn range(values: &[f64]) -> f64 {
    let (low, high) =
        finite(values).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(q), high.max(q)));
    (high - low).max(0.0)
}

/// The sensors that the model reads, then those that change most.
fn temperatures(sight: &Sight<'_>, rows: &[usize]) -> Vec<Track> {
    let given = &sight.study.scenes[sight.scene].given.temperatures;
    let reads = |sensor: usize| {
        sight.model.effects.iter().any(|fitted| sensor_of(&fitted.effect.shape) == Some(sensor))
    };
    let mut sensors: Vec<usize> = (0..given.len()).filter(|sensor| range(&given[*sensor]) > WARMER).collect();
    sensors.sort_by(|a, b| {
        reads(*b).cmp(&reads(*a)).then(range(&given[*b]).total_cmp(&range(&given[*a]))).then(a.cmp(b))
    });
    let track = |sensor: usize| Track {
        name: sight.study.sensors[sensor].clone(),
        unit: "degC".to_owned(),
        values: rows.iter().map(|row| given[sensor][*row]).collect(),
    };
    sensors.into_iter().take(TEMPERATURES).map(track).collect()
}

fn sensor_of(shape: &Shape) -> Option<usize> {
    match shape {
        Shape::SensorPolynomial { sensor, .. }
        | Shape::Expansion { sensor, .. }
        | Shape::Growth { sensor, .. } => Some(*sensor),
        _ => None,
    }
}

fn loads(sight: &Sight<'_>, rows: &[usize]) -> Vec<Track> {
    let given = &sight.study.scenes[sight.scene].given.loads;
    let track = |load: usize| Track {
        name: sight.study.loads[load].0.clone(),
        unit: sight.study.loads[load].1.clone(),
        values: rows.iter().map(|row| given[load][*row]).collect(),
    };
    (0..given.len()).filter(|load| range(&given[*load]) > 0.0).take(LOADS).map(track).collect()
}

/// The means of the runs, where there are several; of very many every so-many-th.
fn run_means(scene: &Scene<'_>, (before, after): &(Vec<f64>, Vec<f64>)) -> Vec<RunMean> {
    let fitted = scene.fitted_rows();
    let stretches = scene.recording.runs();
    if stretches.len() < 2 {
        return Vec::new();
    }
    let apart = stretches.len().div_ceil(RUNS);
    let of = |(rows, run): (std::ops::Range<usize>, i64)| {
        let (old, new) = (&before[rows.clone()], &after[rows.clone()]);
        (count(new) > 0).then(|| RunMean {
            run,
            mean: (mean(old), mean(new)),
            rms: (rms(old), rms(new)),
            held_out: fitted[rows].iter().all(|fits| !fits),
        })
    };
    stretches.into_iter().step_by(apart).filter_map(of).collect()
}

/// The most runs that are drawn.
const RUNS: usize = 400;
