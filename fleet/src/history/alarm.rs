//! Alarms. In: what every series does, and where each machine stands among its kind. Out: what is no chance, in words, with the recordings
//! that it rests on and what to look at.
//!
//! A fleet of many machines asks hundreds of questions each time it is looked at, and chance answers one of a hundred of them. So the
//! bound is one for all questions together (Holm): the plainest is held against the bound over their number, the next against the bound
//! over one less, until one fails. It holds however the series hang together.

use diagnosis::look_at;
use serde::Serialize;

use super::{Change, Machine, Own, Range, Series};
use crate::report::number;

/// How probable it may be that any alarm of a look at the whole fleet is chance: one look of a hundred. A false alarm costs a machine an
/// hour of measuring, and fewer would hide what grows for some weeks more.
pub const BOUND: f64 = 0.01;

/// A noise is told from a fifth on. The level that a recording of a hundred independent readings tells has a standard error of 7 %, and
/// 1.96 times that of the difference of two is a fifth: below, no second recording would show it.
const NOISE: f64 = 0.2;

/// Something that changed.
#[derive(Clone, Debug, Serialize)]
pub struct Alarm {
    /// The machine.
    pub machine: String,
    /// `trend`, `step`, `appears`, `noise` or `unlike`.
    pub kind: &'static str,
    /// What it is about: `EXX backlash axis=X`.
    pub effect: String,
    /// Which number of it.
    pub parameter: String,
    /// What happened, a sentence.
    pub reason: String,
    /// What to look at first, a clause.
    pub look_at: String,
    /// How large the change is: from the first recording to the last of a trend, over a step; how far the machine is from the middle of
    /// its kind.
    pub size: f64,
    /// The unit of the size; of a noise it is the factor.
    pub unit: String,
    /// How probable it is by chance, before the number of questions is allowed for.
    pub probability: f64,
    /// The recordings that it rests on, the first and the last of each stretch: of a step those beside it.
    pub recordings: Vec<String>,
}

/// What to look at for a term; for the noise, which is none, at the instrument.
fn look(term: &str) -> String {
    look_at(term).unwrap_or("the instrument, its mounting, and equipment near the machine").to_owned()
}

/// A question that was asked: how probable its answer is by chance, the alarm that it would be, and the numbers of machine and series.
type Asked = (f64, Option<Alarm>, Option<(usize, usize)>);

/// The alarms, the plainest first, and how many questions were asked. Series of which there is one are marked.
pub(super) fn alarms(machines: &mut [Machine], ranges: &[Range]) -> (Vec<Alarm>, usize) {
    let mut found: Vec<Asked> = Vec::new();
    for (number, machine) in machines.iter().enumerate() {
        for (place, followed) in machine.series.iter().enumerate() {
            if let Some(change) = &followed.change {
                found.push((
                    change.probability,
                    of_change(&machine.name, &followed.series, change),
                    Some((number, place)),
                ));
            }
        }
    }
    for range in ranges {
        found.extend(range.machines.iter().map(|own| (own.probability, Some(unlike(range, own)), None)));
    }
    let questions = found.len();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let count = |number: usize| f64::from(u32::try_from(number).unwrap_or(u32::MAX));
    let mut alarms = Vec::new();
    for (asked, (probability, alarm, place)) in found.into_iter().enumerate() {
        if probability > BOUND / count(questions - asked) {
            break;
        }
        let Some(alarm) = alarm else { continue };
        if let Some((machine, series)) = place
            && let Some(followed) =
                machines.get_mut(machine).and_then(|machine| machine.series.get_mut(series))
        {
            followed.alarm = true;
        }
        alarms.push(alarm);
    }
    (alarms, questions)
}

/// The alarm of a change; nothing where it is smaller than what one recording tells, which no test would show.
fn of_change(machine: &str, series: &Series, change: &Change) -> Option<Alarm> {
    let mut halves: Vec<f64> = series.points.iter().map(|point| (point.high - point.low) / 2.0).collect();
    halves.sort_by(f64::total_cmp);
    let least = if series.is_noise() {
        NOISE.ln_1p()
    } else {
        halves.get(halves.len() / 2).copied().unwrap_or_default()
    };
    if change.size.abs() <= least {
        return None;
    }
    let (first, last) = (series.points.first()?, series.points.last()?);
    let (recordings, when) = match change.kind {
        "trend" => (
            vec![first.recording.clone(), last.recording.clone()],
            format!("from {} to {}", first.time.day(), last.time.day()),
        ),
        _ => {
            let (before, after) =
                (series.points.get(change.from.checked_sub(1)?)?, series.points.get(change.from)?);
            let stretch = [first, before, after, last].map(|point| point.recording.clone()).to_vec();
            (stretch, format!("between {} and {}", before.time.day(), after.time.day()))
        }
    };
    let name = series.name();
    let unit = &series.unit;
    let mut alarm = Alarm {
        machine: machine.to_owned(),
        kind: change.kind,
        effect: series.effect.clone(),
        parameter: series.parameter.clone(),
        reason: String::new(),
        look_at: look(&series.term),
        size: change.size,
        unit: unit.clone(),
        probability: change.probability,
        recordings,
    };
    if series.is_noise() {
        let factor = change.size.exp();
        let goes = if factor > 1.0 { "rises" } else { "falls" };
        let (from, to) = (number(change.before.0.exp(), unit), number(change.after.0.exp(), unit));
        let count = series.points.len();
        alarm.reason = format!("the {name} {goes} from {from} to {to} {when}, in {count} recordings.");
        (alarm.kind, alarm.size, alarm.unit) = ("noise", factor, String::new());
        return Some(alarm);
    }
    // Two intervals that both hold nothing, and one that does no more.
    let (before, after) = (change.before, change.after);
    let appears = before.0.abs() <= before.1 && after.0.abs() > after.1;
    let interval = |(value, half): (f64, f64)| format!("{} +- {}", number(value, unit), number(half, unit));
    let sizes = format!("from {} to {}", interval(before), interval(after));
    // Of what appears, the recordings before do not show it.
    let since = if appears { series.points.get(change.from..)? } else { series.points.as_slice() };
    let claimed = since.iter().filter(|point| point.claimed).count();
    let of = if since.len() < series.points.len() {
        format!("the {} from then on", since.len())
    } else {
        "them".to_owned()
    };
    let rests = format!(
        "it is followed in {} recordings, and {claimed} of {of} find it on their own",
        series.points.len()
    );
    alarm.reason = match change.kind {
        "trend" => {
            let goes = if change.size * after.0 < 0.0 { "falls" } else { "grows" };
            let week = number(change.per_week.abs(), unit);
            format!("{name} {goes} by {week} a week, {sizes}, {when}; {rests}.")
        }
        _ if appears => format!("{name} appears {when}: {sizes}; {rests}."),
        _ => format!("{name} steps {when}, {sizes}; {rests}."),
    };
    if appears {
        alarm.kind = "appears";
    }
    Some(alarm)
}

fn unlike(range: &Range, own: &Own) -> Alarm {
    let unit = &range.unit;
    let (low, high) = (number(range.expected.0, unit), number(range.expected.1, unit));
    let middle = (range.expected.0 + range.expected.1) / 2.0;
    Alarm {
        machine: own.machine.clone(),
        kind: "unlike",
        effect: range.effect.clone(),
        parameter: range.parameter.clone(),
        reason: format!(
            "{} is {} +- {}; of {} machines of the kind {} one more is expected from {low} to {high}.",
            range.name(),
            number(own.value, unit),
            number(own.half, unit),
            range.machines.len(),
            range.kind
        ),
        look_at: look(&range.term),
        size: own.value - middle,
        unit: unit.clone(),
        probability: own.probability,
        recordings: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use recording::Moment;

    use super::of_change;
    use crate::change::change;
    use crate::series::{Point, Series};

    /// A squareness in 20 weeks, which some recordings find on their own.
    fn alarm(values: impl Fn(i64) -> f64, claimed: impl Fn(i64) -> bool) -> String {
        let point = |week: i64| {
            let value = values(week) + if week % 2 == 0 { 0.1 } else { -0.1 };
            let time = Moment::new(week * 604_800).unwrap();
            let (recording, claimed) = (format!("{week}.yaml"), claimed(week));
            Point { time, recording, value, low: value - 0.2, high: value + 0.2, claimed }
        };
        let series = Series {
            effect: "EC0Y constant".to_owned(),
            motion: "EC0Y".to_owned(),
            term: "constant".to_owned(),
            parameter: "value".to_owned(),
            unit: "rad".to_owned(),
            points: (0..20).map(point).collect(),
            untold: Vec::new(),
        };
        of_change("mill", &series, &change(&series).unwrap()).unwrap().reason
    }

    #[test]
    fn what_appears_rests_on_the_recordings_from_then_on() {
        // Found once before by chance, and once not after.
        let appears = alarm(|week| if week < 12 { 0.0 } else { 8.0 }, |week| week == 3 || week > 12);
        assert!(appears.contains(" appears between "), "{appears}");
        let rests = "; it is followed in 20 recordings, and 7 of the 8 from then on find it on their own.";
        assert!(appears.ends_with(rests), "{appears}");
        let steps = alarm(|week| if week < 12 { 5.0 } else { 8.0 }, |week| week > 1);
        assert!(steps.contains(" steps between "), "{steps}");
        assert!(
            steps.ends_with("; it is followed in 20 recordings, and 18 of them find it on their own."),
            "{steps}"
        );
        let grows = alarm(|week| 5.0 + f64::from(i32::try_from(week).unwrap()), |_| true);
        assert!(
            grows.contains(" grows by ") && grows.ends_with("and 20 of them find it on their own."),
            "{grows}"
        );
    }
}
