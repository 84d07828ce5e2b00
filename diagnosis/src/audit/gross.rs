//! Gross faults: columns that are exchanged, turned, or in another unit.
//!
//! In: a channel of a position. Out: if it does not follow the programmed path, the one thing of its set-up that would make it follow.
//! It is off by millimetres then, and no model is needed to tell.

use crate::channel::{Channel, ChannelAt, Kind};
use crate::diagnosis::{Change, Evidence, WrongFile};
use crate::scene::Scene;
use crate::study::Study;

/// Factors to try: metres, micrometres and inches for millimetres and the other way round, and the wrong sign.
const FACTORS: [(f64, &str); 5] = [
    (1e3, "the unit of {} is a thousand times too small"),
    (1e-3, "the unit of {} is a thousand times too large"),
    (25.4, "{} is in inches"),
    (1.0 / 25.4, "{} is in millimetres but is read as inches"),
    (-1.0, "the sign of {} is wrong"),
];

/// A channel follows its path if half of its samples are off by no more than this share of the typical distance that the path goes. No
/// error of a machine is a tenth of the travel, and half of the path of another axis hardly lies that near.
const FOLLOWS: f64 = 0.1;

/// One thing that may be wrong with a channel, and the readings without it.
struct Way {
    readings: Vec<f64>,
    fault: String,
    change: &'static str,
    with: Option<String>,
}

/// The one thing that would make a channel of a position follow its path. `None` if it follows (half of its samples are off by less than
/// `slack`, mm), if nothing would make it follow, or if more than one thing would.
pub(crate) fn change(study: &Study<'_>, at: ChannelAt, slack: f64) -> Option<Change> {
    let (known, observed) = (&study.scenes[at.scene], study.channel(at));
    let Kind::Tip(direction) = observed.kind else { return None };
    let positions: Vec<&[f64]> = known.given.programmed.iter().map(|position| &position[..]).collect();
    let nominal = &known.built.interpreter.nominal_columns(&positions)[direction];
    let before = typical_distance(&observed.values, nominal).filter(|before| *before > slack)?;
    // A channel that stands still follows a path that stands still, and anything divided by a thousand stands still.
    let slack = slack.min(FOLLOWS * typical_distance(nominal, &vec![0.0; nominal.len()])?);
    let off = |way: Way| Some((typical_distance(&way.readings, nominal)?, way));
    let mut fitting = ways(known, observed).into_iter().filter_map(off).filter(|(off, _)| *off < slack);
    let (after, way) = fitting.next()?;
    fitting.next().is_none().then(|| Change {
        file: WrongFile::Recording(at.scene),
        name: known.recording.file.clone(),
        line: None,
        path: format!("channels.{}", observed.name),
        change: way.change,
        with: way.with,
        remedy: "correct it in the recording file; before that, nothing else can be found".to_owned(),
        fault: way.fault,
        amount: None,
        share: 1.0 - (after / before).powi(2),
        evidence: Evidence { with: after, without: before, unit: "mm", drive: None },
        alternatives: Vec::new(),
    })
}

/// What may be wrong with a channel of a position: its unit, its sign, or its column.
fn ways(known: &Scene<'_>, observed: &Channel<'_>) -> Vec<Way> {
    let scaled = FACTORS.iter().map(|(factor, fault)| Way {
        readings: observed.values.iter().map(|value| value * factor).collect(),
        fault: fault.replace("{}", &observed.name),
        change: if *factor < 0.0 { "sign" } else { "unit" },
        with: None,
    });
    let others = known.channels.iter();
    let others = others.filter(|other| matches!(other.kind, Kind::Tip(_)) && other.name != observed.name);
    let swapped = others.map(|other| Way {
        readings: other.values.to_vec(),
        fault: format!("the columns of {} and {} are swapped", observed.name, other.name),
        change: "columns",
        with: Some(format!("channels.{}", other.name)),
    });
    scaled.chain(swapped).collect()
}

/// The median distance of samples from a path, their zero left free.
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
