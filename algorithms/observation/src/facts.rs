//! Properties of robots that stay the same for a run.

use geometry::region::Region;
use robot::spec::{RobotModel, RobotSpec};
use robot::team::Team;

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
