//! A sweep over concealed effects: how much of what is left out does a diagnosis find, and how much does it make up?
//!
//! In: a seed and how many cases. Out: tables in Markdown on standard output. Each case is a machine with known errors,
//! one to three effects that its calibration is not told of (or none), and recordings of it in memory, made by the exact
//! simulation; the diagnosis reads them back as it would read files. It exists because fifteen examples tell little of
//! the next recording.
//!
//! ```text
//! cargo run --release --example concealed-sweep -- --help
//! ```

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a program for the terminal, whose cases are its own"
)]

mod bench;
mod case;
mod draw;
mod effect;
mod evidence;
mod report;
mod scene;
mod score;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use clap::Parser;
use clap::builder::PossibleValuesParser;
use diagnosis::{Inputs, diagnose};
use model_dsl::calibration::write;

use case::{Case, QUIET};
use report::Line;
use score::{How, Score};

/// Diagnoses many simulated machines with concealed effects, and counts what is found and what is made up.
#[derive(clap::Parser)]
struct Options {
    /// Number of cases with one to three concealed effects
    #[arg(long, value_name = "N", default_value_t = 360)]
    count: usize,
    /// Number of cases with no concealed effect
    #[arg(long, value_name = "N", default_value_t = 120)]
    quiet_count: usize,
    /// Seed of the cases: the same seed gives the same cases
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Conceal this term in every case that conceals something
    #[arg(long, value_name = "TERM", value_parser = PossibleValuesParser::new(effect::TERMS.map(|(term, _)| term)))]
    only: Option<String>,
    /// Run only this case, and show the truth beside the diagnosis
    #[arg(long, value_name = "NUMBER")]
    case: Option<usize>,
    /// Write the files of that case to this folder
    #[arg(long, value_name = "FOLDER", requires = "case")]
    dump: Option<PathBuf>,
    /// Start no new case after this number of minutes
    #[arg(long, default_value_t = 15.0)]
    minutes: f64,
    /// Report each case that fails
    #[arg(short, long)]
    verbose: bool,
}

fn main() {
    let options = Options::parse();
    if let Some(number) = options.case {
        return alone(&options, number);
    }
    let numbers: Vec<usize> = interleaved(options.count, options.quiet_count);
    let (next, lines, begun) = (AtomicUsize::new(0), Mutex::new(Vec::new()), Instant::now());
    let cores = thread::available_parallelism().map_or(2, usize::from);
    thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| {
                while let Some(number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if begun.elapsed().as_secs_f64() > 60.0 * options.minutes {
                        break;
                    }
                    if let Some(line) = run(&options, *number) {
                        lines.lock().unwrap().push(line);
                    }
                }
            });
        }
    });
    let mut lines = lines.into_inner().unwrap();
    lines.sort_by_key(|line| line.case.number);
    let minutes = begun.elapsed().as_secs_f64() / 60.0;
    println!("# Concealed effects: {} cases, seed {}, {minutes:.1} min\n", lines.len(), options.seed);
    println!("{}", report::markdown(&lines));
}

/// Cases with effects and without, mixed, so that a sweep that is stopped has some of both.
fn interleaved(count: usize, quiet: usize) -> Vec<usize> {
    let mut numbers: Vec<(f64, usize)> =
        (0..count).map(|number| (number as f64 / count as f64, number)).collect();
    numbers.extend((0..quiet).map(|number| (number as f64 / quiet as f64, QUIET + number)));
    numbers.sort_by(|left, right| left.0.total_cmp(&right.0));
    numbers.into_iter().map(|(_, number)| number).collect()
}

/// Makes, diagnoses and scores one case.
fn run(options: &Options, number: usize) -> Option<Line> {
    let case = Case::draw(options.seed, number, options.only.as_deref());
    let done = catch_unwind(AssertUnwindSafe(|| judge(&case)));
    let Ok((diagnosis, score)) = done else {
        eprintln!("case {number}: panicked: {}", headline(&case));
        return None;
    };
    let failed = !score.verdict_right || !score.wrong.is_empty() || score.effects.contains(&How::Missed);
    let strayed = score.held.iter().any(|held| held.away.abs() > 3.0) || score.sides.contains(&false);
    if options.verbose && (failed || strayed) {
        let detail = verdict_line(&case, &diagnosis, &score);
        eprintln!("case {number}: {}; {detail}", headline(&case));
    }
    Some(Line { case, score })
}

fn judge(case: &Case) -> (diagnosis::diagnosis::Diagnosis, Score) {
    let recordings = case.recordings();
    let begun = Instant::now();
    let inputs = Inputs {
        equations: &case.bench.compiled.equations,
        calibration: case.told(),
        recordings: recordings.iter().collect(),
        holdout: None,
        calibration_file: None,
        chains: None,
    };
    let diagnosis = diagnose(&inputs, &mut |_| {});
    let score = Score::of(case, &diagnosis, begun.elapsed().as_secs_f64());
    (diagnosis, score)
}

/// One case alone: truth against diagnosis, and its files.
fn alone(options: &Options, number: usize) {
    let case = Case::draw(options.seed, number, options.only.as_deref());
    println!("{}", headline(&case));
    println!("expected: {:?}", case.expected);
    for planted in &case.planted {
        println!("  {:?} {planted:?}", planted.name(&case.bench.names));
    }
    if let Some(folder) = &options.dump {
        dump(&case, folder);
    }
    let (diagnosis, score) = judge(&case);
    println!("{}", verdict_line(&case, &diagnosis, &score));
    score.held.iter().for_each(|held| {
        println!("  {} ({:.1} sigma){}", held.told, held.away, if held.inside { "" } else { " MISSES" })
    });
    println!("\n{}", diagnosis::report::text(&diagnosis));
}

/// A case in one line.
fn headline(case: &Case) -> String {
    let scenes = case.scenes.iter().zip(&case.takes).map(|(scene, take)| {
        let measurement = &scene.scenario.measurement;
        let mut more = String::new();
        if !measurement.drives.is_empty() {
            more += " drives";
        }
        if measurement.noise.outliers.is_some() {
            more += " outliers";
        }
        if measurement.missing.rate > 0.0 {
            more += " gaps";
        }
        if scene.short.is_some() {
            more += " short-run";
        }
        let rows = take.simulated.time.len();
        format!(
            "{:?}/{} {rows} rows, {} runs, {:.3} Hz{more}",
            scene.kind,
            measurement.instrument.name(),
            scene.scenario.path.runs,
            scene.rate
        )
    });
    let scenes: Vec<String> = scenes.collect();
    format!("{} {} noise; {}", case.bench.name, case.noises.name(), scenes.join(" + "))
}

fn verdict_line(case: &Case, diagnosis: &diagnosis::diagnosis::Diagnosis, score: &Score) -> String {
    let mut text = String::new();
    if !score.verdict_right {
        text += &format!("VERDICT {} for {:?}; ", score.verdict, case.expected);
    }
    let weights = score.energies.iter().zip(&score.evidence).zip(&case.sizes);
    for ((planted, how), ((energy, evidence), size)) in case.planted.iter().zip(&score.effects).zip(weights) {
        let (motion, term) = planted.name(&case.bench.names);
        text += &format!(
            "[{motion} {term}{} size {size} energy {energy:.0} evidence {evidence:.0}: {how:?}] ",
            if planted.kind() == "wind-up" { " wind-up" } else { "" }
        );
    }
    let found: Vec<String> =
        diagnosis.findings.iter().map(|finding| format!("{} {}", finding.motion, finding.term)).collect();
    let settings: Vec<&str> = diagnosis.settings.iter().map(|setting| setting.term).collect();
    text += &format!("found [{}] [{}]", found.join(", "), settings.join(", "));
    if !score.wrong.is_empty() {
        text += &format!(" FALSE {}", score.wrong.join(", "));
        if let Some(evidence) = score.mistaken {
            text += &format!(" against evidence {evidence:.0}");
        }
    }
    for held in score.held.iter().filter(|held| held.away.abs() > 3.0) {
        text += &format!(" STRAY {} ({:.1} sigma)", held.told, held.away);
    }
    if score.sides.contains(&false) {
        text += " SIDE";
    }
    if score.holdout.is_some_and(|ratio| !(0.9..1.1).contains(&ratio)) {
        text += &format!(" holdout {:.2}", score.holdout.unwrap_or_default());
    }
    text + &format!(" {:.1} s, {} rows", score.seconds, score.rows)
}

/// Writes a case as files.
fn dump(case: &Case, folder: &Path) {
    fs::create_dir_all(folder).unwrap();
    for take in 0..case.takes.len() {
        let (head, data) = case.files(take);
        fs::write(folder.join(format!("recording-{}.yaml", take + 1)), head).unwrap();
        fs::write(folder.join(format!("recording-{}.csv", take + 1)), data).unwrap();
    }
    fs::write(folder.join("calibration.yaml"), write(&case.known, &case.bench.names)).unwrap();
    let truth =
        case.planted.iter().map(|planted| format!("{:?} {planted:?}\n", planted.name(&case.bench.names)));
    fs::write(folder.join("truth.txt"), format!("{:?}\n{}", case.expected, truth.collect::<String>()))
        .unwrap();
}
