//! Planners that send commands from elsewhere.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

use geometry::pose::Twist2;
use parameters::Parameters;
use planner::{Planner, PlannerError, PlannerMap, RobotInfo, Steering, View};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Source of the commands of robots.
pub trait Source: fmt::Debug + Send + Sync {
    /// Returns the command of a robot in the tick with this number.
    fn command(&self, robot: &str, tick: u64) -> Twist2;
}

/// Commands of the current tick.
#[derive(Debug, Default)]
pub struct Current(Mutex<BTreeMap<String, Twist2>>);

impl Current {
    /// Replaces the command of a robot.
    pub fn set(&self, robot: &str, command: Twist2) {
        let mut commands = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match commands.get_mut(robot) {
            Some(known) => *known = command,
            None => {
                commands.insert(robot.to_owned(), command);
            }
        }
    }
}

impl Source for Current {
    fn command(&self, robot: &str, _: u64) -> Twist2 {
        let commands = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        commands.get(robot).copied().unwrap_or(Twist2::STOP)
    }
}

/// Commands of all ticks, by the names of the robots; a stop after the last one.
#[derive(Debug, Default)]
pub struct CommandHistory(pub BTreeMap<String, Vec<Twist2>>);

impl Source for CommandHistory {
    fn command(&self, robot: &str, tick: u64) -> Twist2 {
        let commands = self.0.get(robot);
        let command = commands.and_then(|commands| commands.get(tick as usize));
        command.copied().unwrap_or(Twist2::STOP)
    }
}

/// Parameters of [`CommandedPlanner`]: the source, which has no text.
#[derive(Debug, Clone, Default, Serialize, Deserialize, JsonSchema)]
pub struct CommandedParams {
    #[serde(skip)]
    source: Option<Arc<dyn Source>>,
}

impl CommandedParams {
    pub fn new(source: Arc<dyn Source>) -> Self {
        let source = Some(source);
        Self { source }
    }
}

impl PartialEq for CommandedParams {
    fn eq(&self, other: &Self) -> bool {
        match (&self.source, &other.source) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (None, None) => true,
            _ => false,
        }
    }
}

impl Parameters for CommandedParams {}

/// Planner of one robot that sends the commands of a source.
#[derive(Debug)]
pub struct CommandedPlanner {
    source: Arc<dyn Source>,
    robot: String,
    tick: u64,
}

impl Planner for CommandedPlanner {
    const NAME: &'static str = "commanded";
    const SUMMARY: &'static str = "sends the commands of a learner";

    type Params = CommandedParams;

    fn new(params: &CommandedParams, robot: &RobotInfo, _: u64) -> Result<Self, PlannerError> {
        Ok(Self {
            source: params
                .source
                .clone()
                .ok_or_else(|| PlannerError::algorithm("it has no commands"))?,
            robot: robot.name.clone(),
            tick: 0,
        })
    }

    fn steer(&mut self, _: &PlannerMap, _: &View<'_>) -> Steering {
        let command = self.source.command(&self.robot, self.tick);
        self.tick += 1;
        Steering {
            command,
            ..Steering::stop()
        }
    }
}
