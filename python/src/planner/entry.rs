//! A function or class in Python as a process of a run.

use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;

use planner::{PlannerProcess, TopicProcess};
use pyo3::prelude::*;
use serde_json::Value as Json;

use super::function::Function;
use super::own_topics::OwnTopics;
use super::params::PythonParams;
use super::process::PythonPlanner;
use python_algorithms::interpreter::detach;

/// Runs a function or class as the process of a run with the configuration in a file; returns `true` if the run ended in order.
#[pyfunction]
pub fn serve(py: Python<'_>, function: Py<Function>, config: PathBuf) -> bool {
    let function = Arc::new(function);
    let code = detach(py, || {
        runtime::run_with(&config, Vec::new(), |config, values: &Json| {
            let params = PythonParams::new(values.clone(), Arc::clone(&function));
            if function.get().is_process() {
                return runtime::follow::<TopicProcess<OwnTopics>>(config, &params);
            }
            runtime::follow::<PlannerProcess<PythonPlanner>>(config, &params)
        })
    });
    code == ExitCode::SUCCESS
}
