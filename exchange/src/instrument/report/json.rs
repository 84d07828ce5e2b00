//! An outcome for programs. In: an [`Outcome`]. Out: one object of the schema `abbe-calibrate/1`, in mm and rad. It computes nothing.

use model_dsl::equations::Equations;
use serde_json::{Value, json};

use super::super::calibrate::{MeasuredMotion, Outcome};
use super::super::curve::Mean;
use super::super::lever::Levers;
use super::super::line::Line;
use super::super::reduce::{Reduced, Reversal};
use super::super::squareness::Squareness;
use super::super::uncertainty::Uncertainty;

/// The outcome as JSON. What is not known is null, and so are degrees of freedom without an end.
pub fn json(outcome: &Outcome, equations: &Equations) -> String {
    let names = Names { equations };
    let motions: Vec<Value> = outcome.motions.iter().map(|one| motion(one, &names)).collect();
    let squarenesses: Vec<Value> = outcome.squarenesses.iter().map(|one| squareness(one, &names)).collect();
    let all = json!({
        "schema": "abbe-calibrate/1",
        "machine": outcome.machine,
        "motions": motions,
        "squarenesses": squarenesses,
    });
    format!("{all:#}\n")
}

/// What of a machine the object speaks of.
struct Names<'e> {
    equations: &'e Equations,
}

impl Names<'_> {
    fn motion(&self, number: usize) -> Option<&str> {
        self.equations.motions.get(number).map(|motion| motion.name.as_str())
    }

    fn letter(&self, axis: usize) -> Option<&str> {
        self.equations.axes.get(axis).map(|axis| axis.letter.as_str())
    }
}

fn unit(angular: bool) -> &'static str {
    if angular { "rad" } else { "mm" }
}

fn motion(one: &MeasuredMotion, names: &Names<'_>) -> Value {
    let known = names.equations.motions.get(one.motion);
    let axis = names.equations.axes.get(one.axis);
    let parts: Vec<Value> =
        one.parts.iter().zip(&one.files).map(|(part, file)| of_file(part, file, names)).collect();
    json!({
        "motion": names.motion(one.motion),
        "unit": unit(known.is_some_and(|motion| motion.angular)),
        "axis": names.letter(one.axis),
        "axis_unit": unit(axis.is_some_and(|axis| axis.rotary)),
        "targets": targets(one),
        "reversal": one.reversal.as_ref().map(reversal),
        "files": parts,
        "table": {
            "nodes": one.table.nodes,
            "forward": one.table.forward,
            "reverse": one.table.reverse,
            "lost_motion": one.table.lost_motion,
            "smoothed_by": one.table.smoothed,
            "resampled_by": one.table.resampled,
        },
    })
}

fn targets(one: &MeasuredMotion) -> Vec<Value> {
    let at =
        |side: &Option<Vec<Mean>>, place: usize| side.as_ref().and_then(|side| side.get(place)).map(mean);
    let edge = |place: usize| one.edge.as_ref().and_then(|edge| edge.get(place)).copied();
    let positions = one.curve.positions.iter().enumerate();
    positions
        .map(|(place, position)| {
            json!({
                "position": position,
                "forward": at(&one.curve.forward, place),
                "reverse": at(&one.curve.reverse, place),
                "edge": edge(place),
            })
        })
        .collect()
}

fn mean(one: &Mean) -> Value {
    json!({ "value": one.value, "readings": one.readings, "uncertainty": one.uncertainty.map(uncertainty) })
}

fn uncertainty(one: Uncertainty) -> Value {
    json!({ "standard": one.standard, "freedom": one.freedom, "half95": one.expanded() })
}

fn reversal(one: &Reversal) -> Value {
    json!({
        "mean": one.mean,
        "uncertainty": one.uncertainty.map(uncertainty),
        "greatest": one.greatest,
        "at": one.at,
    })
}

fn of_file(part: &Reduced, file: &str, names: &Names<'_>) -> Value {
    let [forward, reverse] = part.runs;
    json!({
        "file": file,
        "runs": { "forward": forward, "reverse": reverse },
        "left_out": part.left_out,
        "line": part.line.as_ref().map(line),
        "levers": part.levers.as_ref().map(|levers| lever_arms(levers, names)),
    })
}

fn line(one: &Line) -> Value {
    json!({
        "offset": one.offset,
        "slope": one.slope,
        "uncertainty": one.uncertainty().map(uncertainty),
        "from_residual": one.from_residual.map(uncertainty),
        "from_runs": one.from_runs.map(uncertainty),
    })
}

fn lever_arms(levers: &Levers, names: &Names<'_>) -> Value {
    let taken =
        levers.taken.iter().map(|(motion, most)| json!({ "motion": names.motion(*motion), "most": most }));
    let taken: Vec<Value> = taken.collect();
    let remaining: Vec<Option<&str>> = levers.remaining.iter().map(|motion| names.motion(*motion)).collect();
    json!({ "taken_off": taken, "remaining": remaining })
}

fn squareness(one: &Squareness, names: &Names<'_>) -> Value {
    json!({
        "motion": names.motion(one.motion),
        "unit": "rad",
        "angle": one.angle,
        "uncertainty": one.uncertainty.map(uncertainty),
        "reference": one.reference,
        "set_ups": one.set_ups,
        "square": one.square,
        "turned": one.turned,
        "from": one.from.map(|motion| names.motion(motion)),
    })
}
