//! The ceiling: what comes back of each channel, before any name, in words.
//!
//! In: a study in which returns were told. Out: for each channel the states that predict it in units to which they were not
//! fitted, one more in each line, with the share that they predict together and what they leave; and the channels of which nothing
//! comes back.

use crate::channel::{Channel, Kind};
use crate::diagnosis::{NothingReturns, Returning};
use crate::parameters::axis_unit;
use crate::returns::Quantity;
use crate::scene::Scene;
use crate::study::Study;

/// The ceiling of every channel of every recording of which anything comes back.
pub(super) fn ceiling(study: &Study<'_>) -> Vec<Returning> {
    let scenes = study.scenes.iter().enumerate();
    scenes
        .flat_map(|(recording, scene)| {
            scene.channels.iter().flat_map(move |channel| of_channel(study, recording, scene, channel))
        })
        .collect()
}

/// The channels of all recordings of which nothing comes back.
pub(super) fn nothing(study: &Study<'_>) -> Vec<NothingReturns> {
    let scenes = study.scenes.iter().enumerate();
    scenes.flat_map(|(recording, scene)| nothing_of(recording, scene)).collect()
}

fn nothing_of(recording: usize, scene: &Scene<'_>) -> impl Iterator<Item = NothingReturns> {
    let driven_twice = scene.returns.driven_twice();
    let channels = scene.channels.iter().filter(|channel| channel.returning.is_empty());
    channels.map(move |channel| NothingReturns { recording, channel: channel.name.clone(), driven_twice })
}

fn of_channel(
    study: &Study<'_>,
    recording: usize,
    scene: &Scene<'_>,
    channel: &Channel<'_>,
) -> Vec<Returning> {
    let (factor, unit) = unit(study, channel.kind);
    let mut names: Vec<String> = Vec::new();
    let mut lines = Vec::new();
    for one in &channel.returning {
        names.push(words(study, scene.returns.quantity(*one)));
        lines.push(Returning {
            recording,
            channel: channel.name.clone(),
            state: names.join(", "),
            share: one.share,
            left: one.left * factor,
            unit,
        });
    }
    lines
}

/// The unit in which a channel is spoken of.
fn unit(study: &Study<'_>, kind: Kind) -> (f64, &'static str) {
    match kind {
        Kind::Stage(axis) | Kind::Drive(axis) => axis_unit(study, axis),
        _ if kind.angular(study.equations) => (1.0, "rad"),
        _ => (1.0, "mm"),
    }
}

/// A quantity in words.
pub(super) fn words(study: &Study<'_>, quantity: Quantity) -> String {
    let letter = |axis: usize| &study.equations.axes[axis].letter;
    match quantity {
        Quantity::Position(axis) => format!("position of {}", letter(axis)),
        Quantity::Branch(axis) => format!("position and direction of {}", letter(axis)),
        Quantity::Direction(axis) => format!("direction of {}", letter(axis)),
        Quantity::Way(axis) => format!("travel of {} since its last reversal, and direction", letter(axis)),
        Quantity::Velocity(axis) => format!("velocity of {}", letter(axis)),
        Quantity::Acceleration(axis) => format!("acceleration of {}", letter(axis)),
        Quantity::Path => "place on the path".to_owned(),
        Quantity::Temperature(sensor) => format!("temperature {}", study.sensors[sensor]),
        Quantity::Load(load) => format!("load {}", study.loads[load].0),
    }
}
