//! Runs in one thread of this process.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Mutex, PoisonError, mpsc};
use std::time::Duration;

use kinds::KINDS;
use mission::MissionError;
use mission::in_process::{self, Cache, InProcessOptions};
use planner::PlannerProcess;
use pyo3::prelude::*;
use scenario::kind::ConfiguredKind;
use scenario::{Loader, Program, ResolvedScenario};
use serde_json::Value as Json;

use crate::error::{Error, InvalidInput};
use crate::planner::{Function, PythonParams, PythonPlanner};

/// Time between two looks for Ctrl-C.
const SIGNAL_INTERVAL: Duration = Duration::from_millis(50);

/// Data of maps, which all runs of the process share.
static CACHE: LazyLock<Arc<Cache>> = LazyLock::new(Arc::default);

/// A planner in the place of a process, and the command that starts it as one.
#[derive(FromPyObject)]
pub struct Planned {
    /// Name of the process.
    name: String,
    /// The planner.
    function: Py<Function>,
    /// Command of its program.
    command: Vec<String>,
    /// Working directory of its program.
    folder: String,
}

/// Runs a scenario in this thread; returns the report as JSON.
///
/// Raises
/// ------
/// InvalidInput
///     The scenario is invalid, or cannot run in one thread.
/// Error
///     A process failed.
/// KeyboardInterrupt
///     Ctrl-C ended the run in order.
#[pyfunction]
#[pyo3(signature = (scenario, *, seed, overrides, out, force, allow_outside, planners))]
#[expect(clippy::too_many_arguments, reason = "the options of the command")]
pub fn run_in_process(
    py: Python<'_>,
    scenario: String,
    seed: Option<u64>,
    overrides: Vec<String>,
    out: Option<PathBuf>,
    force: bool,
    allow_outside: bool,
    planners: Vec<Planned>,
) -> PyResult<String> {
    let loaded = py.detach(|| {
        runtime::logging::start("warn");
        let loader = Loader::new(KINDS).allow_outside(allow_outside);
        loader.load(&scenario, &overrides, seed)
    });
    let mut scenario = loaded.map_err(|problems| {
        let text = problems.to_string();
        InvalidInput::new_err(text.trim_start_matches("error: ").to_owned())
    })?;
    let mut programs = BTreeMap::new();
    let mut functions = Vec::new();
    for planned in planners {
        functions.push(planned.function.clone_ref(py));
        place(&mut scenario, planned, &mut programs)?;
    }
    let interrupted = Arc::new(AtomicBool::new(false));
    let options = InProcessOptions {
        out,
        force,
        remarks: scenario.remarks(),
        interrupted: Arc::clone(&interrupted),
        programs,
        cache: Arc::clone(&CACHE),
        ..InProcessOptions::default()
    };
    let (result, signal) = wait(py, &interrupted, || in_process::run(&scenario, &options))?;
    let text = result.map(|report| report.json(&scenario, &options.remarks).to_string());
    signal?;
    let failure = functions.iter().find_map(|f| f.get().take_failure());
    text.map_err(|error| {
        let raised = if error.is_refusal() {
            InvalidInput::new_err(error.to_string())
        } else {
            Error::new_err(error.to_string())
        };
        raised.set_cause(py, failure);
        raised
    })
}

/// Puts a planner in the place of a process of the scenario.
fn place(
    scenario: &mut ResolvedScenario,
    planned: Planned,
    programs: &mut BTreeMap<String, ConfiguredKind>,
) -> PyResult<()> {
    let names: Vec<String> = scenario.processes.iter().map(|p| p.name.clone()).collect();
    let processes = &mut scenario.processes;
    let Some(process) = processes.iter_mut().find(|p| p.name == planned.name) else {
        return Err(InvalidInput::new_err(format!(
            "planners: no process {:?}: expected one of {}",
            planned.name,
            names.join(", ")
        )));
    };
    let params = match &process.program {
        Program::Command { params, .. } => params.clone(),
        Program::Kind(kind) if kind.kind().drives_robots => {
            let params = Json::Object(serde_json::Map::new());
            process.program = Program::Command {
                words: planned.command,
                folder: planned.folder,
                params: params.clone(),
            };
            params
        }
        Program::Kind(kind) => {
            return Err(InvalidInput::new_err(format!(
                "planners: process {:?} (kind {}) steers no robot",
                planned.name,
                kind.kind().name
            )));
        }
    };
    let params = PythonParams::new(params, Arc::new(planned.function));
    let kind = ConfiguredKind::new::<PlannerProcess<PythonPlanner>>(params);
    programs.insert(planned.name, kind);
    Ok(())
}

/// Runs `work` in a thread of its own, while this one waits for it and for Ctrl-C, which sets `interrupted`. Returns the
/// result and what Ctrl-C raises.
fn wait<T: Send>(
    py: Python<'_>,
    interrupted: &AtomicBool,
    work: impl FnOnce() -> Result<T, MissionError> + Send,
) -> PyResult<(Result<T, MissionError>, PyResult<()>)> {
    std::thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        // The lock makes it usable in `detach`; no other thread uses it.
        let receiver = Mutex::new(receiver);
        scope.spawn(move || {
            let _ = sender.send(work());
        });
        let mut signal = Ok(());
        loop {
            match py.detach(|| receive(&receiver)) {
                Ok(result) => return Ok((result, signal)),
                Err(mpsc::RecvTimeoutError::Disconnected) => {
                    return Err(Error::new_err("the thread of the run ended unexpectedly"));
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
            }
            if let Err(raised) = py.check_signals() {
                interrupted.store(true, Ordering::Relaxed);
                signal = Err(raised);
            }
        }
    })
}

/// Waits for a result for a short time.
fn receive<T>(receiver: &Mutex<mpsc::Receiver<T>>) -> Result<T, mpsc::RecvTimeoutError> {
    let receiver = receiver.lock().unwrap_or_else(PoisonError::into_inner);
    receiver.recv_timeout(SIGNAL_INTERVAL)
}
