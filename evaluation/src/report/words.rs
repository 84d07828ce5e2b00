//! What text and page say alike. In: lines, circles, figures. Out: headings, sentences and numbers.

use crate::circular::Circle;
use crate::diagonals::{Diagonals, name};
use crate::figure::{Figure, Given, Rests, Sensor, Unit};
use crate::positioning::{Kind, Positioning, Zero};

/// `Positioning of the slide X, at Y 140 mm`.
pub(super) fn line(line: &Positioning) -> String {
    let names = line.axes.join(" and ");
    let what = match line.kind {
        Kind::Slide => format!("the slide {names}"),
        Kind::Rotary => format!("the rotary axis {names}"),
        Kind::FaceDiagonal => format!("the face diagonal {}", name(line)),
        Kind::BodyDiagonal => format!("the body diagonal {}", name(line)),
    };
    let stand = |(axis, at, unit): &(String, f64, Unit)| format!("{axis} {}", unit.place(*at));
    let others: Vec<String> = line.at.iter().map(stand).collect();
    let others = if others.is_empty() { String::new() } else { format!(", at {}", others.join(", ")) };
    format!("Positioning of {what}{others}")
}

/// What read a line, and what its deviations count from.
pub(super) fn basis(line: &Positioning) -> String {
    let sensor = match line.sensor {
        Sensor::Instrument => "Read by the instrument",
        Sensor::Feedback => "Read by the drive's own feedback, which does not see errors after the drive",
    };
    let zero = match line.zero {
        Zero::Instrument => "its own zero",
        Zero::Nominal => "the nominal position",
        Zero::Mean => {
            "the mean of all readings, because the machine's constants are unknown without a calibration"
        }
    };
    format!("{sensor}. Deviations are actual minus target, counted from {zero}.")
}

/// The targets that do not count; nothing where all do.
pub(super) fn left_out(line: &Positioning) -> Option<String> {
    let places: Vec<String> = line.left_out.iter().map(|place| line.unit.place(*place)).collect();
    (!places.is_empty())
        .then(|| format!("Left out, because they were approached from only one side: {}.", listed(&places)))
}

/// `Body diagonals together: +X+Y+Z, ...`.
pub(super) fn diagonals(diagonals: &Diagonals) -> String {
    let kind = if diagonals.kind == Kind::BodyDiagonal { "Body" } else { "Face" };
    format!("{kind} diagonals together: {}", diagonals.names.join(", "))
}

/// `Circle in XY, radius 100.000 mm, centre ..., feed 1000 mm/min`.
pub(super) fn circle(circle: &Circle) -> String {
    let center = circle.center.map_or(String::new(), |[one, other]| {
        let [first, second] = directions(circle);
        format!(", centre {first} {one:.3} {second} {other:.3} mm")
    });
    format!(
        "Circle in {}, radius {:.3} mm{center}, feed {:.0} mm/min",
        circle.plane,
        circle.radius,
        circle.feed * 60.0
    )
}

/// The two directions of a circle's plane.
pub(super) fn directions(circle: &Circle) -> [String; 2] {
    let mut letters = circle.plane.chars();
    [(); 2].map(|()| letters.next().map_or(String::new(), String::from))
}

/// What the drives themselves read says less than an instrument does.
pub(super) fn feedback(circle: &Circle) -> Option<&'static str> {
    (circle.sensor == Sensor::Feedback)
        .then_some("Read by the drives' own feedback, which does not see errors after the drives.")
}

/// What a figure rests on.
pub(super) fn rests(rests: Rests) -> String {
    let [least, most] = rests.runs;
    let runs = if least == most { format!("{least}") } else { format!("{least} to {most}") };
    match rests.targets {
        Some(targets) => format!("{targets} targets, {runs} runs"),
        None => format!("{} readings, {runs} traces", rests.readings),
    }
}

/// The figures that cannot be given, a sentence for each reason.
pub(super) fn not_given(all: &[Figure]) -> Vec<String> {
    let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
    for figure in all {
        if let Given::Not(reason) = &figure.value {
            match reasons.iter_mut().find(|(known, _)| known == reason) {
                Some((_, symbols)) => symbols.push(figure.symbol),
                None => reasons.push((reason, vec![figure.symbol])),
            }
        }
    }
    let sentence = |(reason, symbols): (&str, Vec<&str>)| {
        format!("{} cannot be given from this recording, because {reason}.", symbols.join(", "))
    };
    reasons.into_iter().map(sentence).collect()
}

/// A list that does not grow beyond a line or two.
fn listed(places: &[String]) -> String {
    let some: Vec<&str> = places.iter().take(8).map(String::as_str).collect();
    match places.len().saturating_sub(8) {
        0 => some.join(", "),
        more => format!("{} and {more} more", some.join(", ")),
    }
}

/// A unit as people write it.
pub(super) fn unit(name: &str) -> String {
    if name == "um" { "\u{b5}m".to_owned() } else { name.to_owned() }
}
