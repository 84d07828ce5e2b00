//! The verdict in one line. In: a diagnosis. Out: a sentence of plain words without its end.

use super::figure::{change, percent, size};
use super::remains::brief;
use crate::diagnosis::{Denied, Diagnosis, Verdict};

pub(super) fn sentence(diagnosis: &Diagnosis) -> String {
    match diagnosis.verdict {
        Verdict::Undecided => undecided(diagnosis),
        Verdict::Adequate => adequate(diagnosis),
        Verdict::LeftOutPhysics => format!("{}: {}", subject(diagnosis), found(diagnosis)),
        Verdict::Unexplained => format!("unexplained: {}", unexplained(diagnosis)),
        Verdict::NotRepeatable => format!("not repeatable: {}", not_repeatable(diagnosis)),
    }
}

fn undecided(diagnosis: &Diagnosis) -> String {
    let sentence = diagnosis.undecidable.as_deref().unwrap_or("These recordings cannot decide anything.");
    format!("undecided: {}", sentence.trim_end_matches('.'))
}

fn adequate(diagnosis: &Diagnosis) -> String {
    let settings = match settings(diagnosis) {
        Some(settings) => format!(", with the instruments' own settings ({settings})"),
        None => String::new(),
    };
    format!(
        "adequate: nothing systematic is above the noise{settings}; {}, {}{}",
        remaining(diagnosis),
        noise(diagnosis),
        denied(&diagnosis.denied)
    )
}

/// From which size on effects would have been found.
fn denied(denied: &[Denied]) -> String {
    let one = |one: &Denied| {
        let period = one.period.map(|(period, unit)| format!(" of period {}", size(period, unit)));
        let period = period.unwrap_or_default();
        format!("no {} in {}{period} above about {}", one.term, one.motion, size(one.above, one.unit))
    };
    let all: Vec<String> = denied.iter().map(one).collect();
    if all.is_empty() { String::new() } else { format!("; {}", all.join(", ")) }
}

/// What was wrong: the physics, or the files.
fn subject(diagnosis: &Diagnosis) -> &'static str {
    match (diagnosis.model.is_empty(), diagnosis.findings.is_empty()) {
        (true, _) => "left-out physics",
        (false, true) => "wrong files",
        (false, false) => "wrong files, and left-out physics",
    }
}

fn found(diagnosis: &Diagnosis) -> String {
    let what = match (effects(diagnosis), settings(diagnosis)) {
        (Some(effects), _) => effects,
        (None, Some(settings)) => format!("of the instruments, not of the machine ({settings})"),
        (None, None) => "none with a name".to_owned(),
    };
    format!("{what}; {}, {}", fall(diagnosis), noise(diagnosis))
}

fn unexplained(diagnosis: &Diagnosis) -> String {
    let place = diagnosis.unexplained.as_ref().map(brief);
    let place = place.map_or_else(String::new, |place| format!(" {place}"));
    match effects(diagnosis) {
        Some(effects) => {
            format!("{effects}, and no term fits the rest{place}; {}, {}", fall(diagnosis), noise(diagnosis))
        }
        None => format!(
            "something systematic that no term fits{place}; {}, {}",
            remaining(diagnosis),
            noise(diagnosis)
        ),
    }
}

fn not_repeatable(diagnosis: &Diagnosis) -> String {
    let differ = match &diagnosis.repeatability {
        Some(found) => {
            let [between, expected] =
                [found.between_runs, found.expected].map(|value| size(value, found.unit));
            format!("runs in the same state differ by {between}, but the noise gives only {expected}")
        }
        None => "runs in the same state differ by more than the noise".to_owned(),
    };
    match effects(diagnosis) {
        Some(effects) => format!("{differ}; {effects}"),
        None => format!("{differ}; no model of the state can explain that"),
    }
}

/// How many findings and faults of files there are, and how much they explain together; nothing without any.
fn effects(diagnosis: &Diagnosis) -> Option<String> {
    let (effects, faults) = (diagnosis.findings.len(), diagnosis.model.len());
    let counted = |count: usize, name: &str| match count {
        0 => None,
        1 => Some(format!("1 {name}")),
        count => Some(format!("{count} {name}s")),
    };
    let names: Vec<String> =
        [counted(faults, "fault"), counted(effects, "effect")].into_iter().flatten().collect();
    let verb = if effects + faults == 1 { "explains" } else { "explain" };
    let together = percent(together(diagnosis));
    (!names.is_empty()).then(|| format!("{} {verb} {together} of what the model missed", names.join(" and ")))
}

/// By how much the variance above the noise has come down, of the held-out data where there are any. The shares of the
/// findings do not add up to it: where one is left out, others may stand in for a part of it.
fn together(diagnosis: &Diagnosis) -> f64 {
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let (before, after) = before.holdout_rms.zip(after.holdout_rms).unwrap_or((before.rms, after.rms));
    let above = |rms: f64| {
        let variance = rms * rms - diagnosis.noise.value.powi(2);
        // A maximum would hide that the rms is not known.
        if variance < 0.0 { 0.0 } else { variance }
    };
    1.0 - above(after) / above(before)
}

/// The names of the settings, each once.
fn settings(diagnosis: &Diagnosis) -> Option<String> {
    let mut names: Vec<&str> = Vec::new();
    for setting in &diagnosis.settings {
        if !names.contains(&setting.term) {
            names.push(setting.term);
        }
    }
    (!names.is_empty()).then(|| names.join(", "))
}

/// What the residual was and is: of the held-out data where there are any.
fn fall(diagnosis: &Diagnosis) -> String {
    let (before, after) = (&diagnosis.before, &diagnosis.after);
    let held_out = before.holdout_rms.zip(after.holdout_rms);
    let (name, (before_rms, after_rms)) = match held_out {
        Some(held_out) => ("held-out rms", held_out),
        None => ("rms (nothing could be held out)", (before.rms, after.rms)),
    };
    match change(before_rms, after_rms, after.unit) {
        Some((before, after)) => format!("{name} falls from {before} to {after}"),
        None => format!("{name} is unknown"),
    }
}

fn remaining(diagnosis: &Diagnosis) -> String {
    let after = &diagnosis.after;
    match after.holdout_rms {
        Some(rms) => format!("held-out rms {}", size(rms, after.unit)),
        None => format!("rms {}", size(after.rms, after.unit)),
    }
}

fn noise(diagnosis: &Diagnosis) -> String {
    format!("noise {}", size(diagnosis.noise.value, diagnosis.noise.unit))
}
