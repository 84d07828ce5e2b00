//! Channels: what was observed, and in which direction.
//!
//! In: a recording. Out: its channels, each a number in each row, with what the instrument behind it shows of the machine.

use std::borrow::Cow;

use model_dsl::equations::Equations;

use crate::coarse::{self, Coarse};
use crate::noise;
use crate::recording::{AngleUnit, Instrument, Recording};
use crate::returns::Return;
use crate::rounded;

/// A channel of a recording, by the numbers of both.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ChannelAt {
    pub(crate) scene: usize,
    pub(crate) channel: usize,
}

/// One observed quantity: a number with a direction in each row.
#[derive(Clone, Debug)]
pub(crate) struct Channel<'a> {
    /// The channel's name in the recording.
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// mm or rad; NaN where it is missing, and where it is coarse.
    pub(crate) values: Cow<'a, [f64]>,
    /// Readings that are left out because the display shows them coarser than the others.
    pub(crate) coarse: Option<Coarse>,
    /// Standard deviation, mm or rad, of the rounding of its values and of the commands from which it is predicted.
    pub(crate) rounding: f64,
    /// The states of which some function predicts what the calibration leaves of it.
    pub(crate) returning: Vec<Return>,
}

impl Channel<'_> {
    /// The step of its display.
    pub(crate) fn step(&self) -> f64 {
        rounded::step(self.rounding)
    }
}

/// What a channel observes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// The tool tip in one direction of the part's frame.
    Tip(usize),
    /// The distance of the tool tip from a centre, minus a radius.
    Radius { center: [f64; 3], radius: f64 },
    /// The error of the tool tip along a direction.
    Along([f64; 3]),
    /// The error of the tool tip along the normal in each row.
    Normal,
    /// The rotation of the tool relative to the part about a direction.
    Turn([f64; 3]),
    /// The angle of a rotary axis.
    Stage(usize),
    /// The drive's own feedback of an axis.
    Drive(usize),
}

impl Kind {
    /// Whether an instrument outside the drive reads it.
    pub(crate) fn outside(self) -> bool {
        !matches!(self, Self::Drive(_))
    }

    /// Whether channels of two recordings read the same quantity. Axes, and directions of the part's frame, must be the same. Readings
    /// of a ballbar, along a line, along normals and of a rotation match in any direction.
    pub(crate) fn reads_as(self, other: Self) -> bool {
        match (self, other) {
            (Self::Tip(one), Self::Tip(two))
            | (Self::Stage(one), Self::Stage(two))
            | (Self::Drive(one), Self::Drive(two)) => one == two,
            (Self::Radius { .. }, Self::Radius { .. })
            | (Self::Along(_), Self::Along(_))
            | (Self::Normal, Self::Normal)
            | (Self::Turn(_), Self::Turn(_)) => true,
            _ => false,
        }
    }

    /// Whether it is an angle.
    pub(crate) fn angular(self, equations: &Equations) -> bool {
        match self {
            Self::Turn(_) | Self::Stage(_) => true,
            Self::Drive(axis) => equations.axes.get(axis).is_some_and(|axis| axis.rotary),
            _ => false,
        }
    }
}

/// The channels of a recording. `command_steps` has the step to which each axis's command was rounded, mm or rad.
pub(crate) fn channels<'a>(
    recording: &'a Recording,
    equations: &Equations,
    command_steps: &[f64],
) -> Vec<Channel<'a>> {
    let mut channels = Vec::new();
    let mut add = |name: String, kind: Kind, values: &'a [f64], position: Option<&[f64]>| {
        let unit = if kind.angular(equations) { radians_per_unit(recording) } else { 1.0 };
        let rounding = command_rounding(kind, equations, command_steps);
        channels.push(channel((name, kind), (values, position), unit, rounding));
    };
    for (direction, values) in recording.measured.iter().enumerate() {
        if let Some(values) = values {
            let letter = ["X", "Y", "Z"][direction];
            let axis = equations.axes.iter().position(|axis| axis.letter == letter);
            let position = axis.and_then(|axis| recording.axes.get(axis)?.position());
            add(format!("measured.{}", letter.to_lowercase()), Kind::Tip(direction), values, position);
        }
    }
    if let Some(values) = &recording.deviation {
        let kind = match &recording.instrument {
            Instrument::Position | Instrument::Probe => Kind::Normal,
            Instrument::Ballbar { center, radius } => Kind::Radius { center: *center, radius: *radius },
            Instrument::Linear(line) | Instrument::Straightness(line) => Kind::Along(line.direction),
            Instrument::Angular { about, .. } => Kind::Turn(*about),
        };
        add("deviation".to_owned(), kind, values, None);
    }
    for (axis, known) in recording.axes.iter().enumerate() {
        let letter = equations.axes.get(axis).map(|axis| axis.letter.to_lowercase()).unwrap_or_default();
        // A measured position is a reading only if another channel gives the axis's position.
        if let Some(values) = &known.measured
            && (known.command.is_some() || known.actual.is_some())
        {
            add(format!("measured.{letter}"), Kind::Stage(axis), values, known.position());
        }
        if let (Some(values), Some(_)) = (&known.actual, &known.command) {
            add(format!("actual.{letter}"), Kind::Drive(axis), values, known.position());
        }
    }
    channels
}

/// One channel. `position` is the known position of the axis whose position it reads; `None` for a channel of errors. `unit` is the unit
/// of the display, mm or rad, and `command_rounding` what rounded commands add to its prediction.
fn channel<'a>(
    (name, kind): (String, Kind),
    (values, position): (&'a [f64], Option<&[f64]>),
    unit: f64,
    command_rounding: f64,
) -> Channel<'a> {
    let coarse = position.and_then(|position| coarse::coarse(values, position, unit));
    let values = match &coarse {
        Some(coarse) => Cow::Owned(coarse::without(values, coarse)),
        None => Cow::Borrowed(values),
    };
    let rounding = noise::rounding(&values).hypot(command_rounding);
    Channel { name, kind, values, coarse, rounding, returning: Vec::new() }
}

/// The standard deviation that rounded commands add to the prediction of a channel, mm or rad.
fn command_rounding(kind: Kind, equations: &Equations, command_steps: &[f64]) -> f64 {
    let enters = |axis: usize| match kind {
        Kind::Drive(own) | Kind::Stage(own) => axis == own,
        // A slide moves the tip by as much as it moves. How far a rotary axis moves it depends on the machine.
        _ => !kind.angular(equations) && equations.axes.get(axis).is_some_and(|axis| !axis.rotary),
    };
    let steps = command_steps.iter().enumerate().filter(|(axis, _)| enters(*axis));
    steps.map(|(_, step)| rounded::deviation(*step)).fold(0.0, f64::hypot)
}

/// How many rad the unit is in which the recording gives angles.
fn radians_per_unit(recording: &Recording) -> f64 {
    match recording.angle_unit {
        AngleUnit::Degree => 1f64.to_radians(),
        AngleUnit::Radian => 1.0,
    }
}
