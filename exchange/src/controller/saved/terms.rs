//! A saved correction as error motions. In: a machine, and what a file holds. Out: terms, counted as the machine file counts them.

use model_dsl::calibration::{CalibratedTerm, Curve, CurveNodes, CurveValues, LARGEST_ANGLE, SeriesInput};
use model_dsl::equations::Motion;

use super::Saved;
use super::mesh::Mesh;
use super::screw::Screw;
use super::skew::Skew;
use crate::controller::geometry::Geometry;
use crate::controller::refused::Refused;

/// What turns a lever by less counts as none: lever arms of slides are 0, 1, -1 and positions.
const NONE: f64 = 1e-9;

/// An angle without the last bits of its arithmetic: to 1e-12 rad.
const ANGLES: f64 = 1e12;

const AXES: [char; 3] = ['X', 'Y', 'Z'];

/// The terms of all that stands in a file.
///
/// # Errors
/// A machine that has no such axis or no error motion that does what is corrected.
pub(super) fn of(geometry: &Geometry<'_>, saved: &Saved) -> Result<Vec<(usize, CalibratedTerm)>, Refused> {
    let mut terms = Vec::new();
    if let Some(skew) = &saved.skew {
        terms.extend(of_skew(geometry, skew)?);
    }
    if let Some(mesh) = &saved.mesh {
        terms.extend(of_mesh(geometry, mesh)?);
    }
    if let Some(screw) = &saved.screw {
        terms.push(of_screw(geometry, screw)?);
    }
    Ok(terms)
}

/// For each skew the alignment error of its axis; where the machine file has none, or where the angle is larger than an alignment error may
/// be, the slope of its straightness. That is the same error: neither turns the carriage.
fn of_skew(geometry: &Geometry<'_>, skew: &Skew) -> Result<Vec<(usize, CalibratedTerm)>, Refused> {
    let errors = skew
        .errors()
        .ok_or_else(|| Refused::new("these skew factors have no inverse", "check the numbers of the file"))?;
    let mut terms = Vec::new();
    for (across, row) in errors.iter().enumerate() {
        for (along, slope) in row.iter().enumerate() {
            let slope = (slope * ANGLES).round() / ANGLES;
            if slope != 0.0 {
                terms.push(of_slope(geometry, [across, along], slope)?);
            }
        }
    }
    Ok(terms)
}

/// The error in one direction that grows with one axis: both as numbers of X, Y, Z.
fn of_slope(
    geometry: &Geometry<'_>,
    [across, along]: [usize; 2],
    slope: f64,
) -> Result<(usize, CalibratedTerm), Refused> {
    let axis = slide(geometry, along)?;
    let small = slope.abs() <= LARGEST_ANGLE;
    if let Some((motion, lever)) = alignment(geometry, axis, across).filter(|_| small) {
        return Ok((motion, CalibratedTerm::Constant { value: slope / lever }));
    }
    if let Some((motion, lever)) = displacement(geometry, axis, across) {
        let coefficients = vec![0.0, slope / lever];
        return Ok((motion, CalibratedTerm::Polynomial { input: SeriesInput::Axis(axis), coefficients }));
    }
    let what = format!(
        "{} has no error motion that tilts {} towards {}",
        geometry.equations.machine,
        letter(along),
        letter(across)
    );
    let help =
        format!("add an alignment error of {}, or its straightness, to the machine file", letter(along));
    Err(Refused::new(what, help))
}

/// Minus the heights, as the straightness in Z of the axis along a row.
fn of_mesh(geometry: &Geometry<'_>, mesh: &Mesh) -> Result<Vec<(usize, CalibratedTerm)>, Refused> {
    let [along, across] = mesh.axes.map(|letter| named(geometry, letter));
    let axes = [along?, across?];
    let motion = displacement(geometry, axes[0], 2);
    let (motion, lever) = motion.ok_or_else(|| {
        let what = format!("{} has no straightness EZ{}", geometry.equations.machine, mesh.axes[0]);
        Refused::new(
            what,
            format!("add EZ{}, which takes the heights of a bed, to the machine file", mesh.axes[0]),
        )
    })?;
    Ok(mesh.terms(axes, -1.0 / lever).into_iter().map(|term| (motion, term)).collect())
}

/// Minus the trim, as the positioning error of the axis.
fn of_screw(geometry: &Geometry<'_>, screw: &Screw) -> Result<(usize, CalibratedTerm), Refused> {
    let refused = || {
        let what = format!("{} has no positioning error of that axis", geometry.equations.machine);
        Refused::new(
            what,
            "use a screw table for a slide, and list its positioning error in the machine file: EXX of X",
        )
    };
    let across = own_direction(geometry, screw.axis).ok_or_else(refused)?;
    let (motion, lever) = displacement(geometry, screw.axis, across).ok_or_else(refused)?;
    let errors = |trims: &[f64]| trims.iter().map(|trim| -trim / lever + 0.0).collect::<Vec<f64>>();
    let (forward, reverse) = (errors(&screw.forward), errors(&screw.reverse));
    let values = if forward == reverse {
        CurveValues::Both(forward)
    } else {
        CurveValues::Directed { forward, reverse }
    };
    let curve = Curve::new(CurveNodes::At(screw.places.clone()), values);
    Ok((motion, CalibratedTerm::Table { axis: screw.axis, curve }))
}

/// The slide X, Y or Z, which moves the tool along its own letter relative to the part.
///
/// # Errors
/// A machine that has no such slide.
pub(in crate::controller) fn slide(geometry: &Geometry<'_>, direction: usize) -> Result<usize, Refused> {
    let axis = named(geometry, letter(direction))?;
    if own_direction(geometry, axis) == Some(direction) {
        return Ok(axis);
    }
    let what = format!(
        "the axis {} of {} does not move the tool along {0}",
        letter(direction),
        geometry.equations.machine
    );
    Err(Refused::new(what, "use such files for machines with three slides X, Y, Z"))
}

/// The axis of a letter.
fn named(geometry: &Geometry<'_>, letter: char) -> Result<usize, Refused> {
    let axes = &geometry.equations.axes;
    axes.iter().position(|axis| axis.letter.chars().eq([letter])).ok_or_else(|| {
        let letters: Vec<&str> = axes.iter().map(|axis| axis.letter.as_str()).collect();
        let what = format!("{} has no axis {letter}", geometry.equations.machine);
        Refused::new(
            what,
            format!(
                "its axes are {}; use such files for machines with three slides X, Y, Z",
                letters.join(", ")
            ),
        )
    })
}

fn letter(direction: usize) -> char {
    AXES.get(direction).copied().unwrap_or('Z')
}

/// The direction of the part's frame in which an axis moves the tool forwards, by number.
fn own_direction(geometry: &Geometry<'_>, axis: usize) -> Option<usize> {
    let [from, to] = [0.0, 1.0].map(|place| geometry.nominal(&at(geometry, axis, place)));
    let moved: [f64; 3] = std::array::from_fn(|part| to[part] - from[part]);
    (0..3).find(|direction| is_unit(moved, *direction).is_some_and(|lever| lever > 0.0))
}

/// The displacement of an axis's own link that moves the tool in one direction alone, and by how much: 1 or -1.
fn displacement(geometry: &Geometry<'_>, axis: usize, direction: usize) -> Option<(usize, f64)> {
    let levers = geometry.levers(&at(geometry, axis, 1.0));
    let motions = geometry.equations.motions.iter().zip(levers).enumerate();
    let own = motions.filter(|(_, (motion, _))| is_own(motion, axis) && !motion.alignment && !motion.angular);
    let mut found = own.filter_map(|(number, (_, lever))| Some((number, is_unit(lever, direction)?)));
    found.next()
}

/// The only alignment error of an axis that moves the tool in one direction as the axis goes, and in no other way; and by how much for
/// each rad and mm: 1 or -1.
fn alignment(geometry: &Geometry<'_>, axis: usize, direction: usize) -> Option<(usize, f64)> {
    let axes = 0..geometry.equations.axes.len();
    let [from, to] = [0.0, 1.0].map(|place| geometry.levers(&at(geometry, axis, place)));
    let others: Vec<Vec<[f64; 3]>> =
        axes.filter(|other| *other != axis).map(|other| geometry.levers(&at(geometry, other, 1.0))).collect();
    let slope = |to: &[[f64; 3]], motion: usize| -> Option<[f64; 3]> {
        let (to, from) = (to.get(motion)?, from.get(motion)?);
        Some(std::array::from_fn(|part| to[part] - from[part]))
    };
    let leans = |motion: usize| -> Option<f64> {
        let lever = is_unit(slope(&to, motion)?, direction)?;
        let still = |others: &Vec<[f64; 3]>| {
            slope(others, motion).is_some_and(|slope| slope.iter().all(|part| part.abs() < NONE))
        };
        others.iter().all(still).then_some(lever)
    };
    let motions = geometry.equations.motions.iter().enumerate();
    let own = motions.filter(|(_, motion)| is_own(motion, axis) && motion.alignment && motion.angular);
    let mut found = own.filter_map(|(number, _)| Some((number, leans(number)?)));
    let first = found.next()?;
    found.next().is_none().then_some(first)
}

fn is_own(motion: &Motion, axis: usize) -> bool {
    motion.axis == Some(axis)
}

/// A pose of zeros but for one axis.
fn at(geometry: &Geometry<'_>, axis: usize, place: f64) -> Vec<f64> {
    (0..geometry.equations.axes.len()).map(|other| if other == axis { place } else { 0.0 }).collect()
}

/// 1 or -1 where a lever points along a direction and along no other.
fn is_unit(lever: [f64; 3], direction: usize) -> Option<f64> {
    let own = *lever.get(direction)?;
    let others = lever.iter().enumerate().filter(|(part, _)| *part != direction);
    let straight = (own.abs() - 1.0).abs() < NONE && others.clone().all(|(_, part)| part.abs() < NONE);
    straight.then_some(own.signum())
}
