//! Running jobs. In: a fleet. Out: a result for each of its recordings, those that are there already left as they are.
//!
//! Jobs have two stages. Each recording is diagnosed; when all of a machine are, what was found in any of them is followed in each. A
//! machine whose effects have changed since is followed anew, which takes a small part of the time.

use std::collections::BTreeSet;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use rayon::prelude::*;
use serde::Serialize;
use workshop::failure::Failure;
use workshop::told::Listener;

use crate::diagnosed;
use crate::file::{Fleet, Machine};
use crate::jobs::{Job, PutOff, job, machine_named, named};
use crate::key::of_texts;
use crate::plan::{FOLLOW, Follow, Plan, State, name_of};
use crate::shelf::{Shelf, tidy};

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
    /// Recordings that were diagnosed, without those that cannot be.
    pub diagnosed: usize,
    /// Recordings that are wrong: their result says why. Those of earlier runs are among them.
    pub errors: usize,
    /// Recordings in which what was found was followed.
    pub followed: usize,
    /// Machines that wait until all of their recordings are diagnosed.
    pub waiting: usize,
    /// Jobs that are put off to the next run, since something cannot be read now.
    pub put_off: usize,
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
    /// The recording that is diagnosed: a path from the fleet's folder.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recording: Option<String>,
    /// When it was made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
}

impl Pending {
    /// The job as a line of JSON.
    #[must_use]
    pub fn line(&self) -> String {
        serde_json::to_string(self).map(|line| line + "\n").unwrap_or_default()
    }
}

impl Shard {
    /// Reads `3/16`.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let (part, of) = text.split_once('/')?;
        let (part, of) = (part.trim().parse().ok()?, of.trim().parse().ok()?);
        (1..=of).contains(&part).then_some(Self { part, of })
    }

    /// Whether a job is of this part: by the sum of its name, so that a recording more moves no other.
    pub(crate) fn has(self, id: &str) -> bool {
        let digits = id.get(id.len().saturating_sub(8)..).unwrap_or_default();
        let number = usize::try_from(u32::from_str_radix(digits, 16).unwrap_or_default()).unwrap_or_default();
        number.checked_rem(self.of) == Some(self.part.saturating_sub(1))
    }
}

/// Does all jobs that are not done, on all processors; those of a part where one is given. `pages` writes the page of each diagnosis
/// too, and those that are missing. A run that is stopped, or killed, goes on with the next one.
pub fn all(
    fleet: &Fleet,
    (shard, pages): (Option<Shard>, bool),
    listener: &dyn Listener,
    progress: &(dyn Fn(Step<'_>) + Sync),
) -> Result<Done, Failure> {
    tidy(&fleet.results)?;
    let mut plan = Plan::new(fleet, listener)?;
    plan.clear()?;
    let told = |step: &'static str| move |done| progress(Step { step, done });
    let pending = plan.undiagnosed(shard, listener);
    let mut put_off =
        each(&pending, told("diagnosing"), |job| diagnosed::run(fleet, job, pages, &plan.shelf))?;
    let diagnosed: BTreeSet<String> = pending.iter().map(|job| job.result()).collect();
    if pages {
        let pending = plan.undrawn(shard);
        each(&pending, told("drawing"), |job| diagnosed::draw(fleet, job).map(|()| None))?;
    }
    plan.look()?;
    let (follows, waiting) = plan.follows(listener)?;
    let pending = unfollowed(&plan, &follows, shard, listener)?;
    let later = each(&pending, told("following"), |follow| follow.run(fleet, &plan.shelf))?;
    let followed = pending.len().saturating_sub(later.len());
    put_off.extend(later);
    put_off.extend(plan.put_off.iter().cloned());
    for put_off in &put_off {
        listener.hear(&put_off.line().into());
    }
    let errors = tell_errors(&plan, listener);
    let right = |(job, state): &(&Job, &State)| {
        **state == State::Whole { wrong: None } && diagnosed.contains(&job.result())
    };
    let diagnosed = plan.known().filter(right).count();
    Ok(Done { recordings: plan.recordings, diagnosed, errors, followed, waiting, put_off: put_off.len() })
}

/// The command names at most this many unreadable recordings, half a screen; the history has all of them.
const MOST_NAMED: usize = 10;

/// Tells which recordings cannot be read, and why; their number.
fn tell_errors(plan: &Plan<'_>, listener: &dyn Listener) -> usize {
    let wrong = plan.known().filter_map(|(job, state)| match state {
        State::Whole { wrong: Some(why) } => Some((&job.place.label, why)),
        _ => None,
    });
    let wrong: Vec<_> = wrong.collect();
    for (label, why) in wrong.iter().take(MOST_NAMED) {
        let indented: String = why.lines().map(|line| format!("\n  {line}")).collect();
        listener.hear(&format!("warning: {label} cannot be diagnosed:{indented}").into());
    }
    match wrong.len().saturating_sub(MOST_NAMED) {
        0 => {}
        more => {
            let text = format!(
                "warning: {more} more cannot be diagnosed: `abbe fleet show --format json` has all of them"
            );
            listener.hear(&text.into());
        }
    }
    wrong.len()
}

/// What is not followed yet, of one part or of all. Beside what is, a run that was killed may have left what it replaces: that is removed.
fn unfollowed<'j>(
    plan: &Plan<'_>,
    follows: &'j [Follow<'j>],
    shard: Option<Shard>,
    listener: &dyn Listener,
) -> Result<Vec<&'j Follow<'j>>, Failure> {
    let states: Vec<State> = follows.par_iter().map(|follow| plan.followed(follow)).collect();
    let mut pending = Vec::new();
    for (follow, state) in follows.iter().zip(&states) {
        if state.is_whole() {
            plan.clear_beside(follow)?;
        } else if shard.is_none_or(|shard| shard.has(&follow.job.place.id)) {
            if let Some(line) = state.line(&follow.job.place.label) {
                listener.hear(&line.into());
            }
            pending.push(follow);
        }
    }
    Ok(pending)
}

/// Runs jobs on all processors, one at a time on each: what a job shares out itself goes to the common pool, whose threads do not begin
/// other jobs meanwhile, so that memory stays that of so many recordings. A failure to write ends the run once the jobs under way are done.
/// Tells what is put off.
fn each<T: Sync>(
    jobs: &[T],
    told: impl Fn((usize, usize)) + Sync,
    run: impl Fn(&T) -> Result<Option<PutOff>, Failure> + Sync,
) -> Result<Vec<PutOff>, Failure> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let (failed, put_off) = (Mutex::new(None), Mutex::new(Vec::new()));
    let has_failed = || failed.lock().unwrap_or_else(PoisonError::into_inner).is_some();
    let work = || {
        while let Some(job) = jobs.get(next.fetch_add(1, Ordering::Relaxed)).filter(|_| !has_failed()) {
            match run(job) {
                Ok(later) => put_off.lock().unwrap_or_else(PoisonError::into_inner).extend(later),
                Err(failure) => {
                    failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(failure);
                    break;
                }
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
    let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut put_off = put_off.into_inner().unwrap_or_else(PoisonError::into_inner);
    put_off.sort_by(|one: &PutOff, other| one.label.cmp(&other.label));
    failed.map_or(Ok(put_off), Err)
}

/// What is still to be done, and what cannot be done now.
#[derive(Clone, Debug, Default)]
pub struct Listed {
    /// The jobs.
    pub jobs: Vec<Pending>,
    /// How many recordings, or folders of them, cannot be read now and are not among the jobs.
    pub put_off: usize,
}

/// What is still to be done; the listener hears why a recording that cannot be read now is not among it.
pub fn pending(fleet: &Fleet, shard: Option<Shard>, listener: &dyn Listener) -> Result<Listed, Failure> {
    let plan = Plan::new(fleet, listener)?;
    for put_off in &plan.put_off {
        listener.hear(&put_off.line().into());
    }
    let name =
        |job: &Job| fleet.machines.get(job.place.machine).map_or("", |machine| &machine.name).to_owned();
    let first = plan.undiagnosed(shard, listener).into_iter().map(|job| Pending {
        job: job.name(fleet),
        stage: "diagnose",
        machine: name(job),
        recording: Some(job.place.label.clone()),
        time: Some(job.time.to_string()),
    });
    let mut pending: Vec<Pending> = first.collect();
    let (follows, _) = plan.follows(listener)?;
    for follows in follows.chunk_by(|one, next| one.job.place.machine == next.job.place.machine) {
        let machine = follows.first().map(|follow| name(follow.job)).unwrap_or_default();
        let own = shard.is_none_or(|shard| shard.has(&of_texts(&[&machine])));
        if own && follows.iter().any(|follow| !plan.followed(follow).is_whole()) {
            let job = name_of(&machine, follows);
            pending.push(Pending { job, stage: "follow", machine, recording: None, time: None });
        }
    }
    Ok(Listed { jobs: pending, put_off: plan.put_off.len() })
}

/// Does one job by its name, as [`pending`] tells it: of a diagnosis nothing is looked at but its recording and the names of the results of
/// its machine, of what follows the recordings of its machine.
pub fn one(fleet: &Fleet, name: &str, pages: bool) -> Result<(), Failure> {
    let unknown = || {
        let help = "help: `abbe fleet run --list` lists the jobs";
        Failure::wrong(format!("error: no recording of the fleet has the job `{name}`\n{help}"))
    };
    if let Some((_, machine)) = name.strip_prefix(FOLLOW).and_then(|rest| rest.split_once('/')) {
        return follow_all(fleet, machine_named(fleet, machine).ok_or_else(unknown)?, name);
    }
    let (place, key) = named(fleet, name).ok_or_else(unknown)?;
    let label = place.label.clone();
    let job = job(fleet, place).map_err(later)?;
    if job.key != key {
        return Err(changed(&label));
    }
    let machine = fleet.machines.get(job.place.machine).map(|machine| machine.name.as_str());
    let shelf = Shelf::of(&fleet.results, machine)?;
    diagnosed::run(fleet, &job, pages, &shelf)?.map_or(Ok(()), |put_off| Err(later(put_off)))
}

/// The second stage of a machine.
fn follow_all(fleet: &Fleet, (number, machine): (usize, &Machine), name: &str) -> Result<(), Failure> {
    let plan = Plan::of_machine(fleet, (number, machine))?;
    let (follows, waiting) = plan.follows(&())?;
    if waiting > 0 || name_of(&machine.name, &follows) != name {
        return Err(changed(&format!("the machine {}", machine.name)));
    }
    for follow in follows.iter().filter(|follow| !plan.followed(follow).is_whole()) {
        follow.run(fleet, &plan.shelf)?.map_or(Ok(()), |put_off| Err(later(put_off)))?;
    }
    Ok(())
}

fn changed(what: &str) -> Failure {
    let help = "help: list the jobs again; the requested job is out of date";
    Failure::no(format!("error: {what} has changed since it was listed\n{help}"))
}

fn later(put_off: PutOff) -> Failure {
    let PutOff { label, why } = put_off;
    Failure::no(format!("error: {label} cannot be diagnosed now: {why}\nhelp: do the job again later"))
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
