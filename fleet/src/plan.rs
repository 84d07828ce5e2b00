//! What is there of a fleet and what is not. In: a fleet, and the results beside it. Out: the jobs of both stages that are still to be done.
//!
//! A result counts if all of its files are there and hold what they must. It is looked at by what [`crate::run`] does, by the list of jobs, and
//! by the history, which tells what is pending.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use rayon::prelude::*;
use recording::Moment;
use workshop::failure::Failure;
use workshop::told::Listener;

use crate::diagnosed;
use crate::effects::{Effect, effects, key};
use crate::file::{Fleet, Machine};
use crate::followed;
use crate::jobs::{Job, Places, PutOff, job, places, places_of};
use crate::key::of_texts;
use crate::results::{Filed, Table, encoded, sound};
use crate::run::Shard;
use crate::shelf::{Current, Known, Shelf, read};

/// Before the name of a job that follows.
pub(crate) const FOLLOW: &str = "follow-";

/// The recordings of a fleet, or of one machine of it, with what is there of them.
pub(crate) struct Plan<'f> {
    fleet: &'f Fleet,
    /// In the order of machines.
    jobs: Vec<Job>,
    /// What cannot be read now.
    pub(crate) put_off: Vec<PutOff>,
    /// How many recordings there are, those that cannot be read now among them.
    pub(crate) recordings: usize,
    /// The machine, where it is of one alone.
    machine: Option<&'f str>,
    pub(crate) shelf: Shelf,
    /// What there is of each job, in their order.
    pub(crate) states: Vec<State>,
}

/// What there is of a job's result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum State {
    /// Nothing yet.
    None,
    /// All its files, with what they must hold; why the recording cannot be read, where it cannot.
    Whole { wrong: Option<String> },
    /// Not all of them, or they cannot be read: why.
    Broken(String),
}

impl State {
    /// Looks at the tables of a diagnosis.
    fn of_diagnosis(results: &Path, shelf: &Shelf, filed: &Filed<'_>) -> Self {
        if !shelf.holds(results, filed, Table::Recordings) {
            return Self::None;
        }
        let mut wrong = None;
        for table in Table::OF_DIAGNOSIS {
            match sound(&filed.path(results, table), table, filed.key) {
                Ok(rows) if table == Table::Recordings => {
                    wrong = rows.iter().map(|row| row.text("error").to_owned()).find(|why| !why.is_empty());
                }
                Ok(_) => {}
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
            Ok(_) => Self::Whole { wrong: None },
            Err(why) => Self::Broken(why),
        }
    }

    pub(crate) fn is_whole(&self) -> bool {
        matches!(self, Self::Whole { .. })
    }

    /// The line about a result that is made again.
    pub(crate) fn line(&self, label: &str) -> Option<String> {
        let Self::Broken(why) = self else { return None };
        Some(format!("warning: the result of {label} is computed again: {why}"))
    }
}

impl<'f> Plan<'f> {
    pub(crate) fn new(fleet: &'f Fleet, listener: &dyn Listener) -> Result<Self, Failure> {
        Self::of(fleet, places(fleet, listener), None)
    }

    pub(crate) fn of_machine(
        fleet: &'f Fleet,
        (number, machine): (usize, &'f Machine),
    ) -> Result<Self, Failure> {
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
    pub(crate) fn look(&mut self) -> Result<(), Failure> {
        self.shelf = Shelf::of(&self.fleet.results, self.machine)?;
        let state =
            |job: &Job| State::of_diagnosis(&self.fleet.results, &self.shelf, &self.filed(job, &job.key));
        self.states = self.jobs.par_iter().map(state).collect();
        Ok(())
    }

    /// Each job with what there is of its result.
    pub(crate) fn known(&self) -> impl Iterator<Item = (&Job, &State)> {
        self.jobs.iter().zip(&self.states)
    }

    fn filed<'j>(&'j self, job: &'j Job, key: &'j str) -> Filed<'j> {
        let machine = self.fleet.machines.get(job.place.machine).map_or("", |machine| &machine.name);
        Filed { machine, time: job.time, id: &job.place.id, key }
    }

    pub(crate) fn followed(&self, follow: &Follow<'_>) -> State {
        let filed = self.filed(follow.job, &follow.key);
        State::of_followed(&self.fleet.results, &self.shelf, &filed, &follow.job.key)
    }

    /// The jobs of one part or of all.
    fn own(&self, shard: Option<Shard>) -> impl Iterator<Item = (&Job, &State)> {
        self.known().filter(move |(job, _)| shard.is_none_or(|shard| shard.has(&job.place.id)))
    }

    /// What is to be diagnosed, of one part or of all; the listener hears of what has a result that is of no use.
    pub(crate) fn undiagnosed(&self, shard: Option<Shard>, listener: &dyn Listener) -> Vec<&Job> {
        let pending: Vec<(&Job, &State)> = self.own(shard).filter(|(_, state)| !state.is_whole()).collect();
        for line in pending.iter().filter_map(|(job, state)| state.line(&job.place.label)) {
            listener.hear(&line.into());
        }
        pending.into_iter().map(|(job, _)| job).collect()
    }

    /// What is diagnosed and has no page.
    pub(crate) fn undrawn(&self, shard: Option<Shard>) -> Vec<&Job> {
        let has_page = |job: &Job| self.shelf.holds_page(&self.fleet.results, &self.filed(job, &job.key));
        let undrawn = self.own(shard).filter(|(job, state)| state.is_whole() && !has_page(job));
        undrawn.map(|(job, _)| job).collect()
    }

    /// Takes away what runs that were killed have left beside what replaces it, and what is of recordings that were moved.
    pub(crate) fn clear(&self) -> Result<(), Failure> {
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

    /// Takes away what a followed result has replaced.
    pub(crate) fn clear_beside(&self, follow: &Follow<'_>) -> Result<(), Failure> {
        let filed = self.filed(follow.job, &follow.key);
        self.shelf.replace_in(&self.fleet.results, &filed, Table::Followed)
    }

    /// The recordings that are at their places.
    fn listed(&self) -> BTreeSet<&str> {
        self.jobs.iter().map(|job| job.place.id.as_str()).collect()
    }

    /// The second stage of all machines of which all is diagnosed; and how many others there are.
    pub(crate) fn follows(&self, listener: &dyn Listener) -> Result<(Vec<Follow<'_>>, usize), Failure> {
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
pub(crate) struct Follow<'j> {
    pub(crate) job: &'j Job,
    key: String,
    unfit: bool,
    effects: Arc<[Effect]>,
}

impl Follow<'_> {
    pub(crate) fn run(&self, fleet: &Fleet, shelf: &Shelf) -> Result<Option<PutOff>, Failure> {
        followed::run(fleet, self.job, (&self.effects, &self.key), self.unfit, shelf)
    }
}

/// The name of the job that follows the effects of a machine: the hash of what it is made from, and the machine. It is one job, since what
/// is followed depends on all recordings of the machine.
pub(crate) fn name_of(machine: &str, follows: &[Follow<'_>]) -> String {
    let keys: Vec<&str> = follows.iter().map(|follow| follow.key.as_str()).collect();
    format!("{FOLLOW}{}/{}", of_texts(&keys), encoded(machine))
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
