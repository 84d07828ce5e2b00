//! Progress on a terminal. In: what is being done, and how far it is. Out: one line on standard error, after the first second,
//! which is gone when the work is done; nothing where nobody watches.

use std::io::{self, IsTerminal};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// Shorter work needs no line.
const PATIENCE: Duration = Duration::from_secs(1);

/// How often the line is drawn anew.
const TICK: Duration = Duration::from_millis(100);

/// The steps of a full bar.
const STEPS: u64 = 1000;

/// Work that a person may watch. The line is drawn by a thread of its own, so that the work need not report often, or at all.
pub(crate) struct Progress {
    state: Arc<Mutex<State>>,
    line: Option<Line>,
}

/// What is shown.
#[derive(Clone, Default)]
struct State {
    /// What is being done.
    step: String,
    /// The part that is done, from 0 to 1, where it is known.
    done: Option<f64>,
}

/// The thread that draws.
struct Line {
    /// It stops when this end is gone.
    stop: Sender<()>,
    thread: JoinHandle<()>,
}

impl Progress {
    /// Begins to watch over some work; `quiet` shows nothing, and neither does a standard error that is no terminal.
    pub(crate) fn new(quiet: bool, step: &str) -> Self {
        let state = Arc::new(Mutex::new(State { step: step.to_owned(), done: None }));
        let watched = !quiet && io::stderr().is_terminal();
        let line = watched.then(|| Line::draw(Arc::clone(&state)));
        Self { state, line }
    }

    /// What is being done now, its extent not known.
    pub(crate) fn step(&self, step: &str) {
        self.set(step, None);
    }

    /// What is being done now, and the part of all work that is done, from 0 to 1.
    pub(crate) fn part(&self, step: &str, done: f64) {
        self.set(step, Some(done));
    }

    /// Whether anybody watches: else nothing need be put into words.
    pub(crate) fn is_watched(&self) -> bool {
        self.line.is_some()
    }

    fn set(&self, step: &str, done: Option<f64>) {
        if self.is_watched() {
            // What a thread left that panicked is as good as any other state.
            let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            *state = State { step: step.to_owned(), done };
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(Line { stop, thread }) = self.line.take() {
            drop(stop);
            // The line is gone before anything else is written.
            let _ = thread.join();
        }
    }
}

impl Line {
    fn draw(state: Arc<Mutex<State>>) -> Self {
        let (stop, stopped) = mpsc::channel();
        let thread = thread::spawn(move || {
            let waits = |time| stopped.recv_timeout(time) == Err(RecvTimeoutError::Timeout);
            if !waits(PATIENCE) {
                return;
            }
            let bar = ProgressBar::new(STEPS).with_elapsed(PATIENCE);
            loop {
                let state = state.lock().unwrap_or_else(PoisonError::into_inner).clone();
                show(&bar, state);
                if !waits(TICK) {
                    break;
                }
            }
            bar.finish_and_clear();
        });
        Self { stop, thread }
    }
}

fn show(bar: &ProgressBar, state: State) {
    let template = match state.done {
        Some(_) => "{bar:30} {percent:>3} %  {msg}",
        None => "{spinner} {msg}, {elapsed}",
    };
    // A template that did not fit would leave the usual bar.
    bar.set_style(ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_message(state.step);
    bar.set_position(steps(state.done.unwrap_or_default()));
    bar.tick();
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and 1000; NaN is 0")]
fn steps(done: f64) -> u64 {
    (done.clamp(0.0, 1.0) * STEPS as f64) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_between_nothing_and_all() {
        assert_eq!([-1.0, 0.0, 0.25, 2.0, f64::NAN].map(steps), [0, 0, 250, 1000, 0]);
    }

    #[test]
    fn quiet_work_is_not_watched() {
        let progress = Progress::new(true, "reading");
        progress.part("reading", 0.5);
        assert!(!progress.is_watched());
    }
}
