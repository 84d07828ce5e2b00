//! The words of the machine: sides, states, terms, and what compensation can do. In: names of the contract. Out: what a
//! person at the machine says.

use model_dsl::calibration::TermKind;

use crate::diagnosis::{Finding, Interval, IntervalOf, ParameterValue};

use super::figure::stretch;

/// Where along the way from the drive to the tool something comes in.
pub(super) fn side(side: &str) -> &str {
    match side {
        "drive" => "in the drive",
        "transmission" => "behind the drive's feedback: screw, play, guide",
        "structure" => "in the structure",
        "unknown" => "one sensor cannot tell on which side of the drive's feedback",
        other => other,
    }
}

/// On what it depends.
pub(super) fn state(state: &str) -> String {
    match state {
        "direction" => "depends on the direction of motion".to_owned(),
        "reversal" => "begins at each reversal".to_owned(),
        "other-axis" => "depends on where another axis stands".to_owned(),
        "" => String::new(),
        "constant" | "none" => "the same everywhere".to_owned(),
        other => format!("depends on {other}"),
    }
}

/// The stretch to which something is confined.
pub(super) fn interval(interval: &Interval) -> String {
    let what = match &interval.of {
        IntervalOf::Axis(letter) => letter.to_lowercase(),
        IntervalOf::Time => "time".to_owned(),
        IntervalOf::Frequency => "frequency".to_owned(),
    };
    format!("{what} from {}", stretch(interval.from, interval.to, interval.unit))
}

/// A term's name as it begins a line.
pub(super) fn title(term: &str) -> String {
    let mut letters = term.replace('-', " ").chars().collect::<Vec<_>>();
    if let Some(first) = letters.first_mut() {
        first.make_ascii_uppercase();
    }
    letters.into_iter().collect()
}

/// What the drive's own feedback says of an error that turns with the direction; nothing where that does not arise.
pub(super) fn friction(finding: &Finding) -> Option<&'static str> {
    let turns = matches!(finding.kind(), TermKind::Backlash | TermKind::ReversalSpike)
        || finding.location.state == "direction";
    (turns && finding.location.side == "drive").then_some(
        "The drive's own feedback shows it, so this is friction in the following error, not play: there is nothing to \
         tighten behind the motor.",
    )
}

/// What a lost motion, or the gain of a position loop, below zero means; nothing for other findings.
pub(super) fn ahead(finding: &Finding) -> Option<&'static str> {
    let below = |name: &str| {
        let parameter = finding.parameters.iter().find(|parameter| parameter.name == name);
        matches!(parameter.map(|known| &known.value), Some(ParameterValue::Fitted(estimate)) if estimate.ci95.1 < 0.0)
    };
    if finding.kind() == TermKind::Lag {
        return below("gain").then_some(
            "Here it is below zero: the drive leads its command, by velocity over gain. Its feed-forward is too large, or the \
             loop is quicker than the calibration says.",
        );
    }
    below("lost_motion").then_some(
        "Here it is below zero: after a reversal the axis seems to run ahead, as no play makes it. Look at the sign of the \
         sensor, and at a calibration that compensates more than there is.",
    )
}

/// What a load does inside a position loop; nothing for other findings.
pub(super) fn pushed(finding: &Finding) -> Option<&'static str> {
    (finding.kind() == TermKind::Compliance && finding.location.inside_loop).then_some(
        "It pushes the drive itself, whose position loop yields until it pushes back: the size is that of the loop's \
         stiffness. Far more than a micrometre for each newton is a load in another unit than its column says.",
    )
}

/// What compensation takes away.
pub(super) fn removed(finding: &Finding) -> &'static str {
    if !finding.compensable {
        return "A controller cannot compensate it in real time: it does not know in time what this depends on.";
    }
    if friction(finding).is_some() {
        return "A correction at each reversal removes it; friction compensation in the drive is the better place.";
    }
    match finding.kind() {
        TermKind::Constant | TermKind::Polynomial | TermKind::Table | TermKind::Coupling => {
            "A controller can compensate it in real time, wherever it was measured."
        }
        TermKind::Backlash => "A controller can compensate it in real time: a step at each reversal.",
        TermKind::Cyclic => {
            "A controller can compensate it in real time, as long as the reference position stays."
        }
        TermKind::Lag => {
            "A controller can compensate it in real time; matched gains in the drives are the better place."
        }
        TermKind::Expansion | TermKind::Growth => {
            "A controller that reads the sensor can compensate it in real time."
        }
        TermKind::Delay => {
            "A controller can compensate it in real time; equal paths of the commands are the better place."
        }
        TermKind::ReversalSpike
        | TermKind::Acceleration
        | TermKind::Drift
        | TermKind::Vibration
        | TermKind::Compliance
        | TermKind::Step
        | TermKind::Product => "A controller can compensate it in real time.",
    }
}

/// What compensation leaves, or what helps in its place.
pub(super) fn left(finding: &Finding) -> &'static str {
    match finding.kind() {
        TermKind::Backlash => "What stays is the moment in which the axis crosses over.",
        TermKind::Lag => "What stays is what is faster than the position loop.",
        TermKind::Expansion | TermKind::Growth => "What stays is the heat that the sensor does not see.",
        TermKind::Cyclic => "What stays is what changes with wear and with heat along the screw.",
        TermKind::Table => "What stays is what lies between the nodes and outside the stretch.",
        TermKind::Constant | TermKind::Polynomial | TermKind::Coupling => {
            "What stays is what changes after the measurement."
        }
        TermKind::ReversalSpike => "Friction compensation in the drive is what helps.",
        TermKind::Acceleration => "Acceleration feed-forward in the drive, or gentler motion, is what helps.",
        TermKind::Drift => "Warming up, or a sensor at the source of the heat, is what helps.",
        TermKind::Vibration => "Balancing, damping or isolating its source is what helps.",
        TermKind::Compliance => "A stiffer set-up, or less force, is what helps.",
        TermKind::Delay => "What stays is what the command of the axis does within that time.",
        TermKind::Step => "Looking for what moved, and measuring anew, is what helps.",
        TermKind::Product => "What stays is what lies outside the states that the recording went through.",
    }
}
