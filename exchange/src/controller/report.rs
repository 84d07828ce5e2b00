//! The report of an export. In: what a format carries and loses. Out: text.

use std::fmt::Write;

use abbe_runtime::math::length;

use super::beyond::Beyond;
use super::effects::LEAST;
use super::geometry::Geometry;
use super::lost::{Lost, Size};
use super::space::Space;

/// Files that take off no more than this share of the error do nothing: it is what is left of rounding.
const NOTHING: f64 = 1e-9;

/// Errors at the tool over the workspace, and what no table holds.
pub fn text(geometry: &Geometry<'_>, space: &Space, lost: &Lost) -> String {
    let mut text = workspace(geometry, space);
    let _ = writeln!(text, "error at the tool over it, {} poses (um)           rms  largest", lost.poses);
    for (what, size) in [
        ("  without compensation", lost.without),
        ("  with these files", lost.with_files),
        ("  with Abbe's own compensation", lost.with_abbe),
        ("  loss in these files", lost.lost),
    ] {
        let _ = writeln!(text, "{what:<52}{}", size_text(size));
    }
    if let Some(verdict) = verdict(lost) {
        let _ = writeln!(text, "{verdict}");
    }
    if length(lost.shift) >= 1e-4 {
        let shift = lost.shift.map(|part| format!("{:.1}", part * 1000.0)).join(", ");
        let _ = writeln!(text, "  a constant shift of {shift} um in X, Y, Z also remains");
    }
    if !geometry.beyond().is_empty() {
        let _ = writeln!(text, "in no table, and so not included in these figures:");
        for beyond in geometry.beyond() {
            let _ = writeln!(text, "  {}", beyond_text(geometry, space, beyond));
        }
    }
    text
}

/// What a reader must not miss: files that are worse than none, or do nothing.
fn verdict(lost: &Lost) -> Option<String> {
    let (with, without) = (lost.with_files.rms, lost.without.rms);
    if with > without + LEAST {
        return Some(
            "  WORSE than none: do not load these files. Check the type, the unit, the sign and the axis."
                .to_owned(),
        );
    }
    ((with - without).abs() <= without * NOTHING).then(|| {
        "  these files change nothing at the tool: the tables of this format cannot express the errors of this calibration"
            .to_owned()
    })
}

fn workspace(geometry: &Geometry<'_>, space: &Space) -> String {
    let axes = geometry.equations.axes.iter().zip(space.ranges.iter().zip(&space.reference));
    let axes = axes.filter(|(axis, _)| !axis.is_motor()).map(|(axis, ([low, high], at))| {
        let (unit, name) = if axis.rotary { (1_f64.to_degrees(), "deg") } else { (1.0, "mm") };
        let [low, high, at] = [low, high, at].map(|place| short(place * unit));
        format!("{} {low} to {high} {name} (reference {at})", axis.letter)
    });
    format!("workspace: {}\n", axes.collect::<Vec<_>>().join(", "))
}

fn size_text(size: Size) -> String {
    let um = |mm: f64| mm * 1000.0;
    format!("{:>8.2} {:>8.2}", um(size.rms), um(size.largest))
}

/// A number with as few decimals as it needs, three at most.
fn short(number: f64) -> String {
    // A zero from below has no sign.
    let text = format!("{:.3}", if number.abs() < 5e-4 { 0.0 } else { number });
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A term with its size at the tool.
fn beyond_text(geometry: &Geometry<'_>, space: &Space, beyond: &Beyond) -> String {
    let motion = geometry.equations.motions.get(beyond.motion).map_or("", |motion| motion.name.as_str());
    let poses = space.poses(geometry);
    let at_tool = poses.iter().map(|pose| {
        let lever = geometry.levers(&pose.position).get(beyond.motion).map_or(0.0, |lever| length(*lever));
        let times = beyond.times.and_then(|axis| pose.position.get(axis)).map_or(1.0, |place| place.abs());
        lever * times
    });
    let most = at_tool.fold(0.0, f64::max);
    match beyond.size {
        Some(size) => {
            format!("{motion} {}: up to {:.2} um {}", beyond.term, size * most * 1000.0, beyond.per)
        }
        None => format!("{motion} {}: it changes {}", beyond.term, beyond.per),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_harm_or_do_nothing_are_told() {
        let size = |rms: f64| Size { rms, largest: rms };
        let lost = |with: f64| Lost {
            poses: 1,
            without: size(0.02),
            with_files: size(with),
            with_abbe: size(0.0),
            lost: size(with),
            shift: [0.0; 3],
        };
        // The wrong type of a screw table: its positions are taken for corrections.
        assert!(verdict(&lost(254.0)).unwrap().contains("WORSE than none"));
        assert!(verdict(&lost(0.02)).unwrap().contains("change nothing at the tool"));
        assert_eq!(verdict(&lost(0.001)), None);
    }
}
