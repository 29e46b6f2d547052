//! The Python function or class of a planner, with the inputs that it names.

use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

use runtime::declaration::{WrittenDeclaration, WrittenOutput};

use python_algorithms::error::InvalidInput;

/// Argument of a planner, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Argument {
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
    /// Messages of the topics that it reads.
    Inputs,
}

impl Argument {
    fn from_name(name: &str) -> PyResult<Self> {
        Ok(match name {
            "robot" => Self::Robot,
            "world" => Self::World,
            "map" => Self::Map,
            "scan" => Self::Scan,
            "belief" => Self::Belief,
            "params" => Self::Params,
            "rng" => Self::Rng,
            "inputs" => Self::Inputs,
            _ => {
                return Err(InvalidInput::new_err(format!(
                    "argument {name:?} of a planner: expected one of robot, world, map, scan, belief, params, rng, inputs"
                )));
            }
        })
    }

    /// Returns arguments; those of a process are no robot's.
    fn all(names: &[String], is_process: bool) -> PyResult<Vec<Self>> {
        const OF_PROCESSES: [&str; 4] = ["world", "inputs", "params", "rng"];
        let mut refused = names
            .iter()
            .filter(|name| is_process && !OF_PROCESSES.contains(&name.as_str()));
        if let Some(name) = refused.next() {
            return Err(InvalidInput::new_err(format!(
                "argument {name:?} of a process: expected one of world, inputs, params, rng"
            )));
        }
        names.iter().map(|name| Self::from_name(name)).collect()
    }
}

/// Function or class that steers a robot, or that is a process with own topics.
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
    /// Names of the topics that it reads.
    pub(super) reads: Vec<String>,
    /// Topics that it writes; `None` for a planner.
    pub(super) writes: Option<Vec<WrittenOutput>>,
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
    /// reads
    ///     Names of the topics that it reads.
    /// writes
    ///     Topics that a process writes, as JSON; None for a planner.
    #[new]
    #[pyo3(signature = (callable, inputs, setup=None, reads=Vec::new(), writes=None))]
    fn new(
        callable: Py<PyAny>,
        inputs: Vec<String>,
        setup: Option<Vec<String>>,
        reads: Vec<String>,
        writes: Option<String>,
    ) -> PyResult<Self> {
        let refused = |reason: String| InvalidInput::new_err(reason);
        let writes: Option<Vec<WrittenOutput>> = writes
            .map(|json| serde_json::from_str(&json).map_err(|error| refused(error.to_string())))
            .transpose()?;
        let is_process = writes.is_some();
        let all = |names: &Vec<String>| Argument::all(names, is_process);
        let declared = WrittenDeclaration {
            reads: Vec::new(),
            writes: writes.clone().unwrap_or_default(),
        };
        declared
            .register()
            .map_err(|error| refused(error.to_string()))?;
        Ok(Self {
            callable,
            setup: setup.as_ref().map(all).transpose()?,
            inputs: all(&inputs)?,
            reads,
            writes,
            failure: Mutex::new(None),
        })
    }

    /// `True` for a process with own topics.
    #[getter(is_process)]
    fn get_is_process(&self) -> bool {
        self.is_process()
    }

    /// Declaration of a process, as JSON.
    #[getter]
    fn declaration(&self) -> PyResult<String> {
        let json = serde_json::to_string(&self.declared());
        json.map_err(|error| InvalidInput::new_err(error.to_string()))
    }
}

impl Function {
    /// Returns `true` if it is a process with own topics, not a planner.
    pub fn is_process(&self) -> bool {
        self.writes.is_some()
    }

    /// Returns the topics that it reads and writes.
    pub fn declared(&self) -> WrittenDeclaration {
        WrittenDeclaration {
            reads: self.reads.clone(),
            writes: self.writes.clone().unwrap_or_default(),
        }
    }

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
