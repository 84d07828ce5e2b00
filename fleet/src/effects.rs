//! The effects of a machine. In: what was found in each of its recordings. Out: each effect once, in the form in which it was found most
//! surely, of a wave in that with the sharpest period: what is followed in all of them.

use std::collections::{BTreeMap, BTreeSet};

use diagnosis::{is_event, told_by};

use crate::key::Sum;
use crate::name::Name;
use crate::shelf::Known;
use crate::table::Row;

/// An effect of a machine.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Effect {
    /// What it is called: motion and term, with what tells it from others of the same name.
    pub(crate) name: String,
    pub(crate) motion: String,
    pub(crate) term: String,
    pub(crate) at_drive: bool,
    /// The calibration that holds it alone.
    pub(crate) calibration: String,
    /// The recordings in which it was found.
    pub(crate) found_in: BTreeSet<String>,
    family: String,
    /// The period of a wave, or its frequency, with its interval.
    period: Option<Period>,
    /// How many half widths of an interval its greatest number is from nothing where it was found most surely.
    certainty: f64,
}

/// The period of a wave along an axis, or the frequency of one in time.
#[derive(Clone, Debug, PartialEq)]
struct Period {
    value: f64,
    half: f64,
    unit: String,
}

/// What was found in one recording under one name.
struct Found {
    id: String,
    effect: Effect,
}

/// The most effects that are followed in a machine, those found most often first: a machine with three axes has 21 error motions, and no
/// recording tells three terms of each of them apart.
const MOST: usize = 64;

/// Two waves are one where their periods differ by less than this many times the half widths of both intervals, put together as errors
/// that know nothing of each other are: 4.9 standard errors of the difference, which chance passes once in a million pairs. A machine has
/// up to some ten thousand recordings, each of which is held against the surest one, and one in a hundred machines may get a wave twice.
const TOGETHER: f64 = 2.5;

/// The effects of a machine, those found most often first, then the surest: what is not told from others is then the rarest.
pub(crate) fn effects(parameters: &[Known]) -> Vec<Effect> {
    let mut found: Vec<Found> = findings(parameters).into_values().filter_map(|rows| found(&rows)).collect();
    // The sharpest first; the rest is only so that the order is always the same.
    found.sort_by(|a, b| {
        let sharpest = b.effect.sharpness().total_cmp(&a.effect.sharpness());
        sharpest.then_with(|| a.id.cmp(&b.id)).then_with(|| a.effect.name.cmp(&b.effect.name))
    });
    let mut effects: Vec<Effect> = Vec::new();
    for Found { id, mut effect } in found {
        match effects.iter_mut().find(|known| known.is(&effect)) {
            Some(known) => {
                known.certainty = known.certainty.max(effect.certainty);
                known.found_in.insert(id);
            }
            None => {
                effect.found_in.insert(id);
                effects.push(effect);
            }
        }
    }
    effects.sort_by(|a, b| {
        let often = b.found_in.len().cmp(&a.found_in.len());
        often.then_with(|| b.certainty.total_cmp(&a.certainty))
    });
    effects.truncate(MOST);
    named_apart(&mut effects);
    effects
}

/// The sum of what is followed in a recording, given by its key and its id.
pub(crate) fn key((recording, id): (&str, &str), effects: &[Effect]) -> String {
    let sum = Sum::versioned().text("followed").text(recording);
    let sum = effects.iter().fold(sum, |sum, effect| {
        let claimed = if effect.found_in.contains(id) { "claimed" } else { "" };
        let side = if effect.at_drive { "at drive" } else { "" };
        let share = effect.share().to_string();
        sum.text(&effect.name).text(&effect.calibration).text(&share).text(side).text(claimed)
    });
    sum.digits()
}

/// The rows of each finding of each recording.
fn findings(parameters: &[Known]) -> BTreeMap<(&str, i64), Vec<&Known>> {
    let mut findings: BTreeMap<(&str, i64), Vec<&Known>> = BTreeMap::new();
    for known in parameters {
        let number = known.row.count("finding").unwrap_or_default();
        findings.entry((&known.id, number)).or_default().push(known);
    }
    findings
}

fn found(rows: &[&Known]) -> Option<Found> {
    let first = rows.first()?;
    let row = &first.row;
    let term = row.text("term");
    let (motion, family) = (row.text("motion").to_owned(), row.text("family").to_owned());
    if is_event(term) {
        return None;
    }
    let told_by = told_by(term).unwrap_or_default();
    let period =
        rows.iter().map(|known| &known.row).find(|row| row.text("parameter") == told_by).and_then(period);
    let certainty = rows.iter().filter_map(|known| certainty(&known.row, told_by)).fold(0.0, f64::max);
    Some(Found {
        id: first.id.clone(),
        effect: Effect {
            name: family.clone(),
            motion,
            term: term.to_owned(),
            at_drive: row.flag("at_drive"),
            calibration: row.text("calibration").to_owned(),
            found_in: BTreeSet::new(),
            family,
            period,
            certainty,
        },
    })
}

fn period(row: &Row) -> Option<Period> {
    let half = (row.number("high")? - row.number("low")?) / 2.0;
    Some(Period { value: row.number("value")?, half, unit: row.text("unit").to_owned() })
}

/// How many standard errors a size is from nothing.
fn certainty(row: &Row, told_by: &str) -> Option<f64> {
    let name = row.text("parameter");
    if [told_by, "phase", "wind_up", "decay", "time_constant"].contains(&name) {
        return None;
    }
    let half = (row.number("high")? - row.number("low")?) / 2.0;
    Some(row.number("value")?.abs() / half).filter(|certainty| certainty.is_finite())
}

impl Effect {
    /// How well it is known what stays the same in all recordings: of a wave its period, in half widths of the interval of that. A wave
    /// whose period is off by a hundredth is an eighth of a turn off a dozen turns away, and is followed too small. Of anything
    /// else how sure its size is.
    fn sharpness(&self) -> f64 {
        if self.share() > 0.0 { 1.0 / self.share() } else { self.certainty }
    }

    /// Half the interval of the period of a wave as a share of it; 0 of anything else.
    pub(crate) fn share(&self) -> f64 {
        self.period.as_ref().map_or(0.0, |period| period.half / period.value.abs())
    }

    /// Whether another one is the same: of the same family, with a period that may be the same.
    fn is(&self, other: &Self) -> bool {
        self.family == other.family
            && match (&self.period, &other.period) {
                (Some(one), Some(two)) => {
                    (one.value - two.value).abs() <= TOGETHER * one.half.hypot(two.half)
                }
                (None, None) => true,
                _ => false,
            }
    }
}

/// Gives waves of one family their periods as names.
fn named_apart(effects: &mut [Effect]) {
    for effect in effects {
        if let Some(Period { value, half, unit }) = &effect.period {
            effect.name = Name::of_wave(&effect.family, (*value, *half), unit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Table;
    use crate::table::{Cell, read, written};

    /// A wave that was found in a recording, deg: its amplitude with half of the interval, and its period with half of that.
    struct Wave(&'static str, [f64; 2], [f64; 2]);

    /// The rows of waves of one family.
    fn rows(waves: &[Wave]) -> Vec<Known> {
        let row = |Wave(id, amplitude, period): &Wave| {
            let of = |name: &str, [value, half]: [f64; 2]| {
                let cell = |column: &str| match column {
                    "motion" => Cell::from("ECC"),
                    "term" => Cell::from("cyclic"),
                    "family" => Cell::from("ECC cyclic"),
                    "parameter" => Cell::from(name),
                    "value" => Cell::from(value),
                    "low" => Cell::from(value - half),
                    "high" => Cell::from(value + half),
                    "unit" => Cell::from("deg"),
                    "recording" | "calibration" => Cell::from(*id),
                    "finding" => Cell::Count(0),
                    _ => Cell::None,
                };
                Table::Parameters.columns().iter().map(|(column, _)| cell(column)).collect::<Vec<_>>()
            };
            [of("period", *period), of("amplitude", *amplitude), of("phase", [1.0, 0.1])]
        };
        let rows: Vec<Vec<Cell>> = waves.iter().flat_map(row).collect();
        let own = format!("{}-{:?}", std::process::id(), std::thread::current().id());
        let path = std::env::temp_dir().join(format!("abbe-effects-{own}.parquet"));
        std::fs::write(&path, written(Table::Parameters.columns(), &rows).unwrap()).unwrap();
        let read = read(&path, Table::Parameters.columns()).unwrap();
        std::fs::remove_file(&path).unwrap();
        let known =
            |row: Row| Known { machine: "mount".to_owned(), id: row.text("recording").to_owned(), row };
        read.into_iter().map(known).collect()
    }

    #[test]
    fn a_wave_has_the_period_that_is_known_best_and_not_that_of_the_surest_size() {
        let found = rows(&[
            // Loud, in a recording of a few turns; faint, in a long one; and another wave.
            Wave("short", [9.0, 0.1], [2.10, 0.05]),
            Wave("long", [2.0, 1.0], [2.003, 0.011]),
            Wave("other", [1.0, 0.5], [0.668, 0.002]),
        ]);
        let effects = effects(&found);
        let told: Vec<(&str, &str, usize)> = effects
            .iter()
            .map(|effect| (effect.name.as_str(), effect.calibration.as_str(), effect.found_in.len()))
            .collect();
        assert_eq!(told, [("ECC cyclic 2 deg", "long", 2), ("ECC cyclic 0.668 deg", "other", 1)]);
        assert!((effects[0].share() - 0.011 / 2.003).abs() < 1e-12);
    }

    #[test]
    fn the_key_of_what_is_followed_knows_how_well_the_period_is_known() {
        let key_of =
            |half: f64| key(("key", "long"), &effects(&rows(&[Wave("long", [2.0, 1.0], [2.003, half])])));
        // The same name, rounded.
        assert_ne!(key_of(0.011), key_of(0.012));
        assert_eq!(key_of(0.011), key_of(0.011));
    }
}
