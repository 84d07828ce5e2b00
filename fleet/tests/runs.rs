//! What happens to results when runs meet, recordings change, and files are broken.

#![expect(clippy::unwrap_used, clippy::panic, reason = "a test")]

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, SystemTime};

use abbe_fleet::file::Fleet;
use abbe_fleet::{add, file, run};
use recording::Moment;
use workshop::told::{Listener, Words};

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
    assert_eq!(backlash(&fleet), [4.0, 9.0, 4.0]);
}

#[test]
fn jobs_by_name_give_what_a_run_gives_and_old_names_are_refused() {
    let (folder, fleet) = fleet("jobs");
    let listed = run::pending(&fleet, None, &()).ok().unwrap().jobs;
    assert!(listed.iter().all(|job| job.stage == "diagnose") && listed.len() == 3);
    assert!(listed[0].job.ends_with("/stage%201%2Fb/a stage/2026-01-31.yaml"), "{}", listed[0].job);
    record(&folder.0.join("a stage"), DAYS[0], 5.0);
    let refused = |name: &str| run::one(&fleet, name, false).err().unwrap().words().unwrap().text(false);
    assert!(refused(&listed[0].job).contains("has changed since it was listed"));
    for unknown in [
        "00-00",
        "00/stage%201%2Fb/a stage/3.yaml",
        "00/stage%201%2Fb/fleet.yaml",
        "00/other/a",
        "follow-00/other",
    ] {
        assert!(refused(unknown).contains("no recording of the fleet"), "{unknown}");
    }
    assert!(refused("follow-00/stage%201%2Fb").contains("has changed since it was listed"));
    let stages = ["diagnose", "follow"].map(|stage| {
        let listed = run::pending(&fleet, None, &()).ok().unwrap().jobs;
        assert!(listed.iter().all(|job| job.stage == stage), "{stage}");
        listed.iter().for_each(|job| run::one(&fleet, &job.job, false).ok().unwrap());
        listed.len()
    });
    assert_eq!(stages, [3, 1], "a machine is followed by one job");
    assert!(run::pending(&fleet, None, &()).ok().unwrap().jobs.is_empty());
    let by_name = files(&fleet.results);
    fs::rename(&fleet.results, folder.0.join("elsewhere")).unwrap();
    all(&fleet);
    assert!(files(&fleet.results) == by_name);
    // What was made elsewhere is taken over, but for what is known, or of another recording.
    fs::remove_dir_all(&fleet.results).unwrap();
    record(&folder.0.join("a stage"), DAYS[2], 5.0);
    let elsewhere = [folder.0.join("elsewhere")];
    let taken = |taken, known, refused| add::Added { taken, known, refused };
    // A file that is spoilt, or of another result, ends nothing: it is refused with a line, and the rest is taken.
    let there = files(&folder.0.join("elsewhere"));
    let of = |part: &str| there.keys().find(|path| path.to_string_lossy().contains(part)).unwrap();
    let (one, two) = (
        of("parameters/machine=stage%201%2Fb/month=2026-01"),
        of("verdicts/machine=stage%201%2Fb/month=2026-01"),
    );
    for (path, bytes) in
        [(one, b"PAR1".to_vec()), (two, there[of("verdicts/machine=stage%201%2Fb/month=2026-02")].clone())]
    {
        fs::write(path, bytes).unwrap();
        let heard = Heard::default();
        assert_eq!(add::add(&fleet, &elsewhere, &heard).ok().unwrap().refused, 2);
        let told = |text: &&String| {
            text.contains("the result of a stage/2026-01-31.yaml is not added")
                && text.contains(path.to_str().unwrap())
        };
        assert_eq!(heard.0.borrow().iter().filter(told).count(), 1, "{:?}", heard.0);
        fs::write(path, &there[path]).unwrap();
    }
    fs::remove_dir_all(&fleet.results).unwrap();
    assert_eq!(add::add(&fleet, &elsewhere, &()).ok().unwrap(), taken(2, 0, 1));
    assert_eq!(add::add(&fleet, &elsewhere, &()).ok().unwrap(), taken(0, 2, 1));
    assert!(add::add(&fleet, &[folder.0.join("nothing")], &()).is_err());
    assert_eq!(all(&fleet).diagnosed, 1);
}

#[test]
fn a_job_by_name_looks_at_its_own_recording_alone() {
    let (folder, fleet) = fleet("alone");
    let listed = run::pending(&fleet, None, &()).ok().unwrap().jobs;
    // Nothing but the recording itself can be read.
    for day in DAYS.iter().skip(1) {
        fs::remove_file(folder.0.join(format!("a stage/{day}.yaml"))).unwrap();
    }
    run::one(&fleet, &listed[0].job, false).ok().unwrap();
    assert_eq!(files(&fleet.results).len(), 3);
}

/// What a run that was killed before it could take away what it replaced has left: the results of before beside those of now.
fn left_behind(fleet: &Fleet, before: &BTreeMap<PathBuf, Vec<u8>>) {
    for (path, bytes) in before {
        if !path.exists() {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, bytes).unwrap();
            // It was there first.
            let file = fs::File::options().write(true).open(path).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(3600)).unwrap();
        }
    }
    assert!(files(&fleet.results).len() > 4 * DAYS.len());
}

/// The lost motions of the stage over time, in um.
fn backlash(fleet: &Fleet) -> Vec<f64> {
    let history = abbe_fleet::history(fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
    let backlash = history.machines[0].series.iter().find(|known| known.series.term == "backlash").unwrap();
    backlash.series.points.iter().map(|point| (point.value * 1e3).round()).collect()
}

#[test]
fn a_kill_between_the_new_result_and_the_end_of_the_old_one_doubles_nothing() {
    let (folder, fleet) = fleet("killed");
    all(&fleet);
    let before = files(&fleet.results);
    record(&folder.0.join("a stage"), DAYS[1], 9.0);
    all(&fleet);
    let after = files(&fleet.results);
    left_behind(&fleet, &before);
    assert_eq!(backlash(&fleet), [4.0, 9.0, 4.0], "readers take the newer one of each recording");
    let history = abbe_fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
    assert_eq!(history.machines[0].recordings.len(), 3);
    let done = all(&fleet);
    assert_eq!((done.diagnosed, done.followed), (0, 0));
    assert!(files(&fleet.results) == after, "the next run takes the older ones away");
}

#[test]
fn a_recording_that_is_gone_stays_in_the_history_and_one_that_was_moved_counts_once() {
    let (folder, fleet) = fleet("moved");
    all(&fleet);
    let stage = folder.0.join("a stage");
    let machine = |fleet: &Fleet| {
        let history = abbe_fleet::history(fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
        let text = abbe_fleet::report::text(&history, 200);
        let listed: Vec<bool> = history.machines[0].recordings.iter().map(|entry| entry.listed).collect();
        (listed, text)
    };
    fs::rename(stage.join("2026-02-01.yaml"), stage.join("2-moved.yaml")).unwrap();
    fs::remove_file(stage.join("2026-02-02.yaml")).unwrap();
    let (listed, text) = machine(&fleet);
    assert_eq!(listed, [true, false, false]);
    assert!(text.contains("3 recordings, 2 of them missing"), "{text}");
    // Diagnosed under its new path it is one recording, of which the older result goes.
    assert_eq!(all(&fleet).diagnosed, 1);
    let (listed, text) = machine(&fleet);
    assert_eq!(listed, [true, true, false]);
    assert!(text.contains("3 recordings, 1 of them missing"), "{text}");
    all(&fleet);
    let names: Vec<PathBuf> = files(&fleet.results).into_keys().collect();
    assert_eq!(names.len(), 4 * DAYS.len(), "{names:?}");
    assert_eq!(backlash(&fleet), [4.0, 4.0, 4.0]);
    // A machine that the fleet file names no more is told.
    let text = "fleet: 1\nmachines: {other: {recordings: \"a stage/2*.yaml\"}}\n";
    fs::write(folder.0.join("fleet.yaml"), text).unwrap();
    let heard = Heard::default();
    let other = file::read(&folder.0.join("fleet.yaml"), &()).ok().unwrap();
    abbe_fleet::history(&other, Moment::read("2026-03-01").unwrap(), &heard).ok().unwrap();
    assert!(heard.0.borrow().iter().any(|text| text.contains("results of `stage 1/b`")), "{:?}", heard.0);
}

/// What was said.
#[derive(Default)]
struct Heard(RefCell<Vec<String>>);

impl Listener for Heard {
    fn hear(&self, words: &Words) {
        self.0.borrow_mut().push(words.text(false));
    }
}

#[test]
#[cfg(unix)]
fn what_cannot_be_read_now_is_put_off_and_what_is_wrong_is_filed() {
    let (folder, fleet) = fleet("later");
    let data = |day: &str| folder.0.join(format!("a stage/{day}.csv"));
    let aside = fs::read(data(DAYS[0])).unwrap();
    // A link to itself cannot be opened, as a file that is locked or on a disk that does not answer.
    fs::remove_file(data(DAYS[0])).unwrap();
    std::os::unix::fs::symlink(data(DAYS[0]), data(DAYS[0])).unwrap();
    // No such file, and no table: that lasts until somebody changes it.
    fs::remove_file(data(DAYS[1])).unwrap();
    fs::write(data(DAYS[2]), "nothing").unwrap();
    let heard = Heard::default();
    let done = run::all(&fleet, (None, false), &heard, &|_| {}).ok().unwrap();
    assert_eq!((done.recordings, done.diagnosed, done.errors, done.put_off), (3, 0, 2, 1));
    let listed = run::pending(&fleet, None, &heard).ok().unwrap();
    assert_eq!((listed.jobs.iter().filter(|job| job.stage == "diagnose").count(), listed.put_off), (0, 1));
    assert_eq!(
        heard.0.borrow().iter().filter(|text| text.contains("2026-01-31.yaml is postponed")).count(),
        2
    );
    let put_off = |text: &String| text.contains("2026-01-31.yaml is postponed to the next run");
    assert!(heard.0.borrow().iter().any(put_off), "{:?}", heard.0);
    let known = |of: &str| {
        files(&fleet.results.join("verdicts"))
            .into_keys()
            .filter(|path| path.to_string_lossy().contains(of))
            .count()
    };
    assert_eq!((known("2026-01"), known("2026-02")), (0, 2));
    assert_eq!(
        (all(&fleet).diagnosed, all(&fleet).put_off),
        (0, 1),
        "what is wrong is not read again, what is put off is"
    );
    fs::remove_file(data(DAYS[0])).unwrap();
    fs::write(data(DAYS[0]), aside).unwrap();
    let done = all(&fleet);
    assert_eq!((done.diagnosed, done.put_off), (1, 0));
    // A result that is there stays while its recording cannot be read.
    let whole = files(&fleet.results);
    fs::remove_file(data(DAYS[0])).unwrap();
    std::os::unix::fs::symlink(data(DAYS[0]), data(DAYS[0])).unwrap();
    assert_eq!(all(&fleet).put_off, 1);
    assert!(files(&fleet.results) == whole);
}

#[test]
fn the_history_of_a_day_knows_nothing_of_what_was_found_later() {
    let (folder, fleet) = fleet("until");
    // Nothing is to be found before the last day.
    for day in DAYS.iter().take(2) {
        record(&folder.0.join("a stage"), day, 0.0);
    }
    all(&fleet);
    let on = |moment: &str| {
        let history = abbe_fleet::history(&fleet, Moment::read(moment).unwrap(), &()).ok().unwrap();
        let [machine] = history.machines.try_into().ok().unwrap();
        let followed = machine.series.iter().filter(|known| known.series.term == "backlash");
        (machine.recordings.len(), followed.map(|known| known.series.points.len()).collect::<Vec<_>>())
    };
    assert_eq!(on("2026-02-01T23:59:59"), (2, vec![]));
    assert_eq!(on("2026-02-02"), (3, vec![3]));
}

#[test]
fn pages_are_drawn_later_and_go_with_their_results() {
    let (folder, fleet) = fleet("pages");
    all(&fleet);
    let pages = || files(&fleet.results.join("pages")).into_keys().collect::<Vec<_>>();
    assert!(pages().is_empty());
    let done = run::all(&fleet, (None, true), &(), &|_| {}).ok().unwrap();
    assert_eq!((done.diagnosed, pages().len()), (0, 3));
    record(&folder.0.join("a stage"), DAYS[1], 9.0);
    let before = pages();
    run::all(&fleet, (None, true), &(), &|_| {}).ok().unwrap();
    assert_eq!(pages().len(), 3);
    assert_ne!(pages(), before, "the page of what was measured anew takes the place of the old one");
}

#[test]
fn what_is_not_told_says_why() {
    let (folder, fleet) = fleet("why");
    let text = || {
        all(&fleet);
        let history = abbe_fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
        abbe_fleet::report::text(&history, 200)
    };
    let few = text();
    assert!(
        few.contains("1 number and the noise are followed; changes are reported from 5 recordings on"),
        "{few}"
    );
    for day in DAYS {
        fs::write(folder.0.join(format!("a stage/{day}.csv")), "nothing").unwrap();
    }
    let none = text();
    assert!(none.contains("no recording gives a number to follow"), "{none}");
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
            let heard = Heard::default();
            let history =
                abbe_fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &heard).ok().unwrap();
            let heard = heard.0.into_inner();
            let told =
                |text: &String| text.contains(path.to_str().unwrap()) && text.contains("cannot be read");
            assert_eq!(heard.iter().filter(|text| told(text)).count(), 1, "{heard:?}");
            let entries = history.machines[0].recordings.len();
            let is_entry =
                ["/recordings/", "/verdicts/"].iter().any(|of| path.to_string_lossy().contains(of));
            assert_eq!(entries, DAYS.len() - usize::from(is_entry));
        }
        fs::remove_file(path).unwrap();
        let heard = Heard::default();
        abbe_fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &heard).ok().unwrap();
        let is_of_recording =
            ["/parameters/", "/verdicts/"].iter().any(|of| path.to_string_lossy().contains(of));
        let told = |text: &&String| text.contains(path.to_str().unwrap()) && text.contains("is missing");
        assert_eq!(
            heard.0.borrow().iter().filter(told).count(),
            usize::from(is_of_recording),
            "{:?}",
            heard.0
        );
        fs::write(path, bytes).unwrap();
    }
}

#[test]
fn a_result_that_is_spoilt_is_made_again() {
    let (_folder, fleet) = fleet("spoilt");
    all(&fleet);
    let whole = files(&fleet.results);
    let of = |path: &Path| path.strip_prefix(&fleet.results).unwrap().iter().next().unwrap().to_owned();
    for (path, bytes) in &whole {
        // That of the same table of another recording.
        let other = whole.keys().find(|other| *other != path && of(other) == of(path)).unwrap();
        let half = bytes.get(..bytes.len() / 2).unwrap();
        let spoilt =
            [Some(&b""[..]), Some(b"garbage that is no table"), Some(half), Some(&whole[other]), None];
        for bytes in spoilt {
            match bytes {
                Some(bytes) => fs::write(path, bytes).unwrap(),
                None => fs::remove_file(path).unwrap(),
            }
            let listed = run::pending(&fleet, None, &()).ok().unwrap().jobs;
            let is_followed = of(path) == "followed";
            let stage = if is_followed { "follow" } else { "diagnose" };
            assert_eq!(listed.iter().map(|job| job.stage).collect::<Vec<_>>(), [stage], "{}", path.display());
            let heard = Heard::default();
            let done = run::all(&fleet, (None, false), &heard, &|_| {}).ok().unwrap();
            assert_eq!((done.diagnosed, done.followed), if is_followed { (0, 1) } else { (1, 0) });
            // What says that a result is there was taken away: nothing is wrong, and there is much to do.
            let is_undone = bytes.is_none() && (is_followed || of(path) == "recordings");
            let told =
                |text: &&String| text.contains("is computed again") && text.contains(path.to_str().unwrap());
            assert_eq!(
                heard.0.borrow().iter().filter(told).count(),
                usize::from(!is_undone),
                "{:?}",
                heard.0
            );
            assert!(files(&fleet.results) == whole, "{} is made again", path.display());
        }
    }
}

#[test]
fn a_spoilt_result_of_a_recording_that_is_gone_does_not_stop_its_machine_nor_others() {
    let (folder, fleet) = fleet("gone");
    all(&fleet);
    fs::remove_file(folder.0.join("a stage/2026-01-31.yaml")).unwrap();
    let gone = files(&fleet.results);
    for table in ["verdicts", "parameters"] {
        let path = gone.keys().find(|path| {
            let path = path.to_string_lossy();
            path.contains(table) && path.contains("month=2026-01")
        });
        fs::write(path.unwrap(), "garbage").unwrap();
    }
    record(&folder.0.join("a stage"), DAYS[1], 9.0);
    let heard = Heard::default();
    let done = run::all(&fleet, (None, false), &heard, &|_| {}).ok().unwrap();
    assert_eq!((done.diagnosed, done.followed), (1, 2));
    let told = |text: &&String| text.contains("month=2026-01") && text.contains("cannot be read");
    assert_eq!(heard.0.borrow().iter().filter(told).count(), 2, "{:?}", heard.0);
}

#[test]
#[cfg(unix)]
fn what_is_no_file_is_a_recording_that_is_wrong() {
    let (folder, fleet) = fleet("no-file");
    let stage = folder.0.join("a stage");
    // A link to nothing, a recording that is a pipe, and one whose data are: nobody ever writes into either.
    std::os::unix::fs::symlink(stage.join("nothing"), stage.join("2-link.yaml")).unwrap();
    for pipe in ["2-pipe.yaml", "2026-01-31.csv"] {
        let _ = fs::remove_file(stage.join(pipe));
        assert!(std::process::Command::new("mkfifo").arg(stage.join(pipe)).status().unwrap().success());
    }
    let done = all(&fleet);
    assert_eq!((done.recordings, done.diagnosed, done.errors, done.put_off), (5, 2, 3, 0));
    let history = abbe_fleet::history(&fleet, Moment::read("9999-01-01").unwrap(), &()).ok().unwrap();
    let wrong: BTreeMap<&str, &str> = history.machines[0]
        .recordings
        .iter()
        .filter(|entry| entry.verdict == "error")
        .map(|entry| (entry.recording.as_str(), entry.sentence.as_str()))
        .collect();
    assert!(wrong["a stage/2-link.yaml"].contains("cannot read"), "{wrong:?}");
    for pipe in ["a stage/2-pipe.yaml", "a stage/2026-01-31.yaml"] {
        assert!(wrong[pipe].contains("a pipe or a device"), "{wrong:?}");
    }
    assert_eq!(all(&fleet).errors, 3);
}

/// Whether the rights of files bind this process: they do not bind root.
#[cfg(unix)]
fn is_bound(folder: &Path) -> bool {
    fs::read_dir(folder).is_err()
}

#[test]
#[cfg(unix)]
fn a_folder_that_cannot_be_read_is_postponed() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, fleet) = fleet("locked");
    all(&fleet);
    let whole = files(&fleet.results);
    let stage = folder.0.join("a stage");
    fs::set_permissions(&stage, fs::Permissions::from_mode(0o000)).unwrap();
    if is_bound(&stage) {
        let heard = Heard::default();
        let listed = run::pending(&fleet, None, &heard).ok().unwrap();
        assert_eq!((listed.jobs.len(), listed.put_off), (0, 1));
        let done = run::all(&fleet, (None, false), &heard, &|_| {}).ok().unwrap();
        assert_eq!((done.recordings, done.put_off), (0, 1));
        let told = |text: &&String| {
            text.contains("a stage is postponed to the next run: the folder cannot be read now")
        };
        assert_eq!(heard.0.borrow().iter().filter(told).count(), 2, "{:?}", heard.0);
        assert!(files(&fleet.results) == whole, "what is there stays");
    }
    fs::set_permissions(&stage, fs::Permissions::from_mode(0o755)).unwrap();
    assert_eq!(all(&fleet).put_off, 0);
}

#[test]
fn a_history_says_what_is_wrong_and_what_is_pending() {
    let (folder, fleet) = fleet("open");
    let shown = || {
        let history = abbe_fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
        let pages = abbe_fleet::report::pages(&history, "abbe", &|_| None);
        let (_, index) = pages.files.into_iter().find(|(name, _)| name == "index.html").unwrap();
        let json: serde_json::Value = serde_json::from_str(&abbe_fleet::report::json(&history)).unwrap();
        (abbe_fleet::report::text(&history, 200), index, json)
    };
    let (text, index, _) = shown();
    assert!(text.contains("stage 1/b: no result yet, 3 pending") && index.contains("3 pending"), "{text}");
    fs::write(folder.0.join(format!("a stage/{}.csv", DAYS[0])), "nothing").unwrap();
    all(&fleet);
    record(&folder.0.join("a stage"), DAYS[2], 9.0);
    let (text, index, json) = shown();
    assert!(text.contains("3 recordings, 1 with errors, 1 pending"), "{text}");
    assert!(text.contains(&format!("cannot be diagnosed: a stage/{}.yaml: error: ", DAYS[0])), "{text}");
    assert!(index.contains("1 with errors, 1 pending"), "{index}");
    assert_eq!((&json["schema"], &json["machines"][0]["pending"]), (&"abbe-fleet/1".into(), &1.into()));
    // Measured after the moment that is asked for, it is not waited for.
    let before = abbe_fleet::history(&fleet, Moment::read("2026-02-01").unwrap(), &()).ok().unwrap();
    assert_eq!((before.machines[0].errors(), before.machines[0].pending), (1, 0));
    all(&fleet);
    let (text, ..) = shown();
    assert!(text.contains("3 recordings, 1 with errors;"), "{text}");
}

#[test]
fn the_change_of_a_noise_says_that_it_is_of_logarithms() {
    let (folder, fleet) = fleet("logarithm");
    for day in 3..10 {
        record(&folder.0.join("a stage"), &format!("2026-02-{day:02}"), 4.0);
    }
    all(&fleet);
    let history = abbe_fleet::history(&fleet, Moment::read("2026-03-01").unwrap(), &()).ok().unwrap();
    let mut scales = BTreeMap::new();
    for followed in &history.machines[0].series {
        let (series, change) = (&followed.series, followed.change.as_ref().unwrap());
        scales.insert(series.effect.clone(), change.scale);
        // The level at the beginning is one of the values, in the unit or as its logarithm.
        let level = if change.scale == "logarithm" { change.before.0.exp() } else { change.before.0 };
        let ends =
            |of: fn(f64, f64) -> f64, from| series.points.iter().map(|point| point.value).fold(from, of);
        assert!(
            level > 0.5 * ends(f64::min, f64::MAX) && level < 2.0 * ends(f64::max, 0.0),
            "{level} in {series:?}"
        );
    }
    assert_eq!((scales["noise"], scales["EXX backlash"]), ("logarithm", "value"));
}
