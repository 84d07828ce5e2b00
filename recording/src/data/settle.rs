//! From a table of channels to a [`Recording`].

use std::collections::BTreeSet;

use model_dsl::quantity::Dimension;

use super::super::channel::{Channel, ChannelKind};
use super::super::direction::unit;
use super::super::header::HELD_OUT;
use super::super::{AngleUnit, AxisChannels, Header, Named, Recording};
use super::columns::Table;
use super::error::DataError;

/// Normals whose length is off one by more than this are told of.
const LENGTH_OFF: f64 = 1e-3;

/// Puts every column in its place.
pub(super) fn settle(
    header: &Header,
    table: Table<'_>,
    name: &str,
    notes: Vec<String>,
) -> Result<Recording, DataError> {
    check_holdout(header, &table, name)?;
    let rows = table.time.len();
    let mut recording = Recording {
        file: name.to_owned(),
        title: header.title.clone(),
        date: header.date,
        instrument: header.instrument.clone(),
        datum: header.datum,
        axes: vec![AxisChannels::default(); header.axes.len()],
        constants: header.constants.clone(),
        holdout: header.holdout.as_ref().map(|held| held.iter().map(|run| run.value).collect()),
        angle_unit: angle_unit(&header.channels),
        notes,
        ..Recording::default()
    };
    if let Some((run, count)) = table.restarted {
        recording.notes.push(restarted(name, run, count));
    }
    let mut normals: [Option<Vec<f64>>; 3] = [None, None, None];
    for (channel, values) in table.values {
        put(&mut recording, &mut normals, channel, values);
    }
    place_motors(&mut recording.axes, &header.follows, rows);
    recording.normal = match header.normal {
        Some(direction) => Some(direction.map(|component| vec![component; rows])),
        None => unit_normals(normals, rows, name, &mut recording.notes)?,
    };
    recording.time = table.time;
    recording.run = table.run;
    Ok(recording)
}

fn put(recording: &mut Recording, normals: &mut [Option<Vec<f64>>; 3], channel: &Channel, values: Vec<f64>) {
    let unit = channel.unit.map_or_else(String::new, |unit| match unit.value.dimension {
        Dimension::TEMPERATURE => "degC".to_owned(),
        other => other.internal_unit(),
    });
    let axes = &mut recording.axes;
    match &channel.kind {
        ChannelKind::Time | ChannelKind::Run => {}
        ChannelKind::Command(axis) => fill(axes, *axis, |axis| &mut axis.command, values),
        ChannelKind::Actual(axis) => fill(axes, *axis, |axis| &mut axis.actual, values),
        ChannelKind::MeasuredAngle(axis) => fill(axes, *axis, |axis| &mut axis.measured, values),
        ChannelKind::Measured(direction) => fill(&mut recording.measured, *direction, |slot| slot, values),
        ChannelKind::Normal(direction) => fill(normals, *direction, |slot| slot, values),
        ChannelKind::Deviation => recording.deviation = Some(values),
        ChannelKind::Temperature(name) => {
            recording.temperatures.push(Named { name: name.clone(), unit, values });
        }
        ChannelKind::Load(name) => recording.loads.push(Named { name: name.clone(), unit, values }),
    }
}

/// Motors stand where their axes put them, where anything is known of these.
fn place_motors(axes: &mut [AxisChannels], follows: &[Vec<(usize, f64)>], rows: usize) {
    for (number, follows) in follows.iter().enumerate().filter(|(_, follows)| !follows.is_empty()) {
        let known = |axis: &usize| axes.get(*axis).is_some_and(|axis| axis.position().is_some());
        if !follows.iter().any(|(axis, _)| known(axis)) {
            continue;
        }
        let mut stands = vec![0.0; rows];
        for (axis, weight) in follows {
            let position = axes.get(*axis).map(|axis| axis.position_or_zero(rows)).unwrap_or_default();
            stands.iter_mut().zip(position.iter()).for_each(|(sum, position)| *sum += weight * position);
        }
        if let Some(motor) = axes.get_mut(number) {
            motor.command = Some(stands);
        }
    }
}

fn fill<T>(slots: &mut [T], index: usize, slot: impl Fn(&mut T) -> &mut Option<Vec<f64>>, values: Vec<f64>) {
    if let Some(found) = slots.get_mut(index) {
        *slot(found) = Some(values);
    }
}

/// Normals of length one; a component that no channel gives is zero. NaN in all where one is missing.
fn unit_normals(
    normals: [Option<Vec<f64>>; 3],
    rows: usize,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Option<[Vec<f64>; 3]>, DataError> {
    if normals.iter().all(Option::is_none) {
        return Ok(None);
    }
    let mut normals = normals.map(|normal| normal.unwrap_or_else(|| vec![0.0; rows]));
    let mut off = 0_usize;
    for row in 0..rows {
        let found = normals.each_ref().map(|normal| normal.get(row).copied().unwrap_or(f64::NAN));
        let length = found.iter().map(|component| component * component).sum::<f64>().sqrt();
        let settled = if length.is_nan() { Some([f64::NAN; 3]) } else { unit(found) };
        let Some(settled) = settled else {
            let message = format!("the normal of row {} below the header has length zero", row + 1);
            let help = "write a direction, such as 0, 0, 1, or leave the cells empty if nothing was measured";
            return Err(DataError::new(name, message).help(help));
        };
        off += usize::from((length - 1.0).abs() > LENGTH_OFF);
        for (normal, component) in normals.iter_mut().zip(settled) {
            if let Some(slot) = normal.get_mut(row) {
                *slot = component;
            }
        }
    }
    if off > 0 {
        notes.push(format!("{name}: {off} normals do not have length one; only their directions are used"));
    }
    Ok(Some(normals))
}

fn restarted(name: &str, run: i64, count: usize) -> String {
    let more = if count > 1 { format!(", and {} later ones,", count - 1) } else { String::new() };
    format!(
        "{name}: run {run}{more} begins before the end of the run before it; the runs are placed one after another, with unknown pauses between them"
    )
}

/// The runs that are held out must be there, and others too.
fn check_holdout(header: &Header, table: &Table<'_>, name: &str) -> Result<(), DataError> {
    let Some(held) = &header.holdout else { return Ok(()) };
    let runs: BTreeSet<i64> = table.run.iter().copied().collect();
    let listed = || runs.iter().take(24).map(i64::to_string).collect::<Vec<_>>().join(", ");
    if let Some(absent) = held.iter().find(|run| !runs.contains(&run.value)) {
        let message = format!("run {} is to be held out, but does not exist", absent.value);
        let error = DataError::new(name, message).in_recording(Some((HELD_OUT, absent.span)));
        return Err(error.help(format!("the runs are {}", listed())));
    }
    if runs.iter().all(|run| held.iter().any(|held| held.value == *run)) {
        let place = held.first().map(|first| (HELD_OUT, first.span));
        let error = DataError::new(name, "all runs are held out, so none is left to fit").in_recording(place);
        return Err(error.help(format!("hold out only some of the runs {}", listed())));
    }
    Ok(())
}

/// The unit of the first angle that people would read.
fn angle_unit(channels: &[Channel]) -> AngleUnit {
    let angles = channels
        .iter()
        .filter(|channel| channel.unit.is_some_and(|unit| unit.value.dimension == Dimension::ANGLE));
    let position = angles.clone().find(|channel| channel.kind != ChannelKind::Deviation);
    let written = position.or_else(|| angles.clone().next()).map(|channel| channel.written_unit.as_str());
    match written {
        Some(unit) if !unit.ends_with("rad") => AngleUnit::Degree,
        _ => AngleUnit::Radian,
    }
}
