//! Routes that waypoint planners would produce, without a run: the laps of a patrol, its predicted positions, and the
//! sub-goals of a coverage.

pub mod coverage;
pub mod patrol;

use robot::spec::RobotSpec;
use thiserror::Error;

use scenario::{ProcessSpec, ResolvedScenario};

/// Error of planning the routes of a scenario.
#[derive(Debug, Error)]
pub enum RouteError {
    /// The scenario has no process of the wanted kinds.
    #[error("{scenario}: no process of kind {wanted}; it has {found}")]
    NoProcess {
        /// Name of the scenario.
        scenario: String,
        /// Suitable kinds.
        wanted: String,
        /// Kinds in the scenario.
        found: String,
    },
    /// No process of a suitable kind has this name.
    #[error(
        "{scenario}: `{name}` is none of its processes of kind {wanted}: expected one of {found}"
    )]
    NotNamed {
        /// Name of the scenario.
        scenario: String,
        /// Requested name.
        name: String,
        /// Suitable kinds.
        wanted: String,
        /// Names of the suitable processes.
        found: String,
    },
    /// Several processes are suitable.
    #[error(
        "{scenario} has several processes of kind {wanted}: expected one of {found} as `process`"
    )]
    Several {
        /// Name of the scenario.
        scenario: String,
        /// Suitable kinds.
        wanted: String,
        /// Names of the suitable processes.
        found: String,
    },
    /// The process cannot plan with its parameters.
    #[error("{process}: {reason}")]
    Refused {
        /// Name of the process.
        process: String,
        /// Cause, with the valid values.
        reason: String,
    },
}

/// A process that plans a route, and the first robot that it drives.
#[derive(Debug, Clone, Copy)]
pub struct Router<'s> {
    /// Process of the planner.
    pub process: &'s ProcessSpec,
    /// Kind of the process.
    pub kind: &'s str,
    /// First robot that it drives.
    pub robot: &'s RobotSpec,
}

impl<'s> Router<'s> {
    /// Finds the scenario's only process of one of these kinds, or the process with this name.
    ///
    /// # Errors
    /// [`RouteError`] if there is none, or several without a name.
    pub fn find(
        scenario: &'s ResolvedScenario,
        kinds: &[&str],
        name: Option<&str>,
    ) -> Result<Self, RouteError> {
        let kind_of = |process: &'s ProcessSpec| process.program.kind_name();
        let fitting: Vec<(&ProcessSpec, &str)> = scenario
            .processes
            .iter()
            .filter_map(|process| Some((process, kind_of(process)?)))
            .filter(|(_, kind)| kinds.contains(kind))
            .collect();
        let names = |of: &[(&ProcessSpec, &str)]| {
            let names: Vec<&str> = of
                .iter()
                .map(|(process, _)| process.name.as_str())
                .collect();
            names.join(", ")
        };
        let (scenario_name, wanted) = (scenario.name.clone(), kinds.join(" or "));
        let chosen = match (name, &fitting[..]) {
            (_, []) => {
                let mut kinds: Vec<&str> = scenario.processes.iter().filter_map(kind_of).collect();
                kinds.sort_unstable();
                kinds.dedup();
                return Err(RouteError::NoProcess {
                    scenario: scenario_name,
                    wanted,
                    found: kinds.join(", "),
                });
            }
            (Some(name), all) => {
                let found = all.iter().find(|(process, _)| process.name == name);
                *found.ok_or_else(|| RouteError::NotNamed {
                    scenario: scenario_name,
                    name: name.to_owned(),
                    wanted,
                    found: names(all),
                })?
            }
            (None, [only]) => *only,
            (None, all) => {
                return Err(RouteError::Several {
                    scenario: scenario_name,
                    wanted,
                    found: names(all),
                });
            }
        };
        let (process, kind) = chosen;
        let robot = process
            .robots
            .first()
            .and_then(|&robot| scenario.world.robots.get(robot))
            .ok_or_else(|| RouteError::Refused {
                process: process.name.clone(),
                reason: "it drives no robot".into(),
            })?;
        Ok(Self {
            process,
            kind,
            robot,
        })
    }

    /// Returns the seed that the process gives the planner of this robot.
    fn seed(&self, scenario: &ResolvedScenario) -> u64 {
        planner::planner_seed(scenario.run.seed, self.kind, &self.robot.name)
    }

    /// Returns the parameters of the process.
    fn params<P: 'static>(&self) -> Result<&'s P, RouteError> {
        let kind = self.process.program.kind();
        let params = kind.and_then(|kind| kind.params());
        params.ok_or_else(|| self.refused(&"its parameters are of another kind"))
    }

    fn refused(&self, reason: &dyn std::fmt::Display) -> RouteError {
        RouteError::Refused {
            process: self.process.name.clone(),
            reason: reason.to_string(),
        }
    }
}

#[cfg(test)]
mod tests;
