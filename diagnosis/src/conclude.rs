//! The conclusion: from recordings to a diagnosis.
//!
//! In: what the user gives. Out: the verdict, findings in words and numbers, and how far they carry on held-out data.

use crate::alternatives;
use crate::appraisal::Appraisal;
use crate::candidates;
use crate::curves::BROAD;
use crate::diagnosis::{
    Alternative, Diagnosis, Evidence, Finding, Interval, IntervalOf, NoiseSummary, Parameter, Residual,
    SettingFinding, Summary, Unexplained, Verdict,
};
use crate::engine::{self, Found};
use crate::fit;
use crate::judge;
use crate::local::{self, Feature};
use crate::model::{Effect, Fitted, Model};
use crate::parameters::{Described, WIDTH_95, axis_unit};
use crate::recording::Instrument;
use crate::repeats;
use crate::rest;
use crate::study::{Kind, Scene, Study};
use crate::sweep::Swept;
use crate::terms::{Setting, Shape};
use crate::words;
use crate::zeros;
use crate::{Inputs, Progress};

/// The fewest samples from which anything is claimed.
const FEWEST: usize = 24;
/// How many names are told for one finding at most.
const NAMES: usize = 4;

/// Finds what the model leaves out.
pub(crate) fn diagnose(inputs: &Inputs<'_>, progress: &mut dyn FnMut(Progress)) -> Diagnosis {
    let recordings: Vec<_> = inputs.recordings.iter().copied().chain(inputs.holdout).collect();
    let mut study = Study::new(inputs.equations, inputs.calibration, &recordings);
    rest::tell(&mut study);
    if inputs.holdout.is_some()
        && let Some(scene) = study.scenes.last_mut()
    {
        scene.blocks.iter_mut().for_each(|block| block.held_out = true);
    }
    let mut diagnosis = Diagnosis {
        machine: inputs.equations.machine.clone(),
        undecided: undecided(&study),
        ..Diagnosis::default()
    };
    if let Some(reason) = too_little(&study) {
        return undecidable(diagnosis, &study, reason);
    }
    let units = Units::new(&study);
    let bare = bare_model(&mut study);
    if let Some(reason) = astray(&study, &bare) {
        return undecidable(diagnosis, &study, reason);
    }
    diagnosis.before = units.residual(&study, &bare);
    let mut step = |done: f64| progress(Progress { step: "looking for left-out physics", done: 0.9 * done });
    let always = candidates::always(&study);
    let mut found = engine::find(&mut study, always, &mut step);
    let scattered = repeats::scatter(&mut study, &found.fit.model);
    if !scattered.is_empty() {
        let mut always = candidates::always(&study);
        for scatter in &scattered {
            let fitted: Vec<i64> = fitted_runs(&study.scenes[scatter.scene]);
            always.extend(repeats::run_zeros(scatter.scene, &study.scenes[scatter.scene], &fitted));
        }
        found = engine::find(&mut study, always, &mut step);
    }
    let feature = explain_locally(&mut study, &mut found);
    progress(Progress { step: "comparing with other names", done: 0.95 });
    zeros::free_held_out(&study, &mut found.fit.model);
    diagnosis.after = units.residual(&study, &found.fit.model);
    let quiet = feature.as_ref().and_then(|feature| engine::beside(&study, &found, feature));
    diagnosis.noise = units.noise(&study, quiet.as_ref().unwrap_or(&found.appraisal));
    report(&study, &found, &units, &mut diagnosis);
    diagnosis.unexplained = feature.map(|feature| unexplained(&study, &found, &feature, &units));
    diagnosis.repeatability = scattered.first().map(|scatter| repeats::describe(&study, scatter, units.unit));
    diagnosis.verdict = verdict(&diagnosis);
    diagnosis.recordings = study.scenes.iter().map(summary).collect();
    diagnosis
}

fn verdict(diagnosis: &Diagnosis) -> Verdict {
    let demanding = |setting: &SettingFinding| matches!(setting.term, "clock" | "cosine");
    if diagnosis.repeatability.is_some() {
        Verdict::NotRepeatable
    } else if diagnosis.unexplained.is_some() {
        Verdict::Unexplained
    } else if !diagnosis.findings.is_empty() || diagnosis.settings.iter().any(demanding) {
        Verdict::LeftOutPhysics
    } else {
        Verdict::Adequate
    }
}

/// The settings of the instruments alone, fitted.
fn bare_model(study: &mut Study<'_>) -> Model {
    let effects = candidates::always(study);
    let model: Model = effects.into_iter().map(|effect| Fitted { effect, coefficients: vec![0.0] }).collect();
    let appraisal = Appraisal::new(study, &model);
    appraisal.mark(study);
    let noises: Vec<Vec<_>> = appraisal
        .noises
        .iter()
        .map(|channels| channels.iter().map(|noise| noise.as_white()).collect())
        .collect();
    let mut model = fit::refine(study, model, &noises, &[]).model;
    zeros::free_held_out(study, &mut model);
    model
}

/// Looks for what remains at one place of an axis; what covers much of the travel becomes a `table`, and the search goes on.
fn explain_locally(study: &mut Study<'_>, found: &mut Found) -> Option<Feature> {
    for _ in 0..TABLES {
        let courses = engine::courses(study, &found.fit.model);
        let feature = local::strongest(study, &found.appraisal, &courses, &found.travels)?;
        if feature.extent(&found.travels[feature.axis]) < BROAD {
            return Some(feature);
        }
        match engine::with_table(study, found, &feature) {
            Some(better) => *found = better,
            None => return Some(feature),
        }
    }
    None
}

/// The most tables that are added.
const TABLES: usize = 3;

/// What the recordings cannot tell, whatever is found.
fn undecided(study: &Study<'_>) -> Vec<String> {
    let mut sentences = Vec::new();
    let moving = |axis: usize| {
        study.scenes.iter().any(|scene| {
            let known = &scene.recording.axes[axis];
            let positions = known.command.as_ref().or(known.actual.as_ref()).or(known.measured.as_ref());
            let mut finite = positions.into_iter().flatten().filter(|position| position.is_finite());
            finite.next().is_some_and(|first| finite.any(|position| position != first))
        })
    };
    let axes = &study.equations.axes;
    let still: Vec<&str> =
        (0..axes.len()).filter(|axis| !moving(*axis)).map(|axis| axes[axis].letter.as_str()).collect();
    if still.len() == axes.len() {
        sentences.push(
            "What depends on position, direction or speed cannot be decided from this recording, because no axis moves."
                .to_owned(),
        );
    } else if !still.is_empty() {
        let verb = if still.len() == 1 { "does" } else { "do" };
        sentences.push(format!(
            "What depends on the motion of {} cannot be decided from this recording, because {} {verb} not move.",
            still.join(" and "),
            if still.len() == 1 { "it" } else { "they" }
        ));
    }
    let corners: usize =
        study.scenes.iter().map(|scene| scene.corners.iter().filter(|corner| **corner).count()).sum();
    if corners > 0 {
        sentences.push(format!(
            "What happens at corners of the path cannot be decided in {corners} rows, which are left out, because the path \
             turned between two rows."
        ));
    }
    if study.scenes.iter().all(|scene| scene.run_numbers().len() < 2) {
        sentences.push(
            "Whether runs repeat cannot be decided from this recording, because there is one run.".to_owned(),
        );
    }
    sentences
}

/// Why nothing at all can be claimed, where that is so.
fn too_little(study: &Study<'_>) -> Option<String> {
    let mut fitted = 0;
    let mut held_out = 0;
    for scene in &study.scenes {
        let rows = scene.fitted_rows();
        for channel in &scene.channels {
            for (value, fits) in channel.values.iter().zip(&rows) {
                fitted += usize::from(value.is_finite() && *fits);
                held_out += usize::from(value.is_finite() && !*fits);
            }
        }
    }
    let because = if fitted + held_out == 0 {
        "it holds nothing that was observed".to_owned()
    } else if fitted < FEWEST {
        format!(
            "{fitted} samples to fit are too few to tell an effect from noise (at least {FEWEST} are needed)"
        )
    } else if held_out == 0 {
        "nothing is left to hold out, and what is not tested on other data is not claimed".to_owned()
    } else {
        return None;
    };
    Some(because)
}

fn undecidable(mut diagnosis: Diagnosis, study: &Study<'_>, because: String) -> Diagnosis {
    let sentence = format!("Nothing can be decided from this recording, because {because}.");
    diagnosis.undecided.push(sentence.clone());
    diagnosis.undecidable = Some(sentence);
    let nothing = Residual { rms: f64::NAN, holdout_rms: None, unit: "mm" };
    (diagnosis.before, diagnosis.after) = (nothing, nothing);
    diagnosis.noise = NoiseSummary { value: f64::NAN, unit: "mm", ..NoiseSummary::default() };
    diagnosis.recordings = study.scenes.iter().map(summary).collect();
    diagnosis
}

/// Why what was observed cannot be this machine on this path, where that is so: half of the samples of a channel lie far off,
/// against the travel. No error of a machine is as large; a wrong unit, a wrong column and a wrong axis are.
fn astray(study: &Study<'_>, bare: &Model) -> Option<String> {
    for (scene, residuals) in zeros::residuals(study, bare).into_iter().enumerate() {
        let travel =
            study.scenes[scene].recording.axes.iter().filter_map(|axis| axis.command.as_deref()).map(range);
        let travel = travel.fold(0.0, f64::max);
        for (channel, residual) in study.scenes[scene].channels.iter().zip(residuals) {
            let mut sizes: Vec<f64> =
                residual.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
            sizes.sort_by(f64::total_cmp);
            let median = sizes.get(sizes.len() / 2).copied().unwrap_or_default();
            let slack = if channel.kind.angular(study.equations) { FAR_OFF.1 } else { FAR_OFF.0 };
            if median > slack + FAR_OFF_OF_TRAVEL * travel {
                return Some(format!(
                    "`{}` of {} does not follow the programmed path: half of its samples are off by more than {median:.3}; \
                     look at its column, its unit and the axes",
                    channel.name, study.scenes[scene].recording.file
                ));
            }
        }
    }
    None
}

/// How far off, mm and rad, and as a share of the travel, is too far for an error of a machine.
const FAR_OFF: (f64, f64) = (0.5, 0.01);
const FAR_OFF_OF_TRAVEL: f64 = 0.05;

fn range(values: &[f64]) -> f64 {
    let known = values.iter().filter(|value| value.is_finite());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
    (high - low).max(0.0)
}

fn fitted_runs(scene: &Scene<'_>) -> Vec<i64> {
    let fits = |run: &i64| scene.blocks.iter().any(|block| block.run == *run && !block.held_out);
    scene.run_numbers().into_iter().filter(fits).collect()
}

/// The unit in which residuals are told, and which channels count.
struct Units {
    unit: (f64, &'static str),
    outside: bool,
    angular: bool,
}

impl Units {
    fn new(study: &Study<'_>) -> Self {
        let kinds = || study.scenes.iter().flat_map(|scene| &scene.channels).map(|channel| channel.kind);
        let outside = kinds().any(Kind::outside);
        let first = kinds().find(|kind| kind.outside() == outside);
        let angular = first.is_some_and(|kind| kind.angular(study.equations));
        let unit = match first {
            Some(Kind::Stage(axis) | Kind::Drive(axis)) => axis_unit(study, axis),
            _ if angular => (1.0, "rad"),
            _ => (1.0, "mm"),
        };
        Self { unit, outside, angular }
    }

    fn counts(&self, study: &Study<'_>, kind: Kind) -> bool {
        kind.outside() == self.outside && kind.angular(study.equations) == self.angular
    }

    /// The size of what a model leaves.
    fn residual(&self, study: &Study<'_>, model: &Model) -> Residual {
        let (mut all, mut held) = ((0.0, 0.0), (0.0, 0.0));
        for (scene, residuals) in zeros::residuals(study, model).into_iter().enumerate() {
            let fitted = study.scenes[scene].fitted_rows();
            for (channel, residual) in study.scenes[scene].channels.iter().zip(residuals) {
                if !self.counts(study, channel.kind) {
                    continue;
                }
                for ((value, outlier), fits) in residual.iter().zip(&channel.outliers).zip(&fitted) {
                    if value.is_finite() && !outlier {
                        all = (all.0 + value * value, all.1 + 1.0);
                        if !fits {
                            held = (held.0 + value * value, held.1 + 1.0);
                        }
                    }
                }
            }
        }
        let rms = |(squares, count): (f64, f64)| (squares / f64::max(count, 1.0)).sqrt() * self.unit.0;
        Residual { rms: rms(all), holdout_rms: (held.1 > 0.0).then(|| rms(held)), unit: self.unit.1 }
    }

    /// The residuals of all counted channels on the held-out rows (on all rows where none are), the mean of each channel
    /// taken out.
    fn held_out(&self, study: &Study<'_>, model: &Model) -> Vec<f64> {
        let any = study.scenes.iter().any(|scene| scene.blocks.iter().any(|block| block.held_out));
        let mut values = Vec::new();
        for (scene, residuals) in zeros::residuals(study, model).into_iter().enumerate() {
            let fitted = study.scenes[scene].fitted_rows();
            for (channel, residual) in study.scenes[scene].channels.iter().zip(residuals) {
                if self.counts(study, channel.kind) {
                    let chosen = (0..residual.len()).filter(|row| {
                        residual[*row].is_finite() && !channel.outliers[*row] && !(any && fitted[*row])
                    });
                    let mut of_channel: Vec<f64> = chosen.map(|row| residual[row]).collect();
                    zeros::center(&mut of_channel);
                    values.extend(of_channel);
                }
            }
        }
        values
    }

    fn noise(&self, study: &Study<'_>, appraisal: &Appraisal) -> NoiseSummary {
        let channels = study
            .scenes
            .iter()
            .zip(&appraisal.noises)
            .flat_map(|(scene, noises)| scene.channels.iter().zip(noises));
        let counted: Vec<_> = channels
            .filter(|(channel, _)| self.counts(study, channel.kind))
            .map(|(_, noise)| *noise)
            .collect();
        let count = crate::number(counted.len()).max(1.0);
        let mean = |part: &dyn Fn(&crate::noise::Noise) -> f64| {
            (counted.iter().map(|noise| part(noise) * part(noise)).sum::<f64>() / count).sqrt() * self.unit.0
        };
        let (white, wander) = (mean(&|noise| noise.white), mean(&|noise| noise.wander));
        let wandering = counted.iter().filter(|noise| noise.wander > 0.0);
        let time_constant = wandering.map(|noise| noise.time_constant).fold(0.0, f64::max);
        NoiseSummary { value: white.hypot(wander), unit: self.unit.1, white, wander, time_constant }
    }
}

/// Fills findings and settings.
fn report(study: &Study<'_>, found: &Found, units: &Units, diagnosis: &mut Diagnosis) {
    let names = alternatives::find(study, found);
    let design = judge::design(study, &found.fit.model, &found.appraisal.noises);
    let (products, _) = design.fitted();
    let mut swept = Swept::new(&products);
    for column in 0..design.width {
        swept.take(column);
    }
    let with = held_rms(&diagnosis.after);
    let shares = shares(study, found, units);
    for (number, fitted) in found.fit.model.iter().enumerate() {
        let described = Described::new(study, fitted, &found.fit.covariances[number]);
        let names = number.checked_sub(found.always).map_or(&[] as &[Effect], |place| &names[place]);
        let alternatives = told(study, &fitted.effect, names);
        let Some(motion) = fitted.effect.motion() else {
            if let Some(setting) = setting(found, number, alternatives) {
                diagnosis.settings.push(setting);
            }
            continue;
        };
        let mut reduced = judge::without(&design, &swept, &found.fit.model, number);
        zeros::free_held_out(study, &mut reduced);
        let without = held_rms(&units.residual(study, &reduced));
        let known = &study.equations.motions[motion];
        let calibrated = described.calibrated();
        diagnosis.findings.push(Finding {
            motion: known.name.clone(),
            motion_number: motion,
            motion_meaning: known.meaning.clone(),
            term: fitted.effect.shape.name(),
            parameters: described.parameters(),
            share: shares[number],
            location: words::location(study, fitted, names),
            evidence: Evidence { with, without, unit: units.unit.1 },
            alternatives,
            explanation: fitted.effect.shape.meaning().to_owned(),
            compensable: calibrated.compensable(),
            sensor: calibrated.sensor().map(|sensor| study.sensors[sensor].clone()),
            calibrated,
        });
    }
    diagnosis.findings.sort_by(|a, b| b.share.total_cmp(&a.share));
    diagnosis.settings = joined(std::mem::take(&mut diagnosis.settings));
}

/// The part of each effect in what all effects of the machine do together to the data that were held out (to all data, where
/// none were): its product with the sum over the square of the sum, zeros of channels left free.
fn shares(study: &Study<'_>, found: &Found, units: &Units) -> Vec<f64> {
    let model = &found.fit.model;
    let whole = units.held_out(study, model);
    let difference = |number: usize| -> Vec<f64> {
        if model[number].effect.motion().is_none() {
            return Vec::new();
        }
        let mut without = model.clone();
        without.remove(number);
        units.held_out(study, &without).iter().zip(&whole).map(|(without, whole)| without - whole).collect()
    };
    let signals: Vec<Vec<f64>> = (0..model.len()).map(difference).collect();
    let sum: Vec<f64> =
        (0..whole.len()).map(|at| signals.iter().filter_map(|signal| signal.get(at)).sum()).collect();
    let product = |signal: &[f64]| signal.iter().zip(&sum).map(|(a, b)| a * b).sum::<f64>();
    let square = product(&sum).max(f64::MIN_POSITIVE);
    signals.iter().map(|signal| (product(signal) / square).clamp(0.0, 1.0)).collect()
}

fn held_rms(residual: &Residual) -> f64 {
    residual.holdout_rms.unwrap_or(residual.rms)
}

/// At most four other names, each once.
fn told(study: &Study<'_>, effect: &Effect, names: &[Effect]) -> Vec<Alternative> {
    let mut told: Vec<Alternative> = Vec::new();
    for name in names {
        let motion =
            name.motion().map_or("instrument", |motion| study.equations.motions[motion].name.as_str());
        let term = name.shape.name();
        let own =
            effect.motion().map_or("instrument", |motion| study.equations.motions[motion].name.as_str());
        let known = told.iter().any(|known| known.motion == motion && known.term == term);
        if told.len() < NAMES && !known && (own, effect.shape.name()) != (motion, term) {
            let separate_by = alternatives::separate_by(study, effect, name);
            told.push(Alternative { motion: motion.to_owned(), term, separate_by });
        }
    }
    told
}

/// A setting of an instrument, where the data demand it: it is far from zero.
fn setting(found: &Found, number: usize, alternatives: Vec<Alternative>) -> Option<SettingFinding> {
    let fitted = &found.fit.model[number];
    let (crate::model::Place::Instrument { recording }, Shape::Instrument(setting)) =
        (fitted.effect.place, &fitted.effect.shape)
    else {
        return None;
    };
    let (value, variance) = (*fitted.coefficients.first()?, found.fit.covariances[number][(0, 0)]);
    let half = WIDTH_95 * variance.max(0.0).sqrt();
    if value.abs() < DEMANDED * half / WIDTH_95 {
        return None;
    }
    let estimate = |value: f64, ends: (f64, f64), unit: &str| crate::diagnosis::Estimate {
        value,
        ci95: ends,
        unit: unit.to_owned(),
    };
    let plain = |unit: &str| estimate(value, (value - half, value + half), unit);
    let parameter = match setting {
        Setting::Offset { .. } | Setting::RunOffset { .. } => return None,
        Setting::Eccentricity { direction } => Parameter::fitted(["x", "y", "z"][*direction], plain("mm")),
        Setting::Radius => Parameter::fitted("offset", plain("mm")),
        Setting::Clock => Parameter::fitted("offset", plain("s")),
        Setting::Cosine => {
            let angle = |half_square: f64| (2.0 * half_square.max(0.0)).sqrt();
            let ends = (angle(value - half), angle(value + half));
            Parameter::fitted("angle", estimate(angle(value), ends, "rad"))
        }
    };
    Some(SettingFinding { recording, term: setting.name(), parameters: vec![parameter], alternatives })
}

/// A setting of an instrument is told from this many standard deviations on.
const DEMANDED: f64 = 4.0;

/// The directions of one eccentricity, brought together.
fn joined(settings: Vec<SettingFinding>) -> Vec<SettingFinding> {
    let mut joined: Vec<SettingFinding> = Vec::new();
    for setting in settings {
        match joined
            .iter_mut()
            .find(|known| known.term == setting.term && known.recording == setting.recording)
        {
            Some(known) => known.parameters.extend(setting.parameters),
            None => joined.push(setting),
        }
    }
    joined
}

fn unexplained(study: &Study<'_>, found: &Found, feature: &Feature, units: &Units) -> Unexplained {
    let channel = &study.scenes[feature.scene].channels[feature.channel];
    let axis = &study.equations.axes[feature.axis];
    let (factor, unit) = axis_unit(study, feature.axis);
    let (from, to) = (feature.from * factor, feature.to * factor);
    let which = match feature.direction {
        d if d > 0.0 => "while it moves forward",
        d if d < 0.0 => "while it moves backward",
        _ => "in both directions of motion",
    };
    let table_of = engine::table_motion(study, found, feature)
        .map(|motion| study.equations.motions[motion].name.clone());
    Unexplained {
        link: Some(axis.letter.clone()),
        direction: channel.name.clone(),
        state: "position",
        interval: Some(Interval { of: IntervalOf::Axis(axis.letter.clone()), from, to, unit }),
        rms: feature.rms * units.unit.0,
        unit: units.unit.1,
        detail: format!(
            "comes back in every pass of {} from {from:.1} to {to:.1} {unit}, {which}; no term of the vocabulary has this form",
            axis.letter
        ),
        table_of,
    }
}

fn summary(scene: &Scene<'_>) -> Summary {
    let recording = scene.recording;
    let (mut samples, mut missing, mut outliers) = (0, 0, 0);
    for channel in &scene.channels {
        for (value, outlier) in channel.values.iter().zip(&channel.outliers) {
            match (value.is_finite(), outlier) {
                (false, _) => missing += 1,
                (true, true) => outliers += 1,
                (true, false) => samples += 1,
            }
        }
    }
    Summary {
        file: recording.file.clone(),
        title: recording.title.clone(),
        instrument: instrument(&recording.instrument),
        rows: scene.rows(),
        samples,
        missing,
        outliers,
        runs: scene.run_numbers().len(),
        held_out: held_out(scene),
    }
}

fn instrument(instrument: &Instrument) -> &'static str {
    match instrument {
        Instrument::Position => "position",
        Instrument::Ballbar { .. } => "ballbar",
        Instrument::Linear(_) => "linear",
        Instrument::Straightness(_) => "straightness",
        Instrument::Angular { .. } => "angular",
        Instrument::Probe => "probe",
    }
}

fn held_out(scene: &Scene<'_>) -> String {
    let held = scene.blocks.iter().filter(|block| block.held_out).count();
    match &scene.recording.holdout {
        _ if held == scene.blocks.len() => "all of it".to_owned(),
        Some(runs) => {
            let numbers: Vec<String> = runs.iter().map(ToString::to_string).collect();
            format!("run {}", numbers.join(", "))
        }
        None => format!("{held} of {} blocks of time", scene.blocks.len()),
    }
}
