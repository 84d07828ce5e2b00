//! Elements of drives in words. In: what a wave repeats with. Out: a sentence that names it, as a person at the machine does.

use model_dsl::machine::ElementKind;

use super::figure::{Kind, given};
use crate::diagnosis::{Finding, Repeats};

/// What a wave repeats with; nothing for other findings.
pub(super) fn repeats(finding: &Finding) -> Option<String> {
    let all = &finding.repeats_with;
    let often = all.iter().filter(|one| one.element == ElementKind::Axis).map(often);
    let periods: Vec<String> = all.iter().filter_map(period).collect();
    let period = (!periods.is_empty()).then(|| format!("the period is {}", periods.join(", or ")));
    let said: Vec<String> = often.chain(period).collect();
    (!said.is_empty()).then(|| format!("Here {}.", said.join(", and ")))
}

fn often(one: &Repeats) -> String {
    let times = match one.harmonic {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        3 => "three times".to_owned(),
        many => format!("{many} times"),
    };
    format!("it occurs {times} per turn of the axis")
}

/// The period as that of an element, `half the pitch of the screw (10 mm)`; nothing for the axis itself.
fn period(one: &Repeats) -> Option<String> {
    let size = given(one.period, one.unit, Kind::Travel);
    let whole = match one.element {
        ElementKind::Axis => return None,
        ElementKind::Screw => format!("the pitch of the screw ({size})"),
        ElementKind::Worm { teeth } => format!("a turn of the worm ({teeth} teeth, {size})"),
        ElementKind::Motor => format!("a turn of the motor ({size})"),
        ElementKind::Scale => format!("the grating of the scale ({size})"),
        ElementKind::Encoder { lines } => format!("a line of the encoder ({lines} a turn, {size})"),
    };
    let fraction = match one.harmonic {
        1 => String::new(),
        2 => "half ".to_owned(),
        3 => "a third of ".to_owned(),
        4 => "a quarter of ".to_owned(),
        many => format!("1/{many} of "),
    };
    Some(fraction + &whole)
}
