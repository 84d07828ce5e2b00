//! Progress on a terminal. In: how far the diagnosis is. Out: one line on standard error, after the first second, which is
//! gone when the work is done; nothing where nobody watches.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use diagnosis::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// Shorter work needs no line.
const PATIENCE: Duration = Duration::from_secs(1);

/// The steps of a full bar.
const STEPS: u64 = 1000;

/// The line, once there is one.
pub(super) struct Display {
    began: Instant,
    watched: bool,
    bar: Option<ProgressBar>,
}

impl Display {
    pub(super) fn new(quiet: bool) -> Self {
        Self { began: Instant::now(), watched: !quiet && io::stderr().is_terminal(), bar: None }
    }

    pub(super) fn show(&mut self, progress: &Progress) {
        if !self.watched || self.began.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_insert_with(bar);
        bar.set_message(progress.step);
        bar.set_position(steps(progress.done));
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar() -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}");
    // A template that did not fit would leave the usual bar.
    ProgressBar::new(STEPS).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 1000; NaN is 0")]
fn steps(done: f64) -> u64 {
    (done.clamp(0.0, 1.0) * STEPS as f64) as u64
}
