//! Passes that may be driven besides. In: a recording with its machine. Out: a library of short paths over the same axes, with the same
//! instrument: other feeds, other places, other strokes, circles, and rest.

use recording::Recording;
use simulation::noise::Noise;
use simulation::path::{Path, Shape, Stroke};
use simulation::{Instrument, Measurement, Plant, Scenario, simulate};

use crate::injection::base::Base;
use crate::injection::columns::median;
use crate::injection::state::Axis;
use crate::injection::taken::Outlet;
use crate::made;

/// A path that may be driven besides.
#[derive(Clone, Debug)]
pub struct Move {
    /// What it is: `X from 0 to 400 mm and back at 50 mm/s`.
    pub words: String,
    /// How long it takes, s.
    pub time: f64,
    path: Path,
    instrument: Instrument,
}

/// The most readings of a move: enough for any effect, and as many as a diagnosis is quick with.
const READINGS: f64 = 4000.0;

/// How far an axis is moved to another height where it stood still, mm: more than the lever of a spindle nose, within the travel of most
/// machines.
const FURTHER: f64 = 100.0;

/// How long it rests, s: a warm body settles in some minutes.
const REST: f64 = 600.0;

/// How often a move is driven: one run can be held out.
const RUNS: u32 = 3;

/// All moves for a recording, by axes.
pub fn library(base: &Base) -> Vec<Move> {
    let library = Library { base, rate: rate(base) };
    let mut all = Vec::new();
    for (axis, state) in library.moving() {
        all.extend(library.of_axis(axis, state));
    }
    all.extend(library.circles());
    all.extend(library.rest());
    all.extend(library.other_directions());
    all
}

impl Move {
    /// The move as a recording of the same machine, with noise of this size; nothing where it cannot be driven or read.
    pub fn recorded(&self, base: &Base, noise: f64, seed: u64) -> Option<Base> {
        let plant = Plant::new(&base.compiled.machine, &base.names, base.known()).ok()?;
        let measurement =
            Measurement { noise: Noise::white(noise), seed, ..Measurement::perfect(self.instrument.clone()) };
        let scenario = Scenario {
            title: None,
            path: self.path.clone(),
            temperatures: Vec::new(),
            loads: Vec::new(),
            measurement,
            holdout: vec![i64::from(RUNS)],
        };
        let simulated = simulate(&plant, &scenario).ok()?;
        let mut recording = made::recording(simulated, &self.words)?;
        // What was clamped anew once is clamped anew again.
        recording.datum = base.recording.datum;
        read_by_drives(base, &mut recording);
        Base::new(&self.words, base.compiled.clone(), base.calibration.clone(), recording).ok()
    }
}

/// Where nothing but the drives was read, they are read here too: the simulation's instrument stood in their place.
fn read_by_drives(base: &Base, recording: &mut Recording) {
    for outlet in &base.outlets {
        let Outlet::Actual(axis) = *outlet else { continue };
        let direction = "XYZ".find(base.names.axes[axis].letter.as_str());
        let measured = match direction {
            Some(direction) => recording.measured[direction].take(),
            None => recording.axes[axis].measured.take(),
        };
        recording.axes[axis].actual = measured;
    }
}

/// The rate of a recording's readings, 1/s.
fn rate(base: &Base) -> f64 {
    let step = base.path.clock.step;
    if step > 0.0 { 1.0 / step } else { 1.0 }
}

struct Library<'b> {
    base: &'b Base,
    rate: f64,
}

impl Library<'_> {
    fn moving(&self) -> Vec<(usize, &Axis)> {
        let axes = self.base.path.axes.iter().enumerate();
        axes.filter(|(number, _)| !self.base.names.axes[*number].is_motor())
            .filter_map(|(number, axis)| Some((number, axis.as_ref()?)))
            .filter(|(_, axis)| axis.travel() > 0.0)
            .collect()
    }

    /// Lines along an axis: at other feeds, with each other slide elsewhere, in short strokes.
    fn of_axis(&self, axis: usize, state: &Axis) -> Vec<Move> {
        let [from, to] = state.range;
        let feed = feed(state);
        let whole =
            |feed: f64, at: Option<(usize, f64)>, words: &str| self.line(axis, (from, to), feed, at, words);
        let mut all: Vec<Move> = [(3.0, "three times as fast"), (1.0 / 3.0, "a third as fast")]
            .into_iter()
            .filter_map(|(by, words)| whole(by * feed, None, words))
            .collect();
        for (other, place) in self.elsewhere(axis) {
            all.extend(whole(feed, Some((other, place)), ""));
        }
        let middle = 0.5 * (from + to);
        let stroke = 0.05 * (to - from);
        all.extend(self.line(axis, (middle - stroke, middle + stroke), feed, None, "in short strokes"));
        all
    }

    /// For each other slide a place where the axis was not measured yet: the end of its travel, or further.
    fn elsewhere(&self, axis: usize) -> Vec<(usize, f64)> {
        let slides = (0..self.base.names.axes.len()).filter(|other| *other != axis);
        slides
            .filter(|other| !self.base.names.axes[*other].rotary && !self.base.names.axes[*other].is_motor())
            .map(|other| {
                let range = self.base.path.axes[other].as_ref().map_or([0.0; 2], |axis| axis.range);
                let moved = range[1] - range[0];
                (other, if moved > 0.0 { range[1] } else { range[1] + FURTHER })
            })
            .collect()
    }

    fn line(
        &self,
        axis: usize,
        (from, to): (f64, f64),
        feed: f64,
        at: Option<(usize, f64)>,
        how: &str,
    ) -> Option<Move> {
        let strokes = vec![Stroke { axis, from, to }];
        let shape = Shape::Line { strokes, back: true, overrun: 0.0, stations: None };
        let (unit, per) = self.unit(axis);
        let mut words = format!(
            "{} from {} to {} {unit} and back at {} {unit}/s",
            self.letter(axis),
            crate::size::short(from * per),
            crate::size::short(to * per),
            crate::size::short(feed * per)
        );
        if let Some((other, place)) = at {
            words += &format!(", {} at {} mm", self.letter(other), crate::size::short(place));
        }
        if !how.is_empty() {
            words += &format!(", {how}");
        }
        self.driven(words, shape, feed, at, self.base.instrument().clone())
    }

    /// Circles in the planes of two slides that move.
    fn circles(&self) -> Vec<Move> {
        if !matches!(self.base.instrument(), Instrument::Position { .. }) {
            return Vec::new();
        }
        let slides: Vec<(usize, &Axis)> =
            self.moving().into_iter().filter(|(axis, _)| !self.base.names.axes[*axis].rotary).collect();
        let mut all = Vec::new();
        for (place, (first, one)) in slides.iter().enumerate() {
            for (second, other) in slides.iter().skip(place + 1) {
                let radius = 0.45 * one.travel().min(other.travel());
                let shape = Shape::Circle {
                    plane: [*first, *second],
                    radius,
                    start: 0.0,
                    overshoot: 0.0,
                    counterclockwise: vec![true, false],
                };
                let words = format!(
                    "a circle of {} mm in {}{}, both ways",
                    crate::size::short(radius),
                    self.letter(*first),
                    self.letter(*second)
                );
                let feed = feed(one).min(feed(other));
                all.extend(self.driven(words, shape, feed, None, self.base.instrument().clone()));
            }
        }
        all
    }

    fn rest(&self) -> Option<Move> {
        let words = format!("at rest for {} min", crate::size::short(REST / 60.0));
        self.driven(
            words,
            Shape::Still { time: REST / f64::from(RUNS) },
            1.0,
            None,
            self.base.instrument().clone(),
        )
    }

    /// The lines again, read in all three directions, where an instrument of positions reads fewer.
    fn other_directions(&self) -> Vec<Move> {
        let Instrument::Position { directions, angles } = self.base.instrument() else { return Vec::new() };
        if directions.iter().all(|read| *read) || !self.base.outside() {
            return Vec::new();
        }
        let instrument = Instrument::Position { directions: [true; 3], angles: angles.clone() };
        let line = |(axis, state): (usize, &Axis)| {
            let [from, to] = state.range;
            let again = self.line(axis, (from, to), feed(state), None, "read in all three directions")?;
            Some(Move { instrument: instrument.clone(), ..again })
        };
        self.moving().into_iter().filter_map(line).collect()
    }

    fn driven(
        &self,
        words: String,
        shape: Shape,
        feed: f64,
        at: Option<(usize, f64)>,
        instrument: Instrument,
    ) -> Option<Move> {
        let mut path = Path {
            at: self.middle(at),
            shape,
            feed,
            acceleration: None,
            rate: self.rate,
            runs: RUNS,
            pause: 1.0,
        };
        let rotary: Vec<bool> = self.base.names.axes.iter().map(|axis| axis.rotary).collect();
        let time = path_time(&path, &rotary)?;
        path.rate = self.rate.min(READINGS / time);
        Some(Move { words, time, path, instrument })
    }

    /// Where the axes stand that a move does not drive: where they stood in the middle.
    fn middle(&self, at: Option<(usize, f64)>) -> Vec<Vec<f64>> {
        let place = |number: usize| match at {
            Some((axis, place)) if axis == number => vec![place],
            _ => vec![self.base.path.axes[number].as_ref().map_or(0.0, |axis| median(&axis.position))],
        };
        (0..self.base.names.axes.len()).map(place).collect()
    }

    fn letter(&self, axis: usize) -> &str {
        &self.base.names.axes[axis].letter
    }

    /// The unit in which positions of an axis are told, and its factor.
    fn unit(&self, axis: usize) -> (&'static str, f64) {
        if self.base.names.axes[axis].rotary { ("deg", 360.0 / std::f64::consts::TAU) } else { ("mm", 1.0) }
    }
}

/// How long a path takes, s.
fn path_time(path: &Path, rotary: &[bool]) -> Option<f64> {
    let timeline = path.timeline(rotary).ok()?;
    timeline.instants().last().map(|instant| instant.time).filter(|time| *time > 0.0)
}

/// The usual speed of an axis while it moves.
fn feed(axis: &Axis) -> f64 {
    let fastest = axis.velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let moving: Vec<f64> = axis.velocity.iter().map(|v| v.abs()).filter(|v| *v > 0.1 * fastest).collect();
    let usual = median(&moving);
    if usual > 0.0 { usual } else { axis.travel() / 10.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::passes_of_x;

    #[test]
    fn every_move_can_be_driven_and_read_as_the_recording_was() {
        let base = passes_of_x("FXZ", [true, false, false], 1e-3, 1);
        let library = library(&base);
        assert!(library.len() > 4, "{library:#?}");
        for one in library {
            let recorded = one.recorded(&base, 1e-3, 1).unwrap();
            assert!(one.time > 0.0 && one.time.is_finite(), "{}", one.words);
            let rows = crate::number(recorded.recording.time.len());
            assert!(rows > 5.0 && rows < 1.1 * READINGS * f64::from(RUNS), "{}: {rows} rows", one.words);
            assert!(recorded.recording.measured[0].is_some(), "{}", one.words);
        }
    }

    #[test]
    fn a_slide_that_stood_still_is_moved_to_another_height() {
        let base = passes_of_x("FXZ", [true, false, false], 1e-3, 1);
        let moved = library(&base).into_iter().find(|one| one.words.contains("Z at 100 mm")).unwrap();
        let recorded = moved.recorded(&base, 1e-3, 1).unwrap();
        let z = base.names.axis("Z").unwrap();
        let command = recorded.recording.axes[z].command.as_ref().unwrap();
        assert!(command.iter().all(|place| (place - 100.0).abs() < 1e-12));
    }

    #[test]
    fn the_feed_is_the_usual_speed() {
        let base = passes_of_x("FX", [true, false, false], 1e-3, 1);
        let axis = base.path.axes[0].as_ref().unwrap();
        assert!((feed(axis) - 50.0).abs() < 1.0, "{}", feed(axis));
    }
}
