//! Where a tool of the calibration points. In: `direction` or `turned` of a tool, and the constants with it. Out: the parts of its direction
//! among these constants, and its tip where its holder is turned.
//!
//! Both speak of the last frame of the machine file's chain, in which the offset of its `tool` is. `direction` says where the tool points,
//! and its constants say where its tip is, as without it. `turned` says how its holder stands: the constants are those of the tool
//! as it was measured, upright in the holder, and are turned with it.

use abbe_runtime::math::sin_cos;

use super::names::{MachineNames, TurningTool};
use crate::diagnostic::{Diagnostic, Diagnostics};
use crate::quantity::{self, Dimension};
use crate::source::Spanned;
use crate::yaml::Node;

/// The keys of a tool that are no constants.
pub(super) const KEYS: [&str; 2] = ["direction", "turned"];

/// What rounding may leave of a coordinate that a machine does not have: mm. A tool of 1000 mm that is turned by angles in doubles leaves
/// some 1e-13 mm, and 1e-9 mm is a picometre, which no machine shows.
const ROUNDING: f64 = 1e-9;

/// Takes a key of a tool into its constants.
pub(super) fn take(
    (key, node): &(Spanned<String>, Node),
    tool: &str,
    names: &MachineNames,
    values: &mut [f64],
    diagnostics: &mut Diagnostics,
) {
    let Some(turning) = names.turning else {
        diagnostics.push(
            Diagnostic::error("E0432", key.span, format!("tools of {} have no directions of their own", names.machine))
                .label("the machine file does not name the components of a direction")
                .help(
                    "add `direction: [It, Jt, Kt]` to its `tool`, and `orientation: true`; if only the tip matters, give its position in the \
                     frame of the chain's last link",
                ),
        );
        return;
    };
    if key.value == "direction" {
        if let Some(direction) = direction(node, tool, diagnostics) {
            set(values, turning.direction, direction);
        }
    } else if let Some(rotation) = rotation(node, tool, diagnostics) {
        let own = turning.direction.map(|part| values.get(part).copied().unwrap_or_default());
        set(values, turning.direction, rotated(rotation, own));
        if let Err(reason) = turn_tip(turning, rotation, values) {
            let message = format!("the tip of the tool `{tool}` cannot be turned with its holder");
            diagnostics.push(Diagnostic::error("E0432", key.span, message).label(reason).help(
                "give its `direction`, and the position of its tip in the frame of the chain's last link",
            ));
        }
    }
}

/// Reports a tool whose direction is given twice.
pub(super) fn check(entries: &[(Spanned<String>, Node)], diagnostics: &mut Diagnostics) {
    let mut own = entries.iter().map(|(key, _)| key).filter(|key| KEYS.contains(&key.value.as_str()));
    if let (Some(first), Some(second)) = (own.next(), own.next()) {
        diagnostics.push(
            Diagnostic::error("E0432", second.span, "the direction of this tool is given twice")
                .label("again here")
                .also(first.span, "first here")
                .help("keep `direction` if the tip was measured on the machine, `turned` if it was measured in the holder"),
        );
    }
}

fn set(values: &mut [f64], parts: [usize; 3], direction: [f64; 3]) {
    for (part, value) in parts.into_iter().zip(direction) {
        if let Some(slot) = values.get_mut(part) {
            *slot = value;
        }
    }
}

/// A direction of length 1, from three numbers.
fn direction(node: &Node, tool: &str, diagnostics: &mut Diagnostics) -> Option<[f64; 3]> {
    let items = node.items().unwrap_or_default();
    let what = format!("a part of the direction of the tool `{tool}`");
    let parts: Vec<f64> = match items.len() {
        3 => items
            .iter()
            .map(|item| Some(quantity::read_number(item, &what, diagnostics)?.value))
            .collect::<Option<_>>()?,
        _ => Vec::new(),
    };
    let unit = <[f64; 3]>::try_from(parts).ok().and_then(unit);
    if unit.is_none() {
        diagnostics.push(
            Diagnostic::error("E0432", node.span, format!("this is not a direction of the tool `{tool}`"))
                .label("a direction is three numbers that are not all zero")
                .help("write `direction: [0, 1, 0]`, from the tip towards the holder"),
        );
    }
    unit
}

/// The vector of length 1; none where it has no direction. One that has this length but for its last digit stays as it is, so that what
/// is written reads back to the last bit.
fn unit(vector: [f64; 3]) -> Option<[f64; 3]> {
    let square = vector.iter().map(|part| part * part).sum::<f64>();
    if (square - 1.0).abs() <= 8.0 * f64::EPSILON {
        return Some(vector);
    }
    let size = vector.iter().fold(0.0_f64, |size, part| size.max(part.abs()));
    let scaled = vector.map(|part| part / size);
    let length = scaled.iter().map(|part| part * part).sum::<f64>().sqrt();
    let unit = scaled.map(|part| part / length);
    unit.iter().all(|part| part.is_finite()).then_some(unit)
}

type Rotation = [[f64; 3]; 3];

/// The rotation about X, then Y, then Z.
fn rotation(node: &Node, tool: &str, diagnostics: &mut Diagnostics) -> Option<Rotation> {
    let entries = node.entries().unwrap_or_default();
    let known = |key: &str| "ABC".find(key).filter(|_| key.len() == 1);
    if entries.is_empty() || entries.iter().any(|(key, _)| known(&key.value).is_none()) {
        diagnostics.push(
            Diagnostic::error(
                "E0432",
                node.span,
                format!("this does not say how the holder of the tool `{tool}` is turned"),
            )
            .label("angles about X, Y and Z are A, B and C")
            .help("write `turned: {A: 90 deg}`"),
        );
        return None;
    }
    let mut angles = [0.0; 3];
    for (key, node) in entries {
        let what = format!("`{}` of the tool `{tool}`", key.value);
        let angle = quantity::read(node, Dimension::ANGLE, &what, diagnostics)?;
        if let Some(slot) = known(&key.value).and_then(|axis| angles.get_mut(axis)) {
            *slot = angle.value;
        }
    }
    let [a, b, c] = angles.map(|angle| {
        let (sine, cosine) = sin_cos(angle);
        (without_rounding(sine), without_rounding(cosine))
    });
    Some([
        [c.1 * b.1, c.1 * b.0 * a.0 - c.0 * a.1, c.1 * b.0 * a.1 + c.0 * a.0],
        [c.0 * b.1, c.0 * b.0 * a.0 + c.1 * a.1, c.0 * b.0 * a.1 - c.1 * a.0],
        [-b.0, b.1 * a.0, b.1 * a.1],
    ])
}

/// A right angle has a cosine of zero, and no rounding of pi.
fn without_rounding(value: f64) -> f64 {
    if value.abs() < f64::EPSILON { 0.0 } else { value }
}

fn rotated(rotation: Rotation, [x, y, z]: [f64; 3]) -> [f64; 3] {
    rotation.map(|[a, b, c]| a * x + b * y + c * z)
}

/// Turns the tip, where its coordinates are constants of its own; or says why it cannot be turned.
fn turn_tip(turning: TurningTool, rotation: Rotation, values: &mut [f64]) -> Result<(), &'static str> {
    let offset = turning.offset.ok_or("a coordinate of the machine's tool is not a constant of its own")?;
    let upright = offset.map(|number| number.and_then(|number| values.get(number)).copied().unwrap_or(0.0));
    for (number, value) in offset.into_iter().zip(rotated(rotation, upright)) {
        match number.and_then(|number| values.get_mut(number)) {
            Some(slot) => *slot = value,
            None if value.abs() <= ROUNDING => {}
            None => return Err("it would leave the plane of the machine's tool"),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_of_any_length_is_a_direction() {
        assert_eq!(unit([0.0, 3.0, 4.0]), Some([0.0, 0.6, 0.8]));
        assert_eq!(unit([0.0, 0.0, -1e300]), Some([0.0, 0.0, -1.0]));
        assert_eq!(unit([0.0; 3]), None);
        assert_eq!(unit([f64::INFINITY, 0.0, 0.0]), None);
    }
}
