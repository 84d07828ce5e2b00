//! Gathering. In: the tables of results. Out: machines with their recordings and series, in the order of time.

use std::collections::{BTreeMap, BTreeSet};

use recording::Moment;
use workshop::failure::Failure;
use workshop::told::Listener;

use super::{Entry, Followed, Machine};
use crate::diagnosed::{ERROR, time_of};
use crate::file::Fleet;
use crate::jobs::places;
use crate::name::Name;
use crate::results::{Filed, Table};
use crate::series::{NOISE, Point, Series, Untold};
use crate::shelf::{Current, Known, check, machines as filed_machines, read};

/// The machines of a fleet, with what was recorded until a moment.
pub(super) fn machines(
    fleet: &Fleet,
    until: Moment,
    listener: &dyn Listener,
) -> Result<Vec<Machine>, Failure> {
    let mut hear = |why: String| listener.hear(&why.into());
    let places = places(fleet, &());
    let listed: BTreeSet<&str> = places.found.iter().map(|place| place.id.as_str()).collect();
    let current = Current::of(&fleet.results, None, &listed)?;
    let mut rows =
        |table| Ok::<_, Failure>(by_machine(read(&fleet.results, table, (None, &current), &mut hear)?));
    let (mut verdicts, mut recordings) = (rows(Table::Verdicts)?, rows(Table::Recordings)?);
    let mut followed = rows(Table::Followed)?;
    check(&fleet.results, Table::Parameters, (None, &current), &mut hear)?;
    let named: BTreeSet<&str> = fleet.machines.iter().map(|machine| machine.name.as_str()).collect();
    for name in filed_machines(&fleet.results)? {
        if !named.contains(name.as_str()) {
            let text = format!(
                "warning: results of `{name}` are not shown, because the fleet file does not name this machine"
            );
            listener.hear(&text.into());
        }
    }
    let pending = crate::plan::undone(fleet, places.clone(), until, listener)?;
    let machine = |(number, machine): (usize, &crate::file::Machine)| {
        let of = |rows: &mut BTreeMap<String, Vec<(Moment, Known)>>| {
            rows.remove(&machine.name).unwrap_or_default()
        };
        let verdicts: Vec<_> = of(&mut verdicts).into_iter().filter(|(time, _)| *time <= until).collect();
        let recordings = of(&mut recordings);
        let mut series = series(&of(&mut followed), &listed, until);
        series.extend(noise(&verdicts));
        Machine {
            name: machine.name.clone(),
            kind: machine.kind.clone(),
            pending: pending.get(&number).copied().unwrap_or_default(),
            recordings: entries(fleet, &verdicts, &recordings, &listed),
            series: series
                .into_iter()
                .map(|series| Followed { series, change: None, alarm: false })
                .collect(),
        }
    };
    Ok(fleet.machines.iter().enumerate().map(machine).collect())
}

/// The rows of each machine in the order of time; of one moment in that of the paths.
fn by_machine(rows: Vec<Known>) -> BTreeMap<String, Vec<(Moment, Known)>> {
    let mut machines: BTreeMap<String, Vec<(Moment, Known)>> = BTreeMap::new();
    for known in rows {
        if let Some(time) = time_of(known.row.count("time")) {
            machines.entry(known.machine.clone()).or_default().push((time, known));
        }
    }
    for rows in machines.values_mut() {
        rows.sort_by(|a, b| {
            a.0.cmp(&b.0).then_with(|| a.1.row.text("recording").cmp(b.1.row.text("recording")))
        });
    }
    machines
}

fn entries(
    fleet: &Fleet,
    verdicts: &[(Moment, Known)],
    recordings: &[(Moment, Known)],
    listed: &BTreeSet<&str>,
) -> Vec<Entry> {
    let errors: BTreeMap<&str, &str> =
        recordings.iter().map(|(_, known)| (known.id.as_str(), known.row.text("error"))).collect();
    let entry = |(time, known): &(Moment, Known)| {
        // Without a row among the recordings the job is not done.
        let error = errors.get(known.id.as_str())?;
        let filed = Filed { machine: &known.machine, time: *time, id: &known.id, key: known.row.text("key") };
        let page = Some(filed.page(&fleet.results)).filter(|page| page.is_file());
        let sentence = if known.row.text("verdict") == ERROR { error } else { known.row.text("sentence") };
        Some(Entry {
            time: *time,
            recording: known.row.text("recording").to_owned(),
            verdict: known.row.text("verdict").to_owned(),
            sentence: sentence.to_owned(),
            listed: listed.contains(known.id.as_str()),
            page,
        })
    };
    verdicts.iter().filter_map(entry).collect()
}

/// The names under which effects are followed now: that of a wave has its period as it was found most surely, which changes while there
/// are more recordings. The rows of a recording that is no longer there keep an older one, and belong to the like effect of today.
struct Names<'r> {
    today: BTreeMap<&'r str, Name>,
}

impl<'r> Names<'r> {
    fn of(followed: &'r [(Moment, Known)], listed: &BTreeSet<&str>) -> Self {
        let today = followed.iter().filter(|(_, known)| listed.contains(known.id.as_str()));
        let names = today.map(|(_, known)| known.row.text("effect"));
        Self { today: names.map(|name| (name, Name::of(name))).collect() }
    }

    fn today<'s>(&'s self, name: &'s str) -> &'s str {
        if self.today.contains_key(name) {
            return name;
        }
        let own = Name::of(name);
        self.today.iter().find(|(_, other)| other.is_like(&own)).map_or(name, |(today, _)| today)
    }
}

/// The numbers that were followed until a moment, in the order of their names: of effects that were found by then. One that was found in
/// no recording that it is followed in is always told.
fn series(followed: &[(Moment, Known)], listed: &BTreeSet<&str>, until: Moment) -> Vec<Series> {
    let names = Names::of(followed, listed);
    let claims = followed.iter().filter(|(_, known)| known.row.flag("claimed"));
    let mut found: BTreeMap<&str, Moment> = BTreeMap::new();
    for (time, known) in claims {
        found.entry(names.today(known.row.text("effect"))).or_insert(*time);
    }
    let mut all: BTreeMap<(&str, &str), Series> = BTreeMap::new();
    let mut untold: BTreeMap<&str, Vec<Untold>> = BTreeMap::new();
    for (time, Known { row, .. }) in followed.iter().filter(|(time, _)| *time <= until) {
        let effect = names.today(row.text("effect"));
        if found.get(effect).is_some_and(|found| *found > until) {
            continue;
        }
        if !row.text("untold").is_empty() {
            let (recording, why) = (row.text("recording").to_owned(), row.text("untold").to_owned());
            untold.entry(effect).or_default().push(Untold { time: *time, recording, why });
        }
        let Some((value, low, high)) = row
            .number("value")
            .zip(row.number("low"))
            .zip(row.number("high"))
            .map(|((value, low), high)| (value, low, high))
        else {
            continue;
        };
        let series = all.entry((effect, row.text("parameter"))).or_insert_with(|| Series {
            effect: effect.to_owned(),
            motion: row.text("motion").to_owned(),
            term: row.text("term").to_owned(),
            parameter: row.text("parameter").to_owned(),
            unit: row.text("unit").to_owned(),
            points: Vec::new(),
            untold: Vec::new(),
        });
        if series.unit == row.text("unit") {
            let recording = row.text("recording").to_owned();
            series.points.push(Point {
                time: *time,
                recording,
                value,
                low,
                high,
                claimed: row.flag("claimed"),
            });
        }
    }
    let with_untold = |((effect, _), series): ((&str, &str), Series)| {
        let untold = untold.get(effect).cloned().unwrap_or_default();
        Series { untold, ..series }
    };
    all.into_iter().map(with_untold).collect()
}

/// The noise of each recording, apart by its unit: a machine may be measured by instruments of length and of angle.
fn noise(verdicts: &[(Moment, Known)]) -> Vec<Series> {
    let mut all: BTreeMap<&str, Series> = BTreeMap::new();
    for (time, Known { row, .. }) in verdicts {
        let Some(value) = row.number(NOISE).filter(|value| *value > 0.0) else { continue };
        let series = all.entry(row.text("unit")).or_insert_with(|| Series {
            effect: NOISE.to_owned(),
            motion: String::new(),
            term: String::new(),
            parameter: NOISE.to_owned(),
            unit: row.text("unit").to_owned(),
            points: Vec::new(),
            untold: Vec::new(),
        });
        let recording = row.text("recording").to_owned();
        series.points.push(Point { time: *time, recording, value, low: value, high: value, claimed: true });
    }
    all.into_values().collect()
}
