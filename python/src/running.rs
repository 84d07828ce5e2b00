//! Work that takes long. In: a job that tells how far it is. Out: what it gives; while it runs, the caller is told, and a key that
//! interrupts ends the wait at once.
//!
//! The job has a thread of its own, so that the one that Python runs in can hear signals. A job that nobody waits for any more ends the
//! next time that it tells how far it is.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use diagnosis::Progress;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often signals are looked for.
const TICK: Duration = Duration::from_millis(50);

/// The stack of the thread: that of a program's first one.
const STACK: usize = 8 << 20;

/// What the thread sends.
enum Sent<T> {
    Progress(Progress),
    Done(T),
}

/// Nobody waits any more.
struct Left;

/// Runs a job; `watch` is called with the step and the share that is done, 0 to 1.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    watch: Option<&Bound<'_, PyAny>>,
    job: impl FnOnce(&mut dyn FnMut(Progress)) -> T + Send + 'static,
) -> PyResult<T> {
    let left = Arc::new(AtomicBool::new(false));
    let (sender, receiver) = mpsc::channel();
    let gone = Arc::clone(&left);
    let work = move || {
        let tell = sender.clone();
        let mut show = |now: Progress| {
            if gone.load(Ordering::Relaxed) {
                // Not a panic: nothing is printed, and `catch_unwind` below ends the thread.
                resume_unwind(Box::new(Left));
            }
            // Whoever waits may have left meanwhile.
            let _ = tell.send(Sent::Progress(now));
        };
        if let Ok(done) = catch_unwind(AssertUnwindSafe(|| job(&mut show))) {
            let _ = sender.send(Sent::Done(done));
        }
    };
    let spawned = thread::Builder::new().stack_size(STACK).spawn(work);
    spawned.map_err(|error| PyRuntimeError::new_err(format!("no thread can be had: {error}")))?;
    // One thread waits at a time: Python lets no other into this call.
    let receiver = Mutex::new(receiver);
    let next = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK);
    let waiting = || match py.detach(next) {
        Ok(Sent::Done(done)) => Ok(Some(done)),
        Ok(Sent::Progress(now)) => {
            watch.map(|watch| watch.call1((now.step, now.done))).transpose()?;
            py.check_signals().map(|()| None)
        }
        Err(RecvTimeoutError::Timeout) => py.check_signals().map(|()| None),
        Err(RecvTimeoutError::Disconnected) => {
            Err(PyRuntimeError::new_err("the work ended without a result; this is a bug in Abbe"))
        }
    };
    loop {
        match waiting() {
            Ok(Some(done)) => return Ok(done),
            Ok(None) => {}
            Err(error) => {
                left.store(true, Ordering::Relaxed);
                return Err(error);
            }
        }
    }
}
