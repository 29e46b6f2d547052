//! Remarks about a valid scenario, for commands to show: probable mistakes, choices of planners.

use core::fmt;

use geometry::map::WorldMap;
use runtime::kind::{Remark, Task};
use serde::Serialize;
use sim_backend::team::Role;

use super::resolved::ResolvedScenario;

/// Remark about the map, the rules or values, or of a process about its task with a robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ScenarioRemark {
    /// `note` or `warning`.
    pub severity: &'static str,
    /// Name of the process, if it is about a task.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub process: Option<String>,
    /// Name of the robot, if it is about a task.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Text in one line.
    pub message: String,
}

impl fmt::Display for ScenarioRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            severity,
            process,
            robot,
            message,
        } = self;
        match (process, robot) {
            (Some(process), Some(robot)) => write!(f, "{severity}: {process}, {robot}: {message}"),
            _ => write!(f, "{severity}: {message}"),
        }
    }
}

impl ScenarioRemark {
    /// Returns `true` if it reports a probable mistake.
    pub fn is_warning(&self) -> bool {
        self.severity == "warning"
    }

    /// A warning that is not about a task.
    fn warning(message: String) -> Self {
        Self {
            severity: "warning",
            process: None,
            robot: None,
            message,
        }
    }
}

impl ResolvedScenario {
    /// Returns the remarks about the map's file, the rules and unusual values, then those of all processes about their
    /// tasks, in the order of the processes.
    pub fn remarks(&self) -> Vec<ScenarioRemark> {
        let texts = self.map_remark.iter().cloned();
        let texts = texts.chain(self.capture_remark());
        let mut found: Vec<_> = texts
            .chain(self.unusual_values())
            .map(ScenarioRemark::warning)
            .collect();
        // An invalid map has been refused.
        let Ok(world_map) = WorldMap::recent(&self.world.map) else {
            return found;
        };
        for process in &self.processes {
            let Some(kind) = process.program.kind() else {
                continue;
            };
            for robot in process
                .robots
                .iter()
                .filter_map(|&i| self.world.robots.get(i))
            {
                let task = Task {
                    robot,
                    robots: &self.world.robots,
                    exits: self.rules().exits.len() + world_map.exits().len(),
                    map: &self.world.map,
                    world_map: &world_map,
                    run_seed: self.run.seed,
                };
                found.extend(kind.remarks(&task).into_iter().map(|remark| {
                    let (severity, message) = match remark {
                        Remark::Note(message) => ("note", message),
                        Remark::Warning(message) => ("warning", message),
                    };
                    ScenarioRemark {
                        severity,
                        process: Some(process.name.clone()),
                        robot: Some(robot.name.clone()),
                        message,
                    }
                }));
            }
        }
        found
    }

    /// Returns a warning if robots touch before a capture.
    fn capture_remark(&self) -> Option<String> {
        let capture = self.rules().capture?;
        let robots = &self.world.robots;
        let pairs = robots
            .iter()
            .flat_map(|a| robots.iter().map(move |b| (a, b)));
        let hostile = pairs.filter(|(a, b)| a.role() == Role::Pursuer && a.is_hostile_to(b));
        let contact = hostile.map(|(a, b)| a.model().radius + b.model().radius);
        let contact = contact.reduce(f64::max)?;
        (capture.radius < contact).then(|| {
            format!(
                "rules.capture.radius is {} m, below the sum of the radii of a pursuer and an evader ({contact} m): \
                 they touch before a capture",
                capture.radius
            )
        })
    }
}
