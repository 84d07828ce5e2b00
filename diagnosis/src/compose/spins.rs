//! Spins: waves whose frequency follows a recorded speed, as the unbalance of a spindle does.
//!
//! In: what was found, and the channels of which one may be a speed. Out: forms, each with the rate and the phase that explain most.
//! Such a wave has no frequency in time and no period along an axis. Over the turns, which are the speed summed up over time, it is
//! one line of a spectrum.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::contest::DECISIVE;
use crate::design::{Design, Regressor};
use crate::engine::Found;
use crate::model::{Effect, Model, Place};
use crate::study::Study;
use crate::sweep::Swept;
use crate::terms::{self, Shape};
use crate::waves::{self, Peak, Turns};
use crate::weights::Weights;

use super::forms::Form;

/// How many waves are refined for each measure: the three with the largest gain, and the three with the largest gain over the noise at
/// their own frequency. Three, because error motions with collinear lever arms each give a line.
const WAVES: usize = 3;

/// How often the rate is moved to the vertex of a parabola through three rates. The steps begin with a quarter of the width of a line
/// and become a fifth each time: after three, no phase is off by more than a hundredth of a turn over the recording.
const MOVES: i32 = 3;

/// Waves over the turns of each channel that may be a speed.
#[derive(Default)]
pub(super) struct Spins {
    pub(super) forms: Vec<Form>,
    /// How many independent ones were looked at.
    pub(super) tried: f64,
}

/// The waves that promise most.
pub(super) fn spins(study: &Study<'_>, found: &Found) -> Spins {
    let mut spins = Spins::default();
    for turns in (0..study.loads.len()).filter_map(|load| turns(study, load)) {
        let beside = (&found.fit.model, &found.appraisal.weights);
        let (peaks, tried) = waves::over_turns(study, beside, &found.travels, &turns);
        spins.tried += tried;
        // By chance, the highest of this many waves of noise gains twice the logarithm of their number.
        let chance = 2.0 * tried.max(1.0).ln();
        let wanted = |peak: &Peak| {
            peak.gain.max(peak.local) > chance + DECISIVE
                && follows_the_speed(study, &turns, &peak.effect.shape)
        };
        let peaks = promising(peaks.into_iter().filter(wanted).collect());
        spins.forms.extend(peaks.iter().filter_map(|peak| Polish::new(study, found, &turns, peak).form()));
    }
    spins
}

/// How far something has turned, from a channel that may be its speed: `loads` holds all channels that are neither positions nor
/// temperatures. A force and a current are no speeds.
fn turns(study: &Study<'_>, load: usize) -> Option<Turns> {
    if matches!(study.loads[load].1.as_str(), "N" | "A") {
        return None;
    }
    let of_scene =
        |scene: &crate::scene::Scene<'_>| terms::turned(&scene.given.time, &scene.given.loads[load]);
    let turned: Vec<Vec<f64>> = study.scenes.iter().map(of_scene).collect();
    let mut steps: Vec<f64> =
        turned.iter().flat_map(|turned| turned.windows(2).map(|pair| (pair[1] - pair[0]).abs())).collect();
    steps.retain(|step| *step > 0.0);
    steps.sort_by(f64::total_cmp);
    let step = *steps.get(steps.len() / 2)?;
    Some(Turns { load, turned, step })
}

/// Whether a wave follows the speed: somewhere its phase must differ by a quarter turn from that of a wave of constant frequency.
fn follows_the_speed(study: &Study<'_>, turns: &Turns, shape: &Shape) -> bool {
    let Some((_, rate, _)) = spin(shape) else { return false };
    let ahead = study.scenes.iter().zip(&turns.turned).map(|(scene, turned)| {
        let time = &scene.given.time;
        let ends = time.first().zip(time.last()).zip(turned.first().zip(turned.last()));
        let Some(((from, to), (first, last))) = ends else { return 0.0 };
        let mean = (last - first) / (to - from);
        let off = |(time, turned): (&f64, &f64)| (turned - first - mean * (time - from)).abs();
        time.iter().zip(turned).map(off).fold(0.0, f64::max)
    });
    rate * ahead.fold(0.0, f64::max) > 0.25
}

/// The channel, the rate and the phase of a wave over turns.
fn spin(shape: &Shape) -> Option<(usize, f64, f64)> {
    match *shape.factors() {
        [model_dsl::calibration::Factor::Spin { load, rate, phase }] => Some((load, rate, phase)),
        _ => None,
    }
}

/// The highest peaks by either measure, each once.
fn promising(mut peaks: Vec<Peak>) -> Vec<Peak> {
    let mut chosen: Vec<Peak> = Vec::new();
    for measure in [|peak: &Peak| peak.gain, |peak: &Peak| peak.local] {
        peaks.sort_by(|a, b| measure(b).total_cmp(&measure(a)));
        for peak in peaks.iter().take(WAVES) {
            if !chosen.iter().any(|known| known.effect == peak.effect) {
                chosen.push(peak.clone());
            }
        }
    }
    chosen
}

/// A wave whose rate is made exact beside what was found.
struct Polish<'p> {
    study: &'p Study<'p>,
    model: &'p Model,
    weights: Weights,
    place: Place,
    load: usize,
    rate: f64,
    /// The difference of two rates that come apart by a turn.
    width: f64,
}

impl<'p> Polish<'p> {
    fn new(study: &'p Study<'p>, found: &'p Found, turns: &Turns, peak: &Peak) -> Self {
        let all = || turns.turned.iter().flatten().copied();
        let range = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
        Self {
            study,
            model: &found.fit.model,
            // White noise: the fitted wandering noise would absorb much of the wave.
            weights: found.appraisal.weights.as_white(),
            place: peak.effect.place,
            load: turns.load,
            rate: spin(&peak.effect.shape).map_or(0.0, |(_, rate, _)| rate),
            width: 1.0 / range,
        }
    }

    /// The wave with the rate and the phase that explain most; `None` where its sine and its cosine cannot be told apart.
    fn form(mut self) -> Option<Form> {
        for finer in 0..MOVES {
            self.move_to_vertex(0.25 * self.width * 0.2_f64.powi(finer));
        }
        let (mut swept, [sine, cosine]) = self.swept(self.rate);
        if !(swept.take(sine) && swept.take(cosine)) {
            return None;
        }
        let phase = swept.coefficient(cosine).atan2(swept.coefficient(sine)).rem_euclid(TAU);
        let effect = Effect { place: self.place, shape: Shape::spin(self.load, self.rate, phase) };
        Some(Form { effect, coefficients: vec![1.0], beside: None })
    }

    /// Moves the rate to the vertex of the parabola through what it explains and what its neighbours do, by one step at most.
    fn move_to_vertex(&mut self, step: f64) {
        let [below, here, above] = [-step, 0.0, step].map(|by| self.explained(self.rate + by));
        let bend = below - 2.0 * here + above;
        let by = if bend < 0.0 { 0.5 * (below - above) / bend } else { (above - below).signum() };
        self.rate += step * by.clamp(-1.0, 1.0);
    }

    fn explained(&self, rate: f64) -> f64 {
        let (swept, wave) = self.swept(rate);
        swept.promise(&wave).0
    }

    /// The normal equations with all effects that were found swept in, and the columns of sine and cosine.
    fn swept(&self, rate: f64) -> (Swept, [usize; 2]) {
        let wave = [0.0, FRAC_PI_2]
            .map(|phase| Effect { place: self.place, shape: Shape::spin(self.load, rate, phase) });
        let found = self.model.effects.iter().map(|fitted| fitted.effect.clone());
        let regressors: Vec<Regressor> = found.chain(wave).map(Regressor::of).collect();
        let number = self.model.effects.len();
        let design = Design::new(self.study, self.model, &self.weights, regressors);
        let mut swept = Swept::new(&design.fitted().0);
        let wave = [design.first[number], design.first[number + 1]];
        for column in 0..wave[0] {
            swept.take(column);
        }
        (swept, wave)
    }
}
