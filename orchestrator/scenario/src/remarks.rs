//! Remarks about a valid scenario, for commands to show: probable mistakes, choices of planners.

use core::fmt;

use geometry::map::WorldMap;
use robot::team::Role;
use runtime::kind::{Remark, Task};
use serde::Serialize;

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

/// Returns a line for every kind of remark: the first one and the number of those whose text differs in numbers alone.
pub fn remark_lines<'a>(remarks: impl IntoIterator<Item = &'a ScenarioRemark>) -> Vec<String> {
    let words = |remark: &'a ScenarioRemark| {
        let is_number = |c: char| c.is_ascii_digit() || ".-".contains(c);
        let parts = remark.message.split(is_number);
        let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
        (remark.severity, parts)
    };
    first_of_each(remarks.into_iter().map(|remark| (words(remark), remark)))
}

/// Returns the first text of each kind and the number of the others of its kind.
pub(super) fn first_of_each<K: PartialEq, T: fmt::Display>(
    texts: impl IntoIterator<Item = (K, T)>,
) -> Vec<String> {
    let mut kinds: Vec<(K, T, usize)> = Vec::new();
    for (kind, text) in texts {
        match kinds.iter_mut().find(|(known, ..)| *known == kind) {
            Some((.., others)) => *others += 1,
            None => kinds.push((kind, text, 0)),
        }
    }
    let line = |(_, text, others): (K, T, usize)| match others {
        0 => text.to_string(),
        others => format!("{text} ({others} more like it)"),
    };
    kinds.into_iter().map(line).collect()
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
            for &index in &process.robots {
                let Some(robot) = self.world.robots.get(index) else {
                    continue;
                };
                let task = Task {
                    robot,
                    companions: self.companions(index).len(),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_that_differ_in_numbers_are_one_line() {
        let remark = |severity, robot: &str, message: &str| ScenarioRemark {
            severity,
            process: Some("guard".to_owned()),
            robot: Some(robot.to_owned()),
            message: message.to_owned(),
        };
        let remarks = [
            remark(
                "warning",
                "a",
                "12 of 400 waypoints are outside, first 7 at (1.5, -2)",
            ),
            remark("note", "a", "α = 1.0 m"),
            remark(
                "warning",
                "b",
                "0 of 38 waypoints are outside, first 11 at (-0.25, 3)",
            ),
            remark(
                "warning",
                "b",
                "12 of 400 waypoints are blocked, first 7 at (1.5, -2)",
            ),
            remark(
                "warning",
                "c",
                "5 of 6 waypoints are outside, first 1 at (0, 3)",
            ),
        ];
        let lines = remark_lines(&remarks);
        assert_eq!(lines.len(), 3, "{lines:?}");
        let first = "warning: guard, a: 12 of 400 waypoints are outside, first 7 at (1.5, -2) (2 more like it)";
        assert_eq!(
            (lines[0].as_str(), lines[1].as_str()),
            (first, "note: guard, a: α = 1.0 m")
        );
    }
}
