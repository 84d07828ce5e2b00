//! Between machines: which of a kind is unlike the others. In: the same number of several machines. Out: the range in which one more of
//! the kind is expected, and how probable each is by chance.
//!
//! Machines of one kind differ: how much is estimated from them (random effects). Each machine is held against the others alone, since one
//! that is far off widens the range in which it stands. The weights are those of all machines, and what the others scatter in them is told by
//! the others: sums over all, less one machine each, so that a kind of many machines costs as much as they are.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use crate::change::{Level, level, mean, number};
use crate::name::Name;
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
    /// The term of the effect.
    pub term: String,
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

impl Range {
    /// What it is called, as the series are.
    pub(crate) fn name(&self) -> String {
        format!("{} of {}", self.parameter, self.effect)
    }
}

/// A number of one machine.
type Member<'s> = (Name, &'s str, &'s Series);

/// The ranges of all kinds. A number is compared among the machines in which its effect was found; of the others it is not known, and
/// not zero.
pub(crate) fn ranges<'s>(all: impl Iterator<Item = (&'s str, &'s str, &'s Series)>) -> Vec<Range> {
    let mut families: BTreeMap<(&str, &str, String), Vec<Member<'_>>> = BTreeMap::new();
    for (kind, machine, series) in all.filter(|(_, _, series)| !series.is_noise()) {
        let name = Name::of(&series.effect);
        let family = (kind, series.parameter.as_str(), name.family.clone());
        families.entry(family).or_default().push((name, machine, series));
    }
    let groups = families
        .into_iter()
        .flat_map(|((kind, ..), members)| alike(members).into_iter().map(move |members| (kind, members)));
    groups.filter_map(|(kind, members)| range(kind, &members)).collect()
}

/// The members of a family by their periods: a group goes on as long as the next one is like the first of it, and has a machine once.
fn alike(mut members: Vec<Member<'_>>) -> Vec<Vec<Member<'_>>> {
    members.sort_by(|(one, ..), (other, ..)| {
        one.period.partial_cmp(&other.period).unwrap_or(std::cmp::Ordering::Equal)
    });
    let mut groups: Vec<Vec<Member<'_>>> = Vec::new();
    let mut machines = BTreeSet::new();
    for member in members {
        match groups.last_mut() {
            Some(group)
                if group.first().is_some_and(|first| first.0.is_like(&member.0))
                    && !machines.contains(member.1) =>
            {
                machines.insert(member.1);
                group.push(member);
            }
            _ => {
                machines = BTreeSet::from([member.1]);
                groups.push(vec![member]);
            }
        }
    }
    groups
}

/// A machine with the level of its number.
type Mean<'s> = (&'s str, usize, Level);

fn range(kind: &str, members: &[Member<'_>]) -> Option<Range> {
    let means: Vec<Mean<'_>> = members
        .iter()
        .filter_map(|(_, machine, series)| Some((*machine, series.points.len(), mean(series)?)))
        .collect();
    if means.len() < FEWEST {
        return None;
    }
    let means = pooled(means);
    let all: Vec<(f64, f64)> = means.iter().map(|(_, _, mean)| (mean.value, mean.variance)).collect();
    let middle = level(&all)?;
    let half = quantile(0.05, middle.freedom) * (middle.variance + middle.scatter).sqrt();
    let sums = Sums::of(&all, middle.scatter);
    let own = |(machine, _, mean): &Mean<'_>| Own {
        machine: (*machine).to_owned(),
        value: mean.value,
        half: quantile(0.05, mean.freedom) * mean.variance.sqrt(),
        probability: sums.probability((mean.value, mean.variance)),
    };
    let first = members.first()?.2;
    Some(Range {
        kind: kind.to_owned(),
        effect: first.effect.clone(),
        parameter: first.parameter.clone(),
        term: first.term.clone(),
        unit: first.unit.clone(),
        expected: (middle.value - half, middle.value + half),
        machines: means.iter().map(own).collect(),
    })
}

/// The means, none told better than the recordings of all machines scatter: one that was recorded twice may have come out the same by
/// chance, and one that was recorded once says nothing of its scatter.
fn pooled(mut means: Vec<Mean<'_>>) -> Vec<Mean<'_>> {
    let weighed = means
        .iter()
        .filter(|(_, count, _)| *count > 1)
        .fold((0.0, 0.0), |sum, (_, _, mean)| (sum.0 + mean.freedom, sum.1 + mean.freedom * mean.scatter));
    let scatter = if weighed.0 > 0.0 { weighed.1 / weighed.0 } else { 0.0 };
    for (_, count, mean) in &mut means {
        let least = scatter / number((*count).max(1));
        if mean.variance < least {
            // What all machines tell has their degrees of freedom.
            *mean = Level { variance: least, freedom: mean.freedom.max(weighed.0), ..*mean };
        }
    }
    means
}

/// Sums over the machines of a kind: of weights, and of values and their squares in them.
struct Sums {
    scatter: f64,
    /// The middle, from which values are counted, so that squares of large ones do not cancel.
    zero: f64,
    count: f64,
    weights: f64,
    values: f64,
    squares: f64,
    /// The weights that the intervals alone would give.
    exact: f64,
}

impl Sums {
    fn of(all: &[(f64, f64)], scatter: f64) -> Self {
        let zero = all.iter().map(|(value, _)| value).sum::<f64>() / number(all.len().max(1));
        let mut sums =
            Self { scatter, zero, count: 0.0, weights: 0.0, values: 0.0, squares: 0.0, exact: 0.0 };
        for (value, variance) in all {
            let (value, weight) = (value - zero, sums.weight(*variance));
            sums.count += 1.0;
            sums.weights += weight;
            sums.values += weight * value;
            sums.squares += weight * value * value;
            sums.exact += exact(*variance);
        }
        sums
    }

    fn weight(&self, variance: f64) -> f64 {
        1.0 / (variance + self.scatter).max(f64::MIN_POSITIVE.sqrt())
    }

    /// How probable a machine is by chance among the others: how far it is from their mean, in what they scatter (the residual of a fit
    /// that does not know it). Where they scatter by less than their intervals have it, the intervals count.
    fn probability(&self, (value, variance): (f64, f64)) -> f64 {
        let (value, weight) = (value - self.zero, self.weight(variance));
        let weights = self.weights - weight;
        let values = self.values - weight * value;
        let squares = self.squares - weight * value * value - values * values / weights;
        let freedom = self.count - 2.0;
        let scatter = squares / freedom;
        let apart = value - values / weights;
        let own = (scatter / weight).max(variance);
        let others = (scatter / weights).max(1.0 / (self.exact - exact(variance)));
        two_sided(apart / (own + others).sqrt(), freedom)
    }
}

fn exact(variance: f64) -> f64 {
    1.0 / variance.max(f64::MIN_POSITIVE.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::{bounds, normals};
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
            untold: Vec::new(),
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
    fn a_machine_is_held_against_the_others_alone() {
        // Of values told exactly it is the mean of the others in their own scatter: Student's, with one value beside five.
        let values = [3.0, 3.4, 2.8, 3.1, 2.9, 4.0];
        let all: Vec<(f64, f64)> = values.iter().map(|value| (*value, 1e-12)).collect();
        let sums = Sums::of(&all, level(&all).unwrap().scatter);
        for (place, own) in values.iter().enumerate() {
            let others: Vec<f64> = values
                .iter()
                .enumerate()
                .filter(|(other, _)| *other != place)
                .map(|(_, value)| *value)
                .collect();
            let mean = others.iter().sum::<f64>() / 5.0;
            let variance = others.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 4.0;
            let truth = two_sided((own - mean) / (variance * 1.2).sqrt(), 4.0);
            let told = sums.probability((*own, 1e-12));
            assert!((told / truth - 1.0).abs() < 1e-6, "{own}: {told} and {truth}");
        }
    }

    #[test]
    fn machines_of_one_kind_are_unlike_as_often_as_chance_has_it() {
        // Intervals that are equal, and of which some are ten times as wide.
        for wide in [1.0, 10.0] {
            let of_kind = |seed: u64| {
                let drawn = normals(seed, 16);
                let one = |place: usize| {
                    let error = if place.is_multiple_of(4) { 0.3 * wide } else { 0.3 };
                    (drawn[place] + error * drawn[8 + place], error * error)
                };
                let all: Vec<(f64, f64)> = (0..8).map(one).collect();
                let sums = Sums::of(&all, level(&all).unwrap().scatter);
                // One of each kind, so that all are independent.
                sums.probability(all[usize::try_from(seed % 8).unwrap()]) < 0.05
            };
            let chance = (1..=2000).filter(|seed| of_kind(*seed)).count();
            let (_, most) = bounds(2000, 0.05);
            assert!(chance <= most, "{chance} of 2000, of which {most} may be, {wide} times as wide");
        }
    }

    #[test]
    fn one_recording_of_a_machine_does_not_tell_how_it_scatters() {
        let names: Vec<String> = (0..7).map(|number| format!("m{number}")).collect();
        let mut all: Vec<Series> = (0..7).map(|_| series("EXX backlash axis=X", 3.0)).collect();
        for (machine, one) in all.iter_mut().enumerate() {
            for (point, noise) in one.points.iter_mut().zip(normals(machine as u64 + 1, 4)) {
                (point.value, point.low, point.high) = (3.0 + noise, 3.0 + noise - 0.01, 3.0 + noise + 0.01);
            }
        }
        all[0].points.truncate(1);
        let point = all[0].points.first_mut().unwrap();
        (point.value, point.low, point.high) = (5.0, 4.99, 5.01);
        let ranges = ranges(all.iter().zip(&names).map(|(series, name)| ("mill", name.as_str(), series)));
        let odd = ranges[0].machines.iter().find(|own| own.machine == "m0").unwrap();
        assert!(
            odd.half > 1.0 && odd.probability > 0.01,
            "two standard deviations of one recording: {odd:?}"
        );
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
    }
}
