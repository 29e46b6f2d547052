//! A function or class in Python as a process with topics of its own.

use std::sync::Arc;

use geometry::region::Region;
use planner::{RawOutput, TopicProgram, View, planner_seed};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use runtime::config::ProcessConfig;
use runtime::declaration::WrittenDeclaration;
use runtime::error::ProcessError;
use runtime::raw_inputs::RawInputs;

use super::function::{Argument, Function};
use super::messages::{dtype, messages};
use super::params::PythonParams;
use super::process::{generator, params};
use super::world::World;
use python_algorithms::interpreter::call_planner;

/// The function, or the object of the class.
pub struct OwnTopics {
    function: Arc<Py<Function>>,
    objects: Objects,
}

/// Function of a tick and its inputs.
struct Objects {
    callable: Py<PyAny>,
    world: Py<World>,
    params: Py<PyAny>,
    rng: Py<PyAny>,
}

impl TopicProgram for OwnTopics {
    const NAME: &'static str = "python";
    const SUMMARY: &'static str = "reads and writes topics by a function in Python";

    type Params = PythonParams;

    fn declared(params: &PythonParams) -> WrittenDeclaration {
        let function = params.function();
        function.map_or_else(WrittenDeclaration::default, |function| {
            function.get().declared()
        })
    }

    fn open(config: &ProcessConfig, params: &PythonParams) -> Result<Self, ProcessError> {
        let missing = || ProcessError::Algorithm("it has no function".to_owned());
        let function = params.function().ok_or_else(missing)?;
        let objects = call_planner(|py| {
            let opened = Objects::new(py, config, params);
            opened.map_err(|error| ProcessError::Algorithm(function.get().fail(py, error)))
        })?;
        Ok(Self {
            function: Arc::clone(function),
            objects,
        })
    }

    fn step(
        &mut self,
        view: &View<'_>,
        inputs: &RawInputs,
        outputs: &mut [RawOutput],
    ) -> Result<(), ProcessError> {
        call_planner(|py| {
            let called = self.call(py, view, inputs, outputs);
            called.map_err(|error| ProcessError::Algorithm(self.function.get().fail(py, error)))
        })
    }
}

impl OwnTopics {
    /// Calls the function in a tick, and takes the elements that it returns.
    fn call(
        &self,
        py: Python<'_>,
        view: &View<'_>,
        inputs: &RawInputs,
        outputs: &mut [RawOutput],
    ) -> PyResult<()> {
        self.objects.world.borrow_mut(py).update(py, view);
        let function = self.function.get();
        let arguments = function.inputs.iter().map(|input| match input {
            Argument::Inputs => Ok(messages(py, inputs)?.into_any()),
            input => Ok(self.objects.constant(py, *input)),
        });
        let arguments = PyTuple::new(py, arguments.collect::<PyResult<Vec<_>>>()?)?;
        let result = self.objects.callable.bind(py).call1(arguments)?;
        if result.is_none() {
            return Ok(());
        }
        let names: Vec<&str> = outputs.iter().map(|output| output.topic().name()).collect();
        if let Ok(result) = result.cast::<PyDict>() {
            for (name, elements) in result {
                let name: String = name.extract()?;
                let Some(at) = names.iter().position(|known| *known == name) else {
                    let expected = names.join(", ");
                    return Err(PyValueError::new_err(format!(
                        "it returned elements of topic {name:?}: expected one of {expected}"
                    )));
                };
                take(&mut outputs[at], &elements)?;
            }
            return Ok(());
        }
        match outputs {
            [output] => take(output, &result),
            _ => Err(PyValueError::new_err(format!(
                "it returned {result}: expected a dict of elements by topic ({})",
                names.join(", ")
            ))),
        }
    }
}

/// Takes elements: a structured array, or a list of tuples.
fn take(output: &mut RawOutput, elements: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = elements.py();
    let facts = output.topic().facts();
    let refused = |found: String| {
        PyValueError::new_err(format!(
            "elements of {}: {found}: expected one row of its message",
            facts.name
        ))
    };
    let dtype = dtype(py, &facts.element)?;
    let array = py
        .import("numpy")?
        .call_method1("asarray", (elements, dtype));
    let array = array.map_err(|error| refused(error.to_string()))?;
    let dimensions: usize = array.getattr("ndim")?.extract()?;
    if dimensions != 1 {
        return Err(refused(format!("an array of {dimensions} dimensions")));
    }
    output.fill(array.call_method0("tobytes")?.extract()?);
    Ok(())
}

impl Objects {
    fn new(py: Python<'_>, config: &ProcessConfig, given: &PythonParams) -> PyResult<Self> {
        let exits: Vec<_> = config.run.exits.iter().map(Region::center).collect();
        let seed = planner_seed(config.run.seed, OwnTopics::NAME, &config.name);
        let function = given
            .function()
            .ok_or_else(|| PyValueError::new_err("no function"))?;
        let function = function.get();
        let mut objects = Self {
            callable: function.callable.clone_ref(py),
            // It drives no robot.
            world: Py::new(py, World::new(py, config, usize::MAX, &exits)?)?,
            params: params(py, given.values())?,
            rng: generator(py, seed)?,
        };
        if let Some(setup) = &function.setup {
            let arguments = setup.iter().map(|input| objects.constant(py, *input));
            let arguments = PyTuple::new(py, arguments.collect::<Vec<_>>())?;
            objects.callable = function.callable.call1(py, arguments)?;
        }
        Ok(objects)
    }

    /// Returns an input that is the same object in all ticks.
    fn constant(&self, py: Python<'_>, input: Argument) -> Py<PyAny> {
        match input {
            Argument::World => self.world.clone_ref(py).into_any(),
            Argument::Params => self.params.clone_ref(py),
            Argument::Rng => self.rng.clone_ref(py),
            // The messages are those of a tick: none before the first.
            _ => py.None(),
        }
    }
}
