//! The object `abbe-limits/1`. In: what a recording could show. Out: JSON; what there is not is `null`.

use serde_json::{Value, json as object};

use crate::answer::{Advice, Pair, Pass};
use crate::answer::{Already, Limit, Limits};
use crate::trial::{Other, Trial};

/// Limits as one JSON object with the schema `abbe-limits/1`, in the units that each entry names.
pub fn json(limits: &Limits) -> String {
    let value = object!({
        "schema": "abbe-limits/1",
        "recording": {"file": limits.file, "title": limits.title, "machine": limits.machine, "rows": limits.rows},
        "as_it_is": {"verdict": limits.verdict, "findings": limits.known},
        "seed": limits.seed,
        "found_already": limits.already.iter().map(already).collect::<Vec<Value>>(),
        "passes": limits.advice.as_ref().map(advice),
        "limits": limits.all.iter().map(limit).collect::<Vec<Value>>(),
    });
    // Every value is a number, a text, a list or a map with text as keys: writing them cannot fail.
    let mut text = serde_json::to_string_pretty(&value).unwrap_or_default();
    text.push('\n');
    text
}

fn advice(advice: &Advice) -> Value {
    let pairs = |pairs: &[Pair]| {
        pairs
            .iter()
            .map(|pair| object!({"effect": pair.effect, "or_else": pair.other}))
            .collect::<Vec<Value>>()
    };
    let pass = |pass: &Pass| object!({"drive": pass.words, "seconds": pass.time, "tells_apart": pairs(&pass.settles)});
    object!({"passes": advice.passes.iter().map(pass).collect::<Vec<Value>>(), "left": pairs(&advice.left)})
}

fn already(one: &Already) -> Value {
    object!({"motion": one.motion, "term": one.term})
}

fn limit(limit: &Limit) -> Value {
    let found = limit.found.as_ref();
    object!({
        "motion": limit.motion, "axis": limit.axis, "kind": limit.subject.kind.name(), "shows_alike": limit.alike,
        "drawn": limit.drawn, "size_of": limit.scale.of, "unit": limit.scale.unit,
        "found_below": limit.scale.is_gain,
        "size": limit.size(), "relative_uncertainty": found.map(|found| found.uncertainty),
        "half_interval": limit.half(), "by_its_name": found.map(|found| found.first),
        "or_else": found.map(|found| found.others.iter().map(other).collect::<Vec<Value>>()),
        "instead": limit.instead,
        "trials": limit.trials.iter().map(|one| trial(limit, one)).collect::<Vec<Value>>(),
    })
}

fn other(other: &Other) -> Value {
    object!({"name": other.name, "separate_by": other.separate_by})
}

fn trial(limit: &Limit, trial: &Trial) -> Value {
    object!({"size": limit.scale.told(trial.strength), "found": trial.is_found,
             "first": trial.is_first, "instead": trial.instead})
}
