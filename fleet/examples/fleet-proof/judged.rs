//! What a history makes of a simulated shop. In: a shop with its results. Out: when each planted change was raised, every other alarm, and
//! how many intervals hold the truth.

use abbe_fleet::file::Fleet;
use abbe_fleet::history;

use crate::shop::{PLANTED, Shop};

/// What was made of a planted change.
#[derive(Debug, Default)]
pub(crate) struct Raised {
    /// The machine and the effect.
    pub(crate) what: String,
    /// The week in which it was raised first, counted from 1.
    pub(crate) week: Option<usize>,
    /// What is said in the last week.
    pub(crate) sentence: String,
    /// `trend` or `step`, in the last week.
    pub(crate) kind: &'static str,
    /// The size with half of its 95 % interval, mm or rad.
    pub(crate) size: (f64, f64),
    /// The recording at which it steps.
    pub(crate) from: usize,
    /// In how many recordings it was found by itself, of those before the week in which it begins, and of the others.
    pub(crate) claimed: (usize, usize),
}

/// What was made of it.
#[derive(Debug, Default)]
pub(crate) struct Judged {
    /// The planted changes.
    pub(crate) raised: Vec<Raised>,
    /// Alarms about anything else in any week, each once.
    pub(crate) other: Vec<String>,
    /// Series in which nothing was planted.
    pub(crate) quiet: usize,
    /// Intervals that hold the truth, and all.
    pub(crate) held: (usize, usize),
}

/// Looks at a shop week by week.
pub(crate) fn judged(shop: Shop, fleet: &Fleet) -> Judged {
    let mut judged = Judged {
        raised: PLANTED
            .iter()
            .map(|(machine, effect, _)| Raised {
                what: format!("{}: {effect}", shop.name(*machine)),
                ..Raised::default()
            })
            .collect(),
        ..Judged::default()
    };
    for week in 0..shop.weeks {
        let history = history(fleet, shop.time(week), &()).expect("a history");
        for alarm in &history.alarms {
            let planted = |(machine, effect, parameter): &(usize, &str, &str)| {
                shop.name(*machine) == alarm.machine
                    && alarm.effect.starts_with(effect)
                    && alarm.parameter == *parameter
            };
            match PLANTED.iter().position(planted).and_then(|number| judged.raised.get_mut(number)) {
                Some(raised) => {
                    raised.week.get_or_insert(week + 1);
                    raised.sentence.clone_from(&alarm.reason);
                }
                None => judged.other.push(format!("week {}: {}: {}", week + 1, alarm.machine, alarm.reason)),
            }
        }
        if week + 1 == shop.weeks {
            count(shop, &history, &mut judged);
        }
    }
    judged
}

fn count(shop: Shop, history: &abbe_fleet::History, judged: &mut Judged) {
    for (number, machine) in history.machines.iter().enumerate() {
        for followed in &machine.series {
            let series = &followed.series;
            let planted = |(machine, effect, parameter): &(usize, &str, &str)| {
                *machine == number && series.effect.starts_with(effect) && series.parameter == *parameter
            };
            match PLANTED.iter().position(planted).and_then(|number| judged.raised.get_mut(number)) {
                Some(raised) => tell(shop, followed, raised),
                None => judged.quiet += 1,
            }
            for point in series.points.iter().filter(|_| !series.term.is_empty()) {
                let week =
                    (0..shop.weeks).find(|week| shop.time(*week).day() == point.time.day()).expect("a week");
                let truth = shop.truth(number, week).of(&series.effect, &series.parameter);
                judged.held.0 += usize::from((point.low..=point.high).contains(&truth));
                judged.held.1 += 1;
            }
        }
    }
}

fn tell(shop: Shop, followed: &abbe_fleet::history::Followed, raised: &mut Raised) {
    if let Some(change) = &followed.change {
        (raised.kind, raised.size, raised.from) = (change.kind, (change.size, change.half), change.from);
    }
    let claimed = |point: &&abbe_fleet::history::Point| point.claimed;
    let (before, after) = followed.series.points.split_at(shop.step().min(followed.series.points.len()));
    raised.claimed = (before.iter().filter(claimed).count(), after.iter().filter(claimed).count());
}
