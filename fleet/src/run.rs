//! Running jobs. In: a fleet. Out: a result for each of its recordings, those that are there already left as they are.
//!
//! Jobs have two stages. Each recording is diagnosed; when all of a machine are, what was found in any of them is followed in each. A
//! machine whose effects have changed since is followed anew, which takes a small part of the time.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZero;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use rayon::prelude::*;
use recording::Moment;
use serde::Serialize;
use workshop::failure::Failure;
use workshop::told::Listener;

use crate::diagnosed;
use crate::effects::{Effect, effects, key};
use crate::file::{Fleet, Machine};
use crate::followed;
use crate::jobs::{Job, Places, PutOff, job, machine_named, named, places, places_of};
use crate::key::of_texts;
use crate::results::{Filed, Table, encoded, sound};
use crate::shelf::{Current, Known, Shelf, read, tidy};

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

/// The recordings of a fleet, or of one machine of it, with what is there of them.
struct Plan<'f> {
    fleet: &'f Fleet,
    /// In the order of machines.
    jobs: Vec<Job>,
    /// What cannot be read now.
    put_off: Vec<PutOff>,
    /// How many recordings there are, those that cannot be read now among them.
    recordings: usize,
    /// The machine, where it is of one alone.
    machine: Option<&'f str>,
    shelf: Shelf,
    /// What there is of each job, in their order.
    states: Vec<State>,
}

/// What there is of a job's result.
#[derive(Clone, Debug, PartialEq, Eq)]
enum State {
    /// Nothing yet.
    None,
    /// All its files, with what they must hold; whether the recording is wrong.
    Whole { wrong: bool },
    /// Not all of them, or they cannot be read: why.
    Broken(String),
}

impl State {
    /// Looks at the tables of a diagnosis.
    fn of_diagnosis(results: &Path, shelf: &Shelf, filed: &Filed<'_>) -> Self {
        if !shelf.holds(results, filed, Table::Recordings) {
            return Self::None;
        }
        let mut wrong = false;
        for table in Table::OF_DIAGNOSIS {
            match sound(&filed.path(results, table), table, filed.key) {
                Ok(rows) => {
                    wrong |=
                        table == Table::Recordings && rows.iter().any(|row| !row.text("error").is_empty())
                }
                Err(why) => return Self::Broken(why),
            }
        }
        Self::Whole { wrong }
    }

    /// Looks at the table of followed effects; its rows bear the key of the recording.
    fn of_followed(results: &Path, shelf: &Shelf, filed: &Filed<'_>, recording: &str) -> Self {
        if !shelf.holds(results, filed, Table::Followed) {
            return Self::None;
        }
        match sound(&filed.path(results, Table::Followed), Table::Followed, recording) {
            Ok(_) => Self::Whole { wrong: false },
            Err(why) => Self::Broken(why),
        }
    }

    fn is_whole(&self) -> bool {
        matches!(self, Self::Whole { .. })
    }

    /// The line about a result that is made again.
    fn line(&self, label: &str) -> Option<String> {
        let Self::Broken(why) = self else { return None };
        Some(format!("warning: the result of {label} is computed again: {why}"))
    }
}

impl<'f> Plan<'f> {
    fn new(fleet: &'f Fleet, listener: &dyn Listener) -> Result<Self, Failure> {
        Self::of(fleet, places(fleet, listener), None)
    }

    fn of_machine(fleet: &'f Fleet, (number, machine): (usize, &'f Machine)) -> Result<Self, Failure> {
        Self::of(fleet, places_of(fleet, (number, machine), &()), Some(&machine.name))
    }

    fn of(fleet: &'f Fleet, places: Places, machine: Option<&'f str>) -> Result<Self, Failure> {
        let Places { found, unread: mut put_off } = places;
        let recordings = found.len();
        let read: Vec<Result<Job, PutOff>> = found.into_par_iter().map(|place| job(fleet, place)).collect();
        let mut jobs = Vec::new();
        for read in read {
            match read {
                Ok(job) => jobs.push(job),
                Err(why) => put_off.push(why),
            }
        }
        let mut plan =
            Self { fleet, jobs, put_off, recordings, machine, shelf: Shelf::default(), states: Vec::new() };
        plan.look()?;
        Ok(plan)
    }

    /// Looks anew which results are there.
    fn look(&mut self) -> Result<(), Failure> {
        self.shelf = Shelf::of(&self.fleet.results, self.machine)?;
        let state =
            |job: &Job| State::of_diagnosis(&self.fleet.results, &self.shelf, &self.filed(job, &job.key));
        self.states = self.jobs.par_iter().map(state).collect();
        Ok(())
    }

    /// Each job with what there is of its result.
    fn known(&self) -> impl Iterator<Item = (&Job, &State)> {
        self.jobs.iter().zip(&self.states)
    }

    fn filed<'j>(&'j self, job: &'j Job, key: &'j str) -> Filed<'j> {
        let machine = self.fleet.machines.get(job.place.machine).map_or("", |machine| &machine.name);
        Filed { machine, time: job.time, id: &job.place.id, key }
    }

    fn followed(&self, follow: &Follow<'_>) -> State {
        let filed = self.filed(follow.job, &follow.key);
        State::of_followed(&self.fleet.results, &self.shelf, &filed, &follow.job.key)
    }

    /// The jobs of one part or of all.
    fn own(&self, shard: Option<Shard>) -> impl Iterator<Item = (&Job, &State)> {
        self.known().filter(move |(job, _)| shard.is_none_or(|shard| shard.has(&job.place.id)))
    }

    /// What is to be diagnosed, of one part or of all; the listener hears of what has a result that is of no use.
    fn undiagnosed(&self, shard: Option<Shard>, listener: &dyn Listener) -> Vec<&Job> {
        let pending: Vec<(&Job, &State)> = self.own(shard).filter(|(_, state)| !state.is_whole()).collect();
        for line in pending.iter().filter_map(|(job, state)| state.line(&job.place.label)) {
            listener.hear(&line.into());
        }
        pending.into_iter().map(|(job, _)| job).collect()
    }

    /// What is diagnosed and has no page.
    fn undrawn(&self, shard: Option<Shard>) -> Vec<&Job> {
        let has_page = |job: &Job| self.shelf.holds_page(&self.fleet.results, &self.filed(job, &job.key));
        let undrawn = self.own(shard).filter(|(job, state)| state.is_whole() && !has_page(job));
        undrawn.map(|(job, _)| job).collect()
    }

    /// Takes away what runs that were killed have left beside what replaces it, and what is of recordings that were moved.
    fn clear(&self) -> Result<(), Failure> {
        let mut known = BTreeMap::new();
        for (job, _) in self.known().filter(|(_, state)| state.is_whole()) {
            let filed = self.filed(job, &job.key);
            self.shelf.replace(&self.fleet.results, &filed)?;
            known.insert(job.key.as_str(), filed.machine);
        }
        // Where something is put off, nobody knows what else is not to be seen now.
        match self.put_off.is_empty() {
            true => self.shelf.clear_moved(&known, &self.listed()),
            false => Ok(()),
        }
    }

    /// The recordings that are at their places.
    fn listed(&self) -> BTreeSet<&str> {
        self.jobs.iter().map(|job| job.place.id.as_str()).collect()
    }

    /// The second stage of all machines of which all is diagnosed; and how many others there are.
    fn follows(&self, listener: &dyn Listener) -> Result<(Vec<Follow<'_>>, usize), Failure> {
        let (mut follows, mut waiting) = (Vec::new(), 0);
        let undone: BTreeSet<usize> =
            self.known().filter(|(_, state)| !state.is_whole()).map(|(job, _)| job.place.machine).collect();
        for jobs in self.jobs.chunk_by(|one, next| one.place.machine == next.place.machine) {
            match jobs.first().is_some_and(|job| undone.contains(&job.place.machine)) {
                false => follows.extend(self.follow_of(jobs, listener)?),
                true => waiting += 1,
            }
        }
        Ok((follows, waiting))
    }

    /// The second stage of the jobs of a machine.
    fn follow_of<'j>(&self, jobs: &'j [Job], listener: &dyn Listener) -> Result<Vec<Follow<'j>>, Failure> {
        let machine = jobs.first().and_then(|job| self.fleet.machines.get(job.place.machine));
        let Some(machine) = machine.map(|machine| machine.name.as_str()) else { return Ok(Vec::new()) };
        let listed: BTreeSet<&str> = jobs.iter().map(|job| job.place.id.as_str()).collect();
        let current = Current::of(&self.fleet.results, Some(machine), &listed)?;
        // What is to be diagnosed is whole, as was seen above. Other results are of recordings that are gone, or cannot be read now: nobody
        // can make them again, and the machine goes on without them.
        let mut broken = |why: String| listener.hear(&why.into());
        let mut rows = |table| read(&self.fleet.results, table, (Some(machine), &current), &mut broken);
        let (parameters, verdicts) = (rows(Table::Parameters)?, rows(Table::Verdicts)?);
        let is_unfit = |known: &&Known| is_unfit(known.row.text("verdict"), known.row.count("changes"));
        let unfit: BTreeSet<&str> = verdicts.iter().filter(is_unfit).map(|known| known.id.as_str()).collect();
        let fit = parameters.iter().filter(|known| !unfit.contains(known.id.as_str()));
        let effects: Arc<[Effect]> = effects(&fit.cloned().collect::<Vec<_>>()).into();
        let follow = |job: &'j Job| Follow {
            job,
            key: key((&job.key, &job.place.id), &effects),
            unfit: unfit.contains(job.place.id.as_str()),
            effects: Arc::clone(&effects),
        };
        Ok(jobs.iter().map(follow).collect())
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
    fn run(&self, fleet: &Fleet, shelf: &Shelf) -> Result<Option<PutOff>, Failure> {
        followed::run(fleet, self.job, (&self.effects, &self.key), self.unfit, shelf)
    }
}

/// The name of the job that follows the effects of a machine: the hash of what it is made from, and the machine. It is one job, since what
/// is followed depends on all recordings of the machine.
fn name_of(machine: &str, follows: &[Follow<'_>]) -> String {
    let keys: Vec<&str> = follows.iter().map(|follow| follow.key.as_str()).collect();
    format!("{FOLLOW}{}/{}", of_texts(&keys), encoded(machine))
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
    let states: Vec<State> = follows.par_iter().map(|follow| plan.followed(follow)).collect();
    let mut pending = Vec::new();
    for (follow, state) in follows.iter().zip(&states) {
        if state.is_whole() {
            // What a run that was killed has left beside it.
            let filed = plan.filed(follow.job, &follow.key);
            plan.shelf.replace_in(&fleet.results, &filed, Table::Followed)?;
        } else if shard.is_none_or(|shard| shard.has(&follow.job.place.id)) {
            if let Some(line) = state.line(&follow.job.place.label) {
                listener.hear(&line.into());
            }
            pending.push(follow);
        }
    }
    let later = each(&pending, told("following"), |follow| follow.run(fleet, &plan.shelf))?;
    let followed = pending.len().saturating_sub(later.len());
    put_off.extend(later);
    put_off.extend(plan.put_off.iter().cloned());
    for put_off in &put_off {
        listener.hear(&put_off.line().into());
    }
    let wrong = |state: &&State| matches!(state, State::Whole { wrong: true });
    let right = |(job, state): &(&Job, &State)| {
        **state == State::Whole { wrong: false } && diagnosed.contains(&job.result())
    };
    let diagnosed = plan.known().filter(right).count();
    Ok(Done {
        recordings: plan.recordings,
        diagnosed,
        errors: plan.states.iter().filter(wrong).count(),
        followed,
        waiting,
        put_off: put_off.len(),
    })
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

/// How many recordings of each machine, by its number, were made until a moment and have no whole result of what they hold now. The listener
/// hears of what cannot be read now.
pub(crate) fn undone(
    fleet: &Fleet,
    places: Places,
    until: Moment,
    listener: &dyn Listener,
) -> Result<BTreeMap<usize, usize>, Failure> {
    let plan = Plan::of(fleet, places, None)?;
    for PutOff { label, why } in &plan.put_off {
        listener.hear(&format!("warning: {label} is shown as its last result has it: {why}").into());
    }
    let mut undone = BTreeMap::new();
    for (job, _) in plan.known().filter(|(job, state)| job.time <= until && !state.is_whole()) {
        *undone.entry(job.place.machine).or_default() += 1;
    }
    Ok(undone)
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
