//! Which way every run went. In: the runs as the file lists them, its flags, and what the set-up says. Out: a sense for each run;
//! or that it cannot be told.
//!
//! Nothing is guessed: where flags, order of the list and set-up contradict one another, or none of them tells, the set-up must.

use model_dsl::diagnostic::{Diagnostic, Diagnostics};
use model_dsl::source::{Span, Spanned};

use super::measured::{Flagged, Measured, Run, Sense};
use super::setup::Order;

/// The sense of each run of a file in its own counting, in order. `asked` is where the set-up speaks of the file.
///
/// Findings at places of the set-up: E0910 and E0916; in the data a warning W0903 for runs that hold nothing but zeros against the
/// flags, which have no sense.
pub(super) fn senses(
    measured: &Measured,
    order: Option<Spanned<Order>>,
    asked: Span,
    (in_setup, in_data): (&mut Diagnostics, &mut Diagnostics),
) -> Option<Vec<Option<Sense>>> {
    let told = measured.runs.iter().all(|run| run.told.is_some());
    match (told, order) {
        (true, Some(order)) => {
            let message = "the file has a column of directions, but the set-up also has `runs`";
            in_setup.push(Diagnostic::error("E0910", order.span, message).help("remove `runs`"));
            None
        }
        (true, None) => Some(measured.runs.iter().map(|run| run.told).collect()),
        (false, Some(order)) => by_order(measured, order, in_setup),
        (false, None) => by_list(measured, asked, (in_setup, in_data)),
    }
}

/// As the set-up says. A list that goes down while the set-up says up, or up and down in no such turns, is refused.
fn by_order(
    measured: &Measured,
    order: Spanned<Order>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec<Option<Sense>>> {
    let sense = |run: &Run| match order.value {
        Order::Ascending => Sense::Ascending,
        Order::Descending => Sense::Descending,
        Order::Alternating => of_number(run),
    };
    let against = |run: &&Run| {
        sense(run) == Sense::Ascending && run.listed(&measured.targets) == Some(Sense::Descending)
    };
    if let Some(run) = measured.runs.iter().find(against) {
        let message =
            format!("run {} is listed in descending order, but `runs` says that it ascends", run.number);
        let help = "if targets and axis have opposite signs, write `targets: {sign: -1}` instead";
        diagnostics.push(Diagnostic::error("E0916", order.span, message).help(help));
        return None;
    }
    Some(measured.runs.iter().map(|run| Some(sense(run))).collect())
}

/// Odd runs ascend, even runs descend.
fn of_number(run: &Run) -> Sense {
    if run.number % 2 == 1 { Sense::Ascending } else { Sense::Descending }
}

/// As the file lists its runs, where the list tells it and the flags agree.
fn by_list(
    measured: &Measured,
    asked: Span,
    (in_setup, in_data): (&mut Diagnostics, &mut Diagnostics),
) -> Option<Vec<Option<Sense>>> {
    let listed: Vec<Option<Sense>> = measured.runs.iter().map(|run| run.listed(&measured.targets)).collect();
    let both = listed.contains(&Some(Sense::Ascending)) && listed.contains(&Some(Sense::Descending));
    if measured.flagged == Some(Flagged::OneWay) && both {
        let kept = one_way(measured, &listed, in_data);
        if kept.is_none() {
            in_setup.push(undecided(
                "the flags say that all runs go one way, but runs are listed in both directions",
                asked,
            ));
        }
        return kept;
    }
    if both && in_turns(measured, &listed) {
        // A run of one reading has no order of its own; the others go in turns.
        return Some(measured.runs.iter().map(|run| Some(of_number(run))).collect());
    }
    match doubt(measured, &listed, both) {
        None => Some(listed),
        Some(doubt) => {
            in_setup.push(undecided(doubt, asked));
            None
        }
    }
}

/// Whether odd runs ascend and even runs descend, as far as their lists tell.
fn in_turns(measured: &Measured, listed: &[Option<Sense>]) -> bool {
    let mut runs = measured.runs.iter().zip(listed);
    runs.all(|(run, sense)| sense.is_none_or(|sense| sense == of_number(run)))
}

/// Why the list of the runs does not tell their senses; nothing where it does.
fn doubt(measured: &Measured, listed: &[Option<Sense>], both: bool) -> Option<&'static str> {
    let several = measured.runs.len() > 1;
    match measured.flagged {
        _ if listed.contains(&None) => Some("the order of the targets in a run does not show its direction"),
        Some(Flagged::BothWays) if !both && several => {
            Some("the flags say that runs go both ways, but all are listed in one direction")
        }
        None if !both && several => Some("all runs are listed in one direction; they may have been sorted"),
        _ => None,
    }
}

fn undecided(doubt: &str, asked: Span) -> Diagnostic {
    let help = "add `runs: ascending` or `runs: descending` if all went one way, `runs: alternating` if runs 1, 3, 5 ascended and 2, 4, 6 descended";
    Diagnostic::error("E0916", asked, doubt).help(help)
}

/// A file of one direction whose other runs are filled with zeros, as some programs write it: those are no readings (W0903).
/// Nothing where readings go both ways.
fn one_way(
    measured: &Measured,
    listed: &[Option<Sense>],
    in_data: &mut Diagnostics,
) -> Option<Vec<Option<Sense>>> {
    let empty = |run: &Run| run.readings.iter().all(|reading| reading.deviation == 0.0);
    let kept: Vec<Option<Sense>> =
        measured.runs.iter().zip(listed).map(|(run, sense)| sense.filter(|_| !empty(run))).collect();
    let has = |sense: Sense| kept.contains(&Some(sense));
    if has(Sense::Ascending) == has(Sense::Descending) {
        return None;
    }
    for run in measured.runs.iter().filter(|run| empty(run)) {
        let message =
            format!("run {} contains only zeros, and the flags say that all runs go one way", run.number);
        let help = "it is left out as a way back that was not measured; write `runs: alternating` to use it as readings";
        in_data.push(Diagnostic::warning("W0903", run.span, message).help(help));
    }
    Some(kept)
}
