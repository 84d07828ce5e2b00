//! The error motions of a machine as parameters of a volumetric compensation. In: a geometry. Out: for each error motion its
//! name there and its values over a grid of the axes that it depends on, as the tool relative to the part.

use std::collections::BTreeSet;

use abbe_runtime::Direction;
use model_dsl::equations::Motion;

use super::geometry::Pose;
use super::grid::Grid;
use super::job::Job;
use super::nodes::{Nodes, Spacing};
use super::refused::Refused;
use super::volumetric::Volumetric;

/// The most records of one block.
const MOST_RECORDS: usize = 20_000;

/// An error motion of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parameter {
    /// Its name there: `EXX`, `C0Y`.
    pub name: String,
    /// The axis of its link.
    pub axis: Option<usize>,
    /// Its values, mm or rad.
    pub grid: Grid,
}

/// The error motions of a file, those of the same arguments together, and what has no place in it.
#[derive(Clone, Debug, Default)]
pub(super) struct Gathered {
    /// The error motions.
    pub parameters: Vec<Parameter>,
    /// What is left out, in words.
    pub left_out: Vec<String>,
}

/// Gathers the error motions that are not zero. `arguments` is the most arguments that the format knows.
///
/// # Errors
/// Where a grid would be too large, or a number is not finite.
pub(super) fn gather(job: &Job<'_, '_>, model: &Volumetric, arguments: usize) -> Result<Gathered, Refused> {
    let mut gathered = Gathered::default();
    for (number, motion) in job.geometry.equations.motions.iter().enumerate() {
        let axes = arguments_of(job, number);
        if job.geometry.terms(number).is_empty() {
            continue;
        }
        let Some(sign) = model.sign(job.geometry, number) else {
            gathered
                .left_out
                .push(format!("{}: the controller's model has no such error motion", motion.name));
            continue;
        };
        if axes.len() > arguments {
            let what = "it depends on several axes, but the tables of this format have one";
            gathered.left_out.push(format!("{}: {what}", motion.name));
            continue;
        }
        let grid = grid(job, number, sign, axes)?;
        gathered.parameters.push(Parameter { name: name_of(motion), axis: motion.axis, grid });
    }
    gathered
        .parameters
        .sort_by_key(|parameter| parameter.grid.arguments.iter().map(|(axis, _)| *axis).collect::<Vec<_>>());
    Ok(gathered)
}

/// The axes whose positions an error motion depends on.
fn arguments_of(job: &Job<'_, '_>, motion: usize) -> BTreeSet<usize> {
    let terms = job.geometry.calibration.terms(motion).iter();
    let states = terms.flat_map(|term| term.value.states());
    states.filter(|(state, _)| state.is_position()).filter_map(|(_, axis)| axis).collect()
}

fn grid(job: &Job<'_, '_>, motion: usize, sign: f64, axes: BTreeSet<usize>) -> Result<Grid, Refused> {
    let nodes = |axis: usize| -> Result<(usize, Vec<f64>), Refused> {
        let range = job.space.ranges.get(axis).copied().unwrap_or_default();
        let nodes = Nodes::new(job.geometry.equations, job.geometry.calibration, axis, range);
        Ok((axis, nodes.at_any_places(Spacing { points: job.options.points, most: MOST_RECORDS })?))
    };
    let arguments = axes.into_iter().map(nodes).collect::<Result<Vec<_>, _>>()?;
    let records = arguments.iter().try_fold(1_usize, |size, (_, nodes)| size.checked_mul(nodes.len()));
    let Some(records) = records.filter(|records| *records <= MOST_RECORDS) else {
        let name = job.geometry.equations.motions.get(motion).map_or("", |motion| motion.name.as_str());
        let what = format!("the grid of {name} would have more than {MOST_RECORDS} records");
        return Err(Refused::new(what, "use fewer points with --points"));
    };
    let mut grid = Grid { arguments, values: vec![0.0; records] };
    let values: Vec<f64> = (0..records).map(|record| sign * mean(job, motion, &grid, record)).collect();
    grid.values = values;
    Ok(grid)
}

/// An error motion at a record of its grid, whatever the direction: the mean of both.
fn mean(job: &Job<'_, '_>, motion: usize, grid: &Grid, record: usize) -> f64 {
    let places = grid.arguments.iter().map(|(axis, _)| *axis).zip(grid.places(record));
    let pose = places
        .fold(job.space.reference_pose(Direction::Positive), |pose, (axis, place)| pose.moved(axis, place));
    let back = Pose { direction: vec![Direction::Negative; pose.direction.len()], ..pose.clone() };
    f64::midpoint(job.geometry.motion(motion, &pose), job.geometry.motion(motion, &back))
}

/// The name of an error motion in such files: `C0Y` for EC0Y.
fn name_of(motion: &Motion) -> String {
    let alignment = motion.name.strip_prefix('E').filter(|_| motion.alignment);
    alignment.unwrap_or(&motion.name).to_owned()
}

/// The error motion of a name: EC0Y for `C0Y`; nothing for what is none.
pub fn motion_of(name: &str) -> Option<String> {
    let letters = |bytes: &[u8]| bytes.iter().all(|letter| b"XYZABC".contains(letter));
    match name.as_bytes() {
        [b'E', rest @ ..] if rest.len() == 2 && letters(rest) => Some(name.to_owned()),
        [direction, b'0', axis] if letters(&[*direction, *axis]) => Some(format!("E{name}")),
        _ => None,
    }
}

/// Whether a name is one of those that describe the machine itself: its tip, its centres of rotation, its axes.
pub(super) fn is_description(name: &str) -> bool {
    let known = [["P0", "XYZ"], ["N0", "XYZ"], ["ID", "XYZ"], ["LN", "XYZABC"]];
    let simple = known.iter().any(|[begin, ends]| {
        name.strip_prefix(begin).is_some_and(|end| end.len() == 1 && ends.contains(end))
    });
    let axis = |begin: char, axes: &str| match name.as_bytes() {
        [first, along, of] => {
            char::from(*first) == begin && b"XYZ".contains(along) && axes.contains(char::from(*of))
        }
        _ => false,
    };
    simple || axis('P', "ABC") || axis('V', "XYZABC")
}

/// What the file says of itself.
pub(super) fn preamble(job: &Job<'_, '_>, model: &Volumetric) -> String {
    format!(
        "// Error motions of {}, mm and rad, over positions in mm.\n\
         // Each is that of the tool relative to the part, actual minus commanded, right-handed: the mean of both\n\
         // directions of motion. The chain from part to tool is {}: {} of its axes carry the part.\n",
        job.geometry.equations.machine, model.word, model.workpiece_axes
    )
}

/// How the controller is told of the file.
pub(super) fn loading(model: &Volumetric, form: &str, file: &str) -> Vec<String> {
    vec![
        format!("workpiece_axes {}, and the logical numbers of the axes x, y, z", model.workpiece_axes),
        format!("file[0] {file} and file_format[0] {form}, Interpolation GRID"),
        "the numbers are errors, actual minus commanded. If the axis moves the wrong way in the check with an indicator, the \
         controller's `negate` reverses all signs"
            .to_owned(),
    ]
}
