//! Readings where they belong on the machine. In: a file, its set-up and the machine. Out: readings over positions of the axis, in
//! mm and rad and in the sense of the error motion, forward and reverse.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::quantity::{Dimension, Unit};
use model_dsl::source::Span;

use super::measured::{Measured, Sense};
use super::sense;
use super::setup::{Begin, Measurement, as_dimension};
use super::view::View;

/// The readings of one measurement, by position.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// The positions of the targets on the axis, ascending: mm or rad.
    pub(super) positions: Vec<f64>,
    /// The runs.
    pub(super) runs: Vec<Way>,
}

/// One run along the axis.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// Whether the axis moved in its positive direction.
    pub(super) forward: bool,
    /// The readings: the number of the position, and the deviation in mm or rad.
    pub(super) readings: Vec<(usize, f64)>,
}

impl Placed {
    /// Places the readings of a file. Findings stand at places of the set-up; warnings of runs at those of the file.
    pub(super) fn new(
        measured: &Measured,
        one: &Measurement,
        view: &View<'_>,
        (in_setup, in_data): (&mut Diagnostics, &mut Diagnostics),
    ) -> Option<Self> {
        let at = one.data.span;
        let (axis, motion) = (view.axis_dimension(one.axis), view.motion_dimension(one.motion.value));
        let target_unit = the_unit("targets", one.targets.unit, measured.target_unit, axis, at, in_setup);
        let unit = the_unit(
            "deviations",
            one.deviations.unit.map(|unit| unit.value),
            measured.deviation_unit,
            motion,
            at,
            in_setup,
        );
        let senses = sense::senses(measured, one.runs, at, (in_setup, in_data));
        let (target_unit, unit, senses) = (target_unit?, unit?, senses?);
        let factor = view.sense(one, in_setup)?;
        let targets: Vec<f64> =
            measured.targets.iter().map(|target| target_unit.to_internal(*target)).collect();
        let positions = on_axis(&targets, one);
        let order = ascending(&positions);
        let rank = ranks(&order);
        let runs = measured.runs.iter().zip(senses).filter_map(|(run, sense)| {
            let sense = if one.targets.against { sense?.turned() } else { sense? };
            let readings = run.readings.iter().filter_map(|reading| {
                Some((*rank.get(reading.target)?, factor * unit.to_internal(reading.deviation)))
            });
            Some(Way { forward: sense == Sense::Ascending, readings: readings.collect() })
        });
        let runs = runs.collect();
        let positions = order.iter().filter_map(|target| positions.get(*target).copied()).collect();
        let placed = Self { positions, runs };
        placed.check(at, in_setup)?;
        Some(placed)
    }

    /// Reports targets that a table cannot hold: beyond all numbers (E0926), or nearer to each other than its digits (E0928).
    fn check(&self, at: Span, diagnostics: &mut Diagnostics) -> Option<()> {
        let finite = self.positions.iter().all(|position| position.is_finite());
        let apart = self.positions.windows(2).all(|pair| pair.first() < pair.last());
        let mistake = match (finite, apart) {
            (true, true) => return Some(()),
            (false, _) => {
                Diagnostic::error("E0926", at, "the targets of the file are out of the range of numbers")
            }
            _ => Diagnostic::error("E0928", at, "two targets of the file are at the same place of the axis"),
        };
        diagnostics.push(mistake.help("check their unit"));
        None
    }
}

/// The place of each target in an order.
fn ranks(order: &[usize]) -> Vec<usize> {
    let mut ranks = vec![0; order.len()];
    for (place, target) in order.iter().enumerate() {
        if let Some(slot) = ranks.get_mut(*target) {
            *slot = place;
        }
    }
    ranks
}

/// The one unit that file or set-up gives; both may give the same.
fn the_unit(
    what: &str,
    in_setup: Option<Unit>,
    in_file: Option<Unit>,
    dimension: Dimension,
    at: Span,
    diagnostics: &mut Diagnostics,
) -> Option<Unit> {
    // Nobody gives the targets of a rotary axis in millionths of a radian.
    let of_rotary_axis = dimension == Dimension::ANGLE && what == "targets";
    let usual = if of_rotary_axis { "deg".to_owned() } else { dimension.usual_unit() };
    let [in_setup, in_file] = [in_setup, in_file].map(|unit| unit.map(|unit| as_dimension(unit, dimension)));
    let mistake = match (in_setup, in_file) {
        (None, None) => {
            let message = format!("neither the file nor the set-up gives the unit of the {what}");
            Diagnostic::error("E0909", at, message)
                .help(format!("add `{what}: {{unit: {usual}}}` if that is the unit"))
        }
        (Some(own), Some(file)) if own != file => {
            let message = format!("the set-up and the file give different units for the {what}");
            Diagnostic::error("E0909", at, message)
                .help(format!("remove `unit` from `{what}`, or correct the file"))
        }
        (own, file) => match own.or(file).filter(|unit| unit.dimension == dimension) {
            Some(unit) => return Some(unit),
            None => {
                let message = format!("the {what} of the file are not in a unit of {}", dimension.name());
                let help = format!(
                    "use a unit such as `{usual}`, and check whether this is the file of another motion"
                );
                Diagnostic::error("E0908", at, message).help(help)
            }
        },
    };
    diagnostics.push(mistake);
    None
}

/// The targets as positions of the axis, in the file's order.
fn on_axis(targets: &[f64], one: &Measurement) -> Vec<f64> {
    let sign = if one.targets.against { -1.0 } else { 1.0 };
    let counted: Vec<f64> = targets.iter().map(|target| sign * target).collect();
    let origin = match one.targets.begin {
        Begin::Origin(origin) => origin,
        Begin::MostNegative(least) => least - counted.iter().copied().fold(f64::INFINITY, f64::min),
    };
    counted.iter().map(|target| tidy(origin + target)).collect()
}

/// The numbers of the positions, in ascending order of these.
fn ascending(positions: &[f64]) -> Vec<usize> {
    let at = |index: usize| positions.get(index).copied().unwrap_or(f64::NAN);
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by(|one, other| at(*one).total_cmp(&at(*other)));
    order
}

/// A position or deviation without the last bits of its arithmetic: to 1e-9 mm or rad, far below what any instrument tells.
pub(super) fn tidy(value: f64) -> f64 {
    const STEPS: f64 = 1e9;
    let rounded = (value * STEPS).round() / STEPS;
    // Minus zero is no value of its own.
    if rounded.is_finite() { rounded + 0.0 } else { value }
}
