//! Positioning along straight lines. In: the lines of a path with their approaches. Out: for each the targets, what was read
//! there, and the figures of ISO 230-2; or why there are none.

mod reader;

use crate::NotGiven;
use crate::course::{Course, cell};
use crate::figure::{Figure, Sensor, Unit};
use crate::iso230_2::{Target, TargetFigures, of_axis};
use crate::stations::{Approach, Line, Travelled};
use reader::Reader;

/// The approaches in each direction that the standard asks for.
const RUNS: usize = 5;

/// The fewest targets that the standard asks for on a slide of up to 2 m.
const TARGETS: usize = 5;

/// Positioning along one line: mm or rad.
#[derive(Clone, Debug, PartialEq)]
pub struct Positioning {
    /// The axes that move.
    pub axes: Vec<String>,
    /// What kind of line it is.
    pub kind: Kind,
    /// How each of [`Positioning::axes`] moves for each mm or rad along the line.
    pub direction: Vec<f64>,
    /// Where the other axes stand that have a command: mm, or rad.
    pub at: Vec<(String, f64, Unit)>,
    /// What read it.
    pub sensor: Sensor,
    /// What the deviations count from. B, R, E, M and A do not depend on it.
    pub zero: Zero,
    /// The unit of all of it.
    pub unit: Unit,
    /// The readings of each target, by position.
    pub readings: Vec<Target>,
    /// The figures of each target, in the same order. For an axis a position is that of the axis; on a diagonal it counts along
    /// the line from the place nearest to all zeros.
    pub targets: Vec<TargetFigures>,
    /// Targets that were approached from one side only while others were from both: they do not count.
    pub left_out: Vec<f64>,
    /// The figures.
    pub figures: Vec<Figure>,
    /// What a reader should know, a sentence each.
    pub notes: Vec<String>,
}

/// What kind of line was driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One slide.
    Slide,
    /// One rotary axis.
    Rotary,
    /// Two slides: a face diagonal.
    FaceDiagonal,
    /// Three slides or more: a body diagonal.
    BodyDiagonal,
}

impl Kind {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slide => "linear",
            Self::Rotary => "rotary",
            Self::FaceDiagonal => "face-diagonal",
            Self::BodyDiagonal => "body-diagonal",
        }
    }
}

/// What deviations count from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zero {
    /// The instrument's own zero.
    Instrument,
    /// The nominal position.
    Nominal,
    /// The mean of all readings of the line: the machine's constants are not known.
    Mean,
}

impl Zero {
    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Instrument => "instrument",
            Self::Nominal => "nominal",
            Self::Mean => "mean",
        }
    }
}

/// Readings of a positioning test by targets, as the file of a laser has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cycle {
    /// The file, for people.
    pub file: String,
    /// The machine, for people.
    pub machine: String,
    /// The date, as the file has it.
    pub date: Option<String>,
    /// The letter of the axis.
    pub axis: String,
    /// Whether it is a rotary axis.
    pub rotary: bool,
    /// The targets, ascending, with their deviations: mm, or rad of a rotary axis.
    pub targets: Vec<Target>,
}

/// Evaluates readings by targets; or what cannot be given, and why.
pub(crate) fn of_cycle(cycle: Cycle) -> Result<Positioning, (String, String)> {
    let Cycle { axis, rotary, targets: readings, .. } = cycle;
    let (kind, unit) = if rotary { (Kind::Rotary, Unit::Angle) } else { (Kind::Slide, Unit::Length) };
    let targets: Vec<TargetFigures> = readings.iter().map(TargetFigures::of).collect();
    check(&targets).map_err(|because| (format!("positioning of {axis}"), because))?;
    Ok(Positioning {
        axes: vec![axis],
        kind,
        direction: vec![1.0],
        at: Vec::new(),
        sensor: Sensor::Instrument,
        zero: Zero::Instrument,
        unit,
        figures: of_axis(&targets, unit),
        notes: fewer(&targets, unit),
        left_out: left_out(&targets),
        readings,
        targets,
    })
}

/// Evaluates all lines.
pub(crate) fn evaluate(course: &Course<'_>, travelled: Travelled) -> (Vec<Positioning>, Vec<NotGiven>) {
    let (mut lines, mut without) = (Vec::new(), Vec::new());
    for line in &travelled.lines {
        let targets = distinct(line, line.tolerance());
        if targets < 2 {
            continue;
        }
        match positioning(course, line) {
            Ok(positioning) => lines.push(positioning),
            Err(because) => {
                let reason =
                    NotGiven::new(format!("positioning of {}", names(course, line).join(" and ")), because);
                if !without.contains(&reason) {
                    without.push(reason);
                }
            }
        }
    }
    for (axis, step) in travelled.in_motion {
        let because = format!(
            "{} was read in motion, with a row every {:.3} s; a station holds the same command for at least 0.5 s",
            course.letter(axis),
            step
        );
        without.push(NotGiven::new(format!("positioning of {}", course.letter(axis)), because));
    }
    if travelled.overfull {
        without.push(NotGiven::new(
            "positioning on further lines",
            "the path has more lines than can be distinguished",
        ));
    }
    (lines, without)
}

fn distinct(line: &Line, tolerance: f64) -> usize {
    let mut places: Vec<f64> = line.approaches.iter().map(|approach| approach.at).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|next, one| *next - *one <= tolerance);
    places.len()
}

fn names(course: &Course<'_>, line: &Line) -> Vec<String> {
    line.axes.iter().map(|axis| course.letter(*axis).to_owned()).collect()
}

fn positioning(course: &Course<'_>, line: &Line) -> Result<Positioning, String> {
    let kind = kind(course, line)?;
    let unit = if kind == Kind::Rotary { Unit::Angle } else { Unit::Length };
    let reader = Reader::of(course, line, kind)?;
    let mut readings = targets(course, line, &reader, kind);
    if readings.is_empty() {
        return Err("its stations have no readings".to_owned());
    }
    if reader.zero == Zero::Mean {
        take_mean_off(&mut readings);
    }
    let targets: Vec<TargetFigures> = readings.iter().map(TargetFigures::of).collect();
    check(&targets)?;
    let others = (0..course.positions.len())
        .filter(|axis| course.commanded.get(*axis) == Some(&true) && !line.axes.contains(axis));
    let at = others.map(|axis| {
        let unit = if course.rotary(axis) { Unit::Angle } else { Unit::Length };
        (course.letter(axis).to_owned(), cell(&line.foot, axis), unit)
    });
    Ok(Positioning {
        axes: names(course, line),
        kind,
        direction: line.axes.iter().map(|axis| cell(&line.direction, *axis)).collect(),
        at: at.collect(),
        sensor: reader.sensor,
        zero: reader.zero,
        unit,
        figures: of_axis(&targets, unit),
        notes: notes(line, &targets, unit),
        left_out: left_out(&targets),
        readings,
        targets,
    })
}

/// Refuses targets of which no two were approached from the same side.
fn check(targets: &[TargetFigures]) -> Result<(), String> {
    if targets.iter().filter(|target| target.up.is_some()).count() < 2
        && targets.iter().filter(|target| target.down.is_some()).count() < 2
    {
        return Err("no two stations on one line were approached from the same side".to_owned());
    }
    Ok(())
}

/// The targets that were approached from one side only, where others were from both.
fn left_out(targets: &[TargetFigures]) -> Vec<f64> {
    let both = |target: &&TargetFigures| target.reversal().is_some();
    match targets.iter().filter(both).count() {
        0 => Vec::new(),
        _ => targets.iter().filter(|target| !both(target)).map(|target| target.position).collect(),
    }
}

fn kind(course: &Course<'_>, line: &Line) -> Result<Kind, String> {
    let rotary = line.axes.iter().filter(|axis| course.rotary(**axis)).count();
    match (line.axes.len(), rotary) {
        (1, 0) => Ok(Kind::Slide),
        (1, _) => Ok(Kind::Rotary),
        (2, 0) => Ok(Kind::FaceDiagonal),
        (_, 0) => Ok(Kind::BodyDiagonal),
        _ => Err("a rotary axis moves together with another axis".to_owned()),
    }
}

/// The readings of each target, by position: the mean over the later half of each stand.
fn targets(course: &Course<'_>, line: &Line, reader: &Reader<'_>, kind: Kind) -> Vec<Target> {
    let mut read: Vec<(&Approach, f64)> = line
        .approaches
        .iter()
        .filter_map(|approach| {
            let values = approach
                .rows
                .clone()
                .filter(|row| course.complete(*row))
                .map(|row| reader.at(row, kind))
                .filter(|value| value.is_finite());
            let values: Vec<f64> = values.collect();
            let mean = values.iter().sum::<f64>() / crate::number(values.len());
            mean.is_finite().then_some((approach, mean))
        })
        .collect();
    read.sort_by(|(one, _), (other, _)| one.at.total_cmp(&other.at));
    let mut targets: Vec<Target> = Vec::new();
    for stands in read.chunk_by(|(one, _), (next, _)| next.at - one.at <= line.tolerance()) {
        let side = |up: bool| {
            stands.iter().filter(move |(stand, _)| stand.up == up).map(|(_, value)| *value).collect()
        };
        let position = stands.iter().map(|(stand, _)| stand.at).sum::<f64>() / crate::number(stands.len());
        targets.push(Target { position, up: side(true), down: side(false) });
    }
    targets
}

fn take_mean_off(targets: &mut [Target]) {
    let all = || targets.iter().flat_map(|target| target.up.iter().chain(&target.down));
    let mean = all().sum::<f64>() / crate::number(all().count());
    for target in targets.iter_mut() {
        target.up.iter_mut().chain(&mut target.down).for_each(|deviation| *deviation -= mean);
    }
}

/// What the standard asks for and the readings lack.
fn fewer(targets: &[TargetFigures], unit: Unit) -> Vec<String> {
    let mut notes = Vec::new();
    let both: Vec<&TargetFigures> = targets.iter().filter(|target| target.reversal().is_some()).collect();
    let counted: Vec<&TargetFigures> = if both.is_empty() { targets.iter().collect() } else { both };
    let sides = counted.iter().flat_map(|target| [target.up, target.down]).flatten();
    let fewest = sides.map(|side| side.readings).min().unwrap_or(0);
    if fewest < RUNS {
        notes.push(format!("ISO 230-2 requires {RUNS} approaches to each target in each direction; the fewest here are {fewest}."));
    }
    if unit == Unit::Length && counted.len() < TARGETS {
        notes.push(format!(
            "ISO 230-2 requires at least {TARGETS} targets; there are {} here.",
            counted.len()
        ));
    }
    notes
}

fn notes(line: &Line, targets: &[TargetFigures], unit: Unit) -> Vec<String> {
    let mut notes = fewer(targets, unit);
    if line.approaches.iter().any(|approach| approach.single) {
        notes.push(
            "Each station was read once, so the recording does not show that the axes were at rest."
                .to_owned(),
        );
    }
    if line.assumed() {
        notes.push(
            "The recording does not contain the overrun at the ends. The first place of a run, and a place read twice where \
             the motion reverses, are assumed to be approached as in the cycle of ISO 230-2."
                .to_owned(),
        );
    }
    notes
}
