//! The object `abbe-update/1`. In: an update. Out: JSON; a number that is not finite is `null`.

use serde_json::{Value, json as object};

use crate::residuals::{Figures, Residual};
use crate::setup::Rotation;
use crate::update::{Change, Part, Update};

/// The update as one JSON object with the schema `abbe-update/1`. Lengths are in mm.
pub fn json(update: &Update) -> String {
    let value = object!({
        "schema": "abbe-update/1",
        "machine": update.machine,
        "method": update.options.method.name(),
        "compensated": update.options.compensated,
        "parts": update.parts.iter().map(part).collect::<Vec<Value>>(),
        "points": update.points,
        "datum": {"directions": update.datum, "zeros": update.zeros,
                  "rotations": update.rotations.iter().map(rotation).collect::<Vec<Value>>()},
        "hints": update.hints,
        "unknowns": update.unknowns,
        "rank": update.rank,
        "tolerance": update.tolerance,
        "singular_values": update.singular_values,
        "noise": {"value": update.noise, "unit": "mm"},
        "expected_change": update.expected_change,
        "residuals": update.residuals.iter().map(residual).collect::<Vec<Value>>(),
        "held_out": update.held_out.iter().map(residual).collect::<Vec<Value>>(),
        "leave_one_out": {"before": update.leave_one_out[0], "after": update.leave_one_out[1], "unit": "mm"},
        "changes": update.changes.iter().map(change).collect::<Vec<Value>>(),
        "not_told_apart": update.relations.iter()
            .map(|one| object!({"coefficient": one.name, "from": one.others})).collect::<Vec<Value>>(),
        "not_moved": update.fixed.iter()
            .map(|one| object!({"coefficient": one.name, "reason": one.reason})).collect::<Vec<Value>>(),
    });
    // Every value is a number, a text, a list or a map with text as keys: writing them cannot fail.
    let mut text = serde_json::to_string_pretty(&value).unwrap_or_default();
    text.push('\n');
    text
}

fn part(part: &Part) -> Value {
    object!({"file": part.file, "title": part.title, "points": part.points, "held_out": part.held_out,
             "left_out": part.left_out, "taken_as_zero": part.standing})
}

fn rotation(rotation: &Rotation) -> Value {
    object!({"file": rotation.file, "run": rotation.run, "about": rotation.about,
             "angle": {"value": rotation.angle, "uncertainty": rotation.uncertainty, "unit": "rad"}})
}

fn residual(residual: &Residual) -> Value {
    object!({"direction": residual.direction, "points": residual.points, "unit": "mm",
             "before": figures(residual.before), "after": figures(residual.after)})
}

fn figures(figures: Figures) -> Value {
    object!({"max": figures.max, "mean": figures.mean, "std": figures.std, "rms": figures.rms})
}

fn change(change: &Change) -> Value {
    object!({"coefficient": change.name, "unit": change.unit, "before": change.before, "after": change.after,
             "uncertainty": change.uncertainty, "change": change.change,
             "effect": {"value": change.effect, "unit": "mm"}, "determined": change.determined,
             "alternatives": change.alternatives})
}
