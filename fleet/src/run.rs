//! Running jobs. In: a fleet. Out: a result for each of its recordings, those that are there already left as they are.
//!
//! Jobs have two stages. Each recording is diagnosed; when all of a machine are, what was found in any of them is followed in each. A
//! machine whose effects have changed since is followed anew, which takes a small part of the time.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use rayon::prelude::*;
use serde::Serialize;
use workshop::failure::Failure;
use workshop::told::Listener;

use crate::diagnosed;
use crate::effects::{Effect, effects, key};
use crate::file::Fleet;
use crate::followed;
use crate::jobs::{Job, job, places};
use crate::results::{Filed, Table, There, read, tidy};

/// One of several parts into which jobs are shared, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which part.
    pub part: usize,
    /// Of how many.
    pub of: usize,
}

/// What a run has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Recordings that are there.
    pub recordings: usize,
    /// Recordings that were diagnosed.
    pub diagnosed: usize,
    /// Recordings in which what was found was followed.
    pub followed: usize,
    /// Machines that wait until all of their recordings are diagnosed.
    pub waiting: usize,
}

/// How far a run has come.
#[derive(Clone, Copy, Debug)]
pub struct Step<'s> {
    /// What is done.
    pub step: &'s str,
    /// How many jobs are done, and how many there are.
    pub done: (usize, usize),
}

/// A job that is still to be done.
#[derive(Clone, Debug, Serialize)]
pub struct Pending {
    /// Its name, which [`one`] takes.
    pub job: String,
    /// `diagnose`, or `follow` when all recordings of the machine are diagnosed.
    pub stage: &'static str,
    /// The machine.
    pub machine: String,
    /// The recording: a path from the fleet's folder.
    pub recording: String,
    /// When it was made.
    pub time: String,
}

impl Pending {
    /// The job as a line of JSON.
    #[must_use]
    pub fn line(&self) -> String {
        serde_json::to_string(self).map(|line| line + "\n").unwrap_or_default()
    }
}

/// Before the name of a job that follows.
const FOLLOW: &str = "follow-";

impl Shard {
    /// Reads `3/16`.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let (part, of) = text.split_once('/')?;
        let (part, of) = (part.trim().parse().ok()?, of.trim().parse().ok()?);
        (1..=of).contains(&part).then_some(Self { part, of })
    }

    /// Whether a job is of this part: by the sum of its name, so that a recording more moves no other.
    fn has(self, id: &str) -> bool {
        let digits = id.get(id.len().saturating_sub(8)..).unwrap_or_default();
        let number = usize::try_from(u32::from_str_radix(digits, 16).unwrap_or_default()).unwrap_or_default();
        number.checked_rem(self.of) == Some(self.part.saturating_sub(1))
    }
}

/// The recordings of a fleet with what is there of them.
struct Plan<'f> {
    fleet: &'f Fleet,
    jobs: Vec<Job>,
    there: BTreeMap<Table, There>,
}

impl<'f> Plan<'f> {
    fn new(fleet: &'f Fleet, listener: &dyn Listener) -> Result<Self, Failure> {
        let places = places(fleet, listener);
        let jobs = places.into_par_iter().map(|place| job(fleet, place)).collect();
        let mut plan = Self { fleet, jobs, there: BTreeMap::new() };
        plan.look()?;
        Ok(plan)
    }

    /// Looks anew which results are there.
    fn look(&mut self) -> Result<(), Failure> {
        for table in Table::ALL {
            self.there.insert(table, There::of(&self.fleet.results, table)?);
        }
        Ok(())
    }

    fn of(&self, table: Table) -> There {
        self.there.get(&table).cloned().unwrap_or_default()
    }

    fn filed<'j>(&'j self, job: &'j Job, key: &'j str) -> Filed<'j> {
        let machine = self.fleet.machines.get(job.place.machine).map_or("", |machine| &machine.name);
        Filed { machine, time: job.time, id: &job.place.id, key }
    }

    fn is_diagnosed(&self, job: &Job) -> bool {
        let there = self.there.get(&Table::Recordings);
        there.is_some_and(|there| {
            there.holds(&self.fleet.results, &self.filed(job, &job.key), Table::Recordings)
        })
    }

    /// What is to be diagnosed, of one part or of all.
    fn undiagnosed(&self, shard: Option<Shard>) -> Vec<&Job> {
        let own = |job: &&Job| shard.is_none_or(|shard| shard.has(&job.place.id));
        self.jobs.iter().filter(own).filter(|job| !self.is_diagnosed(job)).collect()
    }

    /// What is to be followed, machine by machine, of those of which all is diagnosed; and how many others there are.
    fn unfollowed(&self, shard: Option<Shard>) -> Result<(Vec<Follow<'_>>, usize), Failure> {
        let (mut pending, mut waiting) = (Vec::new(), 0);
        for number in 0..self.fleet.machines.len() {
            let jobs: Vec<&Job> = self.jobs.iter().filter(|job| job.place.machine == number).collect();
            if jobs.iter().any(|job| !self.is_diagnosed(job)) {
                waiting += 1;
                continue;
            }
            pending.extend(self.follow_of(number, &jobs)?.into_iter().filter(|follow| {
                shard.is_none_or(|shard| shard.has(&follow.job.place.id)) && !self.is_followed(follow)
            }));
        }
        Ok((pending, waiting))
    }

    /// The second stage of the jobs of a machine.
    fn follow_of<'j>(&self, number: usize, jobs: &[&'j Job]) -> Result<Vec<Follow<'j>>, Failure> {
        let Some(machine) = self.fleet.machines.get(number).filter(|_| !jobs.is_empty()) else {
            return Ok(Vec::new());
        };
        let mut broken = Vec::new();
        let parameters =
            read(&self.fleet.results, Table::Parameters, Some(&machine.name), &mut |why| broken.push(why))?;
        let verdicts =
            read(&self.fleet.results, Table::Verdicts, Some(&machine.name), &mut |why| broken.push(why))?;
        if let Some(why) = broken.first() {
            return Err(Failure::no(
                why.replacen("warning", "error", 1)
                    + "\nhelp: remove it, and the file of the same name in `recordings`: it is then made anew",
            ));
        }
        let unfit: Vec<&str> = verdicts
            .iter()
            .filter(|known| is_unfit(known.row.text("verdict"), known.row.count("changes")))
            .map(|known| known.id.as_str())
            .collect();
        let fit = parameters.iter().filter(|known| !unfit.contains(&known.id.as_str()));
        let effects: Arc<[Effect]> = effects(&fit.cloned().collect::<Vec<_>>()).into();
        let follow = |job: &&'j Job| Follow {
            job,
            key: key((&job.key, &job.place.id), &effects),
            unfit: unfit.contains(&job.place.id.as_str()),
            effects: Arc::clone(&effects),
        };
        Ok(jobs.iter().map(follow).collect())
    }

    fn is_followed(&self, follow: &Follow<'_>) -> bool {
        let there = self.there.get(&Table::Followed);
        there.is_some_and(|there| {
            there.holds(&self.fleet.results, &self.filed(follow.job, &follow.key), Table::Followed)
        })
    }
}

/// Whether nothing of a recording is followed: it could not be read, tells nothing, or its files are wrong.
fn is_unfit(verdict: &str, changes: Option<i64>) -> bool {
    verdict == diagnosed::ERROR || verdict == "undecided" || changes.unwrap_or_default() > 0
}

/// The second stage of a job.
struct Follow<'j> {
    job: &'j Job,
    key: String,
    unfit: bool,
    effects: Arc<[Effect]>,
}

impl Follow<'_> {
    fn name(&self) -> String {
        format!("{FOLLOW}{}-{}", self.job.place.id, self.key)
    }

    fn run(&self, fleet: &Fleet, there: &There) -> Result<(), Failure> {
        followed::run(fleet, self.job, (&self.effects, &self.key), self.unfit, there)
    }
}

/// Does all jobs that are not done, on all processors; those of a part where one is given. `pages` writes the page of each diagnosis
/// too. A run that is stopped, or killed, goes on with the next one.
pub fn all(
    fleet: &Fleet,
    (shard, pages): (Option<Shard>, bool),
    listener: &dyn Listener,
    progress: &(dyn Fn(Step<'_>) + Sync),
) -> Result<Done, Failure> {
    tidy(&fleet.results)?;
    let mut plan = Plan::new(fleet, listener)?;
    let there: Vec<(Table, There)> = Table::OF_DIAGNOSIS.map(|table| (table, plan.of(table))).into();
    let pending = plan.undiagnosed(shard);
    each(
        &pending,
        |done| progress(Step { step: "diagnosing", done }),
        |job| diagnosed::run(fleet, job, pages, &there),
    )?;
    let diagnosed = pending.len();
    plan.look()?;
    let there = plan.of(Table::Followed);
    let (pending, waiting) = plan.unfollowed(shard)?;
    each(&pending, |done| progress(Step { step: "following", done }), |follow| follow.run(fleet, &there))?;
    Ok(Done { recordings: plan.jobs.len(), diagnosed, followed: pending.len(), waiting })
}

/// Runs jobs on all processors, one at a time on each: what a job shares out itself goes to the common pool, whose threads do not begin
/// other jobs meanwhile, so that memory stays that of so many recordings. A failure to write ends the run once the jobs under way are done.
fn each<T: Sync>(
    jobs: &[T],
    told: impl Fn((usize, usize)) + Sync,
    run: impl Fn(&T) -> Result<(), Failure> + Sync,
) -> Result<(), Failure> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let failed = Mutex::new(None);
    let has_failed = || failed.lock().unwrap_or_else(PoisonError::into_inner).is_some();
    let work = || {
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)).filter(|_| !has_failed()) {
            if let Err(failure) = run(job) {
                failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
                break;
            }
            told((done.fetch_add(1, Ordering::Relaxed).saturating_add(1), jobs.len()));
        }
    };
    let processors = thread::available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| {
        for _ in 0..processors.min(jobs.len()) {
            scope.spawn(work);
        }
    });
    failed.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

/// What is still to be done.
pub fn pending(
    fleet: &Fleet,
    shard: Option<Shard>,
    listener: &dyn Listener,
) -> Result<Vec<Pending>, Failure> {
    let plan = Plan::new(fleet, listener)?;
    let told = |job: &Job, name: String, stage: &'static str| Pending {
        job: name,
        stage,
        machine: fleet
            .machines
            .get(job.place.machine)
            .map(|machine| machine.name.clone())
            .unwrap_or_default(),
        recording: job.place.label.clone(),
        time: job.time.to_string(),
    };
    let first = plan.undiagnosed(shard).into_iter().map(|job| told(job, job.name(), "diagnose"));
    let (follow, _) = plan.unfollowed(shard)?;
    let second = follow.iter().map(|follow| told(follow.job, follow.name(), "follow"));
    Ok(first.chain(second).collect())
}

/// Does one job by its name, as [`pending`] tells it.
pub fn one(fleet: &Fleet, name: &str, pages: bool) -> Result<(), Failure> {
    let (follows, rest) = match name.strip_prefix(FOLLOW) {
        Some(rest) => (true, rest),
        None => (false, name),
    };
    let (id, key) = rest.split_once('-').unwrap_or((rest, ""));
    let mut places = places(fleet, &());
    let Some(place) = places.iter().find(|place| place.id == id).cloned() else {
        let help = "help: `abbe fleet run --list` tells the jobs there are";
        return Err(Failure::wrong(format!("error: no recording of the fleet has the job `{name}`\n{help}")));
    };
    let changed = || {
        let help = "help: list the jobs again: what was asked for is not what is to be done now";
        Failure::no(format!("error: {} is not as it was when it was listed\n{help}", place.label))
    };
    if !follows {
        let job = job(fleet, place.clone());
        if job.key != key {
            return Err(changed());
        }
        let there =
            Table::OF_DIAGNOSIS.map(|table| There::of(&fleet.results, table).map(|there| (table, there)));
        return diagnosed::run(fleet, &job, pages, &there.into_iter().collect::<Result<Vec<_>, _>>()?);
    }
    places.retain(|other| other.machine == place.machine);
    let mut plan = Plan {
        fleet,
        jobs: places.into_par_iter().map(|place| job(fleet, place)).collect(),
        there: BTreeMap::new(),
    };
    plan.look()?;
    let jobs: Vec<&Job> = plan.jobs.iter().collect();
    if jobs.iter().any(|job| !plan.is_diagnosed(job)) {
        return Err(changed());
    }
    let follow = plan.follow_of(place.machine, &jobs)?;
    let follow =
        follow.iter().find(|follow| follow.job.place.id == id && follow.key == key).ok_or_else(changed)?;
    follow.run(fleet, &plan.of(Table::Followed))
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn every_job_is_of_one_part() {
        for id in [
            "00000000000000000000000000000000",
            "0123456789abcdef0123456789abcdef",
            "ffffffffffffffffffffffffffffffff",
        ] {
            let owners = (1..=16).filter(|part| Shard { part: *part, of: 16 }.has(id)).count();
            assert_eq!(owners, 1, "{id}");
        }
        assert_eq!(Shard::read("3/16"), Some(Shard { part: 3, of: 16 }));
        for wrong in ["0/16", "17/16", "3", "a/b", "1/0", "-1/4"] {
            assert_eq!(Shard::read(wrong), None, "{wrong}");
        }
    }
}
