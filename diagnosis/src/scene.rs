//! Scenes: one recording in the study.
//!
//! In: a recording, the machine that was recorded, a calibration where there is one. Out: its channels, its sensors under the numbers of
//! the study, its blocks of rows, and which of them are held out.

use std::ops::Range;
use std::sync::Arc;

use model_dsl::calibration::{Calibration, SensorReadings};
use model_dsl::equations::Equations;
use model_dsl::exact::ExactProduct;
use model_dsl::program::Interpreter;

use crate::channel::{Channel, Kind, channels};
use crate::course::LastCourse;
use crate::legs::GAP;
use crate::recording::{Instrument, PartPose, Recording, Turned};
use crate::returns::Returns;
use crate::states::{Given, Shared, behind_corners, beside_reversals, unseen_turns};
use crate::targets::Targets;

/// A machine with the values of its constants while one recording was made.
pub(crate) struct Built {
    pub(crate) interpreter: Interpreter,
    /// The same machine without linearisation, for what the calibration says.
    pub(crate) exact: ExactProduct,
}

impl Built {
    pub(crate) fn new(equations: &Equations, constants: &[f64]) -> Arc<Self> {
        let interpreter = Interpreter::new(equations, constants);
        Arc::new(Self { interpreter, exact: ExactProduct::new(equations, constants) })
    }
}

/// One recording in the study.
pub(crate) struct Scene<'a> {
    pub(crate) recording: &'a Recording,
    /// The machine that was recorded: recordings with tools of different lengths differ in a constant.
    pub(crate) built: Arc<Built>,
    pub(crate) given: Given,
    pub(crate) channels: Vec<Channel<'a>>,
    pub(crate) blocks: Vec<Block>,
    /// How long it was observed, s: gaps and pauses left out.
    pub(crate) observed: f64,
    /// Rows that are left out because an axis turned a corner just before, between two rows.
    pub(crate) corners: Vec<bool>,
    /// Axes whose command is an end point; the rows in which they are on their way are left out too.
    pub(crate) targets: Targets,
    /// Whether the axes are at rest in every row, as far as position loops go: rows far apart, which a calibration with
    /// loops explains better so.
    pub(crate) at_rest: bool,
    /// The directions in which the path leaves the plane of a ballbar's centre; the others a ballbar does not show.
    pub(crate) leans: [bool; 3],
    /// How the part lies where it was measured, where that is free.
    pub(crate) pose: Option<PartPose>,
    /// The rotation because of which its datum is taken as free, if the recording has no `datum`.
    pub(crate) turned: Option<Turned>,
    /// The course that was worked out last.
    pub(crate) last_course: LastCourse,
    /// What may come back in it.
    pub(crate) returns: Returns,
}

/// A stretch of rows of one run that is fitted, or held out, as a whole.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Block {
    pub(crate) rows: Range<usize>,
    pub(crate) run: i64,
    pub(crate) held_out: bool,
}

impl<'a> Scene<'a> {
    /// A recording; where it lies and what may come back in it is told once the study holds it.
    pub(crate) fn new(
        recording: &'a Recording,
        equations: &Equations,
        calibration: Option<&Calibration>,
        (sensors, loads): (&[String], &[(String, String)]),
        built: Arc<Built>,
    ) -> Self {
        let rows = recording.time.len();
        let loads = loads.iter().map(|(name, _)| column(&recording.loads, name, rows)).collect();
        let given = Given::new(recording, temperatures(recording, calibration, sensors), loads);
        let letters: Vec<&str> = equations.axes.iter().map(|axis| axis.letter.as_str()).collect();
        let targets = Targets::new(recording, &given, &letters);
        let rounded = Arc::clone(&given.rounded);
        Self {
            // Only the rows in which they have arrived are left.
            at_rest: !targets.axes.is_empty(),
            targets,
            last_course: LastCourse::default(),
            returns: Returns::default(),
            observed: observed(&given),
            corners: corners(recording, &given),
            leans: leans(recording, &given.programmed, &built.interpreter),
            pose: None,
            turned: None,
            built,
            recording,
            given,
            channels: channels(recording, equations, &rounded),
            blocks: blocks(recording),
        }
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> usize {
        self.recording.time.len()
    }

    /// Whether it is read along normals, from one zero.
    pub(crate) fn is_probed(&self) -> bool {
        self.channels.iter().any(|channel| channel.kind == Kind::Normal)
    }

    /// Whether a channel is a drive's own feedback.
    pub(crate) fn has_drives(&self) -> bool {
        self.channels.iter().any(|channel| !channel.kind.outside())
    }

    /// Whether nothing is read off a row, whatever stands in it.
    pub(crate) fn left_out(&self, row: usize) -> bool {
        self.corners[row] || self.targets.on_the_way.get(row) == Some(&true)
    }

    /// Whether rows are so far apart that what a position loop does is over before the next.
    pub(crate) fn sparse(&self) -> bool {
        self.given.step > SPARSE
    }

    /// For each row whether it is fitted, and not held out.
    pub(crate) fn fitted_rows(&self) -> Vec<bool> {
        let mut fitted = vec![true; self.rows()];
        for block in self.blocks.iter().filter(|block| block.held_out) {
            fitted[block.rows.clone()].fill(false);
        }
        fitted
    }

    /// The runs in order of their first rows.
    pub(crate) fn run_numbers(&self) -> Vec<i64> {
        self.recording.run_numbers()
    }
}

fn corners(recording: &Recording, given: &Given) -> Vec<bool> {
    let rows = recording.time.len();
    let any = |each: &dyn Fn(usize, &[f64]) -> Vec<bool>, most: usize| {
        let mut marked = vec![false; rows];
        for (axis, position) in given.programmed.iter().enumerate() {
            marked.iter_mut().zip(each(axis, position)).for_each(|(mark, here)| *mark |= here);
        }
        // A path of such rows only is one that was recorded so; nothing would be left.
        if marked.iter().filter(|mark| **mark).count() > rows / most { vec![false; rows] } else { marked }
    };
    let at_corners = |axis: usize, position: &[f64]| {
        let of = if given.rounded[axis] > 0.0 { beside_reversals } else { behind_corners };
        of(&recording.time, &given.legs, position)
    };
    let mut corners = any(&at_corners, MOST_CORNERS);
    if given.step > SPARSE {
        let turns = any(&|_, position| unseen_turns(&given.legs, position), MOST_TURNS);
        corners.iter_mut().zip(turns).for_each(|(corner, turn)| *corner |= turn);
    }
    corners
}

/// The time of all steps that are no gaps.
fn observed(given: &Given) -> f64 {
    let longest = GAP * given.step;
    given.time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step <= longest).sum()
}

/// At most one row in 20 may be left out because it is behind a corner. A sound path has a few rows behind each reversal; where there are
/// more, the path is one of corners, and to leave them out would leave its reversals out.
const MOST_CORNERS: usize = 20;
/// At most one row in 3 may be left out because an axis may have turned there unseen. Sparse rows have one or two of them at each end of
/// a pass; a path whose every row may be one has no pass that could be trusted more than another.
const MOST_TURNS: usize = 3;

/// A ballbar that leans less than this share of its length into a direction shows nothing of it: 1 um there is 0.02 um along the bar, less
/// than ballbars resolve.
const LEANS: f64 = 0.02;

fn leans(recording: &Recording, programmed: &[Shared], interpreter: &Interpreter) -> [bool; 3] {
    let Instrument::Ballbar { center, radius } = recording.instrument else { return [true; 3] };
    let positions: Vec<&[f64]> = programmed.iter().map(|position| &**position).collect();
    let nominal = interpreter.nominal_columns(&positions);
    [0, 1, 2].map(|d| nominal[d].iter().any(|place| (place - center[d]).abs() > LEANS * radius))
}

/// A channel by name with its gaps bridged; NaN everywhere where it was not recorded.
fn column(channels: &[crate::recording::Named], name: &str, rows: usize) -> Vec<f64> {
    let channel = channels.iter().find(|channel| channel.name == name);
    channel.map_or_else(|| vec![f64::NAN; rows], |channel| bridged(&channel.values))
}

/// Gaps bridged by straight lines over rows, and held at the ends: temperatures and loads change slowly between samples.
fn bridged(values: &[f64]) -> Vec<f64> {
    let mut bridged = values.to_vec();
    let mut last: Option<usize> = None;
    for row in 0..bridged.len() {
        if !values[row].is_finite() {
            continue;
        }
        let from = last.map_or(0, |last| last + 1);
        let start = last.map_or(values[row], |last| values[last]);
        let span = crate::number(row - from + 1);
        for (step, gap) in (from..row).enumerate() {
            bridged[gap] = start + (values[row] - start) * crate::number(step + 1) / span;
        }
        last = Some(row);
    }
    if let Some(last) = last {
        let held = values[last];
        bridged[last..].fill(held);
    }
    bridged
}

/// The temperatures of all sensors of the study, the calibration's derived ones worked out row by row.
fn temperatures(
    recording: &Recording,
    calibration: Option<&Calibration>,
    sensors: &[String],
) -> Vec<Vec<f64>> {
    let rows = recording.time.len();
    let mut columns: Vec<Vec<f64>> =
        sensors.iter().map(|name| column(&recording.temperatures, name, rows)).collect();
    if let Some(calibration) = calibration {
        let inputs = columns.clone();
        let mut readings = SensorReadings::new(&calibration.sensors);
        for row in 0..rows {
            let now = readings.update(|sensor| inputs[sensor][row]);
            for (column, value) in columns.iter_mut().zip(now) {
                column[row] = *value;
            }
        }
    }
    columns
}

/// The step between rows, s, from which on a recording is sparse. A position loop of 25 1/s, slow for a machine tool, has settled to less
/// than a hundredth within it.
const SPARSE: f64 = 0.2;

/// How many blocks the rows that are fitted are cut into, at least.
const BLOCKS: usize = 12;
/// The fewest rows of a block.
const BLOCK_ROWS: usize = 8;
/// One block in four is held out where the recording names no runs for it.
const HELD_OUT_EVERY: usize = 4;

/// Runs cut into blocks; those of held-out runs, or else one of every four blocks, are held out.
fn blocks(recording: &Recording) -> Vec<Block> {
    let runs = recording.runs();
    let several = runs.len() > 1;
    let pieces = BLOCKS.div_ceil(runs.len().max(1)).max(2);
    let mut blocks = Vec::new();
    for (rows, run) in runs {
        let pieces = pieces.min(rows.len() / BLOCK_ROWS).max(1);
        let bounds = |piece: usize| rows.start + rows.len() * piece / pieces;
        blocks.extend((0..pieces).map(|piece| Block {
            rows: bounds(piece)..bounds(piece + 1),
            run,
            held_out: recording.holdout.as_ref().is_some_and(|held| held.contains(&run)),
        }));
    }
    if recording.holdout.is_none() && blocks.len() >= HELD_OUT_EVERY {
        // Where runs have whole groups of blocks, another one each time: what comes round with every run would hold out the
        // same quadrant for ever.
        let turn = usize::from(pieces.is_multiple_of(HELD_OUT_EVERY) && several);
        let first = first_held_out(recording, &blocks, turn);
        for number in held_out(blocks.len(), first, turn) {
            blocks[number].held_out = true;
        }
    }
    blocks
}

/// The blocks that are held out: one of each group, in the first group the one of this number, and in each next group `turn` further.
fn held_out(blocks: usize, first: usize, turn: usize) -> impl Iterator<Item = usize> {
    let groups = 0..blocks.div_ceil(HELD_OUT_EVERY);
    let number = move |group| group * HELD_OUT_EVERY + (first + turn * group) % HELD_OUT_EVERY;
    groups.map(number).filter(move |number| *number < blocks)
}

/// Which block of the first group is held out: the third, unless next to none of the changes of speed lie in the blocks that are then held
/// out. What an axis does when it speeds up or turns can only be tested where it does. Then it is the one with which most nearly their
/// share of the blocks does.
fn first_held_out(recording: &Recording, blocks: &[Block], turn: usize) -> usize {
    let changes = changes_of_speed(recording);
    let whole: f64 = changes.iter().sum();
    let share = |first: usize| {
        let held = held_out(blocks.len(), first, turn).flat_map(|number| blocks[number].rows.clone());
        held.map(|row| changes[row]).sum::<f64>() / whole
    };
    let usual = HELD_OUT_EVERY / 2;
    let fair = 1.0 / crate::number(HELD_OUT_EVERY);
    if whole <= 0.0 || share(usual) >= LITTLE * fair {
        return usual;
    }
    // What happens before the first fitted row or behind the last is foretold by nothing.
    let is_inside = |first: usize| {
        held_out(blocks.len(), first, turn).all(|number| number > 0 && number + 1 < blocks.len())
    };
    // At least as much is left to be fitted as is held out.
    let off = |first: usize| match share(first) {
        share if share > 0.5 || !is_inside(first) => f64::INFINITY,
        share => (share / fair).ln().abs(),
    };
    (0..HELD_OUT_EVERY).fold(usual, |best, first| if off(first) < off(best) { first } else { best })
}

/// The part of its fair share of the changes of speed that the held-out blocks must have. With half of it they can still tell.
const LITTLE: f64 = 0.5;

/// In each row how much the speeds of the axes change there, squared, as a share of the whole of each axis.
fn changes_of_speed(recording: &Recording) -> Vec<f64> {
    let (time, run) = (&recording.time, &recording.run);
    let mut changes = vec![0.0; time.len()];
    for position in recording.axes.iter().filter_map(|axis| axis.position()) {
        let speed = |from: usize| (position[from + 1] - position[from]) / (time[from + 1] - time[from]);
        let change = |row: usize| match row > 0 && row + 1 < time.len() && run[row - 1] == run[row + 1] {
            true => Some((speed(row) - speed(row - 1)).powi(2)).filter(|change| change.is_finite()),
            false => None,
        };
        let of_axis: Vec<f64> = (0..time.len()).map(|row| change(row).unwrap_or(0.0)).collect();
        let whole: f64 = of_axis.iter().sum();
        if whole > 0.0 {
            changes.iter_mut().zip(of_axis).for_each(|(sum, change)| *sum += change / whole);
        }
    }
    changes
}

#[cfg(test)]
mod tests;
