//! Gathering. In: the tables of results. Out: machines with their recordings and series, in the order of time.

use std::collections::BTreeMap;

use recording::Moment;
use workshop::failure::Failure;
use workshop::told::Listener;

use super::{Entry, Followed, Machine};
use crate::diagnosed::{ERROR, time_of};
use crate::file::Fleet;
use crate::results::{Filed, Known, Table, read};
use crate::series::{Point, Series};

/// The name of the series of noise.
const NOISE: &str = "noise";

/// The machines of a fleet, with what was recorded until a moment.
pub(super) fn machines(
    fleet: &Fleet,
    until: Moment,
    listener: &dyn Listener,
) -> Result<Vec<Machine>, Failure> {
    let mut hear = |why: String| listener.hear(&why.into());
    let mut verdicts = by_machine(read(&fleet.results, Table::Verdicts, None, &mut hear)?, until);
    let mut recordings = by_machine(read(&fleet.results, Table::Recordings, None, &mut hear)?, until);
    let mut followed = by_machine(read(&fleet.results, Table::Followed, None, &mut hear)?, until);
    let machine = |machine: &crate::file::Machine| {
        let of = |rows: &mut BTreeMap<String, Vec<(Moment, Known)>>| {
            rows.remove(&machine.name).unwrap_or_default()
        };
        let (verdicts, recordings) = (of(&mut verdicts), of(&mut recordings));
        let mut series = series(&of(&mut followed));
        series.extend(noise(&verdicts));
        Machine {
            name: machine.name.clone(),
            kind: machine.kind.clone(),
            recordings: entries(fleet, &verdicts, &recordings),
            series: series
                .into_iter()
                .map(|series| Followed { series, change: None, alarm: false })
                .collect(),
        }
    };
    Ok(fleet.machines.iter().map(machine).collect())
}

/// The rows of each machine up to a moment, in the order of time; of one moment in that of the paths.
fn by_machine(rows: Vec<Known>, until: Moment) -> BTreeMap<String, Vec<(Moment, Known)>> {
    let mut machines: BTreeMap<String, Vec<(Moment, Known)>> = BTreeMap::new();
    for known in rows {
        if let Some(time) = time_of(known.row.count("time")).filter(|time| *time <= until) {
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

fn entries(fleet: &Fleet, verdicts: &[(Moment, Known)], recordings: &[(Moment, Known)]) -> Vec<Entry> {
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
            page,
        })
    };
    verdicts.iter().filter_map(entry).collect()
}

/// The numbers that were followed, in the order of their names.
fn series(followed: &[(Moment, Known)]) -> Vec<Series> {
    let mut all: BTreeMap<(&str, &str), Series> = BTreeMap::new();
    for (time, Known { row, .. }) in followed {
        let Some((value, low, high)) = row
            .number("value")
            .zip(row.number("low"))
            .zip(row.number("high"))
            .map(|((value, low), high)| (value, low, high))
        else {
            continue;
        };
        let series = all.entry((row.text("effect"), row.text("parameter"))).or_insert_with(|| Series {
            effect: row.text("effect").to_owned(),
            motion: row.text("motion").to_owned(),
            term: row.text("term").to_owned(),
            parameter: row.text("parameter").to_owned(),
            unit: row.text("unit").to_owned(),
            points: Vec::new(),
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
    all.into_values().collect()
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
        });
        let recording = row.text("recording").to_owned();
        series.points.push(Point { time: *time, recording, value, low: value, high: value, claimed: true });
    }
    all.into_values().collect()
}
