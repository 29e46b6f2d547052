//! Remarks of processes about their tasks, for commands to show.

use core::fmt;

use geometry::map::WorldMap;
use runtime::kind::{Remark, Task};
use serde::Serialize;

use super::resolved::ResolvedScenario;

/// Remark of a process about its task with a robot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct TaskRemark {
    /// `note` or `warning`.
    pub severity: &'static str,
    /// Name of the process.
    pub process: String,
    /// Name of the robot.
    pub robot: String,
    /// Text in one line.
    pub message: String,
}

impl fmt::Display for TaskRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            severity,
            process,
            robot,
            message,
        } = self;
        write!(f, "{severity}: {process}, {robot}: {message}")
    }
}

impl TaskRemark {
    /// Returns `true` if it reports a probable mistake.
    pub fn is_warning(&self) -> bool {
        self.severity == "warning"
    }
}

impl ResolvedScenario {
    /// Returns the remarks of all processes about their tasks, in the order of the processes.
    pub fn remarks(&self) -> Vec<TaskRemark> {
        // An invalid map has been refused.
        let Ok(world_map) = WorldMap::recent(&self.world.map) else {
            return Vec::new();
        };
        let mut found = Vec::new();
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
                    map: &self.world.map,
                    world_map: &world_map,
                    run_seed: self.run.seed,
                };
                found.extend(kind.remarks(&task).into_iter().map(|remark| {
                    let (severity, message) = match remark {
                        Remark::Note(message) => ("note", message),
                        Remark::Warning(message) => ("warning", message),
                    };
                    TaskRemark {
                        severity,
                        process: process.name.clone(),
                        robot: robot.name.clone(),
                        message,
                    }
                }));
            }
        }
        found
    }
}
