//! A function or class in Python as a process with topics of its own.

use std::sync::Arc;

use geometry::region::Region;
use ipc_types::bus::{Bus, PublisherOptions, RawPublisher};
use ipc_types::topics::TopicId;
use planner::{Declaration, View, planner_seed, robot_views, teams};
use planner_view::view::RobotView;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use robot::team::Team;
use runtime::config::ProcessConfig;
use runtime::error::ProcessError;
use runtime::inputs::{StateInput, reply_stamp};
use runtime::{Process, ProcessKind};

use super::function::{Argument, Function};
use super::messages::{Messages, dtype};
use super::params::PythonParams;
use super::process::{generator, params};
use super::world::World;
use python_algorithms::interpreter::call_planner;

/// The process.
pub struct OwnTopics {
    config: ProcessConfig,
    function: Arc<Py<Function>>,
    state: StateInput,
    messages: Messages,
    outputs: Vec<OwnOutput>,
    teams: Vec<Team>,
    views: Vec<RobotView>,
    objects: Objects,
}

/// A topic that it writes.
struct OwnOutput {
    topic: TopicId,
    port: RawPublisher,
    /// Bytes of the elements of the tick.
    elements: Option<Vec<u8>>,
}

/// Function of a tick and its inputs.
struct Objects {
    callable: Py<PyAny>,
    world: Py<World>,
    params: Py<PyAny>,
    rng: Py<PyAny>,
}

impl ProcessKind for OwnTopics {
    const NAME: &'static str = "python";
    const SUMMARY: &'static str = "reads and writes topics by a function in Python";

    type Params = PythonParams;

    fn declare(params: &PythonParams) -> Declaration {
        let declared = params.function().map(|function| function.get().declared());
        // Unknown topics are refused when they are opened.
        let declared = declared.and_then(|declared| declared.declaration().ok());
        declared.unwrap_or_default()
    }

    fn open(
        config: &ProcessConfig,
        params: &PythonParams,
        bus: &Bus,
    ) -> Result<Self, ProcessError> {
        let missing = || ProcessError::Algorithm("it has no function".to_owned());
        let function = params.function().ok_or_else(missing)?;
        let declared = function.get().declared();
        let outputs = declared.writes.iter().map(|output| {
            let topic = output.topic.register().map_err(ProcessError::Algorithm)?;
            let options = PublisherOptions::new(config.index, output.elements);
            Ok(OwnOutput {
                topic,
                port: RawPublisher::open(bus, topic, options)?,
                elements: None,
            })
        });
        let objects = call_planner(|py| {
            let opened = Objects::new(py, config, params);
            opened.map_err(|error| ProcessError::Algorithm(function.get().fail(py, error)))
        })?;
        Ok(Self {
            function: Arc::clone(function),
            state: StateInput::open(bus, config.run.robots.len())?,
            messages: Messages::open(&declared.reads, config, bus)?,
            outputs: outputs.collect::<Result<_, ProcessError>>()?,
            teams: teams(&config.run.robots),
            views: Vec::new(),
            objects,
            config: config.clone(),
        })
    }
}

impl Process for OwnTopics {
    fn connect(&mut self) -> Result<(), ProcessError> {
        self.state.connect()?;
        self.messages.connect()?;
        for output in &self.outputs {
            output.port.update_connections()?;
        }
        Ok(())
    }

    fn step(&mut self, tick: u64) -> Result<(), ProcessError> {
        let run = &self.config.run;
        self.state.take_turn(tick, run.clock)?;
        self.messages.receive(tick)?;
        let received_ns = self.state.received_ns;
        robot_views(&self.state, &run.robots, &self.teams, &mut self.views);
        call_planner(|py| {
            let called = self.call(py);
            called.map_err(|error| ProcessError::Algorithm(self.function.get().fail(py, error)))
        })?;
        let stamp = reply_stamp(&self.state.header, received_ns);
        for output in &mut self.outputs {
            if let Some(elements) = output.elements.take() {
                output.port.send(stamp, &elements)?;
            }
        }
        Ok(())
    }

    fn rejected(&self) -> u64 {
        self.state.rejected
    }
}

impl OwnTopics {
    /// Calls the function in a tick, and takes the elements that it returns.
    fn call(&mut self, py: Python<'_>) -> PyResult<()> {
        let view = View {
            time_s: self.state.header.stamp.time_ns as f64 * 1e-9,
            dt: self.config.run.tick_period(),
            me: 0,
            robots: &self.views,
            beliefs: &[],
            exits: &[],
            scan: None,
        };
        self.objects.world.borrow_mut(py).update(py, &view);
        let function = self.function.get();
        let arguments = function.inputs.iter().map(|input| match input {
            Argument::Inputs => Ok(self.messages.take(py)?.into_any()),
            input => Ok(self.objects.constant(py, *input)),
        });
        let arguments = PyTuple::new(py, arguments.collect::<PyResult<Vec<_>>>()?)?;
        let result = self.objects.callable.bind(py).call1(arguments)?;
        if result.is_none() {
            return Ok(());
        }
        let names: Vec<&str> = self
            .outputs
            .iter()
            .map(|output| output.topic.name())
            .collect();
        if let Ok(result) = result.cast::<PyDict>() {
            for (name, elements) in result {
                let name: String = name.extract()?;
                let output = self
                    .outputs
                    .iter_mut()
                    .find(|output| output.topic.name() == name);
                let Some(output) = output else {
                    let expected = names.join(", ");
                    return Err(PyValueError::new_err(format!(
                        "it returned elements of topic {name:?}: expected {expected}"
                    )));
                };
                output.take(&elements)?;
            }
            return Ok(());
        }
        match self.outputs.as_mut_slice() {
            [output] => output.take(&result),
            _ => Err(PyValueError::new_err(format!(
                "it returned {result}: expected a dict of elements by topic ({})",
                names.join(", ")
            ))),
        }
    }
}

impl OwnOutput {
    /// Takes elements: a structured array, or a list of tuples.
    fn take(&mut self, elements: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = elements.py();
        let facts = self.topic.facts();
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
        self.elements = Some(array.call_method0("tobytes")?.extract()?);
        Ok(())
    }
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
