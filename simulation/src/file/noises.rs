//! Noise, gaps, temperatures and loads. In: their mappings. Out: their numbers.

use model_dsl::diagnostic::Diagnostic;
use model_dsl::quantity::{self, Dimension};
use model_dsl::source::{Span, Spanned};
use model_dsl::yaml::Node;

use super::section::{Context, Section, list, named, word};
use crate::noise::{Correlated, Missing, Noise, Outliers, Walk};
use crate::surroundings::{Load, Pulses, Swing, Temperature};

/// Reads noise of one kind: a mapping, or a size alone for white noise.
pub(super) fn noise(node: &Node, name: Span, kind: Dimension, context: &mut Context<'_>) -> Option<Noise> {
    if node.text().is_some() {
        let white = context.size(node, kind, "white noise")?;
        return Some(Noise::white(context.bounded(white, node.span, "white noise", true)?));
    }
    let known = ["white", "correlated", "walk", "outliers", "resolution"];
    let section = Section::open(node, name, "`noise`", &known, context)?;
    let white = section.not_negative("white", kind, 0.0, context);
    let resolution = section.not_negative("resolution", kind, 0.0, context);
    let correlated = section.part("correlated", |node, name| {
        let section = Section::open(node, name, "`correlated`", &["sigma", "time_constant"], context)?;
        let sigma = section.positive("sigma", kind, context);
        let time_constant = section.positive("time_constant", Dimension::TIME, context);
        Some(Correlated { sigma: sigma?, time_constant: time_constant? })
    });
    let walk = section.part("walk", |node, name| {
        let section = Section::open(node, name, "`walk`", &["sigma", "after"], context)?;
        let sigma = section.positive("sigma", kind, context);
        let after = section.positive("after", Dimension::TIME, context);
        Some(Walk { sigma: sigma?, after: after? })
    });
    let outliers = section.part("outliers", |node, name| {
        let section = Section::open(node, name, "`outliers`", &["rate", "size"], context)?;
        let rate = section.need("rate", context).and_then(|node| context.share(node, "`rate` of `outliers`"));
        let size = section.positive("size", kind, context);
        Some(Outliers { rate: rate?, size: size? })
    });
    Some(Noise {
        white: white?,
        correlated: correlated?,
        walk: walk?,
        outliers: outliers?,
        resolution: resolution?,
    })
}

/// So many lost stretches or more are refused.
const MOST_BLOCKS: u32 = 10_000;

/// Reads what is missing: a mapping, or a share alone.
pub(super) fn missing(node: &Node, name: Span, context: &mut Context<'_>) -> Option<Missing> {
    if node.text().is_some() {
        return Some(Missing { rate: context.share(node, "`missing`")?, ..Missing::default() });
    }
    let section = Section::open(node, name, "`missing`", &["rate", "blocks", "length"], context)?;
    let rate = match section.get("rate") {
        Some(node) => context.share(node, "`rate` of `missing`"),
        None => Some(0.0),
    };
    let blocks = section.whole_or("blocks", 0, 0, context);
    if let (Some(MOST_BLOCKS..), Some(node)) = (blocks, section.get("blocks")) {
        let message = format!("`blocks` of `missing` must be less than {MOST_BLOCKS}");
        context.report(Diagnostic::error("E0708", node.span, message).help("use fewer and longer stretches"));
    }
    let length = match blocks {
        Some(1..) => section.positive("length", Dimension::TIME, context),
        _ => Some(0.0),
    };
    Some(Missing { rate: rate?, blocks: blocks?, length: length? })
}

/// Reads all temperature sensors.
pub(super) fn temperatures(node: &Node, context: &mut Context<'_>) -> Option<Vec<Temperature>> {
    let entries = named(node, "`temperatures`", "{spindle: {start: 20 degC}}", context)?;
    let read: Vec<_> = entries.iter().map(|(name, node)| temperature(name, node, context)).collect();
    read.into_iter().collect()
}

fn temperature(name: &Spanned<String>, node: &Node, context: &mut Context<'_>) -> Option<Temperature> {
    let what = format!("the sensor `{}`", name.value);
    let known = ["start", "steps", "time_constant", "swing", "noise"];
    let section = Section::open(node, name.span, &what, &known, context)?;
    let start =
        section.need("start", context).and_then(|node| degrees(node, &section.words("start"), context));
    let steps = section.part("steps", |node, _| steps(node, &what, context));
    let time_constant = section.not_negative("time_constant", Dimension::TIME, 0.0, context);
    let swing = section.part("swing", |node, name| swing(node, name, Dimension::TEMPERATURE, context));
    let noise = section.part("noise", |node, name| noise(node, name, Dimension::TEMPERATURE, context));
    Some(Temperature {
        name: name.value.clone(),
        start: start?,
        steps: steps?.unwrap_or_default(),
        time_constant: time_constant?,
        swing: swing?,
        noise: noise?.unwrap_or_default(),
    })
}

fn degrees(node: &Node, what: &str, context: &mut Context<'_>) -> Option<f64> {
    quantity::read(node, Dimension::TEMPERATURE, what, context.diagnostics).map(|found| found.value)
}

fn steps(node: &Node, what: &str, context: &mut Context<'_>) -> Option<Vec<(f64, f64)>> {
    let words = format!("`steps` of {what}");
    let items = list(node, &words, context)?;
    let mut steps: Vec<(f64, f64)> = Vec::new();
    let mut whole = true;
    for item in items {
        let read = step(item, context);
        let late = read.zip(steps.last()).is_some_and(|((at, _), (before, _))| at <= *before);
        if late {
            let mistake = Diagnostic::error("E0708", item.span, format!("{words} are not in order of time"));
            context.report(mistake.help("begin each step after the one before"));
        }
        whole &= read.is_some() && !late;
        steps.extend(read);
    }
    whole.then_some(steps)
}

fn step(node: &Node, context: &mut Context<'_>) -> Option<(f64, f64)> {
    let section = Section::open(node, node.span, "a step", &["at", "to"], context)?;
    let at = section.not_negative("at", Dimension::TIME, 0.0, context);
    let to = section.need("to", context).and_then(|node| degrees(node, "`to` of a step", context));
    Some((at?, to?))
}

fn swing(node: &Node, name: Span, kind: Dimension, context: &mut Context<'_>) -> Option<Swing> {
    let section = Section::open(node, name, "`swing`", &["amplitude", "period", "phase"], context)?;
    let amplitude = section.quantity("amplitude", kind, context);
    let period = section.positive("period", Dimension::TIME, context);
    let phase = section.quantity_or("phase", Dimension::ANGLE, 0.0, context);
    Some(Swing { amplitude: amplitude?, period: period?, phase: phase? })
}

/// The units of loads.
const LOADS: [(&str, Dimension); 5] = [
    ("N", Dimension::FORCE),
    ("V", Dimension::VOLTAGE),
    ("A", Dimension::CURRENT),
    ("%", Dimension::PERCENT),
    ("count", Dimension::COUNT),
];

/// Reads all loads.
pub(super) fn loads(node: &Node, context: &mut Context<'_>) -> Option<Vec<Load>> {
    let entries = named(node, "`loads`", "{cutting: {unit: N, base: 100 N}}", context)?;
    let read: Vec<_> = entries.iter().map(|(name, node)| load(name, node, context)).collect();
    read.into_iter().collect()
}

fn load(name: &Spanned<String>, node: &Node, context: &mut Context<'_>) -> Option<Load> {
    let what = format!("the load `{}`", name.value);
    let known = ["unit", "base", "pulses", "swing", "noise"];
    let section = Section::open(node, name.span, &what, &known, context)?;
    let unit = word(section.need("unit", context)?, &section.words("unit"), context)?;
    let Some((unit, kind)) = LOADS.iter().find(|(known, _)| *known == unit.value) else {
        let mistake =
            Diagnostic::error("E0716", unit.span, format!("`{}` is not a unit of a load", unit.value));
        context.report(mistake.help("write one of N, V, A, %, count"));
        return None;
    };
    let base = section.quantity_or("base", *kind, 0.0, context);
    let pulses = section.part("pulses", |node, name| {
        let known = ["height", "period", "width", "start"];
        let section = Section::open(node, name, "`pulses`", &known, context)?;
        let height = section.quantity("height", *kind, context);
        let period = section.positive("period", Dimension::TIME, context);
        let width = section.positive("width", Dimension::TIME, context);
        let start = section.not_negative("start", Dimension::TIME, 0.0, context);
        Some(Pulses { height: height?, period: period?, width: width?, start: start? })
    });
    let swing = section.part("swing", |node, name| swing(node, name, *kind, context));
    let noise = section.part("noise", |node, name| noise(node, name, *kind, context));
    Some(Load {
        name: name.value.clone(),
        unit: (*unit).to_owned(),
        base: base?,
        pulses: pulses?,
        swing: swing?,
        noise: noise?.unwrap_or_default(),
    })
}
