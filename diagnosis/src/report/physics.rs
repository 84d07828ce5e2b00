//! The words of the machine: sides, states, terms, and what compensation can do. In: names of the contract. Out: what a
//! person at the machine says.

use model_dsl::calibration::TermKind;

use crate::diagnosis::{Finding, Interval, IntervalOf, ParameterValue};

use super::figure::stretch;

/// Where along the way from the drive to the tool something comes in.
pub(super) fn side(side: &str) -> &str {
    match side {
        "drive" => "in the drive",
        "transmission" => "behind the drive's feedback: screw, nut, guide",
        "structure" => "in the structure",
        "unknown" => "side of the drive's feedback unknown with one sensor",
        other => other,
    }
}

/// On what it depends.
pub(super) fn state(state: &str) -> String {
    match state {
        "direction" => "depends on the direction of motion".to_owned(),
        "reversal" => "begins at each reversal".to_owned(),
        "other-axis" => "depends on the position of another axis".to_owned(),
        "" => String::new(),
        "constant" | "none" => "the same everywhere".to_owned(),
        other => format!("depends on {other}"),
    }
}

/// The stretch to which something is confined.
pub(super) fn interval(interval: &Interval) -> String {
    let what = match &interval.of {
        IntervalOf::Axis(letter) => letter.to_lowercase(),
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
        "The drive's own feedback shows it, so this is friction in the following error and not a gap in the drive train: there \
         is nothing to tighten behind the motor.",
    )
}

/// What a lost motion, or the gain of a lag or of an acceleration, below zero means; nothing for other findings.
pub(super) fn ahead(finding: &Finding) -> Option<&'static str> {
    let below = |name: &str| {
        let parameter = finding.parameters.iter().find(|parameter| parameter.name == name);
        matches!(parameter.map(|known| &known.value), Some(ParameterValue::Fitted(estimate)) if estimate.ci95.1 < 0.0)
    };
    if finding.kind() == TermKind::Lag {
        return below("gain").then_some(
            "Its value is negative: the drive leads its command by velocity over gain. Its feed-forward is too large, or the \
             loop is faster than the calibration says.",
        );
    }
    if finding.kind() == TermKind::Acceleration {
        return below("gain").then_some(
            "Its value is negative: the axis is ahead of its command by acceleration over gain. The drive's feed-forward of the \
             acceleration is too large.",
        );
    }
    below("lost_motion").then_some(
        "Its value is negative: after a reversal the axis seems to run ahead, which no backlash causes. Check the sign of the \
         sensor, and whether a calibration overcompensates.",
    )
}

/// What a load does inside a position loop; nothing for other findings.
pub(super) fn pushed(finding: &Finding) -> Option<&'static str> {
    (finding.kind() == TermKind::Compliance && finding.location.inside_loop).then_some(
        "The load acts on the drive itself, whose position loop yields until it balances the load. The size therefore depends on \
         the stiffness of the loop. Far more than a micrometre per newton means that the load is in another unit than its column \
         says.",
    )
}

/// What compensation takes away.
pub(super) fn removed(finding: &Finding) -> &'static str {
    if !finding.compensable {
        return "A controller cannot compensate it in real time: it does not know in time the quantity on which this depends.";
    }
    if friction(finding).is_some() {
        return "A correction at each reversal removes it; friction compensation in the drive is better.";
    }
    match finding.kind() {
        TermKind::Constant | TermKind::Polynomial | TermKind::Table | TermKind::Coupling => {
            "A controller can compensate it in real time within the measured range."
        }
        TermKind::Backlash => "A controller can compensate it in real time: a step at each reversal.",
        TermKind::Cyclic => {
            "A controller can compensate it in real time, as long as the reference position does not change."
        }
        TermKind::Lag => {
            "A controller can compensate it in real time; matched gains in the drives are better."
        }
        TermKind::Expansion | TermKind::Growth => {
            "A controller that reads the sensor can compensate it in real time."
        }
        TermKind::Delay => {
            "A controller can compensate it in real time; equal command paths for all drives are better."
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
        TermKind::Backlash => "The moment in which the axis crosses over remains.",
        TermKind::Lag => "Errors faster than the position loop remain.",
        TermKind::Expansion | TermKind::Growth => "The effect of heat that the sensor does not see remains.",
        TermKind::Cyclic => "Changes with wear and with heat along the screw remain.",
        TermKind::Table => "Errors between the nodes and outside the stretch remain.",
        TermKind::Constant | TermKind::Polynomial | TermKind::Coupling => {
            "Changes after the measurement remain."
        }
        TermKind::ReversalSpike => "Use friction compensation in the drive.",
        TermKind::Acceleration => {
            "Set the feed-forward of the acceleration in the drive anew, or use gentler motion."
        }
        TermKind::Drift => "Warm up the machine, or place a sensor at the heat source.",
        TermKind::Vibration => "Balance, damp or isolate its source.",
        TermKind::Compliance => "Use a stiffer set-up or less force.",
        TermKind::Delay => "Changes of the command within that time remain.",
        TermKind::Step => "Find out what moved, and measure again.",
        TermKind::Product => "Errors in states that the recording did not cover remain.",
    }
}
