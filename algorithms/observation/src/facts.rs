//! Properties of robots that stay the same for a run.

use geometry::region::Region;
use sim_backend::spec::{RobotModel, RobotSpec};
use sim_backend::team::Team;
use sim_backend::world::World;

/// A robot as an observation needs it from the start of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct RobotFacts {
    /// Name in the scenario.
    pub name: String,
    /// Team.
    pub team: Team,
    /// Body and limits.
    pub model: RobotModel,
    /// Goal, if any.
    pub goal: Option<Region>,
    /// Number of beams of its range scan; 0 without one.
    pub beams: usize,
}

impl RobotFacts {
    /// Returns the robots of a world, in their order.
    pub fn of_world(world: &World) -> Vec<Self> {
        let robots = world.robots().iter().enumerate();
        let facts = robots.map(|(index, robot)| Self {
            name: robot.name.clone(),
            team: robot.team,
            model: robot.model,
            goal: robot.goal,
            beams: world.scan_spec(index).map_or(0, |scan| scan.beams),
        });
        facts.collect()
    }

    /// Returns the robots of a scenario, in their order.
    pub fn of_specs(robots: &[RobotSpec]) -> Vec<Self> {
        let teams = RobotSpec::teams(robots);
        let facts = robots.iter().zip(teams).map(|(robot, team)| Self {
            name: robot.name.clone(),
            team,
            model: robot.model(),
            goal: robot.goal,
            beams: robot.scan.map_or(0, |scan| scan.beams),
        });
        facts.collect()
    }
}
