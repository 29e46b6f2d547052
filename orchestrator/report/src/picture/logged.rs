//! Facts about a run from the metadata and attachments of its log.

use config::{Node, Origin};
use geometry::map::MapSpec;
use parameters::check;
use robot::spec::RobotSpec;
use serde::Deserialize;
use serde_json::Value as Json;
use sim_backend::spec::RulesSpec;

use mission::fields_of_view::fields_of_view;
use scenario::kind::{ConfiguredKind, Kind, find};
use viewer::FieldOfView;

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
    /// Unparsed processes: those that cannot be parsed are not drawn.
    #[serde(default)]
    processes: Vec<Json>,
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

    /// Returns the fields of view whose parameters can be read.
    pub(crate) fn fields_of_view(&self, kinds: &[Kind]) -> Vec<FieldOfView> {
        let lookouts = self.processes.iter().filter_map(|process| {
            let configured = self.configured(process, kinds)?;
            let lookout = configured.kind.lookout(&configured.robots, &self.robots)?;
            Some((configured.name, lookout))
        });
        fields_of_view(&self.robots, lookouts)
    }

    /// Returns the geometry of the robots' tasks.
    pub(crate) fn task(&self, kinds: &[Kind]) -> TaskTrace {
        let mut task = TaskTrace::of_goals(&self.robots);
        for process in &self.processes {
            let Some(configured) = self.configured(process, kinds) else {
                continue;
            };
            let robots = configured.robots.iter();
            for robot in robots.filter_map(|&robot| self.robots.get(robot)) {
                task.add(configured.kind.sketch(robot, &self.world.map));
            }
        }
        task
    }

    /// Returns the radius of the disc that a robot sweeps (m): that of the rules, else that of a robot with a patrol or
    /// an area to cover; `None` for others.
    pub(crate) fn sweeps(&self, robot: &RobotSpec, kinds: &[Kind]) -> Option<f64> {
        if let Some(coverage) = &self.rules.coverage {
            let counts = coverage.counts(&robot.name, &robot.team);
            return counts.then(|| coverage.radius.unwrap_or(robot.model().radius));
        }
        let processes = self.processes.iter();
        let processes = processes.filter_map(|process| self.configured(process, kinds));
        let mut own = processes.filter(|process| {
            let mut robots = process.robots.iter().filter_map(|&i| self.robots.get(i));
            robots.any(|other| other.name == robot.name)
        });
        let has_task = own.any(|process| {
            let sketch = process.kind.sketch(robot, &self.world.map);
            !sketch.contour.is_empty() || !sketch.rectangles.is_empty()
        });
        has_task.then(|| robot.model().radius)
    }

    /// Returns a process with its parameters; `None` for an unknown kind.
    fn configured<'a>(&self, process: &'a Json, kinds: &[Kind]) -> Option<LoggedProcess<'a>> {
        let index = |name: &Json| {
            self.robots
                .iter()
                .position(|r| Some(&*r.name) == name.as_str())
        };
        let name = process.get("name")?.as_str()?;
        let kind = find(kinds, process.get("kind")?.as_str()?)?;
        let robots = process.get("robots").and_then(Json::as_array);
        let params = process.get("params").and_then(Node::from_json);
        // Parameters that cannot be read (for example, of another version) have their defaults.
        let read = params.and_then(|params| kind.read(&params).ok());
        let read = read.or_else(|| kind.read(&Node::empty_table(Origin::Implied)).ok());
        Some(LoggedProcess {
            name,
            kind: read?,
            robots: robots.into_iter().flatten().filter_map(index).collect(),
        })
    }
}

/// A process of the logged scenario.
struct LoggedProcess<'a> {
    name: &'a str,
    kind: ConfiguredKind,
    /// Its robots, by index.
    robots: Vec<usize>,
}
