//! Known effects in recordings of real machines: how many of them does a diagnosis find, and what does it make up?
//!
//! In: a folder of recordings (subfolders with `recording.yaml` and its table). Out: tables on standard output. Into each
//! recording each of the fourteen terms is injected that the recording could show, at several sizes: its largest value over what
//! a straight line leaves of the recording. The case and its base are diagnosed in memory. The noise, the nuisances and
//! the unknown physics are those of a real machine, and one truth is certain.
//!
//! ```text
//! cargo run --release --example injected -- --help
//! ```

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program for the terminal, whose cases are its own"
)]

mod folder;
mod options;
mod report;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use clap::Parser;
use diagnosis::diagnosis::Diagnosis;
use recording::Recording;

use limits::injection::allowed;
use limits::injection::base::Base;
use limits::injection::case::{self, Case};
use limits::injection::score::Score;
use options::{Form, Options};
use report::Line;

fn main() {
    let options = Options::parse();
    let bases = bases(&options);
    let cases = cases(&bases, &options);
    if cases.is_empty() {
        eprintln!("{}: no recording allows an effect", options.folder.display());
        std::process::exit(1);
    }
    let lines = judged(&bases, &cases);
    match options.form() {
        Form::Json => println!("{:#}", report::json(&lines, options.seed)),
        form => print!("{}", report::text(&lines, &options.sizes, form == Form::Markdown)),
    }
}

/// The recordings that can be read; what cannot is told and skipped.
fn bases(options: &Options) -> Vec<Base> {
    let mut folders = Vec::new();
    recordings(&options.folder, &mut folders);
    let named = folders.into_iter().filter_map(|folder| {
        let name = folder.strip_prefix(&options.folder).ok()?.display().to_string();
        let wanted = options.only.as_ref().is_none_or(|only| name.contains(only));
        wanted.then_some((name, folder))
    });
    let named: Vec<(String, PathBuf)> = named.collect();
    let read = |number: usize| {
        let (name, folder) = &named[number];
        let base = catch_unwind(AssertUnwindSafe(|| folder::read(name, folder)));
        let base = base.unwrap_or_else(|_| Err("it cannot be made again".to_owned()));
        base.inspect_err(|why| eprintln!("{name}: skipped: {why}")).ok()
    };
    parallel(named.len(), read).into_iter().flatten().collect()
}

/// All folders with a recording, in order.
fn recordings(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let mut folders: Vec<PathBuf> =
        entries.flatten().map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    for folder in folders {
        if folder.join("recording.yaml").is_file() {
            found.push(folder.clone());
        }
        recordings(&folder, found);
    }
}

/// All cases that were asked for.
fn cases(bases: &[Base], options: &Options) -> Vec<Case> {
    let of_base = |number: usize| -> Vec<Case> {
        let base = &bases[number];
        let allowed = allowed::allowed(base, options.seed);
        let wanted = allowed.iter().filter(|one| options.wants(one.effect.kind().name()));
        wanted.flat_map(|one| Case::all(number, base, one, &options.sizes)).collect()
    };
    let cases = parallel(bases.len(), of_base);
    for (base, _) in bases.iter().zip(&cases).filter(|(_, cases)| cases.is_empty()) {
        eprintln!("{}: skipped: none of the effects would show in it", base.name);
    }
    let cases: Vec<Case> = cases.into_iter().flatten().collect();
    let mut kept = case::shuffled(cases.len(), options.seed);
    kept.truncate(options.most);
    let chosen = |number: &usize| kept.contains(number);
    cases.into_iter().enumerate().filter(|(number, _)| chosen(number)).map(|(_, case)| case).collect()
}

/// Diagnoses bases and cases on all processors, and scores.
fn judged<'c>(bases: &'c [Base], cases: &'c [Case]) -> Vec<Line<'c>> {
    let begun = Instant::now();
    let asked = |number: &usize| cases.iter().any(|case| case.base == *number);
    let asked: Vec<usize> = (0..bases.len()).filter(asked).collect();
    let total = asked.len() + cases.len();
    let done = AtomicUsize::new(0);
    let tell = |what: &str| {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        eprintln!("{done} of {total}, {:.0} s: {what}", begun.elapsed().as_secs_f64());
    };
    let alone = parallel(asked.len(), |place| {
        let base = &bases[asked[place]];
        let diagnosis = diagnosed(base, &base.recording);
        tell(&base.name);
        diagnosis
    });
    let lines = parallel(cases.len(), |number| {
        let case = &cases[number];
        let base = &bases[case.base];
        let place = asked.iter().position(|one| *one == case.base)?;
        let found = diagnosed(base, &case.recording(base))?;
        let score = Score::of(case, base, &found, alone[place].as_ref()?);
        let motion = &base.names.motions[case.motion].name;
        let extra = if score.extra.is_empty() {
            String::new()
        } else {
            format!(", extra {}", score.extra.join(", "))
        };
        let left = score.left.map_or(String::new(), |left| format!(", {left:.2} of the base held out"));
        tell(&format!(
            "{} {motion} {} {}: {}{left}{extra}",
            base.name,
            case.effect.kind().name(),
            case.size,
            score.how.word()
        ));
        Some(Line { case, base, score })
    });
    lines.into_iter().flatten().collect()
}

/// A diagnosis; nothing where it fails, which is told.
fn diagnosed(base: &Base, recording: &Recording) -> Option<Diagnosis> {
    let done = catch_unwind(AssertUnwindSafe(|| limits::trial::diagnosed(base, &[recording])));
    done.inspect_err(|_| eprintln!("{}: the diagnosis failed", base.name)).ok()
}

/// What jobs give, in order, from all processors.
fn parallel<T: Send>(count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let (next, results) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let cores = thread::available_parallelism().map_or(2, usize::from);
    let work = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return;
            }
            let result = job(number);
            results.lock().unwrap().push((number, result));
        }
    };
    thread::scope(|scope| (0..cores).for_each(|_| drop(scope.spawn(work))));
    let mut results = results.into_inner().unwrap();
    results.sort_by_key(|(number, _)| *number);
    results.into_iter().map(|(_, result)| result).collect()
}
