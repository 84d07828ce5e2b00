//! What the samples of LinuxCNC show of a compensation, and whether a diagnosis finds what was hidden from it.
//!
//! In: the samples that `test.sh` takes, or the diagnosis of them as JSON. Out: figures on standard output, and status 1 where one
//! is not what it has to be; from the samples also the table of a recording. It exists so that the test of LinuxCNC is judged by
//! figures, which stand here beside what they may be at most.
//!
//! ```text
//! cargo run --example linuxcnc -- samples SAMPLES RECORDING
//! cargo run --example linuxcnc -- diagnosis DIAGNOSIS
//! cargo run --example linuxcnc -- screw SAMPLES TYPE:FILE...
//! cargo run --example linuxcnc -- five SAMPLES
//! ```

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

mod five;
mod samples;
mod screw;

use std::error::Error;
use std::process::ExitCode;
use std::{env, fs};

use samples::{Phase, Sample};
use serde_json::Value;

/// The error that may be left, as a part of the one without compensation: in the mean and at its greatest.
const LEFT: f64 = 0.05;

/// The time of a fade, s: what `mill-12.yaml` says.
const FADE: f64 = 0.5;
/// The greatest change of a correction in mm/s, from the same place.
const RATE: f64 = 20.0;
/// The longest period that the servo thread tells of, s: it is told to be 1 ms, and measures what it is.
const CYCLE: f64 = 0.001_1;

/// The lost motion of Y in `plant.c`, mm.
const HIDDEN: f64 = 0.012;

/// What was found wanting.
type Complaint = Box<dyn Error>;

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let judged = match words[..] {
        ["samples", samples, recording] => judge_samples(samples, recording),
        ["diagnosis", diagnosis] => judge_diagnosis(diagnosis),
        ["screw", samples, ref files @ ..] => judge_screws(samples, files),
        ["five", samples] => five::judge(samples),
        _ => {
            Err("samples SAMPLES RECORDING, diagnosis DIAGNOSIS, screw SAMPLES TYPE:FILE... or five SAMPLES"
                .into())
        }
    };
    match judged {
        Ok(()) => ExitCode::SUCCESS,
        Err(complaint) => {
            eprintln!("{complaint}");
            ExitCode::FAILURE
        }
    }
}

/// LinuxCNC's own tables, a file for each joint: what it does with them is what Abbe says that it does.
fn judge_screws(samples: &str, files: &[&str]) -> Result<(), Complaint> {
    let samples = fs::read_to_string(samples)?;
    for (joint, file) in files.iter().enumerate() {
        let (kind, path) = file.split_once(':').ok_or("write TYPE:FILE")?;
        let table = screw::table(&fs::read_to_string(path)?, kind)?;
        let agreement = screw::agreement(&samples, joint, &table)?;
        println!(
            "screw compensation of joint {joint}, {} entries: up to {:.2} um, told to {:.4} um",
            table.len(),
            agreement.greatest * 1e3,
            agreement.difference * 1e3
        );
        hold(agreement.moved.iter().all(|cycles| *cycles > 1000), "the joint did not go both ways")?;
        hold(agreement.holds(), "LinuxCNC does something else with the file than Abbe says")?;
        hold(
            table.is_empty() == (agreement.greatest == 0.0),
            "a table that is empty corrects, or one that is not does not",
        )?;
    }
    Ok(())
}

fn judge_samples(path: &str, recording: &str) -> Result<(), Complaint> {
    let samples = samples::read(&fs::read_to_string(path)?)?;
    let of = |phase| samples.iter().filter(move |sample| sample.phase == phase).collect::<Vec<_>>();
    judge_errors(&of(Phase::Off), &of(Phase::On))?;
    judge_steps(&samples)?;
    judge_following(&samples)?;
    tell_times(of(Phase::On).iter().map(|sample| sample.nanoseconds).collect());
    fs::write(recording, samples::table(&of(Phase::Off)))?;
    Ok(())
}

/// The error at the tool, with compensation beside without.
fn judge_errors(off: &[&Sample], on: &[&Sample]) -> Result<(), Complaint> {
    // Both must be the whole program: two circles and two diagonals, which take more than 10 s.
    hold(off.len() > 10_000 && on.len() > 10_000, "the program was not sampled as a whole")?;
    let errors =
        |samples: &[&Sample]| samples.iter().map(|sample| sample.error() * 1e3).collect::<Vec<f64>>();
    let compared = compare("error at the tool", "um", &[off, on].map(errors));
    hold(compared.least > 20.0, "the mill hardly errs: there is nothing to be shown")?;
    hold(compared.left < LEFT, "too much of the error is left")
}

/// Errors without compensation and with it, of their mean and of their greatest.
struct Compared {
    /// The lesser of both without compensation.
    least: f64,
    /// The greater part that is left of them.
    left: f64,
}

/// Tells of errors without compensation and with it.
fn compare(what: &str, unit: &str, [off, on]: &[Vec<f64>; 2]) -> Compared {
    let mut compared = Compared { least: f64::INFINITY, left: 0.0 };
    for (which, figure) in [("rms", rms as fn(&[f64]) -> f64), ("greatest", greatest)] {
        let (without, with) = (figure(off), figure(on));
        let part = with / without;
        println!(
            "{what}, {which}: {without:.2} {unit} without compensation, {with:.2} {unit} with it, {:.1} %",
            part * 100.0
        );
        compared = Compared { least: compared.least.min(without), left: compared.left.max(part) };
    }
    compared
}

fn rms(errors: &[f64]) -> f64 {
    let sum: f64 = errors.iter().map(|error| error.powi(2)).sum();
    (sum / errors.len() as f64).sqrt()
}

fn greatest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

/// How far the corrections go in one cycle: no further than the rate lets them at any time, and while they fade in at rest, where
/// neither a motion nor a reversal changes them, no further than the fade does.
fn judge_steps(samples: &[Sample]) -> Result<(), Complaint> {
    let any = largest_step(samples, |_| true);
    let standing = largest_step(samples, |sample| sample.phase == Phase::Standing);
    let corrections = samples.iter().filter(|sample| sample.phase == Phase::Standing);
    let reached = corrections.map(|sample| samples::length(sample.correction)).fold(0.0, f64::max);
    let fading = reached * CYCLE / FADE;
    println!(
        "largest step of the corrections: {:.3} um while {:.1} um of them fade in, {:.1} um at reversals",
        standing * 1e3,
        reached * 1e3,
        any * 1e3
    );
    hold(reached > 0.005, "nothing fades in")?;
    hold(standing <= fading, "the corrections jump when they are switched on")?;
    hold(any <= RATE * CYCLE, "the corrections change faster than they may")
}

/// The largest step from one sample to the next, both of them in what is looked at.
fn largest_step(samples: &[Sample], of: impl Fn(&Sample) -> bool) -> f64 {
    let pairs = samples.iter().zip(samples.iter().skip(1));
    let steps = pairs
        .filter(|(from, to)| of(from) && of(to))
        .map(|(from, to)| samples::length([0, 1, 2].map(|axis| to.correction[axis] - from.correction[axis])));
    steps.fold(0.0, f64::max)
}

/// The motion controller never saw a correction, and never stopped.
fn judge_following(samples: &[Sample]) -> Result<(), Complaint> {
    let watched = || samples.iter().filter(|sample| sample.phase != Phase::SettingUp);
    let following = watched().map(|sample| samples::length(sample.following)).fold(0.0, f64::max);
    println!("greatest following error: {:.3} um", following * 1e3);
    hold(watched().all(|sample| sample.machine_on), "the machine was switched off")?;
    hold(following < 0.001, "the corrections come back as a following error")?;
    let seen = |phase, status| samples.iter().any(|sample| (sample.phase, sample.status) == (phase, status));
    hold(seen(Phase::Off, 5) && !seen(Phase::Off, 1), "compensated while it was to be off")?;
    hold(seen(Phase::On, 1) && !seen(Phase::On, 5), "not compensated while it was to be on")?;
    let both = seen(Phase::Silent, 2) && seen(Phase::Silent, 3);
    hold(both, "a silent thermometer was not held and then given up")
}

/// How long a cycle of Abbe takes. It is told and not judged: what else the machine does in that time counts too.
fn tell_times(mut times: Vec<f64>) {
    times.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let index =
            times.iter().enumerate().find(|(index, _)| *index as f64 >= part * (times.len() - 1) as f64);
        index.map_or(f64::NAN, |(_, time)| time / 1e3)
    };
    println!(
        "a cycle of Abbe takes {:.1} us in the median, {:.1} us at 99 %, {:.1} us at worst, on a kernel that is {}",
        at(0.5),
        at(0.99),
        at(1.0),
        if fs::exists("/sys/kernel/realtime").unwrap_or(false) { "real-time" } else { "not real-time" }
    );
}

/// The diagnosis names the play of Y, and how much it is.
fn judge_diagnosis(path: &str) -> Result<(), Complaint> {
    let diagnosis: Value = serde_json::from_str(&fs::read_to_string(path)?)?;
    let findings = diagnosis["findings"].as_array().ok_or("no findings")?;
    hold(findings.len() == 1, "not one finding")?;
    let finding = findings.first().ok_or("no finding")?;
    let named = (finding["motion"].as_str(), finding["term"].as_str());
    hold(named == (Some("EYY"), Some("backlash")), "another finding than the play of Y")?;
    let lost_motion = &finding["parameters"]["lost_motion"];
    let number = |value: &Value| value.as_f64().ok_or("no number");
    let (value, low, high) =
        (number(&lost_motion["value"])?, number(&lost_motion["ci95"][0])?, number(&lost_motion["ci95"][1])?);
    println!(
        "the play of Y that was hidden: {:.2} um found, {:.2} to {:.2} um; {:.2} um in the plant",
        value * 1e3,
        low * 1e3,
        high * 1e3,
        HIDDEN * 1e3
    );
    // Of a hundred intervals of 95 % five do not hold what is in the plant: one of them says nothing of a fault.
    hold((value - HIDDEN).abs() < samples::STEP, "it is not what is in the plant, to the instrument's step")?;
    hold(high - low < HIDDEN / 10.0, "the interval is wide")
}

fn hold(holds: bool, otherwise: &str) -> Result<(), Complaint> {
    if holds { Ok(()) } else { Err(otherwise.into()) }
}
