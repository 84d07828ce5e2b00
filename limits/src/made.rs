//! Recordings that are made. In: what the simulation drove and read. Out: the recording as if it had been read from its file.

use recording::{AxisChannels, Instrument, Line, Named, PartDatum, Recording};
use simulation::{Channel, Column, Instrument as Reader, Simulated};

/// A simulated recording as if it had been read from its file. Nothing where the instrument cannot be told in a recording: a ballbar
/// without a circle.
pub(crate) fn recording(simulated: Simulated, file: &str) -> Option<Recording> {
    let instrument = set_up(&simulated.instrument)?;
    let axes = simulated.commands.into_iter().zip(simulated.actual);
    let mut recording = Recording {
        file: file.to_owned(),
        title: simulated.title,
        instrument,
        datum: PartDatum::free_where(simulated.free_datum),
        time: simulated.time,
        run: simulated.run,
        axes: axes
            .map(|(command, actual)| AxisChannels { command: Some(command), actual, measured: None })
            .collect(),
        normal: simulated.normals,
        temperatures: simulated.temperatures.into_iter().map(named).collect(),
        loads: simulated.loads.into_iter().map(named).collect(),
        holdout: (!simulated.holdout.is_empty()).then_some(simulated.holdout),
        ..Recording::default()
    };
    for reading in simulated.readings {
        match reading.channel {
            Channel::Measured(direction) => recording.measured[direction] = Some(reading.values),
            Channel::Angle(axis) => recording.axes.get_mut(axis)?.measured = Some(reading.values),
            Channel::Deviation => recording.deviation = Some(reading.values),
        }
    }
    Some(recording)
}

fn named(column: Column) -> Named {
    Named { name: column.name, unit: column.unit, values: column.values }
}

fn set_up(instrument: &Reader) -> Option<Instrument> {
    Some(match *instrument {
        Reader::Position { .. } => Instrument::Position,
        Reader::Ballbar { center, radius, .. } => Instrument::Ballbar { center: center?, radius: radius? },
        Reader::Linear { axis, direction, .. } => Instrument::Linear(Line { axis: Some(axis), direction }),
        Reader::Straightness { axis, direction } => {
            Instrument::Straightness(Line { axis: Some(axis), direction })
        }
        Reader::Angular { axis, about } => Instrument::Angular { axis, about },
        Reader::Probe { .. } => Instrument::Probe,
    })
}
