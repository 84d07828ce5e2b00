//! What happens to results when runs meet, recordings change, and files are broken.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;

use fleet::file::Fleet;
use fleet::{add, file, run};
use recording::Moment;

/// A folder that goes with its test.
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A stage that is read there and back, with a lost motion of so many um.
fn record(folder: &Path, name: &str, lost_motion: f64) {
    let mut table = "t,xc,xm\n".to_owned();
    let mut state = 12_345_u64;
    for row in 0..400_u32 {
        let part = f64::from(row) / 200.0;
        let (x, side) = if part < 1.0 { (200.0 * part, 0.5) } else { (200.0 * (2.0 - part), -0.5) };
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let noise = f64::from(u32::try_from(state >> 32).unwrap()) / f64::from(u32::MAX) - 0.5;
        table +=
            &format!("{:.2},{x:.4},{:.6}\n", 0.1 * f64::from(row), x - 1e-3 * (side * lost_motion + noise));
    }
    fs::write(folder.join(format!("{name}.csv")), table).unwrap();
    let text = format!(
        "recording: 1\nmachine: FX\ndate: {name}\ninstrument: position\ndata: {{file: {name}.csv}}\nchannels: {{time: {{column: t, unit: s}}, \
         command.x: {{column: xc, unit: mm}}, measured.x: {{column: xm, unit: mm}}}}\n"
    );
    fs::write(folder.join(format!("{name}.yaml")), text).unwrap();
}

const DAYS: [&str; 3] = ["2026-01-31", "2026-02-01", "2026-02-02"];

fn fleet(test: &str) -> (Folder, Fleet) {
    let folder = std::env::temp_dir().join(format!("abbe-fleet-runs-{}-{test}", std::process::id()));
    fs::create_dir_all(folder.join("a stage")).unwrap();
    for day in DAYS {
        record(&folder.join("a stage"), day, 4.0);
    }
    let text = "fleet: 1\nmachines: {stage 1/b: {recordings: \"a stage/2*.yaml\"}}\n";
    fs::write(folder.join("fleet.yaml"), text).unwrap();
    let fleet = file::read(&folder.join("fleet.yaml"), &()).ok().unwrap();
    (Folder(folder), fleet)
}

fn all(fleet: &Fleet) -> run::Done {
    match run::all(fleet, (None, false), &(), &|_| {}) {
        Ok(done) => done,
        Err(failure) => panic!("{:?}", failure.words().map(|words| words.text(false))),
    }
}

/// Every file below a folder with what it holds.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path))
        } else {
            drop(found.insert(path.clone(), fs::read(&path).unwrap()))
        }
    }
    found
}

#[test]
fn two_runs_at_once_give_what_one_gives() {
    let (_folder, fleet) = fleet("together");
    thread::scope(|scope| {
        let runs = [(), ()].map(|()| scope.spawn(|| all(&fleet)));
        for run in runs {
            run.join().unwrap();
        }
    });
    let together = files(&fleet.results);
    assert_eq!(together.len(), 4 * DAYS.len(), "{:?}", together.keys());
    let part = |name: &str| together.keys().filter(|path| path.to_string_lossy().contains(name)).count();
    assert_eq!((part("machine=stage%201%2Fb/month=2026-01"), part("month=2026-02")), (4, 8));
    fs::remove_dir_all(&fleet.results).unwrap();
    all(&fleet);
    assert!(files(&fleet.results) == together, "a run alone gives other bytes");
}

#[test]
fn a_recording_that_is_measured_anew_replaces_its_result() {
    let (folder, fleet) = fleet("anew");
    assert_eq!((all(&fleet).diagnosed, all(&fleet).diagnosed), (3, 0));
    record(&folder.0.join("a stage"), DAYS[1], 9.0);
    let done = all(&fleet);
    assert_eq!(done.diagnosed, 1);
    assert_eq!(files(&fleet.results).len(), 4 * DAYS.len());
    let history = fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
    let backlash = history.machines[0].series.iter().find(|known| known.series.term == "backlash").unwrap();
    let values: Vec<f64> = backlash.series.points.iter().map(|point| (point.value * 1e3).round()).collect();
    assert_eq!(values, [4.0, 9.0, 4.0]);
    assert!(backlash.change.is_none(), "three recordings tell no change");
}

#[test]
fn jobs_by_name_give_what_a_run_gives_and_old_names_are_refused() {
    let (folder, fleet) = fleet("jobs");
    let listed = run::pending(&fleet, None, &()).ok().unwrap();
    assert!(listed.iter().all(|job| job.stage == "diagnose") && listed.len() == 3);
    record(&folder.0.join("a stage"), DAYS[0], 5.0);
    let refused = |name: &str| run::one(&fleet, name, false).err().unwrap().words().unwrap().text(false);
    assert!(refused(&listed[0].job).contains("not as it was when it was listed"));
    assert!(refused("00-00").contains("no recording of the fleet"));
    for _ in 0..2 {
        for job in run::pending(&fleet, None, &()).ok().unwrap() {
            run::one(&fleet, &job.job, false).ok().unwrap();
        }
    }
    assert!(run::pending(&fleet, None, &()).ok().unwrap().is_empty());
    let by_name = files(&fleet.results);
    fs::rename(&fleet.results, folder.0.join("elsewhere")).unwrap();
    all(&fleet);
    assert!(files(&fleet.results) == by_name);
    // What was made elsewhere is taken over, but for what is known, or of another recording.
    fs::remove_dir_all(&fleet.results).unwrap();
    record(&folder.0.join("a stage"), DAYS[2], 5.0);
    let elsewhere = [folder.0.join("elsewhere")];
    let taken = |taken, known, refused| add::Added { taken, known, refused };
    assert_eq!(add::add(&fleet, &elsewhere, &()).ok().unwrap(), taken(2, 0, 1));
    assert_eq!(add::add(&fleet, &elsewhere, &()).ok().unwrap(), taken(0, 2, 1));
    assert!(add::add(&fleet, &[folder.0.join("nothing")], &()).is_err());
    assert_eq!(all(&fleet).diagnosed, 1);
}

#[test]
fn a_broken_result_is_told_and_nothing_panics() {
    let (_folder, fleet) = fleet("broken");
    all(&fleet);
    let whole = files(&fleet.results);
    for (path, bytes) in &whole {
        for broken in
            [&b""[..], b"PAR1", bytes.get(..bytes.len() / 2).unwrap(), b"PAR1aaaaPAR1\xff\xff\xff\x7fPAR1"]
        {
            fs::write(path, broken).unwrap();
            let history = fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
            assert_eq!(history.machines.len(), 1);
        }
        fs::write(path, bytes).unwrap();
    }
}
