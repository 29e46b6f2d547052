//! Runs in one thread of this process.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, LazyLock};

use kinds::KINDS;
use mission::in_process::placement::{self, PlacementError};
use mission::in_process::{self, Cache, InProcessOptions};
use planner::{PlannerProcess, TopicProcess};
use pyo3::prelude::*;
use scenario::kind::ConfiguredKind;
use scenario::{Loader, Program, ProgramDeclaration, ResolvedScenario};
use serde_json::Value as Json;

use crate::planner::{Function, OwnTopics, PythonParams, PythonPlanner};
use python_algorithms::arguments::invalid;
use python_algorithms::error::{Error, InvalidInput};
use python_algorithms::interruptible::{compute, wait};

/// Data of maps, which all runs of the process share.
pub static CACHE: LazyLock<Arc<Cache>> = LazyLock::new(Arc::default);

/// A planner in the place of processes, and the command that starts it as one.
#[derive(FromPyObject)]
pub struct FunctionPlanner {
    /// Name of a robot, a team or a process.
    name: String,
    /// The planner.
    function: SharedPlanner,
    /// Command of its program.
    command: Vec<String>,
    /// Working directory of its program.
    folder: String,
}

/// Reason why planners have no place in a scenario.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// The name of a planner.
    #[error("planners: {0}")]
    Planner(#[from] PlacementError),
    /// The name of a process with own topics.
    #[error("processes: the scenario has no process {0:?} with a command")]
    NoCommand(String),
}

/// A planner that runs share.
#[derive(Clone)]
struct SharedPlanner(Arc<Py<Function>>);

impl<'py> FromPyObject<'_, 'py> for SharedPlanner {
    type Error = PyErr;

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self(Arc::new(value.extract()?)))
    }
}

impl FunctionPlanner {
    fn is_process(&self) -> bool {
        self.function.0.get().is_process()
    }

    /// Returns the processes in whose place it runs: those of a planner's robots, or the one with its name.
    fn places(&self, scenario: &ResolvedScenario) -> Result<Vec<usize>, PlaceError> {
        if !self.is_process() {
            return Ok(placement::processes_of(scenario, &self.name)?);
        }
        let mut processes = scenario.processes.iter();
        let place = processes.position(|process| {
            process.name == self.name && matches!(process.program, Program::Command { .. })
        });
        let place = place.ok_or_else(|| PlaceError::NoCommand(self.name.clone()))?;
        Ok(vec![place])
    }
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
    planners: Vec<FunctionPlanner>,
) -> PyResult<String> {
    let loaded = compute(py, move || {
        runtime::logging::start("warn");
        let loader = Loader::new(KINDS).allow_outside(allow_outside);
        loader.load(&scenario, &overrides, seed)
    })?;
    let mut scenario = loaded.map_err(|problems| {
        let text = problems.to_string();
        InvalidInput::new_err(text.trim_start_matches("error: ").to_owned())
    })?;
    place(&mut scenario, &planners).map_err(invalid)?;
    let programs = kinds_of(&scenario, &planners).map_err(invalid)?;
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
    let mut functions = planners.iter().map(|planned| planned.function.0.get());
    let failure = functions.find_map(Function::take_failure);
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

/// Puts planners in the place of the processes of the scenario that their names mean: a process, or those of a robot
/// or of a team.
///
/// # Errors
/// [`PlaceError`] names the planner that means none, or more than it says.
pub fn place(
    scenario: &mut ResolvedScenario,
    planners: &[FunctionPlanner],
) -> Result<(), PlaceError> {
    for planned in planners.iter().filter(|planned| !planned.is_process()) {
        for index in placement::processes_of(scenario, &planned.name)? {
            if let Some(process) = scenario.processes.get_mut(index)
                && let Program::Kind(_) = process.program
            {
                process.program = Program::Command {
                    words: planned.command.clone(),
                    folder: planned.folder.clone(),
                    params: Json::Object(serde_json::Map::new()),
                    declared: ProgramDeclaration::Nothing,
                };
            }
        }
    }
    Ok(())
}

/// Returns the kinds that run in the place of the commands of a scenario, by the names of the processes.
///
/// # Errors
/// As [`place`].
pub fn kinds_of(
    scenario: &ResolvedScenario,
    planners: &[FunctionPlanner],
) -> Result<BTreeMap<String, ConfiguredKind>, PlaceError> {
    let mut kinds = BTreeMap::new();
    for planned in planners {
        for index in planned.places(scenario)? {
            let Some(process) = scenario.processes.get(index) else {
                continue;
            };
            let function = Arc::clone(&planned.function.0);
            let params = PythonParams::new(process.program.params(), function);
            let kind = if planned.is_process() {
                ConfiguredKind::new::<TopicProcess<OwnTopics>>(params)
            } else {
                ConfiguredKind::new::<PlannerProcess<PythonPlanner>>(params)
            };
            kinds.insert(process.name.clone(), kind);
        }
    }
    Ok(kinds)
}
