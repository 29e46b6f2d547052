//! Long work that Ctrl-C ends in order.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::time::Duration;

use pyo3::prelude::*;

use crate::error::Error;
use crate::interpreter::{detach, interrupt_planners};

/// Time between two looks for Ctrl-C.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

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
        // The lock makes it usable in `detach`; no other thread uses it.
        let receiver = Mutex::new(receiver);
        let thread = scope.spawn(move || {
            // It is received for as long as the thread runs.
            let _ = sender.send(work());
        });
        let mut signal = Ok(());
        loop {
            match detach(py, || receive(&receiver)) {
                Ok(result) => return Ok((result, signal)),
                Err(mpsc::RecvTimeoutError::Disconnected) => {
                    // Its panic, which stderr shows, must not cross.
                    let _ = thread.join();
                    return Err(Error::new_err(
                        "internal error: a thread ended unexpectedly",
                    ));
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
            }
            if let Err(raised) = py.check_signals() {
                let again = interrupted.swap(true, Ordering::Relaxed);
                let planners = if again {
                    interrupt_planners(py)
                } else {
                    Ok(())
                };
                signal = planners.and(Err(raised));
            }
        }
    })
}

/// Waits for a result for a short time.
fn receive<T>(receiver: &Mutex<mpsc::Receiver<T>>) -> Result<T, mpsc::RecvTimeoutError> {
    let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
    receiver.recv_timeout(SIGNAL_INTERVAL)
}
