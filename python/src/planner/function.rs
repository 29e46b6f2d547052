//! The Python function or class of a planner, with the inputs that it names.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

use crate::error::InvalidInput;

/// Argument of a planner, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Argument {
    /// Its robot.
    Robot,
    /// All robots, exits and the time.
    World,
    /// The map.
    Map,
    /// The range scan of its robot.
    Scan,
    /// Beliefs about the opponents.
    Belief,
    /// Parameters of the scenario.
    Params,
    /// Random numbers.
    Rng,
}

impl Argument {
    fn of(name: &str) -> PyResult<Self> {
        Ok(match name {
            "robot" => Self::Robot,
            "world" => Self::World,
            "map" => Self::Map,
            "scan" => Self::Scan,
            "belief" => Self::Belief,
            "params" => Self::Params,
            "rng" => Self::Rng,
            _ => {
                return Err(InvalidInput::new_err(format!(
                    "argument {name:?} of a planner: expected robot, world, map, scan, belief, params or rng"
                )));
            }
        })
    }

    fn all(names: &[String]) -> PyResult<Vec<Self>> {
        names.iter().map(|name| Self::of(name)).collect()
    }
}

/// Function or class that steers a robot.
///
/// A function is called once per tick and robot. A class is called once per robot; its object is called once per tick.
#[pyclass(frozen, module = "protean_robotics")]
#[derive(Debug)]
pub struct Function {
    pub(super) callable: Py<PyAny>,
    /// Inputs of the class; `None` for a function.
    pub(super) setup: Option<Vec<Argument>>,
    /// Inputs of a tick.
    pub(super) inputs: Vec<Argument>,
    /// Exception that ended the last run.
    failure: Mutex<Option<PyErr>>,
}

#[pymethods]
impl Function {
    /// Parameters
    /// ----------
    /// callable
    ///     The function or class.
    /// inputs
    ///     Names of the arguments of a tick.
    /// setup
    ///     Names of the arguments of the class; None for a function.
    #[new]
    #[pyo3(signature = (callable, inputs, setup=None))]
    fn new(callable: Py<PyAny>, inputs: Vec<String>, setup: Option<Vec<String>>) -> PyResult<Self> {
        Ok(Self {
            callable,
            setup: setup.as_deref().map(Argument::all).transpose()?,
            inputs: Argument::all(&inputs)?,
            failure: Mutex::new(None),
        })
    }
}

impl Function {
    /// Returns `true` if it has this input, in a tick or at its start.
    pub(super) fn uses(&self, input: Argument) -> bool {
        let setup = self.setup.iter().flatten();
        self.inputs.iter().chain(setup).any(|own| *own == input)
    }

    /// Keeps the exception that ends a run, and returns its text.
    pub(super) fn fail(&self, py: Python<'_>, error: PyErr) -> String {
        let text = traceback(py, &error);
        *self.failure.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
        text
    }

    /// Returns the exception that ended the last run.
    pub fn take_failure(&self) -> Option<PyErr> {
        self.failure
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }
}

/// Returns an exception with its traceback, as Python prints it.
fn traceback(py: Python<'_>, error: &PyErr) -> String {
    let format = || -> PyResult<String> {
        let module = py.import("traceback")?;
        let parts = (error.get_type(py), error.value(py), error.traceback(py));
        let lines = module.call_method1("format_exception", parts)?;
        let lines: Vec<String> = lines.extract()?;
        Ok(lines.concat().trim_end().to_owned())
    };
    format().unwrap_or_else(|_| error.to_string())
}
