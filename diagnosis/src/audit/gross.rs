//! Gross faults: columns that are exchanged, turned, or in another unit.
//!
//! In: a channel that does not follow the programmed path. Out: what of its set-up would make it follow, where there is one such
//! thing. Millimetres are wrong here, and no model is needed to tell.

use crate::diagnosis::{Change, Evidence, WrongFile};
use crate::study::{Kind, Study};

/// Factors that are tried: metres, micrometres and inches for millimetres, and the other way; and the other sign.
const WAYS: [(f64, &str); 5] = [
    (1e3, "the unit of {} is a thousand times too small"),
    (1e-3, "the unit of {} is a thousand times too large"),
    (25.4, "{} is in inches"),
    (1.0 / 25.4, "{} is in millimetres, and is read as inches"),
    (-1.0, "the sign of {} is wrong"),
];

/// A channel follows where half of its samples are off by no more than this share of what half of the path goes.
const FOLLOWS: f64 = 0.1;

/// What would make a channel of a position follow the path, so that half of its samples are off by less than `slack` (mm). `None` where
/// it does follow, and where nothing would make it, or more than one thing.
pub(crate) fn change(study: &Study<'_>, (scene, channel): (usize, usize), slack: f64) -> Option<Change> {
    let known = &study.scenes[scene];
    let Kind::Tip(direction) = known.channels[channel].kind else { return None };
    let positions: Vec<&[f64]> = known.given.programmed.iter().map(|position| &position[..]).collect();
    let nominal = study.interpreter.nominal_columns(&positions);
    let own = known.channels[channel].values;
    let tip = |channel: &&crate::study::Channel<'_>| matches!(channel.kind, Kind::Tip(of) if of != direction);
    let mut ways: Vec<(Vec<f64>, String, &'static str, Option<String>)> = Vec::new();
    let name = |direction: usize| format!("measured.{}", ["x", "y", "z"][direction]);
    for (factor, fault) in &WAYS {
        let values = own.iter().map(|value| value * factor).collect();
        let kind = if *factor < 0.0 { "sign" } else { "unit" };
        ways.push((values, fault.replace("{}", &name(direction)), kind, None));
    }
    for other in known.channels.iter().filter(tip) {
        let fault = format!("the columns of {} and {} are swapped", name(direction), other.name);
        ways.push((other.values.to_vec(), fault, "columns", Some(format!("channels.{}", other.name))));
    }
    let off = |values: &[f64]| typical_distance(values, &nominal[direction]);
    let before = off(own).filter(|before| *before > slack)?;
    // What goes nowhere follows any path that stands, and anything divided by a thousand does.
    let way = typical_distance(&nominal[direction], &vec![0.0; nominal[direction].len()])?;
    let slack = slack.min(FOLLOWS * way);
    let mut fitting = ways.into_iter().filter_map(|way| Some((off(&way.0)?, way)));
    let mut fitting = fitting.by_ref().filter(|(off, _)| *off < slack);
    let (after, (_, fault, kind, with)) = fitting.next()?;
    fitting.next().is_none().then(|| Change {
        file: WrongFile::Recording(scene),
        name: known.recording.file.clone(),
        line: None,
        path: format!("channels.{}", name(direction)),
        change: kind,
        with,
        remedy: "correct it in the recording file; nothing else can be told before".to_owned(),
        fault,
        amount: None,
        share: 1.0 - (after / before).powi(2),
        evidence: Evidence { with: after, without: before, unit: "mm", drive: None },
        alternatives: Vec::new(),
    })
}

/// Half of the samples are farther from a path than this, a zero left free.
fn typical_distance(values: &[f64], nominal: &[f64]) -> Option<f64> {
    let mut away: Vec<f64> = values
        .iter()
        .zip(nominal)
        .map(|(value, nominal)| value - nominal)
        .filter(|away| away.is_finite())
        .collect();
    let zero = middle(&mut away)?;
    away.iter_mut().for_each(|away| *away = (*away - zero).abs());
    middle(&mut away)
}

fn middle(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
