//! Elements: the screw, worm, motor or line that a wave repeats with.
//!
//! In: a wave along an axis with the interval of its period, and the elements that the machine file gives the axis. Out:
//! those whose period, or a whole fraction of it, lies in the interval, where that is hardly chance. They name what was
//! found; they change nothing of it.

use std::f64::consts::TAU;

use model_dsl::machine::{Element, ElementKind};

use crate::diagnosis::{Parameter, ParameterValue, Repeats};
use crate::number;
use crate::parameters::axis_unit;
use crate::ranges::{goes_round, periods};
use crate::study::Study;
use crate::terms::Shape;
use crate::travel::Travel;

/// An element shows with its period and with a half, a third and a quarter of it: balls and teeth that are not alike, an
/// eccentric fit, the joint of a shaft. Higher harmonics are small, and each more is one more place for a chance. No element
/// here repeats in a whole multiple of its turn: the balls of a screw go round in about two turns, and not in exactly two.
const HARMONICS: u32 = 4;

/// How often a wave of another cause may bear the name of some element of its axis.
const CHANCE: f64 = 0.05;

/// Periods are as true as screws are: ISO 3408-3 allows a rolled one, of grade 7, 52 um in 300 mm. An interval that is narrower
/// says how well the wave is known, and not how well the screw is cut.
const LEAD: f64 = 52e-3 / 300.0;

/// The elements of its axis that a wave repeats with, those of which it is the lower harmonic first; nothing for other terms.
pub(crate) fn repeating(
    study: &Study<'_>,
    travels: &[Travel],
    shape: &Shape,
    parameters: &[Parameter],
) -> Vec<Repeats> {
    let Some((axis, period)) = shape.wave_along() else { return Vec::new() };
    let Some(travel) = travels.get(axis) else { return Vec::new() };
    let (factor, unit) = axis_unit(study, axis);
    let round = goes_round(study, axis, travel);
    let around = match round {
        true => between_neighbours(period),
        false => interval(parameters).map(|(low, high)| (low / factor, high / factor)).map(as_true_as_screws),
    };
    let Some(around) = around else { return Vec::new() };
    let wave = Wave { around, among: periods(study, axis, travel), round };
    let named = wave.named(&study.equations.axes[axis].elements);
    let told = |(element, harmonic): (Element, u32)| Repeats {
        element: element.kind,
        period: element.period * factor,
        unit,
        harmonic,
    };
    named.into_iter().map(told).collect()
}

/// The interval of the fitted period; nothing where the recordings say nothing about it.
fn interval(parameters: &[Parameter]) -> Option<(f64, f64)> {
    let period = parameters.iter().find(|parameter| parameter.name == "period")?;
    let ParameterValue::Fitted(estimate) = &period.value else { return None };
    let (low, high) = estimate.ci95;
    (0.0 < low && low < high && high.is_finite()).then_some((low, high))
}

fn as_true_as_screws((low, high): (f64, f64)) -> (f64, f64) {
    (low * (1.0 - LEAD), high * (1.0 + LEAD))
}

/// Of an axis that has gone round only whole parts of a turn are possible: a period is told from that of one wave more or
/// less a turn, and from nothing between.
fn between_neighbours(period: f64) -> Option<(f64, f64)> {
    let turns = (TAU / period).round();
    (turns >= 1.0).then_some((TAU / (turns + 0.5), TAU / (turns - 0.5)))
}

/// A wave that was found; mm or rad.
struct Wave {
    /// The interval of its period.
    around: (f64, f64),
    /// The shortest and the longest period that was looked for.
    among: (f64, f64),
    /// Whether its axis has gone round.
    round: bool,
}

impl Wave {
    /// The elements with the harmonic that the wave is of each.
    fn named(&self, elements: &[Element]) -> Vec<(Element, u32)> {
        let doubtful = elements.iter().filter(|element| !self.told(element)).count();
        let most = CHANCE / number(doubtful.max(1));
        let sure = |element: &&Element| self.told(element) || self.chance(element) <= most;
        let harmonic = |element: &Element| self.harmonic(element).map(|harmonic| (*element, harmonic));
        let mut named: Vec<(Element, u32)> = elements.iter().filter(sure).filter_map(harmonic).collect();
        named.sort_by_key(|(_, harmonic)| *harmonic);
        named
    }

    /// Whether that the wave comes so often in a turn of an element is what was told already, and no coincidence.
    fn told(&self, element: &Element) -> bool {
        self.round && element.kind == ElementKind::Axis
    }

    /// The lowest harmonic of an element that lies in the interval.
    fn harmonic(&self, element: &Element) -> Option<u32> {
        let (low, high) = self.around;
        let found = self.harmonics(element).find(|(_, period)| (low..=high).contains(period));
        found.map(|(harmonic, _)| harmonic)
    }

    /// The harmonics of an element that the recordings could show, with their periods.
    fn harmonics(&self, element: &Element) -> impl Iterator<Item = (u32, f64)> {
        let ((shortest, longest), period) = (self.among, element.period);
        let all = (1..=HARMONICS).map(move |harmonic| (harmonic, period / f64::from(harmonic)));
        all.filter(move |(_, period)| (shortest..=longest).contains(period))
    }

    /// The chance that a wave of another cause lies so near to a harmonic of an element. Nothing is known of its period but
    /// that it was looked for, and so its logarithm is as likely anywhere among these; an interval is as wide everywhere, counted
    /// in periods over a travel.
    fn chance(&self, element: &Element) -> f64 {
        let (low, high) = self.around;
        let (shortest, longest) = self.among;
        let width = 1.0 / low - 1.0 / high;
        let covered: f64 = self.harmonics(element).map(|(_, period)| width * period).sum();
        covered / (longest / shortest).ln().max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests;
