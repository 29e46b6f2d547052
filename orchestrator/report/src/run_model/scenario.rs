//! The scenario in a log, as far as it is drawn.

use core::str;

use geometry::map::{MapSpec, VectorMapError};
use parameters::{ParamsError, check};
use recorder::TaskInfo;
use robot::spec::RobotSpec;
use runtime::kind::TaskSketch;
use serde::Deserialize;
use sim_backend::spec::RulesSpec;

use super::task::TaskTrace;

/// The parts of the logged scenario that a picture needs. Other parts are ignored, so that a
/// picture does not depend on them.
#[derive(Debug, Clone, Deserialize)]
pub struct LoggedScenario {
    #[serde(default)]
    pub(crate) title: String,
    #[serde(default)]
    pub(crate) description: String,
    pub(crate) world: LoggedWorld,
    #[serde(default)]
    pub(crate) rules: RulesSpec,
    pub(crate) robots: Vec<RobotSpec>,
}

/// The table `[world]` of the scenario.
#[derive(Debug, Clone, Deserialize)]
pub struct LoggedWorld {
    pub(crate) map: MapSpec,
}

/// Reason why a logged scenario is not drawn.
#[derive(Debug, Clone, thiserror::Error)]
pub enum ScenarioFault {
    #[error(transparent)]
    Encoding(#[from] str::Utf8Error),
    #[error(transparent)]
    Syntax(#[from] toml::de::Error),
    #[error(transparent)]
    Map(#[from] VectorMapError),
    #[error(transparent)]
    Rules(#[from] ParamsError),
    #[error("{0}: {1}")]
    Robot(String, ParamsError),
}

impl LoggedScenario {
    /// Parses the attachment and validates the parts that are drawn.
    ///
    /// # Errors
    /// [`ScenarioFault`] of the first invalid part.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, ScenarioFault> {
        let scenario: Self = toml::from_str(str::from_utf8(bytes)?)?;
        if let MapSpec::Vector(map) = &scenario.world.map {
            map.validate()?;
        }
        check(&scenario.rules)?;
        for robot in &scenario.robots {
            check(robot).map_err(|e| ScenarioFault::Robot(robot.name.clone(), e))?;
        }
        Ok(scenario)
    }

    /// Returns the geometry of the robots' tasks.
    pub(crate) fn task(&self, tasks: &[TaskInfo]) -> TaskTrace {
        let mut task = TaskTrace::of_goals(&self.robots);
        for info in tasks {
            task.add(&info.sketch);
        }
        task
    }

    /// Returns the radius of the disc that a robot sweeps (m): that of the rules, else that of a robot with a patrol or
    /// an area to cover; `None` for others.
    pub(crate) fn sweeps(&self, robot: usize, tasks: &[TaskInfo]) -> Option<f64> {
        let spec = self.robots.get(robot)?;
        if let Some(coverage) = &self.rules.coverage {
            let counts = coverage.counts(&spec.name, &spec.team);
            return counts.then(|| coverage.radius.unwrap_or(spec.model().radius));
        }
        let has_task = tasks.iter().any(|task| {
            let TaskSketch {
                contour,
                rectangles,
                graph,
                ..
            } = &task.sketch;
            let has_ground = !(contour.is_empty() && rectangles.is_empty()) || graph.is_some();
            task.robot as usize == robot && has_ground
        });
        has_task.then(|| spec.model().radius)
    }
}
