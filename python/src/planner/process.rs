//! A function or class in Python as a planner.

use std::sync::Arc;

use geometry::pose::Twist2;
use geometry::region::Region;
use ipc_types::bus::Bus;
use nalgebra::Point2;
use planner::{
    Declaration, Input, Limits, Planner, PlannerError, PlannerMap, RobotInfo, Steering, View,
    limits, planner_reads,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use runtime::config::ProcessConfig;
use runtime::error::ProcessError;
use runtime::raw_inputs::RawInputs;
use serde_json::Value as Json;

use super::function::{Argument, Function};
use super::messages::messages;
use super::params::PythonParams;
use super::robot::Robot;
use super::sensors::{Belief, Scan};
use super::steering::Command;
use super::world::World;
use python_algorithms::interpreter::call_planner;
use python_algorithms::map::Map;

/// The planner of one robot.
#[derive(Debug)]
pub struct PythonPlanner {
    function: Arc<Py<Function>>,
    values: Json,
    seed: u64,
    limits: Limits,
    exits: Vec<Point2<f64>>,
    objects: Option<Objects>,
    failure: Option<String>,
    messages: RawInputs,
}

/// Function of a tick and its inputs.
#[derive(Debug)]
struct Objects {
    callable: Py<PyAny>,
    inputs: Vec<Argument>,
    robot: Py<Robot>,
    world: Py<World>,
    params: Py<PyAny>,
    rng: Py<PyAny>,
    map: Option<Py<Map>>,
}

impl Planner for PythonPlanner {
    const NAME: &'static str = "python";
    const SUMMARY: &'static str = "steers by a function in Python";

    type Params = PythonParams;

    fn declare(params: &PythonParams) -> Declaration {
        let uses = |input| {
            let function = params.function();
            function.is_some_and(|function| function.get().uses(input))
        };
        let function = params.function().map(|function| function.get());
        planner_reads(function.map_or(&[], |function| &function.reads))
            .reads_if(uses(Argument::Belief), Input::BELIEFS)
            .reads_if(uses(Argument::Scan), Input::SCANS)
            .reads_if(uses(Argument::Map), Input::SHAPES.optional())
    }

    fn new(params: &PythonParams, robot: &RobotInfo, seed: u64) -> Result<Self, PlannerError> {
        let function = params
            .function()
            .ok_or_else(|| PlannerError::algorithm("it has no function"))?;
        Ok(Self {
            function: Arc::clone(function),
            values: params.values().clone(),
            seed,
            limits: limits(robot)?,
            exits: Vec::new(),
            objects: None,
            failure: None,
            messages: RawInputs::default(),
        })
    }

    fn rules(&mut self, exits: &[Region], _: f64) {
        self.exits = exits.iter().map(Region::center).collect();
    }

    fn open(&mut self, config: &ProcessConfig, bus: &Bus, robot: u32) -> Result<(), ProcessError> {
        self.messages = RawInputs::open(&self.function.get().reads, config, bus)?;
        call_planner(|py| {
            let opened = self.set_up(py, config, robot as usize);
            self.objects =
                Some(opened.map_err(|error| {
                    ProcessError::Algorithm(self.function.get().fail(py, error))
                })?);
            Ok(())
        })
    }

    fn failure(&mut self) -> Option<ProcessError> {
        self.failure.take().map(ProcessError::Algorithm)
    }

    fn steer(&mut self, map: &PlannerMap, view: &View<'_>) -> Steering {
        let tick = (view.time_s / view.dt).round() as u64;
        if let Err(error) = self.messages.receive(tick) {
            self.failure = Some(error.to_string());
            return Steering::stop();
        }
        call_planner(|py| match self.call(py, map, view) {
            Ok(steering) => steering,
            Err(error) => {
                self.failure = Some(self.function.get().fail(py, error));
                Steering::stop()
            }
        })
    }
}

impl PythonPlanner {
    /// Creates the objects of a run, and the object of a class.
    fn set_up(&self, py: Python<'_>, config: &ProcessConfig, own: usize) -> PyResult<Objects> {
        let function = self.function.get();
        let world = World::new(py, config, own, &self.exits)?;
        let robot = world.robot(own).map(|robot| robot.clone_ref(py));
        let robot = robot.ok_or_else(|| PyValueError::new_err("the run has no such robot"))?;
        let mut objects = Objects {
            callable: function.callable.clone_ref(py),
            inputs: function.inputs.clone(),
            robot,
            world: Py::new(py, world)?,
            params: params(py, &self.values)?,
            rng: generator(py, self.seed)?,
            map: None,
        };
        if let Some(setup) = &function.setup {
            let arguments = setup.iter().map(|input| objects.constant(py, *input));
            let arguments = PyTuple::new(py, arguments.collect::<PyResult<Vec<_>>>()?)?;
            objects.callable = function.callable.call1(py, arguments)?;
        }
        Ok(objects)
    }

    /// Calls the function in a tick.
    fn call(&mut self, py: Python<'_>, map: &PlannerMap, view: &View<'_>) -> PyResult<Steering> {
        let Some(objects) = &mut self.objects else {
            return Ok(Steering::stop());
        };
        objects.world.borrow_mut(py).update(py, view);
        let known = objects.map.as_ref().map(|known| known.get().map.revision());
        if objects.inputs.contains(&Argument::Map) && known != Some(map.revision()) {
            let map = Arc::new(map.clone());
            objects.map = Some(Py::new(py, Map { map, recipe: None })?);
        }
        let messages = objects
            .inputs
            .contains(&Argument::Inputs)
            .then(|| messages(py, &self.messages))
            .transpose()?;
        let inputs = objects.inputs.iter();
        let arguments = inputs.map(|input| match input {
            Argument::Map => Ok(match &objects.map {
                Some(map) => map.clone_ref(py).into_any(),
                None => py.None(),
            }),
            Argument::Scan => match &view.scan {
                Some(scan) => Ok(Py::new(py, Scan::new(py, scan))?.into_any()),
                None => Ok(py.None()),
            },
            Argument::Belief => objects.beliefs(py, view),
            Argument::Inputs => Ok(messages
                .as_ref()
                .map_or_else(|| py.None(), |messages| messages.clone_ref(py).into_any())),
            input => objects.constant(py, *input),
        });
        let arguments = PyTuple::new(py, arguments.collect::<PyResult<Vec<_>>>()?)?;
        let result = objects.callable.bind(py).call1(arguments)?;
        let command: Command = result.extract()?;
        let twist = Twist2::new(command.v, command.omega);
        if !twist.is_finite() {
            let (v, omega) = (command.v, command.omega);
            return Err(PyValueError::new_err(format!(
                "the planner returned v = {v}, omega = {omega}: expected finite numbers (m/s, rad/s)"
            )));
        }
        Ok(Steering {
            command: self.limits.clip(twist),
            target: command.target,
            aim: command.aim,
            waypoint: command.waypoint,
            ..Steering::stop()
        })
    }
}

/// Returns the parameters of the scenario as a dict.
pub fn params(py: Python<'_>, values: &Json) -> PyResult<Py<PyAny>> {
    let values = match values {
        Json::Null => "{}".to_owned(),
        values => values.to_string(),
    };
    Ok(py
        .import("json")?
        .call_method1("loads", (values,))?
        .unbind())
}

/// Returns a generator of random numbers.
pub fn generator(py: Python<'_>, seed: u64) -> PyResult<Py<PyAny>> {
    let random = py.import("numpy.random")?;
    let bits = random.call_method1("PCG64", (seed,))?;
    Ok(random.call_method1("Generator", (bits,))?.unbind())
}

impl Objects {
    /// Returns an input that is the same object in all ticks.
    fn constant(&self, py: Python<'_>, input: Argument) -> PyResult<Py<PyAny>> {
        Ok(match input {
            Argument::Robot => self.robot.clone_ref(py).into_any(),
            Argument::World => self.world.clone_ref(py).into_any(),
            Argument::Params => self.params.clone_ref(py),
            Argument::Rng => self.rng.clone_ref(py),
            Argument::Map | Argument::Scan | Argument::Belief | Argument::Inputs => {
                return Err(PyTypeError::new_err(
                    "__init__ of a planner: expected robot, world, params or rng as arguments",
                ));
            }
        })
    }

    /// Returns the beliefs of a tick, by the name of the opponent.
    fn beliefs(&self, py: Python<'_>, view: &View<'_>) -> PyResult<Py<PyAny>> {
        let beliefs = PyDict::new(py);
        let world = self.world.borrow(py);
        for belief in view.beliefs {
            if let Some(robot) = world.robot(belief.robot) {
                let object = Belief::new(py, robot, belief)?;
                beliefs.set_item(robot.borrow(py).name(), Py::new(py, object)?)?;
            }
        }
        Ok(beliefs.into_any().unbind())
    }
}
