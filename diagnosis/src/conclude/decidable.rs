//! What can be decided at all.
//!
//! In: a study, and what the instruments' settings alone leave. Out: sentences about what its recordings cannot tell, and
//! the reason why nothing can be claimed from them, where that is so.

use crate::answers::answers;
use crate::audit::gross;
use crate::channel::Channel;
use crate::coarse::Coarse;
use crate::crossing;
use crate::diagnosis::Change;
use crate::model::{Fitted, Model};
use crate::parameters::{angle_unit, axis_unit};
use crate::recording::{Instrument, Turned, taken_as_free};
use crate::scene::Scene;
use crate::states::Crossing;
use crate::study::Study;
use crate::terms::Setting;
use crate::zeros;

/// The fewest samples from which anything is claimed.
const FEWEST: usize = 24;

/// What the recordings cannot tell, whatever is found.
pub(super) fn undecided(study: &Study<'_>) -> Vec<String> {
    let mut sentences = Vec::new();
    let moving = |axis: usize| {
        study.scenes.iter().any(|scene| {
            let positions = scene.recording.axes[axis].position();
            let mut finite = positions.into_iter().flatten().filter(|position| position.is_finite());
            finite.next().is_some_and(|first| finite.any(|position| position != first))
        })
    };
    let axes = &study.equations.axes;
    let still: Vec<&str> =
        (0..axes.len()).filter(|axis| !moving(*axis)).map(|axis| axes[axis].letter.as_str()).collect();
    if still.len() == axes.len() {
        sentences.push(
            "This recording cannot show what depends on position, direction or speed, because no axis moves."
                .to_owned(),
        );
    } else if !still.is_empty() {
        let verb = if still.len() == 1 { "does" } else { "do" };
        sentences.push(format!(
            "This recording cannot show what depends on the motion of {}, because {} {verb} not move.",
            still.join(" and "),
            if still.len() == 1 { "it" } else { "they" }
        ));
    }
    let corners: usize =
        study.scenes.iter().map(|scene| scene.corners.iter().filter(|corner| **corner).count()).sum();
    if corners > 0 {
        sentences.push(format!(
            "What happens at corners of the path cannot be decided in {corners} rows, which are left out. The path reversed \
             between two rows, or may have done so: an axis is at one place twice, and the recording does not show from which \
             side it came the second time."
        ));
    }
    sentences.extend(study.scenes.iter().flat_map(|scene| coarse_readings(study, scene)));
    sentences.extend(study.scenes.iter().filter_map(|scene| end_points(study, scene)));
    sentences.extend(study.scenes.iter().filter_map(unturned));
    sentences.extend(turned_alike(study));
    sentences.extend(clamped(study));
    if study.scenes.iter().all(|scene| scene.run_numbers().len() < 2) {
        sentences
            .push("This recording cannot show whether runs repeat, because it has only one run.".to_owned());
    }
    sentences.extend(answers(study).iter().map(|answer| {
        let (name, axis) = (&study.loads[answer.load].0, &study.equations.axes[answer.axis].letter);
        format!(
            "This recording cannot show the effect of the load {name} on the drive of {axis}, because the load is the output of \
             the position loop of {axis}: following error, velocity and programmed motion explain {:.1} % of it. The load \
             responds to the error.",
            (1000.0 * answer.share).floor() / 10.0
        )
    }));
    sentences
}

/// What the points of parts leave open of how these lay where they were measured: a rotation that is free and that they do not show.
fn unturned(scene: &Scene<'_>) -> Option<String> {
    let lie = scene.lie.as_ref()?;
    (lie.rotations == [false; 3]).then(|| {
        format!(
            "The rotation of the part of {} cannot be decided, because its points lie in line with the measured direction.",
            scene.recording.file
        )
    })
}

/// What the free rotations of all parts leave open of the machine: what it turns alike wherever its axes stand. Where none of them says
/// that it is free, [`clamped`] says it.
fn turned_alike(study: &Study<'_>) -> Option<String> {
    if study.scenes.iter().all(|scene| scene.turned.is_some()) {
        return None;
    }
    let free = |scene: &Scene<'_>, about: usize| scene.lie.as_ref().is_some_and(|lie| lie.rotations[about]);
    let about = ["X", "Y", "Z"].into_iter().enumerate();
    let about: Vec<&str> = about
        .filter(|(number, _)| study.scenes.iter().all(|scene| free(scene, *number)))
        .map(|(_, letter)| letter)
        .collect();
    (!about.is_empty()).then(|| {
        format!(
            "These recordings cannot show whether the machine rotates all parts about {} by a constant angle, because each part \
             was clamped again (`datum: free`) and is rotated by its own angle.",
            about.join(" or ")
        )
    })
}

/// What is said of parts whose datum is free only because a rotation explains them.
fn clamped<'s>(study: &'s Study<'_>) -> Option<String> {
    let of_its_file = |scene: &'s Scene<'_>| Some((scene.recording.file.as_str(), scene.turned?));
    let parts: Vec<(&str, Turned)> = study.scenes.iter().filter_map(of_its_file).collect();
    taken_as_free(&parts)
}

/// What is left out because a display shows it coarser than the rest.
fn coarse_readings(study: &Study<'_>, scene: &Scene<'_>) -> Vec<String> {
    let of_channel = |channel: &Channel<'_>| {
        let coarse = channel.coarse.as_ref()?;
        let is_angle = channel.kind.angular(study.equations);
        let (scale, unit) = if is_angle { angle_unit(study) } else { (1.0, "mm") };
        let shown = |value: f64| format!("{} {unit}", (value * scale * 1e9).round() / 1e9);
        let Coarse { from, step, fine, count } = *coarse;
        Some(format!(
            "{} readings of {} are left out. From {} on it is displayed to {} only, and below to {}.",
            count,
            channel.name,
            shown(from),
            shown(step),
            shown(fine)
        ))
    };
    scene.channels.iter().filter_map(of_channel).collect()
}

/// What commands that are end points leave open.
fn end_points(study: &Study<'_>, scene: &Scene<'_>) -> Option<String> {
    let axes = scene.targets.axes.iter().map(|axis| study.equations.axes[*axis].letter.as_str());
    let axes: Vec<&str> = axes.collect();
    let used = (0..scene.rows()).filter(|row| !scene.left_out(*row)).count();
    let (verb, runs) = if axes.len() == 1 { ("is", "runs") } else { ("are", "run") };
    let letters = axes.join(" and ");
    (!axes.is_empty()).then(|| {
        format!(
            "{file} cannot show what depends on the speed of {letters}, because its command is an end point: the command is \
             constant while {letters} {runs} there, and no position loop explains the motion. Only the {used} rows in which \
             {letters} {verb} at rest are used.",
            file = scene.recording.file
        )
    })
}

/// What cannot be told of axes that cross their plays, and that nothing which was found holds.
pub(super) fn crossed(study: &Study<'_>, model: &Model) -> Vec<String> {
    let axes = crossing::crossing_only(model).into_iter();
    axes.map(|axis| {
        let letter = &study.equations.axes[axis].letter;
        let lost_motion = match model.crossing(axis) {
            Crossing::After(way) => {
                let (factor, unit) = axis_unit(study, axis);
                format!("lost motion that comes when {letter} has gone {:.3} {unit} back", way * factor)
            }
            Crossing::AtOnce | Crossing::Over(_) => format!("the lost motion that {letter} crosses before it moves"),
        };
        format!(
            "This recording cannot show whether friction also holds {letter} for a moment after a reversal, because {lost_motion} \
             explains what is seen there."
        )
    })
    .collect()
}

/// What a fault of a file leaves open.
pub(super) fn since_when(change: &Change) -> String {
    format!(
        "These recordings cannot show whether {} was wrong from the start or the machine has changed since. They show that {}.",
        change.name, change.fault
    )
}

/// Why nothing at all can be claimed, where that is so.
pub(super) fn too_little(study: &Study<'_>) -> Option<String> {
    let mut fitted = 0;
    let mut held_out = 0;
    for scene in &study.scenes {
        let rows = scene.fitted_rows();
        for channel in &scene.channels {
            for (row, (value, fits)) in channel.values.iter().zip(&rows).enumerate() {
                let counts = value.is_finite() && !scene.left_out(row);
                fitted += usize::from(counts && *fits);
                held_out += usize::from(counts && !*fits);
            }
        }
    }
    let because = if fitted + held_out == 0 {
        "it contains no observation".to_owned()
    } else if fitted < FEWEST {
        format!(
            "{fitted} samples are too few to separate an effect from noise (at least {FEWEST} are needed)"
        )
    } else if held_out == 0 {
        "no data are left to hold out, and Abbe reports no finding that is not tested on other data"
            .to_owned()
    } else {
        return None;
    };
    Some(because)
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
    for (scene, residuals) in zeros::residuals(study, bare).into_iter().enumerate() {
        for (channel, residual) in study.scenes[scene].channels.iter().zip(residuals) {
            let mut sizes: Vec<f64> =
                residual.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
            sizes.sort_by(f64::total_cmp);
            let median = sizes.get(sizes.len() / 2).copied().unwrap_or_default();
            if median > far_off(study, scene, channel) {
                return Some(format!(
                    "`{}` of {} does not follow the programmed path: half of its samples deviate by more than {median:.3}; check \
                     its column, its unit and the axes",
                    channel.name, study.scenes[scene].recording.file
                ));
            }
        }
    }
    None
}

/// How far off is too far for an error of a machine, mm or rad.
fn far_off(study: &Study<'_>, scene: usize, channel: &Channel<'_>) -> f64 {
    let axes = study.scenes[scene].recording.axes.iter();
    let travel = axes.filter_map(|axis| axis.command.as_deref()).map(range).fold(0.0, f64::max);
    let slack = if channel.kind.angular(study.equations) { FAR_OFF.1 } else { FAR_OFF.0 };
    slack + FAR_OFF_OF_TRAVEL * travel
}

/// Why no machine can have gone the programmed path, where that is so: farther or faster than any axis goes. Metres for millimetres
/// and milliseconds for seconds do that.
pub(super) fn impossible(study: &Study<'_>) -> Option<String> {
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
pub(super) fn misplaced(study: &Study<'_>) -> Option<String> {
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

fn range(values: &[f64]) -> f64 {
    let known = values.iter().filter(|value| value.is_finite());
    let (low, high) =
        known.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), q| (low.min(*q), high.max(*q)));
    (high - low).max(0.0)
}
