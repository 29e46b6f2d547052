//! Ways out of the interpreter and back, also while it ends.
//!
//! CPython before 3.14 ends a thread that comes back after the end of the interpreter, whatever frames of Rust are on its
//! stack: the process crashes. Here such a thread stops instead, and the end waits for those that are back already.

use core::cell::Cell;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

/// Time between two interruptions of planners that the end waits for.
const INTERRUPTION_INTERVAL: Duration = Duration::from_millis(100);
/// Longest time that the end waits for planners.
const MAX_WAIT: Duration = Duration::from_secs(5);

/// Threads that the end of the interpreter must wait for.
#[derive(Debug)]
struct Inside {
    /// Number of their entries.
    entries: usize,
    /// Identifiers of those that run planners, by Python's `threading.get_ident`.
    planners: Vec<u64>,
    /// Process of these threads: a forked child has not them.
    process: u32,
    /// The thread that ends the interpreter.
    ending: Option<ThreadId>,
}

static INSIDE: Mutex<Inside> = Mutex::new(Inside {
    entries: 0,
    planners: Vec::new(),
    process: 0,
    ending: None,
});
static CHANGED: Condvar = Condvar::new();

thread_local! {
    /// Entries of this thread.
    static ENTRIES: Cell<usize> = const { Cell::new(0) };
}

fn inside() -> MutexGuard<'static, Inside> {
    INSIDE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A thread in the interpreter, or on its way.
struct Entry;

impl Entry {
    /// Enters; stops the thread for ever if the interpreter ends.
    fn new() -> Self {
        let mut inside = inside();
        if inside
            .ending
            .is_some_and(|ending| ending != thread::current().id())
        {
            inside.entries -= ENTRIES.replace(0);
            drop(inside);
            CHANGED.notify_all();
            loop {
                thread::park();
            }
        }
        inside.entries += 1;
        ENTRIES.set(ENTRIES.get() + 1);
        Self
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        inside().entries -= 1;
        ENTRIES.set(ENTRIES.get() - 1);
        CHANGED.notify_all();
    }
}

/// Does work while other threads use the interpreter.
pub fn detach<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    let (result, entry) = py.detach(|| {
        let result = work();
        (result, Entry::new())
    });
    drop(entry);
    result
}

/// Does work in the interpreter, from a thread outside.
pub fn attach<T>(work: impl FnOnce(Python<'_>) -> T) -> T {
    let _entry = Entry::new();
    Python::attach(work)
}

/// Calls a planner, from a thread outside.
pub fn call_planner<T>(work: impl FnOnce(Python<'_>) -> T) -> T {
    attach(|py| {
        let ident = py.import("threading").and_then(|module| {
            let ident = module.call_method0("get_ident")?;
            ident.extract::<u64>()
        });
        let ident = ident.unwrap_or_default();
        inside().planners.push(ident);
        let result = work(py);
        let mut inside = inside();
        if let Some(at) = inside.planners.iter().position(|&own| own == ident) {
            inside.planners.swap_remove(at);
        }
        drop(inside);
        result
    })
}

/// Raises KeyboardInterrupt in all planners.
pub fn interrupt_planners(py: Python<'_>) -> PyResult<()> {
    let planners = inside().planners.clone();
    let ctypes = py.import("ctypes")?;
    let exception = ctypes.call_method1("py_object", (py.get_type::<PyKeyboardInterrupt>(),))?;
    for ident in planners {
        let thread = ctypes.call_method1("c_ulong", (ident,))?;
        let api = ctypes.getattr("pythonapi")?;
        api.call_method1("PyThreadState_SetAsyncExc", (thread, &exception))?;
    }
    Ok(())
}

/// Makes `end` a part of the end of the interpreter.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    inside().process = std::process::id();
    let end = wrap_pyfunction!(end, module)?;
    module
        .py()
        .import("atexit")?
        .call_method1("register", (end,))?;
    Ok(())
}

/// Waits for the threads in the interpreter, and stops the others.
#[pyfunction]
fn end(py: Python<'_>) -> PyResult<()> {
    let mut own = inside();
    if own.process != std::process::id() {
        return Ok(());
    }
    own.ending = Some(thread::current().id());
    drop(own);
    let begin = Instant::now();
    while py.detach(wait_for_none) > 0 && begin.elapsed() < MAX_WAIT {
        interrupt_planners(py)?;
    }
    Ok(())
}

/// Waits a short time until no thread is inside; returns the number of entries.
fn wait_for_none() -> usize {
    let waited =
        CHANGED.wait_timeout_while(inside(), INTERRUPTION_INTERVAL, |inside| inside.entries > 0);
    let (inside, _) = waited.unwrap_or_else(PoisonError::into_inner);
    inside.entries
}
