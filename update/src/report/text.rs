//! The report for a terminal. In: an update. Out: text of at most 100 columns, but for names that are longer.

use diagnosis::report::{WIDTH, paragraph, plain};

use crate::Method;
use crate::residuals::Residual;
use crate::setup::Rotation;
use crate::update::{Change, Part, Relation, Update};

/// How many changes are listed; JSON has all of them.
const CHANGES: usize = 40;

/// How many others of a relation are named.
const OTHERS: usize = 6;

/// The update as text for a person.
pub fn text(update: &Update) -> String {
    let mut text = format!("Update of {} by {}\n\n", plain(&update.machine), update.options.method.name());
    text += &update.parts.iter().map(part).collect::<String>();
    text += &wrapped(&datum(update), "", "");
    text += &rotations(update);
    text += &update.hints.iter().map(|hint| wrapped(hint, "", "   ")).collect::<String>();
    text += &wrapped(&system(update), "", "");
    text += &figures("Residuals, um (absolute values)", &update.residuals);
    text += &figures("Residuals at the held-out points, um", &update.held_out);
    text += &wrapped(&unseen(update), "", "");
    text += &changes(update);
    text += &relations(&update.relations);
    text += &fixed(update);
    text
}

fn part(part: &Part) -> String {
    let mut facts = vec![format!("{} readings", part.points)];
    if part.held_out > 0 {
        facts.push(format!("{} held out", part.held_out));
    }
    if part.left_out > 0 {
        facts.push(format!("{} left out, because their rows lack a position or a normal", part.left_out));
    }
    if !part.standing.is_empty() {
        facts.push(format!("{} assumed to be at zero", part.standing.join(", ")));
    }
    wrapped(&format!("{}: {}.", part.file, facts.join("; ")), "", "   ")
}

fn datum(update: &Update) -> String {
    let zero = match update.datum.as_slice() {
        [] => "No zero is free: the places of the parts are taken as known.".to_owned(),
        free => {
            let zeros =
                if update.zeros == 1 { "1 zero".to_owned() } else { format!("{} zeros", update.zeros) };
            format!("The zero of every set-up is free in {} ({zeros}).", free.join(" and "))
        }
    };
    let compensated = match update.options.compensated {
        true => " The parts were made with this calibration's compensation.",
        false => "",
    };
    zero + compensated
}

/// How the parts lie whose datum is free.
fn rotations(update: &Update) -> String {
    if update.rotations.is_empty() {
        return String::new();
    }
    let several = |file: &str| {
        let mut runs = update.rotations.iter().filter(|one| one.file == file).map(|one| one.run);
        let first = runs.next();
        runs.any(|run| Some(run) != first)
    };
    let line = |one: &Rotation| {
        let run = if several(&one.file) { format!(", run {}", one.run) } else { String::new() };
        wrapped(&format!("{}{run}: {} about {}", one.file, angle(one), one.about), "   ", "      ")
    };
    let lines: String = update.rotations.iter().map(line).collect();
    format!("The datum of these parts is free. They are rotated by\n{lines}")
}

/// An angle with its standard uncertainty, in urad and in degrees.
fn angle(rotation: &Rotation) -> String {
    let angle = rotation.angle;
    let uncertainty = rotation.uncertainty.map_or(String::new(), |size| format!(" +- {:.1}", size * 1e6));
    format!("{:.1}{uncertainty} urad ({:.4} deg)", angle * 1e6, angle.to_degrees())
}

fn system(update: &Update) -> String {
    let rank = format!(
        "{} readings, {} coefficients, rank {} (singular values up to {:.2e} count as zero",
        update.points, update.unknowns, update.rank, update.tolerance
    );
    let counted: Vec<f64> = update.singular_values.iter().copied().take(update.rank).collect();
    let range = match (counted.first(), counted.last()) {
        (Some(greatest), Some(least)) => {
            format!("; those that count run from {greatest:.3e} to {least:.3e}).")
        }
        _ => ").".to_owned(),
    };
    rank + &range
}

fn figures(heading: &str, residuals: &[Residual]) -> String {
    if residuals.is_empty() {
        return String::new();
    }
    let row = |residual: &Residual| {
        let (one, other) = (residual.before, residual.after);
        let sizes = [one.max, one.mean, one.std, other.max, other.mean, other.std];
        let sizes: String = sizes.iter().map(|size| format!("{:>9.2}", size * 1e3)).collect();
        format!("{:<10}{:>7}{sizes}\n", residual.direction, residual.points)
    };
    let titles = ["max", "mean", "std", "max", "mean", "std"].map(|title| format!("{title:>9}")).concat();
    format!(
        "\n{heading}\n{:<10}{:>7}{:>27}{:>27}\n{:17}{titles}\n{}",
        "direction",
        "points",
        "before",
        "after",
        "",
        residuals.iter().map(row).collect::<String>()
    )
}

fn unseen(update: &Update) -> String {
    let [before, after] = update.leave_one_out;
    let one_out = match (before, after) {
        (Some(before), Some(after)) => format!(
            "Readings not used in the fit (leave-one-out): {:.2} um rms before, {:.2} um after.",
            before * 1e3,
            after * 1e3
        ),
        _ => "Some readings alone determine a part of the model, so nothing tests it there.".to_owned(),
    };
    let noise = match update.noise {
        Some(noise) => format!(" Noise of a reading, from the residuals: {:.2} um.", noise * 1e3),
        None => " There are no redundant readings, so the noise is unknown and the fit cannot be tested."
            .to_owned(),
    };
    let expected = update.expected_change.map_or(String::new(), |expected| {
        format!(" The readings suggest relative changes of {:.3} (standard deviation).", expected)
    });
    one_out + &noise + &expected
}

fn changes(update: &Update) -> String {
    let stand = update.unknowns - update.changes.len();
    if update.changes.is_empty() {
        return "\nNo change is worth its penalty: all coefficients stay the same.\n".to_owned();
    }
    let longest = update.changes.iter().map(|change| change.name.chars().count()).max().unwrap_or(0).max(11);
    let title = format!(
        "\n{:<longest$} {:>13} {:>13} {:>11} {:>10} {:>9}  unit\n",
        "coefficient", "before", "after", "uncertainty", "change", "moves um"
    );
    let mut text = title;
    text.extend(update.changes.iter().take(CHANGES).map(|change| row(change, longest)));
    let more = update.changes.len().saturating_sub(CHANGES);
    if more > 0 {
        text += &format!("{more} smaller changes: --format json lists them.\n");
    }
    if stand > 0 {
        text += &format!("The other {stand} coefficients stay the same.\n");
    }
    if update.changes.iter().any(|change| !change.determined) && update.options.method != Method::Select {
        text += &wrapped(
            "* not determined by itself: see below. Its uncertainty covers the part that the points show; with ridge, it also \
             covers the part that they do not show.",
            "",
            "  ",
        );
    }
    text
}

fn row(change: &Change, longest: usize) -> String {
    let uncertainty = change.uncertainty.map_or("-".to_owned(), |size| format!("{size:.2e}"));
    let mark = if change.determined { "" } else { " *" };
    let row = format!(
        "{:<longest$} {:>13.5e} {:>13.5e} {uncertainty:>11} {:>9.2} % {:>7.2}  {}{mark}\n",
        change.name,
        change.before,
        change.after,
        change.change * 1e2,
        change.effect * 1e3,
        change.unit
    );
    match change.alternatives.as_slice() {
        [] => row,
        others => row + &wrapped(&format!("equally good: {}", named(others)), "    ", "      "),
    }
}

fn relations(relations: &[Relation]) -> String {
    let (unseen, alike): (Vec<&Relation>, Vec<&Relation>) =
        relations.iter().partition(|relation| relation.others.is_empty());
    let mut text = String::new();
    if !alike.is_empty() {
        text += "\nCollinear at these points\n";
        for relation in alike {
            let with = if relation.others.len() > 1 { "a sum of " } else { "" };
            let line = format!("{} and {with}{}", relation.name, named(&relation.others));
            text += &wrapped(&line, "   ", "      ");
        }
    }
    if !unseen.is_empty() {
        let names: Vec<String> = unseen.iter().map(|relation| relation.name.clone()).collect();
        text += "\nNot visible at these points\n";
        text += &wrapped(&names.join(", "), "   ", "   ");
    }
    text
}

fn named(names: &[String]) -> String {
    let more = names.len().saturating_sub(OTHERS);
    let named: Vec<&str> = names.iter().take(OTHERS).map(String::as_str).collect();
    match more {
        0 => named.join(", "),
        _ => format!("{} and {more} more", named.join(", ")),
    }
}

/// What was not moved, by reason.
fn fixed(update: &Update) -> String {
    let mut reasons: Vec<&str> = Vec::new();
    for fixed in &update.fixed {
        if !reasons.contains(&fixed.reason) {
            reasons.push(fixed.reason);
        }
    }
    if reasons.is_empty() {
        return String::new();
    }
    let line = |reason: &&str| {
        let all = update.fixed.iter().filter(|fixed| fixed.reason == *reason);
        let names: Vec<String> = all.map(|fixed| fixed.name.clone()).collect();
        wrapped(&format!("{}: {reason}", names.join(", ")), "   ", "      ")
    };
    format!("\nNot changed\n{}", reasons.iter().map(line).collect::<String>())
}

fn wrapped(text: &str, first: &str, others: &str) -> String {
    paragraph(WIDTH, text, first, others)
}
