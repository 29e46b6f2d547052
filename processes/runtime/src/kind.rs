//! Kinds of processes: what a scenario, a run and a command must know of a process.

use core::fmt;
use parameters::Parameters;

use geometry::map::{MapSpec, WorldMap};
use geometry::visibility::polygon::SightLimits;
use ipc_types::bus::Bus;
use sim_backend::spec::RobotSpec;

use crate::config::ProcessConfig;
use crate::error::ProcessError;

/// A process, wired to its topics, that takes part in the loop of a run.
pub trait Process {
    /// Connects every port, now that all processes have opened theirs.
    ///
    /// # Errors
    /// Ends the process.
    fn connect(&mut self) -> Result<(), ProcessError>;

    /// Builds what the algorithm needs of the map, which has been sent by now, so that the first
    /// tick does not have to.
    ///
    /// # Errors
    /// Ends the process.
    fn prepare(&mut self) -> Result<(), ProcessError> {
        Ok(())
    }

    /// Does one tick: takes up the inputs, computes, publishes the outputs.
    ///
    /// # Errors
    /// Ends the process.
    fn step(&mut self, tick: u64) -> Result<(), ProcessError>;

    /// Messages so far that failed the checks.
    fn rejected(&self) -> u64 {
        0
    }
}

/// A kind of process: its name, its parameters, what it needs and makes, and how it is opened.
///
/// An implementation is all that there is to a kind; the list of the kinds of a program names it in
/// one line.
pub trait ProcessKind: Process + Sized + 'static {
    /// The name that scenarios use (`kind = "…"`).
    const NAME: &'static str;

    /// What it does, in one line.
    const SUMMARY: &'static str;

    /// Whether it commands robots (and then must be given some).
    const DRIVES_ROBOTS: bool = false;

    /// What it makes for others.
    const MAKES: &'static [Product] = &[];

    /// Its parameters. All of them have defaults.
    type Params: Parameters + Default + Clone + PartialEq + fmt::Debug + Send + Sync;

    /// Sets of parameters that `params.preset` names; keys beside it change single values.
    fn presets() -> Vec<(&'static str, Self::Params)> {
        Vec::new()
    }

    /// What another part of the scenario must provide.
    fn needs(params: &Self::Params) -> Vec<Need> {
        let _ = params;
        Vec::new()
    }

    /// Particles of the largest belief that it publishes; 0 for a process without beliefs.
    fn belief_particles(params: &Self::Params) -> usize {
        let _ = params;
        0
    }

    /// Where it looks from, and how far; `None` for a process that does not look. `given` are the
    /// robots that the scenario gives to it, by their indices in `robots`.
    fn lookout(params: &Self::Params, given: &[usize], robots: &[RobotSpec]) -> Option<ViewSpec> {
        let _ = (params, given, robots);
        None
    }

    /// Checks whether it can do what it is told with one of its robots on this map.
    ///
    /// # Errors
    /// What does not fit.
    fn check_task(params: &Self::Params, task: &Task<'_>) -> Result<(), TaskFault> {
        let _ = (params, task);
        Ok(())
    }

    /// Opens the ports and sets up the algorithm.
    ///
    /// # Errors
    /// Ends the process before it is ready.
    fn open(config: &ProcessConfig, params: &Self::Params, bus: &Bus)
    -> Result<Self, ProcessError>;
}

/// Checks the parameters and opens the process.
///
/// # Errors
/// [`ProcessError::Params`] for parameters that are refused; as [`ProcessKind::open`].
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
    K::open(config, params, bus)
}

/// Something that a process needs and another part of the scenario must provide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Beliefs about the opponents: a process that makes [`Product::Beliefs`].
    Belief,
    /// A `scan` sensor on every robot that the process drives.
    Scan,
    /// Trajectories on request: a process that makes [`Product::Plans`].
    Plans,
    /// A `goal` of every robot that the process drives.
    Goal,
}

/// Something that a kind of process makes for others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Product {
    /// The beliefs that [`Need::Belief`] asks for.
    Beliefs,
    /// The plans that [`Need::Plans`] asks for.
    Plans,
    /// What becomes of waypoints (`robot/waypoint`).
    Waypoints,
}

/// Where a process looks from, and how far.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewSpec {
    /// The robots that look, by index.
    pub robots: Vec<usize>,
    /// Fixed places (m).
    pub points: Vec<[f64; 2]>,
    /// How far and how wide it sees.
    pub limits: SightLimits,
}

/// What a process is told to do with one of its robots.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// The robot.
    pub robot: &'a RobotSpec,
    /// The map as the scenario describes it.
    pub map: &'a MapSpec,
    /// The same map, built.
    pub world_map: &'a WorldMap,
    /// Seed of the run.
    pub run_seed: u64,
}

/// Why a process cannot do what it is told with a robot on a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TaskFault {
    /// A parameter does not fit.
    #[error("{message}")]
    Param {
        /// Dotted path of the parameter inside `params`.
        field: String,
        /// What is wrong with it and what to change.
        message: String,
    },
    /// An obstacle of the map does not fit.
    #[error("{message}")]
    Obstacle {
        /// Its number in the map.
        index: usize,
        /// What is wrong with it and what to change.
        message: String,
    },
}

impl TaskFault {
    /// A parameter that does not fit, by its dotted path inside `params`.
    pub fn param(field: &str, message: &dyn fmt::Display) -> Self {
        Self::Param {
            field: field.to_owned(),
            message: message.to_string(),
        }
    }
}
