//! Gross mistakes of a set-up: what is said before anything is diagnosed, since every finding beside them would be wrong.
//!
//! In: a study, and what the instruments' settings alone leave. Out: the reason why nothing can be claimed, where there is one.

use crate::audit::gross;
use crate::channel::{Channel, Kind};
use crate::diagnosis::Change;
use crate::model::{Fitted, Model};
use crate::noise;
use crate::recording::Instrument;
use crate::report::figure::size;
use crate::scene::Scene;
use crate::study::Study;
use crate::terms::Setting;
use crate::zeros;

/// Why nothing can be claimed of a set-up in which something does not fit the recording, whatever the readings leave.
pub(super) fn mistake(study: &Study<'_>) -> Option<String> {
    impossible(study)
        .or_else(|| misplaced(study))
        .or_else(|| dead(study))
        .or_else(|| beside_the_motion(study))
        .or_else(|| exchanged(study))
}

/// Why nothing can be claimed: a channel is read wrongly.
pub(super) struct Misread {
    pub(super) reason: String,
    /// The change that would make it follow its path.
    pub(super) change: Change,
}

/// A channel that lies far off its path and would follow it if one thing of its set-up were changed. This is asked first: an axis that
/// seems to move while its command stands may be another axis.
pub(super) fn misread(study: &Study<'_>) -> Option<Misread> {
    study.channels().find_map(|at| {
        let channel = study.channel(at);
        let change = gross::change(study, at, far_off(study, at.scene, channel))?;
        let file = &study.scenes[at.scene].recording.file;
        let reason = format!(
            "`{}` of {file} does not follow the programmed path, and it seems that {}",
            channel.name, change.fault
        );
        Some(Misread { reason, change })
    })
}

/// Why what was observed cannot be this machine on this path, where that is so: half of the samples of a channel lie far off,
/// against the travel. No error of a machine is as large; a wrong unit, a wrong column and a wrong axis are.
pub(super) fn astray(study: &Study<'_>, bare: &Model) -> Option<String> {
    let far = off_by(study, bare).find(|off| off.median > off.slack + FAR_OFF_OF_TRAVEL * off.travel)?;
    Some(format!(
        "`{}` of {} does not follow the programmed path: half of its samples deviate by more than {:.3}; check its column, its unit and \
         the axes",
        far.channel.name, far.file, far.median
    ))
}

/// What is doubtful where an error is read that is larger than those of machine tools, and not so large that no machine has it.
pub(super) fn doubtful(study: &Study<'_>, bare: &Model) -> Vec<String> {
    let errors = off_by(study, bare)
        .filter(|off| matches!(off.channel.kind, Kind::Along(_) | Kind::Normal | Kind::Turn(_)));
    let large = errors.filter(|off| off.median > off.slack + DOUBTFUL_OF_TRAVEL * off.travel);
    let told = |off: Off<'_>| {
        let unit = if off.channel.kind.angular(study.equations) { "rad" } else { "mm" };
        format!(
            "Half of the samples of `{}` of {} deviate by more than {}. Errors of machine tools are smaller, and the recording does not \
             show whether the unit of the column is right.",
            off.channel.name,
            off.file,
            size(off.median, unit)
        )
    };
    large.map(told).collect()
}

/// How far a channel is off its path.
struct Off<'s> {
    file: &'s str,
    channel: &'s Channel<'s>,
    /// By which half of its samples are off at least, mm or rad.
    median: f64,
    /// What an error may be wherever the axes are, mm or rad.
    slack: f64,
    /// The longest travel of an axis, mm or rad.
    travel: f64,
}

/// How far all channels are off their paths.
fn off_by<'s>(study: &'s Study<'_>, bare: &Model) -> impl Iterator<Item = Off<'s>> {
    let all = study.scenes.iter().zip(zeros::residuals(study, bare));
    all.flat_map(move |(scene, residuals)| {
        scene.channels.iter().zip(residuals).map(move |(channel, residual)| {
            let mut sizes: Vec<f64> =
                residual.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
            let median = noise::middle(&mut sizes).unwrap_or_default();
            let file = scene.recording.file.as_str();
            Off { file, channel, median, slack: slack(study, channel), travel: travel(scene) }
        })
    })
}

/// How far off is too far for an error of a machine, mm or rad.
fn far_off(study: &Study<'_>, scene: usize, channel: &Channel<'_>) -> f64 {
    slack(study, channel) + FAR_OFF_OF_TRAVEL * travel(&study.scenes[scene])
}

fn slack(study: &Study<'_>, channel: &Channel<'_>) -> f64 {
    if channel.kind.angular(study.equations) { FAR_OFF.1 } else { FAR_OFF.0 }
}

fn travel(scene: &Scene<'_>) -> f64 {
    let axes = scene.recording.axes.iter();
    axes.filter_map(|axis| axis.command.as_deref()).map(range).fold(0.0, f64::max)
}

/// Why no machine can have gone the programmed path, where that is so: farther or faster than any axis goes. Metres for millimetres
/// and milliseconds for seconds do that.
fn impossible(study: &Study<'_>) -> Option<String> {
    for scene in &study.scenes {
        for (axis, position) in study.equations.axes.iter().zip(scene.given.programmed.iter()) {
            let (farthest, fastest, unit) =
                if axis.rotary { (f64::INFINITY, FASTEST.1, "rad") } else { (FARTHEST, FASTEST.0, "mm") };
            let (travel, speed) = (range(position), speed(&scene.given.time, position));
            if travel <= farthest && speed <= fastest {
                continue;
            }
            let does = if travel > farthest {
                format!("goes {:.0} m", 1e-3 * travel)
            } else {
                format!("moves at {speed:.0} {unit}/s")
            };
            return Some(format!(
                "the command of {} in {} {does}, which no machine does; check the units of its column and of time",
                axis.letter, scene.recording.file
            ));
        }
    }
    None
}

/// The speed of an axis in the middle of the rows in which it moves. A single jump says nothing of it.
fn speed(time: &[f64], position: &[f64]) -> f64 {
    let steps = time.windows(2).zip(position.windows(2));
    let mut speeds: Vec<f64> = steps
        .map(|(time, place)| ((place[1] - place[0]) / (time[1] - time[0])).abs())
        .filter(|speed| speed.is_finite() && *speed > 0.0)
        .collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get(speeds.len() / 2).copied().unwrap_or_default()
}

/// The longest travel, mm: the beds of the longest gantry mills have a hundred metres.
const FARTHEST: f64 = 2e5;
/// The highest speed, mm/s and rad/s: linear motors reach 5 m/s, a lathe's spindle as an axis 10 000 turns a minute.
const FASTEST: (f64, f64) = (1e4, 2e3);

/// Why a ballbar cannot have stood where its set-up says, where that is so: the programmed path keeps another distance from its
/// centre than the bar is long, by more than bars can read.
fn misplaced(study: &Study<'_>) -> Option<String> {
    for scene in &study.scenes {
        let Instrument::Ballbar { center, radius } = scene.recording.instrument else { continue };
        let positions: Vec<&[f64]> = scene.given.programmed.iter().map(|position| &position[..]).collect();
        let tip = scene.built.interpreter.nominal_columns(&positions);
        let distance = |row: usize| (0..3).map(|d| (tip[d][row] - center[d]).powi(2)).sum::<f64>().sqrt();
        let mut distances: Vec<f64> = (0..scene.rows()).map(distance).filter(|far| far.is_finite()).collect();
        distances.sort_by(f64::total_cmp);
        let Some(median) = distances.get(distances.len() / 2) else { continue };
        if (median - radius).abs() > BAR_READS + BAR_READS_OF_LENGTH * radius {
            let center = center.map(|value| format!("{value:.3}")).join(", ");
            return Some(format!(
                "the ballbar of {} is {radius:.3} mm long, and the programmed path is {median:.3} mm from its centre ({center}) \
                 mm; check the centre, which is that of the nominal tip with the tool's offset, the radius, and the machine's \
                 constants",
                scene.recording.file
            ));
        }
    }
    None
}

/// Why a sensor is dead, where that is so: no reading of any channel ever changes.
fn dead(study: &Study<'_>) -> Option<String> {
    let constant = |channel: &Channel<'_>| range(&channel.values) == 0.0;
    let first = study.scenes.iter().find(|scene| !scene.channels.is_empty())?;
    let all = study.scenes.iter().flat_map(|scene| &scene.channels).all(constant);
    all.then(|| {
        let channel = &first.channels[0];
        let value = channel.values.iter().find(|value| value.is_finite()).copied().unwrap_or_default();
        format!(
            "no reading of {} ever changes: `{}` is {value} in all rows; check the sensor and its column",
            first.recording.file, channel.name
        )
    })
}

/// Why an instrument cannot have been set up as its set-up says, where that is so: the axis that it names stands, and another moves.
fn beside_the_motion(study: &Study<'_>) -> Option<String> {
    study.scenes.iter().find_map(|scene| {
        let (Instrument::Linear(line) | Instrument::Straightness(line)) = &scene.recording.instrument else {
            return None;
        };
        let named = line.axis?;
        let moves = |axis: &usize| range(&scene.given.programmed[*axis]) > 0.0;
        let moving: Vec<usize> = (0..study.equations.axes.len()).filter(moves).collect();
        let letter = |axis: &usize| study.equations.axes[*axis].letter.as_str();
        let letters: Vec<&str> = moving.iter().map(letter).collect();
        (!moving.is_empty() && !moving.contains(&named)).then(|| {
            format!(
                "the set-up of the instrument in {} names {} as the axis that moves, but there only {} moves; correct \
                 `setup: {{axis}}`, or add the command of {}",
                scene.recording.file,
                letter(&named),
                letters.join(" and "),
                letter(&named)
            )
        })
    })
}

/// Why a reading and its command seem to be exchanged, where that is so: the readings are round numbers, such as targets are, the command
/// is not, and both agree far more closely than a display of such a step could show.
fn exchanged(study: &Study<'_>) -> Option<String> {
    study.scenes.iter().find_map(|scene| {
        scene.channels.iter().find_map(|channel| {
            let axis = own_axis(study, channel)?;
            let command = &scene.given.programmed[axis];
            let step = noise::display_step(&channel.values);
            are_targets(&channel.values, command, step).then(|| {
                let letter = study.equations.axes[axis].letter.to_lowercase();
                format!(
                    "`{name}` of {file} has round numbers only, and `command.{letter}` has the deviations from them: the two columns \
                     seem to be exchanged; exchange them, or, where an instrument gives known places (a step gauge), write those \
                     with all their digits",
                    name = channel.name,
                    file = scene.recording.file
                )
            })
        })
    })
}

/// The axis of which a channel reads the position.
fn own_axis(study: &Study<'_>, channel: &Channel<'_>) -> Option<usize> {
    match channel.kind {
        Kind::Stage(axis) | Kind::Drive(axis) => Some(axis),
        Kind::Tip(direction) => {
            study.equations.axes.iter().position(|axis| axis.letter == ["X", "Y", "Z"][direction])
        }
        _ => None,
    }
}

/// Whether readings that are multiples of a step cannot come from a display of that step: they agree with a command, up to a zero, more
/// closely than such a display shows it by chance. The command does not go by multiples of the step: the readings of targets that do all
/// lie alike in their steps.
fn are_targets(values: &[f64], command: &[f64], step: f64) -> bool {
    let rows = values.iter().zip(command).filter(|(value, command)| value.is_finite() && command.is_finite());
    let (readings, commands): (Vec<f64>, Vec<f64>) = rows.unzip();
    let Some(first) = commands.first() else { return false };
    let away: Vec<f64> = readings.iter().zip(&commands).map(|(value, command)| value - command).collect();
    let ways: Vec<f64> = commands.iter().map(|command| command - first).collect();
    within(range(&away) / step, places(&readings, step)) < CHANCE && noise::display_step(&ways) < FINER * step
}

/// The probability that `count` independent numbers, uniformly distributed between 0 and 1, span at most `range`.
fn within(range: f64, count: usize) -> f64 {
    let (range, count) = (range.min(1.0), crate::number(count));
    count * range.powf(count - 1.0) - (count - 1.0) * range.powf(count)
}

/// How many different values there are, to the nearest step.
fn places(values: &[f64], step: f64) -> usize {
    let mut places: Vec<f64> = values.iter().map(|value| (value / step).round()).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places.len()
}

/// Once in a thousand recordings a display reads so by chance.
const CHANCE: f64 = 1e-3;
/// A command that does not go by multiples of a step has one decimal digit more at least: a tenth of the step, and its rounding.
const FINER: f64 = 0.11;

/// Why the path cannot be the circle that a ballbar was set up for, where that is so: fitted to it, the bar is longer or shorter
/// than bars can read, or its ball stood elsewhere. Exchanged columns and wrong units do that.
pub(super) fn no_circle(study: &Study<'_>, bare: &Model) -> Option<String> {
    study.scenes.iter().enumerate().find_map(|(number, scene)| {
        let Instrument::Ballbar { radius, .. } = scene.recording.instrument else { return None };
        let setting = |fitted: &&Fitted| {
            matches!(fitted.effect.setting_of(number), Some(Setting::Radius | Setting::Eccentricity { .. }))
        };
        let sizes = bare.effects.iter().filter(setting).flat_map(|fitted| &fitted.coefficients);
        let largest = sizes.fold(0.0, |most: f64, value| most.max(value.abs()));
        (largest > BAR_READS + BAR_READS_OF_LENGTH * radius).then(|| {
            format!(
                "the readings of {} are not a circle about the declared centre: a fit gives a centre or length of the bar that \
                 differs by {largest:.1} mm; check the columns of the axes, which may be swapped, and their signs and units",
                scene.recording.file
            )
        })
    })
}

/// How much longer or shorter than its nominal length a ballbar reads, mm, and as a share of its length.
const BAR_READS: f64 = 1.0;
const BAR_READS_OF_LENGTH: f64 = 0.01;

/// How far off, mm and rad, and as a share of the travel, is too far for an error of a machine.
const FAR_OFF: (f64, f64) = (0.5, 0.01);
const FAR_OFF_OF_TRAVEL: f64 = 0.05;
/// The share of the travel from which on an error is doubtful. Steel that is 80 K too warm is long by a thousandth, and no machine tool is
/// worse: twice that.
const DOUBTFUL_OF_TRAVEL: f64 = 2e-3;

fn range(values: &[f64]) -> f64 {
    let known = values.iter().filter(|value| value.is_finite());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
    (high - low).max(0.0)
}
