//! How the time and the memory of a diagnosis grow with rows, channels and candidates.
//!
//! In: the most rows and the most cases. Out: a table in Markdown on standard output: each case is a simulated recording of the
//! shipped mill with two concealed effects, diagnosed by a process of its own, whose time and greatest memory are its own
//! too; and the power of the rows with which they grow. It exists so that "linear" is a figure and no opinion.
//!
//! ```text
//! cargo run --release --example diagnosis-growth -- --help
//! ```
//!
//! With `--in-a-row`, one process diagnoses several recordings of the same size, one after another. They differ only in their noise.
//! The table shows how much memory each diagnosis needs, and how much stays allocated after it.
//!
//! One processor: `RAYON_NUM_THREADS=1` before it.

#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a program for the terminal, whose cases are its own"
)]

mod case;
mod measure;

use std::path::PathBuf;

use clap::Parser;

use case::{Case, SEED};
use measure::{Figures, measured};

/// Measures how the time and the memory of a diagnosis grow with rows, channels and candidates.
#[derive(clap::Parser)]
struct Options {
    /// The largest number of rows of a case; with `--in-a-row`, the number of rows of every recording
    #[arg(long, default_value_t = 1_000_000)]
    rows: usize,
    /// Where the simulated recordings are written
    #[arg(long, default_value_os_t = std::env::temp_dir().join("abbe-diagnosis-growth"))]
    folder: PathBuf,
    /// Measure only the growth with this
    #[arg(long, value_parser = ["rows", "channels", "candidates"])]
    only: Option<String>,
    /// Instead, diagnose this number of recordings in one process, one after another
    #[arg(long, value_name = "COUNT")]
    in_a_row: Option<u64>,
}

/// Rows of the cases that have more channels or candidates.
const MIDDLE: usize = 100_000;

fn main() {
    let mut arguments = std::env::args().skip(1);
    match arguments.next().as_deref() {
        Some("--diagnose") => return arguments.for_each(|recording| measure::diagnose(recording.as_ref())),
        Some("--diagnose-in-a-row") => return measure::diagnose_in_a_row(arguments),
        _ => {}
    }
    let options = Options::parse();
    if let Some(count) = options.in_a_row {
        return in_a_row(count, &options);
    }
    let families =
        [("rows", by_rows(options.rows)), ("channels", by_channels()), ("candidates", by_sensors())];
    for (name, cases) in families {
        if options.only.as_ref().is_none_or(|only| only == name) {
            println!("\nGrowth with {name}\n");
            table(&cases, &options.folder);
        }
    }
}

/// Ten thousand rows and three times as many again and again.
fn by_rows(most: usize) -> Vec<Case> {
    let sizes = [1, 3, 10, 30, 100, 300, 500].map(|size| 10_000 * size);
    sizes
        .into_iter()
        .filter(|rows| *rows <= most)
        .map(|rows| Case { rows, channels: 2, sensors: 0, seed: SEED })
        .collect()
}

fn by_channels() -> Vec<Case> {
    (1..=3).map(|channels| Case { rows: MIDDLE, channels, sensors: 0, seed: SEED }).collect()
}

fn by_sensors() -> Vec<Case> {
    (0..=2).map(|sensors| Case { rows: MIDDLE, channels: 2, sensors, seed: SEED }).collect()
}

/// Recordings of one size, one after the other in a process of their own.
fn in_a_row(count: u64, options: &Options) {
    let recorded = |seed: u64| {
        let case = Case { rows: options.rows, channels: 2, sensors: 0, seed };
        case.recorded(&options.folder)
    };
    let recordings: Vec<PathBuf> = (0..count).map(|number| recorded(SEED + number)).collect();
    println!("\n{count} recordings of {} rows in one process\n", options.rows);
    println!("| recording | wall, s | CPU, s | peak memory, MB | memory behind it, MB | findings |");
    println!("| --: | --: | --: | --: | --: | --: |");
    measure::in_a_row(&recordings);
}

fn table(cases: &[Case], folder: &std::path::Path) {
    println!(
        "| rows | channels | sensors | candidates | wall, s | CPU, s | peak memory, MB | memory / data | findings |"
    );
    println!("| --: | --: | --: | --: | --: | --: | --: | --: | --: |");
    let mut found: Vec<(f64, Figures)> = Vec::new();
    for case in cases {
        let recording = case.recorded(folder);
        let data = std::fs::metadata(recording.with_file_name("data.csv")).unwrap().len();
        let figures = measured(&recording);
        println!(
            "| {} | {} | {} | {} | {:.2} | {:.2} | {:.0} | {:.1} | {} |",
            case.rows,
            case.channels,
            case.sensors,
            figures.candidates,
            figures.wall,
            figures.cpu,
            figures.memory / 1e6,
            figures.memory / data as f64,
            figures.findings
        );
        found.push((case.rows as f64, figures));
    }
    let power = |of: fn(&Figures) -> f64| power(found.iter().map(|(rows, figures)| (*rows, of(figures))));
    if let (Some(wall), Some(cpu), Some(memory)) =
        (power(|of| of.wall), power(|of| of.cpu), power(|of| of.memory))
    {
        println!("\nPower of the rows: wall {wall:.2}, CPU {cpu:.2}, peak memory {memory:.2}.");
    }
}

/// The slope of a straight line through logarithms; nothing where there is only one number of rows.
fn power(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let points: Vec<(f64, f64)> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let spread: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let along: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    (spread > 0.0).then(|| along / spread)
}
