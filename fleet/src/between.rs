//! Between machines: which of a kind is unlike the others. In: the same number of several machines. Out: the range in which one more of
//! the kind is expected, and how probable each is by chance.
//!
//! Machines of one kind differ: how much is estimated from them (random effects). Each machine is held against the others alone, since one
//! that is far off widens the range in which it stands.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::change::{level, mean};
use crate::series::Series;
use crate::student::{quantile, two_sided};

/// The fewest machines of a kind that give a range: the others of each must tell their own scatter.
const FEWEST: usize = 5;

/// What is expected of one number of a kind of machines.
#[derive(Clone, Debug, Serialize)]
pub struct Range {
    /// The kind of the machines.
    pub kind: String,
    /// What it is of: `EXX backlash axis=X`.
    pub effect: String,
    /// Which number of it.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Where one more machine of the kind is expected with 95 %.
    pub expected: (f64, f64),
    /// Every machine that has it.
    pub machines: Vec<Own>,
}

/// One machine beside the others.
#[derive(Clone, Debug, Serialize)]
pub struct Own {
    /// Its name.
    pub machine: String,
    /// Its mean over all recordings.
    pub value: f64,
    /// Half of the 95 % interval of the mean.
    pub half: f64,
    /// How probable it is by chance among the others.
    pub probability: f64,
}

/// The ranges of all kinds. A number is compared among the machines in which its effect was found; of the others it is not known, and
/// not zero.
pub(crate) fn ranges<'s>(all: impl Iterator<Item = (&'s str, &'s str, &'s Series)>) -> Vec<Range> {
    let mut groups: BTreeMap<(&str, &str), Vec<Group<'_>>> = BTreeMap::new();
    for (kind, machine, series) in all.filter(|(_, _, series)| !series.is_noise()) {
        let name = Name::of(&series.effect);
        let known = groups.entry((kind, &series.parameter)).or_default();
        match known
            .iter_mut()
            .find(|(other, members)| other.is(&name) && members.iter().all(|(of, _)| *of != machine))
        {
            Some((_, members)) => members.push((machine, series)),
            None => known.push((name, vec![(machine, series)])),
        }
    }
    let found = groups.into_iter().flat_map(|((kind, _), groups)| {
        groups.into_iter().filter_map(move |(_, members)| range(kind, &members))
    });
    found.collect()
}

/// An effect with the machines that have it, by their names.
type Group<'s> = (Name, Vec<(&'s str, &'s Series)>);

/// The name of an effect, the period of a wave apart.
struct Name {
    family: String,
    period: Option<f64>,
}

/// Waves of two machines of a kind are one where their periods lie within this share: screws of one catalogue have it to far less, and
/// the next wave is a harmonic.
const SAME_PERIOD: f64 = 0.05;

impl Name {
    fn of(effect: &str) -> Self {
        let mut words: Vec<&str> = effect.split(' ').collect();
        let period = words.len().checked_sub(2).and_then(|place| words.get(place)?.parse().ok());
        if period.is_some() {
            words.truncate(words.len().saturating_sub(2));
        }
        Self { family: words.join(" "), period }
    }

    fn is(&self, other: &Self) -> bool {
        self.family == other.family
            && match (self.period, other.period) {
                (Some(one), Some(two)) => (one - two).abs() <= SAME_PERIOD * one.abs(),
                (None, None) => true,
                _ => false,
            }
    }
}

fn range(kind: &str, members: &[(&str, &Series)]) -> Option<Range> {
    let means: Vec<(&str, f64, f64)> = members
        .iter()
        .filter_map(|(machine, series)| mean(series).map(|(value, variance)| (*machine, value, variance)))
        .collect();
    if means.len() < FEWEST {
        return None;
    }
    let all: Vec<(f64, f64)> = means.iter().map(|(_, value, variance)| (*value, *variance)).collect();
    let (middle, variance, scatter) = level(&all)?;
    let number = |count: usize| f64::from(u32::try_from(count).unwrap_or(u32::MAX));
    let half = quantile(0.05, number(all.len().saturating_sub(2))) * (variance + scatter).sqrt();
    let own = |(place, (machine, value, own)): (usize, &(&str, f64, f64))| {
        let others: Vec<(f64, f64)> =
            all.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, known)| *known).collect();
        let (middle, variance, scatter) = level(&others)?;
        let apart = (value - middle) / (own + variance + scatter).sqrt();
        let probability = two_sided(apart, number(others.len().saturating_sub(2)));
        let half = 1.959_964 * own.sqrt();
        Some(Own { machine: (*machine).to_owned(), value: *value, half, probability })
    };
    let first = members.first()?.1;
    Some(Range {
        kind: kind.to_owned(),
        effect: first.effect.clone(),
        parameter: first.parameter.clone(),
        unit: first.unit.clone(),
        expected: (middle - half, middle + half),
        machines: means.iter().enumerate().filter_map(own).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::Point;
    use recording::Moment;

    fn series(effect: &str, value: f64) -> Series {
        let points = (0..4).map(|week| Point {
            time: Moment::new(week * 604_800).unwrap(),
            recording: String::new(),
            value,
            low: value - 0.1,
            high: value + 0.1,
            claimed: true,
        });
        Series {
            effect: effect.to_owned(),
            motion: "EXX".to_owned(),
            term: "backlash".to_owned(),
            parameter: "lost_motion".to_owned(),
            unit: "mm".to_owned(),
            points: points.collect(),
        }
    }

    #[test]
    fn the_odd_one_of_a_kind_is_told_and_does_not_hide_itself() {
        let values = [3.0, 3.4, 2.8, 3.1, 2.9, 3.2, 12.0];
        let names: Vec<String> = (0..values.len()).map(|number| format!("m{number}")).collect();
        let all: Vec<Series> = values.iter().map(|value| series("EXX backlash axis=X", *value)).collect();
        let ranges = ranges(all.iter().zip(&names).map(|(series, name)| ("mill", name.as_str(), series)));
        let [range] = ranges.as_slice() else { panic!("{ranges:?}") };
        let odd: Vec<&str> = range
            .machines
            .iter()
            .filter(|own| own.probability < 1e-3)
            .map(|own| own.machine.as_str())
            .collect();
        assert_eq!(odd, ["m6"]);
        assert!(range.machines.iter().take(6).all(|own| own.probability > 0.1));
    }

    #[test]
    fn waves_of_one_screw_are_compared_and_few_machines_are_not() {
        let names: Vec<String> = (0..6).map(|number| format!("m{number}")).collect();
        let periods = ["10 mm", "10.02 mm", "9.99 mm", "10.1 mm", "5 mm", "5.01 mm"];
        let all: Vec<Series> =
            periods.iter().map(|period| series(&format!("EXX cyclic axis=X {period}"), 1.0)).collect();
        let of = |count: usize| {
            ranges(all.iter().zip(&names).take(count).map(|(one, name)| ("mill", name.as_str(), one)))
        };
        assert!(of(6).is_empty(), "four of one period and two of another");
        assert!(Name::of("EXX cyclic axis=X 10 mm").is(&Name::of("EXX cyclic axis=X 10.02 mm")));
        assert!(!Name::of("EXX cyclic axis=X 10 mm").is(&Name::of("EXX cyclic axis=X 5 mm")));
    }
}
