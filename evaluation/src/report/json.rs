//! The object `abbe-evaluation/1`. In: an evaluation. Out: JSON; what cannot be given is `null`, with its reason.

use serde_json::{Value, json as object};

use crate::circular::{Circle, Pair, Trace};
use crate::diagonals::Diagonals;
use crate::figure::{Figure, Unit};
use crate::iso230_2::{Side, TargetFigures};
use crate::positioning::Positioning;
use crate::{Evaluation, NotGiven};

/// The evaluation as one JSON object with the schema `abbe-evaluation/1`: mm, rad and mm/s.
pub fn json(evaluation: &Evaluation) -> String {
    let value = object!({
        "schema": "abbe-evaluation/1",
        "recording": {"file": evaluation.file, "title": evaluation.title, "machine": evaluation.machine,
                      "instrument": evaluation.instrument, "date": evaluation.date},
        "temperatures": evaluation.temperatures.iter().map(temperature).collect::<Vec<Value>>(),
        "positioning": evaluation.positioning.iter().map(positioning).collect::<Vec<Value>>(),
        "diagonals": evaluation.diagonals.as_ref().map(diagonals),
        "circles": evaluation.circles.iter().map(circle).collect::<Vec<Value>>(),
        "not_given": evaluation.not_given.iter().map(not_given).collect::<Vec<Value>>(),
    });
    // Every value is a number, a text, a list or a map with text as keys: writing them cannot fail.
    let mut text = serde_json::to_string_pretty(&value).unwrap_or_default();
    text.push('\n');
    text
}

fn temperature((sensor, [least, greatest]): &(String, [f64; 2])) -> Value {
    object!({"sensor": sensor, "least": least, "greatest": greatest, "unit": "degC"})
}

fn not_given(one: &NotGiven) -> Value {
    object!({"what": one.what, "because": one.because})
}

fn figure(figure: &Figure) -> Value {
    object!({"figure": figure.symbol, "name": figure.name, "value": figure.value.number(),
             "unit": figure.unit.name(), "because": figure.value.reason(), "targets": figure.rests.targets,
             "readings": figure.rests.readings, "runs": figure.rests.runs, "source": figure.source})
}

fn figures(all: &[Figure]) -> Vec<Value> {
    all.iter().map(figure).collect()
}

fn positioning(line: &Positioning) -> Value {
    let stands =
        |(axis, at, unit): &(String, f64, Unit)| object!({"axis": axis, "value": at, "unit": unit.name()});
    object!({"axes": line.axes, "kind": line.kind.name(), "direction": line.direction,
             "at": line.at.iter().map(stands).collect::<Vec<Value>>(),
             "sensor": line.sensor.name(), "zero": line.zero.name(), "unit": line.unit.name(),
             "targets": line.targets.iter().map(target).collect::<Vec<Value>>(),
             "left_out": line.left_out, "figures": figures(&line.figures), "notes": line.notes})
}

fn target(target: &TargetFigures) -> Value {
    object!({"position": target.position, "up": target.up.map(side), "down": target.down.map(side),
             "mean": target.mean(), "reversal": target.reversal(), "repeatability": target.repeatability()})
}

fn side(side: Side) -> Value {
    object!({"readings": side.readings, "mean": side.mean, "s": side.s, "repeatability": side.repeatability()})
}

fn diagonals(diagonals: &Diagonals) -> Value {
    object!({"kind": diagonals.kind.name(), "diagonals": diagonals.names, "figures": figures(&diagonals.figures)})
}

fn circle(circle: &Circle) -> Value {
    object!({"plane": circle.plane, "center": circle.center, "radius": circle.radius, "unit": "mm",
             "feed": {"value": circle.feed, "unit": "mm/s"}, "sensor": circle.sensor.name(),
             "traces": circle.traces.iter().map(trace).collect::<Vec<Value>>(),
             "pairs": circle.pairs.iter().map(pair).collect::<Vec<Value>>(),
             "figures": figures(&circle.figures)})
}

fn trace(trace: &Trace) -> Value {
    let own = trace.figures.as_ref().ok();
    object!({"run": trace.run, "sense": trace.sense.name(), "span": {"value": trace.span, "unit": "rad"},
             "readings": trace.points.len(),
             "G": own.map(|own| own.circular), "G_LS": own.map(|own| own.circular_least_squares),
             "F_max": own.map(|own| own.radial[0]), "F_min": own.map(|own| own.radial[1]),
             "F_set_up": trace.set_up.as_ref().ok().map(|[most, least]| object!({"max": most, "min": least})),
             "center": own.and_then(|own| own.center), "radius": own.map(|own| own.radius),
             "because": trace.figures.as_ref().err()})
}

fn pair(pair: &Pair) -> Value {
    object!({"runs": {"CCW": pair.runs[0], "CW": pair.runs[1]}, "readings": pair.readings, "G_b": pair.circular,
             "G_b_LS": pair.circular_least_squares, "D": pair.radius})
}
