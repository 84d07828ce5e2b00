//! The history of a fleet. In: its results. Out: for each machine its recordings and its numbers over time; what changed; and which
//! machine is unlike others of its kind.

mod alarm;
mod gather;

use std::path::PathBuf;

use recording::Moment;
use serde::Serialize;
use workshop::failure::Failure;
use workshop::told::Listener;

pub use crate::between::{Own, Range};
pub use crate::change::Change;
pub use crate::series::{Point, Series, Untold};
pub use alarm::{Alarm, BOUND};

use crate::diagnosed::ERROR;
use crate::file::Fleet;
use crate::series::as_text;

/// The name and the version of a history as JSON.
pub const SCHEMA: &str = "abbe-fleet/1";

/// Machines over time.
#[derive(Clone, Debug, Serialize)]
pub struct History {
    /// The name and the version of this form: [`SCHEMA`].
    pub schema: &'static str,
    /// The end of the history.
    #[serde(serialize_with = "as_text")]
    pub until: Moment,
    /// Changes, and machines that differ from others of their kind, the least probable by chance first.
    pub alarms: Vec<Alarm>,
    /// The number of tests of hypotheses on all series together: the bound of each alarm allows for them (Holm).
    pub questions: usize,
    /// The machines, in the order of the fleet file.
    pub machines: Vec<Machine>,
    /// What is expected of each kind of machine.
    pub ranges: Vec<Range>,
}

/// One machine over time.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: Option<String>,
    /// Its recordings, in the order of time.
    pub recordings: Vec<Entry>,
    /// How many recordings up to the end have no result for their present contents: they are not diagnosed yet, or have changed since.
    pub pending: usize,
    /// Its numbers over time: what was found in any recording, then the noise.
    pub series: Vec<Followed>,
}

/// A number of a machine over time, and what it does.
#[derive(Clone, Debug, Serialize)]
pub struct Followed {
    /// The number.
    #[serde(flatten)]
    pub series: Series,
    /// The trend or the step that fits best, plain or not; nothing of a series that is too short to tell.
    pub change: Option<Change>,
    /// Whether there is an alarm about it.
    pub alarm: bool,
}

/// A recording as its result has it.
#[derive(Clone, Debug, Serialize)]
pub struct Entry {
    /// When it was made.
    #[serde(serialize_with = "as_text")]
    pub time: Moment,
    /// Its path from the fleet's folder.
    pub recording: String,
    /// The word of the verdict; `error` where it could not be read.
    pub verdict: String,
    /// The verdict as a sentence, or why it could not be read.
    pub sentence: String,
    /// Whether it is still where the fleet file looks for it. The results of recordings that are gone stay in the history.
    pub listed: bool,
    /// The page of its diagnosis, where one was written.
    pub page: Option<PathBuf>,
}

impl Machine {
    /// The number of its recordings that could not be read.
    #[must_use]
    pub fn errors(&self) -> usize {
        self.recordings.iter().filter(|entry| entry.verdict == ERROR).count()
    }

    /// The recording that was made last.
    #[must_use]
    pub fn last(&self) -> Option<&Entry> {
        self.recordings.last()
    }
}

/// The history of a fleet up to a moment: of what was recorded, and of the effects that were found until then. Results that cannot be read are told to the listener and left out.
pub fn history(fleet: &Fleet, until: Moment, listener: &dyn Listener) -> Result<History, Failure> {
    let mut machines = gather::machines(fleet, until, listener)?;
    for machine in &mut machines {
        for followed in &mut machine.series {
            followed.change = crate::change::change(&followed.series);
        }
    }
    let kinds = machines.iter().filter_map(|machine| Some((machine.kind.as_deref()?, machine)));
    let numbers = kinds.flat_map(|(kind, machine)| {
        machine.series.iter().map(move |followed| (kind, machine.name.as_str(), &followed.series))
    });
    let ranges = crate::between::ranges(numbers);
    let (alarms, questions) = alarm::alarms(&mut machines, &ranges);
    Ok(History { schema: SCHEMA, until, alarms, questions, machines, ranges })
}
