//! Long work that Ctrl-C ends. All that leaves the interpreter does it in one of these ways:
//!
//! - [`wait`]: work with effects, which sees that it is interrupted and ends in order;
//! - [`compute`]: a pure computation, which Ctrl-C abandons: it goes on without an effect, as its result is dropped;
//! - [`each`]: a value for each of many items, between which Ctrl-C is seen;
//! - [`short`]: work so short that Ctrl-C can wait for it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use rustix::process::getpid;
use rustix::thread::gettid;

use crate::error::Error;
use crate::interpreter::{detach, interrupt_planners};

/// Time between two looks for Ctrl-C.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);
/// Number of items between two looks at the clock.
const BLOCK: usize = 4;

/// Runs `work` in a thread of its own, while this one waits for it and for Ctrl-C, which sets `interrupted`; the second one
/// is raised in planners that do not return. Returns the result and what Ctrl-C raises.
///
/// # Errors
/// [`Error`] if the thread panics.
pub fn wait<T: Send>(
    py: Python<'_>,
    interrupted: &AtomicBool,
    work: impl FnOnce() -> T + Send,
) -> PyResult<(T, PyResult<()>)> {
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        let thread = scope.spawn(move || {
            // It is received for as long as the thread runs.
            let _ = sender.send(work());
        });
        let mut signal = Ok(());
        let result = receive(py, receiver, |raised| {
            let again = interrupted.swap(true, Ordering::Relaxed);
            let planners = if again {
                interrupt_planners(py)
            } else {
                Ok(())
            };
            signal = planners.and(Err(raised));
            Ok(())
        });
        // Its panic, which stderr shows, must not cross.
        let _ = thread.join();
        Ok((result?, signal))
    })
}

/// Computes a value in a thread of its own, while this one waits for it and for Ctrl-C.
///
/// After Ctrl-C the thread goes on to its end. It must not hold what other calls wait for, and never enters the
/// interpreter, so that the process may end meanwhile.
///
/// # Errors
/// The exception that Ctrl-C raises; [`Error`] if the thread cannot start, or panics.
pub fn compute<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    // Python raises the exceptions of signals in its main thread alone.
    if gettid() != getpid() {
        return Ok(detach(py, work));
    }
    let (sender, receiver) = mpsc::channel();
    let thread = std::thread::Builder::new().name("compute".to_owned());
    let started = thread.spawn(move || {
        // It is abandoned otherwise.
        let _ = sender.send(work());
    });
    started.map_err(|error| Error::new_err(format!("a thread cannot start: {error}")))?;
    receive(py, receiver, Err)
}

/// Computes a value for each item.
///
/// # Errors
/// The exception that Ctrl-C raises.
pub fn each<A: Sync, T: Send>(
    py: Python<'_>,
    items: &[A],
    work: impl Fn(&A) -> T + Sync,
) -> PyResult<Vec<T>> {
    let mut values = Vec::with_capacity(items.len());
    let mut blocks = items.chunks(BLOCK);
    while values.len() < items.len() {
        detach(py, || {
            let begin = Instant::now();
            for block in blocks.by_ref() {
                values.extend(block.iter().map(&work));
                if begin.elapsed() > SIGNAL_INTERVAL {
                    break;
                }
            }
        });
        py.check_signals()?;
    }
    Ok(values)
}

/// Does work that takes far less than a second, whatever its input.
pub fn short<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    detach(py, work)
}

/// Waits for a result; `raised` decides whether an exception of a signal ends the wait.
fn receive<T: Send>(
    py: Python<'_>,
    receiver: mpsc::Receiver<T>,
    mut raised: impl FnMut(PyErr) -> PyResult<()>,
) -> PyResult<T> {
    // The lock makes it usable in `detach`; no other thread uses it.
    let receiver = Mutex::new(receiver);
    let receive = || {
        let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
        receiver.recv_timeout(SIGNAL_INTERVAL)
    };
    loop {
        match detach(py, receive) {
            Ok(result) => return Ok(result),
            Err(mpsc::RecvTimeoutError::Disconnected) => {
                return Err(Error::new_err(
                    "internal error: a thread ended unexpectedly",
                ));
            }
            Err(mpsc::RecvTimeoutError::Timeout) => {}
        }
        py.check_signals().or_else(&mut raised)?;
    }
}
