//! What can be decided at all.
//!
//! In: a study. Out: sentences about what its recordings cannot tell, and the reason why they are too few to claim anything, where that
//! is so.

use super::units::unit_at;
use crate::answers::answers;
use crate::channel::Channel;
use crate::coarse::Coarse;
use crate::course;
use crate::crossing;
use crate::diagnosis::Change;
use crate::model::Model;
use crate::parameters::{angle_unit, axis_unit};
use crate::position_loop::PositionLoop;
use crate::recording::{Turned, taken_as_free};
use crate::repeats::{self, Scatter};
use crate::report::figure::{significant, size};
use crate::scene::Scene;
use crate::states::Crossing;
use crate::study::Study;

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
    let pose = scene.pose.as_ref()?;
    (pose.rotations == [false; 3]).then(|| {
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
    let free =
        |scene: &Scene<'_>, about: usize| scene.pose.as_ref().is_some_and(|pose| pose.rotations[about]);
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

/// What commands that bend between rows leave open: the parabola between two rows lies a twelfth of the acceleration times their distance
/// squared away from its chord.
pub(super) fn bent(study: &Study<'_>, model: &Model) -> Option<String> {
    let step = study.scenes.iter().map(|scene| scene.given.step).fold(0.0, f64::max);
    model.bends().then(|| {
        format!(
            "These recordings cannot show an acceleration with a gain of {} 1/s^2 or more, because their commands bend between rows, \
             which are {} ms apart. More rows a second would show it.",
            significant(12.0 / (step * step), 3),
            significant(1e3 * step, 3)
        )
    })
}

/// What runs that begin underway leave open: a loop remembers how its axis moved before.
pub(super) fn underway(study: &Study<'_>, model: &Model) -> Option<String> {
    let follows = course::loops(study, model).into_iter().any(PositionLoop::acts);
    let sentence = "These recordings cannot show where an axis was when a run began, because it moved already. The first rows of such runs \
        are left out until what its position loop remembers has faded. Runs that begin at rest would show it.";
    (model.underway() && follows).then(|| sentence.to_owned())
}

/// What a fault of a file leaves open.
pub(super) fn since_when(change: &Change) -> String {
    format!(
        "These recordings cannot show whether {} was wrong from the start or the machine has changed since. They show that {}.",
        change.name, change.fault
    )
}

/// What is left open by runs that differ and went to different places, where there are such.
pub(super) fn zeros_or_places(study: &Study<'_>, scattered: &[Scatter]) -> Option<String> {
    let scatter = scattered.iter().find(|scatter| !scatter.is_told)?;
    let at = scatter.at();
    let (scene, (factor, unit)) = (&study.scenes[scatter.scene], unit_at(study, at));
    let axes = repeats::elsewhere(scene);
    let letters: Vec<&str> = axes.iter().map(|axis| study.equations.axes[*axis].letter.as_str()).collect();
    Some(format!(
        "The runs of {} differ by {} (standard deviation of their means) in {}, but the noise gives only {}. They went to different \
         places of {}, so it cannot be decided whether the zero of the instrument has changed between runs or an error depends on \
         the place.",
        scene.recording.file,
        size(scatter.between * factor, unit),
        study.channel(at).name,
        size(scatter.within * factor, unit),
        letters.join(" and ")
    ))
}

/// Why recordings in which nothing is found do not show that the model is adequate, where that is so.
pub(super) fn shows_nothing(study: &Study<'_>) -> Option<String> {
    let shows = |scene: &Scene<'_>| {
        let recording = scene.recording;
        let has_position = recording.axes.iter().any(|axis| axis.position().is_some());
        has_position || !recording.temperatures.is_empty() || !recording.loads.is_empty()
    };
    (!study.scenes.iter().any(shows)).then(|| {
        "Nothing systematic is above the noise, but no recording has the position of an axis, a temperature or a load: they cannot \
         show anything that depends on these."
            .to_owned()
    })
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
            "only {fitted} of its samples can be fitted, and at least {FEWEST} are needed to separate an effect from noise"
        )
    } else if held_out == 0 {
        "no data are left to hold out, and Abbe reports no finding that is not tested on other data"
            .to_owned()
    } else {
        return None;
    };
    Some(because)
}
