//! The scenario in a log, as far as it is drawn.

use geometry::map::MapSpec;
use parameters::check;
use recorder::TaskInfo;
use robot::spec::RobotSpec;
use runtime::kind::TaskSketch;
use serde::Deserialize;
use sim_backend::spec::RulesSpec;

use super::task::TaskTrace;

/// The parts of the logged scenario that a picture needs. Other parts are ignored, so that a
/// picture does not depend on them.
#[derive(Debug, Deserialize)]
pub(crate) struct LoggedScenario {
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
#[derive(Debug, Deserialize)]
pub(crate) struct LoggedWorld {
    pub(crate) map: MapSpec,
}

impl LoggedScenario {
    /// Parses the attachment and validates the parts that are drawn.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, String> {
        let text = str::from_utf8(bytes).map_err(|e| e.to_string())?;
        let scenario: Self = toml::from_str(text).map_err(|e| e.to_string())?;
        if let MapSpec::Vector(map) = &scenario.world.map {
            map.validate().map_err(|e| e.to_string())?;
        }
        check(&scenario.rules).map_err(|e| e.to_string())?;
        for robot in &scenario.robots {
            check(robot).map_err(|e| format!("{}: {e}", robot.name))?;
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
                ..
            } = &task.sketch;
            task.robot as usize == robot && !(contour.is_empty() && rectangles.is_empty())
        });
        has_task.then(|| spec.model().radius)
    }
}
