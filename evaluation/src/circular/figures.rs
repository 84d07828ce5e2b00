//! The figures of a circle. In: its traces and pairs. Out: one value of each figure, or why there is none.

use super::{Pair, Sense, Trace, TraceFigures};
use crate::figure::{Figure, Given, Rests, Unit};
use crate::number;

/// The source of all figures here.
const SOURCE: &str = "ISO 230-4";

pub(super) fn figures(traces: &[Trace], pairs: &[Pair]) -> Vec<Figure> {
    let of = |sense: Sense| traces.iter().filter(move |trace| trace.sense == sense).collect::<Vec<&Trace>>();
    let (ccw, cw) = (of(Sense::Counterclockwise), of(Sense::Clockwise));
    let all: Vec<&Trace> = traces.iter().collect();
    let circular = |figures: &TraceFigures| figures.circular;
    let squares = |figures: &TraceFigures| figures.circular_least_squares;
    vec![
        one_way(
            "G_CCW",
            "circular deviation, counterclockwise",
            &ccw,
            "counterclockwise",
            f64::max,
            circular,
        ),
        one_way("G_CW", "circular deviation, clockwise", &cw, "clockwise", f64::max, circular),
        both_ways("G_b", "bidirectional circular deviation", pairs, traces, |pair| pair.circular),
        one_way(
            "G_CCW_LS",
            "circular deviation by least squares, counterclockwise",
            &ccw,
            "counterclockwise",
            f64::max,
            squares,
        ),
        one_way(
            "G_CW_LS",
            "circular deviation by least squares, clockwise",
            &cw,
            "clockwise",
            f64::max,
            squares,
        ),
        both_ways("G_b_LS", "bidirectional circular deviation by least squares", pairs, traces, |pair| {
            pair.circular_least_squares
        }),
        one_way("F_max", "maximum radial deviation", &all, "", f64::max, |figures| figures.radial[0]),
        one_way("F_min", "minimum radial deviation", &all, "", f64::min, |figures| figures.radial[1]),
        set_up_figure(
            "F_max_set_up",
            "maximum radial deviation about the centre as set up",
            traces,
            f64::max,
            0,
        ),
        set_up_figure(
            "F_min_set_up",
            "minimum radial deviation about the centre as set up",
            traces,
            f64::min,
            1,
        ),
        both_ways("D", "mean bidirectional radial deviation", pairs, traces, |pair| pair.radius),
    ]
}

/// The greatest or least of some traces; where one of them has no figures, of the others.
fn one_way(
    symbol: &'static str,
    name: &'static str,
    traces: &[&Trace],
    sense: &str,
    choose: fn(f64, f64) -> f64,
    value: impl Fn(&TraceFigures) -> f64,
) -> Figure {
    let good: Vec<(&TraceFigures, usize)> =
        traces.iter().filter_map(|trace| Some((trace.figures.as_ref().ok()?, trace.points.len()))).collect();
    let rests =
        Rests { targets: None, readings: good.iter().map(|(_, count)| count).sum(), runs: [good.len(); 2] };
    let value = good.iter().map(|(figures, _)| value(figures)).reduce(choose);
    let value = value.ok_or_else(|| no_trace(traces, sense));
    Figure { symbol, name, source: SOURCE, value: Given::from(value), unit: Unit::Length, rests }
}

/// The greatest or least of all traces about the centre as set up.
fn set_up_figure(
    symbol: &'static str,
    name: &'static str,
    traces: &[Trace],
    choose: fn(f64, f64) -> f64,
    part: usize,
) -> Figure {
    let good: Vec<(f64, usize)> = traces
        .iter()
        .filter_map(|trace| Some((*trace.set_up.as_ref().ok()?.get(part)?, trace.points.len())))
        .collect();
    let rests =
        Rests { targets: None, readings: good.iter().map(|(_, count)| count).sum(), runs: [good.len(); 2] };
    let reason = || traces.iter().find_map(|trace| trace.set_up.clone().err()).unwrap_or_default();
    let value = good.iter().map(|(value, _)| *value).reduce(choose).ok_or_else(reason);
    Figure { symbol, name, source: SOURCE, value: Given::from(value), unit: Unit::Length, rests }
}

fn no_trace(traces: &[&Trace], sense: &str) -> String {
    match traces.first().map(|trace| &trace.figures) {
        Some(Err(reason)) => reason.clone(),
        _ => format!("the circle was not driven {sense}"),
    }
}

/// What both senses give together: of several pairs the one of the greatest size; D is the mean of all.
fn both_ways(
    symbol: &'static str,
    name: &'static str,
    pairs: &[Pair],
    traces: &[Trace],
    value: impl Fn(&Pair) -> f64,
) -> Figure {
    let values: Vec<f64> = pairs.iter().map(value).collect();
    let rests = Rests {
        targets: None,
        readings: pairs.iter().map(|pair| pair.readings).sum(),
        runs: [2 * values.len(); 2],
    };
    let value = if values.is_empty() {
        let only = traces.iter().find(|trace| trace.figures.is_ok());
        Err(match only {
            Some(trace) => format!("full circles were driven only {}", trace.sense.name()),
            None => no_trace(&traces.iter().collect::<Vec<&Trace>>(), ""),
        })
    } else if symbol == "D" {
        Ok(values.iter().sum::<f64>() / number(values.len()))
    } else {
        Ok(values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
    };
    Figure { symbol, name, source: SOURCE, value: Given::from(value), unit: Unit::Length, rests }
}
