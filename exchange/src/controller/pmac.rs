//! Delta Tau PMAC: leadscrew and backlash compensation tables (`DEFINE COMP`, `DEFINE BLCOMP`). In: a correction taken apart. Out:
//! commands for the controller; and what such commands do.
//!
//! Facts: PMAC and Turbo PMAC software reference and user manual, "Position compensation". Entries are whole sixteenths of a
//! count of the target motor; the first is one spacing from the motor's zero, where the correction is zero; positions roll over
//! at the count length, so that what lies below zero stands at the end. A COMP value is added to the desired position; a
//! BLCOMP value, and `Ixx86` with it, is subtracted while the motor moves in its negative direction.

mod commands;

use abbe_runtime::Direction;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::source::SourceFile;

use super::effects::{Effect, Effects, LEAST};
use super::export::{Controller, File, Job, Written};
use super::geometry::Pose;
use super::lost::Target;
use super::nodes::Spacing;
use super::refused::Refused;

/// Entries are so many to a count.
const PARTS: f64 = 16.0;

/// The most entries of a table.
const MOST: usize = 10_000;

/// A step is cut into so many parts at most to bring nodes and zero together.
const FINEST: u32 = 20;

/// The leadscrew tables that a controller has: one belongs to each motor.
const TABLES: usize = 8;

/// A table that rolls over.
#[derive(Clone, Debug, Default, PartialEq)]
struct Rolling {
    /// The span, in counts of the source.
    length: f64,
    /// The entries, from one spacing on, in sixteenths of a count of the target.
    entries: Vec<i64>,
}

/// A leadscrew table.
#[derive(Clone, Debug, PartialEq)]
struct Screw {
    source: usize,
    target: usize,
    table: Rolling,
}

/// A motor, by axis.
#[derive(Clone, Debug)]
struct Motor {
    /// Its number.
    number: String,
    /// Its counts for a mm; none for a rotary axis, which has no table.
    counts: Option<f64>,
    /// Its backlash table.
    backlash: Option<Rolling>,
    /// `Ixx86`, in sixteenths of a count.
    constant: f64,
}

/// A controller with its tables.
#[derive(Debug)]
pub(super) struct Pmac {
    motors: Vec<Motor>,
    screws: Vec<Screw>,
}

/// The controller without compensation.
///
/// # Errors
/// Where the counts of a motor are not said.
pub(super) fn controller(job: &Job<'_, '_>) -> Result<Pmac, Refused> {
    let axes = job.geometry.equations.axes.iter().enumerate();
    let motor = |(place, axis): (usize, &model_dsl::equations::AxisInfo)| {
        let counts =
            job.options.counts.iter().find(|(letter, _)| *letter == axis.letter).map(|(_, counts)| *counts);
        if !axis.rotary && counts.is_none() {
            let help = format!("give the counts for a mm: --counts {}=10000", axis.letter);
            return Err(Refused::new(format!("how many counts {} has is not known", axis.letter), help));
        }
        let number =
            job.options.name(&axis.letter).map_or_else(|| (place + 1).to_string(), ToOwned::to_owned);
        Ok(Motor { number, counts: counts.filter(|_| !axis.rotary), backlash: None, constant: 0.0 })
    };
    Ok(Pmac { motors: axes.map(motor).collect::<Result<_, _>>()?, screws: Vec::new() })
}

impl Controller for Pmac {
    fn load(&mut self, source: &SourceFile, _axis: Option<usize>, diagnostics: &mut Diagnostics) {
        commands::load(self, source, diagnostics);
    }

    fn target(&self) -> &dyn Target {
        self
    }
}

impl Rolling {
    /// The value at a position in counts, in sixteenths of a count.
    fn value(&self, position: f64) -> f64 {
        let count = self.entries.len();
        let Some(spacing) =
            u32::try_from(count).ok().filter(|count| *count > 0).map(|count| self.length / f64::from(count))
        else {
            return 0.0;
        };
        let place = position.rem_euclid(self.length) / spacing;
        let whole = place.floor();
        // Entry k is k + 1 spacings from zero; the last is zero itself.
        let entry = |number: usize| {
            self.entries.get((number + count - 1) % count).copied().map_or(0.0, commands::number)
        };
        let number = commands::index(whole);
        entry(number) + (entry(number + 1) - entry(number)) * (place - whole)
    }
}

impl Target for Pmac {
    fn correction(&self, pose: &Pose) -> Result<Vec<f64>, Refused> {
        let mut correction = vec![0.0; pose.position.len()];
        let counts = |axis: usize| self.motors.get(axis).and_then(|motor| motor.counts);
        let place =
            |axis: usize| pose.position.get(axis).zip(counts(axis)).map(|(place, counts)| place * counts);
        let mut add = |axis: usize, parts: f64| {
            if let Some((slot, counts)) = correction.get_mut(axis).zip(counts(axis)) {
                *slot += parts / PARTS / counts;
            }
        };
        for screw in &self.screws {
            add(screw.target, place(screw.source).map_or(0.0, |place| screw.table.value(place)));
        }
        for (axis, motor) in self.motors.iter().enumerate() {
            if pose.direction.get(axis) == Some(&Direction::Negative) {
                let table =
                    motor.backlash.as_ref().zip(place(axis)).map_or(0.0, |(table, place)| table.value(place));
                add(axis, -(table + motor.constant));
            }
        }
        Ok(correction)
    }
}

/// One file of commands.
pub(super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let pmac = controller(job)?;
    let effects = Effects::new(job.geometry, job.space)?;
    let (mut all, mut backlash) = (Vec::new(), Vec::new());
    for (source, range) in job.space.ranges.iter().enumerate() {
        if pmac.motors.get(source).is_none_or(|motor| motor.counts.is_none()) {
            continue;
        }
        let nodes = rolling_nodes(job, &effects, source, *range)?;
        for effect in effects.of(source, &nodes)? {
            let own = effect.target == source;
            if own && effect.directed() > 0.0 {
                backlash.push(effect.clone());
            }
            if effect.largest() >= LEAST {
                all.push(effect);
            }
        }
    }
    all.sort_by(|one, other| other.largest().total_cmp(&one.largest()));
    let (kept, rest) = all.split_at(all.len().min(TABLES));
    let mut written = Written::default();
    if let Some(largest) = rest.first() {
        written.left_out.push(format!(
            "{} tables, the largest of {:.1} um: a controller has {TABLES}, one for each motor",
            rest.len(),
            largest.largest() * 1000.0
        ));
    }
    let text = commands::text(&pmac, kept, &backlash)?;
    let about = format!("{} leadscrew and {} backlash tables", kept.len(), backlash.len());
    written.files.push(File { name: "compensation.pmc".to_owned(), axis: None, text, about });
    written.loading = vec![
        "a motor's zero is the calibration's: home it there, or set its home offset so".to_owned(),
        "Ixx85 = 0 and no other buffers (I6, GATHER, ROTARY) while the tables are defined; I51 = 1 switches them on".to_owned(),
    ];
    Ok(written)
}

/// Nodes at multiples of one step, zero among them, that cover the range: the control counts spacings from zero.
fn rolling_nodes(
    job: &Job<'_, '_>,
    effects: &Effects<'_, '_>,
    axis: usize,
    [low, high]: [f64; 2],
) -> Result<Vec<f64>, Refused> {
    let letter = job.geometry.equations.axes.get(axis).map_or("", |info| info.letter.as_str());
    if !(low..=high).contains(&0.0) {
        let help =
            format!("extend it with --range {letter}=..., or move the calibration's zero to the motor's");
        return Err(Refused::new(
            format!("the range of {letter} leaves out zero, where a table begins"),
            help,
        ));
    }
    let even = effects.nodes(axis)?.at_equal_steps(Spacing { points: job.options.points, most: MOST })?;
    let step = even.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let step = if job.options.points.is_some() { step } else { counted_from_zero(step, &even) };
    let whole = |place: f64| commands::index((place / step - 1e-9).ceil().max(0.0));
    let (below, above) = (whole(-low), whole(high));
    let at = |number: usize| f64::from(u32::try_from(number).unwrap_or(u32::MAX)) * step;
    Ok((1..=below).rev().map(|number| -at(number)).chain((0..=above).map(at)).collect())
}

/// A step that divides this one and on whose multiples all nodes lie, where one of a few does; else a fine one.
fn counted_from_zero(step: f64, nodes: &[f64]) -> f64 {
    let lies = |step: f64| nodes.iter().all(|place| ((place / step).round() * step - place).abs() < 1e-6);
    let parts = (1..=FINEST).map(|parts| step / f64::from(parts));
    parts.clone().find(|step| lies(*step)).or_else(|| parts.last()).unwrap_or(step)
}

/// The value of an own effect at zero.
fn at_zero(effect: &Effect, values: &[f64]) -> f64 {
    let zero = effect.nodes.iter().position(|place| *place == 0.0);
    zero.and_then(|zero| values.get(zero)).copied().unwrap_or_default()
}
