//! From readings to an error motion. In: the readings of a measurement, by position. Out: the curve that stands in the
//! calibration, and what was taken off it, what the directions differ by, and what else a reader should know.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::Span;

use super::curve::{Averaged, Curve};
use super::lever::Levers;
use super::line::Line;
use super::placed::{Placed, tidy};
use super::setup::{Form, Measurement, Remove};
use super::uncertainty::{Uncertainty, count, mean};

/// What one file shows of its motion.
#[derive(Clone, Debug)]
pub struct Reduced {
    /// The means over the runs, without the line that was removed.
    pub curve: Curve,
    /// What was removed.
    pub line: Option<Line>,
    /// The difference of the directions, where both were read.
    pub reversal: Option<Reversal>,
    /// How many runs went forward, and how many back.
    pub runs: [usize; 2],
    /// Targets that one of the directions lacks: they are not in the curve.
    pub left_out: Vec<f64>,
    /// What lever arms did, where the set-up says where it was measured.
    pub levers: Option<Levers>,
}

/// What the directions differ by: forward minus reverse, mm or rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reversal {
    /// The mean over the targets.
    pub mean: f64,
    /// The uncertainty of that mean, from the scatter of whole runs.
    pub uncertainty: Option<Uncertainty>,
    /// The one that is greatest in size.
    pub greatest: f64,
    /// Where that is.
    pub at: f64,
}

impl Reduced {
    /// Averages, and removes what is to be removed. E0917 where there is too little for that.
    pub(super) fn new(placed: &Placed, one: &Measurement, diagnostics: &mut Diagnostics) -> Option<Self> {
        let averaged = Averaged::new(placed);
        let found = averaged.curve.positions.len();
        // Of two targets on an edge of a square the slope is all that can be had.
        let slope_alone = one.remove == Remove::Line && one.reference.is_some() && found == 2;
        let needed = if one.remove == Remove::Line && !slope_alone { 3 } else { 2 };
        if found < needed {
            diagnostics.push(too_few(found, needed, &averaged, one.data.span));
            return None;
        }
        let line = Line::of(&averaged, one.remove);
        let straight = match line {
            Some(line) => averaged.curve.plus(|position| -line.at(position)),
            None => averaged.curve.clone(),
        };
        let side = |forward: bool| placed.runs.iter().filter(|run| run.forward == forward).count();
        Some(Self {
            curve: zeroed(straight, one, diagnostics)?,
            line,
            reversal: Reversal::of(&averaged),
            runs: [side(true), side(false)],
            left_out: averaged.left_out,
            levers: None,
        })
    }
}

/// Whether a curve is the rest of a line through two targets, which is nothing.
pub(super) fn is_of_two(curve: &Curve, one: &Measurement) -> bool {
    curve.positions.len() == 2 && one.remove == Remove::Line
}

/// Tells that the slope is all that is known (W0905).
pub(super) fn slope_of_two(one: &Measurement) -> Diagnostic {
    let message = "two targets give the slope of this edge but no straightness, so the motion gets no table";
    let help = "measure three or more targets to get the straightness and the uncertainty of the slope";
    Diagnostic::warning("W0905", one.data.span, message).help(help)
}

fn too_few(found: usize, needed: usize, averaged: &Averaged, span: Span) -> Diagnostic {
    let message =
        format!("{found} targets have readings from every side that was driven, but {needed} are needed");
    let help = match averaged.left_out.is_empty() {
        true => "measure more targets for a curve",
        false => "give the readings at one place the same target, the nominal position",
    };
    Diagnostic::error("E0917", span, message).help(help)
}

/// The curve moved so that it is zero where the set-up wants it.
fn zeroed(curve: Curve, one: &Measurement, diagnostics: &mut Diagnostics) -> Option<Curve> {
    let Some((zero, span)) = one.deviations.zero_at else { return Some(curve) };
    match interpolated(&curve.positions, &curve.centre(), zero) {
        Some(value) => Some(curve.plus(|_| -value)),
        None => {
            let mistake = Diagnostic::error("E0917", span, "`zero_at` is outside the measured range");
            diagnostics.push(mistake.help("give a position between the first target and the last"));
            None
        }
    }
}

/// The value of a piecewise linear curve; nothing outside of it.
fn interpolated(positions: &[f64], values: &[f64], at: f64) -> Option<f64> {
    let mut pieces = positions.windows(2).zip(values.windows(2));
    let (ends, values) = pieces.find(|(ends, _)| ends.first() <= Some(&at) && Some(&at) <= ends.last())?;
    let (left, right) = (*ends.first()?, *ends.last()?);
    let (low, high) = (*values.first()?, *values.last()?);
    let share = if right > left { (at - left) / (right - left) } else { 0.0 };
    Some(low + share * (high - low))
}

impl Reversal {
    fn of(averaged: &Averaged) -> Option<Self> {
        let curve = &averaged.curve;
        let differences = curve.differences()?;
        let greater = |one: &(&f64, &f64), other: &(&f64, &f64)| one.0.abs().total_cmp(&other.0.abs());
        let (greatest, at) = differences.iter().zip(&curve.positions).max_by(greater)?;
        let share = 1.0 / count(differences.len());
        Some(Self {
            mean: mean(&differences),
            uncertainty: averaged.scatter_of_difference(&vec![share; differences.len()]),
            greatest: *greatest,
            at: *at,
        })
    }
}

/// The curve as a table has it: values over nodes, and a backlash beside them where that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    /// The nodes, ascending.
    pub nodes: Vec<f64>,
    /// The values in both directions, or while the axis moves forward.
    pub forward: Vec<f64>,
    /// The values while it moves back, where they have a table of their own.
    pub reverse: Option<Vec<f64>>,
    /// The lost motion beside a table of means: reverse minus forward.
    pub lost_motion: Option<f64>,
    /// The most that smoothing moved a value by.
    pub smoothed: Option<f64>,
    /// The most that the resampled table departs from the means at the targets.
    pub resampled: Option<f64>,
}

impl Tabulated {
    /// Reports a step that is too small for the range (E0907), and numbers beyond all numbers (E0926).
    pub(super) fn check(&self, one: &Measurement, diagnostics: &mut Diagnostics) -> Option<()> {
        let (first, last) = ends(&self.nodes);
        if let Some(step) = one.resample.filter(|step| (last - first) / step.value > MOST_NODES) {
            let message = format!("the table would have more than {MOST_NODES} nodes");
            let mistake = Diagnostic::error("E0907", step.span, message);
            diagnostics.push(mistake.help("write a larger step; no machine needs so many nodes"));
            return None;
        }
        let reverse = self.reverse.iter().flatten();
        let mut values = self.nodes.iter().chain(&self.forward).chain(reverse).chain(&self.lost_motion);
        if values.all(|value| value.is_finite()) {
            return Some(());
        }
        let message = "the deviations of the file are out of the range of numbers";
        let mistake = Diagnostic::error("E0926", one.data.span, message);
        diagnostics.push(mistake.help("check its units"));
        None
    }

    /// The table of a curve, smoothed and resampled only where the set-up asks for it.
    pub(super) fn of(curve: &Curve, one: &Measurement, reversal: Option<f64>) -> Self {
        let values = |side: &Option<Vec<super::curve::Mean>>| -> Option<Vec<f64>> {
            Some(side.as_ref()?.iter().map(|mean| mean.value).collect())
        };
        let both = one.reversal == Form::Tables && curve.forward.is_some() && curve.reverse.is_some();
        let (forward, reverse) = match both {
            true => (values(&curve.forward).unwrap_or_default(), values(&curve.reverse)),
            false => (curve.centre(), None),
        };
        let lost_motion = reversal.filter(|_| one.reversal == Form::Backlash).map(|mean| tidy(-mean));
        let mut table = Self {
            nodes: curve.positions.clone(),
            forward,
            reverse,
            lost_motion,
            smoothed: None,
            resampled: None,
        };
        if let Some(width) = one.smooth {
            table.smooth(width);
        }
        if let Some(step) = one.resample {
            table.resample(step.value);
        }
        table.each(|values| values.iter_mut().for_each(|value| *value = tidy(*value)));
        table
    }

    fn each(&mut self, mut change: impl FnMut(&mut Vec<f64>)) {
        change(&mut self.forward);
        if let Some(reverse) = &mut self.reverse {
            change(reverse);
        }
    }

    fn smooth(&mut self, width: usize) {
        let mut most = 0.0_f64;
        self.each(|values| {
            let smooth = moving_mean(values, width);
            most = smooth.iter().zip(values.iter()).map(|(new, old)| (new - old).abs()).fold(most, f64::max);
            *values = smooth;
        });
        self.smoothed = Some(most);
    }

    fn resample(&mut self, step: f64) {
        let old = self.nodes.clone();
        let new = stepped(&old, step);
        let mut most = 0.0_f64;
        self.each(|values| {
            let there = |positions: &[f64], values: &[f64], at: f64| {
                interpolated(positions, values, at).unwrap_or(f64::NAN)
            };
            let resampled: Vec<f64> = new.iter().map(|node| there(&old, values, *node)).collect();
            let departs =
                old.iter().zip(values.iter()).map(|(at, value)| (there(&new, &resampled, *at) - value).abs());
            most = departs.fold(most, f64::max);
            *values = resampled;
        });
        self.nodes = new;
        self.resampled = Some(most);
    }
}

/// The moving mean over an odd number of values; towards the ends over fewer, so that it stays in the middle of them.
fn moving_mean(values: &[f64], width: usize) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let around = |place: usize| {
        let half = (width / 2).min(place).min(last - place);
        mean(values.get(place - half..=place + half).unwrap_or(&[]))
    };
    (0..values.len()).map(around).collect()
}

/// More nodes than this make no table.
const MOST_NODES: f64 = 10_000.0;

/// Nodes in equal steps over the whole range, the last of them at its end.
fn stepped(positions: &[f64], step: f64) -> Vec<f64> {
    let (first, last) = ends(positions);
    let steps = std::iter::successors(Some(0.0), |number| (*number < MOST_NODES).then_some(number + 1.0));
    let steps = steps.map(|number| tidy(first + number * step));
    steps.take_while(|node| *node < last - 1e-6 * step).chain([last]).collect()
}

fn ends(positions: &[f64]) -> (f64, f64) {
    let at = |end: Option<&f64>| end.copied().unwrap_or(f64::NAN);
    (at(positions.first()), at(positions.last()))
}
