//! `abbe limits`: what a recording could show. In: a recording. Out: from which size on each effect would be found in it, as text, JSON
//! or a page. What it shares with `abbe plan` stands here too.

use limits::answer::Limits as Found;
use limits::injection::base::Base;
use limits::injection::kind::Kind;
use limits::limits::{Question, limits};
use limits::moves::library;
use limits::passes::advice;
use limits::report;
use limits::search::Effort;
use limits::trial::Known;
use model_dsl::Compiled;
use model_dsl::calibration::MachineNames;
use model_dsl::suggest::nearest;
use workshop::failure::Failure;
use workshop::named::Files;
use workshop::origin::word;
use workshop::recorded::{self, Recorded};

use crate::arguments::{Asked, Limits, LimitsFormat};
use crate::output::Person;
use crate::progress::Progress;

/// Runs the command. Status 1 where no effect can be injected into the recording.
pub(crate) fn run(arguments: &Limits) -> Result<(), Failure> {
    let asked = &arguments.asked;
    let recorded = recorded::read(&arguments.recording, &Person::new(asked.quiet))?;
    recorded.needs_positions()?;
    asked.target.check(&Files::of(&recorded, &arguments.recording).all(None))?;
    check_names(&asked.only, &recorded.equations.names())?;
    let progress = Progress::new(asked.quiet, "diagnosing the recording as it is");
    let name = arguments.recording.display().to_string();
    let known = Known::new(base(&name, recorded)?).map_err(|reason| cannot(&name, &reason))?;
    let found = answered(&[known], asked, arguments.passes, &progress);
    drop(progress);
    tell(found, &name, asked, &command(arguments))
}

/// The recording, ready for effects to be injected.
fn base(name: &str, recorded: Recorded) -> Result<Base, Failure> {
    let compiled = Compiled { machine: recorded.machine, equations: recorded.equations };
    let calibration = recorded.calibration.map(|known| known.calibration);
    Base::new(name, compiled, calibration, recorded.recording).map_err(|reason| cannot(name, &reason))
}

/// Asks, and looks for extra passes where that is wanted.
pub(super) fn answered(known: &[Known], asked: &Asked, passes: bool, progress: &Progress) -> Option<Found> {
    let effort = Effort { trials: usize::from(asked.trials), ..Effort::default() };
    let question = Question { only: asked.only.clone(), effort, seed: asked.seed };
    let mut found = limits(known, &question, &|done| progress.part("injecting effects", done))?;
    if let Some(first) = known.first().filter(|_| passes) {
        let trying = |done: f64| progress.part("trying extra passes", done);
        found.advice = Some(advice(first, &found, &library(&first.base), &trying));
    }
    Some(found)
}

/// Prints what was found. Status 1 where nothing could be asked.
pub(super) fn tell(found: Option<Found>, name: &str, asked: &Asked, command: &str) -> Result<(), Failure> {
    let found = found.filter(|found| !found.all.is_empty() || !found.already.is_empty());
    let reason =
        "it can show none of the requested effects, because its axes do not make the motion that these need";
    let found = found.ok_or_else(|| cannot(name, reason))?;
    asked.target.put(&match asked.format {
        LimitsFormat::Text => report::text(&found),
        LimitsFormat::Json => report::json(&found),
        LimitsFormat::Html => report::html(&found, command),
    })
}

/// Why nothing can be injected.
pub(super) fn cannot(name: &str, reason: &str) -> Failure {
    Failure::no(format!("error: no effect can be injected into {name}: {reason}"))
}

/// Refuses a name that is neither a kind, a motion nor an axis.
pub(super) fn check_names(only: &[String], names: &MachineNames) -> Result<(), Failure> {
    let axes = names.axes.iter().map(|axis| axis.letter.as_str());
    let motions = names.motions.iter().map(|motion| motion.name.as_str());
    let known: Vec<&str> = Kind::names().into_iter().chain(axes).chain(motions).collect();
    let Some(wrong) = only.iter().find(|name| !known.contains(&name.as_str())) else { return Ok(()) };
    let help = match nearest(wrong, known.iter().copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None => {
            format!(
                "give --only axes and error motions of the machine, or the kinds {}",
                Kind::names().join(", ")
            )
        }
    };
    Err(Failure::wrong(format!(
        "error: `{wrong}` is not an effect, an error motion or an axis\nhelp: {help}"
    )))
}

/// The command that makes the page again.
fn command(arguments: &Limits) -> String {
    let passes = if arguments.passes { " --passes" } else { "" };
    let recording = word(&arguments.recording);
    format!("abbe limits {recording}{passes}{} > limits.html", options(&arguments.asked))
}

/// The options of what is asked for a page, each with a space before it.
pub(super) fn options(asked: &Asked) -> String {
    let only = match asked.only.as_slice() {
        [] => String::new(),
        names => format!(" --only {}", names.join(",")),
    };
    format!("{only} --trials {} --seed {} --format html", asked.trials, asked.seed)
}
