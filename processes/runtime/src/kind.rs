//! Kinds of processes: their names, parameters, inputs, outputs and checks.

use core::fmt;
use parameters::Parameters;
use std::sync::Arc;

use geometry::map::{MapSpec, WorldMap};
use geometry::pose::Twist2;
use geometry::shape::Shape;
use geometry::visibility::polygon::SightLimits;
use ipc_types::bus::Bus;
use ipc_types::topics::{Scan, WorldShapes};
use planner_view::view::{BeliefView, View};
use robot::spec::RobotSpec;
use serde::{Deserialize, Serialize};

use crate::config::{ProcessConfig, RobotInfo};
use crate::declaration::{Declaration, Flow};
use crate::error::ProcessError;
use crate::maps::Maps;

/// Process connected to its topics, as the loop of a run drives it.
pub trait Process {
    /// Shares the data of maps with the other processes of a thread. Called before [`Self::connect`], and not in a run
    /// with processes.
    fn share_maps(&mut self, maps: &Arc<Maps>) {
        let _ = maps;
    }

    /// Connects every port. All processes have opened theirs by then.
    ///
    /// # Errors
    /// Ends the process.
    fn connect(&mut self) -> Result<(), ProcessError>;

    /// Builds the algorithm's data of the map, which has been sent by then, before the first tick.
    ///
    /// # Errors
    /// Ends the process.
    fn prepare(&mut self) -> Result<(), ProcessError> {
        Ok(())
    }

    /// Does one tick: receives the inputs, computes, publishes the outputs.
    ///
    /// # Errors
    /// Ends the process.
    fn step(&mut self, tick: u64) -> Result<(), ProcessError>;

    /// Returns `true` if it needs no messages but state, map and beliefs, so that [`Self::into_direct`] can take its place.
    fn is_direct(&self) -> bool {
        false
    }

    /// Returns the prepared process without its ports, as one that steps without messages; `None` if it cannot.
    fn into_direct(self: Box<Self>) -> Option<Box<dyn DirectProcess>> {
        None
    }

    /// Returns the number of rejected messages so far.
    fn rejected(&self) -> u64 {
        0
    }
}

/// Process that steps without messages, on the map that [`Process::prepare`] has taken.
pub trait DirectProcess {
    /// Does one tick: writes the commands of its robots on a view, whose robot is any, into `commands`, by robot.
    ///
    /// # Errors
    /// As [`Process::step`].
    fn steer(
        &mut self,
        view: &View<'_>,
        commands: &mut [Option<Twist2>],
    ) -> Result<(), ProcessError>;

    /// Adds its newest beliefs, by robot: those of this tick after [`Self::steer`].
    fn beliefs<'a>(&'a self, beliefs: &mut Vec<BeliefView<'a>>) {
        let _ = beliefs;
    }
}

/// Kind of process: its name, its parameters, its inputs and outputs, and its constructor.
///
/// A kind is complete with this implementation; a program names it in one line of its list of
/// kinds.
pub trait ProcessKind: Process + Sized + 'static {
    /// Name that scenarios use (`kind = "…"`).
    const NAME: &'static str;

    /// One-line description.
    const SUMMARY: &'static str;

    /// Names of the parameters that are the path of a file in a scenario and its contents in a process
    /// ([`files`](crate::files)).
    const FILES: &'static [&'static str] = &[];

    /// Parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + fmt::Debug + Send + Sync;

    /// Sets of parameters for `params.preset`; keys beside it change single values.
    fn presets() -> Vec<(&'static str, Self::Params)> {
        Vec::new()
    }

    /// Returns what a process with these parameters reads and writes.
    fn declare(params: &Self::Params) -> Declaration;

    /// Returns viewpoint and range; `None` for a process without a view. `given` are the robots
    /// that the scenario assigns to it, by their indices in `robots`.
    fn lookout(params: &Self::Params, given: &[usize], robots: &[RobotSpec]) -> Option<ViewSpec> {
        let _ = (params, given, robots);
        None
    }

    /// Returns the geometry of its task with one of its robots on this map.
    fn sketch(params: &Self::Params, robot: &RobotSpec, map: &MapSpec) -> TaskSketch {
        let _ = (params, robot, map);
        TaskSketch::default()
    }

    /// Checks that it can do its task with one of its robots on this map.
    ///
    /// # Errors
    /// [`TaskFault`] names the parameter or obstacle.
    fn check_task(params: &Self::Params, task: &Task<'_>) -> Result<(), TaskFault> {
        let _ = (params, task);
        Ok(())
    }

    /// Returns what a user should know about a task that [`Self::check_task`] accepts.
    fn remarks(params: &Self::Params, task: &Task<'_>) -> Vec<Remark> {
        let _ = (params, task);
        Vec::new()
    }

    /// Opens the ports and sets up the algorithm.
    ///
    /// # Errors
    /// Ends the process before it is ready.
    fn open(config: &ProcessConfig, params: &Self::Params, bus: &Bus)
    -> Result<Self, ProcessError>;
}

/// Checks the parameters and the inputs, and opens the process. A scenario with a built-in kind was checked before; the
/// parameters and inputs of an external program are known only here.
///
/// # Errors
/// [`ProcessError::Params`] for invalid parameters; [`ProcessError::Input`]; as [`ProcessKind::open`].
pub fn open<K: ProcessKind>(
    config: &ProcessConfig,
    params: &K::Params,
    bus: &Bus,
) -> Result<K, ProcessError> {
    parameters::check(params).map_err(|fault| ProcessError::Params {
        process: config.name.clone(),
        kind: config.kind.clone(),
        reason: fault.to_string(),
    })?;
    check_inputs(&K::declare(params), config)?;
    K::open(config, params, bus)
}

/// Checks that a run has the required inputs of a process.
fn check_inputs(declaration: &Declaration, config: &ProcessConfig) -> Result<(), ProcessError> {
    let lacks = |lack: String, expected: &'static str| ProcessError::Input {
        process: format!("{} (kind {})", config.name, config.kind),
        lack,
        expected,
    };
    let robot_without = |lacks: fn(&RobotInfo) -> bool| {
        let mut own = config.own_robots();
        own.find_map(|(_, robot)| lacks(robot).then(|| robot.name.clone()))
    };
    for flow in declaration.required() {
        if flow == Flow::for_topic::<Scan>() {
            if let Some(robot) = robot_without(|robot| robot.beams == 0) {
                let lack = format!("reads {flow}, but robot `{robot}` has no range scanner");
                return Err(lacks(lack, "a `scan` table on the robot"));
            }
        } else if flow == Flow::for_topic::<WorldShapes>() && config.run.capacity(flow).is_none() {
            let lack = format!("reads {flow}, but the map has too many pieces for it");
            return Err(lacks(lack, "a map with fewer pieces"));
        } else if !flow.is_of_the_run() && config.run.capacity(flow).is_none() {
            let lack = format!("reads {flow}, but no process writes it");
            return Err(lacks(
                lack,
                "a [[processes]] block with a kind that writes it",
            ));
        }
    }
    if declaration.needs_goals
        && let Some(robot) = robot_without(|robot| robot.goal.is_none())
    {
        let lack = format!("drives to goals, but robot `{robot}` has none");
        return Err(lacks(lack, "a `goal` of the robot"));
    }
    Ok(())
}

/// Viewpoint and range of a process.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewSpec {
    /// Robots that serve as viewpoints, by index.
    pub robots: Vec<usize>,
    /// Fixed places (m).
    pub points: Vec<[f64; 2]>,
    /// Range and angle of the field of view.
    pub limits: SightLimits,
}

/// Geometry of a task, for pictures.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TaskSketch {
    /// Contour of a patrol, its corners in order (m); the first again at the end if it is closed.
    pub contour: Vec<[f64; 2]>,
    /// Danger zones of the patrol.
    pub danger_zones: Vec<Shape>,
    /// Rectangles into which a workplace is divided: smallest and largest corner (m).
    pub rectangles: Vec<[[f64; 2]; 2]>,
    /// Graph of a patrol.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub graph: Option<GraphSketch>,
}

/// Graph of a patrol.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct GraphSketch {
    /// Its nodes (m).
    pub nodes: Vec<[f64; 2]>,
    /// Pairs of nodes, by their indices, that have an edge.
    pub edges: Vec<[usize; 2]>,
    /// Distance within which a robot visits a node (m), above 0.
    pub visit_m: f64,
}

/// Task of a process with one of its robots.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// The robot.
    pub robot: &'a RobotSpec,
    /// Number of robots with this task, itself included, as in [`RobotInfo::companions`](crate::config::RobotInfo); 0 while
    /// tasks are checked one by one.
    pub companions: usize,
    /// All robots of the scenario; those drawn by the seed at any place.
    pub robots: &'a [RobotSpec],
    /// Number of exits, of the map and of the rules.
    pub exits: usize,
    /// The map of the scenario.
    pub map: &'a MapSpec,
    /// The same map, built.
    pub world_map: &'a WorldMap,
    /// Seed of the run.
    pub run_seed: u64,
}

/// Remark about a task that is no fault.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remark {
    /// Choice that the scenario leaves open.
    Note(String),
    /// Probable mistake.
    Warning(String),
}

/// Faults of a task on a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TaskFault {
    /// Unsuitable parameter.
    #[error("{message}")]
    Param {
        /// Dotted path of the parameter inside `params`.
        field: String,
        /// Description of the fault and its remedy.
        message: String,
    },
    /// Unsuitable obstacle of the map.
    #[error("{message}")]
    Obstacle {
        /// Its number in the map.
        index: usize,
        /// Description of the fault and its remedy.
        message: String,
    },
}

impl TaskFault {
    /// Returns the error of a parameter, by its dotted path inside `params`.
    pub fn param(field: &str, message: &dyn fmt::Display) -> Self {
        Self::Param {
            field: field.to_owned(),
            message: message.to_string(),
        }
    }
}
