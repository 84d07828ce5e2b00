//! Tables for a PMAC. In: a correction taken apart. Out: the largest effects as tables, at nodes counted from the motor's zero.

use super::super::effects::{Effects, LEAST};
use super::super::job::{File, Job, Written};
use super::super::nodes::Spacing;
use super::super::refused::Refused;
use super::commands;
use super::tables::{TABLES, controller, index};

/// The most entries of a table.
const MOST: usize = 10_000;

/// A step is cut into so many parts at most to bring nodes and zero together.
const FINEST: u32 = 20;

/// One file of commands.
pub(in super::super) fn written(job: &Job<'_, '_>) -> Result<Written, Refused> {
    let pmac = controller(job)?;
    let effects = Effects::new(job.geometry, job.space)?;
    let mut written = Written::default();
    let (mut all, mut backlash) = (Vec::new(), Vec::new());
    for (source, range) in job.space.ranges.iter().enumerate() {
        if pmac.motors.get(source).is_none_or(|motor| motor.counts.is_none()) {
            written.left_out.extend(left_out(job, source));
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
        "the zero of each motor must be that of the calibration: home the motor there, or set its home offset".to_owned(),
        "set Ixx85 = 0 and use no other buffers (I6, GATHER, ROTARY) while the tables are defined; I51 = 1 switches them on".to_owned(),
    ];
    Ok(written)
}

/// What is told of a rotary axis that corrects its angle and whose counts are not said.
fn left_out(job: &Job<'_, '_>, axis: usize) -> Option<String> {
    let geometry = job.geometry;
    let own = geometry.equations.turning().into_iter().filter(|own| own.axis == axis);
    let letter = &geometry.equations.axes.get(axis)?.letter;
    own.into_iter().any(|own| !geometry.terms(own.motion).is_empty()).then(|| {
        format!("the angle of {letter}: give the counts of its motor per degree, --counts {letter}=10000")
    })
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
            format!("the range of {letter} does not contain zero, where a table begins"),
            help,
        ));
    }
    let even = effects.nodes(axis)?.at_equal_steps(Spacing { points: job.options.points, most: MOST })?;
    let step = even.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let step = if job.options.points.is_some() { step } else { counted_from_zero(step, &even) };
    let whole = |place: f64| index((place / step - 1e-9).ceil().max(0.0));
    let (below, above) = (whole(-low), whole(high));
    let at = |number: usize| f64::from(u32::try_from(number).unwrap_or(u32::MAX)) * step;
    Ok((1..=below).rev().map(|number| -at(number)).chain((0..=above).map(at)).collect())
}

/// A step that divides this one and on whose multiples all nodes lie, where one of a few does; else a fine one.
fn counted_from_zero(step: f64, nodes: &[f64]) -> f64 {
    let lies = |step: f64| nodes.iter().all(|place| ((place / step).round() * step - place).abs() < 1e-6);
    let mut parts = (1..=FINEST).map(|parts| step / f64::from(parts));
    parts.clone().find(|step| lies(*step)).or_else(|| parts.next_back()).unwrap_or(step)
}
