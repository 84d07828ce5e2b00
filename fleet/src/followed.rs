//! The second stage of a job. In: a recording, and the effects of its machine. Out: the rows of how large each of them is in it.
//!
//! The names of error motions and the numbers of a term are those of the recording's own machine file, so that a recording of another
//! machine under the same name has no such motion, and no row.

use diagnosis::{Followed, Inputs, Size, Untold, follow};
use model_dsl::calibration;
use model_dsl::diagnostic::Diagnostics;
use model_dsl::equations::Equations;
use model_dsl::source::SourceFile;
use model_dsl::yaml;
use workshop::failure::Failure;
use workshop::recorded::{self, Recorded};

use crate::effects::Effect;
use crate::file::Fleet;
use crate::jobs::{Job, PutOff};
use crate::results::{Filed, Table, moment, write};
use crate::shelf::Shelf;
use crate::table::Cell;

/// Follows the effects of a machine in a recording and files the rows under a key. A recording that is `unfit`, whose diagnosis could not
/// tell anything or says that its files are wrong, has none. One that was read when it was diagnosed and cannot be read now is put off.
pub(crate) fn run(
    fleet: &Fleet,
    job: &Job,
    (effects, key): (&[Effect], &str),
    unfit: bool,
    shelf: &Shelf,
) -> Result<Option<PutOff>, Failure> {
    let Some(machine) = fleet.machines.get(job.place.machine) else { return Ok(None) };
    let sizes = match unfit || effects.is_empty() {
        true => Vec::new(),
        false => match recorded::read(&job.place.path, &()) {
            Ok(recorded) => sizes(&recorded, effects),
            Err(why) => {
                let why = why.words().map(|words| words.text(false)).unwrap_or_default();
                let why = why.lines().next().unwrap_or_default().to_owned();
                return Ok(Some(PutOff { label: job.place.label.clone(), why }));
            }
        },
    };
    let rows: Vec<Vec<Cell>> =
        effects.iter().zip(sizes).flat_map(|(effect, sizes)| rows(job, effect, sizes)).collect();
    let filed = Filed { machine: &machine.name, time: job.time, id: &job.place.id, key };
    write(&fleet.results, &filed, Table::Followed, &rows)?;
    shelf.replace_in(&fleet.results, &filed, Table::Followed)?;
    Ok(None)
}

/// The sizes of effects, or why the recording does not tell one; nothing of a motion that its machine does not have.
fn sizes(recorded: &Recorded, effects: &[Effect]) -> Vec<Option<Result<Vec<Size>, Untold>>> {
    let inputs = Inputs {
        equations: &recorded.equations,
        calibration: recorded.calibration.as_ref().map(|known| &known.calibration),
        recordings: vec![&recorded.recording],
        holdout: None,
        calibration_file: None,
        chains: None,
    };
    let read: Vec<Option<Followed>> =
        effects.iter().map(|effect| followed(&recorded.equations, effect)).collect();
    let known: Vec<Followed> = read.iter().flatten().cloned().collect();
    let mut sizes = follow(&inputs, &known).into_iter();
    read.iter().map(|read| read.as_ref().and_then(|_| sizes.next())).collect()
}

/// The effect in the numbers of a machine; nothing where that has no such motion.
fn followed(equations: &Equations, effect: &Effect) -> Option<Followed> {
    let source = SourceFile::new("the result", &effect.calibration);
    let mut diagnostics = Diagnostics::new();
    let root = yaml::read(&source, &mut diagnostics)?;
    let alone = calibration::read(&root, &equations.names(), &mut diagnostics)?;
    let listed = alone.motions.first()?;
    let term = listed.terms.first()?.value.clone();
    let name = |sensor: usize| Some((sensor, alone.sensors.iter().nth(sensor)?.name.value.clone()));
    Some(Followed {
        motion: listed.motion,
        at_drive: effect.at_drive,
        inside_loop: listed.is_inside_loop(0),
        sensors: term.sensors().filter_map(name).collect(),
        share: effect.share(),
        term,
    })
}

/// The rows of an effect: one for each of its numbers, or one without a number that says why there is none.
fn rows(job: &Job, effect: &Effect, sizes: Option<Result<Vec<Size>, Untold>>) -> Vec<Vec<Cell>> {
    let claimed = Cell::from(effect.found_in.contains(&job.place.id));
    let mut head = vec![Cell::from(&*job.key), Cell::from(&*job.place.label), moment(job.time)];
    head.extend([&effect.name, &effect.motion, &effect.term].map(|text| Cell::from(text.as_str())));
    let row = |numbers: Vec<Cell>, untold: Cell| {
        head.iter().cloned().chain(numbers).chain([claimed.clone(), untold]).collect()
    };
    let told = |Size { name, estimate }: Size| {
        let numbers = [estimate.value, estimate.ci95.0, estimate.ci95.1].map(Cell::from);
        let unit = [Cell::Text(estimate.unit)];
        row([Cell::Text(name)].into_iter().chain(numbers).chain(unit).collect(), Cell::None)
    };
    match sizes {
        Some(Ok(sizes)) => sizes.into_iter().map(told).collect(),
        Some(Err(untold)) => vec![row(vec![Cell::None; NUMBERS], Cell::from(untold.why()))],
        None => Vec::new(),
    }
}

/// The columns of a number: its name, the value, the ends of its interval and the unit.
const NUMBERS: usize = 5;
