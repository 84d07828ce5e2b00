//! Where the values of a table stand. In: what the calibration's terms over an axis are, and the range. Out: nodes at which
//! straight lines between them say the same, or say it closely.

use std::f64::consts::TAU;

use model_dsl::calibration::vocabulary::Form;
use model_dsl::calibration::{CalibratedTerm, Calibration, Factor, Part};
use model_dsl::equations::Equations;

use super::refused::Refused;

/// Intervals over an axis on which something is curved, where the user does not say how many.
const CURVED: usize = 100;

/// Nodes closer than this are one: mm or rad.
const SAME: f64 = 1e-9;

/// Positions are written with six decimals.
const DECIMALS: f64 = 1e6;

/// Whether the nodes of a rotary axis are those of one whole turn, after which a table of it repeats.
pub(super) fn is_a_turn(nodes: &[f64]) -> bool {
    let ends = nodes.first().zip(nodes.last());
    ends.is_some_and(|(first, last)| (last - first - TAU).abs() < SAME)
}

/// Where a table is to have its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spacing {
    /// The number that the user asks for, evenly spaced.
    pub points: Option<usize>,
    /// The most that the controller takes.
    pub most: usize,
}

/// The nodes of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Nodes {
    /// The nodes of the calibration's tables, and the ends of the range.
    own: Vec<f64>,
    /// Whether anything over the axis is curved between them.
    curved: bool,
    range: [f64; 2],
    letter: String,
    /// What a file writes for one mm or rad: 1, or the degrees of a radian.
    unit: f64,
}

impl Nodes {
    /// What is known of an axis.
    pub fn new(equations: &Equations, calibration: &Calibration, axis: usize, range: [f64; 2]) -> Self {
        let terms = calibration.motions.iter().flat_map(|motion| &motion.terms).map(|term| &term.value);
        let info = equations.axes.get(axis);
        let mut own: Vec<f64> = terms.clone().flat_map(|term| term.nodes(axis)).chain(range).collect();
        own.retain(|place| (range[0]..=range[1]).contains(place));
        own.sort_by(f64::total_cmp);
        own.dedup_by(|next, place| *next - *place < SAME);
        let curved = info.is_some_and(|info| info.rotary) || terms.clone().any(|term| is_curved(term, axis));
        let rotary = info.is_some_and(|info| info.rotary);
        let letter = info.map_or_else(String::new, |info| info.letter.clone());
        Self { own, curved, range, letter, unit: if rotary { 1_f64.to_degrees() } else { 1.0 } }
    }

    /// The nodes of the calibration's tables, and the ends of the range.
    pub(super) fn own(&self) -> &[f64] {
        &self.own
    }

    /// The nodes of an axis on which something is curved that no term tells: an angle times a lever arm that grows with the
    /// same position.
    #[must_use]
    pub(super) fn curved(self, curved: bool) -> Self {
        Self { curved: self.curved || curved, ..self }
    }

    /// Nodes at any places.
    ///
    /// # Errors
    /// Where the controller takes fewer.
    pub fn at_any_places(&self, spacing: Spacing) -> Result<Vec<f64>, Refused> {
        let nodes = match spacing.points {
            Some(points) => {
                self.check_count(points, spacing)?;
                self.spread(intervals(points, &self.letter)?)
            }
            None if self.curved => {
                let mut nodes = self.own.clone();
                nodes.extend(self.spread(CURVED.min(spacing.most.saturating_sub(nodes.len() + 1).max(1))));
                nodes.sort_by(f64::total_cmp);
                nodes.dedup_by(|next, place| *next - *place < SAME);
                nodes
            }
            None => self.own.clone(),
        };
        self.few_enough(nodes, spacing)
    }

    /// Nodes at equal steps, the step having no more decimals than are written.
    ///
    /// # Errors
    /// Where the controller takes fewer, or no such step divides the range.
    pub fn at_equal_steps(&self, spacing: Spacing) -> Result<Vec<f64>, Refused> {
        let intervals = match spacing.points {
            Some(points) => intervals(points, &self.letter)?,
            None => self.own_intervals().or_else(|| self.round_intervals()).unwrap_or(CURVED),
        };
        self.check_count(intervals.saturating_add(1), spacing)?;
        let [low, high] = self.range;
        if !self.is_round((high - low) / count(intervals)) {
            let help = "give another number of points with --points, or rounder ends with --range";
            let what = format!(
                "{} points over {} give a step with more than six decimals",
                intervals + 1,
                self.letter
            );
            return Err(Refused::new(what, help));
        }
        Ok(self.spread(intervals))
    }

    /// Nodes at equal steps of any length, for a mesh whose ends and count are told: those of the calibration, but no more than the
    /// controller takes.
    ///
    /// # Errors
    /// More points asked for than the controller takes, or fewer than two.
    pub fn spread_evenly(&self, spacing: Spacing) -> Result<Vec<f64>, Refused> {
        let intervals = match spacing.points {
            Some(points) => intervals(points, &self.letter)?,
            None => self.at_most(spacing.most.saturating_sub(1).max(1)),
        };
        self.check_count(intervals.saturating_add(1), spacing)?;
        Ok(self.spread(intervals))
    }

    /// The number of equal steps on which all own nodes lie, finer where something is curved, but not more than a bound: so that the
    /// own nodes stay among them if they can.
    fn at_most(&self, most: usize) -> usize {
        let Some(own) = self.even_intervals().filter(|own| *own <= most) else { return most.min(CURVED) };
        let finer = if self.curved { CURVED.div_ceil(own).min(most / own) } else { 1 };
        own * finer
    }

    /// The number of equal steps on which all own nodes lie; finer where something is curved.
    fn own_intervals(&self) -> Option<usize> {
        let number = self.even_intervals()?;
        let finer = if self.curved { CURVED.div_ceil(number) } else { 1 };
        // A step of degrees is round only for some numbers of intervals: 180 deg in 108, not in 102.
        let [low, high] = self.range;
        let is_round = |finer: &usize| self.is_round((high - low) / count(number * finer));
        Some(number * (finer..=2 * finer).find(is_round).unwrap_or(finer))
    }

    /// The number of equal steps on which all own nodes lie.
    fn even_intervals(&self) -> Option<usize> {
        let [low, high] = self.range;
        let step = self.own.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let whole = |length: f64| ((length / step).round() * step - length).abs() < 1e-6;
        let even =
            self.is_round(step) && whole(high - low) && self.own.iter().all(|place| whole(place - low));
        let number = (1..=1_000_000).find(|number| count(*number) * step > high - low - 0.5 * step)?;
        even.then_some(number)
    }

    /// The least number of intervals from the usual one on whose step is round.
    fn round_intervals(&self) -> Option<usize> {
        let [low, high] = self.range;
        (CURVED..=2 * CURVED).find(|number| self.is_round((high - low) / count(*number)))
    }

    /// The range in equal intervals, its ends exact.
    fn spread(&self, intervals: usize) -> Vec<f64> {
        let [low, high] = self.range;
        let share = |number: usize| count(number) / count(intervals);
        (0..=intervals).map(|number| low * (1.0 - share(number)) + high * share(number)).collect()
    }

    /// Whether a step has no more decimals than are written, apart from its last bits.
    fn is_round(&self, step: f64) -> bool {
        let scaled = step * self.unit * DECIMALS;
        (scaled - scaled.round()).abs() < 1e-4
    }

    fn few_enough(&self, nodes: Vec<f64>, spacing: Spacing) -> Result<Vec<f64>, Refused> {
        self.check_count(nodes.len(), spacing)?;
        Ok(nodes)
    }

    fn check_count(&self, count: usize, spacing: Spacing) -> Result<(), Refused> {
        if count <= spacing.most {
            return Ok(());
        }
        let what = format!(
            "the table of {} would have {count} points, but the controller takes {}",
            self.letter, spacing.most
        );
        let help = format!("use fewer points, --points {}, and check the loss in the report", spacing.most);
        Err(Refused::new(what, help))
    }
}

fn intervals(points: usize, letter: &str) -> Result<usize, Refused> {
    if points >= 2 {
        return Ok(points - 1);
    }
    Err(Refused::new(format!("a table of {letter} needs at least two points"), "give --points 2 or more"))
}

/// A count as a number; exact, since none comes near 2^32.
fn count(number: usize) -> f64 {
    f64::from(u32::try_from(number).unwrap_or(u32::MAX))
}

/// Whether a term is no straight line over an axis, tables apart.
fn is_curved(term: &CalibratedTerm, axis: usize) -> bool {
    if !term.factors().is_empty() {
        return is_curved_with_factors(term, axis);
    }
    let (kind, entry) = (term.kind(), term.kind().entry());
    let curved = match entry.form {
        // The last of them belongs to a power above 1.
        Form::Powers { .. } => match term.part("coefficients") {
            Some(Part::Numbers(coefficients)) => kind.first_power() + coefficients.len() > 2,
            _ => false,
        },
        Form::Plain => entry.state.is_position(),
        Form::Curve => false,
    };
    curved && term.axis() == Some(axis)
}

/// The same of a term with factors: what is linear twice is curved.
fn is_curved_with_factors(term: &CalibratedTerm, axis: usize) -> bool {
    let over = |other: Option<usize>| other == Some(axis);
    let states = term.states().filter(|(state, of)| state.is_position() && over(*of)).count();
    let bent = term.factors().iter().any(|factor| match factor {
        Factor::Position { power, .. } => over(factor.axis()) && *power > 1,
        Factor::Turn { .. } => over(factor.axis()),
        _ => false,
    });
    states > 1 || bent || is_curved(term.core(), axis)
}
