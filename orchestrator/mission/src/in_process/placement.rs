//! Processes that a name means, for planners that take their place.

use scenario::{ProcessSpec, ResolvedScenario};

/// Reason why a name means no processes whose place a planner may take.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PlacementError {
    /// The process has no robots to steer.
    #[error("process {name:?} steers no robot")]
    NoRobots {
        /// Name of the process.
        name: String,
    },
    /// The process steers other robots, too.
    #[error(
        "process {process:?} steers {name} and {other}: expected its name, or a planner for both"
    )]
    Shared {
        /// Name of the process.
        process: String,
        /// Name of the robot or team.
        name: String,
        /// Name of the other robot.
        other: String,
    },
    /// Nothing has the name.
    #[error("no robot, team or process {name:?}: expected one of {}", known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// Names of robots, teams and steering processes.
        known: Vec<String>,
    },
}

/// Returns the indices of the processes that a name means, all of which steer robots: a process, or those of a robot or
/// of a team.
///
/// # Errors
/// [`PlacementError`] if there are none, or one of them steers other robots, too.
pub fn processes_of(scenario: &ResolvedScenario, name: &str) -> Result<Vec<usize>, PlacementError> {
    let robots = &scenario.world.robots;
    let named = scenario.processes.iter().position(|p| p.name == name);
    if let Some(index) = named {
        return match scenario.processes.get(index) {
            Some(process) if steers(process) => Ok(vec![index]),
            _ => Err(PlacementError::NoRobots { name: name.into() }),
        };
    }
    let is_meant = |&robot: &usize| {
        let robot = robots.get(robot);
        robot.is_some_and(|robot| robot.name == name || robot.team == name)
    };
    let mut meant = Vec::new();
    for (index, process) in scenario.processes.iter().enumerate() {
        if !steers(process) || !process.robots.iter().any(is_meant) {
            continue;
        }
        if let Some(&other) = process.robots.iter().find(|robot| !is_meant(robot)) {
            return Err(PlacementError::Shared {
                process: process.name.clone(),
                name: name.into(),
                other: robots.get(other).map_or("", |robot| &robot.name).into(),
            });
        }
        meant.push(index);
    }
    if meant.is_empty() {
        return Err(PlacementError::Unknown {
            name: name.into(),
            known: known_names(scenario),
        });
    }
    Ok(meant)
}

/// Returns `true` if a process steers its robots.
pub fn steers(process: &ProcessSpec) -> bool {
    let declaration = process.declaration();
    declaration.is_none_or(|declaration| declaration.drives_robots())
}

/// Returns the names of robots, teams and steering processes, each once.
fn known_names(scenario: &ResolvedScenario) -> Vec<String> {
    let robots = &scenario.world.robots;
    let steering = scenario.processes.iter().filter(|process| steers(process));
    let known = robots.iter().map(|robot| &robot.name);
    let known = known.chain(robots.iter().map(|robot| &robot.team));
    let known = known.chain(steering.map(|process| &process.name));
    let mut unique: Vec<String> = Vec::new();
    for name in known {
        if !unique.contains(name) {
            unique.push(name.clone());
        }
    }
    unique
}
