//! Measured curves: the term `table`.

use std::f64::consts::TAU;

use super::fields::filled_list;
use super::parameters::Parameters;
use super::series::{read_motion_unit, wrong_unit};
use super::term::{CalibratedTerm, Curve, CurveNodes, CurveValues};
use crate::diagnostic::Diagnostic;
use crate::quantity::{self, Dimension};
use crate::source::{Span, Spanned};
use crate::yaml::Node;

pub(super) fn read_table(term: &mut Parameters<'_, '_, '_>) -> Option<CalibratedTerm> {
    let axis = term.axis();
    let nodes = read_nodes(term, axis);
    let values = read_values(term);
    let (values, length) = values?;
    let (nodes, values) = match nodes? {
        Nodes::Uniform { start, step } => (CurveNodes::Uniform { start, step }, values),
        Nodes::At(at, span) => {
            if at.len() != length {
                lengths_differ(term, span, at.len(), length);
                return None;
            }
            ascending(at, values)
        }
    };
    let axis = axis?;
    let curve = repeated(term, axis, Curve::new(nodes, values))?;
    Some(CalibratedTerm::Table { axis, curve })
}

/// Lengths that differ by less than this share of them are one: what rounding leaves of degrees.
const SAME: f64 = 1e-9;

/// The curve as it repeats: after the period that is given, or after one turn where it spans that of a rotary axis.
fn repeated(term: &mut Parameters<'_, '_, '_>, axis: usize, curve: Curve) -> Option<Curve> {
    let [first, last] = curve.ends()?;
    let length = (last - first).abs();
    let is = |period: f64| (length - period).abs() <= SAME * period;
    let Some(node) = term.fields.get("period") else {
        let spans_a_turn = term.position(Some(axis)) == Dimension::ANGLE && is(TAU);
        let curve = Curve { repeats: spans_a_turn, ..curve };
        if spans_a_turn {
            warn_of_a_jump(term, term.key_span("axis"), &curve);
        }
        return Some(curve);
    };
    let period = term.quantity_in(node, "period", term.position(Some(axis)))?;
    if period.value <= 0.0 || length > period.value * (1.0 + SAME) {
        let message = format!("{} must not be shorter than the table", term.words("period"));
        let mistake = Diagnostic::error("E0419", period.span, message);
        term.report(mistake.help("it is the distance from the first node to where the table begins again"));
        return None;
    }
    if is(period.value) && length > 0.0 {
        let curve = Curve { repeats: true, ..curve };
        warn_of_a_jump(term, period.span, &curve);
        return Some(curve);
    }
    Some(closed(curve, period.value))
}

/// The curve with its first value once more, a period behind its first node.
fn closed(curve: Curve, period: f64) -> Curve {
    let positions = curve.positions();
    let (Some(first), Some(last)) = (positions.first().copied(), positions.last().copied()) else {
        return curve;
    };
    let end = if last < first { first - period } else { first + period };
    let close = |mut values: Vec<f64>| {
        values.extend(values.first().copied());
        values
    };
    let values = match curve.values {
        CurveValues::Both(values) => CurveValues::Both(close(values)),
        CurveValues::Directed { forward, reverse } => {
            CurveValues::Directed { forward: close(forward), reverse: close(reverse) }
        }
    };
    let (nodes, values) = match curve.nodes {
        // One step further is the end already.
        CurveNodes::Uniform { start, step } if (last + step - end).abs() <= SAME * period => {
            (CurveNodes::Uniform { start, step }, values)
        }
        _ => ascending(positions.into_iter().chain([end]).collect(), values),
    };
    Curve { nodes, values, repeats: true }
}

/// Warns where the ends of a turn have two values: the correction jumps whenever the axis passes there.
fn warn_of_a_jump(term: &mut Parameters<'_, '_, '_>, place: Span, curve: &Curve) {
    if !curve.meets() {
        let message = format!("the ends of {} are the same place but have different values", term.what);
        let warning =
            Diagnostic::warning("W0403", place, message).label("the table repeats after its last node");
        term.report(warning.help("write the mean of both at both ends, or the correction jumps there"));
    }
}

enum Nodes {
    Uniform { start: f64, step: f64 },
    At(Vec<f64>, Span),
}

fn read_nodes(term: &mut Parameters<'_, '_, '_>, axis: Option<usize>) -> Option<Nodes> {
    let stepped = ["start", "step"].into_iter().find(|key| term.fields.get(key).is_some());
    match (term.fields.get("at"), stepped) {
        (Some(_), Some(key)) => {
            exclusive(term, "at", key, "give the nodes by `start` and `step`, or by `at`");
            None
        }
        (Some(at), None) => read_at(term, at, axis),
        (None, Some(_)) => read_uniform(term, axis),
        (None, None) => {
            let message = format!("{} does not say where its nodes are", term.what);
            let mistake = Diagnostic::error("E0411", term.key_span("at"), message);
            term.report(mistake.help("add `start` and `step`, or `at: [...]`"));
            None
        }
    }
}

fn exclusive(term: &mut Parameters<'_, '_, '_>, key: &str, other: &str, help: &str) {
    let message = format!("{} has `{other}` and `{key}` together", term.what);
    let mistake = Diagnostic::error("E0416", term.key_span(key), message);
    let mistake = mistake.also(term.key_span(other), format!("`{other}` is here"));
    term.report(mistake.help(help));
}

fn read_uniform(term: &mut Parameters<'_, '_, '_>, axis: Option<usize>) -> Option<Nodes> {
    if term.fields.get("per").is_some() {
        let message = format!("`per` of {} has nothing to scale", term.what);
        let mistake = Diagnostic::error("E0416", term.key_span("per"), message);
        term.report(mistake.help("it is for bare numbers in `at`; leave it out with `start` and `step`"));
    }
    let kind = term.position(axis);
    let start = term.quantity("start", kind);
    let step_node = term.need("step")?;
    let step = term.quantity_in(step_node, "step", kind)?;
    // Tables are read by the inverse of their step.
    if !step.value.recip().is_finite() {
        let message = format!("{} must not be zero or close to zero", term.words("step"));
        let mistake = Diagnostic::error("E0419", step.span, message);
        term.report(mistake.help("write the distance from one node to the next"));
        return None;
    }
    Some(Nodes::Uniform { start: start?, step: step.value })
}

fn read_at(term: &mut Parameters<'_, '_, '_>, node: &Node, axis: Option<usize>) -> Option<Nodes> {
    let scale = match term.fields.get("per") {
        Some(per) => Some(read_scale(term, per, axis)?),
        None => None,
    };
    let words = term.words("at");
    let items = filled_list(node, &words, term.context.diagnostics)?;
    let read: Vec<_> = items.iter().map(|item| read_node(term, item, scale, axis)).collect();
    let at: Vec<Spanned<f64>> = read.into_iter().collect::<Option<_>>()?;
    check_order(term, &at)?;
    let at = at.into_iter().map(|node| node.value).collect();
    Some(Nodes::At(at, node.span))
}

fn read_scale(term: &mut Parameters<'_, '_, '_>, node: &Node, axis: Option<usize>) -> Option<f64> {
    let words = term.words("per");
    let per = quantity::read_unit(node, &words, term.context.diagnostics)?;
    let expected = term.position(axis);
    if axis.is_some() && per.value.dimension != expected {
        wrong_unit(term, node, per, &format!("`at` of {}", term.what), expected);
        return None;
    }
    Some(per.value.factor)
}

fn read_node(
    term: &mut Parameters<'_, '_, '_>,
    item: &Node,
    scale: Option<f64>,
    axis: Option<usize>,
) -> Option<Spanned<f64>> {
    let words = format!("an entry of {}", term.words("at"));
    match scale {
        Some(scale) => {
            let number = quantity::read_number(item, &words, term.context.diagnostics)?;
            Some(number.map(|number| number * scale))
        }
        None => quantity::read(item, term.position(axis), &words, term.context.diagnostics),
    }
}

/// Reports every node that does not go on in the direction of the first two.
fn check_order(term: &mut Parameters<'_, '_, '_>, at: &[Spanned<f64>]) -> Option<()> {
    let falling = matches!(at, [first, second, ..] if second.value < first.value);
    let pairs = at.iter().zip(at.iter().skip(1));
    let wrong = pairs.filter(|(before, next)| match falling {
        true => next.value >= before.value,
        false => next.value <= before.value,
    });
    let mistakes: Vec<_> =
        wrong.map(|(before, next)| out_of_order(before.span, next.span, falling)).collect();
    let in_order = mistakes.is_empty();
    mistakes.into_iter().for_each(|mistake| term.report(mistake));
    in_order.then_some(())
}

fn out_of_order(before: Span, next: Span, falling: bool) -> Diagnostic {
    let relation = if falling { "below" } else { "above" };
    let message = format!("this node of `at` is not {relation} the one before it");
    let mistake = Diagnostic::error("E0418", next, message).also(before, "the one before it");
    mistake.help("sort the nodes together with their values, and list each node once")
}

/// Reads `values`, or `forward` and `reverse`, and tells how many there are.
fn read_values(term: &mut Parameters<'_, '_, '_>) -> Option<(CurveValues, usize)> {
    let unit = read_motion_unit(term);
    let directed = ["forward", "reverse"].into_iter().find(|key| term.fields.get(key).is_some());
    match (term.fields.get("values"), directed) {
        (Some(_), Some(key)) => {
            exclusive(term, "values", key, "give one curve, `values`, or one for each direction");
            None
        }
        (Some(values), None) => {
            let values = read_curve(term, "values", values, unit)?;
            let length = values.len();
            Some((CurveValues::Both(values), length))
        }
        (None, Some(_)) => read_directed(term, unit),
        (None, None) => {
            let message = format!("{} has no values", term.what);
            let mistake = Diagnostic::error("E0411", term.key_span("values"), message);
            term.report(mistake.help("add `values: [...]`, or `forward: [...]` and `reverse: [...]`"));
            None
        }
    }
}

fn read_directed(term: &mut Parameters<'_, '_, '_>, unit: Option<f64>) -> Option<(CurveValues, usize)> {
    let forward = term.need("forward");
    let reverse = term.need("reverse");
    let forward = forward.and_then(|node| read_curve(term, "forward", node, unit));
    let reverse_values = reverse.and_then(|node| read_curve(term, "reverse", node, unit));
    let (forward, reverse_values) = (forward?, reverse_values?);
    let length = forward.len();
    if reverse_values.len() != length {
        let span = reverse.map_or(term.key_span("reverse"), |node| node.span);
        lengths_differ(term, span, reverse_values.len(), length);
        return None;
    }
    Some((CurveValues::Directed { forward, reverse: reverse_values }, length))
}

fn lengths_differ(term: &mut Parameters<'_, '_, '_>, span: Span, found: usize, expected: usize) {
    let message = format!("{} has {found} nodes here, but {expected} values", term.what);
    let mistake = Diagnostic::error("E0417", span, message).label(format!("{found} entries"));
    term.report(mistake.help("write one value for each node, in each direction"));
}

fn read_curve(
    term: &mut Parameters<'_, '_, '_>,
    key: &str,
    node: &Node,
    unit: Option<f64>,
) -> Option<Vec<f64>> {
    let words = term.words(key);
    let items = filled_list(node, &words, term.context.diagnostics)?;
    let entry = format!("an entry of {words}");
    let numbers: Vec<_> =
        items.iter().map(|item| quantity::read_number(item, &entry, term.context.diagnostics)).collect();
    let unit = unit?;
    numbers.into_iter().map(|number| Some(number?.value * unit)).collect()
}

/// Turns falling nodes, and their values, the other way round.
fn ascending(mut at: Vec<f64>, mut values: CurveValues) -> (CurveNodes, CurveValues) {
    if matches!(at.as_slice(), [first, second, ..] if second < first) {
        at.reverse();
        match &mut values {
            CurveValues::Both(values) => values.reverse(),
            CurveValues::Directed { forward, reverse } => {
                forward.reverse();
                reverse.reverse();
            }
        }
    }
    (CurveNodes::At(at), values)
}
